# SPDX-License-Identifier: Apache-2.0
"""Columns of an entity's values over many times, converted once for all sinks.

The conversion takes most of the time of drawing, since rerun converts strips one by one. A chunk, the unit
that rerun transfers and writes, costs about the same for one time as for a hundred.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pyarrow as pa
import rerun as rr
from rerun.chunk import Chunk

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.validation import FloatArray


class _Made(NamedTuple):
    """Times on one timeline, or values of one component, in rerun's form."""

    of: Any  # the timeline's name, or the component's descriptor
    array: pa.Array

    def timeline_name(self) -> str:
        return str(self.of)

    def component_descriptor(self) -> Any:
        return self.of

    def as_arrow_array(self) -> pa.Array:
        return self.array


class Columns(NamedTuple):
    """The values of an entity's components at many times."""

    times: tuple[_Made, ...]
    values: tuple[_Made, ...]

    @classmethod
    def made_of(cls, times: Iterable[rr.TimeColumn], values: Iterable[rr.ComponentColumn]) -> Columns:
        """Convert them."""
        return cls(
            tuple(_Made(each.timeline_name(), each.as_arrow_array()) for each in times),
            tuple(_Made(each.component_descriptor(), each.as_arrow_array()) for each in values),
        )

    @property
    def kind(self) -> tuple[str, ...]:
        """Key that is equal for columns that can be joined."""
        return tuple(str(each.of) for each in (*self.times, *self.values))

    def joined(self, others: Iterable[Columns]) -> Columns:
        """Return these columns and further ones of their kind, one after the other."""
        every = (self, *others)
        return Columns(_joined([each.times for each in every]), _joined([each.values for each in every]))

    def chunk(self, path: str) -> Chunk:
        """Return a chunk for rerun at a path, which may be sent to several sinks."""
        return Chunk.from_columns(path, self.times, self.values)  # type: ignore[arg-type]


def _joined(parts: Sequence[tuple[_Made, ...]]) -> tuple[_Made, ...]:
    return tuple(
        _Made(same[0].of, pa.concat_arrays([each.array for each in same]))
        for same in zip(*parts, strict=True)
    )


def scalar_columns(values: FloatArray) -> list[rr.ComponentColumn]:
    """Like `rr.Scalars.columns`, but faster, for values, (n,)."""
    return [_column(rr.Scalars.descriptor_scalars(), pa.array(values, pa.float64()))]


def pose_columns(p_WB_W: FloatArray, q_WB: FloatArray) -> list[rr.ComponentColumn]:
    """Like `rr.Transform3D.columns`, but faster, for positions, (n, 3), m, and quaternions, (n, 4)."""
    return [
        _column(rr.Transform3D.descriptor_translation(), _vectors(p_WB_W, rr.components.Translation3D)),
        _column(rr.Transform3D.descriptor_quaternion(), _vectors(q_WB, rr.components.RotationQuat)),
    ]


def strip_columns(strips: FloatArray) -> list[rr.ComponentColumn]:
    """Like `rr.LineStrips3D.columns`, but faster, for strips, (n, k, 3), m."""
    return [_column(rr.LineStrips3D.descriptor_strips(), strips_3d(strips))]


def _vectors(numbers: FloatArray, kind: Any) -> pa.Array:
    return pa.FixedSizeListArray.from_arrays(np.ravel(numbers).astype(np.float32), type=kind.arrow_type())


def _column(descriptor: rr.ComponentDescriptor, array: pa.Array) -> rr.ComponentColumn:
    """Return a column with one value at each time."""
    offsets = np.arange(len(array) + 1, dtype=np.int32)
    return rr.ComponentColumn(descriptor, _Made(descriptor, array), offsets=offsets)


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
