# SPDX-License-Identifier: Apache-2.0
"""States are drawn as often as they may cost."""

from __future__ import annotations

import time

import pytest

from contact_dynamics.viewing.states_in_turn import LONGEST_S, SHARE, SHORTEST_S, Pace, wait_after


@pytest.mark.parametrize(
    ("took", "wait"),
    [
        (0.0, SHORTEST_S),
        (0.9 * SHARE * SHORTEST_S, SHORTEST_S),
        (SHARE * 0.2, 0.2),
        (1.1 * SHARE * LONGEST_S, LONGEST_S),
        (10.0, LONGEST_S),
    ],
)
def test_a_drawing_has_its_share_of_the_time(took: float, wait: float) -> None:
    assert wait_after(took) == pytest.approx(wait)


def test_a_dear_drawing_lets_the_next_wait() -> None:
    pace = Pace()
    assert pace.is_due
    with pace.drawing():
        until = time.thread_time() + SHARE * 0.3
        while time.thread_time() < until:
            pass
    drawn = time.monotonic()
    assert 0.3 <= pace.wait_s <= LONGEST_S
    if time.monotonic() < drawn + 0.1:  # the machine did not stand still
        assert not pace.is_due
    time.sleep(pace.wait_s)
    assert pace.is_due


def test_a_drawing_that_fails_counts_too() -> None:
    pace = Pace()
    with pytest.raises(RuntimeError), pace.drawing():
        raise RuntimeError
    assert pace.wait_s == SHORTEST_S
