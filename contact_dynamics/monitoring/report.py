# SPDX-License-Identifier: Apache-2.0
"""Describes the events and estimates of a monitor in words."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import to_seconds
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.monitoring.evidence import REGIONS, Parameter

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.monitoring.changes import SurfaceReport
    from contact_dynamics.monitoring.monitor import MonitoredEvent
    from contact_dynamics.validation import FloatArray


def line_of(event: MonitoredEvent) -> str:
    """Return a description of one event in one line."""
    where = f" on {event.surface}" if event.surface else ""
    return f"{to_seconds(event.stamp_ns):.3f} s, {event.body}{where}: {event.kind.value}, " + ", ".join(
        _parts(event)
    )


def _parts(event: MonitoredEvent) -> Iterator[str]:
    if event.as_predicted is not None:
        if event.as_predicted:
            yield f"{event.measured_mode} measured, as predicted"
        else:
            predicted = " or ".join(map(_mode, event.predicted_mode.split("|")))
            yield f"{_mode(event.measured_mode)} measured, predicted {predicted}"
    elif event.probability is None:
        yield f"not compared ({event.problem or 'no covariance'})"
    else:
        region = event.smallest_region or 1.0
        where = f"inside {100 * region:.0f} %" if region < 1.0 else f"outside {100 * REGIONS[-1]:.0f} %"
        yield f"{where}, p = {event.probability:.2g}"
    if event.explained_by is not None:
        yield f"another {event.explained_by.value} explains it"
    report = event.surface_report
    if report is not None:
        yield f"this impact has {_values(event.impact_values, event.impact_stds)}"
        if report.is_new and report.changed is not None:
            yield f"CHANGED: {report.changed.value} of {event.surface}, now {estimates_in_words(report)}"


def _mode(mode: str) -> str:
    return f"{mode} ({mode_in_words(mode, turns=False)})" if mode.islower() else mode  # or a verdict


def estimates_in_words(report: SurfaceReport) -> str:
    """Return the estimates for a surface."""
    return f"{_values(report.values, report.stds)} from {report.impacts} impacts"


def _values(values: FloatArray, stds: FloatArray) -> str:
    return ", ".join(
        f"{parameter.value} unknown" if np.isnan(value) else f"{parameter.value} {value:.3f} +- {std:.3f}"
        for parameter, value, std in zip(Parameter, values, stds, strict=True)
    )


class Summary:
    """Counts events and correct predictions by kind, and keeps the latest report of each surface.

    Attributes:
        latest: The latest report of each surface, by name.
    """

    def __init__(self) -> None:
        """Start without events."""
        self.latest: dict[str, SurfaceReport] = {}
        self._counts: defaultdict[str, Counter[str]] = defaultdict(Counter)
        self._inside: defaultdict[str, FloatArray] = defaultdict(lambda: np.zeros(len(REGIONS)))

    def add(self, event: MonitoredEvent) -> None:
        """Count an event."""
        kind = event.kind.value
        counts = self._counts[kind]
        counts["events"] += 1
        if event.regions:
            counts["compared"] += 1
            self._inside[kind] += event.regions
        if event.as_predicted is not None:
            counts["modes"] += 1
            counts["as predicted"] += event.as_predicted
        if event.surface_report is not None:
            self.latest[event.surface] = event.surface_report

    def rows(self) -> dict[str, str]:
        """Return a description of each kind of event and of each surface."""
        found = {}
        for kind, counts in self._counts.items():
            parts = [f"{counts['events']} events"]
            if counts["compared"]:
                shares = ", ".join(
                    f"{100 * share:.0f} % inside {100 * region:.0f} %"
                    for region, share in zip(REGIONS, self._inside[kind] / counts["compared"], strict=True)
                )
                parts.append(f"{counts['compared']} compared: {shares}")
            if counts["modes"]:
                parts.append(f"{counts['as predicted']} of {counts['modes']} as predicted")
            found[kind] = ", ".join(parts)
        for surface, report in self.latest.items():
            changed = f"; {report.changed.value} changed" if report.changed else ""
            found[surface] = f"{estimates_in_words(report)}{changed}"
        return found

    def __str__(self) -> str:
        """Return one line per row."""
        return "\n".join(f"{name}: {text}" for name, text in self.rows().items()) or "no events"
