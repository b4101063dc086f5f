"""The server: one process with the three services, one store of states, and the log.

It watches published states and answers `~/predict_contact_mode`, `~/predict_impact` and `~/predict_tumbling`.
Drawing happens in another process (`visualizer`), which listens to the service events that this node
publishes.
"""

from __future__ import annotations

import time
import traceback
from typing import TYPE_CHECKING, Any

from nav_msgs.msg import Path
from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.service_introspection import ServiceIntrospectionState
from rosgraph_msgs.msg import Clock

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.arguments import VISUALIZER_PARAMETERS, server_parser
from contact_dynamics.nodes.call_times import CallTimes
from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.node_parameters import NodeParameters, refuse_unknown_parameters
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.run_record import NODE_NAME, run_record
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.services import SERVICES
from contact_dynamics.nodes.state_subscriptions import STATE_QOS, subscribe_to_states
from contact_dynamics.questions.knowledge import Knowledge
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters.path import path_from_trajectory
from msg_adapters.status import report_error

if TYPE_CHECKING:
    from rclpy.subscription import Subscription

    from contact_dynamics.nodes.inbox import Taken
    from contact_dynamics.nodes.services import Request, Service
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


class Server(InboxNode):
    """The node `contact_dynamics`."""

    def __init__(self, **node_options: Any) -> None:
        """Read the parameters, begin the log, subscribe and serve.

        Raises:
            ConfigurationError: a parameter is missing, unknown or not allowed.
        """
        super().__init__(NODE_NAME, **node_options)
        source = NodeParameters(self)
        parameters = read_server_parameters(source)
        # One file may configure both nodes.
        refuse_unknown_parameters(self, also_known=VISUALIZER_PARAMETERS)
        states = StateStore(
            history=parameters.state_history,
            timeout=parameters.state_timeout,
            future_tolerance=parameters.future_tolerance,
        )
        # A simulation or a log that is played again: without this its new states would count as old ones.
        set_back = JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1))
        self._jumps = self.get_clock().create_jump_callback(set_back, post_callback=lambda _: states.clear())
        self._asked_ns = 0  # when the present question came, by the node's clock
        self._knowledge = Knowledge(
            world=parameters.world,
            states=states,
            defaults=parameters.defaults,
            now_ns=lambda: self._asked_ns or None,  # zero before a simulation tells the time
        )
        self._world_frame = parameters.world_frame
        # The log begins after this, so that a configuration with an unknown source leaves no log.
        types = subscribe_to_states(self, parameters, states=states, record=self._record)
        self._log = Log(
            parameters.log_directory if parameters.log else None,
            run=self._run_description(source.topics),
            limits=parameters.log_limits,
            on_problem=self.get_logger().error,
            on_deleted=self.get_logger().warning,
        )
        for topic, type_name in types.items():
            self._log.add_topic(topic, type_name, STATE_QOS)
        self._log_clock()
        self._path = self.create_publisher(Path, "~/predicted_path", PATH_QOS)
        self._events: list[Subscription] = []
        for service in SERVICES:
            self._serve(service)
        self._log.start()
        bodies = ", ".join(body.name for body in parameters.world.bodies) or "none"
        self.get_logger().info(f"ready: bodies {bodies}; log {self._log.folder or 'off'}")

    def attend(self) -> None:
        """Take messages, and the events of the answer that has just left."""
        super().attend()
        for events in self._events:
            self.empty(events)

    def close(self) -> bool:
        """Finish the log and say where it is; return True, since a log that fails has been told."""
        self.take_messages()
        self.get_logger().info(self._log.close())
        return True

    def _serve(self, served: Service) -> None:
        service_type = served.service_type
        times = CallTimes(lambda: self.get_clock().now().nanoseconds)

        def handle(request: Request, response: Response) -> Response:
            self.take_messages()
            self._asked_ns = times.begin()
            self.note_question(time.time_ns())
            start = time.perf_counter()
            try:
                served.serve(request, response, self._knowledge, world_frame=self._world_frame)
            except ContactDynamicsError as error:
                response = service_type.Response()
                report_error(response, error)
            except Exception as error:  # noqa: BLE001  a fault in one answer must not end the service
                self.get_logger().error(f"{served.name} failed:\n{traceback.format_exc()}")
                response = service_type.Response()
                report_error(response, error)
            response.computation_time = time.perf_counter() - start
            if service_type is PredictTumbling and response.status == response.OK:
                self._publish_path(response)
            times.end()
            return response

        def record(event: Taken) -> None:
            happened = times.of_event(event.data)
            self._log.record(
                events, event.data, log_time_ns=happened.log_time_ns, publish_time_ns=happened.publish_time_ns
            )

        service = self.create_service(service_type, f"~/{served.name}", handle, qos_profile=SERVICE_QOS)
        service.configure_introspection(self.get_clock(), EVENT_QOS, ServiceIntrospectionState.CONTENTS)
        events = f"{service.service_name}/_service_event"
        self._log.add_topic(events, f"contact_dynamics_interfaces/srv/{served.type_name}_Event", EVENT_QOS)
        self._events.append(self.subscribe(service_type.Event, events, record, EVENT_QOS, in_rounds=False))

    def _log_clock(self) -> None:
        """Log the simulated time, which the stamps of states and events are of, where there is one."""
        if not self._parameters["use_sim_time"].value:
            return

        def record(tick: Taken) -> None:
            self._record(topic, tick)

        topic: str = self.subscribe(Clock, "/clock", record, CLOCK_QOS).topic_name
        self._log.add_topic(topic, "rosgraph_msgs/msg/Clock", CLOCK_QOS)

    def _record(self, topic: str, taken: Taken) -> None:
        self._log.record(topic, taken.data, log_time_ns=taken.received_ns)

    def _publish_path(self, response: PredictTumbling.Response) -> None:
        """Publish the newest trajectory for RViz, if somebody listens."""
        if self._path.get_subscription_count() > 0:
            self._path.publish(path_from_trajectory(response.trajectory))

    def _run_description(self, topics: dict[str, str]) -> dict[str, str]:
        """Return all that an answer depends on besides the states; ``topics`` has their full names."""
        parameters = {name: self._parameters[name].value for name in sorted(self._parameters)}
        return run_record(parameters, topics)


def main(arguments: list[str]) -> int:
    """Run the server until it is told to stop; return the exit code."""
    return run_node(Server, verb="server", parser=server_parser(), arguments=arguments)
