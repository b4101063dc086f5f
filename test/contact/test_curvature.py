# SPDX-License-Identifier: Apache-2.0
"""Accelerations of contacts of every kind, beside twice differentiated gaps of exactly moved geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from contact_dynamics.contact import ContactSet, Curvatures
from contact_dynamics.contact.velocities import velocity_accelerations
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.plane import PlanarContact
from oracles import moved_gaps as exact

INF = math.inf
UP = np.array([0.0, 0.0, 1.0])
DRAWS = range(4)


@pytest.fixture(autouse=True)
def many_digits() -> Iterator[None]:
    with mp.workdps(exact.DIGITS):
        yield


def unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


class Touching:
    """Sides in contact at a point r from the body's reference point, which is at the origin."""

    def __init__(self, r: Any, normal: Any, body: Any, surface: Any) -> None:
        self.r = np.array(r, dtype=float)
        self.normal = unit(np.array(normal, dtype=float))
        self.contacts = ContactSet(
            p_WC_W=self.r[None],
            normals_W=self.normal[None],
            frictions=0.0,
            restitutions=0.0,
            body_curvatures=self.side(*body),
            surface_curvatures=self.side(*surface),
        )

    @staticmethod
    def side(along: float, over: float, direction: Any = (0.0, 0.0, 0.0)) -> Curvatures:
        return Curvatures(along=[along], across=[over], directions_W=[direction])

    def check(self, gap: exact.Gap, seed: int) -> None:
        """Compare n . (a + alpha x r + w x (w x r)) and what velocities add with the gap's derivative."""
        draw = np.random.default_rng(seed)
        v, w, a, alpha = draw.normal(size=(4, 3))
        v -= self.normal * (self.normal @ (v + np.cross(w, self.r)))  # the contact persists

        def pose_at(t: Any) -> exact.Pose:
            return exact.moved(*(exact.vec(x) for x in (v, a, w, alpha)), t)

        assert abs(gap(pose_at(mpf(0)))) < 1e-15  # the doubles of the contact are its geometry's
        point = v + np.cross(w, self.r)
        added = velocity_accelerations(self.contacts, point[None], w)[0]
        acceleration = a + np.cross(alpha, self.r) + np.cross(w, np.cross(w, self.r))
        # Differences are good to 1e-12 of third derivatives, the contact's doubles to 1e-15 of curvatures.
        found = float(self.normal @ (acceleration + added))
        assert found == pytest.approx(exact.second_derivative(gap, pose_at), rel=1e-9, abs=1e-9)


def ellipsoid_curvature(semiaxes: np.ndarray, foot: np.ndarray) -> tuple[np.ndarray, Any]:
    """Outward normal at a point of an ellipsoid, and its two principal curvatures with a direction."""
    gradient = 2.0 * foot / semiaxes**2
    size = float(np.linalg.norm(gradient))
    normal = gradient / size
    P = np.eye(3) - np.outer(normal, normal)
    values, vectors = np.linalg.eigh(P @ np.diag(2.0 / semiaxes**2) @ P / size)
    tangent = sorted(range(3), key=lambda i: abs(vectors[:, i] @ normal))[:2]
    return normal, (values[tangent[0]], values[tangent[1]], vectors[:, tangent[0]])


@pytest.mark.parametrize("seed", DRAWS)
def test_a_point_on_a_flat(seed: int) -> None:
    r = np.array([0.3, -0.2, -0.7])
    contact = Touching(r, UP, (INF, INF), (0.0, 0.0))
    contact.check(exact.ball_to_plane(exact.vec(r), 0, exact.vec(r), exact.vec(UP)), seed)


@pytest.mark.parametrize("seed", DRAWS)
@pytest.mark.parametrize("other", [2.0, -2.0])
def test_a_ball_on_a_ball_and_in_a_bowl(seed: int, other: float) -> None:
    """A bowl of radius 2 is a ball that is touched from within."""
    center = np.array([0.25, -0.5, 0.125])
    normal = np.array([0.6, 0.0, 0.8])
    contact = Touching(center - 0.5 * normal, normal, (2.0, 2.0), (1.0 / other, 1.0 / other))
    middle = exact.vec(center) - exact.vec(normal) * mpf(0.5 + other) / exact.length(exact.vec(normal))

    def gap(pose: exact.Pose) -> Any:
        distance = exact.length(pose[0] + pose[1] * exact.vec(center) - middle)
        return distance - mpf(2.5) if other > 0.0 else mpf(1.5) - distance

    contact.check(gap, seed)


@pytest.mark.parametrize("seed", DRAWS)
def test_an_ellipsoid_on_a_ball(seed: int) -> None:
    semiaxes = np.array([0.5, 0.8, 1.3])
    outward = unit(np.array([0.5, -0.6, 0.9]))
    foot = semiaxes**2 * outward / np.linalg.norm(semiaxes * outward)
    normal, curvatures = ellipsoid_curvature(semiaxes, foot)
    contact = Touching(foot, -normal, curvatures, (1.0 / 0.7, 1.0 / 0.7))
    center = foot + 0.7 * normal
    radius = exact.outside_ellipsoid(exact.vec(semiaxes), exact.vec(center))
    contact.check(exact.ellipsoid_to_ball(exact.vec(semiaxes), exact.vec(center), radius), seed)


