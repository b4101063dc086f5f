# SPDX-License-Identifier: Apache-2.0
"""The arguments of `contact-dynamics evaluate`, and what it shares with `calibrate` and `monitor`.

This file imports only what `--help` needs.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.evaluation.settings import Law


def evaluate_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics evaluate`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics evaluate",
        usage="%(prog)s [options] RECORDING [RECORDING ...]",
        description="Find flights, first contacts, impacts, rests and slides in recordings, predict "
        "each from the states available some time before, and compare the predictions with what "
        "actually happened. ROS is not required. docs/evaluate.md explains the results.",
        epilog="The exit code is 0 if all recordings were evaluated, 1 if some were not, and 2 if "
        "none was or an argument is invalid.",
    )
    add_recordings(parser)
    _add_what_is_asked(parser)
    _add_who_does_it(parser)
    _add_outputs(parser)
    return parser


def add_recordings(parser: argparse.ArgumentParser) -> None:
    """Add the argument for the paths of recordings, which `sources.find_sources` resolves."""
    parser.add_argument(
        "recordings",
        nargs="*",
        metavar="RECORDING",
        help="log (its folder or .mcap or .db3 file), toss (.csv), tosses (.npz, or one of them: "
        "tosses.npz#17), or a folder that contains any of these",
    )


def add_config(parser: argparse._ActionsContainer) -> None:
    """Add the option for the configuration with which recordings are read."""
    parser.add_argument(
        "--config",
        type=Path,
        metavar="YAML",
        help="server parameters of bodies, surfaces and topics (default: those in the log or the toss)",
    )


def add_calibration(parser: argparse._ActionsContainer) -> None:
    """Add the option for a calibration, which `model_error.model_error_of` reads."""
    parser.add_argument(
        "--calibration",
        type=Path,
        metavar="FILE",
        help="--json file of calibrate, whose model errors widen the prediction regions",
    )


def _add_what_is_asked(parser: argparse.ArgumentParser) -> None:
    asked = parser.add_argument_group("predictions")
    add_config(asked)
    add_calibration(asked)
    asked.add_argument(
        "--horizons",
        type=_list_of_seconds,
        metavar="MS,MS",
        help="look-ahead times of the predictions, ms (default: 20,50,100,200)",
    )
    asked.add_argument(
        "--laws",
        type=_laws,
        metavar="LAW,LAW",
        help="impact laws: poisson, newton, energetic, in time (default: all)",
    )
    asked.add_argument(
        "--fit-window",
        type=_seconds,
        metavar="MS",
        help="length of the window of states to which a flight is fitted, ms (default: 100)",
    )
    asked.add_argument(
        "--against",
        type=Path,
        metavar="FILE",
        help="compare with predictions under another configuration (.yaml), or with the --json file "
        "of another evaluation of the same recordings",
    )


def _add_who_does_it(parser: argparse.ArgumentParser) -> None:
    work = parser.add_argument_group("processes")
    machines = work.add_mutually_exclusive_group()
    machines.add_argument(
        "--jobs",
        type=_count,
        metavar="N",
        help="number of processes on this machine, which share recordings, or bodies and events (default: "
        "one per processor, and fewer for short recordings)",
    )
    machines.add_argument(
        "--dask",
        default="",
        metavar="ADDRESS",
        help="scheduler of a Dask cluster whose workers find the recordings under the same paths, such as "
        "tcp://10.0.0.1:8786; or local:N for N workers on this machine",
    )
    work.add_argument(
        "--results",
        type=Path,
        metavar="DIR",
        help="folder for the results of single recordings, from which an interrupted evaluation continues",
    )


def _add_outputs(parser: argparse.ArgumentParser) -> None:
    outputs = parser.add_argument_group("output files")
    outputs.add_argument("--json", type=Path, metavar="FILE", help="the complete result")
    outputs.add_argument("--csv", type=Path, metavar="FILE", help="one row per prediction")
    outputs.add_argument("--parquet", type=Path, metavar="FILE", help="the same rows (requires pyarrow)")
    outputs.add_argument(
        "--plots", type=Path, metavar="DIR", help="plots of errors and coverage (requires Matplotlib)"
    )
    outputs.add_argument(
        "--rerun",
        type=Path,
        metavar="FILE.rrd",
        help="measured and predicted events side by side (requires rerun)",
    )


def _list_of_seconds(text: str) -> tuple[float, ...]:
    return tuple(_seconds(each) for each in text.split(","))


def _seconds(text: str) -> float:
    """Return a number of milliseconds in s. Less than one was meant in seconds."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1.0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"must be a number of milliseconds >= 1, got {text!r}")
    return value / 1000.0


def _laws(text: str) -> tuple[Law, ...]:
    from contact_dynamics.evaluation.settings import Law  # not needed for --help

    known = {law.value: law for law in Law}
    laws = [each.strip() for each in text.split(",")]
    for law in laws:
        if law not in known:
            raise argparse.ArgumentTypeError(f"must be one of {', '.join(known)}, got {law!r}")
    return tuple(known[law] for law in laws)


def _count(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number >= 1, got {text!r}")
    return int(text)


NOTHING: Final = 2  # exit code if no recording could be used, or an argument is invalid


def run_on_recordings(
    parser: argparse.ArgumentParser, arguments: list[str], work: Callable[[argparse.Namespace], int]
) -> int:
    """Parse the arguments, call ``work``, and return the exit code. Errors are printed."""
    given = parser.parse_args(arguments)
    if not given.recordings:  # not by argparse, so that a mistyped option is reported first
        parser.error("at least one RECORDING is required")
    try:
        return work(given)
    except (ContactDynamicsError, OSError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return NOTHING


def check_writable(*files: Path | None) -> None:
    """Check that the output files can be written, before the evaluation starts, or raise `OSError`."""
    for path in files:
        if path is not None:
            with path.open("ab"):
                pass
