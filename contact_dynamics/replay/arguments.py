# SPDX-License-Identifier: Apache-2.0
"""The arguments of `contact-dynamics replay`, with its modes, and of `contact-dynamics recover`."""

from __future__ import annotations

import argparse
import difflib
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

VERIFY: Final = "verify"
INFO: Final = "info"
TABLE: Final = "table"
VIEW: Final = "view"
PUBLISH: Final = "publish"

MODES: Final = {  # the modes of `replay`
    VERIFY: "recompute every logged response and compare it (the default mode)",
    INFO: "list topics, bodies, time span, and requests by service and status",
    TABLE: "write one row per request, with its response and the later measurement",
    VIEW: "draw states and responses in rerun, live or to a file",
    PUBLISH: "publish the states over ROS, and optionally repeat the requests",
}

QUESTIONS: Final = ("landing", "impact", "modes")  # predictions for recordings without requests

DEFAULT_PORT: Final = 9876


def replay_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics replay`."""
    parser = _WithDefaultMode(
        prog="contact-dynamics replay",
        description="Replay a log of the server. Only the mode publish requires ROS.",
        epilog="`contact-dynamics replay LOG` verifies. `contact-dynamics replay MODE --help` lists options.",
    )
    modes = parser.add_subparsers(dest="mode", metavar="MODE", parser_class=argparse.ArgumentParser)
    usage = "%(prog)s [-h] [--tolerance T] [--config FILE] [--set NAME:=VALUE] LOG [LOG ...]"
    _add_verify(
        modes.add_parser(VERIFY, usage=usage, help=MODES[VERIFY], description=_sentence(MODES[VERIFY]))
    )
    inside = modes.add_parser(INFO, help=MODES[INFO], description=_sentence(MODES[INFO]))
    inside.add_argument(
        "logs", nargs="+", metavar="LOG", help="a log of the server, any rosbag2 bag, or a folder of them"
    )
    _add_table(modes.add_parser(TABLE, help=MODES[TABLE], description=_sentence(MODES[TABLE])))
    _add_view(modes.add_parser(VIEW, help=MODES[VIEW], description=_sentence(MODES[VIEW])))
    _add_publish(modes.add_parser(PUBLISH, help=MODES[PUBLISH], description=_sentence(MODES[PUBLISH])))
    return parser


def recover_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics recover`."""
    parser = argparse.ArgumentParser(
        prog="contact-dynamics recover",
        usage="%(prog)s [-h] [--output DIR] LOG",
        description="Copy the readable messages of a damaged or unfinished log to a new folder that "
        "every reader accepts. The damaged log is not changed. ROS is not required.",
        epilog="The exit code is 0 if the new log was written, even if messages are lost, and 2 otherwise.",
    )
    parser.add_argument(
        "log", nargs="?", metavar="LOG", help="folder of a log or of another MCAP bag, or one of its files"
    )
    parser.add_argument("--output", metavar="DIR", help="new folder (default: LOG_recovered)")
    return parser


def stamps_as_logged(given: argparse.Namespace) -> bool:
    """Return whether published messages keep the stamps of the log."""
    chosen = given.stamps or ("logged" if given.clock else "now")
    return bool(chosen == "logged")


class _WithDefaultMode(argparse.ArgumentParser):
    """A parser that passes arguments without a mode to the first mode."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        given: Sequence[str] = args or ()
        names_mode = bool(given) and given[0] in {*MODES, "-h", "--help"}
        if given and not names_mode and given[0].isalpha() and not Path(given[0]).exists():
            near = difflib.get_close_matches(given[0], MODES, n=1)
            meant = f"did you mean {near[0]!r}?" if near else f"the modes are {', '.join(MODES)}"
            self.error(f"there is no mode and no log {given[0]!r}; {meant}")
        return super().parse_known_args([*given] if names_mode else [VERIFY, *given], namespace)


def _add_verify(parser: argparse.ArgumentParser) -> None:
    parser.epilog = (
        "The exit code is 0 if all responses equal the logged ones, 1 if one differs or cannot be "
        "read, and 2 if a log is not one of the server. Computation times are not compared."
    )
    parser.add_argument(
        "logs",
        nargs="*",
        metavar="LOG",
        help="folder of a log of the server, one of its files, or a folder that contains logs",
    )
    _add_tolerance(parser)

    group = parser.add_argument_group(
        "other parameters", "Recompute the responses with other parameters, and list the largest differences."
    )
    group.add_argument("--config", metavar="FILE", help="server parameters that replace the logged ones")
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME:=VALUE",
        help="value of one parameter, such as surface.floor.friction:=0.31; may be repeated",
    )


def _add_table(parser: argparse.ArgumentParser) -> None:
    parser.epilog = (
        "Error columns compare the predicted with the measured state at the predicted time; `evaluate` "
        "reports errors of landing times. docs/replay.md explains the columns."
    )
    parser.add_argument(
        "logs", nargs="+", metavar="LOG", help="a log of the server, or a recording with --config"
    )
    parser.add_argument(
        "--output",
        metavar="FILE",
        help=".csv or .parquet file; an existing file is replaced (default: CSV to the terminal)",
    )
    _add_span(parser)
    _add_foreign(parser)


