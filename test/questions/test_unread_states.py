# SPDX-License-Identifier: Apache-2.0
"""States that are handed over unread: read when a question needs one, once; forgotten if it is none."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactDynamicsError
from contact_dynamics.errors import InvalidFieldError, NoStateError, StaleStateError, WrongTypeError
from contact_dynamics.questions import StateStore
from contact_dynamics.recording import BagReader, BagWriter, service_calls


def state(stamp_ns: int) -> BodyState:
    zero = (0.0, 0.0, 0.0)
    return BodyState(p_WB_W=zero, q_WB=(0.0, 0.0, 0.0, 1.0), v_WB_W=zero, w_WB_W=zero, stamp_ns=stamp_ns)


class Reads:
    """Functions that read a state, and the stamps that they were called for."""

    def __init__(self) -> None:
        self.stamps: list[int] = []

    def of(self, stamp_ns: int, *, readable: bool = True) -> Callable[[], BodyState | None]:
        def read() -> BodyState | None:
            self.stamps.append(stamp_ns)
            return state(stamp_ns) if readable else None

        return read


def store_of(reads: Reads, stamps: list[int], *, broken: frozenset[int] = frozenset()) -> StateStore:
    store = StateStore(history=1.0, timeout=1.0)
    for stamp_ns in stamps:
        store.add_unread("ball", stamp_ns, reads.of(stamp_ns, readable=stamp_ns not in broken))
    return store


def test_only_what_is_asked_for_is_read_and_only_once() -> None:
    reads = Reads()
    store = store_of(reads, [1, 3, 2, 4])
    assert [store.newest("ball").stamp_ns for _ in range(3)] == [4, 4, 4]
    assert store.around("ball", 2)[0].stamp_ns == 2
    assert reads.stamps == [4, 2]
    assert [each.stamp_ns for each in store.window("ball", store.newest("ball"), 2e-9)] == [2, 3, 4]
    assert reads.stamps == [4, 2, 3]


def test_what_cannot_be_read_is_passed_over_and_forgotten() -> None:
    reads = Reads()
    store = store_of(reads, [1, 2, 3, 4, 5], broken=frozenset({2, 4, 5}))
    assert store.newest("ball").stamp_ns == 3
    assert store.newest("ball").stamp_ns == 3
    assert reads.stamps == [5, 4, 3]
    assert [each.stamp_ns for each in store.window("ball", store.newest("ball"), 1.0)] == [1, 3]
    assert [each.stamp_ns for each in store.window("ball", store.newest("ball"), 1.0)] == [1, 3]
    assert reads.stamps == [5, 4, 3, 1, 2]


def test_the_states_around_a_stamp_are_those_that_can_be_read() -> None:
    store = store_of(Reads(), [1, 2, 4, 5, 7], broken=frozenset({2, 5}))
    earlier, later = store.around("ball", 3)
    assert later is not None
    assert (earlier.stamp_ns, later.stamp_ns) == (1, 4)
    earlier, later = store.around("ball", 5)
    assert later is not None
    assert (earlier.stamp_ns, later.stamp_ns) == (4, 7)


def test_of_a_body_whose_states_all_cannot_be_read_none_is_known() -> None:
    store = store_of(Reads(), [1, 2], broken=frozenset({1, 2}))
    with pytest.raises(NoStateError, match="2 messages received; none could be read"):
        store.newest("ball")
    with pytest.raises(NoStateError, match="2 messages received; none could be read"):
        store.around("ball", 5)


def test_no_more_are_kept_than_stated_and_the_oldest_go_first() -> None:
    reads = Reads()
    store = StateStore(history=1.0, timeout=1.0, max_states=3)
    for stamp_ns in (5, 1, 4, 2, 3):
        store.add_unread("ball", stamp_ns, reads.of(stamp_ns))
    assert [each.stamp_ns for each in store.window("ball", store.newest("ball"), 1.0)] == [3, 4, 5]


def missing(store: StateStore) -> str:
    with pytest.raises(NoStateError) as caught:
        store.newest("ball")
    with pytest.raises(NoStateError) as in_a_worker:
        store.excerpt([("ball", None, 1.0)]).newest("ball")
    assert str(in_a_worker.value) == str(caught.value)
    return str(caught.value).removeprefix("no state of 'ball': ")


def test_who_finds_no_state_is_told_how_many_came_and_what_became_of_them() -> None:
    store = StateStore(history=1.0, timeout=1.0)
    assert missing(store) == "none has been received yet"
    store.clear()
    assert missing(store) == "none has been received yet"
    store.refuse("ball", "stamp must be less, got 5 s")
    store.refuse("ball", "mass must be > 0, got -1")
    refused = "2 messages received; the last was rejected because mass must be > 0, got -1"
    assert missing(store) == refused
    store.clear()  # which changes nothing where none is kept
    assert missing(store) == refused
    for stamp_ns in (1, 2, 3):
        store.add("ball", state(stamp_ns))
    store.clear()
    assert (
        missing(store) == "5 messages received; the stored states were discarded when the clock was set back"
    )
    store.add("ball", state(9_000_000_000))
    store.add("other", state(1), now_ns=1)
    with pytest.raises(
        NoStateError, match=r"6 messages received; .* when the clock turned out to be behind their stamps"
    ):
        store.newest("ball", now_ns=1)


def stale(store: StateStore, *, now_ns: int) -> str:
    with pytest.raises(StaleStateError) as caught:
        store.newest("ball", now_ns=now_ns)
    with pytest.raises(StaleStateError) as in_a_worker:
        store.excerpt([("ball", None, 1.0)], now_ns=now_ns).newest("ball", now_ns=now_ns)
    assert str(in_a_worker.value) == str(caught.value)
    return str(caught.value)


def test_a_state_that_is_too_old_says_whether_newer_ones_were_rejected() -> None:
    store = StateStore(history=1.0, timeout=1.0)
    store.add("ball", state(1))
    assert "rejected" not in stale(store, now_ns=2_000_000_000)
    store.refuse("ball", "header.frame_id must be 'world', got 'map'")
    assert stale(store, now_ns=2_000_000_000).endswith(
        "must be at most 1 s old (state_timeout), got 2.000 s; "
        "later messages were rejected, the last because header.frame_id must be 'world', got 'map'"
    )
    store.refuse("ball", "it is NaN", now_ns=1_500_000_000)
    assert stale(store, now_ns=8_000_000_000).endswith("were rejected, the last 6.5 s ago because it is NaN")
    store.add("ball", state(2))
    assert "rejected" not in stale(store, now_ns=2_000_000_000)
    store.add_unread("ball", 3, lambda: store.refuse("ball", "it is NaN", was_kept=True))
    assert stale(store, now_ns=2_000_000_000).endswith("the last because it is NaN")


def test_a_state_that_is_too_old_says_whether_it_was_when_it_came() -> None:
    store = StateStore(history=9.0, timeout=1.0)
    store.add("ball", state(4_000_000_000), now_ns=4_500_000_000)
    assert stale(store, now_ns=6_000_000_000).endswith("got 2.000 s")
    store.add("ball", state(1_000_000_000), now_ns=6_000_000_000)
    assert stale(store, now_ns=7_000_000_000).endswith(
        "got 3.000 s; the last message was 5.0 s old when it was received: do the clocks agree?"
    )
    store.refuse("ball", "it is NaN")
    assert stale(store, now_ns=7_000_000_000).endswith("were rejected, the last because it is NaN")


def test_of_unread_states_the_last_one_that_came_says_why_it_was_rejected() -> None:
    """They are read from the newest back, and one that came before a good one is no later message."""
    second_ns = 1_000_000_000
    store = StateStore(history=9.0, timeout=1.0)

    def add(at: int, reason: str = "") -> None:
        def read() -> BodyState | None:
            if not reason:
                return state(at * second_ns)
            store.refuse("ball", reason, was_kept=True, now_ns=at * second_ns)
            return None

        store.add_unread("ball", at * second_ns, read, now_ns=at * second_ns)

    add(1)
    add(2, "it is NaN")
    add(3, "it is NaN")
    add(4, "it is in another frame")
    told = stale(store, now_ns=5 * second_ns)
    assert told.endswith("later messages were rejected, the last 1.0 s ago because it is in another frame")
    add(5, "it is NaN")
    add(6)
    newest = store.newest("ball")
    assert len(store.window("ball", newest, 9.0)) == 2
    assert stale(store, now_ns=9 * second_ns).endswith("got 3.000 s")
    assert store.arrivals("ball").rejected == 4


def known_of(store: StateStore, stamp_ns: int | None, seconds: float, now_ns: int | None) -> object:
    """What a question finds: the states of its window and the one after its stamp, or why there is none."""
    try:
        if stamp_ns is None:
            newest, later = store.newest("ball", now_ns=now_ns), None
        else:
            newest, later = store.around("ball", stamp_ns, now_ns=now_ns)
    except ContactDynamicsError as error:
        return str(error)
    window = [each.stamp_ns for each in store.window("ball", newest, seconds)]
    return newest.stamp_ns, None if later is None else later.stamp_ns, window


def test_an_excerpt_answers_as_the_whole() -> None:
    """Windows that end between, at, before and after states; unreadable ones, and some ahead of the clock."""
    rng = np.random.default_rng(24)
    kinds = set()
    for _ in range(2000):
        stamps = [int(each) for each in rng.integers(100, 160, size=rng.integers(0, 12))]
        broken = (
            frozenset(int(each) for each in rng.choice(stamps, size=len(stamps) // 4)) if stamps else set()
        )
        stamp_ns = None if rng.random() < 0.3 else int(rng.integers(90, 170))
        now_ns = None if rng.random() < 0.3 else int(rng.integers(130, 200))
        seconds = 1e-9 * int(rng.integers(0, 40))
        whole, other = (
            StateStore(history=30e-9, timeout=20e-9, future_tolerance=5e-9, max_states=10) for _ in range(2)
        )
        for store in (whole, other):
            for each in stamps:
                store.add_unread("ball", each, Reads().of(each, readable=each not in broken))
        expected = known_of(whole, stamp_ns, seconds, now_ns)
        part = other.excerpt([("ball", stamp_ns, seconds)], now_ns=now_ns)
        assert known_of(part, stamp_ns, seconds, now_ns) == expected
        if not broken and now_ns is None and isinstance(expected, tuple):
            assert other.count("ball", stamp_ns, seconds) >= len(expected[2])
        kinds.add(type(expected))
    assert kinds == {str, tuple}


LIMITS = {"history": 5.0, "timeout": 0.5}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("history", b"ab"),
        ("history", "5"),
        ("history", -5.0),
        ("timeout", None),
        ("timeout", math.inf),
        ("future_tolerance", math.nan),
        ("max_states", "3"),
        ("max_states", 0),
    ],
)
def test_a_limit_that_is_none_is_rejected_by_name(name: str, value: Any) -> None:
    with pytest.raises(InvalidFieldError, match=name):
        StateStore(**{**LIMITS, name: value})


@pytest.mark.parametrize(
    ("method", "arguments", "name"),
    [
        ("add", ("brick", 1), "state"),
        ("add", (1, None), "body_name"),
        ("newest", (None,), "body_name"),
        ("window", ("brick", "newest", 1.0), "newest"),
    ],
)
def test_a_wrong_type_is_rejected_by_name(method: str, arguments: tuple[Any, ...], name: str) -> None:
    with pytest.raises(WrongTypeError, match=f"{name} must be"):
        getattr(StateStore(**LIMITS), method)(*arguments)


@pytest.mark.parametrize(
    ("function", "name"), [(BagReader, "path"), (BagWriter, "folder"), (service_calls, "messages")]
)
def test_a_log_is_rejected_by_name(function: Any, name: str) -> None:
    with pytest.raises(WrongTypeError, match=f"{name} must be"):
        function(3)
