# SPDX-License-Identifier: Apache-2.0
"""What is made ready for rerun in less time is what rerun itself makes."""

from __future__ import annotations

import numpy as np
import pytest
import rerun as rr

from contact_dynamics.validation import FloatArray
from contact_dynamics.viewing.columns import pose_columns, scalar_columns, strip_columns, strips_2d, strips_3d

RNG = np.random.default_rng(5)
POINTS, TURNS, PAIRS = RNG.random((5, 3)), RNG.random((5, 4)), RNG.random((5, 2, 3))


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (scalar_columns(POINTS[:, 0]), rr.Scalars.columns(scalars=POINTS[:, 0])),
        (pose_columns(POINTS, TURNS), rr.Transform3D.columns(translation=POINTS, quaternion=TURNS)),
        (strip_columns(PAIRS), rr.LineStrips3D.columns(strips=list(PAIRS))),
    ],
    ids=["scalars", "poses", "strips"],
)
def test_columns(made: list[rr.ComponentColumn], expected: rr.ComponentColumnList) -> None:
    for ours, theirs in zip(made, expected, strict=True):
        assert ours.component_descriptor() == theirs.component_descriptor()
        assert ours.as_arrow_array().equals(theirs.as_arrow_array())


@pytest.mark.parametrize("counts", [(), (2,), (3, 2, 7)], ids=str)
def test_strips(counts: tuple[int, ...]) -> None:
    flat: list[FloatArray] = [RNG.random((count, 2)) for count in counts]
    spatial: list[FloatArray] = [RNG.random((count, 3)) for count in counts]
    assert strips_2d(flat).equals(rr.components.LineStrip2DBatch(flat).as_arrow_array())
    assert strips_3d(spatial).equals(rr.components.LineStrip3DBatch(spatial).as_arrow_array())
