# SPDX-License-Identifier: Apache-2.0
"""Friction cones, force duals and acceleration centres."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.plane.types import (
    OrientedPoint,
    PlanarBody,
    PlanarContact,
    PlanarWrench,
    Turn,
    acceleration_centre,
    force_dual,
    friction_cone,
)

# Smaller forces have a force dual at a distance that no double holds.
numbers = st.floats(-10.0, 10.0).filter(lambda x: x == 0.0 or abs(x) > 1e-100)


def test_the_edges_push_right_and_left() -> None:
    right, left = friction_cone(PlanarContact(r=(2.0, -1.0), normal=(0.0, 1.0), friction=0.5))
    assert right == PlanarWrench(f=(0.5, 1.0), moment=2.5)
    assert left == PlanarWrench(f=(-0.5, 1.0), moment=1.5)


@given(numbers, numbers, st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.sampled_from([-1.0, 1.0]))
def test_a_wrench_accelerates_the_body_about_its_force_dual(
    f_x: float, f_y: float, mass: float, rho: float, moment: float
) -> None:
    body = PlanarBody(mass=mass, inertia=mass * rho * rho)
    dual = force_dual(body, PlanarWrench(f=(f_x, f_y), moment=moment))
    assert dual is not None
    assert dual.turn == moment
    x, y = dual.point
    alpha = moment / body.inertia
    scale = 1e-12 * (abs(f_x) + abs(f_y) + 1.0) / mass
    assert abs(f_x / mass - alpha * y) <= scale
    assert abs(f_y / mass + alpha * x) <= scale
    # Mason 5.8: the dual lies across the centre from the line of force, at rho^2 over its distance.
    distance = abs(moment) / math.hypot(f_x, f_y) if f_x or f_y else math.inf
    assert math.hypot(x, y) * distance == pytest.approx(rho * rho) or (f_x, f_y) == (0.0, 0.0)


def test_pure_forces_and_translations_have_their_point_at_infinity() -> None:
    body = PlanarBody(mass=1.0, inertia=1.0)
    assert force_dual(body, PlanarWrench(f=(0.0, -2.0))) == OrientedPoint((1.0, 0.0), Turn.NEITHER)
    assert acceleration_centre((0.0, 0.0), 0.0) is None
    assert acceleration_centre((0.0, 0.0), -3.0) == OrientedPoint((0.0, 0.0), Turn.CLOCKWISE)


@given(st.tuples(numbers, numbers, numbers), st.floats(0.0, 3.0), st.integers(3, 16))
def test_the_pyramid_is_inside_the_round_cone(
    direction: tuple[float, float, float], friction: float, facets: int
) -> None:
    length = math.hypot(*direction)
    if length < 1e-3:
        return
    normal = np.array(direction) / length
    one, two = tangents_towards(normal)
    np.testing.assert_allclose(np.cross(one, two), normal, atol=1e-12)
    edges = linearised_cone(normal, friction, facets)
    assert edges.shape == (facets, 3)
    np.testing.assert_allclose(edges @ normal, 1.0, atol=1e-12)
    across = edges - normal
    np.testing.assert_allclose(np.linalg.norm(across, axis=1), friction, atol=1e-12)
    # Evenly spread: neighbours are all the same angle apart, and the first differs from the last.
    turns = np.sum(across * np.roll(across, 1, axis=0), axis=1)
    np.testing.assert_allclose(turns, friction**2 * math.cos(2.0 * math.pi / facets), atol=1e-12)
