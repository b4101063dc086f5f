# SPDX-License-Identifier: Apache-2.0
"""The visualizer: draws bodies, surfaces, contacts and the responses of a server in rerun, live or to a file.

It is a process of its own, which subscribes to the states and to the server's service events, and publishes
nothing. It reads the server's parameters, which describe bodies, surfaces and topics, and its own
(`config/visualizer.yaml`). A drawing that fails is reported once, and the others continue.

`replay.view` draws a log in the same way.
"""

from __future__ import annotations

import math
import os
import sys
import time
import traceback
from collections import deque
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rcl_interfaces.msg import ParameterEvent
from rclpy.clock import Clock, ClockType
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from contact_dynamics.nodes.arguments import visualizer_parser
from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.nodes.node_parameters import NodeParameters, refuse_lost_sections
from contact_dynamics.nodes.other_parameters import PARAMETERS_OF_OTHERS, read_visualizer_parameters
from contact_dynamics.nodes.parameter_reader import ConfigurationError, ParameterSource
from contact_dynamics.nodes.parameters import check_change, read_server_parameters
from contact_dynamics.nodes.run_record import CHANGES, changed_values, plain
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.server_core import ServerCore
from contact_dynamics.nodes.state_subscriptions import PassedOn, StateTopic
from contact_dynamics.nodes.topic_faults import TopicFaults
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.recording.cdr import EventType, event_type_of
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.sinks import OpenRecording, ViewerMode, raise_errors
from contact_dynamics.viewing.states_in_turn import SHORTEST_S, StatesInTurn
from contact_dynamics_interfaces.msg import MonitorEvent
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rclpy.subscription import Subscription

    from contact_dynamics.nodes.inbox import Taken
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.questions.services import Service
    from contact_dynamics.questions.uncertain_state import KnownState

NODE_NAME: Final = "contact_dynamics_visualizer"

EVENT_QOS: Final = QoSProfile(depth=10_000)
"""Queue depth of the service events, which equals the server's, so that all of a burst are drawn."""

SERVER_WAIT_S: Final = 3.0
"""s. Longest wait for a server, which may start at the same time."""

_NICER: Final = 5
"""Increase of the process's nice value, since responses must not wait for a drawing."""

_POLL_S: Final = 0.02


_LEFT_S: Final = 2.0
"""s. Longest time for drawing the remaining responses at the end, before a launch kills the process."""


class _Waiting(NamedTuple):
    """A response that is not drawn yet."""

    shown: Service
    data: bytes  # the event
    came_ns: int  # time of reception by DDS
    now_ns: int | None  # the stamp of the newest of them


