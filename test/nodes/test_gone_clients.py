# SPDX-License-Identifier: Apache-2.0
"""Clients that seemed gone get no answers for a short time, whatever happens to the machine's clock."""

from __future__ import annotations

import time

import pytest

from contact_dynamics.nodes.calls import GoneClients

HOUR_NS = 3_600_000_000_000
CLIENT = b"one"


def test_what_was_asked_before_gets_no_answer_and_what_is_asked_later_does() -> None:
    gone = GoneClients(60.0)
    asked_ns = time.time_ns()
    gone.note(CLIENT)
    assert gone.has(CLIENT, asked_ns=asked_ns)
    assert not gone.has(CLIENT, asked_ns=asked_ns + HOUR_NS)
    assert not gone.has(b"another", asked_ns=asked_ns)


def test_a_clock_that_is_set_back_by_an_hour_silences_nobody_for_an_hour(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gone = GoneClients(0.01)
    with monkeypatch.context() as patch:
        ahead_ns = time.time_ns() + HOUR_NS
        patch.setattr(time, "time_ns", lambda: ahead_ns)
        gone.note(CLIENT)
    time.sleep(0.02)
    assert not gone.has(CLIENT, asked_ns=time.time_ns())
