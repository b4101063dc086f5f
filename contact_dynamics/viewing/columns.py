"""What is drawn of a thing at many times, made ready for rerun once, for all places that get it.

To convert it costs most of what drawing costs. And a chunk, which is what rerun takes and writes, costs about
the same whether it has one time or a hundred.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pyarrow as pa
import rerun as rr
from rerun.chunk import Chunk

from contact_dynamics.viewing.strips import strips_3d

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.validation import FloatArray


class _Times(NamedTuple):
    """Times on one timeline, as rerun takes them."""

    timeline: str
    array: pa.Array

    def timeline_name(self) -> str:
        return self.timeline

    def as_arrow_array(self) -> pa.Array:
        return self.array


class _Values(NamedTuple):
    """Values of one component at each time, as rerun takes them."""

    descriptor: Any
    array: pa.Array

    def component_descriptor(self) -> Any:
        return self.descriptor

    def as_arrow_array(self) -> pa.Array:
        return self.array


class _Array(NamedTuple):
    """Values of one component, as rerun takes them."""

    array: pa.Array

    def as_arrow_array(self) -> pa.Array:
        return self.array


class Columns(NamedTuple):
    """The values of a thing's components at many times."""

    times: tuple[_Times, ...]
    values: tuple[_Values, ...]

    @classmethod
    def made_of(cls, times: Iterable[rr.TimeColumn], values: Iterable[rr.ComponentColumn]) -> Columns:
        """Make them ready."""
        return cls(
            tuple(_Times(each.timeline_name(), each.as_arrow_array()) for each in times),
            tuple(_Values(each.component_descriptor(), each.as_arrow_array()) for each in values),
        )

    @property
    def kind(self) -> tuple[str, ...]:
        """What is the same in columns that can be joined."""
        return (
            *(each.timeline for each in self.times),
            *(str(each.descriptor) for each in self.values),
        )

    def joined(self, others: Iterable[Columns]) -> Columns:
        """Return these columns and further ones of their kind, one after the other."""
        every = (self, *others)
        times = (pa.concat_arrays([each.times[i].array for each in every]) for i in range(len(self.times)))
        values = (pa.concat_arrays([each.values[i].array for each in every]) for i in range(len(self.values)))
        return Columns(
            tuple(each._replace(array=array) for each, array in zip(self.times, times, strict=True)),
            tuple(each._replace(array=array) for each, array in zip(self.values, values, strict=True)),
        )

    def chunk(self, path: str) -> Chunk:
        """Return what rerun draws at a path. It may be sent to several places."""
        return Chunk.from_columns(path, self.times, self.values)  # type: ignore[arg-type]


def scalar_columns(values: FloatArray) -> list[rr.ComponentColumn]:
    """Return what `rr.Scalars.columns` does of values, (n,), in less time."""
    return [_column(rr.Scalars.descriptor_scalars(), pa.array(values, pa.float64()))]


def pose_columns(p_WB_W: FloatArray, q_WB: FloatArray) -> list[rr.ComponentColumn]:
    """Return what `rr.Transform3D.columns` does of positions, (n, 3), m, and turns, (n, 4), in less time."""
    return [
        _column(rr.Transform3D.descriptor_translation(), _vectors(p_WB_W, rr.components.Translation3D)),
        _column(rr.Transform3D.descriptor_quaternion(), _vectors(q_WB, rr.components.RotationQuat)),
    ]


def strip_columns(strips: FloatArray) -> list[rr.ComponentColumn]:
    """Return what `rr.LineStrips3D.columns` does of strips, (n, k, 3), m, in less time."""
    return [_column(rr.LineStrips3D.descriptor_strips(), strips_3d(strips))]


def _vectors(numbers: FloatArray, kind: Any) -> pa.Array:
    return pa.FixedSizeListArray.from_arrays(np.ravel(numbers).astype(np.float32), type=kind.arrow_type())


def _column(descriptor: rr.ComponentDescriptor, array: pa.Array) -> rr.ComponentColumn:
    """Return a column with one value at each time."""
    offsets = np.arange(len(array) + 1, dtype=np.int32)
    return rr.ComponentColumn(descriptor, _Array(array), offsets=offsets)
