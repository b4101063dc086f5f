# SPDX-License-Identifier: Apache-2.0
"""Watches whether the states of each body come and are kept, as `/diagnostics` reports it."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from contact_dynamics.nodes.situations import RECENT_S, Present, Situation

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.nodes.state_subscriptions import StateTopic
    from contact_dynamics.nodes.world_parameters import BodySources
    from contact_dynamics.questions.state_store import Arrivals


class BodyWatch:
    """The watch on one body.

    A topic can be as lively as ever while one of the bodies on it is gone, or while the states of a body are
    rejected.
    """

    def __init__(
        self,
        sources: BodySources,
        topics: Mapping[str, StateTopic],
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Begin to watch.

        Args:
            sources: the sources of the body's states.
            topics: the subscriptions, by the full names of their topics.
            clock: returns seconds.
        """
        self._name = sources.body_name
        self._sources = [[topics[each.full_name] for each in source.topics] for source in sources.sources]
        self._topics = [topic for source in self._sources for topic in source]
        self._clock = clock
        self._came = self._rejected = self._old = 0  # states, at the last look
        self._came_at = self._kept_at = clock()  # when that was noticed, s; at the beginning, when this began
        self._rejected_at = -RECENT_S
        self._is_old = False

    def look(self, arrivals: Arrivals, *, silent_after: float, awake_for: float) -> list[Present]:
        """Look, once a second, at what came of the body; return what is wrong.

        Args:
            arrivals: what became of its states.
            silent_after: s without a state, from which on that is wrong.
            awake_for: s, for how long this process has run without standing still.
        """
        now = self._clock()
        came, rejected = arrivals.came - self._came, arrivals.rejected - self._rejected
        old, kept = arrivals.old - self._old, came - rejected
        self._came, self._rejected, self._old = arrivals.came, arrivals.rejected, arrivals.old
        if came:
            self._came_at = now
        if rejected:
            self._rejected_at = now
        if kept > 0:
            self._kept_at, self._is_old = now, old >= kept
        silence = min(now - self._came_at, awake_for)
        return [
            *self._of_sources(),
            *self._of_rejections(arrivals, now),
            *self._of_age(arrivals),
            *(self._of_silence(arrivals) if silence > silent_after else []),
        ]

    def _of_sources(self) -> list[Present]:
        published = [source[0] for source in self._sources if source[0].publishers]
        if len(published) < 2:
            return []
        names = " and ".join(topic.name for topic in published)
        publishers = sum(topic.publishers for topic in published)
        return [Situation.SEVERAL_PUBLISHERS.present(topic=names, publishers=publishers)]

    def _of_rejections(self, arrivals: Arrivals, now: float) -> list[Present]:
        is_none_kept = arrivals.came == arrivals.rejected or now - self._kept_at > RECENT_S
        if arrivals.newest_is_rejected and is_none_kept:
            return [Situation.ALL_REJECTED.present(body=self._name, reason=arrivals.reason)]
        if now - self._rejected_at < RECENT_S:
            return [Situation.SOME_REJECTED.present(body=self._name, reason=arrivals.reason)]
        return []

    def _of_age(self, arrivals: Arrivals) -> list[Present]:
        return [Situation.OLD.present(body=self._name, age=arrivals.age)] if self._is_old else []

    def _of_silence(self, arrivals: Arrivals) -> list[Present]:
        names = " and ".join(dict.fromkeys(topic.name for topic in self._topics))
        if not arrivals.came and names:
            publishers = sum(topic.publishers for topic in self._topics)
            return [Situation.NO_STATE_YET.present(body=self._name, topics=names, publishers=publishers)]
        if any(topic.traffic.is_silent for topic in self._topics) or not names:
            return []
        return [Situation.BODY_SILENT.present(body=self._name, topics=names)]
