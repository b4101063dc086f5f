# SPDX-License-Identifier: Apache-2.0
"""Logs that are published over DDS to a real server, whose own log says what came."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile
from rosbags.rosbag2 import StoragePlugin

from contact_dynamics.recording import BagReader, ServiceCall, decode_without_ros, service_calls
from contact_dynamics.replay.run import main
from contact_dynamics.replay.verify import differences, verify_log
from message_words import says
from replay.asked_log import Asked, configured
from replay.flights import flight, write_flight
from running_server import PATIENCE_S, ROOT, Client, environment, process, wait_for

STATES = {"/brick/odometry", "/ball/pose", "/ball/twist"}


def published(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run `contact-dynamics replay publish` to its end."""
    command = [sys.executable, "-m", "contact_dynamics", "replay", "publish", *map(str, arguments)]
    return subprocess.run(
        command, cwd=ROOT, env=environment(), capture_output=True, text=True, check=False, timeout=300
    )


def calls_of(log: Path) -> list[ServiceCall]:
    """The calls of a log, service by service, each in the order in which they were answered."""
    calls = (call for call in service_calls(BagReader(log).messages()) if call.response_event is not None)
    return sorted(calls, key=lambda call: call.service)


def test_the_time_of_the_log_gives_its_states_and_its_answers(asked: Asked, tmp_path: Path) -> None:
    """With its clock, a server under use_sim_time says the same to the bit as the one that was there."""
    arguments = ["--params-file", str(configured(tmp_path)), "--ros-args"]
    arguments += ["-p", f"log_directory:={tmp_path / 'logs'}", "-p", "use_sim_time:=true"]
    with process("server", *arguments, ready="ready"):
        done = published(asked.log, "--clock", "--requests", "--wait", str(PATIENCE_S))
    count = sum(asked.counts.values())
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{count} requests sent, {count} responses received" in done.stderr
    assert compared(done.stdout)["predict_contact_mode"] == (asked.counts["PredictContactMode"],) * 2
    (log,) = (tmp_path / "logs").iterdir()
    for topic in STATES:
        before, after = ([m.data for m in BagReader(path).messages({topic})] for path in (asked.log, log))
        assert after == before, topic
    # What names no time of its own depends on when it came between two states, which DDS does not keep: so
    # questions about a stated state and refusals are compared.
    before, after = calls_of(asked.log), calls_of(log)
    assert [call.service for call in after] == [call.service for call in before]
    explicit = 0
    for old, new in zip(before, after, strict=True):
        assert old.response_event is not None
        assert new.response_event is not None
        if not old.service.endswith("/predict_contact_mode"):
            continue
        explicit += 1
        answers = [decode_without_ros(call).response[0] for call in (old.response_event, new.response_event)]
        assert list(differences(*answers)) == []
    assert explicit == asked.counts["PredictContactMode"]
    assert verify_log(log).agrees


def compared(printed: str) -> dict[str, tuple[int, int]]:
    """How many questions of each service were asked, and how many were answered as in the log."""
    rows = [line.split() for line in printed.splitlines() if line.startswith("  /contact_dynamics/")]
    return {row[0].rpartition("/")[2]: (int(row[1]), int(row[2])) for row in rows if len(row) == 4}


def test_other_answers_are_told_and_counted(asked: Asked, tmp_path: Path) -> None:
    """The server has another friction, as who compares two of them would have it."""
    arguments = ["--params-file", str(configured(tmp_path)), "--ros-args", "-p", "log_directory:=''"]
    arguments += ["-p", "surface.floor.friction:=0.31"]
    with process("server", *arguments, ready="ready"):
        done = published(asked.log, "--requests", "--wait", str(PATIENCE_S))
    assert done.returncode == 1
    questions, equal = compared(done.stdout)["predict_contact_mode"]
    assert questions == asked.counts["PredictContactMode"]
    assert equal < questions
    assert "/contact_dynamics/predict_contact_mode, request " in done.stdout
    assert compared(done.stdout)["predict_tumbling_batch"][0] == asked.counts["PredictTumblingBatch"]
    assert len(set(compared(done.stdout)["predict_tumbling_batch"])) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        # States that come twice as fast with the same velocities would land elsewhere.
        ("--rate 2", "--rate must be 1 if stamps are shifted to the present, got 2"),
        ("--rate 0.5 --stamps now --clock", "--rate must be 1 if stamps are shifted..., got 0.5"),
        (
            "--start 5 --end 6",
            "--start and --end must be a part of...bag, which lasts 0.945 s..., got 5 s to 6 s",
        ),
        ("--requests", "not a log of the server"),
    ],
)
def test_what_cannot_be_published_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: str, words: str
) -> None:
    write_flight(tmp_path / "bag")
    try:
        code: object = main(["publish", str(tmp_path / "bag"), *arguments.split()])
    except SystemExit as ended:  # of argparse
        code = ended.code
    assert code == 2
    assert says(capsys.readouterr().err, words)


