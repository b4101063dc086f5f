"""What the server is while it is configured: the store of states, the log, the workers and the services."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from nav_msgs.msg import Path
from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from contact_dynamics.nodes.diagnostics import AnswerTimes, Diagnostics
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.service_front import ServiceFront
from contact_dynamics.nodes.services import SERVICES
from contact_dynamics.nodes.state_subscriptions import STATE_QOS, subscribe_to_states
from contact_dynamics.nodes.topic_faults import TopicFaults
from contact_dynamics.questions.knowledge import Knowledge
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.workers import Workers
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters.path import path_from_trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.nodes.inbox import InboxNode, Taken
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.nodes.services import Service
    from msg_adapters.status import Response

SERVICE_QOS = QoSProfile(depth=1000)
"""Queue depth of the services. With the usual 10, replies get lost when several clients ask at once."""

EVENT_QOS = QoSProfile(depth=10 * SERVICE_QOS.depth)
"""The queue of the service events is this deep. The log must lose none of them, and all requests that wait
are answered, each with two events, before the first of these events is taken."""

CLOCK_QOS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Queue of the simulated time. It matches every publisher, like the node's own subscription to the clock."""

PATH_QOS = QoSProfile(depth=1)
"""Queue of the predicted trajectory as a path. It is a picture, and only the newest one matters."""

LOOK_EVERY_S: Final = 1.0
"""s. Time between two looks at topics and other nodes, which /diagnostics then tells of."""


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
        self._world = parameters.world
        states = StateStore(
            history=parameters.state_history,
            timeout=parameters.state_timeout,
            future_tolerance=parameters.future_tolerance,
        )
        # A simulation or a log that is played again: without this its new states would count as old ones.
        set_back = JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1))
        self._jumps = node.get_clock().create_jump_callback(set_back, post_callback=lambda _: states.clear())
        self._asked_ns = 0  # when the present question came, by the node's clock
        self._knowledge = Knowledge(
            world=parameters.world,
            states=states,
            defaults=parameters.defaults,
            now_ns=lambda: self._asked_ns or None,  # zero before a simulation tells the time
        )
        self._world_frame = parameters.world_frame
        # The log begins after this, so that a configuration with an unknown source leaves no log.
        self._faults = TopicFaults(node.get_logger().warning)
        self._topics = subscribe_to_states(
            node, parameters, states=states, record=self._record, faults=self._faults
        )
        self._log = Log(
            parameters.log_directory if parameters.log else None,
            run=run,
            limits=parameters.log_limits,
            on_problem=node.get_logger().error,
            on_deleted=node.get_logger().warning,
        )
        for topic in self._topics:
            self._log.add_topic(topic.name, topic.type_name, STATE_QOS)
        self._log_clock()
        self._path = node.create_publisher(Path, "~/predicted_path", PATH_QOS)
        limits = parameters.worker_limits
        self._workers = Workers(limits) if limits.count > 0 else None
        self._answer_times = AnswerTimes()
        self._diagnostics = Diagnostics(node)
        self._looked = time.monotonic()
        self._fronts = [self._serve(service) for service in SERVICES]
        self._log.start()

    def __str__(self) -> str:
        """Return in words what is served."""
        bodies = ", ".join(body.name for body in self._world.bodies) or "none"
        return f"bodies {bodies}; log {self._log.folder or 'off'}"

    def activate(self, *, is_active: bool) -> None:
        """Answer questions from now on, or refuse them."""
        for front in self._fronts:
            front.is_active = is_active

    def attend(self) -> None:
        """Take the events of the answer that has just left, and look around once a second."""
        for front in self._fronts:
            front.take_events()
        if time.monotonic() - self._looked >= LOOK_EVERY_S:
            self._looked = time.monotonic()
            self._look()

    def close(self) -> str:
        """End the workers, and finish the log; return in words where that is."""
        self.end_workers()
        self._node.take_messages()
        self.attend()
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

    def _look(self) -> None:
        """Look at topics and other nodes, and tell how everything is."""
        for topic in self._topics:
            topic.look()
        full_names = [(namespace, name) for name, namespace in self._node.get_node_names_and_namespaces()]
        if full_names.count((self._node.get_namespace(), self._node.get_name())) > 1:
            text = "another node has this name: both answer the same questions"
            self._faults.add(self._node.get_fully_qualified_name(), "same name", 1, text)
        self._diagnostics.publish(
            self._diagnostics.of_topics([topic.traffic for topic in self._topics], self._faults.counts),
            self._diagnostics.of_answers(
                self._answer_times, 0 if self._workers is None else self._workers.waiting
            ),
            self._diagnostics.of_log(self._log.status),
        )

    def _serve(self, served: Service) -> ServiceFront:
        front = ServiceFront(
            self._node,
            served,
            knowledge=self._knowledge,
            world_frame=self._world_frame,
            workers=self._workers,
            begin=self._begin,
            answered=self._note_answer,
            qos=SERVICE_QOS,
            event_qos=EVENT_QOS,
            record=self._record_event,
        )
        self._log.add_topic(
            front.topic, f"contact_dynamics_interfaces/srv/{served.type_name}_Event", EVENT_QOS
        )
        return front

    def _begin(self, asked_ns: int) -> None:
        self._asked_ns = asked_ns

    def _record_event(self, topic: str, data: bytes, log_time_ns: int, publish_time_ns: int | None) -> None:
        self._log.record(topic, data, log_time_ns=log_time_ns, publish_time_ns=publish_time_ns)

    def _log_clock(self) -> None:
        """Log the simulated time, which the stamps of states and events are of, where there is one."""
        if not self._node.get_parameter("use_sim_time").value:
            return

        def record(tick: Taken) -> None:
            self._record(topic, tick)

        topic: str = self._node.subscribe(Clock, "/clock", record, CLOCK_QOS).topic_name
        self._log.add_topic(topic, "rosgraph_msgs/msg/Clock", CLOCK_QOS)

    def _record(self, topic: str, taken: Taken) -> None:
        self._log.record(topic, taken.data, log_time_ns=taken.received_ns)

    def _note_answer(self, response: Response) -> None:
        self._answer_times.note(response)
        self._publish_path(response)

    def _publish_path(self, response: Response) -> None:
        """Publish the newest trajectory for RViz, if somebody listens."""
        is_path = isinstance(response, PredictTumbling.Response) and response.status == response.OK
        if is_path and self._path.get_subscription_count() > 0:
            self._path.publish(path_from_trajectory(response.trajectory))  # type: ignore[attr-defined]
