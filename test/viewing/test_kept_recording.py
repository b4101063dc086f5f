# SPDX-License-Identifier: Apache-2.0
"""A place that is opened late gets what stands in the picture, on all timelines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rerun as rr

from contact_dynamics.viewing.blueprint import make_blueprint
from contact_dynamics.viewing.kept_recording import LAST_BATCHES, LAST_S, LAST_WORDS, KeptRecording
from contact_dynamics.viewing.measured import set_time, time_column
from contact_dynamics.viewing.picture import Picture
from viewing.answers import contact_mode_answer, tumbling_answer
from viewing.drawn import STAMP_NS, Drawn, read_drawn
from viewing.known import STATE, TRAJECTORY, TWO_CONTACTS, WORLD
from viewing.test_picture import an_impact, moved


class Places:
    """A recording with places that are files."""

    def __init__(self, folder: Path) -> None:
        self.recording = KeptRecording()
        self._folder = folder
        self._count = 0

    def open(self) -> Path:
        self._count += 1
        path = self._folder / f"{self._count}.rrd"
        self.recording.open(rr.FileSink(path))
        return path

    def read(self, *paths: Path) -> list[Drawn]:
        self.recording.disconnect()
        return [read_drawn(path) for path in paths]


@pytest.fixture
def places(tmp_path: Path) -> Places:
    return Places(tmp_path)


def test_a_late_place_has_the_whole_picture(places: Places) -> None:
    """Of each entity and component, the newest values are those of the place that was there all the time."""
    early = places.open()
    picture = Picture(places.recording, WORLD, surface_side=0.5)
    for i in range(3):
        at_ns = STAMP_NS + 1000 * i
        picture.add_states("brick", [moved(STATE, at_ns), moved(STATE, at_ns + 1)])
        picture.show(tumbling_answer(moved(STATE, at_ns + 2), TRAJECTORY))
        picture.show(an_impact(STATE, TWO_CONTACTS, stamp_ns=at_ns + 3))
        picture.show(contact_mode_answer(moved(STATE, at_ns + 4), TWO_CONTACTS))
    late = places.open()
    picture.add_states("brick", [moved(STATE, STAMP_NS + 5000)])
    first, second = places.read(early, late)
    assert second.blueprints == 1
    drawn = {key for key in first.values if key[0] != "/__properties" and not key[1].startswith("Clear")}
    assert drawn <= set(second.values)
    for key in drawn:
        assert str(second.last(*key)) == str(first.last(*key)), key
        assert second.stamps(*key)[-1] == first.stamps(*key)[-1], key
    assert second.values["/answers/log", "TextLog:text"] == first.values["/answers/log", "TextLog:text"]
    trail = ("/world/trails/brick", "LineStrips3D:strips")
    assert second.values[trail] == first.values[trail]


def test_what_was_cleared_is_not_drawn_again(places: Places) -> None:
    recording = places.recording
    set_time(recording, STAMP_NS)
    for path in ("a", "a/b", "ab", "c"):
        recording.log(path, rr.Points3D([[1.0, 2.0, 3.0]]))
    recording.log("a", rr.Clear(recursive=True))
    recording.log("c", rr.Clear(recursive=False))
    (drawn,) = places.read(places.open())
    assert {path for path, _ in drawn.values if not path.startswith("/__")} == {"/ab"}


def test_what_is_clear_is_not_cleared_again(places: Places) -> None:
    """An earlier stamp is not clear, nor is what was drawn since, also below the path."""
    path, recording = places.open(), places.recording
    point = rr.Points3D([[1.0, 2.0, 3.0]])
    for after, drawn_at in ((0, "a/b"), (1, ""), (2, ""), (3, "a"), (4, "a/b/c"), (3, ""), (5, "elsewhere")):
        set_time(recording, STAMP_NS + after)
        if drawn_at:
            recording.log(drawn_at, point)
        recording.log("a", rr.Clear(recursive=True))
    (drawn,) = places.read(path)
    stamps = drawn.stamps("/a", "Clear:is_recursive")
    assert [stamp - STAMP_NS for stamp in stamps] == [0, 3, 3, 4]


def test_a_gap_between_batches_stays(places: Places) -> None:
    recording = places.recording
    for first in (0, 10):
        column = rr.Scalars.columns(scalars=[1.0, 2.0])
        recording.send_columns(
            "c", indexes=[time_column([STAMP_NS + first, STAMP_NS + first + 1])], columns=column
        )
        set_time(recording, STAMP_NS + first + 2)
        recording.log("c", rr.Clear(recursive=False))
    (drawn,) = places.read(places.open())
    assert [stamp - STAMP_NS for stamp in drawn.stamps("/c", "Scalars:scalars")] == [0, 1, 10, 11]
    assert [stamp - STAMP_NS for stamp in drawn.stamps("/c", "Clear:is_recursive")] == [2, 12]


def test_what_is_kept_is_bounded(places: Places) -> None:
    recording = places.recording
    for i in range(LAST_WORDS + 50):
        set_time(recording, STAMP_NS + i)
        recording.log("words", rr.TextLog(str(i)))
        recording.log("thing", rr.Points3D([[float(i), 0.0, 0.0]]))
        column = rr.Scalars.columns(scalars=[float(i)])
        recording.send_columns("curve", indexes=[time_column([STAMP_NS + i])], columns=column)
    (drawn,) = places.read(places.open())
    assert len(drawn.values["/words", "TextLog:text"]) == LAST_WORDS
    assert len(drawn.values["/curve", "Scalars:scalars"]) == LAST_BATCHES
    assert drawn.values["/thing", "Points3D:positions"] == [
        (STAMP_NS + LAST_WORDS + 49, [[LAST_WORDS + 49, 0, 0]])
    ]


def test_the_last_seconds_of_a_curve_are_kept_and_come_in_one_piece(places: Places) -> None:
    """A viewer that comes back gets one chunk of a curve, instead of one for each batch."""
    from rerun.chunk import RrdReader

    recording = places.recording
    stamps_ns = [STAMP_NS + 100_000_000 * i for i in range(50)]
    for i, stamp_ns in enumerate(stamps_ns):
        column = rr.Scalars.columns(scalars=[float(i), i + 0.5])
        recording.send_columns("curve", indexes=[time_column([stamp_ns, stamp_ns + 1])], columns=column)
    path = places.open()
    (drawn,) = places.read(path)
    begin_ns = stamps_ns[-1] + 1 - int(1e9 * LAST_S)
    kept = [i for i, stamp_ns in enumerate(stamps_ns) if stamp_ns + 1 >= begin_ns]
    assert len(kept) == 21
    values = [value for i in kept for value in ([float(i)], [i + 0.5])]
    assert [value for _, value in drawn.values["/curve", "Scalars:scalars"]] == values
    chunks = [chunk for chunk in RrdReader(path).stream() if str(chunk.entity_path) == "/curve"]
    assert len(chunks) == 1


def test_a_place_without_sinks_gets_nothing_and_opened_anew_what_stands(
    places: Places, tmp_path: Path
) -> None:
    paths = [tmp_path / name for name in ("before.rrd", "after.rrd")]
    place = places.recording.open(rr.FileSink(paths[0]))
    for name, sinks in (("a", []), ("b", [rr.FileSink(paths[1])]), ("c", None)):
        places.recording.log(name, rr.Points3D([[1.0, 2.0, 3.0]]), static=True)
        if sinks is not None:
            places.recording.reopen(place, *sinks)
    before, after = places.read(*paths)
    assert before.entities & {"/a", "/b", "/c"} == {"/a"}
    assert after.entities & {"/a", "/b", "/c"} == {"/a", "/b", "/c"}


def test_time_counts_from_the_first_stamp_and_events_in_the_order_they_came(places: Places) -> None:
    from rerun.chunk import RrdReader

    path, recording = places.open(), places.recording
    column = rr.Scalars.columns(scalars=[1.0, 2.0])
    recording.send_columns("states", indexes=[time_column([STAMP_NS, STAMP_NS + 4])], columns=column)
    set_time(recording, STAMP_NS + 3)  # an answer that came after the states, about an earlier one
    recording.log("answer", rr.Points3D([[1.0, 2.0, 3.0]]))
    recording.send_blueprint(make_blueprint([], eye=None))
    recording.disconnect()
    found: dict[tuple[str, str], list[int]] = {}
    for chunk in RrdReader(path).stream():
        batch = chunk.to_record_batch()
        for name in ("stamp", "time since start", "order of events"):
            if name in batch.schema.names:
                found[str(chunk.entity_path), name] = batch.column(name).cast("int64").to_pylist()
    assert found["/states", "stamp"] == [STAMP_NS, STAMP_NS + 4]
    assert found["/states", "time since start"] == [0, 4]
    assert found["/answer", "time since start"] == [3]
    (answer,) = found["/answer", "order of events"]
    assert np.all(np.array(found["/states", "order of events"]) < answer)
