# SPDX-License-Identifier: Apache-2.0
"""Waiting that a process which stood still has not done."""

from __future__ import annotations

import time

from contact_dynamics.demo.patience import MAX_OF_A_LOOK_S, Patience


def test_a_stall_counts_as_one_look() -> None:
    patience = Patience(2.0 * MAX_OF_A_LOOK_S)
    time.sleep(5.0 * MAX_OF_A_LOOK_S)
    patience.look()
    assert not patience.is_over


def test_looks_that_find_nothing_end_it_in_its_time() -> None:
    seconds = 2.0 * MAX_OF_A_LOOK_S
    patience, begun = Patience(seconds), time.monotonic()
    while not patience.is_over:
        time.sleep(0.1 * MAX_OF_A_LOOK_S)
        patience.look()
    assert time.monotonic() - begun >= seconds
