# SPDX-License-Identifier: Apache-2.0
"""States read from logs: the same events as from the toss itself, whatever clock and configuration."""

from __future__ import annotations

import json
import math
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from contact_dynamics.demo.toss_publisher import topic_of
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.evaluation.log_states import recording_of_log
from contact_dynamics.evaluation.recording import Recording, recording_of_toss
from contact_dynamics.evaluation.sources import Source, find_sources
from contact_dynamics.measured.events import find_events
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.nodes.run_record import run_record
from contact_dynamics.questions.uncertain_state import KnownState, UncertainState
from contact_dynamics.recording import BagReader, BagWriter
from contact_dynamics.recording.errors import NotALogError
from evaluation.made_logs import BRIEF, EPOCH_NS, parameters_of_toss, write_log
from evaluation.made_motion import only_motion
from msg_adapters.odometry import ODOMETRY
from msg_adapters.state_adapter import SourceSettings
from msg_adapters.transforms import TransformTree


def happened(recording: Recording) -> list[tuple[str, str, float]]:
    return [(event.kind.value, event.surface, event.time) for event in find_events(only_motion(recording))]


def assert_same_events(found: Recording, expected: Recording) -> None:
    """The noise is estimated from a log and stated by a toss: times may differ within their deviations."""
    ours, theirs = happened(found), happened(expected)
    assert [event[:2] for event in ours] == [event[:2] for event in theirs]
    assert [event[2] for event in ours] == pytest.approx([event[2] for event in theirs], abs=2e-3)


def written(parameters: dict[str, Any], folder: Path) -> Path:
    """A parameter file with these."""
    config = folder / "other.yaml"
    config.write_text(json.dumps({"/**": {"ros__parameters": parameters}}), encoding="utf-8")
    return config


def test_a_log_has_the_events_of_the_toss_that_it_holds(tmp_path: Path) -> None:
    toss = read_toss()
    found = recording_of_log(write_log(tmp_path / "log"))
    motion = only_motion(found)
    assert len(motion) == len(toss)
    assert motion.p_WB_W == pytest.approx(toss.p_WB_W, abs=1e-12)
    assert motion.v_WB_W[100] == pytest.approx(toss.v_WB_W[100], abs=1e-12)
    assert motion.w_WB_W[100] == pytest.approx(toss.w_WB_W[100], abs=1e-12)
    assert motion.position_noise == pytest.approx(toss.position_noise, rel=0.1)
    assert motion.orientation_noise == pytest.approx(toss.orientation_noise, rel=0.1)
    assert_same_events(found, recording_of_toss(toss))


def test_a_state_is_known_when_it_arrived(tmp_path: Path) -> None:
    motion = only_motion(recording_of_log(write_log(tmp_path / "log", delay_ns=12_000_000)))
    assert set((motion.arrivals_ns - motion.stamps_ns).tolist()) == {12_000_000}


def test_states_read_together_are_those_of_single_messages(tmp_path: Path) -> None:
    """Plain messages are read many at once. Some among them have a covariance, another frame or faults."""
    toss, lever = read_toss(), [0.1, -0.03, 0.02]
    name = toss.body.name
    parameters = parameters_of_toss(tmp_path / "beside", toss) | {f"body.{name}.center_of_mass": lever}
    settings = SourceSettings(
        body_name=name,
        body_frame=name,
        world_frame="world",
        p_FB_F=np.array(lever),
        velocity_window=0.1,
        static=TransformTree(),
    )
    (reader,) = ODOMETRY.readers(settings)
    expected: list[KnownState] = []
    with BagWriter(tmp_path / "odd", run=run_record(parameters, {})) as writer:
        writer.add_topic(topic_of(toss), "nav_msgs/msg/Odometry")
        for i, message in enumerate(BagReader(write_log(tmp_path / "log", until=BRIEF)).messages()):
            msg = deserialize_message(message.data, Odometry)
            turn = msg.pose.pose.orientation
            if i % 20 == 3:
                msg.pose.covariance[::7] = msg.twist.covariance[::7] = np.full(6, 1e-4)
            elif i % 20 == 7:
                msg.header.frame_id = "elsewhere"
            elif i % 20 == 9:
                msg.twist.twist.linear.y = math.nan
            elif i % 20 == 11:
                turn.x += 0.1
            elif i % 20 == 13:
                turn.x, turn.y, turn.z, turn.w = (1.0005 * each for each in (turn.x, turn.y, turn.z, turn.w))
            data = bytes(serialize_message(msg))
            writer.write(message.topic, data, log_time_ns=message.log_time_ns, publish_time_ns=0)
            with suppress(ContactDynamicsError):
                expected.append(reader(msg))
    motion = only_motion(recording_of_log(tmp_path / "odd"))
    found = [motion.state(sample) for sample in range(len(motion))]
    assert [each.to_dict() for each in found] == [each.to_dict() for each in expected]
    assert sum(isinstance(each, UncertainState) for each in found) == 10
    assert len(found) == i + 1 - 3 * 10


