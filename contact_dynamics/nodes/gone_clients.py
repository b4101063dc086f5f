# SPDX-License-Identifier: Apache-2.0
"""Remembers which clients seemed gone, for a short time, on the monotonic clock."""

from __future__ import annotations

import time
from typing import NamedTuple


class _Gone(NamedTuple):
    since_ns: int  # since the epoch by this machine's clock, by which requests are stamped
    noted: float  # s, by a clock that only goes forward


class GoneClients:
    """Clients that seemed gone when an answer was sent to them.

    Attributes:
        gone_for: s for which such a client gets no answers to what it asked before.
    """

    def __init__(self, gone_for: float) -> None:
        """Begin with none."""
        self.gone_for = gone_for
        self._gone: dict[bytes, _Gone] = {}

    @property
    def are_none(self) -> bool:
        """Whether no client seemed gone a short time ago."""
        if self._gone:
            self._forget_old(time.monotonic())
        return not self._gone

    def note(self, client: bytes) -> None:
        """Note that a client seems gone, and forget those of whom that was noted long ago."""
        now = time.monotonic()
        self._forget_old(now)
        self._gone[client] = _Gone(time.time_ns(), now)

    def has(self, client: bytes, *, asked_ns: int) -> bool:
        """Tell whether a client asked before it seemed gone, a short time ago. Who asks later is there."""
        gone = self._gone.get(client)
        if gone is None or time.monotonic() >= gone.noted + self.gone_for:
            return False
        return asked_ns <= gone.since_ns

    def _forget_old(self, now: float) -> None:
        self._gone = {each: gone for each, gone in self._gone.items() if now < gone.noted + self.gone_for}