def _add_view(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="a log of the server, or a recording with --config")
    parser.add_argument(
        "--rrd",
        metavar="FILE",
        default="",
        help="output file in rerun's format; an existing file is replaced",
    )
    viewer = parser.add_mutually_exclusive_group()
    viewer.add_argument(
        "--spawn", action="store_true", help="open rerun's viewer (the default without --rrd)"
    )
    viewer.add_argument("--serve", action="store_true", help="serve the picture at --port until Ctrl-C")
    viewer.add_argument("--connect", metavar="URL", default="", help="URL of an open viewer")
    parser.add_argument(
        "--port",
        type=int,
        default=DEFAULT_PORT,
        help=f"port for --spawn and --serve (default: {DEFAULT_PORT})",
    )
    parser.add_argument(
        "--surface-side",
        type=_positive,
        default=2.0,
        metavar="M",
        help="side of the square drawn for a surface, m (default: 2)",
    )
    _add_span(parser)
    _add_foreign(parser)


def _add_publish(parser: argparse.ArgumentParser) -> None:
    parser.epilog = (
        "The space bar pauses and resumes playback; while paused, the key '.' advances by 0.1 s. The exit "
        "code is 0 if the log was published and, with --requests, every response equals the logged one; 1 if "
        "nothing was published, or a response differs or is missing; 2 if there is no such log or part of "
        "it. ROS arguments follow --ros-args."
    )
    parser.add_argument("log", metavar="LOG", help="a log of the server, or any recording with --all-topics")
    parser.add_argument(
        "--rate",
        type=_positive,
        default=1.0,
        metavar="R",
        help="playback speed relative to the recording (default: 1). Other speeds require --clock or "
        "--stamps logged, because the velocities do not match stretched stamps",
    )
    parser.add_argument("--loop", action="store_true", help="restart at the end, until Ctrl-C")
    parser.add_argument("--paused", action="store_true", help="start paused")
    parser.add_argument(
        "--requests",
        action="store_true",
        help="send each logged request at its time, and compare the responses with the logged ones",
    )
    _add_tolerance(parser)
    parser.add_argument(
        "--clock", action="store_true", help="publish the time of the log on /clock at 100 Hz"
    )
    parser.add_argument(
        "--stamps",
        choices=("now", "logged"),
        help="stamps of the states: shifted to the present (default), or as logged (default with --clock)",
    )
    parser.add_argument(
        "--all-topics",
        action="store_true",
        help="publish all topics, not only states (default for recordings that are not logs of the server)",
    )
    parser.add_argument(
        "--wait",
        type=_not_negative,
        default=3.0,
        metavar="S",
        help="maximum time to wait for subscribers, s (default: 3)",
    )
    _add_span(parser)
    _require(parser, "requests", "tolerance")


def _add_tolerance(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--tolerance",
        type=_not_negative,
        default=0.0,
        metavar="T",
        help="maximum difference of two numbers, relative to the larger one, or to 1 if both are smaller "
        "(default: 0, bit for bit)",
    )


def _add_span(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--start",
        type=_not_negative,
        default=0.0,
        metavar="S",
        help="start time, s after the beginning of the log",
    )
    parser.add_argument(
        "--end", type=_positive, default=None, metavar="S", help="end time, s after the beginning of the log"
    )


def _add_foreign(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "recordings of other systems", "Any rosbag2 bag that contains states of bodies."
    )
    group.add_argument("--config", metavar="FILE", help="server parameters, such as config/server.yaml")
    group.add_argument(
        "--topics",
        action="append",
        default=[],
        metavar="BODY=TOPIC",
        help="topics of a body's states, instead of those in --config: BODY=ODOMETRY or BODY=POSE,TWIST",
    )
    group.add_argument(
        "--ask",
        action="append",
        default=[],
        choices=QUESTIONS,
        help="prediction to repeat: landing (pose at the next contact), impact (velocities after it) "
        "or modes (contact modes); may be repeated",
    )
    group.add_argument(
        "--body", action="append", default=[], metavar="NAME", help="body to predict (default: all)"
    )
    group.add_argument(
        "--every",
        type=_not_negative,
        default=0.1,
        metavar="S",
        help="time between predictions, s (default: 0.1; with 0, one at each state)",
    )
    group.add_argument(
        "--fit-window",
        type=_not_negative,
        default=0.0,
        metavar="S",
        help="length of the window of states to which a flight is fitted, s (default: 0, no fit)",
    )
    _require(parser, "config", "topics")
    _require(parser, "ask", "body", "every", "fit_window")


def _require(parser: argparse.ArgumentParser, needed: str, *names: str) -> None:
    """Make it an error to give options that are ignored without another one (`check_read`)."""
    rows = [(name, parser.get_default(name), needed) for name in names]
    parser.set_defaults(requires=[*(parser.get_default("requires") or ()), *rows])


def check_read(parser: argparse.ArgumentParser, given: argparse.Namespace) -> None:
    """End the process with an error if a given option would be ignored."""
    for name, default, needed in getattr(given, "requires", ()):
        if getattr(given, name) != default and not getattr(given, needed):
            parser.error(f"--{name.replace('_', '-')} must be used with --{needed}")


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _not_negative(text: str) -> float:
    value = _number(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"must be >= 0, got {text}")
    return value


def _positive(text: str) -> float:
    value = _number(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"must be > 0, got {text}")
    return value


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a number, got {text}") from None