def test_under_another_clock_a_state_is_known_at_its_stamp(tmp_path: Path) -> None:
    """In simulated time stamps are seconds from 0, and log_time is the machine's."""
    motion = only_motion(recording_of_log(write_log(tmp_path / "log", clock_offset_ns=EPOCH_NS - 10**9)))
    assert motion.stamps_ns[0] < 2 * 10**9
    assert motion.arrivals_ns.tolist() == motion.stamps_ns.tolist()


def test_a_configuration_beside_the_log_is_used_instead_of_its_own(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log", with_run=False)
    with pytest.raises(NotALogError, match="--config is required"):
        recording_of_log(log)
    parameters = parameters_of_toss(tmp_path / "other", read_toss())
    surface = parameters["surfaces"][0]
    parameters[f"surface.{surface}.friction"] = 0.77
    config = written(parameters, tmp_path)
    found = recording_of_log(log, config=config)
    assert found.informed.world.surfaces[0].friction == 0.77
    assert_same_events(found, recording_of_toss(read_toss()))


@pytest.mark.parametrize("mode", [CompressionMode.NONE, CompressionMode.FILE])
@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_bag_of_another_tool_has_the_events_too(
    tmp_path: Path, storage: StoragePlugin, mode: CompressionMode
) -> None:
    messages = list(BagReader(write_log(tmp_path / "log")).messages())
    writer = Writer(tmp_path / "foreign", version=9, storage_plugin=storage)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection(
            messages[0].topic, messages[0].type_name, typestore=get_typestore(Stores.ROS2_JAZZY)
        )
        for message in messages:
            writer.write(connection, message.log_time_ns, message.data)
    (source,), refused = find_sources([str(tmp_path / "foreign")])
    assert refused == []
    parameters_of_toss(tmp_path / "beside", read_toss())
    found = source.read(config=tmp_path / "beside" / "server.yaml")
    assert_same_events(found, recording_of_toss(read_toss()))
    assert len(source.digest()) == 64


def test_a_log_without_states_of_a_configured_body_is_refused(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log", with_run=False)
    parameters = parameters_of_toss(tmp_path / "other", read_toss())
    name = parameters["bodies"][0]
    parameters[f"body.{name}.odometry_topic"] = "/elsewhere"
    config = written(parameters, tmp_path)
    with pytest.raises(ValueError, match="no state of a configured body"):
        recording_of_log(log, config=config)


def test_a_log_that_was_cut_short_is_evaluated_as_far_as_it_goes(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log")
    (file,) = log.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: -file.stat().st_size // 3])
    found = recording_of_log(log)
    assert "damaged or was cut short" in found.damage
    assert 12 <= len(only_motion(found)) < len(read_toss())


def test_a_log_is_read_in_parts_by_body(tmp_path: Path) -> None:
    log = Source(path=write_log(tmp_path / "log", names=("one", "two", "three"), until=BRIEF))
    parts = log.parts(2)
    assert [part.bodies for part in parts] == [("one",), ("two",), ("three",), ("three",)]
    assert [part.share for part in parts] == [(0, 1), (0, 1), (0, 2), (1, 2)]
    found = [[motion.body.name for motion in part.read().motions] for part in parts]
    assert found == [["one"], ["two"], ["three"], ["three"]]
    assert {part.name for part in parts} == {log.name}
    assert log.parts(1) == [log]
