# SPDX-License-Identifier: Apache-2.0
"""Contact sets through their message: kinds, curvatures, and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.curvature import Curvatures, alike
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg
from msg_adapters.contacts import contacts_from_msg, contacts_to_msg

INF = math.inf


def contacts(n: int = 3, **sides: Curvatures) -> ContactSet:
    return ContactSet(
        p_WC_W=np.arange(3.0 * n).reshape(n, 3),
        normals_W=[0.0, 0.0, 1.0],
        frictions=np.linspace(0.0, 1.0, n),
        restitutions=np.linspace(0.0, 1.0, n),
        surfaces=tuple("abcdef"[:n]),
        **sides,
    )


def same(one: Curvatures | None, other: Curvatures | None) -> None:
    assert one is not None
    assert other is not None
    np.testing.assert_array_equal(one.along, other.along)
    np.testing.assert_array_equal(one.across, other.across)
    np.testing.assert_array_equal(one.directions_W, other.directions_W)


def test_more_contacts_than_the_interface_allows_are_counted() -> None:
    """ROS does not send them, but it receives them from who does."""
    data = bytearray(serialize_message(ContactSetMsg(frictions=[0.5] * 10_000)))
    at = data.index((10_000).to_bytes(4, "little"))
    data[at : at + 4] = (10_001).to_bytes(4, "little")
    msg = deserialize_message(bytes(data[: at + 8]) + bytes(8) + bytes(data[at + 8 :]), ContactSetMsg)
    with pytest.raises(TooLargeError, match=r"contacts must be at most 10000.*, got 10001 contacts"):
        contacts_from_msg(msg)


def test_points_on_flats_travel_without_kinds() -> None:
    msg = contacts_to_msg(contacts())
    assert len(msg.kinds) == len(msg.body_curvatures) == len(msg.surface_curvatures) == 0
    back = contacts_from_msg(msg)
    np.testing.assert_array_equal(back.p_WC_W, contacts().p_WC_W)
    assert back.surfaces == ("a", "b", "c")
    assert back.body_curvatures is None
    assert back.surface_curvatures is None
    msg.kinds = [ContactSetMsg.POINT_ON_FLAT] * 3
    assert contacts_from_msg(msg).body_curvatures is None


def test_every_kind_comes_back_as_it_went() -> None:
    body = Curvatures(
        along=np.array([INF, 0.0, 2.0, 0.0]),
        across=np.array([INF, 0.0, INF, INF]),
        directions_W=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.6, 0.8, 0.0]]),
    )
    surface = Curvatures(
        along=np.array([0.0, INF, 0.0, 0.0]),
        across=np.array([0.0, INF, 0.0, INF]),
        directions_W=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.8, 0.6, 0.0]]),
    )
    there = contacts(4, body_curvatures=body, surface_curvatures=surface)
    msg = contacts_to_msg(there)
    assert list(msg.kinds) == [
        ContactSetMsg.POINT_ON_FLAT,
        ContactSetMsg.FLAT_ON_POINT,
        ContactSetMsg.CURVED,
        ContactSetMsg.CURVED,
    ]
    back = contacts_from_msg(msg)
    same(back.body_curvatures, there.body_curvatures)
    same(back.surface_curvatures, there.surface_curvatures)


def test_kinds_alone_and_one_curvature_in_all_directions() -> None:
    msg = contacts_to_msg(contacts(2))
    msg.kinds = [ContactSetMsg.FLAT_ON_POINT] * 2
    back = contacts_from_msg(msg)
    same(back.body_curvatures, alike(2, 0.0))
    same(back.surface_curvatures, alike(2, INF))
    msg.kinds = [ContactSetMsg.CURVED] * 2
    msg.body_curvatures, msg.surface_curvatures = [4.0, 5.0], [0.0, 1.0]
    back = contacts_from_msg(msg)
    assert back.body_curvatures is not None
    assert back.body_curvatures.along.tolist() == back.body_curvatures.across.tolist() == [4.0, 5.0]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"kinds": [0, 1]}, r"contacts\.kinds must be .*, got 2 kinds"),
        ({"static_frictions": [9.0] * 2}, r"contacts\.static_frictions must be of shape \(3,\)"),
        ({"static_frictions": [9.0, 0.0, 9.0]}, r"contacts\.static_frictions\[1\] must be at least "),
        ({"kinds": [0, 1, 3]}, r"contacts\.kinds\[2\]"),
        ({"kinds": [2, 0, 0]}, r"contacts\.body_curvatures must be .*, got 0 numbers"),
        ({"kinds": [2, 0, 0], "body_curvatures": [1.0, 0.0, 0.0]}, r"contacts\.surface_curvatures"),
        ({"body_curvatures": [1.0, 0.0, 0.0]}, r"contacts\.kinds must be .*, got none, with curvatures"),
        (
            {
                "kinds": [2] * 3,
                "body_curvatures": [1.0] * 3,
                "surface_curvatures": [0.0] * 3,
                "body_curvatures_across": [1.0] * 3,
            },
            r"contacts\.body_curvatures_across",
        ),
        (
            {"kinds": [2] * 3, "body_curvatures": [-1.0] * 3, "surface_curvatures": [0.0] * 3},
            r"contacts\.body_curvatures, contacts\.surface_curvatures: contact 0",
        ),
    ],
)
def test_what_is_incomplete_or_impossible_is_refused_by_name(changes: dict[str, Any], words: str) -> None:
    msg = contacts_to_msg(contacts())
    for field, value in changes.items():
        setattr(msg, field, value)
    with pytest.raises(InvalidFieldError, match=words):
        contacts_from_msg(msg)


def test_static_frictions_come_back_as_they_went() -> None:
    assert not contacts_to_msg(contacts()).static_frictions
    static = contacts().frictions + np.array([0.0, 0.1, 0.2])
    back = contacts_from_msg(contacts_to_msg(replace(contacts(), static_frictions=static)))
    np.testing.assert_array_equal(back.static_frictions, static)


MOTION = ("surface_velocities", "surface_angular_velocities", "surface_accelerations")


def test_moving_surfaces_come_back_as_they_went() -> None:
    assert not any(getattr(contacts_to_msg(contacts()), field) for field in MOTION)
    values = np.arange(27.0).reshape(3, 3, 3)
    there = replace(contacts(), **{f"{field}_W": values[i] for i, field in enumerate(MOTION)})
    back = contacts_from_msg(contacts_to_msg(there))
    for i, field in enumerate(MOTION):
        np.testing.assert_array_equal(getattr(back, f"{field}_W"), values[i])
    one = contacts_from_msg(contacts_to_msg(replace(contacts(), surface_velocities_W=[0.1, 0.0, 0.0])))
    assert one.surface_accelerations_W is None


@pytest.mark.parametrize("field", MOTION)
def test_motion_that_is_incomplete_or_no_number_is_refused_by_name(field: str) -> None:
    msg = contacts_to_msg(contacts())
    for numbers, words in (
        ([0.1] * 8, r"must be 9, three for each of 3 frictions, got 8"),
        ([math.nan] * 9, "nan"),
    ):
        setattr(msg, field, numbers)
        with pytest.raises(InvalidFieldError, match=rf"contacts\.{field} .*{words}"):
            contacts_from_msg(msg)