def test_stamps_are_moved_to_the_present(asked: Asked, tmp_path: Path) -> None:
    """A server by the machine's clock takes the states as new ones, and answers questions about them."""
    arguments = ["--params-file", str(configured(tmp_path)), "--ros-args"]
    arguments += ["-p", f"log_directory:={tmp_path / 'logs'}"]
    with process("server", *arguments, ready="ready"):
        began_ns = time.time_ns()  # the log that is published has ended before
        done = published(asked.log, "--requests", "--wait", str(PATIENCE_S))
        ended_ns = time.time_ns()
    assert done.returncode == 0, done.stdout + done.stderr
    for service in ("predict_impact_batch", "predict_tumbling_batch", "predict_contact_mode"):
        questions, equal = compared(done.stdout)[service]
        assert questions == equal > 0
    (log,) = (tmp_path / "logs").iterdir()
    for message in BagReader(log).messages(STATES):
        assert began_ns < message.publish_time_ns < ended_ns
    answered = []
    for path in (asked.log, log):
        responses = [decode_without_ros(call.response_event).response[0] for call in calls_of(path)]
        answered.append(sum(response.status == response.OK for response in responses))
    # DDS does not keep the order between topics and services. Rounds are 20 ms apart, with four questions
    # about published states in each. Those of two rounds can overtake the first states, then or now.
    assert abs(answered[1] - answered[0]) <= 8
    assert verify_log(log).agrees


def test_a_recording_of_others_in_its_time_and_faster(tmp_path: Path) -> None:
    """0.95 s of states at twice the rate, twice over, take at least 0.47 s each."""
    write_flight(tmp_path / "bag", storage=StoragePlugin.MCAP)
    begin = time.monotonic()
    done = published(tmp_path / "bag", "--rate", "2", "--stamps", "logged", "--wait", "0")
    assert done.returncode == 0, done.stderr
    assert time.monotonic() - begin > 0.47
    assert f"{2 * len(flight())} messages published" in done.stderr
    done = published(tmp_path / "bag", "--start", "0.5", "--end", "0.6", "--wait", "0")
    assert "40 messages published" in done.stderr  # 20 states and 20 points


def test_a_loop_goes_on_until_it_is_told_to_stop(tmp_path: Path) -> None:
    write_flight(tmp_path / "bag")
    command = [sys.executable, "-m", "contact_dynamics", "replay", "publish", tmp_path / "bag"]
    with subprocess.Popen(
        [*command, "--loop", "--rate", "50", "--stamps", "logged", "--wait", "0"],
        cwd=ROOT,
        env=environment(),
        stderr=subprocess.PIPE,
        text=True,
    ) as started:
        client = Client(wait=False)
        heard: list[bytes] = []
        client.node.create_subscription(
            Odometry, "/tracker/ball", heard.append, QoSProfile(depth=1000), raw=True
        )
        client.spin_until(lambda: len(heard) > 3 * len(flight()))
        client.close()
        started.send_signal(signal.SIGINT)
        told = started.communicate(timeout=PATIENCE_S)[1]
        assert started.returncode == 0
    count = int(told.partition(" messages published")[0].rpartition(" ")[2])
    assert count > 2 * 2 * len(flight())


def in_a_terminal(bag: Path, *, typed_before: bytes = b"") -> tuple[subprocess.Popen[str], int]:
    """Begin paused to publish a log in a terminal; return the process and what types into it."""
    outside, inside = pty.openpty()
    os.write(outside, typed_before)
    command = [sys.executable, "-m", "contact_dynamics", "replay", "publish", bag, "--paused", "--wait", "0"]
    started = subprocess.Popen(
        command,
        cwd=ROOT,
        env=environment(),
        stdin=inside,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    os.close(inside)
    return started, outside


def test_the_space_bar_lets_time_stand_still(tmp_path: Path) -> None:
    """In a terminal: paused, nothing is published; after the space bar, all is."""
    write_flight(tmp_path / "bag")
    started, outside = in_a_terminal(tmp_path / "bag")
    try:
        wait_for(started, "paused: press the space bar to resume")
        with pytest.raises(subprocess.TimeoutExpired):
            started.wait(2.0)  # what is left takes a second
        os.write(outside, b" ")
        printed = started.communicate(timeout=PATIENCE_S)[0]
        assert started.returncode == 0
    finally:
        started.kill()
        started.communicate()
        os.close(outside)
    assert f"{2 * len(flight())} messages published" in printed


def test_keys_that_are_pressed_before_it_reads_them_count(tmp_path: Path) -> None:
    """Two keys in one go, too early: the first space goes on, and the next two pause and go on again."""
    write_flight(tmp_path / "bag")
    started, outside = in_a_terminal(tmp_path / "bag", typed_before=b"   ")
    try:
        printed = started.communicate(timeout=PATIENCE_S)[0]
        assert started.returncode == 0
    finally:
        started.kill()
        started.communicate()
        os.close(outside)
    assert f"{2 * len(flight())} messages published" in printed
