# SPDX-License-Identifier: Apache-2.0
"""Subscriptions that are polled by their node instead of an executor.

An executor wakes for each message, which costs 11 µs a message at 20 000 messages per second. To take all
waiting messages a hundred times per second, and before each request, costs 2.6 µs a message. DDS queues the
messages meanwhile. A burst of messages therefore delays no request, and each request is answered with all
messages that arrived before it.
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

TAKE_EVERY_S: Final = 0.005  # s, shortest time between two rounds through all queues

_WARN_EVERY_S: Final = 5.0


class Taken(NamedTuple):
    """A received message."""

    data: bytes  # its bytes
    received_ns: int  # time of reception by DDS, ns since the epoch on the clock of this machine
    # Its number among those of its publisher, from 1, or None if the middleware provides none
    number: int | None


class InboxNode(Node):
    """A node with polled subscriptions.

    Attributes:
        inbox: The polled subscriptions.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        """Create a node without subscriptions; the arguments are those of `rclpy.node.Node`."""
        self.inbox: list[Subscription] = []
        self._in_rounds: list[Subscription] = []
        self._takes_time = False  # by its own subscription instead of that of rclpy's time source
        self._emptied = 0.0  # s, time of the last round
        self._question_ns = 0
        super().__init__(*arguments, **options)
        refuse_what_ros_cannot_do(self)

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """The subscriptions that an executor handles."""
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
        """Subscribe to serialized messages, which are passed to ``receive`` when the node takes them.

        ``receive`` must not raise an error. The depth of the ``qos`` limits the number of messages of one
        round. If ``may_override`` is set, parameters may override the ``qos``, and an invalid override raises
        `ConfigurationError`. If ``in_rounds`` is false, `take_messages` leaves out the messages, and the node
        calls `empty`.
        """
        overrides = QoSOverridingOptions.with_default_policies(callback=_allowed) if may_override else None
        # rclpy writes overrides into the given profile, which other topics share.
        try:
            subscription = self.create_subscription(
                msg_type, topic, receive, copy(qos), raw=True, qos_overriding_options=overrides
            )
        except Exception as error:
            if not may_override:
                raise
            # rclpy raises several unrelated types for invalid parameters.
            message = f"qos_overrides.{self.resolve_topic_name(topic)}.subscription: {error}"
            raise ConfigurationError(message) from None
        self.inbox.append(subscription)
        if in_rounds:
            self._in_rounds.append(subscription)
        return subscription

    def subscribe_to_time(self, receive: Callable[[Taken], object], qos: QoSProfile) -> Subscription:
        """Subscribe to the simulated time, which sets the node's clock and is passed to ``receive``.

        The subscription of rclpy's time source is not used any more. It keeps one message only, and messages
        that it takes would be missing here.
        """

        def tick(taken: Taken) -> None:
            receive(taken)
            self._set_clock(taken.data)

        subscription = self.subscribe(Clock, "/clock", tick, qos)
        self._in_rounds.insert(0, self._in_rounds.pop())  # since states ahead of the clock are rejected
        self._takes_time = True
        return subscription

    def end_services(self) -> None:
        """Remove all services; see `RunnableNode`."""
        for service in list(self.services):
            self.destroy_service(service)

    def unsubscribe(self) -> None:
        """Remove all polled subscriptions."""
        for subscription in self.inbox:
            self.destroy_subscription(subscription)
        self.inbox.clear()
        self._in_rounds.clear()
        self._takes_time = False

    def attend(self) -> None:
        """Take all waiting messages every `TAKE_EVERY_S`; see `RunnableNode`."""
        if time.monotonic() - self._emptied >= TAKE_EVERY_S:
            self.take_messages()

    def take_messages(self) -> None:
        """Take all waiting messages."""
        self._emptied = time.monotonic()
        clock = self._clock_subscription
        if clock is not None and not self._takes_time:
            self._take_time(clock)
        for subscription in self._in_rounds:
            self.empty(subscription)

    def note_question(self, received_ns: int) -> None:
        """Set the arrival time of a request, ns since the epoch. Messages taken later count as after it."""
        self._question_ns = received_ns

    def empty(self, subscription: Subscription) -> None:
        """Take the waiting messages of one subscription."""
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
        """The subscription of rclpy's time source, which has no public name."""
        source = getattr(self, "_time_source", None)  # it does not exist before the node is complete
        return None if source is None else source._clock_sub  # noqa: SLF001

    def _take_time(self, clock: Subscription) -> None:
        with clock.handle:
            for _ in range(clock.qos_profile.depth):
                taken = clock.handle.take_message(clock.msg_type, True)  # noqa: FBT003  raw
                if taken is None:
                    return
                self._set_clock(taken[0])

    def _set_clock(self, data: bytes) -> None:
        """Set the node's clock to the time of a message, or warn if it is invalid."""
        clock = self._clock_subscription
        if clock is None:  # the parameter `use_sim_time` has been changed
            return
        warn = partial(self.get_logger().warning, throttle_duration_sec=_WARN_EVERY_S)
        try:
            msg = deserialize_message(data, Clock)
        except RuntimeError as error:  # bytes that are no message
            warn(f"{clock.topic_name}: message ignored: {error}")
            return
        try:
            clock.callback(msg)
        except ValueError:  # rclpy has no negative times; the clock keeps its time
            warn(f"{clock.topic_name}: message ignored: clock.sec must be >= 0, got {msg.clock.sec}")

    def _after_the_question(self, received_ns: int) -> int:
        """Return the time of reception. A message received while a request was taken counts as later."""
        question_ns = self._question_ns
        if question_ns - NS_PER_S < received_ns <= question_ns:  # otherwise the machine's clock was set back
            return question_ns + 1
        return received_ns or time.time_ns()  # 0 from middleware that does not provide it


def _allowed(qos: QoSProfile) -> SetParametersResult:
    """Reject an overridden QoS with depth 0, which would receive nothing."""
    reason = "" if qos.depth > 0 else f"depth must be a whole number > 0, got {qos.depth}"
    return SetParametersResult(successful=not reason, reason=reason)


def refuse_what_ros_cannot_do(node: Node) -> None:
    """Make a node's existing services return an empty response, with a warning, instead of raising an error.

    These are the services that ROS adds to every node. An error raised by rclpy would end the process, such
    as for a lifecycle transition that is not available in the current state. Lifecycle managers request such
    transitions when they start all nodes and one is already active. rclcpp responds that it failed.
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
