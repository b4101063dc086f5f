# SPDX-License-Identifier: Apache-2.0
"""`contact-dynamics demo`: plays a recorded toss and compares predictions with the measurements.

The server, the visualizer and the publisher of the states are separate processes. This process starts them,
sends the requests, and stops them at the end, even after a failure. The recording describes the body and the
surface.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import shlex
import sys
import time
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias

import numpy as np
import rclpy
from rclpy.signals import SignalHandlerOptions

from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.demo.arguments import demo_parser
from contact_dynamics.demo.processes import Processes
from contact_dynamics.demo.questioner import Questioner
from contact_dynamics.demo.toss_publisher import WORLD_FRAME, topic_of
from contact_dynamics.diagrams.words import OUTCOMES
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.measured.flights import find_strikes
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.nodes.own_process import ensure_ros_log_directory
from contact_dynamics.nodes.running import stop_signals
from contact_dynamics.rotations.many import rotation_vectors
from msg_adapters.geometry import vector_from_msg

if TYPE_CHECKING:
    import argparse
    import threading
    from collections.abc import Sequence

    from contact_dynamics.demo.questioner import Asked
    from contact_dynamics.measured.flights import Strike
    from contact_dynamics.measured.recorded_toss import Toss
    from contact_dynamics.validation import FloatArray


LISTENERS: Final = 3
"""Number of subscriptions that the toss waits for: the server's, the visualizer's and this process's."""

PICTURE: Final = "toss.rrd"

_DRAIN_S: Final = 0.5  # time for the last messages to reach the log and the picture


def main(arguments: list[str]) -> int:
    """Run the demo, and return the exit code."""
    given = demo_parser().parse_args(arguments)
    try:
        toss = read_toss(given.toss)
    except (ContactDynamicsError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    try:
        folder = _new_folder(given.output)
    except OSError as error:
        print(f"--output must be a folder to write in ({error}), got {given.output!r}", file=sys.stderr)
        return 2
    ensure_ros_log_directory()
    try:
        with stop_signals() as stop, Processes(folder) as processes:
            asked = _play(toss, given, folder, processes, stop)
            processes.close()
            _tell(processes)
    except (TimeoutError, RuntimeError) as error:
        print(f"{error}\nWhat the processes printed is in {folder}", file=sys.stderr)
        return 1
    if not given.quiet:
        print_table(toss, find_strikes(toss), asked)
    print(f"\nto look at the picture: {_opening(folder / PICTURE)}")
    print(f"\nlog and picture ({asked.received} states):")
    for path in (*sorted(folder.glob("*/*.mcap")), folder / PICTURE):
        print(_from_here(path))
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
    picture = ["-p", f"rrd_path:={folder / PICTURE}", "-p", f"spawn:={'true' if given.view else 'false'}"]
    processes.start("visualizer", ["--params-file", str(parameters), "--ros-args", *picture])
    publisher = processes.start("toss_publisher", ["--toss", given.toss, "--listeners", str(LISTENERS)])
    os.environ.update(processes.ros_environment)
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    questioner = Questioner(toss)
    try:
        questioner.get_ready(go_on)
        questioner.watch(lambda: go_on() and publisher.poll() is None)
        # The publisher may wait up to 3 s (a heartbeat of Fast DDS) for acknowledgements. It is not awaited,
        # because meanwhile the server would warn that no more states arrive.
        if publisher.poll() not in {None, 0} or not questioner.received:
            raise RuntimeError(f"the toss was not played: {processes.printed_by('toss_publisher')}")
        time.sleep(_DRAIN_S)
        go_on()
    finally:
        questioner.close()
    return questioner


def _tell(processes: Processes) -> None:
    for complaint in processes.new_complaints():
        print(complaint, file=sys.stderr, flush=True)


def _opening(picture: Path) -> str:
    """Return the command, for a shell, that opens a picture from the folder where the demo was started."""
    rerun = Path(sys.executable).with_name("rerun")
    command = [_from_here(rerun) if rerun.exists() else "rerun", _from_here(picture)]
    return shlex.join(command)


def _from_here(path: Path) -> str:
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)


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


TOUCHING: Final = 0.003
"""Distance tolerance, m: the combined error of the tracked pose, the shape and the surface."""


def write_parameters(path: Path, toss: Toss, *, log_directory: Path) -> None:
    """Write the parameter file of the server and the visualizer, as JSON, which is valid YAML."""
    name, surface = toss.body.name, toss.surface
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = toss.body.mass_properties.I_B.tolist()
    parameters: dict[str, Any] = {
        "world_frame": WORLD_FRAME,
        "gravity": toss.gravity_W.tolist(),
        "bodies": [name],
        f"body.{name}.mass": toss.body.mass_properties.mass,
        f"body.{name}.inertia": [ixx, iyy, izz, ixy, ixz, iyz],
        f"body.{name}.box": toss.box_size.tolist(),
        f"body.{name}.odometry_topic": topic_of(toss),
        "surfaces": [surface.name],
        f"surface.{surface.name}.point": surface.p_WS_W.tolist(),
        f"surface.{surface.name}.normal": surface.normal_W.tolist(),
        f"surface.{surface.name}.friction": surface.friction,
        f"surface.{surface.name}.restitution": surface.restitution,
        # Velocities within the noise of the measurement count as zero.
        "velocity_tolerance": 5.0 * toss.contact_speed_noise,
        "distance_tolerance": TOUCHING,
        "out_of_plane_tolerance": 5.0 * toss.contact_speed_noise,
        "log_directory": str(log_directory),
    }
    path.write_text(json.dumps({"/**": {"ros__parameters": parameters}}, indent=2) + "\n", encoding="utf-8")


SAME_STRIKE: Final = 0.03  # s, largest difference in time between a predicted strike and its measurement