@pytest.mark.parametrize("seed", DRAWS)
def test_a_corner_on_an_ellipsoid(seed: int) -> None:
    """The world's ellipsoid is about the origin; the body's corner is where its reference point is."""
    semiaxes = np.array([0.5, 0.8, 1.3])
    outward = unit(np.array([0.5, -0.6, 0.9]))
    foot = semiaxes**2 * outward / np.linalg.norm(semiaxes * outward)
    normal, curvatures = ellipsoid_curvature(semiaxes, foot)
    arm = np.array([0.1, 0.2, -0.3])
    contact = Touching(arm, normal, (INF, INF), curvatures)

    def level(pose: exact.Pose) -> Any:  # the ellipsoid's own equation: its gradient's size makes it a gap
        x = pose[0] + pose[1] * exact.vec(arm) - exact.vec(arm) + exact.vec(foot)
        value = sum((x[i] / mpf(float(semiaxes[i]))) ** 2 for i in range(3)) - 1
        return value / (2 * mpf(float(np.linalg.norm(foot / semiaxes**2))))

    contact.check(level, seed)


@pytest.mark.parametrize("seed", DRAWS)
def test_a_flat_on_a_point(seed: int) -> None:
    r, inward = np.array([0.4, 0.1, -0.3]), np.array([0.6, 0.0, 0.8])
    contact = Touching(r, inward, (0.0, 0.0), (INF, INF))
    contact.check(exact.flat_to_point(exact.vec(r), exact.vec(inward), exact.vec(r)), seed)


@pytest.mark.parametrize("seed", DRAWS)
def test_an_edge_on_an_edge(seed: int) -> None:
    r, mine, other = np.array([0.4, 0.1, -0.3]), np.array([1.0, 0.5, 0.25]), np.array([0.2, 1.0, 0.7])
    normal = np.cross(mine, other)
    contact = Touching(r, normal, (0.0, INF, unit(mine)), (0.0, INF, unit(other)))
    gap = exact.edge_to_edge(
        exact.vec(r + 0.3 * mine),
        exact.vec(mine),
        exact.vec(r - 2.0 * other),
        exact.vec(other),
        exact.vec(normal),
    )
    contact.check(gap, seed)


@pytest.mark.parametrize("seed", DRAWS)
def test_an_edge_on_a_ball(seed: int) -> None:
    r, mine = np.array([0.4, 0.1, -0.3]), np.array([1.0, 0.5, 0.25])
    normal = unit(np.cross(mine, UP))
    contact = Touching(r, normal, (0.0, INF, unit(mine)), (2.0, 2.0))
    center = exact.vec(r) - exact.vec(normal) * mpf(0.5)
    foot = exact.vec(r) - exact.vec(mine) * mpf(0.7)
    radius = exact.length(exact.cross(exact.vec(mine), center - foot)) / exact.length(exact.vec(mine))
    contact.check(exact.edge_to_ball(foot, exact.vec(mine), center, radius), seed)


@pytest.mark.parametrize("seed", DRAWS)
def test_a_tilted_rim_on_a_flat(seed: int) -> None:
    tilt, radius = 0.7, 0.5
    axis = np.array([0.0, -math.sin(tilt), math.cos(tilt)])
    foot = radius * np.array([0.0, -math.cos(tilt), -math.sin(tilt)])
    contact = Touching(foot, UP, (math.sin(tilt) / radius, INF, (1.0, 0.0, 0.0)), (0.0, 0.0))
    gap = exact.rim_to_plane(exact.vec((0, 0, 0)), exact.vec(axis), mpf(radius), exact.vec(UP))
    level = gap((exact.vec((0, 0, 0)), mp.eye(3)))
    contact.check(lambda pose: gap(pose) - level, seed)


def test_a_contact_at_rest_that_rolls_and_pivots_starts_to_slide_as_the_material_point_does_and_w_x_eta() -> (
    None
):
    """The velocity of whatever point of an ellipsoid is lowest, differentiated."""
    semiaxes = np.array([0.5, 0.8, 1.3])
    normal = unit(np.array([0.5, -0.6, 0.9]))
    foot = -(semiaxes**2) * normal / np.linalg.norm(semiaxes * normal)
    _, curvatures = ellipsoid_curvature(semiaxes, foot)
    contact = Touching(foot, normal, curvatures, (0.0, 0.0))
    w, a, alpha = np.random.default_rng(5).normal(size=(3, 3))
    v = -np.cross(w, foot)

    def sliding(t: Any) -> exact.Vector:
        R = exact.turn(exact.vec(w) * t)
        n_B = R.T * exact.vec(normal)
        scaled = exact.vec([mpf(float(semiaxes[i])) ** 2 * n_B[i] for i in range(3)])
        size = mp.sqrt(sum((mpf(float(semiaxes[i])) * n_B[i]) ** 2 for i in range(3)))
        rate = exact.vec(w) + exact.vec(alpha) * t
        return exact.vec(v) + exact.vec(a) * t + exact.cross(rate, R * (scaled / -size))

    rates = exact.first_derivative(sliding)
    added = velocity_accelerations(contact.contacts, np.zeros((1, 3)), w)[0]
    found = a + np.cross(alpha, foot) + np.cross(w, np.cross(w, foot)) + added
    np.testing.assert_allclose(
        found - (found @ normal) * normal, rates - (rates @ normal) * normal, atol=1e-9
    )
    assert np.linalg.norm(added - (added @ normal) * normal) > 0.1  # of consequence here


