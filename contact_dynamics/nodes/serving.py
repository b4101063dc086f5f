# SPDX-License-Identifier: Apache-2.0
"""While it is configured, the server receives states, answers by its services, and has workers for that."""

from __future__ import annotations

import gc
import time
from typing import TYPE_CHECKING, Final

from nav_msgs.msg import Path
from rclpy.qos import QoSProfile

from contact_dynamics.nodes.diagnostics import AnswerTimes
from contact_dynamics.nodes.receiving import Receiving
from contact_dynamics.nodes.service_front import EVENT_QOS, ServiceFront
from contact_dynamics.nodes.situations import Part, Present, Situation
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.questions.workers import Workers
from msg_adapters.tumbling import path_from_trajectory

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.nodes.inbox import InboxNode
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.questions.services import Service
    from msg_adapters.status import Response

PATH_QOS = QoSProfile(depth=1)
"""Queue of the predicted trajectory as a path. It is a picture, and only the newest one matters."""

EVENTS_EVERY_S: Final = 0.05
"""s. Time between two looks for events that no call of the moment is about, which are those of clients."""

_SENT_AGAIN_FOR_S: Final = 1.0
"""s. Many answers at once overflow the socket of a client that a busy machine stops meanwhile. DDS sends them
again, for as long as the service is there."""

_HANDED_OVER_WITHIN_S: Final = 0.1
"""s. A server that ends waits so long for requests that had arrived, and that DDS has not handed over yet."""

_REFUSES_FOR_S: Final = 3.0
"""s. A server that ends refuses what still arrives for so long at most."""


class Serving(Receiving):
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
        """Whether questions are answered."""
        return all(front.is_active for front in self._fronts)

    @property
    def is_ready(self) -> bool:
        """Whether all kinds of questions can be answered, for some of which workers have to be ready."""
        are_workers_ready = self._workers is None or self._workers.ready == self._workers.count
        return are_workers_ready and not self._unprepared

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
        """Answer with another configuration from now on, and log it (see `Receiving`)."""
        super().change(parameters, event=event, run=run)
        for front in self._fronts:
            front.gone.gone_for = parameters.client_gone_for
        if self._workers is not None:
            self._workers.limits = parameters.worker_limits

    def attend(self) -> None:
        """Take the events that wait, unless that was done a moment ago, and look around once a second."""
        if time.monotonic() - self._took_events >= EVENTS_EVERY_S:
            self._take_events()
        if self._unprepared:  # one at a time, so that a first request waits for one of them at most
            self._unprepared.pop(0).prepare()
            gc.freeze()  # see `running`
        super().attend()

    def end(self) -> None:
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
        self.end()
        self.end_workers()
        self._node.take_messages()
        self._take_events()
        return super().close()

    def remove(self) -> None:
        """Take what this made from the node."""
        for front in self._fronts:
            front.remove()
        self._node.destroy_publisher(self._path)
        super().remove()

    def end_workers(self) -> None:
        """End the processes that answer."""
        if self._workers is not None:
            self._workers.close()

    def _take_events(self) -> None:
        """Take all service events that wait, which are those of clients and of answers that left."""
        self._took_events = time.monotonic()
        for front in self._fronts:
            front.take_events()

    def _values(self) -> Mapping[Part, Mapping[str, str]]:
        waiting = 0 if self._workers is None else self._workers.waiting
        return {Part.ANSWERS: {**self._answer_times.values(), "hard questions that wait": str(waiting)}}

    def _present(self) -> list[Present]:
        return [*self._look_at_names(), *self._answer_times.look(), *self._look_at_workers()]

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

    def _note_answer(self, response: Response) -> None:
        self._answer_times.note(response, is_active=self.is_active)
        self._publish_path(response)

    def _publish_path(self, response: Response) -> None:
        """Publish the newest trajectory for RViz, if somebody listens."""
        trajectory = getattr(response, "trajectory", None)
        is_path = trajectory is not None and response.status == response.OK
        if is_path and self._path.get_subscription_count() > 0:
            self._path.publish(path_from_trajectory(trajectory))
