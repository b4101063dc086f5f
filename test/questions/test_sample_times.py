# SPDX-License-Identifier: Apache-2.0
"""When a trajectory is sampled: what is refused when a question is made."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.questions import AtStamps, AtTimes, UntilPlane


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: AtTimes(times=[0.0, 0.2, 0.1]), r"times\[2\] must be .*, got 0.1 s before times\[1\]"),
        (lambda: AtTimes(times=[]), "times must be at least one time.*, got none"),
        (lambda: AtStamps(stamps_ns=[]), "stamps_ns must be at least one stamp.*, got none"),
        (
            lambda: AtStamps(stamps_ns=[2_000_000_000, 0]),
            r"stamps_ns\[1\] must be .*, got 2 s before stamps_ns\[0\]",
        ),
        (
            lambda: UntilPlane(plane_point=[0, 0, 0], plane_normal=[0, 0, 1], body_point=[-1e160, 0, 0]),
            r"body_point must be at most 1e\+60.*, got 1e\+160",
        ),
        (
            lambda: UntilPlane(plane_point=[0, 0, 1e61], plane_normal=[0, 0, 1], body_point=[0, 0, 0]),
            r"plane_point must be at most 1e\+60.*, got 1e\+61",
        ),
    ],
)
def test_times_without_sense_are_refused(make: Callable[[], object], words: str) -> None:
    with pytest.raises(InvalidFieldError, match=words):
        make()


@pytest.mark.parametrize("make", [lambda n: AtTimes(times=range(n)), lambda n: AtStamps(stamps_ns=range(n))])
def test_too_many_samples_are_refused(make: Callable[[int], object]) -> None:
    make(20_000)
    with pytest.raises(TooLargeError, match="got 20001 samples"):
        make(20_001)
