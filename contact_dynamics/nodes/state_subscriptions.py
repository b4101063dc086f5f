# SPDX-License-Identifier: Apache-2.0
"""Subscriptions to published states, which log each message and store it as a state.

The log receives the serialized messages unchanged. Decoding a message into a state takes forty times as long
as receiving it. If each message is a state by itself, only its stamp is therefore read until a question
requires the state. The first message of a topic is decoded at once, then one every half second, and each
whose length or frame differs from the last decoded one, so that faults are reported even without questions.
"""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from rclpy.qos import DurabilityPolicy, QoSCompatibility, QoSProfile, qos_check_compatible
from rclpy.serialization import deserialize_message

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.situations import RECENT_S, Present, Situation
from contact_dynamics.nodes.state_sources import no_message
from contact_dynamics.nodes.topic_faults import TopicFaults, TopicTraffic
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.recording.cdr import leading_stamp_ns
from contact_dynamics.recording.message_types import message_class
from msg_adapters.rejected_fields import check_numbers, in_fields

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo

    from contact_dynamics.nodes.inbox import InboxNode, Taken
    from contact_dynamics.nodes.state_sources import BodyReader, StateSource
    from contact_dynamics.nodes.world_parameters import BodySources
    from contact_dynamics.questions.state_store import Arrivals, ReadState
    from contact_dynamics.questions.uncertain_state import KnownState

STATE_QOS = QoSProfile(depth=1000)
"""Queue of a topic with states, which is enough for 1 s at 1 kHz if the process is stalled."""

LATCHED_QOS = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Queue of static transforms, which receives earlier ones too."""

_EXAMINE_EVERY_NS: Final = NS_PER_S // 2
_FRAME_AT: Final = 12  # bytes before a header's frame: encapsulation and stamp


def present_ns(node: Node) -> int | None:
    """Return the present time, ns, or None before the first message of a simulation's clock."""
    clock = node.get_clock()
    now_ns: int = clock.now().nanoseconds
    return None if now_ns == 0 and clock.ros_time_is_active else now_ns


