# SPDX-License-Identifier: Apache-2.0
"""The event of a monitor as a message."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from contact_dynamics.monitoring.report import line_of
from contact_dynamics_interfaces.msg import MonitorEvent
from msg_adapters.stamps import stamp_to_msg

if TYPE_CHECKING:
    from contact_dynamics.monitoring.evidence import Parameter
    from contact_dynamics.monitoring.monitor import MonitoredEvent

TYPE: Final = "contact_dynamics_interfaces/msg/MonitorEvent"


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
