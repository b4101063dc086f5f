# SPDX-License-Identifier: Apache-2.0
"""While it is configured, the server has a store of states, a log, workers and services."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from nav_msgs.msg import Path
from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.qos import QoSProfile, ReliabilityPolicy

from contact_dynamics.nodes.diagnostics import AnswerTimes, Diagnostics, values_of_log, values_of_topics
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.run_record import CHANGE_TYPE, CHANGES
from contact_dynamics.nodes.server_core import ServerCore
from contact_dynamics.nodes.service_front import EVENT_QOS, ServiceFront
from contact_dynamics.nodes.situations import Part, Present, Situation
from contact_dynamics.nodes.state_subscriptions import (
    BodyWatch,
    OfferedQosWatch,
    StateTopic,
    present_ns,
)
from contact_dynamics.nodes.topic_faults import TopicFaults
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.questions.twist_axes import TwistAxes
from contact_dynamics.questions.workers import Workers
from msg_adapters.tumbling import path_from_trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.nodes.inbox import InboxNode, Taken
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.questions.services import Service
    from msg_adapters.status import Response

CLOCK_QOS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Queue of the simulated time. It matches every publisher, like the node's own subscription to the clock."""

PATH_QOS = QoSProfile(depth=1)
"""Queue of the predicted trajectory as a path. It is a picture, and only the newest one matters."""

EVENTS_EVERY_S: Final = 0.05
"""s. Time between two looks for events that no call of the moment is about, which are those of clients."""

LOOK_EVERY_S: Final = 1.0
"""s. Time between two looks at topics and other nodes, which /diagnostics then tells of."""

STOOD_STILL_S: Final = 2.0
"""s. A process that has not looked for so long was stopped or starved, and heard nothing for that reason."""

_SENT_AGAIN_FOR_S: Final = 1.0
"""s. Many answers at once overflow the socket of a client that a busy machine stops meanwhile. DDS sends them
again, for as long as the service is there."""

_HANDED_OVER_WITHIN_S: Final = 0.1
"""s. A server that ends waits so long for requests that had arrived, and that DDS has not handed over yet."""

_REFUSES_FOR_S: Final = 3.0
"""s. A server that ends refuses what still arrives for so long at most."""


