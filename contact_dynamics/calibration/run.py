# SPDX-License-Identifier: Apache-2.0
"""The command `contact-dynamics calibrate`, which reads recordings, and prints and writes the result."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Final

from contact_dynamics.calibration.arguments import calibrate_parser
from contact_dynamics.calibration.calibrate import calibrate
from contact_dynamics.calibration.plots import write_plots
from contact_dynamics.calibration.report import content_of, report, server_parameters
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.evaluation.arguments import check_writable, run_on_recordings
from contact_dynamics.evaluation.sources import find_sources
from contact_dynamics.replay.progress import Progress

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from contact_dynamics.calibration.result import Calibration
    from contact_dynamics.evaluation.sources import Source
    from contact_dynamics.measured.motion import MeasuredMotion

SOMETHING_OPEN: Final = 1  # exit code if the result is incomplete, or a recording could not be read


def main(arguments: list[str]) -> int:
    """Calibrate; return the exit code."""
    return run_on_recordings(calibrate_parser(), arguments, _calibrate)


def _calibrate(given: argparse.Namespace) -> int:
    check_writable(given.yaml, given.json, given.rerun)
    motions, names, refused = _motions(given)
    for name, reason in refused:
        print(f"not read: {name}: {reason}", file=sys.stderr)
    progress = Progress("calibrating", end=len(motions))
    try:
        found = calibrate(
            motions,
            names=names,
            free=given.free,
            with_paths=not given.no_trajectories,
            tell=lambda what, done, of: progress.tell(min(done, len(motions)), f"{what}, {done} of {of}"),
        )
    finally:
        progress.end()
    print(report(found), flush=True)
    _write(given, found)
    return SOMETHING_OPEN if refused or found.problems or found.undetermined else 0


def _motions(given: argparse.Namespace) -> tuple[list[MeasuredMotion], list[str], list[tuple[str, str]]]:
    """Return the motions of one body, the names of their recordings, and a list of unreadable ones."""
    sources, refused = find_sources(given.recordings)
    _check_config(given.config, sources)
    motions: list[MeasuredMotion] = []
    names: list[str] = []
    for source in sources:
        try:
            recording = source.read(config=given.config)
        except (ContactDynamicsError, OSError) as error:
            refused.append((source.name, str(error)))
            continue
        for motion in recording.motions:
            if given.body in {"", motion.body.name}:
                motions.append(motion)
                names.append(source.name.rpartition("/")[2])
    bodies = sorted({motion.body.name for motion in motions})
    if len(bodies) > 1:
        raise InvalidFieldError("--body", "nothing, with several bodies", f"one of {', '.join(bodies)}")
    if not motions:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in refused)
        what = f"states of body {given.body!r}" if given.body else "states of a body"
        why = f" ({reasons})" if reasons else ""
        raise InvalidFieldError("RECORDING", f"none with {what}{why}", "at least one")
    return motions, names, refused


def _check_config(config: Path | None, sources: list[Source]) -> None:
    """Reject a missing file, and report that tosses have their own body and surface anyway."""
    if config is None:
        return
    if not config.is_file():
        raise InvalidFieldError("--config", f"no file {str(config)!r}", "a file of the server's parameters")
    tosses = sum(source.is_toss for source in sources)
    if tosses:
        what = "of a toss" if tosses == 1 else f"of {tosses} tosses"
        print(f"--config does not count for the body and surface {what}: these are in it", file=sys.stderr)


def _write(given: argparse.Namespace, found: Calibration) -> None:
    if given.yaml is not None:
        given.yaml.write_text(server_parameters(found), encoding="utf-8")
        print(f"written: {given.yaml}")
    if given.json is not None:
        given.json.write_text(json.dumps(content_of(found), indent=1), encoding="utf-8")
        print(f"written: {given.json}")
    if given.plots is not None:
        for path in write_plots(given.plots, found):
            print(f"drawn: {path}")
    if given.rerun is not None:
        from contact_dynamics.calibration.picture import write_picture  # imports rerun

        print(f"drawn: {given.rerun} with {write_picture(given.rerun, found)} strikes")