class StateTopic:
    """A topic with messages about bodies.

    Attributes:
        name: Its full name.
        type_name: The type of its messages.
        source: Its source, which converts messages to states. Another one of the same topic may replace it.
        traffic: Its statistics.
        publishers: Number of publishers, at the last check, whose messages can be received.
    """

    def __init__(
        self,
        node: InboxNode,
        source: StateSource,
        *,
        states: StateStore,
        record: Callable[[str, Taken], object],
        offered: Callable[[str, list[Any]], object],
        faults: TopicFaults,
    ) -> None:
        """Subscribe, record every message, and store every state.

        A message without a plausible state, or with a stamp in the future, is recorded and counted in
        ``faults``, but not stored. ``record`` is called with the topic and each message, and ``offered`` with
        the topic and the QoS that its publishers offer. Raise `InvalidFieldError` if the package of the
        messages is not installed.
        """
        self._node = node
        self.source = source
        self._states = states
        self._record = record
        self._faults = faults
        self._msg_type: type[Any] = message_class(source.type_name)
        self._length = 0  # length of the last decoded message
        self._frame = b""  # frame of the same message
        self._examined_ns = 0
        self.publishers = 0
        qos = LATCHED_QOS if source.is_latched else STATE_QOS
        self._subscription = node.subscribe(
            self._msg_type, source.topic, self._receive, qos, may_override=True
        )
        self.name: str = self._subscription.topic_name
        self.type_name = source.type_name
        self._publishers = OfferedQosWatch(node, self.name, offered)
        self.traffic = TopicTraffic(
            topic=self.name, faults=faults, one_publisher=source.is_of_one_body, may_rest=source.is_latched
        )

    def look(self, *, awake_for: float) -> list[Present]:
        """Check publishers and silence, once a second; return the present situations.

        ``awake_for`` is the time, s, for which this process has run without being stopped.
        """
        found = self._publishers.look()
        mismatches = [text for text in map(self._mismatch, found) if text]
        publishers = self.publishers = len(found) - len(mismatches)
        present = self.traffic.look(publishers, awake_for=awake_for)
        if mismatches:
            present.append(
                Situation.NO_MATCH.present(
                    topic=self.name, count=len(mismatches), publishers=len(found), reason=mismatches[0]
                )
            )
        return present

    def _mismatch(self, publisher: TopicEndpointInfo) -> str:
        """Return why the messages of a publisher cannot be received, or an empty text if they can."""
        if publisher.topic_type != self.type_name:
            return f"they send {publisher.topic_type}, and {self.type_name} is needed"
        offered, asked = publisher.qos_profile, self._subscription.qos_profile
        compatibility, reason = qos_check_compatible(offered, asked)
        if compatibility != QoSCompatibility.ERROR:
            return ""
        reason = reason.replace("ERROR: ", "").strip(" ;")
        return f"{reason} (see qos_overrides in config/server.yaml)"

    def _receive(self, taken: Taken) -> None:
        if not self.traffic.received:
            self._publishers.look()
        self._record(self.name, taken)
        self.traffic.note(taken)
        data, clock = taken.data, self._node.get_clock()
        now_ns = present_ns(self._node) if clock.ros_time_is_active else taken.received_ns
        try:
            if self.source.is_whole and self._is_as_before(taken):
                stamp_ns = leading_stamp_ns(data)
                for reader in self.source.readers:
                    read = partial(self._read, reader, data, now_ns)
                    self._states.add_unread(reader.body_name, stamp_ns, read, now_ns=now_ns)
                return
            msg = deserialize_message(data, self._msg_type)
            check_numbers(msg)
        except (ContactDynamicsError, RuntimeError) as error:  # bytes that are no message raise the latter
            self._refuse(error, data, *self.source.readers, now_ns=now_ns)
            return
        for reader in self.source.readers:
            self._keep(reader, msg, now_ns=now_ns, taken=taken)

    def _keep(self, reader: BodyReader, msg: object, *, now_ns: int | None, taken: Taken) -> None:
        """Store the state of one body, if a message contains or completes one."""
        try:
            state = reader.believable(msg)
            if state is not None:
                self._states.add(reader.body_name, state, now_ns=now_ns)
                self._examined_ns, self._length = taken.received_ns, len(taken.data)
                self._frame = _leading_frame(taken.data)
        except ContactDynamicsError as error:
            self._refuse(error, taken.data, reader, now_ns=now_ns)

    def _is_as_before(self, taken: Taken) -> bool:
        """Return whether a message has the length and the frame of a recently decoded one."""
        data = taken.data
        return (
            len(data) == self._length
            and data.startswith(self._frame, _FRAME_AT)
            and 0 <= taken.received_ns - self._examined_ns < _EXAMINE_EVERY_NS
        )

    def _read(self, reader: BodyReader, data: bytes, came_ns: int | None) -> KnownState | None:
        """Return the state of one body in a message, or None if the message is rejected."""
        try:
            msg = deserialize_message(data, self._msg_type)
            check_numbers(msg)
            return reader.believable(msg)
        except (ContactDynamicsError, RuntimeError) as error:  # bytes that are no message raise the latter
            self._refuse(error, data, reader, now_ns=came_ns, was_kept=True)
            return None

    def _refuse(
        self,
        error: ContactDynamicsError | RuntimeError,
        data: bytes,
        *readers: BodyReader,
        now_ns: int | None,
        was_kept: bool = False,
    ) -> None:
        """Count a rejected message, and store the reason for questions about its bodies."""
        error = in_fields(error)
        self._faults.refuse(self.name, error)
        is_message = isinstance(error, ContactDynamicsError)
        reason = error if is_message else no_message(data, self.type_name)
        for reader in readers:
            self._states.refuse(reader.body_name, reason, was_kept=was_kept, now_ns=now_ns)


