# SPDX-License-Identifier: Apache-2.0
"""Qualities of service in the forms in which bags have them."""

from __future__ import annotations

import json
import sqlite3
from pathlib import Path

import pytest

from contact_dynamics.recording import BagReader, OfferedQos
from contact_dynamics.recording.bag_metadata import FOREVER_NS, offered_qos, qos_maps

OF_HUMBLE = """
- history: 3
  depth: 0
  reliability: 2
  durability: 1
  deadline: {sec: 0, nsec: 20000000}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
"""


def test_what_is_written_is_read() -> None:
    offers = (
        OfferedQos(reliability="best_effort", depth=3, deadline=1_500_000_000),
        OfferedQos(durability="transient_local", liveliness="manual_by_topic", lifespan=7),
    )
    assert offered_qos(json.dumps(qos_maps(offers))) == list(offers)
    assert offered_qos(json.dumps(qos_maps(()))) == []


def test_numbers_of_rmw_are_read_as_their_names() -> None:
    (offer,) = offered_qos(OF_HUMBLE)
    assert (offer.history, offer.reliability, offer.durability) == (
        "unknown",
        "best_effort",
        "transient_local",
    )
    assert (offer.deadline, offer.lifespan) == (20_000_000, FOREVER_NS)


@pytest.mark.parametrize(
    "text", ["", "~", "[", "3", "a: 1", "[1, x]", "\x00"], ids=["", "~", "[", "3", "map", "list", "zero"]
)
def test_what_is_no_list_of_offers_says_nothing(text: str) -> None:
    assert offered_qos(text) == []


@pytest.mark.parametrize(
    "values", ["{reliability: 99, depth: many}", "{deadline: {sec: 1}, durability: [2]}"]
)
def test_what_cannot_be_read_is_as_for_an_ordinary_publisher(values: str) -> None:
    assert offered_qos(f"[{values}]") == [OfferedQos()]


@pytest.mark.parametrize("has_qos", [True, False], ids=["Foxy and later", "Dashing"])
def test_a_database_tells_them_if_it_has_them(tmp_path: Path, has_qos: bool) -> None:  # noqa: FBT001
    path = tmp_path / "bag_0.db3"
    database = sqlite3.connect(path)
    columns = "id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT"
    database.execute(f"CREATE TABLE topics({columns}{', offered_qos_profiles TEXT' if has_qos else ''})")
    database.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)"
    )
    row = (1, "/pose", "geometry_msgs/msg/Pose", "cdr", *([OF_HUMBLE] if has_qos else []))
    database.execute(f"INSERT INTO topics VALUES({', '.join('?' * len(row))})", row)
    database.commit()
    database.close()
    (topic,) = BagReader(path).topics()
    assert [offer.reliability for offer in offered_qos(topic.qos)] == (["best_effort"] if has_qos else [])
