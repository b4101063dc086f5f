# SPDX-License-Identifier: Apache-2.0
"""The line on the terminal that says how far long work is."""

from __future__ import annotations

import io

import pytest

from contact_dynamics.replay import progress as module


class Terminal(io.StringIO):
    """What somebody watches."""

    def isatty(self) -> bool:
        return True


def told(monkeypatch: pytest.MonkeyPatch, seen: io.StringIO, **extent: float) -> str:
    """What is printed of work that tells at 0, 10 and 20 s that it is at 2, 5 and 10, and then ends."""
    times = iter([0.0, 0.0, 10.0, 20.0])
    monkeypatch.setattr(module.time, "monotonic", lambda: next(times))
    monkeypatch.setattr("sys.stderr", seen)
    line = module.Progress("log", **extent)
    for at in (2, 5, 10):
        line.tell(at, f"{at} messages")
    line.end()
    return seen.getvalue()


def test_a_line_shows_the_share_and_the_time_left_and_is_cleared(monkeypatch: pytest.MonkeyPatch) -> None:
    first, second, cleared = told(monkeypatch, Terminal(), end=10).split("\r\033[K")[
        1:
    ]  # not within half a second
    assert first == f"log: {12 * '#':24}  50 %, 10 s left, 5 messages"
    assert second == f"log: {24 * '#'} 100 %, 0 s left, 10 messages"
    assert cleared == ""


def test_without_a_known_end_there_is_no_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "log: 5 messages" in told(monkeypatch, Terminal())


def test_nobody_watches_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch, io.StringIO(), end=10) == ""
