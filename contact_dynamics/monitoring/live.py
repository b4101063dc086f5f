# SPDX-License-Identifier: Apache-2.0
"""The monitor as a node: published states in, a message for each event out, and both in a log.

It is a managed node with the server's parameters (`nodes.managed_node`). While it is active, the states go
to the same `Monitor` as those of a recording. `contact-dynamics monitor` therefore reports the same events
for its log.
"""

from __future__ import annotations

import math
import time
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.serialization import serialize_message

from contact_dynamics.evaluation.log_states import informed_by
from contact_dynamics.evaluation.model_error import ModelError, model_error_of
from contact_dynamics.monitoring.monitor import LOOK_EVERY, SILENT, Monitor, MonitorSettings
from contact_dynamics.monitoring.report import Summary, estimates_in_words, line_of
from contact_dynamics.nodes.arguments import live_monitor_parser
from contact_dynamics.nodes.managed_node import ManagedNode
from contact_dynamics.nodes.other_parameters import CALIBRATION, MONITOR_NAME, MONITOR_PARAMETERS
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.receiving import Receiving
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.service_front import EVENT_QOS
from contact_dynamics.nodes.situations import Part, Present, Situation
from contact_dynamics.nodes.state_subscriptions import PassedOn
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.recording.cdr import cut_to_its_end
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.replay.timeline import MONITOR_EVENT
from contact_dynamics_interfaces.msg import MonitorEvent
from msg_adapters.stamps import stamp_to_msg

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from contact_dynamics.monitoring.evidence import Parameter
    from contact_dynamics.monitoring.monitor import MonitoredEvent
    from contact_dynamics.nodes.inbox import InboxNode, Taken
    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.questions.uncertain_state import KnownState


def event_to_msg(event: MonitoredEvent, *, frame_id: str) -> MonitorEvent:
    """Return an event as a message in the world frame ``frame_id``."""
    msg = MonitorEvent(
        body_name=event.body,
        surface_name=event.surface,
        kind=event.kind.value,
        text=line_of(event),
        region=round(100.0 * (event.smallest_region or 0.0)),
        probability=_or_nan(event.probability),
        time_error=_or_nan(event.time_error),
        predicted_mode=event.predicted_mode,
        measured_mode=event.measured_mode,
        problem=event.problem,
        explained_by=_name(event.explained_by),
    )
    msg.header.frame_id = frame_id
    stamp_to_msg(event.stamp_ns, into=msg.header.stamp)
    msg.restitution, msg.friction = event.impact_values.tolist()
    msg.restitution_std, msg.friction_std = event.impact_stds.tolist()
    report = event.surface_report
    values, stds = ([math.nan] * 2,) * 2 if report is None else (report.values.tolist(), report.stds.tolist())
    msg.estimated_restitution, msg.estimated_friction = values
    msg.estimated_restitution_std, msg.estimated_friction_std = stds
    if report is not None:
        msg.impacts, msg.changed, msg.alarm = report.impacts, _name(report.changed), report.is_new
    return msg


def _or_nan(number: float | None) -> float:
    return math.nan if number is None else number


def _name(parameter: Parameter | None) -> str:
    return "" if parameter is None else parameter.value


