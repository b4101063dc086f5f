# SPDX-License-Identifier: Apache-2.0
"""Line strips as rerun keeps them, made at once. rerun itself converts a list of strips one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike


def strips_2d(strips: Iterable[ArrayLike]) -> pa.ListArray:
    """Return strips, (k, 2) each, to draw with `rr.LineStrips2D`."""
    return _strips(strips, rr.components.LineStrip2D.arrow_type())


def strips_3d(strips: Iterable[ArrayLike]) -> pa.ListArray:
    """Return strips, (k, 3) each, to draw with `rr.LineStrips3D`."""
    return _strips(strips, rr.components.LineStrip3D.arrow_type())


def _strips(strips: Iterable[ArrayLike], kind: pa.DataType) -> pa.ListArray:
    points = [np.asarray(strip, dtype=np.float32) for strip in strips]
    ends = np.cumsum([0, *map(len, points)], dtype=np.int32)
    numbers = np.concatenate(points, axis=None) if points else np.zeros(0, dtype=np.float32)
    return pa.ListArray.from_arrays(
        ends, pa.FixedSizeListArray.from_arrays(numbers, type=kind.value_type), type=kind
    )