class Visualizer(InboxNode):
    """The node `contact_dynamics_visualizer`."""

    def __init__(
        self,
        *,
        ros_arguments: Sequence[str] = (),
        strict: bool = False,
        server_wait: float = 0.0,
        **node_options: Any,
    ) -> None:
        """Read the parameters, open the sinks, draw the scene and subscribe.

        Errors in drawing are raised if ``strict``; otherwise each kind is reported once. Wait at most
        ``server_wait``, s, for the server before subscribing to states. The ``ros_arguments`` are those of
        `rclpy.init`, and the ``node_options`` those of `rclpy.node.Node`.

        Raises:
            ConfigurationError: a parameter is missing, unknown or not allowed.
            NowhereToDrawError: only a viewer was requested, and there is none.
            OSError: the file cannot be written.
        """
        super().__init__(NODE_NAME, **node_options)
        raise_errors()
        refuse_lost_sections(self, ros_arguments)
        self._strict = strict
        self._told: set[str] = set()
        self._source = NodeParameters(
            self, ros_arguments=ros_arguments, also_known=PARAMETERS_OF_OTHERS, read_only=True
        )
        self._core = core = ServerCore(read_server_parameters(self._source))
        own = read_visualizer_parameters(self._source)
        server, self._sinks = own.server, own.sinks
        self._recording = OpenRecording(self._sinks, on_problem=self.get_logger().warning)
        self._picture = Picture(
            self._recording.stream,
            core.world,
            surface_side=own.surface_side,
            predictions=own.predictions,
            carried=core.parameters.carried,
        )
        self._states = StatesInTurn(self._picture, guarded=self._guarded)
        self._came_ns = 0
        self._answers: deque[_Waiting] = deque()
        self._server = server
        self._values = {name: plain(parameter.value) for name, parameter in self._parameters.items()}
        self.create_subscription(ParameterEvent, CHANGES, self._follow, EVENT_QOS)
        self.create_subscription(MonitorEvent, f"{own.monitor}/events", self._tell_event, EVENT_QOS)
        self._events = [self._listen(shown, f"{server}/{shown.name}") for shown in SERVICES]
        self._wait_for_server(server, self._events, server_wait)
        passed_on, faults = PassedOn(self._pass_on, is_stored=False), TopicFaults(self.get_logger().warning)
        self._topics = [
            StateTopic(
                self,
                source,
                states=passed_on,
                record=self._note_arrival,
                offered=lambda _topic, _offers: None,
                faults=faults,
            )
            for source in core.sources.values()
        ]
        self.create_timer(SHORTEST_S, self._keep_pace, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.get_logger().info(f"ready: draws {server} to {self._recording.description}")

    def _note_arrival(self, topic: str, taken: Taken) -> None:  # noqa: ARG002  it is the same for all topics
        """Store the time of reception of the message whose states are passed on next."""
        self._came_ns = taken.received_ns

    def _pass_on(self, body_name: str, state: KnownState) -> None:
        self._states.add(body_name, state_of(state), came_ns=self._came_ns)

    def take_messages(self) -> None:
        """Take all waiting states, and then the events, so that states are drawn before a later response."""
        super().take_messages()
        if len(self._answers) < EVENT_QOS.depth:  # otherwise they wait in the queues of DDS
            for subscription in self._events:
                self.empty(subscription)

    def draw_all(self) -> None:
        """Draw everything that has arrived."""
        self.take_messages()
        self._draw_answers()
        self._states.draw()

    def close(self) -> bool:
        """Draw the remaining responses and close the sinks; return whether they accepted everything."""
        until = time.monotonic() + _LEFT_S
        self.take_messages()
        while self._answers and time.monotonic() < until:
            self._draw_answers(until=until)
            self.take_messages()
        if self._answers:
            self.get_logger().warning(
                f"{len(self._answers)} responses are not drawn: they still waited after {_LEFT_S:g} s"
            )
        self._states.draw()
        if self._sinks.viewer is ViewerMode.NONE:
            self._guarded("the last look", self._picture.frame_all)
        return self._recording.close()

    def _keep_pace(self) -> None:
        """Draw the waiting responses, and the states if that is due.

        A response is not drawn at once, since the server and its client are busy then.
        """
        self.take_messages()
        self._draw_answers()
        if self._states.pace.is_due:
            self._states.draw()
        self._guarded("files and viewers", self._recording.tend)

    def _wait_for_server(self, server: str, events: list[Subscription], patience: float) -> None:
        """Wait for the server's events, so that none is missed if states are published next."""
        deadline = time.monotonic() + patience
        while not all(subscription.get_publisher_count() for subscription in events):
            if time.monotonic() > deadline:
                self.get_logger().info(f"waiting for {server}: its responses are drawn once it runs")
                return
            time.sleep(_POLL_S)

    def _listen(self, shown: Service, service: str) -> Subscription:
        def receive(taken: Taken) -> None:
            if event_type_of(taken.data) == EventType.RESPONSE_SENT:
                now_ns = self._states.newest_stamp_ns()
                self._answers.append(_Waiting(shown, taken.data, taken.received_ns, now_ns))

        topic = f"{service}/_service_event"
        return self.subscribe(shown.service_type.Event, topic, receive, EVENT_QOS, in_rounds=False)

    def _draw_answers(self, *, until: float = math.inf) -> None:
        """Draw the waiting responses, and take states meanwhile so that their queues do not overflow."""
        for _ in range(len(self._answers)):
            if time.monotonic() > until:
                return
            waiting = self._answers.popleft()
            self._guarded(f"{self._server}/{waiting.shown.name}", partial(self._show, waiting))
            self.attend()

    def _show(self, waiting: _Waiting) -> None:
        shown = waiting.shown
        event = deserialize_message(waiting.data, shown.service_type.Event)
        if not event.response:
            return
        response = event.response[0]
        now_ns = waiting.now_ns or self._picture.newest_stamp_ns() or stamp_ns_from_msg(event.info.stamp)
        if response.status != response.OK:
            refused = f"rejected ({response.status}): {response.message}"
            self._picture.tell(shown.kind, refused, stamp_ns=now_ns, is_error=True)
            return
        answer = shown.answer_from_msg(response, world=self._core.world)
        self._states.draw_before(answer, came_ns=waiting.came_ns)
        self._picture.show(
            answer, now_ns=now_ns, remark=response.message, computation_time=response.computation_time
        )

    def _tell_event(self, msg: MonitorEvent) -> None:
        """Log an event of a monitor as text."""
        stamp_ns, is_unusual = stamp_ns_from_msg(msg.header.stamp), msg.alarm or msg.region == msg.OUTSIDE_99
        tell = partial(self._picture.tell, "monitor", msg.text, stamp_ns=stamp_ns, is_error=is_unusual)
        self._guarded("the monitor's events", tell)

    def _follow(self, event: ParameterEvent) -> None:
        """Draw the server's changed configuration."""
        if event.node != self._server:
            return
        self._values.update(changed_values(event))
        given = ParameterSource(self._values, also_known=self._values, resolve=self._source.resolved_topic)
        try:
            before, after = self._core.parameters, read_server_parameters(given)
            check_change(before, after)
        except ConfigurationError:
            return  # the parameters of a body arrive one by one, before the list of bodies
        self.draw_all()
        self._core.change(after)
        for topic in self._topics:
            topic.source = self._core.sources[topic.name]
        if _scenery(after) == _scenery(before):
            return  # each parameter of a change causes an event, and many do not belong to the world
        change = partial(
            self._picture.change_world,
            after.world,
            stamp_ns=stamp_ns_from_msg(event.stamp),
            carried=after.carried,
        )
        self._guarded("a change of the world", change)
        names = ", ".join(each.name for each in (*after.world.bodies, *after.world.surfaces))
        self.get_logger().info(f"draws what {self._server} is configured with now: {names}")

    def _guarded(self, kind: str, draw: Callable[[], None]) -> None:
        try:
            draw()
        except Exception:
            if self._strict:
                raise
            if kind not in self._told:
                self._told.add(kind)
                self.get_logger().warning(f"cannot draw {kind} (reported once):\n{traceback.format_exc()}")


def _scenery(parameters: ServerParameters) -> object:
    """Return the drawn part of a configuration, to compare it with another one."""
    return parameters.world.to_dict(), [each.to_dict() for each in parameters.carried]


def main(arguments: list[str]) -> int:
    """Run the visualizer until a signal or a shutdown ends it; return the exit code."""
    os.nice(_NICER)  # before other threads, which inherit it
    exit_code = run_node(
        lambda ros_arguments: Visualizer(ros_arguments=ros_arguments, server_wait=SERVER_WAIT_S),
        verb="visualizer",
        parser=visualizer_parser(),
        arguments=arguments,
    )
    if exit_code == 1:
        sys.stdout.flush()
        os._exit(exit_code)  # a usual exit would wait for a viewer that hangs
    return exit_code
