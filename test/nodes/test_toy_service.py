# SPDX-License-Identifier: Apache-2.0
"""A service that a record adds is served, logged, verified, tabulated, drawn and plotted."""

from __future__ import annotations

import csv
import subprocess
import sys
import time
from pathlib import Path

import pytest
from builtin_interfaces.msg import Time
from nav_msgs.msg import Odometry

from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import DEEP, PATIENT, ROOT, Client, environment, process
from toy_service import IMPORTED, PROGRAM
from viewing.drawn import read_drawn

UP = 1.0  # m/s, at the beginning
GRAVITY = 9.80665  # m/s^2
HEIGHT = 1.0 + 0.5 * UP**2 / GRAVITY  # m, of the highest point
STATES = 60
STEP = 0.005  # s


def thrown(begun_ns: int, seconds: float) -> Odometry:
    """The state of a brick that was thrown upwards."""
    msg = Odometry(child_frame_id="brick")
    stamp_ns = begun_ns + round(1e9 * seconds)
    msg.header.frame_id = "world"
    msg.header.stamp = Time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    msg.pose.pose.position.z = 1.0 + UP * seconds - 0.5 * GRAVITY * seconds**2
    msg.twist.twist.linear.z = UP - GRAVITY * seconds
    return msg


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("toy")


@pytest.fixture(scope="module")
def log(folder: Path) -> Path:
    """The log of a server that was asked how high a brick rises, while it flew and a visualizer drew it."""
    shared = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p"]
    path = {"PYTHONPATH": f"{ROOT}:{ROOT / 'test'}"}
    told = {IMPORTED: str(folder / "imported"), **path}
    drawing = [*shared, f"rrd_path:={folder / 'live.rrd'}"]
    serving = [*shared, f"log_directory:={folder / 'logs'}", "-p", PATIENT]
    with (
        process("server", *serving, ready="ready", program=PROGRAM, settings=told),
        process("visualizer", *drawing, ready="ready", program=PROGRAM, settings=path),
    ):
        client = Client(wait=False)
        try:
            apex = client.node.create_client(
                PredictTumbling, "/contact_dynamics/predict_apex", qos_profile=DEEP
            )
            states = client.publisher(Odometry, "/brick/odometry")
            client.spin_until(apex.service_is_ready)
            begun_ns = time.time_ns()
            for number in range(STATES):
                states.publish(thrown(begun_ns, STEP * number))
                if number == 1:
                    time.sleep(0.1)  # the server takes these two first
                    future = apex.call_async(PredictTumbling.Request(body_name="brick"))
                    client.spin_until(future.done)
            answer = future.result()
            assert answer.status == answer.OK, answer.message
            assert answer.trajectory.positions[2] == pytest.approx(HEIGHT, abs=1e-9)
            time.sleep(0.2)  # the states after it are logged
        finally:
            client.close()
    (found,) = (folder / "logs").iterdir()
    return found


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the command line with the service in its table."""
    done = subprocess.run(
        [sys.executable, *PROGRAM, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        env={**environment(), "PYTHONPATH": f"{ROOT}:{ROOT / 'test'}"},
    )
    assert done.returncode == 0, done.stderr
    return done


def test_the_server_has_imported_no_viewer(log: Path) -> None:
    assert (log.parents[1] / "imported").read_text(encoding="utf-8") == "set()"


def test_its_answer_is_verified(log: Path) -> None:
    assert "/contact_dynamics/predict_apex 1 1 0" in " ".join(run("replay", "verify", log).stdout.split())


def test_its_answer_is_a_row_with_what_was_then_measured(log: Path, folder: Path) -> None:
    run("replay", "table", log, "--output", folder / "table.csv")
    with (folder / "table.csv").open(encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert (row["service"], row["body"]) == ("predict_apex", "brick")
    assert row["summary"].startswith("rises for 0.")
    assert float(row["predicted_z"]) == pytest.approx(HEIGHT, abs=1e-9)
    # Stamps are whole nanoseconds, in which the body moves by 1 nm at most.
    assert float(row["position_error"]) < 1e-8


def test_its_answer_is_drawn_and_put_into_words_live_and_from_the_log(log: Path, folder: Path) -> None:
    run("replay", "view", log, "--rrd", folder / "logged.rrd")
    for picture in ("live.rrd", "logged.rrd"):
        drawn = read_drawn(folder / picture)
        ((_, points),) = drawn.values["/world/apex", "Points3D:positions"]
        assert points[0][2] == pytest.approx(HEIGHT, abs=1e-6)  # single precision
        said = str([value for (_, component), value in drawn.values.items() if component == "TextLog:text"])
        assert "Apex: brick rises for 0." in said
        assert "a point is drawn at the top" in said


def test_its_answer_is_plotted(log: Path, folder: Path) -> None:
    run("plot", log, "--output", folder / "plots")
    assert [path.name for path in (folder / "plots").iterdir()] == ["001-apex-brick-top.svg"]
