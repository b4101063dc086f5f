# SPDX-License-Identifier: Apache-2.0
"""The work of a configured node: it receives and logs the states of bodies, and reports on /diagnostics."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Final

from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.qos import QoSProfile, ReliabilityPolicy

from contact_dynamics.nodes.diagnostics import Diagnostics, values_of_log, values_of_topics
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.run_record import CHANGE_TYPE, CHANGES
from contact_dynamics.nodes.server_core import ServerCore
from contact_dynamics.nodes.service_front import EVENT_QOS
from contact_dynamics.nodes.situations import Part, Present, Situation
from contact_dynamics.nodes.state_subscriptions import BodyWatch, OfferedQosWatch, StateTopic, present_ns
from contact_dynamics.nodes.topic_faults import TopicFaults
from contact_dynamics.questions.twist_axes import TwistAxes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.nodes.inbox import InboxNode, Taken
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.questions.state_store import StateStore

CLOCK_QOS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Queue of the simulated time. It matches every publisher, as does rclpy's own subscription to the clock."""

LOOK_EVERY_S: Final = 1.0
"""s. Interval at which topics and other nodes are checked and /diagnostics is published."""

STOOD_STILL_S: Final = 2.0
"""s. After a longer interval, the process counts as having been stopped, so topics do not count as silent."""


