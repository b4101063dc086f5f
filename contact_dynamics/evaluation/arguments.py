"""The arguments of `contact-dynamics evaluate`. This file imports what help needs, and no more."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

LAWS: Final = ("poisson", "newton", "energetic", "in time")
"""The names of the laws; a test holds them to `settings.Law`."""

HORIZONS: Final = (0.02, 0.05, 0.1, 0.2)
"""s, as in `settings`; a test holds the two together."""

FIT_WINDOW: Final = 0.1
"""s, as in `settings`, held by the same test."""


def evaluate_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics evaluate`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics evaluate",
        usage="%(prog)s [options] RECORDING [RECORDING ...]",
        description="Find the events in what was measured (flights, first contacts, impacts, rests, slides), "
        "ask about each as it would have been asked some time before, and compare with what came. This needs "
        "no ROS. docs/evaluate.md explains every number.",
        epilog="exit code: 0 all recordings were evaluated; 1 some were not; 2 none was, or an argument is "
        "wrong",
    )
    add_recordings(parser)
    _add_what_is_asked(parser)
    _add_who_does_it(parser)
    _add_outputs(parser)
    return parser


def add_recordings(parser: argparse.ArgumentParser) -> None:
    """Add the recordings that `sources.find_sources` finds."""
    parser.add_argument(
        "recordings",
        nargs="*",
        metavar="RECORDING",
        help="log (its folder or .mcap or .db3 file), toss (.csv), tosses (.npz, or one of them: "
        "tosses.npz#17), or a folder in which all of these are looked for",
    )


def add_config(parser: argparse._ActionsContainer) -> None:
    """Add the configuration that recordings are read with."""
    parser.add_argument(
        "--config",
        type=Path,
        metavar="YAML",
        help="parameters of the server that describe bodies, surfaces and topics (default: those in the log; "
        "a toss has its own)",
    )


def _add_what_is_asked(parser: argparse.ArgumentParser) -> None:
    asked = parser.add_argument_group("what is asked")
    add_config(asked)
    asked.add_argument(
        "--horizons",
        type=_list_of_seconds,
        default=HORIZONS,
        metavar="MS,MS",
        help="how long before an event to ask, ms (default: 20,50,100,200)",
    )
    asked.add_argument(
        "--laws",
        type=_laws,
        default=LAWS,
        metavar="LAW,LAW",
        help=f"laws of impact: {', '.join(LAWS)} (default: all)",
    )
    asked.add_argument(
        "--fit-window",
        type=_seconds,
        default=FIT_WINDOW,
        metavar="MS",
        help="length of the states that a flight is fitted to, ms, at most since it began (default: 100)",
    )
    asked.add_argument(
        "--against",
        type=Path,
        metavar="FILE",
        help="compare with another configuration (.yaml), asked about the same events; or with the JSON of "
        "another evaluation of the same recordings, as by another version",
    )


def _add_who_does_it(parser: argparse.ArgumentParser) -> None:
    work = parser.add_argument_group("who does it")
    work.add_argument(
        "--jobs",
        type=_count,
        default=1,
        metavar="N",
        help="processes of this machine, which share the recordings, or the bodies of few logs (default: 1)",
    )
    work.add_argument(
        "--dask",
        default="",
        metavar="ADDRESS",
        help="scheduler of a Dask cluster whose workers see the recordings under the same paths, such as "
        "tcp://10.0.0.1:8786; or local:N for N workers here",
    )
    work.add_argument(
        "--results",
        type=Path,
        metavar="DIR",
        help="keep the result of each recording here, and go on from what is there",
    )


def _add_outputs(parser: argparse.ArgumentParser) -> None:
    outputs = parser.add_argument_group("what it writes besides the tables on the terminal")
    outputs.add_argument("--json", type=Path, metavar="FILE", help="everything, for --against and programs")
    outputs.add_argument("--csv", type=Path, metavar="FILE", help="a row for each question")
    outputs.add_argument("--parquet", type=Path, metavar="FILE", help="the same (needs pyarrow)")
    outputs.add_argument(
        "--plots", type=Path, metavar="DIR", help="pictures of errors and coverage (needs matplotlib)"
    )
    outputs.add_argument(
        "--rerun",
        type=Path,
        metavar="FILE.rrd",
        help="events side by side, measured against predicted (needs rerun)",
    )


def _list_of_seconds(text: str) -> tuple[float, ...]:
    return tuple(_seconds(each) for each in text.split(","))


def _seconds(text: str) -> float:
    """Return s of a number of milliseconds."""
    try:
        value = float(text) / 1000.0
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"must be a number of milliseconds > 0, got {text!r}")
    return value


def _laws(text: str) -> tuple[str, ...]:
    laws = tuple(each.strip() for each in text.split(","))
    for law in laws:
        if law not in LAWS:
            raise argparse.ArgumentTypeError(f"must be one of {', '.join(LAWS)}, got {law!r}")
    return laws


def _count(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number >= 1, got {text!r}")
    return int(text)
