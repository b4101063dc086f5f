"""A recording that remembers what stands in it, so that a place that is opened later gets it too.

A viewer that dies and comes back and the next of several files begin with the picture as it is then: with
all that keeps its form, the newest drawing of each thing, the last moments of trails and curves, and the
newest words. What is sent to one place as to another has the same recording's id, so that several files
opened together are one picture.

Two timelines are added to that of the stamps. On `SINCE_START` the first stamp is zero. On `ORDER` each step
is one drawing, in the order in which states and answers came.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final
from uuid import uuid4

import numpy as np
import rerun as rr

from contact_dynamics.viewing.arrangement import Arrangement
from contact_dynamics.viewing.entities import ORDER, SINCE_START, TIMELINE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

APPLICATION: Final = "contact_dynamics"

LAST_BATCHES: Final = 40
"""Batches of states that stay in memory of each trail and curve: two seconds of a live picture."""

LAST_WORDS: Final = 200
"""Lines of the list of all answers that stay in memory."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Drawn:
    """One thing that was drawn: a row with the time it was drawn at, or columns with their own times."""

    step: int
    stamp_ns: int | None
    path: str
    parts: tuple[Any, ...]
    indexes: tuple[rr.TimeColumn, ...] = ()

    @property
    def kind(self) -> type:
        return type(self.parts[0])

    def draw(self, place: rr.RecordingStream, start_ns: int | None) -> None:
        if self.indexes:
            place.send_columns(self.path, indexes=self.indexes, columns=self.parts)
            return
        _set_time(place, self.stamp_ns, start_ns=start_ns, step=self.step)
        place.log(self.path, *self.parts)