class Serving:
    """Receives states, answers questions and writes the log, for a node."""

    def __init__(self, node: InboxNode, parameters: ServerParameters, *, run: Mapping[str, str]) -> None:
        """Begin the log, subscribe and create the services, which refuse all questions for now.

        Args:
            node: the node.
            parameters: how it is configured.
            run: what the log says of the run.

        Raises:
            ConfigurationError: a source or the log's folder is not there.
        """
        self._node = node
        self._core = core = ServerCore(parameters)
        # The log begins after this, so that a configuration with an unknown source leaves no log.
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
        self._path = node.create_publisher(Path, "~/predicted_path", PATH_QOS)
        limits = parameters.worker_limits
        self._workers = Workers(limits) if limits.count > 0 else None
        self._answer_times = AnswerTimes()
        self._diagnostics = Diagnostics(node)
        self._looked = time.monotonic()
        self._awake_since = self._looked
        self._took_events = 0.0
        self._fronts = [self._serve(service) for service in SERVICES]
        self._log.start()
        # A simulation or a log that is played again: without this its new states would count as old ones.
        # It comes last, since the clock goes on to call what is not unregistered, and ends the process if
        # that is not there any more.
        set_back = JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1))
        self._jumps = node.get_clock().create_jump_callback(
            set_back, post_callback=lambda _: core.states.clear()
        )

    def __str__(self) -> str:
        """Return in words what is served."""
        names = [body.name for body in self._core.world.bodies]
        bodies = ", ".join(name if name in self._bodies else f"{name} (no state topic)" for name in names)
        return f"bodies {bodies or 'none'}; log {self._log.folder or 'off'}"

    @property
    def is_active(self) -> bool:
        """Whether questions are answered."""
        return all(front.is_active for front in self._fronts)

    @property
    def is_ready(self) -> bool:
        """Whether all kinds of questions can be answered, for some of which workers have to be ready."""
        return self._workers is None or self._workers.ready == self._workers.count

    @property
    def preparations(self) -> str:
        """In words, what is still made ready."""
        count = 0 if self._workers is None else self._workers.count
        return f"{count} workers start; quick questions are answered meanwhile"

    def activate(self, *, is_active: bool) -> None:
        """Answer questions from now on, or refuse them."""
        for front in self._fronts:
            front.is_active = is_active

    def change(self, parameters: ServerParameters, *, event: bytes, run: Mapping[str, str]) -> None:
        """Answer with another configuration from now on, and log it.

        Args:
            parameters: the configuration, which `check_change` allows.
            event: the change as a serialised event.
            run: what the log says of the run from now on.
        """
        self._node.take_messages()  # what came before is of the configuration before
        now_ns = time.time_ns()
        self._node.note_question(now_ns)  # and what is taken from here on counts as later
        self._log.record(CHANGES, event, log_time_ns=now_ns)
        self._log.change_run(run)
        self._core.change(parameters)
        for topic in self._topics:
            topic.source = self._core.sources[topic.name]
        self._note_publishers()
        self._twist_axes = _watch_twists(parameters)
        self._faults.limits = parameters.fault_limits
        for front in self._fronts:
            front.gone.gone_for = parameters.client_gone_for
        if self._workers is not None:
            self._workers.limits = parameters.worker_limits

    def attend(self) -> None:
        """Take the events that wait, unless that was done a moment ago, and look around once a second."""
        now = time.monotonic()
        if now - self._took_events >= EVENTS_EVERY_S:
            self._take_events()
        since_look = now - self._looked
        if since_look >= LOOK_EVERY_S:
            self._looked = now
            if since_look > STOOD_STILL_S:
                self._awake_since = self._looked
            self._look()

    def refuse_all(self) -> None:
        """Refuse the questions whose answers are not there yet, and stay until clients have that."""
        begun = time.monotonic()
        until = begun + _HANDED_OVER_WITHIN_S
        while True:
            if sum(front.refuse_all() for front in self._fronts) > 0:
                until = min(time.monotonic() + _SENT_AGAIN_FOR_S, begun + _REFUSES_FOR_S)
            if time.monotonic() >= until:
                return
            time.sleep(EVENTS_EVERY_S)

    def close(self) -> str:
        """End the workers, and finish the log; return in words where that is."""
        self.refuse_all()
        self.end_workers()
        self._node.take_messages()
        self._take_events()
        return self._log.close()

    def remove(self) -> None:
        """Take what this made from the node."""
        self._jumps.unregister()
        for front in self._fronts:
            front.remove()
        self._node.unsubscribe()
        self._node.destroy_publisher(self._path)
        self._diagnostics.remove()

    def end_workers(self) -> None:
        """End the processes that answer."""
        if self._workers is not None:
            self._workers.close()

    def _take_events(self) -> None:
        """Take all service events that wait, which are those of clients and of answers that left."""
        self._took_events = time.monotonic()
        for front in self._fronts:
            front.take_events()

    def _look(self) -> None:
        """Look at topics and other nodes, and tell how everything is."""
        present = [
            *self._look_at_states(),
            *self._look_at_names(),
            *self._answer_times.look(),
            *self._look_at_workers(),
            *self._log.present(),
        ]
        waiting = 0 if self._workers is None else self._workers.waiting
        self._diagnostics.publish(
            {
                Part.STATES: values_of_topics([each.traffic for each in self._topics], self._faults.counts),
                Part.ANSWERS: {**self._answer_times.values(), "hard questions that wait": str(waiting)},
                Part.LOG: values_of_log(self._log.status),
            },
            present,
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
        """Note, for whoever asks before the first state, on which topics how many publish."""
        self._core.expect({topic.name: topic.publishers for topic in self._topics})

    def _look_at_workers(self) -> list[Present]:
        if self.is_ready or self._workers is None:
            return []
        return [Situation.WORKERS.present(ready=self._workers.ready, count=self._workers.count)]

    def _look_at_names(self) -> list[Present]:
        full_names = [(namespace, name) for name, namespace in self._node.get_node_names_and_namespaces()]
        if full_names.count((self._node.get_namespace(), self._node.get_name())) < 2:
            return []
        present = Situation.SAME_NAME.present()
        self._faults.add(self._node.get_fully_qualified_name(), "same name", 1, present.text)
        return [present]

    def _serve(self, served: Service) -> ServiceFront:
        front = ServiceFront(
            self._node,
            served,
            core=self._core,
            workers=self._workers,
            log=self._log,
            answered=self._note_answer,
        )
        self._log.add_topic(
            front.topic, f"contact_dynamics_interfaces/srv/{served.type_name}_Event", EVENT_QOS
        )
        return front

    def _log_clock(self) -> None:
        """Log the simulated time, which the stamps of states and events are of, where there is one."""
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

    def _note_answer(self, response: Response) -> None:
        self._answer_times.note(response, is_active=self.is_active)
        self._publish_path(response)

    def _publish_path(self, response: Response) -> None:
        """Publish the newest trajectory for RViz, if somebody listens."""
        trajectory = getattr(response, "trajectory", None)
        is_path = trajectory is not None and response.status == response.OK
        if is_path and self._path.get_subscription_count() > 0:
            self._path.publish(path_from_trajectory(trajectory))


def _watch_twists(parameters: ServerParameters) -> list[tuple[str, TwistAxes]]:
    """Return the topics that have a body's only odometry, and a watch on its twists for each."""
    return [
        (body.sources[0].topics[0].full_name, TwistAxes(body.body_name, known.p_FB_F))
        for body, known in zip(parameters.sources, parameters.world.bodies, strict=True)
        if [source.adapter for source in body.sources] == ["odometry"]
    ]
