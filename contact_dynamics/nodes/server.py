# SPDX-License-Identifier: Apache-2.0
"""The server: one process with the services, the states and the log.

It receives published states and answers the services of `questions.services`. The visualizer is another
process, which receives the service events of this node.
"""

from __future__ import annotations

import gc
import time
from typing import TYPE_CHECKING, Any, Final

from nav_msgs.msg import Path
from rclpy.qos import QoSProfile

from contact_dynamics.nodes.arguments import server_parser
from contact_dynamics.nodes.diagnostics import AnswerTimes
from contact_dynamics.nodes.managed_node import ManagedNode
from contact_dynamics.nodes.parameter_reader import NODE_NAME
from contact_dynamics.nodes.receiving import Receiving
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.service_front import EVENT_QOS, ServiceFront
from contact_dynamics.nodes.situations import Part, Present, Situation
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.questions.workers import Workers
from msg_adapters.tumbling import path_from_trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from contact_dynamics.nodes.inbox import InboxNode
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.questions.services import Service
    from msg_adapters.status import Response

PATH_QOS = QoSProfile(depth=1)
"""Queue of the predicted path. Only the latest path matters, since it is only displayed."""

EVENTS_EVERY_S: Final = 0.05
"""s. Interval at which events are taken that belong to no current call, which are those of clients."""

_SENT_AGAIN_FOR_S: Final = 1.0
"""s. Time for which a server that ends keeps its services after it has sent responses. DDS repeats them while
the service exists, if they overflow the socket of a client that a busy machine has stopped."""

_HANDED_OVER_WITHIN_S: Final = 0.1
"""s. Time for which a server that ends waits for requests that DDS has received and not delivered."""

_REFUSES_FOR_S: Final = 3.0  # s. Longest time for which a server that ends rejects new requests.


class Server(ManagedNode):
    """The node `contact_dynamics`."""

    def __init__(self, *, ros_arguments: Sequence[str] = (), **node_options: Any) -> None:
        """Read the parameters, and start if ``autostart`` is set (see `ManagedNode`)."""
        super().__init__(NODE_NAME, ros_arguments=ros_arguments, **node_options)

    def make_work(self, configuration: ServerParameters, run: Mapping[str, str]) -> Serving:
        """Return the services and the log."""
        return Serving(self, configuration, run=run)


def main(arguments: list[str]) -> int:
    """Run the server until a signal or a shutdown ends it; return the exit code."""
    return run_node(
        lambda ros_arguments: Server(ros_arguments=ros_arguments),
        verb="server",
        parser=server_parser(),
        arguments=arguments,
    )


class Serving(Receiving):
    """Receives states, answers requests and writes the log while the node is configured."""

    def __init__(self, node: InboxNode, parameters: ServerParameters, *, run: Mapping[str, str]) -> None:
        """Begin the log, subscribe and create the services, which reject all requests until `activate`.

        The errors are those of `Receiving`.
        """
        super().__init__(node, parameters, run=run)
        self._path = node.create_publisher(Path, "~/predicted_path", PATH_QOS)
        limits = parameters.worker_limits
        self._workers = Workers(limits) if limits.count > 0 else None
        self._answer_times = AnswerTimes()
        self._took_events = 0.0
        self._fronts = [self._serve(service) for service in SERVICES]
        self._unprepared = list(SERVICES)
        self._begin()

    @property
    def is_active(self) -> bool:
        """Whether requests are answered."""
        return all(front.is_active for front in self._fronts)

    @property
    def is_ready(self) -> bool:
        """Whether all kinds of requests can be answered, some of which require workers."""
        return self._workers is None or self._workers.ready == self._workers.count

    @property
    def preparations(self) -> str:
        """A text about what is not ready yet."""
        count = 0 if self._workers is None else self._workers.count
        return f"{count} workers start; inexpensive requests are answered meanwhile"

    def activate(self, *, is_active: bool) -> None:
        """Answer requests from now on, or reject them."""
        for front in self._fronts:
            front.is_active = is_active

    def change(self, parameters: ServerParameters, *, event: bytes, run: Mapping[str, str]) -> None:
        """Continue with another configuration, and log it (see `Receiving`)."""
        super().change(parameters, event=event, run=run)
        for front in self._fronts:
            front.gone.gone_for = parameters.client_gone_for
        if self._workers is not None:
            self._workers.limits = parameters.worker_limits

    def attend(self) -> None:
        """Take waiting events, import what services need, and report on /diagnostics once a second."""
        if time.monotonic() - self._took_events >= EVENTS_EVERY_S:
            self._take_events()
        if self._unprepared:  # one at a time, so that an early request waits for one import only
            self._unprepared.pop(0).prepare()
            gc.freeze()  # see `running`
        super().attend()

    def end(self) -> None:
        """Reject unanswered requests, and stay until their clients have received that."""
        begun = time.monotonic()
        until = begun + _HANDED_OVER_WITHIN_S
        while True:
            if sum(front.refuse_all() for front in self._fronts) > 0:
                until = min(time.monotonic() + _SENT_AGAIN_FOR_S, begun + _REFUSES_FOR_S)
            if time.monotonic() >= until:
                return
            time.sleep(EVENTS_EVERY_S)

    def close(self) -> str:
        """End the workers and finish the log; return a text about the log."""
        self.end()
        self.end_workers()
        self._node.take_messages()
        self._take_events()
        return super().close()

    def remove(self) -> None:
        """Remove the services and the publisher from the node."""
        for front in self._fronts:
            front.remove()
        self._node.destroy_publisher(self._path)
        super().remove()

    def end_workers(self) -> None:
        """End the worker processes."""
        if self._workers is not None:
            self._workers.close()

    def _take_events(self) -> None:
        """Take all waiting service events, which are those of clients and of sent responses."""
        self._took_events = time.monotonic()
        for front in self._fronts:
            front.take_events()

    def _values(self) -> Mapping[Part, Mapping[str, str]]:
        waiting = 0 if self._workers is None else self._workers.waiting
        return {Part.ANSWERS: {**self._answer_times.values(), "queued requests": str(waiting)}}

    def _present(self) -> list[Present]:
        present = [*self._look_at_names(), *self._answer_times.look()]
        if self._workers is not None and not self.is_ready:
            present.append(Situation.WORKERS.present(ready=self._workers.ready, count=self._workers.count))
        return present

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

    def _note_answer(self, response: Response) -> None:
        """Count a response, and publish its trajectory for RViz if there is a subscriber."""
        self._answer_times.note(response, is_active=self.is_active)
        trajectory = getattr(response, "trajectory", None)
        is_path = trajectory is not None and response.status == response.OK
        if is_path and self._path.get_subscription_count() > 0:
            self._path.publish(path_from_trajectory(trajectory))
