# SPDX-License-Identifier: Apache-2.0
"""A recording that keeps its current contents, so that sinks opened later receive them too.

A restarted viewer and the next of several files begin with the current picture: everything static, the newest
drawing of each entity, the last moments of trails and curves, and the newest words. All sinks receive the
same recording id, so that several files opened together form one picture.

Two timelines are added to that of the stamps. On `SINCE_START` the first stamp is zero. On `ORDER` each step
is one drawing, in the order in which states and answers arrived.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final, NamedTuple
from uuid import uuid4

import numpy as np
import rerun as rr
import rerun_bindings as bindings

from contact_dynamics.constants import to_ns
from contact_dynamics.viewing.columns import Columns
from contact_dynamics.viewing.entities import ORDER, SINCE_START, TIMELINE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    import rerun.blueprint as rrb

APPLICATION: Final = "contact_dynamics"

LAST_S: Final = 2.0  # s, by the stamps, of each trail and curve that is kept in memory
LAST_BATCHES: Final = 100  # maximum number of batches in it, since stamps can repeat or decrease
LAST_WORDS: Final = 200  # lines of the list of all answers that are kept in memory


class _Timed(NamedTuple):
    """The times of one drawing."""

    columns: tuple[rr.TimeColumn, ...]  # one for each timeline
    last_ns: int
    step: int


@dataclass(frozen=True, slots=True, kw_only=True)
class _Row:
    """An entity drawn at one time."""

    step: int
    stamp_ns: int | None
    path: str
    kind: type
    parts: Sequence[rr.DescribedComponentBatch]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Batch:
    """An entity drawn at many times."""

    step: int
    stamp_ns: int | None  # the last one
    path: str
    columns: Columns


class KeptRecording(rr.RecordingStream):
    """Forwards drawings to its sinks, which are recordings with its id.

    It is a `rr.RecordingStream` without a sink of its own, so that all drawing functions accept it.
    """

    def __init__(self) -> None:
        """Begin with an empty picture and no sinks."""
        self.id = uuid4().hex
        super().__init__(APPLICATION, recording_id=self.id, send_properties=False)
        super().set_sinks()
        self._places: list[rr.RecordingStream] = []
        self._left: list[rr.RecordingStream] = []
        self._arrangement = Arrangement()
        self._static: dict[tuple[str, type], Sequence[rr.DescribedComponentBatch]] = {}
        self._rows: dict[str, dict[type, _Row]] = {}  # by path and kind
        self._batches: dict[str, deque[_Row | _Batch]] = {}  # columns with the gaps between them, and texts
        self._cleared: dict[str, _Row] = {}  # cleared paths without a later drawing
        self._timed: _Timed | None = None
        self._start_ns: int | None = None
        self._stamp_ns: int | None = None
        self._step = 0

    def open(self, *sinks: rr.sinks.LogSinkLike) -> rr.RecordingStream:
        """Open and return a further sink, which receives the current picture and all later drawings."""
        place = rr.RecordingStream(APPLICATION, recording_id=self.id)
        self._places.append(place)
        self.reopen(place, *sinks)
        return place

    def reopen(self, place: rr.RecordingStream, *sinks: rr.sinks.LogSinkLike) -> None:
        """Reopen a recording with other sinks and the current picture, or disable it without sinks.

        rerun keeps a recording's threads and memory after its end, so recordings are reused.
        """
        place.set_sinks(*sinks)
        if place in self._left:
            self._left.remove(place)
            self._places.append(place)
        if not sinks:
            return
        self._arrangement.send_to(place)
        for (path, _), parts in self._static.items():
            place.log(path, parts, static=True)
        rows = (row for kinds in self._rows.values() for row in kinds.values())
        batches = (batch for kept in self._batches.values() for batch in _joined(kept))
        step = -1
        for drawn in sorted((*rows, *batches), key=lambda each: each.step):
            if isinstance(drawn, _Batch):
                place.send_chunks(drawn.columns.chunk(drawn.path))
                continue
            if drawn.step != step:
                step = drawn.step
                _set_time(place, drawn.stamp_ns, start_ns=self._start_ns, step=step)
            place.log(drawn.path, drawn.parts)
        _set_time(place, self._stamp_ns, start_ns=self._start_ns, step=self._step)

    def leave(self, place: rr.RecordingStream) -> None:
        """Stop drawing into a blocked sink until it is reopened.

        It is kept, since closing it could block in rerun for ever.
        """
        self._places.remove(place)
        self._left.append(place)

    def set_time(self, timeline: str, **time: Any) -> None:
        """Set the time of the following drawings; a stamp sets all three timelines."""
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
        """Draw an entity, as `rr.RecordingStream.log` does."""
        path = (
            rr.new_entity_path(entity_path) if isinstance(entity_path, list) else f"/{entity_path.strip('/')}"
        )
        if type(entity) is rr.Clear and self._is_clear(path, entity):
            return
        parts = [batch for part in (entity, *extra) for batch in part.as_component_batches()]
        for place in self._places:
            place.log(path, parts, static=static, strict=strict)
        if static:
            self._static[path, type(entity)] = parts
            return
        row = _Row(step=self._step, stamp_ns=self._stamp_ns, path=path, kind=type(entity), parts=parts)
        if row.kind is rr.Clear:
            self._clear(row)
            return
        self._note_drawn(path)
        if row.kind is rr.TextLog:
            self._batches.setdefault(path, deque(maxlen=LAST_WORDS)).append(row)
        else:
            self._rows.setdefault(path, {})[row.kind] = row

    def send_columns(
        self,
        entity_path: str,
        indexes: Iterable[Any],
        columns: Iterable[Any],
        *,
        strict: bool | None = None,  # noqa: ARG002  what is wrong always raises
    ) -> None:
        """Draw an entity at many times, as `rr.RecordingStream.send_columns` does, with one column of stamps.

        Consecutive entities whose stamps are the same object count as one drawing.
        """
        (index,) = indexes
        timed = self._at_times(index)
        path = f"/{entity_path.strip('/')}"
        made = Columns.made_of(timed.columns, columns)
        chunk = made.chunk(path)
        self._note_drawn(path)
        for place in self._places:
            place.send_chunks(chunk)
        kept = self._batches.setdefault(path, deque(maxlen=LAST_BATCHES))
        kept.append(_Batch(step=timed.step, stamp_ns=timed.last_ns, path=path, columns=made))
        while (kept[0].stamp_ns or 0) < timed.last_ns - to_ns(LAST_S):
            kept.popleft()

    def send_blueprint(self, blueprint: Any, **_as_always: bool) -> None:
        """Set the layout of the views, as `rr.RecordingStream.send_blueprint` does by default."""
        self._arrangement.newest = blueprint
        for place in self._places:
            self._arrangement.send_to(place)

    def flush(self, *, timeout_sec: float = 1e38) -> None:
        """Wait until all sinks have received all drawings, each for at most ``timeout_sec``, s."""
        for place in self._places:
            place.flush(timeout_sec=timeout_sec)

    def disconnect(self) -> None:
        """Close all sinks."""
        for place in self._places:
            place.disconnect()

    def _begin(self, stamp_ns: int) -> int:
        """Return the first stamp, ns, which is this one if there was none before."""
        if self._start_ns is None:
            self._start_ns = stamp_ns
        return self._start_ns

    def _at_times(self, index: rr.TimeColumn) -> _Timed:
        """Return a column of stamps with the columns of the other timelines."""
        if self._timed is None or index is not self._timed.columns[0]:
            stamps = index.as_arrow_array().to_numpy(zero_copy_only=False).astype(np.int64)
            self._step += 1
            since = (stamps - self._begin(int(stamps[0]))).astype("timedelta64[ns]")
            steps = np.full(len(stamps), self._step)
            columns = (
                index,
                rr.TimeColumn(SINCE_START, duration=since),
                rr.TimeColumn(ORDER, sequence=steps),
            )
            self._timed = _Timed(columns, int(stamps.max()), self._step)
        return self._timed

    def _is_clear(self, path: str, clear: rr.Clear) -> bool:
        """Return whether a path was cleared, at this stamp or before, and nothing was drawn there since."""
        before = self._cleared.get(path)
        if before is None or (before.stamp_ns or 0) > (self._stamp_ns or 0):
            return False
        return _is_recursive(before.parts) or not _is_recursive(clear.as_component_batches())

    def _note_drawn(self, path: str) -> None:
        """Mark a path and its parents as drawn."""
        while path and self._cleared:
            self._cleared.pop(path, None)
            path = path.rpartition("/")[0]

    def _clear(self, drawn: _Row) -> None:
        self._cleared[drawn.path] = drawn
        kept: tuple[dict[str, Any], ...] = (self._rows, self._batches)
        if _is_recursive(drawn.parts):
            for each in kept:
                for path in [path for path in each if f"{path}/".startswith(f"{drawn.path}/")]:
                    del each[path]
            return
        self._rows.pop(drawn.path, None)
        if drawn.path in self._batches:
            self._batches[drawn.path].append(drawn)


def _is_recursive(parts: Sequence[rr.DescribedComponentBatch]) -> bool:
    (is_recursive,) = parts[0].as_arrow_array().to_pylist()
    return bool(is_recursive)


def _joined(kept: Iterable[_Row | _Batch]) -> Iterator[_Row | _Batch]:
    """Join consecutive batches, since many small ones take much longer."""
    for kind, group in groupby(
        kept, key=lambda each: each.columns.kind if isinstance(each, _Batch) else None
    ):
        first, *others = group
        if kind is None or not isinstance(first, _Batch):
            yield first
            yield from others
        else:
            joined = first.columns.joined(each.columns for each in others if isinstance(each, _Batch))
            yield replace(first, columns=joined)


def _set_time(place: rr.RecordingStream, stamp_ns: int | None, *, start_ns: int | None, step: int) -> None:
    if stamp_ns is not None and start_ns is not None:
        place.set_time(TIMELINE, timestamp=np.datetime64(stamp_ns, "ns"))
        place.set_time(SINCE_START, duration=np.timedelta64(stamp_ns - start_ns, "ns"))
        place.set_time(ORDER, sequence=step)


class Arrangement:
    """The layout of the views of one picture, which can be sent repeatedly without accumulating memory.

    `rr.send_blueprint` makes a recording for each blueprint that it sends, which rerun keeps to the end of
    the process: two threads and 2 MB each time, and pictures in rolling files send one with each file. Here
    all blueprints go through one recording. It uses the same functions as `rr.send_blueprint`; a test with
    the real rerun counts the threads.

    Attributes:
        newest: The newest layout, or None before the first.
    """

    def __init__(self) -> None:
        self.newest: rrb.Blueprint | None = None
        self._stream = rr.RecordingStream._from_native(  # noqa: SLF001
            bindings.new_blueprint(
                application_id=APPLICATION,
                make_default=False,
                make_thread_default=False,
                default_enabled=True,
            )
        )
        self._stream.set_time("blueprint", sequence=0)

    def send_to(self, place: rr.RecordingStream) -> None:
        """Send the newest layout to a sink, if there is one."""
        if self.newest is None:
            return
        for path in ("view", "container"):  # earlier ones have other names, and would remain hidden
            self._stream.log(path, rr.Clear(recursive=True))
        self.newest._log_to_stream(self._stream)  # noqa: SLF001
        storage = self._stream.memory_recording().storage
        active = default = True
        bindings.send_blueprint(storage, active, default, recording=place.to_native())
