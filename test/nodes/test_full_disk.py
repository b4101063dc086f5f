# SPDX-License-Identifier: Apache-2.0
"""A log whose disk is full: the server reports it, goes on answering, and logs again once there is room.

A limit on the size of files, which the kernel applies to a running process, refuses each write as a full disk
does.
"""

from __future__ import annotations

import json
import os
import re
import resource
import subprocess
import time
from pathlib import Path

import pytest
import yaml
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile

from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.situations import Part, Situation
from contact_dynamics.recording import BagReader, UnfinishedLogWarning
from contact_dynamics.recording.bag_writer import Gap
from contact_dynamics.recording.limits import UNLIMITED
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters.stamps import stamp_ns_from_msg
from nodes.monitor import hang, monitored, odometry
from running_server import PATIENCE_S

BEGIN = bytes([0, 1, 0, 0])  # of each serialised message


def give_room(server: subprocess.Popen[str], size: int) -> None:
    """Let files of a process have this size at most, bytes."""
    _, hard = resource.prlimit(server.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(server.pid, resource.RLIMIT_FSIZE, (size, hard))


def test_the_log_goes_on_once_there_is_room_and_says_what_is_missing(tmp_path: Path) -> None:
    """A message that is none came long before, which once hid that the disk was full."""
    sent: list[int] = []
    limits = {"log_directory": str(tmp_path), "silent_after": 1e6}
    with monitored(tmp_path, log=True, **limits) as (server, monitor):
        states = monitor.client.publisher(Odometry, "/brick/odometry")

        def publish() -> None:
            msg = odometry()
            states.publish(msg)
            sent.append(stamp_ns_from_msg(msg.header.stamp))

        states.publish(BEGIN)
        monitor.wait(Situation.LOG_REJECTING, "a message was not logged: data", work=publish)
        monitor.wait_until_ok(Part.LOG, work=publish)
        for _ in range(2):
            give_room(server, 0)
            message = monitor.wait(Situation.LOG_INTERRUPTED, "File too large", work=publish)
            assert re.search(r"[1-9]\d* messages are missing so far", message)
            question = PredictTumbling.Request(body_name="brick", times=[0.0])
            assert monitor.client.ask(question).status == 0
            give_room(server, resource.RLIM_INFINITY)
            monitor.wait_until_ok(Part.LOG, work=publish)
        publish()
        monitor.client.wait_until_found()  # the server has received it
        server.terminate()
        assert server.stdout is not None
        goodbye, _ = server.stdout.read(), server.wait(PATIENCE_S)
    (folder,) = (each for each in tmp_path.iterdir() if each.is_dir())
    assert goodbye.count("the log continues in") == 2
    written, lost = map(int, re.findall(r"\((\d+) messages, (\d+) lost", goodbye)[0])
    reader = BagReader(folder)
    with pytest.warns(
        UnfinishedLogWarning, match="its writer was killed"
    ):  # the files that the disk refused to finish
        messages = list(reader.messages())
    assert len(messages) == written
    metadata = yaml.safe_load((folder / "metadata.yaml").read_text(encoding="utf-8"))
    text = metadata["rosbag2_bagfile_information"]["custom_data"]["gaps"]
    last_file = folder / metadata["rosbag2_bagfile_information"]["relative_file_paths"][-1]
    assert BagReader(last_file).run()["gaps"] == text
    gaps = [Gap(**each) for each in json.loads(text)]
    assert len(gaps) == 2
    assert sum(gap.lost for gap in gaps) == lost - 1  # the message that is none was rejected
    logged = {each.publish_time_ns for each in messages if each.topic == "/brick/odometry"}
    missing = [stamp_ns for stamp_ns in sent if stamp_ns not in logged]
    assert sent[-1] in logged
    assert 0 < len(missing) <= lost
    slack_ns = 1_000_000_000  # from the stamp of a message until it is received
    for stamp_ns in missing:
        assert any(gap.from_ns - slack_ns <= stamp_ns <= gap.until_ns for gap in gaps)


def test_each_kind_of_problem_of_the_log_is_reported_while_it_is_there(tmp_path: Path) -> None:
    told: list[str] = []
    resumed: list[str] = []
    log = Log(str(tmp_path), run={}, limits=UNLIMITED, on_problem=told.append, on_notice=resumed.append)
    log.add_topic("/pose", "geometry_msgs/msg/Pose", QoSProfile(depth=1))
    log.start()
    assert log.present() == []
    log.record("/pose", bytes(3))
    wait_for(log, Situation.LOG_REJECTING)
    log.record("/pose", bytes(1_000_000_000))
    (rejecting,) = log.present()
    assert "a message of 1000000200 bytes is not logged" in rejecting.text
    fail = hang(log)  # the disk, which now blocks each write
    for _ in range(70):
        log.record("/pose", BEGIN + os.urandom(1_000_000))
    wait_for(log, Situation.LOG_DROPPING)
    fail()
    wait_for(log, Situation.LOG_INTERRUPTED)
    deadline = time.monotonic() + PATIENCE_S
    while not resumed:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    wait_for(log, Situation.LOG_INTERRUPTED)  # a monitor that looks every second sees a second of it too
    deadline = time.monotonic() + PATIENCE_S
    while log.present():
        assert time.monotonic() < deadline
        time.sleep(0.01)
    log.close()
    assert len(told) == 3


def wait_for(log: Log, situation: Situation) -> None:
    deadline = time.monotonic() + PATIENCE_S
    words = {
        Situation.LOG_REJECTING: "not logged",
        Situation.LOG_DROPPING: "does not keep up",
        Situation.LOG_INTERRUPTED: "is interrupted",
    }[situation]
    while not any(words in each.text and each.level is situation.value.level for each in log.present()):
        assert time.monotonic() < deadline
        time.sleep(0.01)
