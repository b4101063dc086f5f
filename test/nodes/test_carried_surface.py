# SPDX-License-Identifier: Apache-2.0
"""A cup on a tray whose states are published: server, log, verification and picture."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
from nav_msgs.msg import Odometry

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.evaluation.log_states import parameters_of
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.srv import PredictContactMode
from msg_adapters.stamps import stamp_to_msg
from nodes.monitor import parameters_file
from running_server import PATIENCE_S, Client, process

PERIOD_NS = 10_000_000
PARAMETERS: dict[str, Any] = {
    "bodies": ["tray", "cup"],
    "body.tray.mass": 1.0,
    "body.tray.box": [0.4, 0.4, 0.02],
    "body.tray.odometry_topic": "/tray",
    "body.cup.mass": 0.3,
    "body.cup.box": [0.06, 0.06, 0.1],
    "body.cup.odometry_topic": "/cup",
    "surfaces": ["top"],
    "surface.top.body": "tray",
    "surface.top.point": [0.0, 0.0, 0.01],
    "surface.top.friction": 0.3,
    "surface.top.restitution": 0.2,
}


def states(frame: str, a: float, height: float, begin_ns: int) -> list[Odometry]:
    """Eleven states, one every 10 ms, of a body that accelerates along x from rest."""
    found = []
    for k in range(11):
        t = 0.01 * k
        msg = Odometry(child_frame_id=frame)
        msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(begin_ns + k * PERIOD_NS)
        msg.pose.pose.position.x, msg.pose.pose.position.z = 0.5 * a * t * t, height
        msg.pose.pose.orientation.w = 1.0
        msg.twist.twist.linear.x = a * t
        found.append(msg)
    return found


def test_a_cup_on_an_accelerating_tray_is_answered_logged_and_verified(tmp_path: Path) -> None:
    path = parameters_file(tmp_path, {**PARAMETERS, "state_timeout": 1e4, "state_history": 1e3})
    settings = ("--ros-args", "-p", f"log_directory:={tmp_path}")
    with process("server", "--params-file", str(path), *settings, ready="ready") as server:
        client = Client()
        try:
            publishers = {name: client.publisher(Odometry, f"/{name}") for name in ("tray", "cup")}
            client.wait_until_found()
            request = PredictContactMode.Request(body_name="cup")
            request.state_source = request.STATE_AT_STAMP
            for a, letter in ((2.0, "f"), (4.0, "c")):  # friction holds up to 0.3 g = 2.94 m/s^2
                begin_ns = time.time_ns() - 1_000_000_000
                for name, height in (("tray", 1.0), ("cup", 1.06)):
                    for msg in states(name, a, height, begin_ns):
                        publishers[name].publish(msg)
                request.stamp = stamp_to_msg(begin_ns + 10 * PERIOD_NS)
                deadline = time.monotonic() + PATIENCE_S
                while (
                    (answer := client.ask(request)).status or answer.message
                ) and time.monotonic() < deadline:
                    time.sleep(0.05)
                assert (answer.status, answer.verdict, answer.message) == (0, answer.UNIQUE, "")
                assert [mode.mode for mode in answer.modes] == [4 * letter]
        finally:
            client.close()
        server.terminate()
        server.wait(PATIENCE_S)
    (folder,) = (each for each in tmp_path.iterdir() if each.is_dir())
    report = verify_log(folder)
    assert report.agrees
    assert sum(tally.equal for tally in report.services.values()) >= 2


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"surface.top.body": "table"}, r"surface\.top\.body must be one of the bodies \['tray', 'cup'\]"),
        ({"surface.top.velocity": [1.0, 0.0, 0.0]}, "surface.top.body must be empty for an obstacle, a belt"),
        ({"surface.top.box": [1.0, 1.0, 1.0]}, "surface.top.body must be empty for an obstacle"),
    ],
)
def test_what_is_wrong_with_a_carried_surface_is_named(
    values: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(ConfigurationError, match=words):
        read_server_parameters(ParameterFile(parameters_file(tmp_path, PARAMETERS | values)))


def test_events_on_a_carried_surface_are_not_evaluated(tmp_path: Path) -> None:
    with pytest.raises(NotSupportedError, match=r"surfaces must be at rest .* got 'top' on 'tray'"):
        parameters_of(ParameterFile(parameters_file(tmp_path, PARAMETERS)))
