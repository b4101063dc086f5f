# SPDX-License-Identifier: Apache-2.0
"""The events of a monitor in words."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import to_seconds
from contact_dynamics.monitoring.evidence import REGIONS, Parameter

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.monitoring.changes import SurfaceReport
    from contact_dynamics.monitoring.monitor import MonitoredEvent
    from contact_dynamics.validation import FloatArray


def line_of(event: MonitoredEvent) -> str:
    """Return one event in a line."""
    where = f" on {event.surface}" if event.surface else ""
    return f"{to_seconds(event.stamp_ns):.3f} s, {event.body}{where}: {event.kind.value}, " + ", ".join(
        _parts(event)
    )


def _parts(event: MonitoredEvent) -> Iterator[str]:
    if event.as_predicted is not None:
        verdict = "as predicted" if event.as_predicted else f"predicted {event.predicted_mode}"
        yield f"{event.measured_mode} measured, {verdict}"
    elif event.probability is None:
        yield f"not compared ({event.problem or 'no covariance'})"
    else:
        inside = next((region for region, is_in in zip(REGIONS, event.regions, strict=True) if is_in), None)
        where = f"inside {100 * inside:.0f} %" if inside else f"outside {100 * REGIONS[-1]:.0f} %"
        yield f"{where}, p = {event.probability:.2g}"
    if event.explained_by is not None:
        yield f"another {event.explained_by.value} explains it"
    report = event.surface_report
    if report is not None:
        yield f"this impact has {_values(event.impact_values, event.impact_stds)}"
        if report.is_new and report.changed is not None:
            yield f"CHANGED: {report.changed.value} of {event.surface}, now {_estimates(report)}"


def _estimates(report: SurfaceReport) -> str:
    return f"{_values(report.values, report.stds)} from {report.impacts} impacts"


def _values(values: FloatArray, stds: FloatArray) -> str:
    return ", ".join(
        f"{parameter.value} unknown" if np.isnan(value) else f"{parameter.value} {value:.3f} +- {std:.3f}"
        for parameter, value, std in zip(Parameter, values, stds, strict=True)
    )


def summary_of(events: Sequence[MonitoredEvent]) -> str:
    """Return how many events of each kind were predicted how well, and the estimates for each surface."""
    lines = []
    for kind, count in Counter(event.kind for event in events).items():
        own = [event for event in events if event.kind is kind]
        parts = [f"{kind.value}: {count} events"]
        regions = np.array([event.regions for event in own if event.regions])
        if len(regions):
            shares = ", ".join(
                f"{100 * share:.0f} % inside {100 * region:.0f} %"
                for region, share in zip(REGIONS, regions.mean(axis=0), strict=True)
            )
            parts.append(f"{len(regions)} compared: {shares}")
        modes = [event.as_predicted for event in own if event.as_predicted is not None]
        if modes:
            parts.append(f"{sum(modes)} of {len(modes)} as predicted")
        lines.append(", ".join(parts))
    latest = {event.surface: event.surface_report for event in events if event.surface_report is not None}
    for surface, report in latest.items():
        changed = f"; {report.changed.value} changed" if report.changed else ""
        lines.append(f"{surface}: {_estimates(report)}{changed}")
    return "\n".join(lines) or "no events"