class KeptRecording(rr.RecordingStream):
    """Hands on what is drawn to its places, which are recordings with its id.

    It is a `rr.RecordingStream`, so that whatever draws into one draws into it. Itself it has no sink.
    """

    def __init__(self) -> None:
        """Begin with an empty picture and no places."""
        self.id = uuid4().hex
        super().__init__(APPLICATION, recording_id=self.id, send_properties=False)
        super().set_sinks()
        self._places: list[rr.RecordingStream] = []
        self._arrangement = Arrangement(APPLICATION)
        self._static: dict[tuple[str, type], tuple[Any, ...]] = {}
        self._rows: dict[str, dict[type, _Drawn]] = {}  # by path and kind
        self._batches: dict[str, deque[_Drawn]] = {}  # columns with the gaps between them, and words
        self._start_ns: int | None = None
        self._stamp_ns: int | None = None
        self._step = 0

    def open(self, *sinks: rr.sinks.LogSinkLike) -> rr.RecordingStream:
        """Open a further place, which gets what stands now and what is drawn from now on. Return it."""
        place = rr.RecordingStream(APPLICATION, recording_id=self.id)
        self._places.append(place)
        self.reopen(place, *sinks)
        return place

    def reopen(self, place: rr.RecordingStream, *sinks: rr.sinks.LogSinkLike) -> None:
        """Open a place anew, with other sinks and what stands now. Without sinks nothing is drawn there.

        A recording of rerun keeps threads and memory after its end, so a place is not thrown away.
        """
        place.set_sinks(*sinks)
        if not sinks:
            return
        self._arrangement.send_to(place)
        for (path, _), parts in self._static.items():
            place.log(path, *parts, static=True)
        rows = (row for kinds in self._rows.values() for row in kinds.values())
        batches = (batch for kept in self._batches.values() for batch in kept)
        for drawn in sorted((*rows, *batches), key=lambda each: each.step):
            drawn.draw(place, self._start_ns)
        _set_time(place, self._stamp_ns, start_ns=self._start_ns, step=self._step)

    def set_time(self, timeline: str, **time: Any) -> None:
        """Set the time of what is logged next. If it is a stamp, it is so on all three timelines."""
        if timeline != TIMELINE:
            for place in self._places:
                place.set_time(timeline, **time)
            return
        self._stamp_ns = int(time["timestamp"].astype("datetime64[ns]").astype(np.int64))
        self._begin(self._stamp_ns)
        self._step += 1
        for place in self._places:
            _set_time(place, self._stamp_ns, start_ns=self._start_ns, step=self._step)

    def log(
        self,
        entity_path: str | list[object],
        entity: Any,
        *extra: Any,
        static: bool = False,
        strict: bool | None = None,
    ) -> None:
        """Draw a thing, as `rr.RecordingStream.log` does."""
        path = (
            rr.new_entity_path(entity_path) if isinstance(entity_path, list) else f"/{entity_path.strip('/')}"
        )
        parts = (entity, *extra)
        for place in self._places:
            place.log(path, *parts, static=static, strict=strict)
        if static:
            self._static[path, type(entity)] = parts
        else:
            self._keep(_Drawn(step=self._step, stamp_ns=self._stamp_ns, path=path, parts=parts))

    def send_columns(
        self, entity_path: str, indexes: Iterable[Any], columns: Iterable[Any], *, strict: bool | None = None
    ) -> None:
        """Draw a thing at many times, as `rr.RecordingStream.send_columns` does."""
        self._step += 1
        times = tuple(time for index in indexes for time in self._times(index))
        path, parts = f"/{entity_path.strip('/')}", tuple(columns)
        for place in self._places:
            place.send_columns(path, indexes=times, columns=parts, strict=strict)
        self._keep(_Drawn(step=self._step, stamp_ns=None, path=path, parts=parts, indexes=times))

    def send_blueprint(self, blueprint: Any, *, make_active: bool = True, make_default: bool = True) -> None:
        """Arrange the views, as `rr.RecordingStream.send_blueprint` does."""
        self._arrangement.change(blueprint)
        for place in self._places:
            self._arrangement.send_to(place, make_active=make_active, make_default=make_default)

    def flush(self, *, timeout_sec: float = 1e38) -> None:
        """Wait until all places have what was drawn, each for at most ``timeout_sec``, s."""
        for place in self._places:
            place.flush(timeout_sec=timeout_sec)

    def disconnect(self) -> None:
        """Close all places."""
        for place in self._places:
            place.disconnect()

    def _begin(self, stamp_ns: int) -> int:
        """Return the first stamp, ns, which this one is if there was none before."""
        if self._start_ns is None:
            self._start_ns = stamp_ns
        return self._start_ns

    def _times(self, index: Any) -> list[rr.TimeColumn]:
        """Return a column of times, and if it has stamps, those of the other timelines."""
        if index.timeline_name() != TIMELINE:
            return [index]
        stamps: NDArray[np.int64] = index.as_arrow_array().to_numpy(zero_copy_only=False).astype(np.int64)
        since = (stamps - self._begin(int(stamps[0]))).astype("timedelta64[ns]")
        steps = np.full(len(stamps), self._step)
        return [index, rr.TimeColumn(SINCE_START, duration=since), rr.TimeColumn(ORDER, sequence=steps)]

    def _keep(self, drawn: _Drawn) -> None:
        """Remember a thing in place of what it covers."""
        is_words = drawn.kind is rr.TextLog
        if drawn.kind is rr.Clear:
            self._clear(drawn)
        elif is_words or drawn.indexes:
            most = LAST_WORDS if is_words else LAST_BATCHES
            self._batches.setdefault(drawn.path, deque(maxlen=most)).append(drawn)
        else:
            self._rows.setdefault(drawn.path, {})[drawn.kind] = drawn

    def _clear(self, drawn: _Drawn) -> None:
        (is_recursive,) = drawn.parts[0].is_recursive.as_arrow_array().to_pylist()
        kept: tuple[dict[str, Any], ...] = (self._rows, self._batches)
        if is_recursive:
            for each in kept:
                for path in [path for path in each if f"{path}/".startswith(f"{drawn.path}/")]:
                    del each[path]
            return
        self._rows.pop(drawn.path, None)
        if drawn.path in self._batches:
            self._batches[drawn.path].append(drawn)


def _set_time(place: rr.RecordingStream, stamp_ns: int | None, *, start_ns: int | None, step: int) -> None:
    if stamp_ns is not None and start_ns is not None:
        place.set_time(TIMELINE, timestamp=np.datetime64(stamp_ns, "ns"))
        place.set_time(SINCE_START, duration=np.timedelta64(stamp_ns - start_ns, "ns"))
        place.set_time(ORDER, sequence=step)