def _leading_frame(data: bytes) -> bytes:
    """Return the serialized frame of a header, with the four bytes of its length."""
    letters = int.from_bytes(data[_FRAME_AT : _FRAME_AT + 4], "little" if data[1] else "big")
    return data[_FRAME_AT : _FRAME_AT + 4 + letters]


class PassedOn(StateStore):
    """A store that passes on each state when it arrives, and stores it only if ``is_stored``."""

    def __init__(self, take: Callable[[str, KnownState], object], *, is_stored: bool) -> None:
        """Call ``take`` with the body and each state. States that are not stored may have any stamp."""
        super().__init__(history=0.0, timeout=0.0)
        self._take, self._is_stored = take, is_stored

    def add(self, body_name: str, state: KnownState, *, now_ns: int | None = None) -> None:
        """Pass on a state."""
        if self._is_stored:
            super().add(body_name, state, now_ns=now_ns)
        self._take(body_name, state)

    def add_unread(
        self, body_name: str, stamp_ns: int, read: ReadState, *, now_ns: int | None = None
    ) -> None:
        """Decode a state, and pass it on."""
        if self._is_stored:
            super().add_unread(body_name, stamp_ns, read, now_ns=now_ns)
        state = read()
        if state is not None:
            self._take(body_name, state)


class OfferedQosWatch:
    """Reports the QoS that the publishers of a topic offer, whenever it has changed.

    DDS does not provide the depth of a publisher's queue. The history is then unknown, as in bags of rosbag2.
    """

    def __init__(self, node: Node, topic: str, tell: Callable[[str, list[Any]], object]) -> None:
        """Watch a topic. ``tell`` is called with the topic and the ``QoSProfile`` of each publisher."""
        self._node = node
        self._topic = topic
        self._tell = tell
        self._told: list[Any] = []

    def look(self) -> list[TopicEndpointInfo]:
        """Return the present publishers. The QoS of former publishers counts until there are others."""
        publishers: list[TopicEndpointInfo] = self._node.get_publishers_info_by_topic(self._topic)
        found = [info.qos_profile for info in publishers]
        if found and found != self._told:
            self._told = found
            self._tell(self._topic, found)
        return publishers


class BodyWatch:
    """Checks the states of one body.

    Messages may arrive on a topic while one of its bodies is missing, or while the states of a body are
    rejected.
    """

    def __init__(self, sources: BodySources, topics: Mapping[str, StateTopic]) -> None:
        """Begin to check. The ``topics`` have their full names as keys."""
        self._name = sources.body_name
        self._sources = [[topics[each.full_name] for each in source.topics] for source in sources.sources]
        self._topics = [topic for source in self._sources for topic in source]
        self._came = self._rejected = self._old = 0  # numbers of states, at the last check
        self._came_at = self._kept_at = time.monotonic()  # s, time of the last check with new ones
        self._rejected_at = -RECENT_S
        self._is_old = False

    def look(self, arrivals: Arrivals, *, silent_after: float, awake_for: float) -> list[Present]:
        """Check the body's states, once a second; return the present situations.

        The body counts as silent after ``silent_after``, s, without a state. ``awake_for`` is the time, s,
        for which this process has run without being stopped.
        """
        now = time.monotonic()
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
            *([Situation.OLD.present(body=self._name, age=arrivals.age)] if self._is_old else []),
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

    def _of_silence(self, arrivals: Arrivals) -> list[Present]:
        names = " and ".join(dict.fromkeys(topic.name for topic in self._topics))
        if not arrivals.came and names:
            publishers = sum(topic.publishers for topic in self._topics)
            return [Situation.NO_STATE_YET.present(body=self._name, topics=names, publishers=publishers)]
        if any(topic.traffic.is_silent for topic in self._topics) or not names:
            return []
        return [Situation.BODY_SILENT.present(body=self._name, topics=names)]
