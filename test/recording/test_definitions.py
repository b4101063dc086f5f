# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.definitions import ament_prefixes, find_definition

SHARES = [share for prefix in ament_prefixes() if (share := prefix / "share").is_dir()]
PACKAGES = ("std_msgs", "geometry_msgs", "nav_msgs", "rcl_interfaces", "service_msgs", "lifecycle_msgs")


def installed(folder: str) -> list[str]:
    files = {
        file for share in SHARES for package in PACKAGES for file in share.glob(f"{package}/{folder}/*.json")
    }
    return sorted(f"{file.parent.parent.name}/{folder}/{file.stem}" for file in files)


def test_there_are_types_to_test() -> None:
    assert len(installed("msg")) > 50
    assert len(installed("srv")) > 10


def test_text_of_every_message_hashes_to_the_hash_of_its_type() -> None:
    """Witness: rosbags computes the hash of REP 2011 from the text alone.

    Types with a char are left out: rosbags 0.11 takes it for a uint8, and so hashes another type.
    """
    msg = pytest.importorskip("rosbags.typesys.msg")
    typesys = pytest.importorskip("rosbags.typesys")
    wrong = []
    for type_name in installed("msg"):
        definition = find_definition(type_name)
        if re.search(r"^char\b", definition.text, re.MULTILINE):
            continue
        store = typesys.get_typestore(typesys.Stores.EMPTY)
        store.register(msg.get_types_from_msg(definition.text, type_name))
        if store.hash_rihs01(type_name) != definition.type_hash:
            wrong.append(type_name)
    assert wrong == []


@pytest.mark.parametrize("service", installed("srv"))
def test_event_names_the_types_that_rosidl_says_it_is_built_of(service: str) -> None:
    definition = find_definition(f"{service}_Event")
    assert definition.is_service_event
    sections = {
        line.removeprefix("MSG: ") for line in definition.text.splitlines() if line.startswith("MSG: ")
    }
    package, _, name = service.split("/")
    described = json.loads(
        next(s / package / f"srv/{name}.json" for s in SHARES if (s / package).is_dir()).read_text()
    )
    parts = {f"{service}_Request", f"{service}_Response"}
    others = {entry["type_name"] for entry in described["type_hashes"]} - {service, f"{service}_Event"}
    assert parts <= others
    assert {name.replace("/msg/", "/").replace("/srv/", "/") for name in others} == sections
    assert definition.type_hash.startswith("RIHS01_")


def test_separator_and_order_are_those_of_mcap() -> None:
    text = find_definition("geometry_msgs/msg/PoseStamped").text
    root, *sections = text.split("\n" + "=" * 80 + "\n")
    assert "std_msgs/Header header" in root
    assert [section.splitlines()[0] for section in sections] == [
        "MSG: std_msgs/Header",
        "MSG: builtin_interfaces/Time",
        "MSG: geometry_msgs/Pose",
        "MSG: geometry_msgs/Point",
        "MSG: geometry_msgs/Quaternion",
    ]


@pytest.mark.parametrize(
    ("type_name", "expected"),
    [
        ("nav_msgs/msg/Odometry", True),
        ("rcl_interfaces/msg/Log", True),
        ("geometry_msgs/msg/Pose", False),
        ("std_msgs/msg/String", False),
        ("nav_msgs/srv/GetPlan_Event", False),
    ],
)
def test_knows_which_types_begin_with_a_stamp(type_name: str, *, expected: bool) -> None:
    assert find_definition(type_name).begins_with_stamp is expected


@pytest.mark.parametrize(
    "type_name",
    [
        "nav_msgs/Odometry",
        "nav_msgs/msg/odometry",
        "nav_msgs/srv/GetPlan",
        "nav_msgs/msg/GetPlan_Event",
        "../msg/Odometry",
        "nav_msgs/msg/NotThere",
        "not_there/msg/Odometry",
        "",
    ],
)
def test_refuses_what_is_no_installed_type(type_name: str) -> None:
    with pytest.raises(InvalidFieldError, match="type_name"):
        find_definition(type_name)


def test_nearer_prefix_wins_and_a_type_without_json_has_no_hash(tmp_path: Path) -> None:
    for prefix, text in (("near", "float64 a # metres\nInner[<=3] inner\n"), ("far", "float64 b\n")):
        folder = tmp_path / prefix / "share/own_msgs/msg"
        folder.mkdir(parents=True)
        (folder / "Outer.msg").write_text(text)
    (tmp_path / "near/share/own_msgs/msg/Inner.msg").write_text('string<=5 NAME="x y"\nstring<=5 name\n')
    definition = find_definition("own_msgs/msg/Outer", prefixes=[tmp_path / "near", tmp_path / "far"])
    assert "MSG: own_msgs/Inner\n" in definition.text
    assert "float64 b" not in definition.text
    assert definition.type_hash == ""


def test_prefixes_are_the_environments_then_this_pythons(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", "/first:/second")
    assert ament_prefixes() == (Path("/first"), Path("/second"), Path(sys.prefix))
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    assert ament_prefixes() == (Path(sys.prefix),)
