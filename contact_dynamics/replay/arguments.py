"""These are the arguments of `contact-dynamics replay`, with its modes, and of `contact-dynamics recover`."""

from __future__ import annotations

import argparse
import difflib
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

VERIFY: Final = "verify"
TABLE: Final = "table"
VIEW: Final = "view"
PUBLISH: Final = "publish"

MODES: Final = {
    VERIFY: "answer every logged question again and compare the answers (the default mode)",
    TABLE: "write a row for each question: request, answer and later measurement",
    VIEW: "draw states and answers in rerun, live or to a file",
    PUBLISH: "publish states and repeat questions over ROS",
}
"""What `replay` can do with a log."""

QUESTIONS: Final = ("landing", "impact", "modes")
"""What can be asked of a recording that holds no questions."""

DEFAULT_PORT: Final = 9876


def replay_parser() -> argparse.ArgumentParser:
    """Return the parser of `contact-dynamics replay`."""
    parser = _WithDefaultMode(
        prog="contact-dynamics replay",
        description="Replay a log. Only the mode publish needs ROS.",
        epilog="`contact-dynamics replay LOG` verifies. `contact-dynamics replay MODE --help` has options.",
    )
    modes = parser.add_subparsers(dest="mode", metavar="MODE", parser_class=argparse.ArgumentParser)
    usage = "%(prog)s [-h] [--tolerance T] [--config FILE] [--set NAME:=VALUE] LOG [LOG ...]"
    _add_verify(
        modes.add_parser(VERIFY, usage=usage, help=MODES[VERIFY], description=_sentence(MODES[VERIFY]))
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
        description="Rewrite a damaged or unfinished log into a new folder that every reader can open. "
        "The damaged log is not changed. This needs no ROS.",
        epilog="The exit code is 0 if the new log was written, whatever is lost, and 2 if it was not.",
    )
    parser.add_argument(
        "log", nargs="?", metavar="LOG", help="folder of a log or of another bag in MCAP, or one file of it"
    )
    parser.add_argument("--output", metavar="DIR", help="the new folder (default: LOG_recovered, beside it)")
    return parser


def stamps_as_logged(given: argparse.Namespace) -> bool:
    """Return whether what is published keeps the stamps of the log."""
    chosen = given.stamps or ("logged" if given.clock else "now")
    return bool(chosen == "logged")


class _WithDefaultMode(argparse.ArgumentParser):
    """A parser that takes what names no mode as the arguments of the first one."""

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
        "exit code: 0 all answers are as logged; 1 an answer differs, or a call cannot be read; "
        "2 a log is not one of the server. Computation times are not compared."
    )
    parser.add_argument(
        "logs",
        nargs="*",
        metavar="LOG",
        help="folder of a log of the server, one of its files, or a folder in which logs are looked for",
    )
    _add_tolerance(parser)

    group = parser.add_argument_group(
        "another configuration", "Answers under other parameters. The report lists the largest differences."
    )
    group.add_argument(
        "--config", metavar="FILE", help="parameters of the server that replace the logged ones"
    )
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME:=VALUE",
        help="one parameter, such as surface.floor.friction:=0.31; may be repeated",
    )


def _add_table(parser: argparse.ArgumentParser) -> None:
    parser.epilog = "The page docs/replay.md explains the columns."
    parser.add_argument(
        "logs", nargs="+", metavar="LOG", help="a log of the server, or a recording with --config"
    )
    parser.add_argument(
        "--output",
        metavar="FILE",
        help=".csv or .parquet file, which is replaced (default: CSV to the terminal)",
    )
    _add_span(parser)
    _add_foreign(parser)


def _add_view(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="a log of the server, or a recording with --config")
    parser.add_argument("--rrd", metavar="FILE", default="", help="file to draw into, which is replaced")
    viewer = parser.add_mutually_exclusive_group()
    viewer.add_argument(
        "--spawn", action="store_true", help="open rerun's viewer (the default without --rrd)"
    )
    viewer.add_argument(
        "--serve", action="store_true", help="serve the picture at the port, for viewers, until Ctrl-C"
    )
    viewer.add_argument("--connect", metavar="URL", default="", help="a viewer that is open already")
    parser.add_argument(
        "--port", type=int, default=DEFAULT_PORT, help=f"of --spawn and --serve (default: {DEFAULT_PORT})"
    )
    parser.add_argument(
        "--surface-side",
        type=_positive,
        default=2.0,
        metavar="M",
        help="side of a drawn surface, m (default: 2)",
    )
    _add_span(parser)
    _add_foreign(parser)


def _add_publish(parser: argparse.ArgumentParser) -> None:
    parser.epilog = (
        "exit code: 0 all was published, and with --requests every answer is as logged; 1 nothing was "
        "published, an answer differs, or did not come; 2 there is no such log, or no such part of it. "
        "While it runs, the space bar pauses it, and a dot steps on. ROS's own arguments follow --ros-args."
    )
    parser.add_argument("log", metavar="LOG", help="a log of the server, or any recording with --all-topics")
    parser.add_argument(
        "--rate",
        type=_positive,
        default=1.0,
        metavar="R",
        help="playback speed relative to the recording (default: 1). Others need --clock or --stamps logged, "
        "since velocities do not fit stretched stamps",
    )
    parser.add_argument("--loop", action="store_true", help="start again at the end, until Ctrl-C")
    parser.add_argument("--paused", action="store_true", help="start paused")
    parser.add_argument(
        "--requests",
        action="store_true",
        help="repeat the logged questions, each at its time, and compare the answers with the logged ones",
    )
    _add_tolerance(parser)
    parser.add_argument(
        "--clock", action="store_true", help="publish the time of the log at /clock, 100 times a second"
    )
    parser.add_argument(
        "--stamps",
        choices=("now", "logged"),
        help="stamps of the states: shifted to the present (default), or as logged (default with --clock)",
    )
    parser.add_argument(
        "--all-topics",
        action="store_true",
        help="publish every topic, not only states (default without a server's log)",
    )
    parser.add_argument(
        "--wait",
        type=_not_negative,
        default=3.0,
        metavar="S",
        help="longest wait for subscribers, s (default: 3)",
    )
    _add_span(parser)


def _add_tolerance(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--tolerance",
        type=_not_negative,
        default=0.0,
        metavar="T",
        help="largest difference of a number, relative to the larger of the two, or to 1 if both are smaller "
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
    group = parser.add_argument_group("foreign recordings", "Any bag of rosbag2 with states of bodies.")
    group.add_argument("--config", metavar="FILE", help="parameters of a server, such as config/server.yaml")
    group.add_argument(
        "--topics",
        action="append",
        default=[],
        metavar="BODY=TOPIC",
        help="topics of the states of a body, if not those of --config: BODY=ODOMETRY or BODY=POSE,TWIST",
    )
    group.add_argument(
        "--ask",
        action="append",
        default=[],
        choices=QUESTIONS,
        help="a question to ask throughout: landing (where will it be?), impact (which velocities then?), "
        "modes (which contact mode?); may be repeated",
    )
    group.add_argument(
        "--body", action="append", default=[], metavar="NAME", help="body to ask about (default: all)"
    )
    group.add_argument(
        "--every",
        type=_not_negative,
        default=0.1,
        metavar="S",
        help="time between questions, s (default: 0.1; 0: at each state)",
    )
    group.add_argument(
        "--fit-window",
        type=_not_negative,
        default=0.0,
        metavar="S",
        help="length of the window of states for the fit, s (default: 0, no fit)",
    )


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
