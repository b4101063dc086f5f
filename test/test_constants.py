# SPDX-License-Identifier: Apache-2.0
"""Stamps in nanoseconds and durations in seconds: there and back, with times since 1970 too."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.constants import ns_after, seconds_between, seconds_since, to_ns, to_seconds

stamps = st.integers(0, 4 * 10**18)  # ns: until 2096
durations = st.integers(-(10**13), 10**13)  # ns: some hours, whose seconds a double tells apart by ns


@given(stamp_ns=stamps, duration_ns=durations)
def test_a_duration_goes_there_and_back(stamp_ns: int, duration_ns: int) -> None:
    seconds = seconds_between(stamp_ns, stamp_ns + duration_ns)
    assert seconds == to_seconds(duration_ns) == pytest.approx(duration_ns / 1e9, rel=1e-15)
    assert to_ns(seconds) == duration_ns
    assert ns_after(stamp_ns, seconds) == stamp_ns + duration_ns


@given(stamp_ns=stamps, later_ns=st.lists(durations, max_size=4))
def test_many_are_each_to_rounding(stamp_ns: int, later_ns: list[int]) -> None:
    found = seconds_since(stamp_ns, [stamp_ns + later for later in later_ns])
    assert found.shape == (len(later_ns),)
    assert found.tolist() == pytest.approx([to_seconds(later) for later in later_ns], rel=1e-15)


def test_the_nearest_nanosecond_is_taken() -> None:
    assert to_ns(1.4e-9) == 1
    assert to_ns(-1.6e-9) == -2
    assert ns_after(1_700_000_000_000_000_001, 1e-9) == 1_700_000_000_000_000_002
