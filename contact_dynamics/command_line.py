# SPDX-License-Identifier: Apache-2.0
"""The command line, `contact-dynamics <verb>`. `ros2 run contact_dynamics <executable>` does the same."""

from __future__ import annotations

import argparse
import difflib
import gc
import io
import os
import sys
import warnings
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.version import version_of_this_package

if TYPE_CHECKING:
    from collections.abc import Sequence


class Verb(NamedTuple):
    """One verb, with the locations of its `main(arguments) -> exit code` and of its parser.

    Attributes:
        parser: The parser, as module:function. It does not require ROS, so that `--help` works everywhere.
        needs: Modules that `pip install .` does not install.
        is_listed: Whether `--help` lists it. The nodes of the examples are not.
    """

    module: str
    parser: str
    needs: tuple[str, ...]
    help: str
    is_listed: bool = True

    def make_parser(self) -> argparse.ArgumentParser:
        """Return its parser."""
        module, _, function = self.parser.partition(":")
        parser: argparse.ArgumentParser = getattr(import_module(module), function)()
        return parser


INTERRUPTED: Final = 130
"""The exit code after Ctrl-C, as in shells."""

BROKEN_PIPE: Final = 141
"""The exit code when the reader of the output, such as `head`, has closed the pipe, as in shells."""

DISCOVERY_RANGE: Final = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_SERVER_OF_DISCOVERY: Final = "ROS_DISCOVERY_SERVER"

_THREADS_OF_BLAS: Final = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Threads do not speed up matrices of a few dozen rows, and delay them on a busy machine: the singular values
of a matrix with 64 rows took 300 ms instead of 2 ms."""

_ROS: Final = ("rclpy", "geometry_msgs.msg", "nav_msgs.msg", "contact_dynamics_interfaces.srv")


VERBS: Final = {
    "demo": Verb(
        "contact_dynamics.demo.run",
        "contact_dynamics.demo.arguments:demo_parser",
        (*_ROS, "rerun"),
        "play a recorded toss, and compare the server's predictions with the measurements",
    ),
    "server": Verb(
        "contact_dynamics.nodes.server",
        "contact_dynamics.nodes.arguments:server_parser",
        _ROS,
        "provide the services for contact modes, impacts, tumbling and tosses over ROS 2",
    ),
    "visualizer": Verb(
        "contact_dynamics.nodes.visualizer",
        "contact_dynamics.nodes.arguments:visualizer_parser",
        (*_ROS, "rerun"),
        "draw bodies, contacts and predictions in rerun, live or to a file",
    ),
    "replay": Verb(
        "contact_dynamics.replay.run",
        "contact_dynamics.replay.arguments:replay_parser",
        (),
        "recompute the responses in a log and compare them; tables, pictures, publishing",
    ),
    "evaluate": Verb(
        "contact_dynamics.evaluation.run",
        "contact_dynamics.evaluation.arguments:evaluate_parser",
        (),
        "measure the accuracy of predictions on logs and recorded tosses",
    ),
    "calibrate": Verb(
        "contact_dynamics.calibration.run",
        "contact_dynamics.calibration.arguments:calibrate_parser",
        (),
        "estimate friction, restitution, centre of mass and more from recorded tosses",
    ),
    "monitor": Verb(
        "contact_dynamics.monitoring.run",
        "contact_dynamics.monitoring.arguments:monitor_parser",
        (),
        "detect changed friction and restitution, and events outside of their prediction regions",
    ),
    "live_monitor": Verb(
        "contact_dynamics.monitoring.live",
        "contact_dynamics.nodes.arguments:live_monitor_parser",
        _ROS,
        "monitor published states over ROS 2",
    ),
    "recover": Verb(
        "contact_dynamics.replay.recover",
        "contact_dynamics.replay.arguments:recover_parser",
        (),
        "repair a damaged log",
    ),
    "plot": Verb(
        "contact_dynamics.plots.run",
        "contact_dynamics.plots.arguments:plot_parser",
        ("matplotlib",),
        "draw diagrams of the responses in a log",
    ),
    "cases": Verb(
        "contact_dynamics.cases.run",
        "contact_dynamics.cases.arguments:cases_parser",
        (),
        "solve problems with known exact answers, and compare with MuJoCo",
    ),
    "toss_publisher": Verb(
        "contact_dynamics.demo.toss_publisher",
        "contact_dynamics.demo.arguments:toss_publisher_parser",
        _ROS,
        "publish the states of a recorded toss",
        is_listed=False,
    ),
    "block_publisher": Verb(
        "contact_dynamics.demo.block_publisher",
        "contact_dynamics.demo.arguments:block_publisher_parser",
        _ROS,
        "publish the states of a block that is pushed or lies on a tilting tray",
        is_listed=False,
    ),
    "commentator": Verb(
        "contact_dynamics.demo.commentator",
        "contact_dynamics.demo.arguments:commentator_parser",
        _ROS,
        "send requests to a running server, and print text summaries of the responses",
        is_listed=False,
    ),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the verb that the arguments name, and return the exit code."""
    if "_ARGCOMPLETE" in os.environ:
        _complete()
    given = list(sys.argv[1:] if arguments is None else arguments)
    out = sys.stdout
    if out is sys.__stdout__ and isinstance(out, io.TextIOWrapper) and not out.isatty():
        raw = _Output(out.fileno(), "w", closefd=False)
        output: Any = raw if out.write_through else io.BufferedWriter(raw)  # -u writes through
        sys.stdout = io.TextIOWrapper(
            output, encoding=out.encoding, errors=out.errors, write_through=out.write_through
        )
    try:
        return _main(given)
    finally:
        sys.stdout.flush()


