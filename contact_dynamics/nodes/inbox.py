# SPDX-License-Identifier: Apache-2.0
"""Subscriptions that no executor waits for: their node empties them all at once.

An executor wakes for each message and calls a function for each. At 20 000 messages a second that takes 11 µs
a message; to take all that wait, a hundred times a second and before each answer, takes 2.6. The queues of
DDS hold what comes meanwhile. So a burst of messages delays no question, and a question sees all messages
that came before it.
"""

from __future__ import annotations

import time
from copy import copy
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.nodes.parameter_reader import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rclpy.qos import QoSProfile
    from rclpy.service import Service
    from rclpy.subscription import Subscription

TAKE_EVERY_S: Final = 0.005
"""s, the least time between two rounds through all queues."""


_TELL_EVERY_S: Final = 5.0


class Taken(NamedTuple):
    """A message as it came.

    Attributes:
        data: Its bytes.
        received_ns: When DDS received it, ns since the epoch by this machine's clock.
        number: Its number among those of its publisher, from 1 on, or None if this DDS tells none.
    """

    data: bytes
    received_ns: int
    number: int | None


class InboxNode(Node):
    """A node that has such subscriptions.

    Attributes:
        inbox: These subscriptions.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        """Begin without any, and find who is there; the arguments are those of `rclpy.node.Node`."""
        self.inbox: list[Subscription] = []
        self._in_rounds: list[Subscription] = []
        self._takes_time = False  # by a subscription of its own, rather than by that of its time source
        self._emptied = 0.0  # when, s
        self._question_ns = 0
        super().__init__(*arguments, **options)
        refuse_what_ros_cannot_do(self)

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """The subscriptions that an executor waits for."""
        by_hand = [*self.inbox, self._clock_subscription]
        return (each for each in super().subscriptions if each not in by_hand)

    def subscribe(
        self,
        msg_type: type[Any],
        topic: str,
        receive: Callable[[Taken], object],
        qos: QoSProfile,
        *,
        may_override: bool = False,
        in_rounds: bool = True,
    ) -> Subscription:
        """Subscribe to bytes, which ``receive`` gets when the node takes them.

        Args:
            msg_type: the class of the messages.
            topic: the topic.
            receive: takes a message. It must not raise.
            qos: the queue's; its depth is how many messages are taken in one round at most.
            may_override: whether parameters may override the QoS.
            in_rounds: whether `take_messages` takes its messages. Otherwise the node calls `empty`.

        Raises:
            ConfigurationError: a parameter overrides the QoS by something that is not allowed.
        """
        overrides = QoSOverridingOptions.with_default_policies(callback=_allowed) if may_override else None
        # rclpy writes a parameter's values into the profile that it is given, which other topics share.
        try:
            subscription = self.create_subscription(
                msg_type, topic, receive, copy(qos), raw=True, qos_overriding_options=overrides
            )
        except Exception as error:
            if not may_override:
                raise
            # rclpy raises several unrelated types for these parameters, as for all others.
            message = f"qos_overrides.{self.resolve_topic_name(topic)}.subscription: {error}"
            raise ConfigurationError(message) from None
        self.inbox.append(subscription)
        if in_rounds:
            self._in_rounds.append(subscription)
        return subscription

    def subscribe_to_time(self, receive: Callable[[Taken], object], qos: QoSProfile) -> Subscription:
        """Subscribe to the simulated time. The node's clock goes by the messages that ``receive`` gets.

        The subscription of rclpy's time source is left alone from then on: it keeps one message, and what it
        took, others might not get.
        """

        def tick(taken: Taken) -> None:
            receive(taken)
            self._set_clock(taken.data)

        subscription = self.subscribe(Clock, "/clock", tick, qos)
        self._in_rounds.insert(0, self._in_rounds.pop())  # states that are ahead of the clock are refused
        self._takes_time = True
        return subscription

    def end_services(self) -> None:
        """Take no more requests; see `RunnableNode`."""
        for service in list(self.services):
            self.destroy_service(service)

    def unsubscribe(self) -> None:
        """Give up all these subscriptions."""
        for subscription in self.inbox:
            self.destroy_subscription(subscription)
        self.inbox.clear()
        self._in_rounds.clear()
        self._takes_time = False

    def attend(self) -> None:
        """Take all messages, unless that was done a moment ago; see `RunnableNode`."""
        if time.monotonic() - self._emptied >= TAKE_EVERY_S:
            self.take_messages()

    def take_messages(self) -> None:
        """Take all messages that wait."""
        self._emptied = time.monotonic()
        clock = self._clock_subscription
        if clock is not None and not self._takes_time:
            self._take_time(clock)
        for subscription in self._in_rounds:
            self.empty(subscription)

    def note_question(self, received_ns: int) -> None:
        """Note that a question came at that time, ns since the epoch: what is taken later came after it."""
        self._question_ns = received_ns

    def empty(self, subscription: Subscription) -> None:
        """Take the messages of one subscription that wait."""
        handle, msg_type, receive = subscription.handle, subscription.msg_type, subscription.callback
        with handle:
            take = handle.take_message
            for _ in range(subscription.qos_profile.depth):
                taken = take(msg_type, True)  # noqa: FBT003  raw; rclpy names no argument
                if taken is None:
                    return
                data, info = taken
                received_ns = self._after_the_question(info["received_timestamp"])
                receive(Taken(data, received_ns, info["publication_sequence_number"]))

    @property
    def _clock_subscription(self) -> Subscription | None:
        """The subscription by which the node takes a simulation's time. rclpy has no public name for it."""
        source = getattr(self, "_time_source", None)  # there is none while the node is being made
        return None if source is None else source._clock_sub  # noqa: SLF001

    def _take_time(self, clock: Subscription) -> None:
        with clock.handle:
            for _ in range(clock.qos_profile.depth):
                taken = clock.handle.take_message(clock.msg_type, True)  # noqa: FBT003  raw
                if taken is None:
                    return
                self._set_clock(taken[0])

    def _set_clock(self, data: bytes) -> None:
        """Set the node's clock to what a message says, or say why it cannot be."""
        clock = self._clock_subscription
        if clock is None:  # the parameter `use_sim_time` was changed meanwhile
            return
        warn = partial(self.get_logger().warning, throttle_duration_sec=_TELL_EVERY_S)
        try:
            msg = deserialize_message(data, Clock)
        except RuntimeError as error:  # bytes that are no message
            warn(f"{clock.topic_name}: message ignored: {error}")
            return
        try:
            clock.callback(msg)
        except ValueError:  # rclpy has no time before zero; the clock stays where it was
            warn(f"{clock.topic_name}: message ignored: clock.sec must be >= 0, got {msg.clock.sec}")

    def _after_the_question(self, received_ns: int) -> int:
        """Return when a message came; one that came while a question was being taken counts as later."""
        question_ns = self._question_ns
        if question_ns - NS_PER_S < received_ns <= question_ns:  # else the machine's clock was set back
            return question_ns + 1
        return received_ns or time.time_ns()  # a DDS that does not tell says 0


def _allowed(qos: QoSProfile) -> SetParametersResult:
    """Tell whether an overridden QoS can be served: a queue without room would take nothing, silently."""
    reason = "" if qos.depth > 0 else f"depth must be a whole number > 0, got {qos.depth}"
    return SetParametersResult(successful=not reason, reason=reason)


def refuse_what_ros_cannot_do(node: Node) -> None:
    """Let the services that a node has so far answer errors with an empty response and a warning.

    They are those that ROS gives every node. rclpy raises where it cannot do what is asked, which would end
    the process: so for a lifecycle transition that the present state does not have. Managers ask for such
    when they bring up all nodes and one is active already. rclcpp answers that it was no success.
    """
    for service in node.services:
        _guard(service, node)


def _guard(service: Service, node: Node) -> None:
    answer = service.callback

    def answer_or_refuse(request: Any, response: Any) -> Any:
        try:
            return answer(request, response)
        except Exception as error:  # noqa: BLE001  rclpy raises several unrelated types
            node.get_logger().warning(f"{service.service_name}: request refused: {error}")
            return type(response)()

    service.callback = answer_or_refuse
