"""The demo: a toss is played as published states, the server is asked, and a table says how well it knew.

Three processes and this one: the server, the visualizer, the publisher; this one asks. All of them are
stopped at the end, however it comes.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import time
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Final

import rclpy
from rclpy.signals import SignalHandlerOptions

from contact_dynamics.demo.comparison import print_table
from contact_dynamics.demo.parameters import write_parameters
from contact_dynamics.demo.processes import Processes
from contact_dynamics.demo.questioner import Questioner
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.measured.events import measure_events
from contact_dynamics.measured.read_toss import DEFAULT_RECORDING, read_toss
from contact_dynamics.nodes.running import stop_signals

if TYPE_CHECKING:
    import threading

    from contact_dynamics.measured.recorded_toss import Toss

LISTENERS: Final = 3
"""Subscriptions that the toss waits for: the server's, the visualizer's and this process's."""

_DRAIN_S: Final = 0.5  # for what is still on its way to log and picture when the toss is over


def main(arguments: list[str]) -> int:
    """Run the demo; return the exit code."""
    given = _arguments(arguments)
    try:
        toss = read_toss(given.toss)
    except (ContactDynamicsError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    try:
        folder = _new_folder(given.output)
    except OSError as error:
        print(f"--output: found {given.output!r}, allowed is a folder to write in ({error})", file=sys.stderr)
        return 2
    try:
        with stop_signals() as stop, Processes(folder) as processes:
            asked = _play(toss, given, folder, processes, stop)
            processes.stop()
            _tell(processes)
    except KeyboardInterrupt:
        print("\nstopped", file=sys.stderr)
        return 130
    except (TimeoutError, RuntimeError) as error:
        print(f"{error}\nWhat the processes printed is in {folder}", file=sys.stderr)
        return 1
    if not given.quiet:
        print_table(toss, measure_events(toss), asked)
    print(f"\nlog and picture ({asked.received} states):")
    for path in (*sorted(folder.glob("*/*.mcap")), folder / "toss.rrd"):
        print(path)
    return 0


def _play(
    toss: Toss, given: argparse.Namespace, folder: Path, processes: Processes, stop: threading.Event
) -> Questioner:
    def go_on() -> bool:
        if stop.is_set():
            raise KeyboardInterrupt
        processes.all_alive()
        _tell(processes)
        return True

    print(f"playing {toss.source}: {len(toss)} states at {toss.rate:g} Hz", flush=True)
    parameters = folder / "parameters.yaml"
    write_parameters(parameters, toss, log_directory=folder)
    processes.start("server", ["--params-file", str(parameters)])
    picture = ["-p", f"rrd_path:={folder / 'toss.rrd'}", "-p", f"spawn:={'true' if given.view else 'false'}"]
    processes.start("visualizer", ["--params-file", str(parameters), "--ros-args", *picture])
    publisher = processes.start("toss_publisher", ["--toss", given.toss, "--listeners", str(LISTENERS)])
    os.environ.update(processes.ros_environment)
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    questioner = Questioner(toss)
    try:
        questioner.get_ready(go_on)
        questioner.watch(lambda: go_on() and publisher.poll() is None)
        if publisher.wait() != 0 or not questioner.received:
            raise RuntimeError(f"the toss was not played: {processes.printed_by('toss_publisher')}")
        time.sleep(_DRAIN_S)
        go_on()
    finally:
        questioner.close()
    return questioner


def _tell(processes: Processes) -> None:
    for complaint in processes.new_complaints():
        print(complaint, file=sys.stderr, flush=True)


def _arguments(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="contact-dynamics demo",
        description="Play a recorded toss, ask the server about it, compare with what was measured.",
    )
    parser.add_argument(
        "--toss",
        default=str(DEFAULT_RECORDING),
        metavar="PATH",
        help="recording: a .csv like the package's own, or measured cube tosses, .npz#INDEX",
    )
    parser.add_argument("--view", action="store_true", help="open rerun's viewer and watch live")
    parser.add_argument(
        "--output",
        default="demo_output",
        metavar="FOLDER",
        help="where the run's folder goes (default: %(default)s)",
    )
    parser.add_argument("--quiet", action="store_true", help="no table")
    return parser.parse_args(arguments)


def _new_folder(output: str) -> Path:
    name = datetime.now(timezone.utc).astimezone().strftime("%Y-%m-%d_%H-%M-%S")
    folder = Path(output).resolve() / name
    number = 1
    while True:
        with contextlib.suppress(FileExistsError):
            folder.mkdir(parents=True)
            return folder
        number += 1
        folder = folder.with_name(f"{name}_{number}")