@pytest.mark.parametrize(
    ("k_B", "k_S"), [(2.0, 0.0), (2.0, 0.5), (0.0, 4.0), (INF, 0.5), (0.0, INF), (3.0, INF), (3.0, -1.0)]
)
def test_the_plane_is_a_section_of_space(k_B: float, k_S: float) -> None:
    v_t, w = 0.7, -1.3  # the plane is x, z with y away from the eye: turns are about -y
    contact = Touching((0.1, 0.0, -0.5), UP, (k_B, k_B), (k_S, k_S))
    added = velocity_accelerations(contact.contacts, np.array([[v_t, 0.0, 0.0]]), np.array([0.0, -w, 0.0]))
    flat = PlanarContact(
        r=(0.1, -0.5), normal=(0.0, 1.0), friction=0.0, body_curvature=k_B, surface_curvature=k_S
    )
    assert flat.gap_acceleration(v_t, w) == pytest.approx(added[0, 2], rel=1e-14)
    assert added[0, :2] == pytest.approx((0.0, 0.0), abs=1e-15)


def test_without_curvatures_nothing_is_added() -> None:
    plain = ContactSet(p_WC_W=np.zeros((2, 3)), normals_W=UP, frictions=0.0, restitutions=0.0)
    np.testing.assert_array_equal(
        velocity_accelerations(plain, np.ones((2, 3)), np.ones(3)), np.zeros((2, 3))
    )
    assert PlanarContact(r=(1.0, 2.0), normal=(0.0, 1.0), friction=0.0).gap_acceleration(3.0, 4.0) == 0.0


X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


@pytest.mark.parametrize(
    ("body", "surface", "words"),
    [
        ((INF, INF), (INF, INF), "corner"),
        ((0.0, 0.0), (0.0, 0.0), "sum > 0"),
        ((1.0, 0.0, X), (0.0, 0.0), "sum > 0"),  # a line: its two ends are meant
        ((1.0, 1.0), (-2.0, -2.0), "sum > 0"),
        ((0.0, INF, X), (0.0, INF, X), "sum > 0"),  # parallel edges
        ((INF, INF), (0.0, INF, X), "corner"),
        ((1.0, 2.0), (0.0, 0.0), "unit vector at right angles"),
        ((1.0, 2.0, (0.0, 0.6, 0.8)), (0.0, 0.0), "unit vector at right angles"),
        ((math.nan, 1.0, X), (0.0, 0.0), "along"),
        ((1.0, -INF, X), (0.0, 0.0), "across"),
    ],
)
def test_sides_that_do_not_touch_in_one_point_are_refused(body: Any, surface: Any, words: str) -> None:
    with pytest.raises(InvalidFieldError, match=words):
        Touching((0.0, 0.0, 0.0), UP, body, surface)


@pytest.mark.parametrize(
    ("body", "surface"), [(INF, INF), (0.0, 0.0), (-1.0, 0.5), (math.nan, 0.0), (-INF, 0.0)]
)
def test_so_they_are_in_the_plane(body: float, surface: float) -> None:
    with pytest.raises(InvalidFieldError, match="body_curvature"):
        PlanarContact(
            r=(0.0, 0.0), normal=(0.0, 1.0), friction=0.0, body_curvature=body, surface_curvature=surface
        )


def test_curvatures_follow_their_contacts() -> None:
    curvatures = Curvatures(along=[1.0, 2.0], across=[INF, 2.0], directions_W=[X, (0.0, 0.0, 0.0)])
    both = ContactSet(
        p_WC_W=np.zeros((2, 3)), normals_W=UP, frictions=0.0, restitutions=0.0, body_curvatures=curvatures
    )
    one = both.subset([1]).body_curvatures
    assert one is not None
    assert one.along.tolist() == one.across.tolist() == [2.0]
    assert curvatures.in_direction(0, np.array(X)) == 1.0
    assert curvatures.in_direction(0, -np.array(Y)) == INF
    assert curvatures.in_direction(0, unit(np.array([1.0, 1.0, 0.0]))) is None
    assert curvatures.in_direction(1, unit(np.array([1.0, 1.0, 0.0]))) == 2.0
    with pytest.raises(InvalidFieldError, match="body_curvatures"):
        ContactSet(
            p_WC_W=np.zeros((1, 3)),
            normals_W=[UP],
            frictions=0.0,
            restitutions=0.0,
            body_curvatures=curvatures,
        )