class _Output(io.FileIO):
    """The standard output. The command exits silently when the reader, such as `head`, closes the pipe."""

    def write(self, data: Any) -> int:
        """Write some bytes."""
        try:
            return super().write(data)
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())  # for output during exit
            raise SystemExit(BROKEN_PIPE) from None


def _main(given: list[str]) -> int:
    parser = _parser()
    if not given:
        parser.print_help(sys.stderr)
        return 2
    if given[0] not in VERBS:
        if not given[0].startswith("-"):
            parser.error(_unknown(given[0]))
        parser.parse_args(given)  # `--help` and `--version` exit here; anything else is an error
    try:
        return _run(given[0], given[1:])
    except KeyboardInterrupt:  # nodes install their own handlers, but only once they have started
        print("\nstopped", file=sys.stderr)
        return INTERRUPTED


def _run(name: str, arguments: list[str]) -> int:
    verb = VERBS[name]
    for variable in _THREADS_OF_BLAS:
        os.environ.setdefault(variable, "1")
    with warnings.catch_warnings():
        if not {"-h", "--help"}.isdisjoint(arguments):
            warnings.simplefilter("ignore", RuntimeWarning)  # about an outdated compiled core
        from contact_dynamics.nodes.arguments import check_arguments  # loads SciPy

        check_arguments(verb.make_parser(), arguments)
    missing = [needed.partition(".")[0] for needed in verb.needs if not _is_installed(needed)]
    if missing:
        print(_remedy(name, missing), file=sys.stderr)
        return 3
    _stay_on_this_machine()
    if name == "server":  # its imports take seconds when the files are not cached
        print("contact-dynamics server: starting", file=sys.stderr, flush=True)
    exit_code: int = _imported(verb.module).main(arguments)
    return exit_code


def _stay_on_this_machine() -> None:
    """Restrict ROS discovery to this machine, unless the environment configures discovery."""
    if not (os.environ.get(DISCOVERY_RANGE) or os.environ.get(_SERVER_OF_DISCOVERY)):
        os.environ[DISCOVERY_RANGE] = "LOCALHOST"


def _imported(module: str) -> Any:
    """Return a module, imported without garbage collection, which would take a tenth of the startup time."""
    gc.disable()
    try:
        return import_module(module)
    finally:
        gc.freeze()
        gc.enable()


def _is_installed(module: str) -> bool:
    """Return whether a module can be found. A folder without code, such as `srv` of the sources, is none."""
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:
        return False
    return spec is not None and spec.origin is not None


def _remedy(verb: str, missing: list[str]) -> str:
    lines = [f"contact-dynamics {verb} requires modules that are not installed: {', '.join(missing)}."]
    if "rerun" in missing:
        lines.append("To install rerun, run `pip install '.[view]'` in a clone of the repository.")
    if "matplotlib" in missing:
        lines.append("To install Matplotlib, run `pip install matplotlib`.")
    if set(missing) - {"rerun", "matplotlib"}:
        lines.append(
            "The other modules belong to ROS 2 Jazzy and to the interface package of this repository.\n"
            "If ROS is installed, source it and the workspace in which colcon has built the repository.\n"
            "Otherwise, run `make setup` in a clone, which installs them into .venv (see README.md)."
        )
    return "\n".join(lines)


def _unknown(name: str) -> str:
    """Return an error that suggests the verb probably meant, or lists all verbs."""
    from contact_dynamics.replay.arguments import MODES

    near = difflib.get_close_matches(name.replace("-", "_"), VERBS, n=1)
    if name in MODES:
        near = [f"replay {name}"]
    listed = ", ".join(verb for verb in VERBS if VERBS[verb].is_listed)
    return f"there is no verb {name!r}; {f'did you mean {near[0]!r}?' if near else f'the verbs are {listed}'}"


def _complete() -> None:
    """Print the shell completions of a command line, and exit."""
    import argcomplete  # in the extra [completion]; only the shell's hook calls this function

    parser = argparse.ArgumentParser(prog="contact-dynamics")
    verbs = parser.add_subparsers()
    for name, verb in VERBS.items():
        verbs.add_parser(name, parents=[verb.make_parser()], add_help=False)
    argcomplete.autocomplete(parser)


def _parser() -> argparse.ArgumentParser:
    verbs = "\n".join(f"  {name:15} {verb.help}" for name, verb in VERBS.items() if verb.is_listed)
    parser = argparse.ArgumentParser(
        prog="contact-dynamics",
        description="Predict contact modes, impacts, tumbling and tosses of rigid bodies.",
        epilog=f"verbs:\n{verbs}\n\n`contact-dynamics <verb> --help` explains each verb.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("verb", help="one of the verbs below", choices=sorted(VERBS), metavar="verb")
    parser.add_argument("--version", action="version", version=version_of_this_package())
    return parser
