# SPDX-License-Identifier: Apache-2.0
"""Arrangements of views cost nothing that lasts, however many are sent, and the newest holds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import rerun as rr
from rerun.chunk import RrdReader

from contact_dynamics.viewing.blueprint import make_blueprint
from contact_dynamics.viewing.kept_recording import KeptRecording

if TYPE_CHECKING:
    import pytest

MANY = 20


def threads() -> int:
    """How many threads this process has."""
    return len(list(Path("/proc/self/task").iterdir()))


def test_further_arrangements_cost_no_threads(tmp_path: Path) -> None:
    """With `rr.send_blueprint` there were two more after each."""
    recording = KeptRecording()
    recording.open(rr.FileSink(tmp_path / "picture.rrd", write_footer=False))
    recording.send_blueprint(make_blueprint(["brick"], eye=None, shown=set()))
    before = threads()
    for number in range(MANY):
        recording.send_blueprint(make_blueprint([f"brick_{number}"], eye=None, shown=set()))
    assert threads() < before + MANY // 2
    recording.disconnect()


def test_each_place_gets_the_newest_arrangement(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    """All are one blueprint of rerun's, so that a viewer shows the newest and keeps no others beside it."""
    paths = [tmp_path / "early.rrd", tmp_path / "late.rrd"]
    recording = KeptRecording()
    recording.open(rr.FileSink(paths[0], write_footer=False))
    for number in range(3):
        recording.send_blueprint(make_blueprint([f"brick_{number}"], eye=None, shown=set()))
    recording.open(rr.FileSink(paths[1], write_footer=False))
    recording.disconnect()
    early, late = (RrdReader(path).blueprints() for path in paths)
    assert len(early) == len(late) == 1
    assert early[0].recording_id == late[0].recording_id
    recwarn.clear()  # files without an index are read whole