class Monitoring(Receiving):
    """Receives states, publishes events and writes the log of both, for a node."""

    def __init__(
        self, node: InboxNode, parameters: ServerParameters, *, run: Mapping[str, str], error: ModelError
    ) -> None:
        """Begin the log and subscribe, without monitoring; ``error`` is the model error of predictions.

        The errors are those of `Receiving`.
        """
        import_module("scipy.stats")  # with what answers: imported at the first event, it would delay states
        for service in SERVICES:
            service.prepare()
        self._is_active = False
        self._came_ns = 0
        self._came: dict[str, float] = {}  # s, arrival of the last state of each body with unsettled events
        self._summary = Summary()
        self._monitor = Monitor(informed_by(parameters), MonitorSettings(error=error))
        super().__init__(node, parameters, run=run, states=PassedOn(self._take, is_stored=True))
        self._publisher = node.create_publisher(MonitorEvent, "~/events", EVENT_QOS)
        self._definition = find_definition(MONITOR_EVENT)
        self._log.add_topic(self._publisher.topic_name, MONITOR_EVENT, EVENT_QOS)
        self._begin()

    def activate(self, *, is_active: bool) -> None:
        """Start or stop monitoring."""
        self._is_active = is_active
        self._tell(self._monitor.finish())

    def attend(self) -> None:
        """Publish the last events of silent bodies, and check topics once a second."""
        now = time.monotonic()
        for body_name in [name for name, came in self._came.items() if now - came > SILENT + LOOK_EVERY]:
            del self._came[body_name]
            self._tell(self._monitor.settle(body_name))
        super().attend()

    def change(self, parameters: ServerParameters, *, event: bytes, run: Mapping[str, str]) -> None:
        """Predict with another configuration from now on, and log it (see `Receiving`)."""
        super().change(parameters, event=event, run=run)
        self._tell(self._monitor.finish())
        self._monitor.informed = informed_by(parameters)

    def close(self) -> str:
        """Publish the last events, and finish the log; return a text about it."""
        self._node.take_messages()
        self._tell(self._monitor.finish())
        return super().close()

    def remove(self) -> None:
        """Remove the publisher, subscriptions and other publishers from the node."""
        self._node.destroy_publisher(self._publisher)
        super().remove()

    def _record(self, topic: str, taken: Taken) -> None:
        self._came_ns = taken.received_ns
        super()._record(topic, taken)

    def _forget_states(self) -> None:
        super()._forget_states()
        self._tell(self._monitor.finish())

    def _take(self, body_name: str, state: KnownState) -> None:
        if self._is_active:
            self._came[body_name] = time.monotonic()
            self._tell(self._monitor.add(body_name, state, self._came_ns))

    def _tell(self, events: Iterable[MonitoredEvent]) -> None:
        for event in events:
            self._summary.add(event)
            msg = event_to_msg(event, frame_id=self._core.parameters.world_frame)
            data = cut_to_its_end(serialize_message(msg), self._definition)
            self._publisher.publish(data)
            self._log.record(self._publisher.topic_name, data, log_time_ns=time.time_ns())
            if msg.alarm:
                self._node.get_logger().warning(msg.text)
            else:
                self._node.get_logger().info(msg.text)

    def _values(self) -> Mapping[Part, Mapping[str, str]]:
        return {Part.EVENTS: self._summary.rows()}

    def _present(self) -> list[Present]:
        return [
            Situation.CHANGED.present(
                coefficient=report.changed.value, surface=surface, estimates=estimates_in_words(report)
            )
            for surface, report in self._summary.latest.items()
            if report.changed is not None
        ]


class LiveMonitor(ManagedNode):
    """The node `contact_dynamics_monitor`."""

    def __init__(self, *, ros_arguments: Sequence[str] = (), **node_options: Any) -> None:
        """Read the parameters, and start if ``autostart`` is set (see `ManagedNode`)."""
        super().__init__(MONITOR_NAME, own=MONITOR_PARAMETERS, ros_arguments=ros_arguments, **node_options)

    def _read(self, source: ParameterSource) -> ServerParameters:
        """Read every parameter, and reject surfaces that move with a body."""
        parameters = super()._read(source)
        informed_by(parameters)
        return parameters

    def make_work(self, configuration: ServerParameters, run: Mapping[str, str]) -> Monitoring:
        """Return the object that monitors while the node is active."""
        if not any(body.sources for body in configuration.sources):
            message = "body.NAME.odometry_topic, or another topic of states, is required for one body"
            raise ConfigurationError(message)
        path: str = self.get_parameter(CALIBRATION).value
        error = model_error_of(Path(path), CALIBRATION) if path else ModelError()
        for doubt in error.doubts(body.name for body in configuration.world.bodies):
            self.get_logger().warning(doubt)
        return Monitoring(self, configuration, run=run, error=error)


def main(arguments: list[str]) -> int:
    """Run the monitor until a signal or a shutdown ends it; return the exit code."""
    return run_node(
        lambda ros_arguments: LiveMonitor(ros_arguments=ros_arguments),
        verb="live_monitor",
        parser=live_monitor_parser(),
        arguments=arguments,
    )
