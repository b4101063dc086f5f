# SPDX-License-Identifier: Apache-2.0
"""Counters of the faults of topics with states, and warnings about them.

Faults are rejected messages, lost messages, silent topics, and several publishers of one body's states.
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact_dynamics.nodes.situations import RECENT_S, FaultLimits, Present, Situation
from msg_adapters.status import short

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.nodes.inbox import Taken


class TopicFaults:
    """Counts faults by topic and kind, and issues throttled warnings.

    The throttle of ROS has one clock for each line of code, so the faults of one topic would hide all others.

    Attributes:
        limits: The throttle of warnings, which may be replaced.
        clock: Returns the time, s, on a clock that does not jump.
    """

    def __init__(
        self,
        tell: Callable[[str], object],
        *,
        inform: Callable[[str], object] | None = None,
        limits: FaultLimits | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Create counters with the value zero.

        ``tell`` logs warnings; ``inform`` logs other messages, which are not logged by default.
        """
        self.inform: Callable[[str], object] = inform or (lambda _: None)
        self.limits = limits or FaultLimits()
        self._tell = tell
        self.clock = clock
        self._counts: Counter[tuple[str, str]] = Counter()
        self._told: dict[tuple[str, str], float] = {}

    @property
    def counts(self) -> Mapping[tuple[str, str], int]:
        """The numbers of faults, by topic and kind."""
        return self._counts

    def refuse(self, topic: str, error: Exception) -> None:
        """Count a rejected message, and issue a throttled warning with the reason."""
        kind = f"{type(error).__name__} {getattr(error, 'field', '')}".rstrip()
        self.add(topic, kind, 1, f"message ignored: {short(str(error))}")

    def add(self, topic: str, kind: str, count: int, text: str) -> None:
        """Count faults of a kind, and issue a throttled warning."""
        key = (topic, kind)
        self._counts[key] += count
        now = self.clock()
        told = self._told.get(key)
        if told is not None and now - told < self.limits.warn_every:
            return
        self._told[key] = now
        self._tell(f"{topic}: {text} ({self._counts[key]} such so far)")


@dataclass(slots=True, kw_only=True)
class TopicTraffic:
    """Statistics of a topic."""

    topic: str  # the topic
    faults: TopicFaults
    one_publisher: bool  # whether its messages should come from a single publisher
    may_rest: bool = False  # whether the topic may be silent, as that of static transforms
    received: int = 0  # number of received messages
    lost: int = 0  # number of lost messages, from the sequence numbers of received ones
    # s, age of the latest message at the last check, or None before the first message
    age: float | None = None
    rate: float = 0.0  # Hz, rate of messages between the last two checks
    is_silent: bool = False  # whether the topic had become silent at the last check
    _newest: float = 0.0
    _number: int | None = None
    _is_steady: bool = True
    _looked: float | None = None
    _received_before: int = 0
    _lost_at: float | None = None

    def note(self, taken: Taken) -> None:
        """Count a message, and the lost messages before it."""
        self.received += 1
        self._newest = self.faults.clock()
        number, before = taken.number, self._number
        self._number = number
        if number is None or before is None or number == before + 1:
            return
        if number <= before:  # a restarted publisher, or a second one
            self._is_steady = False
        elif self._is_steady and self.one_publisher:
            missing = number - before - 1
            self.lost += missing
            self._lost_at = self._newest
            self.faults.add(self.topic, "lost", missing, "messages were lost before they were received")

    def look(self, publishers: int, *, awake_for: float) -> list[Present]:
        """Check silence and the number of ``publishers``, once a second; return the present situations.

        ``awake_for`` is the time, s, for which this process has run without being stopped.
        """
        present: list[Present] = []
        self._is_steady = publishers <= 1
        if self.one_publisher and publishers > 1:
            self.faults.add(self.topic, "publishers", 1, f"{publishers} publishers send states of one body")
            present.append(Situation.SEVERAL_PUBLISHERS.present(topic=self.topic, publishers=publishers))
        if not self.received:
            return present
        now = self.faults.clock()
        if self._lost_at is not None and now - self._lost_at < RECENT_S:
            present.append(Situation.LOST.present(topic=self.topic, count=self.lost))
        if self._looked is not None:
            self.rate = (self.received - self._received_before) / max(now - self._looked, 1e-9)
        self._looked, self._received_before = now, self.received
        self.age = now - self._newest
        silence = min(self.age, awake_for)  # during which the process could receive messages
        is_quiet = silence > self.faults.limits.silent_after
        was_silent, self.is_silent = self.is_silent, is_quiet and not self.may_rest
        if self.is_silent and not was_silent:
            if publishers:
                self.faults.add(self.topic, "silent", 1, f"nothing came for {silence:.1f} s")
            else:
                self.faults.inform(f"{self.topic}: nobody publishes any more")
        if self.is_silent:
            present.append(Situation.SILENT.present(topic=self.topic))
        return present
