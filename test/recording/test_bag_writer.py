# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import yaml

from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.recording import BagReader, BagWriter, LogExistsError, LogFailedError, OfferedQos

if TYPE_CHECKING:
    from collections.abc import Callable

    PoseCdr = Callable[[int, float], bytes]

POSE = "geometry_msgs/msg/PoseStamped"
NOW_NS = 1_700_000_000_000_000_000

# Keys and kinds of values of metadata.yaml version 9, from rosbag2's own encoder and decoder
# (rosbag2_storage, yaml.hpp).
TIME = {"sec": int, "nsec": int}
QOS_KEYS = {
    "history": str,
    "depth": int,
    "reliability": str,
    "durability": str,
    "deadline": TIME,
    "lifespan": TIME,
    "liveliness": str,
    "liveliness_lease_duration": TIME,
    "avoid_ros_namespace_conventions": bool,
}
BAG_KEYS = {
    "version": int,
    "storage_identifier": str,
    "duration": {"nanoseconds": int},
    "starting_time": {"nanoseconds_since_epoch": int},
    "message_count": int,
    "topics_with_message_count": [
        {
            "topic_metadata": {
                "name": str,
                "type": str,
                "serialization_format": str,
                "offered_qos_profiles": [QOS_KEYS],
                "type_description_hash": str,
            },
            "message_count": int,
        }
    ],
    "compression_format": str,
    "compression_mode": str,
    "relative_file_paths": [str],
    "files": [
        {
            "path": str,
            "starting_time": {"nanoseconds_since_epoch": int},
            "duration": {"nanoseconds": int},
            "message_count": int,
        }
    ],
    "custom_data": {"version": str, "mass": str},
    "ros_distro": str,
}


