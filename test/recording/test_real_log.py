# SPDX-License-Identifier: Apache-2.0
"""One session between two real processes, read back by every reader at hand, each in its own way."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from contact_dynamics.recording import BagReader, decode, service_calls
from running_server import ROOT


def test_nothing_is_lost_between_publisher_and_file(real_log: Any) -> None:
    assert Counter(topic for topic, _, _ in real_log.received) == real_log.counts
    assert real_log.status.written == sum(real_log.counts.values())
    assert (real_log.status.lost, real_log.status.problem) == (0, None)


def test_our_reader_gives_back_each_byte_and_time(real_log: Any) -> None:
    reader = BagReader(real_log.folder)
    messages = list(reader.messages())
    assert [(message.topic, message.data, message.log_time_ns) for message in messages] == real_log.received
    assert {message.topic: message.type_name for message in messages} == real_log.types
    assert reader.damage is None
    assert reader.run()["mass_kg"] == "0.37"


def test_publish_times_are_the_sources_stamps(real_log: Any) -> None:
    for topic in ("/probe/odometry", "/probe/pose"):
        messages = list(BagReader(real_log.folder).messages({topic}))
        assert [message.publish_time_ns for message in messages] == real_log.stamps_ns
        stamps = [decode(message).header.stamp for message in messages]
        assert [stamp.sec * 10**9 + stamp.nanosec for stamp in stamps] == real_log.stamps_ns
    for topic in ("/probe/plan/_service_event", "/probe/change/_service_event"):
        times = [message.publish_time_ns for message in BagReader(real_log.folder).messages({topic})]
        assert times == sorted(times)
        assert real_log.began_ns <= times[0]
        assert times[-1] <= real_log.ended_ns


def test_each_call_is_found_with_its_request_and_response(real_log: Any) -> None:
    calls = list(service_calls(BagReader(real_log.folder).messages()))
    plans = [call for call in calls if call.service == "/probe/plan"]
    changes = [call for call in calls if call.service == "/probe/change"]
    assert [len(call.response().plan.poses) for call in plans] == real_log.answers
    assert [call.request().tolerance for call in plans] == [float(answer) for answer in real_log.answers]
    assert [call.request().transition.label for call in changes] == [f"step {n}" for n in range(len(plans))]
    assert all(call.response().success for call in changes)
    assert {call.service_type for call in changes} == {"lifecycle_msgs/srv/ChangeState"}


@pytest.mark.parametrize("whole_folder", [True, False])
def test_rosbags_reads_states_and_events(real_log: Any, *, whole_folder: bool) -> None:
    highlevel = pytest.importorskip("rosbags.highlevel")
    found: Counter[str] = Counter()
    answers = []
    with highlevel.AnyReader([real_log.folder if whole_folder else real_log.path]) as reader:
        for connection, log_time_ns, data in reader.messages():
            # rosbags files an event type under a name of its own.
            message = reader.deserialize(data, connection.msgtype.replace("/srv/", "/srv/msg/"))
            found[connection.topic] += 1
            assert real_log.began_ns <= log_time_ns <= real_log.ended_ns
            if connection.topic == "/probe/plan/_service_event" and len(message.response):
                answers.append(len(message.response[0].plan.poses))
        qos = reader.connections[0].ext.offered_qos_profiles[0]
    assert found == real_log.counts
    assert answers == real_log.answers
    assert (qos.history.name, qos.depth, qos.reliability.name) == ("KEEP_LAST", 1000, "RELIABLE")


def test_mcap_ros2_reads_states(real_log: Any) -> None:
    """It cannot decode events: it refuses the underscore in their type's name."""
    reader = pytest.importorskip("mcap_ros2.reader")
    topics = ["/probe/odometry", "/probe/pose"]
    messages = list(reader.read_ros2_messages(str(real_log.path), topics=topics))
    assert Counter(message.channel.topic for message in messages) == {t: real_log.counts[t] for t in topics}
    x = [m.ros_msg.pose.pose.position.x for m in messages if m.channel.topic == "/probe/odometry"]
    assert x == [0.5 * index for index in range(len(x))]


def test_mcap_library_finds_all_by_its_index(real_log: Any) -> None:
    from mcap.reader import make_reader

    with real_log.path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        topics = {channel.topic: channel for channel in summary.channels.values()}
        assert {
            topic: summary.schemas[channel.schema_id].name for topic, channel in topics.items()
        } == real_log.types
        assert all(channel.metadata["topic_type_hash"].startswith("RIHS01_") for channel in topics.values())
        found = Counter(channel.topic for _, channel, _ in reader.iter_messages())
    assert found == real_log.counts


def test_rerun_finds_nothing_to_complain_of(real_log: Any) -> None:
    pytest.importorskip("rerun")
    rerun = Path(sys.executable).with_name("rerun")
    done = subprocess.run(
        [str(rerun), "mcap", "check", "--full", str(real_log.path)],
        capture_output=True,
        text=True,
        check=True,
    )
    lines = {
        topic: line for line in done.stdout.splitlines() for topic in real_log.counts if f" {topic} " in line
    }
    assert set(lines) == set(real_log.counts)
    assert {(line.split()[0], line.split()[-1]) for line in lines.values()} == {("ok", "—")}


def test_rerun_draws_nothing_of_a_log_by_itself(real_log: Any, tmp_path: Path) -> None:
    """As `docs/log.md` says, the values are there, but nothing that its 3D view would show."""
    pytest.importorskip("rerun")
    rerun, converted = Path(sys.executable).with_name("rerun"), tmp_path / "log.rrd"
    subprocess.run([str(rerun), "mcap", "convert", str(real_log.path), "-o", str(converted)], check=True)
    printed = subprocess.run(
        [str(rerun), "rrd", "print", "-v", str(converted)], capture_output=True, text=True, check=True
    ).stdout
    assert "nav_msgs.msg.Odometry:message" in printed
    shapes = (
        "Transform3D",
        "Transform",
        "Points3D",
        "Boxes3D",
        "Mesh3D",
        "Asset3D",
        "Arrows3D",
        "LineStrips3D",
    )
    assert [shape for shape in shapes if f"{shape}:" in printed] == []
    assert "viewport stays empty" in (ROOT / "docs" / "log.md").read_text(encoding="utf-8")
