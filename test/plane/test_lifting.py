# SPDX-License-Identifier: Apache-2.0
"""Whether a planar answer holds in space: mirror images of contacts, and shares of forces."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet
from contact_dynamics.errors import OutOfPlaneError
from contact_dynamics.plane import PlaneOfMotion
from contact_dynamics.plane.lifting import check_mirrored, equal_shares, mirror_partners

PLANE = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])
CENTRE = np.array([0.3, 0.2, 0.1])
STATE = BodyState(p_WB_W=CENTRE, q_WB=[0.0, 0.0, 0.0, 1.0])


def contacts(arms: list[tuple[float, ...]], frictions: list[float] | None = None) -> ContactSet:
    n = len(arms)
    return ContactSet(
        p_WC_W=CENTRE + np.array(arms, dtype=float).reshape(-1, 3),
        normals_W=np.tile([0.0, 0.0, 1.0], (n, 1)),
        frictions=np.array(frictions or [0.5] * n),
        restitutions=np.zeros(n),
    )


def partners(found: ContactSet, tolerance: float = 1e-6) -> tuple[int, ...]:
    return mirror_partners(PLANE, STATE, found, distance_tolerance=tolerance)


def test_each_foot_has_its_mirror_image() -> None:
    feet = [(1.0, 0.5, -1.0), (1.0, -0.5, -1.0), (0.2, 0.0, -1.0), (-1.0, -0.5, -1.0), (-1.0, 0.5, -1.0)]
    assert partners(contacts(feet)) == (1, 0, 2, 4, 3)
    assert partners(contacts([])) == ()


def test_coincident_contacts_are_paired_one_by_one() -> None:
    twice = [(1.0, 0.5, -1.0)] * 2 + [(1.0, -0.5, -1.0)] * 2
    found = partners(contacts(twice))
    assert sorted(found) == [0, 1, 2, 3]
    assert all(found[found[i]] == i for i in range(4))
    assert {found[0], found[1]} == {2, 3}


@pytest.mark.parametrize(
    ("arms", "frictions"),
    [
        ([(1.0, 0.5, -1.0)], None),
        ([(1.0, 0.5, -1.0), (1.0, -0.4, -1.0)], None),
        ([(1.0, 0.5, -1.0), (1.0, 0.5, -1.0)], None),
        ([(1.0, 0.5, -1.0), (1.0, -0.5, -1.0)], [0.5, 0.4]),
    ],
    ids=["alone", "not opposite", "on one side", "of another friction"],
)
def test_what_has_none_is_refused_with_its_distance(
    arms: list[tuple[float, ...]], frictions: list[float] | None
) -> None:
    found = contacts(arms, frictions)
    assert partners(found)[0] == -1
    with pytest.raises(OutOfPlaneError, match=r"contacts.p_WC_W\[0\] must be .*, got 0.5 m beside the plane"):
        check_mirrored(PLANE, STATE, found, partners(found))


def test_noise_of_half_a_degree_does_not_part_a_pair() -> None:
    tilt = 0.4 * math.radians(1.0)
    feet = [(1.0, 0.5, -1.0 + 0.5 * tilt), (1.0, -0.5, -1.0 - 0.5 * tilt)]
    assert partners(contacts(feet)) == (1, 0)
    far = [(1.0, 0.5, -0.9), (1.0, -0.5, -1.1)]
    assert partners(contacts(far)) == (-1, -1)
    assert partners(contacts(far), tolerance=0.2) == (1, 0)


def test_pairs_share_equally_and_others_keep_theirs() -> None:
    forces = np.array([[0.0, 0.0, 4.0], [1.0, 0.0, 0.0], [0.0, 0.0, 7.0], [0.0, 0.0, 9.0]])
    shared = equal_shares(forces, (1, 0, 2, -1))
    np.testing.assert_array_equal(shared[:2], [[0.5, 0.0, 2.0]] * 2)
    np.testing.assert_array_equal(shared[2:], forces[2:])
