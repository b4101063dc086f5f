# SPDX-License-Identifier: Apache-2.0
"""What is wrong with the topics of states: counted by topic and kind, and told from time to time.

It is a message that is refused, messages that got lost on the way, a topic that fell silent, and a body whose
states come from two publishers.
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
    """Counts faults by topic and kind, and warns of them.

    The throttle of ROS has one clock for each line of code, so one topic's fault would hide all others.

    Attributes:
        limits: When faults are told. They may be replaced.
        clock: Returns seconds. It does not jump when somebody sets the machine's clock.
    """

    def __init__(
        self,
        tell: Callable[[str], object],
        *,
        inform: Callable[[str], object] | None = None,
        limits: FaultLimits | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Count from zero.

        Args:
            tell: logs a warning.
            inform: logs what is not a fault. By default it is not logged.
            limits: when faults are reported.
            clock: returns seconds.
        """
        self.inform: Callable[[str], object] = inform or (lambda _: None)
        self.limits = limits or FaultLimits()
        self._tell = tell
        self.clock = clock
        self._counts: Counter[tuple[str, str]] = Counter()
        self._told: dict[tuple[str, str], float] = {}

    @property
    def counts(self) -> Mapping[tuple[str, str], int]:
        """How many faults there were, by topic and kind."""
        return self._counts

    def refuse(self, topic: str, error: Exception) -> None:
        """Count a message that was refused, and warn with the reason, unless it has just warned of it."""
        kind = f"{type(error).__name__} {getattr(error, 'field', '')}".rstrip()
        self.add(topic, kind, 1, f"message ignored: {short(str(error))}")

    def add(self, topic: str, kind: str, count: int, text: str) -> None:
        """Count faults of a kind, and warn of them, unless it has just warned of it."""
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
    """What came on a topic, and what did not.

    Attributes:
        topic: The topic.
        one_publisher: Whether its messages should come from a single publisher.
        may_rest: Whether nothing has to come, as where transforms are told once that stand still.
        received: How many messages came.
        lost: How many did not, as the numbers of those that came tell.
        age: s, since the newest message, at the last look. None while none came.
        rate: Hz, of the messages between the last two looks.
        is_silent: Whether nothing came for a while at the last look, where something had come before.
    """

    topic: str
    faults: TopicFaults
    one_publisher: bool
    may_rest: bool = False
    received: int = 0
    lost: int = 0
    age: float | None = None
    rate: float = 0.0
    is_silent: bool = False
    _newest: float = 0.0
    _number: int | None = None
    _is_steady: bool = True
    _looked: float | None = None
    _received_before: int = 0
    _lost_at: float | None = None

    def note(self, taken: Taken) -> None:
        """Note a message, and tell of those that are missing before it."""
        self.received += 1
        self._newest = self.faults.clock()
        number, before = taken.number, self._number
        self._number = number
        if number is None or before is None or number == before + 1:
            return
        if number <= before:  # a publisher that was started again, or a second one
            self._is_steady = False
        elif self._is_steady and self.one_publisher:
            missing = number - before - 1
            self.lost += missing
            self._lost_at = self._newest
            self.faults.add(self.topic, "lost", missing, "messages were lost before they were received")

    def look(self, publishers: int, *, awake_for: float) -> list[Present]:
        """Look, once a second, at who publishes and for how long nothing came; return what is wrong.

        Args:
            publishers: how many publish on the topic.
            awake_for: s, for how long this process has run without standing still.
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
        silence = min(self.age, awake_for)  # in which the process could have heard something
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
