# SPDX-License-Identifier: Apache-2.0
"""`contact-dynamics monitor`: recordings are monitored in their order, and the events are printed."""

from __future__ import annotations

import json
import sys
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.evaluation.arguments import NOTHING, check_writable, run_on_recordings
from contact_dynamics.evaluation.log_states import parameters_of
from contact_dynamics.evaluation.model_error import ModelError, model_error_of
from contact_dynamics.evaluation.sources import find_sources
from contact_dynamics.monitoring.arguments import monitor_parser
from contact_dynamics.monitoring.monitor import Monitor, MonitorSettings
from contact_dynamics.monitoring.report import Summary, line_of
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.rotations.many import matrices_of

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator
    from pathlib import Path

    from contact_dynamics.evaluation.recording import Recording
    from contact_dynamics.evaluation.sources import Source
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.monitoring.monitor import MonitoredEvent
    from contact_dynamics.world import World

CHANGED: Final = 1  # exit code: a change is detected, or a recording could not be read


def main(arguments: list[str]) -> int:
    """Monitor; return the exit code."""
    return run_on_recordings(monitor_parser(), arguments, _monitor)


def _monitor(given: argparse.Namespace) -> int:
    check_writable(given.json)
    error = ModelError() if given.calibration is None else model_error_of(given.calibration)
    sources, refused = find_sources(given.recordings)
    monitor: Monitor | None = None
    summary, changed, bodies = Summary(), False, set[str]()
    with ExitStack() as stack:
        file = None if given.json is None else stack.enter_context(given.json.open("w", encoding="utf-8"))
        for source in sources:
            try:
                recording = _read(source, given.config)
            except (ContactDynamicsError, OSError) as problem:
                refused.append((source.name, str(problem)))
                continue
            settings = MonitorSettings(error=error, noise=_noise(source, recording))
            monitor = monitor or Monitor(recording.informed, settings)
            monitor.informed = recording.informed
            for event in monitored(monitor, recording):
                summary.add(event)
                bodies.add(event.body)
                changed |= event.surface_report is not None and event.surface_report.is_new
                print(f"{source.name}: {line_of(event)}", flush=True)
                if file is not None:
                    print(json.dumps({"recording": source.name, **event.to_dict()}), file=file)
    for name, reason in refused:
        print(f"not read: {name}: {reason}", file=sys.stderr)
    if monitor is None:
        return NOTHING
    print(summary)
    for doubt in error.doubts(bodies):
        print(doubt, file=sys.stderr)
    return CHANGED if changed or refused else 0


def monitored(monitor: Monitor, recording: Recording) -> Iterator[MonitoredEvent]:
    """Yield the events of a recording, whose states are added in the order of their arrival."""
    states = [
        (arrival_ns, motion.body.name, state)
        for motion in recording.motions
        for arrival_ns, state in zip(
            motion.arrivals_ns.tolist(), motion.states(list(range(len(motion)))), strict=True
        )
    ]
    for arrival_ns, name, state in sorted(states, key=lambda each: each[0]):
        yield from monitor.add(name, state, arrival_ns)
    yield from monitor.finish()


def _read(source: Source, config: Path | None) -> Recording:
    """Return a recording. The configuration, where one is given, also replaces the world of a toss."""
    recording = source.read(config=config)
    if config is None or not source.is_toss:
        return recording
    world = parameters_of(ParameterFile(config))[1].world
    return replace(
        recording,
        motions=tuple(_of_center(motion, world) for motion in recording.motions),
        informed=replace(recording.informed, world=world),
    )


def _of_center(motion: MeasuredMotion, world: World) -> MeasuredMotion:
    """Return a motion with the states of the centre of mass that is configured."""
    offset = world.body(motion.body.name).p_FB_F - motion.body.p_FB_F
    arms = matrices_of(motion.q_WB) @ offset
    return replace(motion, p_WB_W=motion.p_WB_W + arms, v_WB_W=motion.v_WB_W + np.cross(motion.w_WB_W, arms))


def _noise(source: Source, recording: Recording) -> tuple[float, float] | None:
    """Return the noise that the file of a toss has."""
    if not source.is_toss or not recording.motions:
        return None
    return recording.motions[0].position_noise, recording.motions[0].orientation_noise
