"""The command line: `contact-dynamics <verb>`; `ros2 run contact_dynamics <executable>` does the same."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence


class Verb(NamedTuple):
    """One verb: where its `main(arguments) -> exit code` is, and what it does."""

    module: str
    help: str


VERBS: Final = {
    "demo": Verb(
        "contact_dynamics.demo.run",
        "play a recorded toss, ask the server about it, compare with what was measured",
    ),
    "server": Verb("contact_dynamics.nodes.server", "serve contact modes, impacts and tumbling over ROS 2"),
    "visualizer": Verb(
        "contact_dynamics.nodes.visualizer",
        "show bodies, contacts and predictions in rerun, live or to a file",
    ),
    "toss_publisher": Verb(
        "contact_dynamics.demo.toss_publisher", "publish a recorded toss as a body's states"
    ),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the verb that the arguments name; return the exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    parser = _parser()
    if not given or given[0] not in VERBS:
        parser.parse_args(given)  # --help and --version end here, anything else is an error
        parser.print_help()
        return 2
    return _run(given[0], given[1:])


def _run(verb: str, arguments: list[str]) -> int:
    try:
        module = import_module(VERBS[verb].module)
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] in {"contact_dynamics", "msg_adapters"}:
            raise
        print(
            f"contact-dynamics {verb} needs {error.name!r}, which is not installed.\n"
            "With ROS 2: source it and a workspace with its interface package. Without: `make setup` in\n"
            "the project's folder installs ROS's own Python packages into .venv (see README.md).",
            file=sys.stderr,
        )
        return 3
    exit_code: int = module.main(arguments)
    return exit_code


def _parser() -> argparse.ArgumentParser:
    verbs = "\n".join(f"  {name:15} {verb.help}" for name, verb in VERBS.items())
    parser = argparse.ArgumentParser(
        prog="contact-dynamics",
        description="Contact modes, impacts and free tumbling of rigid bodies.",
        epilog=f"verbs:\n{verbs}\n\n`contact-dynamics <verb> --help` explains each.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("verb", help="what to do, see below", choices=sorted(VERBS), metavar="verb")
    parser.add_argument("--version", action="version", version=_version())
    return parser


def _version() -> str:
    try:
        return version("contact_dynamics")
    except PackageNotFoundError:
        return "not installed"