def kinds(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: kinds(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [kinds(inner) for inner in value]
    return type(value)


def write_poses(writer: BagWriter, pose_cdr: PoseCdr, count: int) -> None:
    for index in range(count):
        writer.write("/pose", pose_cdr(NOW_NS + index, float(index)), log_time_ns=NOW_NS + 1000 + index)


def metadata_of(folder: Path) -> Any:
    return yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]


def test_metadata_has_the_keys_that_rosbag2_reads(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    with BagWriter(tmp_path / "log", run={"mass": 'a "quoted": #value\n√2'}) as writer:
        writer.add_topic("/pose", POSE)
        write_poses(writer, pose_cdr, 3)
    metadata = metadata_of(tmp_path / "log")
    assert kinds(metadata) == BAG_KEYS
    assert metadata["version"] == 9
    assert metadata["ros_distro"] == "jazzy"
    assert metadata["message_count"] == metadata["topics_with_message_count"][0]["message_count"] == 3
    assert metadata["duration"]["nanoseconds"] == 2
    assert metadata["starting_time"]["nanoseconds_since_epoch"] == NOW_NS + 1000
    assert metadata["relative_file_paths"] == ["log_0.mcap"]
    assert metadata["custom_data"]["mass"] == 'a "quoted": #value\n√2'


def test_record_in_the_file_says_what_metadata_yaml_says(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    from mcap.reader import make_reader

    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        write_poses(writer, pose_cdr, 3)
    with writer.path.open("rb") as stream:
        records = {record.name: record.metadata for record in make_reader(stream).iter_metadata()}
    assert yaml.safe_load(records["rosbag2"]["serialized_metadata"]) == metadata_of(tmp_path / "log")
    assert set(records) == {"rosbag2", "contact_dynamics"}


def test_qos_of_rclpy_in_words(tmp_path: Path) -> None:
    qos = pytest.importorskip("rclpy.qos")
    duration = pytest.importorskip("rclpy.duration")
    profile = qos.QoSProfile(
        depth=7,
        reliability=qos.ReliabilityPolicy.BEST_EFFORT,
        durability=qos.DurabilityPolicy.TRANSIENT_LOCAL,
        deadline=duration.Duration(seconds=1, nanoseconds=5),
    )
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE, profile)
        writer.add_topic("/other", POSE, OfferedQos(history="keep_all"))
    first, second = metadata_of(tmp_path / "log")["topics_with_message_count"]
    (found,) = first["topic_metadata"]["offered_qos_profiles"]
    assert kinds(found) == QOS_KEYS
    assert (found["history"], found["depth"], found["reliability"]) == ("keep_last", 7, "best_effort")
    assert (found["durability"], found["deadline"]) == ("transient_local", {"sec": 1, "nsec": 5})
    (found,) = second["topic_metadata"]["offered_qos_profiles"]
    assert found["history"] == "keep_all"
    assert found["lifespan"] == {"sec": 9223372036, "nsec": 854775807}


def test_publishers_may_come_and_go_for_ever(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    """MCAP numbers the channels of a file with 16 bits. Each takes some 300 bytes, and stands there twice."""
    one, two = OfferedQos(depth=1), OfferedQos(depth=2)
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        for i in range(2000):
            writer.set_qos("/pose", [one, two] if i % 2 else [one])
        writer.write("/pose", pose_cdr(0, 0.0), log_time_ns=NOW_NS)
    bag = BagReader(tmp_path / "log")
    assert [message.topic for message in bag.messages()] == ["/pose"]
    assert bag.damage is None
    assert writer.path.stat().st_size < 20_000


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_never_overwrites(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "log"
    path.mkdir() if kind == "folder" else path.write_text("dear")
    with pytest.raises(LogExistsError, match="never overwritten") as caught:
        BagWriter(path)
    assert isinstance(caught.value, ContactDynamicsError)
    assert isinstance(caught.value, FileExistsError)
    assert list(path.iterdir()) == [] if kind == "folder" else path.read_text() == "dear"


@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("topic", {"topic": "/unknown"}),
        ("data", {"data": b"\0\1\0\0"}),
        ("data", {"data": "text"}),
        ("data", {"data": bytearray(100)}),
        ("data", {"data": b"\0\1\0\0\0"}),  # too short for the stamp of its type
        ("log_time_ns", {"log_time_ns": -1}),
        ("log_time_ns", {"log_time_ns": 2**63}),
        ("log_time_ns", {"log_time_ns": 1.0}),
        ("log_time_ns", {"log_time_ns": True}),
        ("publish_time_ns", {"publish_time_ns": -1}),
        ("publish_time_ns", {"publish_time_ns": "now"}),
    ],
)
def test_bad_argument_is_refused_by_name_and_the_log_goes_on(
    tmp_path: Path, pose_cdr: PoseCdr, field: str, change: dict[str, Any]
) -> None:
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        write_poses(writer, pose_cdr, 2)
        good = {
            "topic": "/pose",
            "data": pose_cdr(NOW_NS, 0.0),
            "log_time_ns": NOW_NS,
            "publish_time_ns": None,
        }
        with pytest.raises(InvalidFieldError, match=field):
            writer.write(**{**good, **change})
        write_poses(writer, pose_cdr, 2)
    assert len(list(BagReader(tmp_path / "log").messages())) == 4
    assert metadata_of(tmp_path / "log")["message_count"] == 4


@pytest.mark.parametrize("name", ["pose", "", "/pose"])
def test_topic_must_be_absolute_and_new(tmp_path: Path, name: str) -> None:
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        with pytest.raises(InvalidFieldError, match="topic"):
            writer.add_topic(name, POSE)


def test_run_must_be_text(tmp_path: Path) -> None:
    with pytest.raises(InvalidFieldError, match="mass"):
        BagWriter(tmp_path / "log", run={"mass": 1.0})  # type: ignore[dict-item]


def test_publish_time_is_the_stamp_the_given_or_the_reception(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        writer.add_topic("/unstamped", "geometry_msgs/msg/Point")
        writer.write("/pose", pose_cdr(17, 0.0), log_time_ns=NOW_NS)
        writer.write("/pose", pose_cdr(17, 0.0), log_time_ns=NOW_NS, publish_time_ns=18)
        writer.write("/pose", pose_cdr(-17, 0.0), log_time_ns=NOW_NS)  # before the epoch: MCAP's earliest
        writer.write("/unstamped", b"\0\1\0\0" + bytes(24), log_time_ns=NOW_NS)
    times = [message.publish_time_ns for message in BagReader(tmp_path / "log").messages()]
    assert times == [17, 18, 0, NOW_NS]


def test_closed_log_takes_nothing_and_closes_again(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    writer = BagWriter(tmp_path / "log")
    writer.add_topic("/pose", POSE)
    writer.close()
    writer.close()
    with pytest.raises(LogFailedError, match="closed"):
        write_poses(writer, pose_cdr, 1)
    with pytest.raises(LogFailedError, match="closed"):
        writer.flush()
    with pytest.raises(LogFailedError, match="closed"):
        writer.add_topic("/other", POSE)
    assert list(BagReader(tmp_path / "log").messages()) == []


# A soft limit on file size refuses writes as a full disk does: in part first, then wholly. In a process of
# its own, for the limit holds for all that a process writes.
FULL_DISK = """
import random, resource, struct, sys
from contact_dynamics.recording import BagWriter, LogFailedError
resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, resource.RLIM_INFINITY))
noise = random.Random(1)
writer = BagWriter(sys.argv[1])
writer.add_topic("/point", "geometry_msgs/msg/Point")
given = 0
try:
    while True:
        for _ in range(200):
            writer.write("/point", bytes([0, 1, 0, 0]) + noise.randbytes(24), log_time_ns=given)
            given += 1
        writer.flush()
except OSError as error:
    print(type(error).__name__, writer.safe_count, given)
try:
    writer.write("/point", bytes([0, 1, 0, 0]) + bytes(24), log_time_ns=0)
except LogFailedError:
    print("refused")
writer.close()
"""


def test_full_disk_leaves_the_log_whole_up_to_the_last_flush(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(tmp_path / "log")], capture_output=True, text=True, check=True
    )
    (kind, safe, given), (refused,) = (line.split() for line in done.stdout.splitlines())
    assert (kind, refused) == ("OSError", "refused")
    assert 0 < int(safe) < int(given)
    reader = BagReader(tmp_path / "log")
    with pytest.warns(UserWarning, match="its writer was killed"):
        messages = list(reader.messages())
    assert [message.log_time_ns for message in messages] == list(range(int(safe)))
    assert metadata_of(tmp_path / "log")["message_count"] == int(safe)
    assert sorted(path.name for path in (tmp_path / "log").iterdir()) == ["log_0.mcap", "metadata.yaml"]