class Receiving(ABC):
    """Receives states and writes the log of a node."""

    def __init__(
        self,
        node: InboxNode,
        parameters: ServerParameters,
        *,
        run: Mapping[str, str],
        states: StateStore | None = None,
    ) -> None:
        """Create the log and subscribe. Nothing is logged before `_begin`.

        The log's record of the run is ``run``. The states are stored in ``states`` if it is given. Raise
        `ConfigurationError` if a source does not exist, or the log's folder cannot be created.
        """
        self._node = node
        self._core = core = ServerCore(parameters, states)
        # The log is created after this, so that an unknown source leaves no empty log.
        self._faults = TopicFaults(
            node.get_logger().warning, inform=node.get_logger().info, limits=parameters.fault_limits
        )
        self._topics = [
            StateTopic(
                node,
                source,
                states=core.states,
                record=self._record,
                offered=self._note_offers,
                faults=self._faults,
            )
            for source in core.sources.values()
        ]
        self._note_publishers()
        by_name = {topic.name: topic for topic in self._topics}
        self._bodies = {
            body.body_name: BodyWatch(body, by_name) for body in parameters.sources if body.sources
        }
        self._twist_axes = _watch_twists(parameters)
        self._log = Log(
            parameters.log_directory if parameters.log else None,
            run=run,
            limits=parameters.log_limits,
            on_problem=node.get_logger().error,
            on_notice=node.get_logger().warning,
        )
        for topic in self._topics:
            self._log.add_topic(topic.name, topic.type_name)
        self._clock_publishers: OfferedQosWatch | None = None
        self._log_clock()
        self._log.add_topic(CHANGES, CHANGE_TYPE, EVENT_QOS)
        self._diagnostics = Diagnostics(node)
        self._looked = time.monotonic()
        self._awake_since = self._looked

    def _begin(self) -> None:
        """Begin to record, once all topics of the log are declared."""
        self._log.start()
        # If a simulation or a log starts again, its states would otherwise be rejected as old. This comes
        # last, because the clock calls the function until it is removed, even if this object no longer
        # exists, which ends the process.
        set_back = JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1))
        self._jumps = self._node.get_clock().create_jump_callback(
            set_back, post_callback=lambda _: self._forget_states()
        )

    def __str__(self) -> str:
        """Return the bodies with states, and the folder of the log."""
        names = [body.name for body in self._core.world.bodies]
        bodies = ", ".join(name if name in self._bodies else f"{name} (no state topic)" for name in names)
        return f"bodies {bodies or 'none'}; log {self._log.folder or 'off'}"

    @property
    def is_ready(self) -> bool:
        """Whether the node can do all its work."""
        return True

    @property
    def preparations(self) -> str:
        """A text about what is not ready yet."""
        return ""

    @abstractmethod
    def activate(self, *, is_active: bool) -> None:
        """Start or stop the work of the active node."""

    def change(self, parameters: ServerParameters, *, event: bytes, run: Mapping[str, str]) -> None:
        """Continue with another configuration, which `check_change` allows.

        Log the serialized ``event`` of the change. The files of the log that begin later contain ``run``.
        """
        self._node.take_messages()  # these arrived under the previous configuration
        now_ns = time.time_ns()
        self._node.note_question(now_ns)  # messages from here on arrived after the change
        self._log.record(CHANGES, event, log_time_ns=now_ns)
        self._log.change_run(run)
        self._core.change(parameters)
        for topic in self._topics:
            topic.source = self._core.sources[topic.name]
        self._note_publishers()
        self._twist_axes = _watch_twists(parameters)
        self._faults.limits = parameters.fault_limits

    def attend(self) -> None:
        """Check topics and publish /diagnostics once a second."""
        now = time.monotonic()
        since_look = now - self._looked
        if since_look >= LOOK_EVERY_S:
            self._looked = now
            if since_look > STOOD_STILL_S:
                self._awake_since = self._looked
            self._look()

    def close(self) -> str:
        """Finish the log; return a text about it."""
        self._node.take_messages()
        return self._log.close()

    def remove(self) -> None:
        """Remove subscriptions and publishers from the node."""
        self._jumps.unregister()
        self._node.unsubscribe()
        self._diagnostics.remove()

    def end(self) -> None:  # noqa: B027  a monitor has no requests
        """End the processing of requests, before the node removes its services."""

    def end_workers(self) -> None:  # noqa: B027  nor workers
        """End worker processes."""

    def _forget_states(self) -> None:
        """Forget all states, because the clock was set back."""
        self._core.states.clear()

    def _values(self) -> Mapping[Part, Mapping[str, str]]:
        """Return further values to report."""
        return {}

    def _present(self) -> list[Present]:
        """Return further present situations."""
        return []

    def _look(self) -> None:
        """Check topics and other nodes, and publish /diagnostics."""
        self._diagnostics.publish(
            {
                Part.STATES: values_of_topics([each.traffic for each in self._topics], self._faults.counts),
                **self._values(),
                Part.LOG: values_of_log(self._log.status),
            },
            [*self._look_at_states(), *self._present(), *self._log.present()],
        )

    def _look_at_states(self) -> list[Present]:
        awake_for = self._looked - self._awake_since
        present = [found for topic in self._topics for found in topic.look(awake_for=awake_for)]
        self._note_publishers()
        for name, body in self._bodies.items():
            silent_after = self._core.parameters.fault_limits.silent_after
            present += body.look(
                self._core.states.arrivals(name), silent_after=silent_after, awake_for=awake_for
            )
        for topic, axes in self._twist_axes:
            speed = axes.look(self._core.states)
            if speed is not None:
                found = Situation.TWIST_AXES.present(topic=topic, speed=speed)
                self._faults.add(topic, "twist in other axes", 1, found.text.removeprefix(f"{topic}: "))
                present.append(found)
        if self._clock_publishers is not None:
            self._clock_publishers.look()
            if present_ns(self._node) is None:
                present.append(Situation.NO_CLOCK.present())
        return present

    def _note_publishers(self) -> None:
        """Note the number of publishers of each topic, for errors before the first state."""
        self._core.expect({topic.name: topic.publishers for topic in self._topics})

    def _log_clock(self) -> None:
        """Log the simulated time, if it is used. Stamps of states and events are then of it."""
        if not self._node.get_parameter("use_sim_time").value:
            return

        def record(tick: Taken) -> None:
            self._record(topic, tick)

        topic: str = self._node.subscribe_to_time(record, CLOCK_QOS).topic_name
        self._log.add_topic(topic, "rosgraph_msgs/msg/Clock")
        self._clock_publishers = OfferedQosWatch(self._node, topic, self._note_offers)

    def _record(self, topic: str, taken: Taken) -> None:
        self._log.record(topic, taken.data, log_time_ns=taken.received_ns)

    def _note_offers(self, topic: str, offers: list[QoSProfile]) -> None:
        self._log.set_qos(topic, offers)


def _watch_twists(parameters: ServerParameters) -> list[tuple[str, TwistAxes]]:
    """Return the topics with the only odometry of a body, and a check of its twist's axes for each."""
    return [
        (body.sources[0].topics[0].full_name, TwistAxes(body.body_name, known.p_FB_F))
        for body, known in zip(parameters.sources, parameters.world.bodies, strict=True)
        if [source.adapter for source in body.sources] == ["odometry"]
    ]