_AVERAGED: Final = 12  # frames at the beginning and end of the rest whose mean positions are compared

_UNKNOWN: Final = "no clean strike"

Row: TypeAlias = tuple[str, str, str, str]
"""A line of the table: the quantity, its predicted and measured values, and their difference."""


class Section(NamedTuple):
    """A request, and the rows of its response."""

    time: float  # time of the request, s, on the recording's clock
    title: str
    rows: list[Row]


def sections(toss: Toss, strikes: Sequence[Strike], questioner: Questioner) -> list[Section]:
    """Return the requests in the order of time."""
    found = [
        *(_flight_section(asked, strikes, questioner) for asked in questioner.flights),
        *(_impact_section(asked, strikes, questioner) for asked in questioner.impacts),
        *(_mode_section(asked, toss) for asked in questioner.modes),
    ]
    return sorted(found, key=lambda section: section.time)


def print_table(toss: Toss, strikes: Sequence[Strike], questioner: Questioner) -> None:
    """Print the table."""
    print(f"\n{'':34}{'predicted':>27}{'measured':>27}{'difference':>16}")
    for section in sections(toss, strikes, questioner):
        print(f"\nt = {section.time:.3f} s, {section.title}")
        for quantity, predicted, measured, difference in section.rows:
            print(f"  {quantity:32}{predicted:>27}{measured:>27}{difference:>16}")
    print(
        f"\nThe states that were published carry noise: {1e3 * toss.velocity_noise:.0f} mm/s and "
        f"{toss.angular_velocity_noise:.2f} rad/s in each component of their velocities.\n"
        f"Their latency was at most {1e3 * questioner.latest:.0f} ms."
    )


def _strike_at(strikes: Sequence[Strike], time: float) -> Strike | None:
    near = [strike for strike in strikes if abs(strike.time - time) < SAME_STRIKE]
    return min(near, key=lambda strike: abs(strike.time - time), default=None)


def _flight_section(asked: Asked, strikes: Sequence[Strike], questioner: Questioner) -> Section:
    response = asked.response
    landing = questioner.seconds_of(response.state.header.stamp) + response.event_time
    title = f"in flight, {landing - asked.time:.2f} s before landing: where will it be? {_answered(asked)}"
    strike = _strike_at(strikes, landing)
    if strike is None:
        return Section(asked.time, title, [("time of landing, s", f"{landing:.4f}", _UNKNOWN, "")])
    state = strike.before.state
    position = np.array(response.trajectory.positions[-3:])
    turn = rotation_vectors(np.array(response.trajectory.orientations[-4:])[None], state.q_WB)[0]
    late, off = 1e3 * (landing - strike.time), 1e3 * _length(position - state.p_WB_W)
    rows = [
        ("time of landing, s", f"{landing:.4f}", f"{strike.time:.4f}", f"{late:+.1f} ms"),
        ("position then, m", _vector(position), _vector(state.p_WB_W), f"{off:.1f} mm"),
        ("attitude then", "", "", f"{math.degrees(_length(turn)):.1f} deg"),
    ]
    return Section(asked.time, title, rows)


def _impact_section(asked: Asked, strikes: Sequence[Strike], questioner: Questioner) -> Section:
    response = asked.response
    if response.status != response.OK:
        return Section(asked.time, f"what after the impact? {response.message}", [])
    time = questioner.seconds_of(response.state_before.header.stamp)
    title = f"{1e3 * (time - asked.time):.0f} ms before landing: what after the impact? {_answered(asked)}"
    after, strike = response.impact.state_after, _strike_at(strikes, time)
    v, w = vector_from_msg(after.linear_velocity), vector_from_msg(after.angular_velocity)
    outcome = OUTCOMES[ImpactOutcome(response.impact.outcome)]
    measured_v = measured_w = (_UNKNOWN, "")
    if strike is not None:
        before, measured = strike.before.state, strike.after.state
        measured_v = _measured(v, before.v_WB_W, measured.v_WB_W)
        measured_w = _measured(w, before.w_WB_W, measured.w_WB_W)
    rows = [
        ("velocity after, m/s", _vector(v), *measured_v),
        ("spin after, rad/s", _vector(w), *measured_w),
        ("the contact", outcome, "", ""),
    ]
    return Section(asked.time, title, rows)


def _measured(predicted: FloatArray, before: FloatArray, after: FloatArray) -> tuple[str, str]:
    """Return the measured value, and the error of the prediction with the measured change."""
    return _vector(after), f"{_length(predicted - after):.2f} of {_length(after - before):.2f}"


def _mode_section(asked: Asked, toss: Toss) -> Section:
    response, title = asked.response, "it rests, or nearly: which contact mode?"
    if response.status != response.OK:
        return Section(asked.time, f"{title} {response.message}", [])
    modes = " or ".join(mode.mode for mode in response.modes) or "none"
    verdict = ModeVerdict(response.verdict).name.lower()
    later = toss.p_WB_W[toss.times > asked.time]
    few = max(1, min(_AVERAGED, len(later) // 2))
    moved = _length(later[-few:].mean(axis=0) - later[:few].mean(axis=0)) if len(later) else 0.0
    row = (
        f"modes of {len(response.contacts.frictions)} contacts",
        f"{modes} ({verdict})",
        f"moved {1e3 * moved:.1f} mm",
        f"in {toss.times[-1] - asked.time:.2f} s",
    )
    return Section(asked.time, f"{title} {_answered(asked)}", [row])


def _answered(asked: Asked) -> str:
    return f"[answered in {1e3 * asked.round_trip:.1f} ms]"


def _length(vector: FloatArray) -> float:
    return float(np.linalg.norm(vector))


def _vector(vector: FloatArray) -> str:
    return " ".join(f"{number:8.3f}" for number in vector)
