# SPDX-License-Identifier: Apache-2.0
"""Contacts that geometry finds for round bodies, and the shapes themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.contact.found import find_contacts, nearest_surface
from contact_dynamics.contact.touches import RIM_POINTS
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.shapes import ConvexShape, Obstacle, Rim
from contact_dynamics.shapes.convex import (
    MAX_RIMS,
    box,
    capsule,
    cone,
    cylinder,
    polygon,
    polyhedron,
    rounded,
    sphere,
)
from contact_dynamics.world import Body, Surface, World, box_vertices

STUFF = MassProperties(mass=1.0, I_B=np.eye(3))
FLOOR = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=[0.0, 0.0, 1.0], friction=0.5, restitution=0.0)
WALL = Surface(name="wall", p_WS_W=[1.0, 0.0, 0.0], normal_W=[-1.0, 0.0, 0.0], friction=0.2, restitution=0.0)
ON_SIDE = Rotation.from_euler("x", 90.0, degrees=True)


def body(shape: ConvexShape) -> Body:
    return Body(name="it", mass_properties=STUFF, shape=shape)


def at(p: tuple[float, float, float], turn: Rotation | None = None) -> BodyState:
    q = np.array([0.0, 0.0, 0.0, 1.0]) if turn is None else turn.as_quat()
    return BodyState(p_WB_W=np.array(p), q_WB=q)


def test_a_ball_in_a_corner_touches_floor_and_wall_in_one_point_each() -> None:
    found = find_contacts(body(sphere(radius=0.3)), at((0.7, 2.0, 0.3)), World(surfaces=(FLOOR, WALL)))
    np.testing.assert_allclose(found.p_WC_W, [[0.7, 2.0, 0.0], [1.0, 2.0, 0.3]], atol=1e-15)
    assert found.surfaces == ("floor", "wall")
    assert found.frictions.tolist() == [0.5, 0.2]
    assert found.body_curvatures is not None
    assert found.body_curvatures.along.tolist() == found.body_curvatures.across.tolist() == [1.0 / 0.3] * 2


def test_a_cylinder_on_its_side_touches_with_the_two_ends_of_its_line() -> None:
    found = find_contacts(
        body(cylinder(radius=0.1, length=0.5)), at((0.0, 0.0, 0.1), ON_SIDE), World(surfaces=(FLOOR,))
    )
    ends = found.p_WC_W[np.argsort(found.p_WC_W[:, 1])]
    np.testing.assert_allclose(ends, [[0.0, -0.25, 0.0], [0.0, 0.25, 0.0]], atol=1e-15)
    curvatures = found.body_curvatures
    assert curvatures is not None
    np.testing.assert_allclose(curvatures.along, 10.0)
    assert np.isinf(curvatures.across).all()
    np.testing.assert_allclose(np.abs(curvatures.directions_W), [[1.0, 0.0, 0.0]] * 2, atol=1e-15)


def test_a_cylinder_on_its_base_touches_in_the_stated_points_of_its_rim() -> None:
    found = find_contacts(
        body(cylinder(radius=0.1, length=0.5)), at((1.0, 0.0, 0.25)), World(surfaces=(FLOOR,))
    )
    assert len(found) == RIM_POINTS
    np.testing.assert_allclose(np.hypot(found.p_WC_W[:, 0] - 1.0, found.p_WC_W[:, 1]), 0.1, rtol=1e-14)
    np.testing.assert_allclose(found.p_WC_W[0], [1.1, 0.0, 0.0], atol=1e-15)  # towards the body's x
    # what tips it over: the least distance of the polygon's sides from the centre
    sides = 0.5 * (found.p_WC_W + np.roll(found.p_WC_W, -1, axis=0))
    assert np.hypot(sides[:, 0] - 1.0, sides[:, 1]).min() == pytest.approx(0.1 * math.cos(math.pi / 8))


@settings(max_examples=20)
@given(tilt=st.floats(0.05, 1.5), turn=st.floats(0.0, 6.0))
def test_a_tilted_disc_touches_in_its_lowest_point_with_the_curvature_of_its_shadow(
    tilt: float, turn: float
) -> None:
    rotation = Rotation.from_euler("zx", [turn, tilt])
    radius = 0.2
    found = find_contacts(
        body(cylinder(radius=radius, length=0.0)),
        at((0.0, 0.0, radius * math.sin(tilt)), rotation),
        World(surfaces=(FLOOR,)),
    )
    assert len(found) == 1
    assert found.p_WC_W[0, 2] == pytest.approx(0.0, abs=1e-15)
    assert math.dist(found.p_WC_W[0], (0.0, 0.0, radius * math.sin(tilt))) == pytest.approx(radius)
    curvatures = found.body_curvatures
    assert curvatures is not None
    # By differences: heights of the rim's points beside the lowest one, over the squared distance to it.
    angles = np.linspace(0.0, 2.0 * math.pi, 20_001)
    ring = rotation.apply(radius * np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles]))
    ring[:, 2] += radius * math.sin(tilt)
    near = np.linalg.norm(ring - found.p_WC_W[0], axis=1)
    near_enough = (near > 2e-3 * radius) & (near < 8e-3 * radius)
    fitted = 2.0 * ring[near_enough, 2] / near[near_enough] ** 2
    assert curvatures.along[0] == pytest.approx(fitted.mean(), rel=1e-4)


def test_a_capsule_a_cone_and_a_rounded_box() -> None:
    lying = find_contacts(
        body(capsule(radius=0.1, length=0.4)), at((0.0, 0.0, 0.1), ON_SIDE), World(surfaces=(FLOOR,))
    )
    assert len(lying) == 2
    assert np.ptp(lying.p_WC_W[:, 1]) == pytest.approx(0.4)
    # a cone on its side: its base rim and its tip, tilted by its half angle
    half = math.atan2(0.3, 0.4)
    on_side = Rotation.from_euler("y", math.pi / 2.0 + half)
    height = -min(on_side.apply([[0.3, 0.0, 0.0], [-0.3, 0.0, 0.0], [0.0, 0.0, 0.4]])[:, 2])
    found = find_contacts(
        body(cone(radius=0.3, height=0.4)), at((0.0, 0.0, height), on_side), World(surfaces=(FLOOR,))
    )
    assert len(found) == 2
    assert math.dist(*found.p_WC_W) == pytest.approx(0.5)
    pillow = rounded(box(size=(0.4, 0.2, 0.1)), radius=0.02)
    found = find_contacts(body(pillow), at((0.0, 0.0, 0.07)), World(surfaces=(FLOOR,)))
    assert len(found) == 4
    np.testing.assert_allclose(np.abs(found.p_WC_W), [[0.2, 0.1, 0.0]] * 4, atol=1e-15)


@given(gap=st.floats(-0.05, 0.05), tolerance=st.floats(0.0, 0.04))
def test_the_tolerance_decides_what_touches(gap: float, tolerance: float) -> None:
    shapes = (sphere(radius=0.25), cylinder(radius=0.5, length=0.5), box(size=(1.0, 1.0, 0.5)))
    for shape in shapes:
        height = 0.25
        state = at((0.0, 0.0, height + gap))
        if height - (height + gap) > max(tolerance, 1e-6):
            with pytest.raises(
                InvalidFieldError, match=r"must be at most .*\(distance_tolerance\), got .*m deep in 'floor'"
            ):
                find_contacts(body(shape), state, World(surfaces=(FLOOR,)), distance_tolerance=tolerance)
            continue
        found = find_contacts(body(shape), state, World(surfaces=(FLOOR,)), distance_tolerance=tolerance)
        touches = (height + gap) - height <= tolerance
        assert (len(found) > 0) == touches


@pytest.mark.parametrize(
    ("shape", "turn", "reach"),
    [
        (sphere(radius=0.2), None, 0.2),
        (box(size=[0.2, 0.4, 0.6]), None, 0.3),
        (cylinder(radius=0.1, length=0.4), ON_SIDE, 0.1),
        (rounded(box(size=[0.2, 0.2, 0.2]), radius=0.05), None, 0.15),
    ],
)
@pytest.mark.parametrize("gap", [0.01, -0.01])
def test_the_nearest_surface_and_its_gap(
    shape: ConvexShape, turn: Rotation | None, reach: float, gap: float
) -> None:
    table = Obstacle(
        name="table",
        vertices_W=box_vertices([2.0, 2.0, 0.5]) + np.array([0.0, 0.0, 0.25]),
        friction=0.5,
        restitution=0.0,
    )
    nearest = nearest_surface(body(shape), at((0.0, 0.0, 0.5 + reach + gap), turn), [FLOOR, WALL, table])
    assert nearest is not None
    assert nearest[0] is table
    assert nearest[1] == pytest.approx(gap, abs=1e-15)
    above_floor = nearest_surface(body(shape), at((0.0, 0.0, reach + gap), turn), [WALL, FLOOR])
    assert above_floor is not None
    assert (above_floor[0], above_floor[1]) == (FLOOR, pytest.approx(gap, abs=1e-15))


def test_a_shape_moves_with_its_parts() -> None:
    turn = Rotation.from_euler("xyz", [0.3, 0.4, 0.5])
    offset = np.array([0.1, -0.2, 0.3])
    moved = cone(radius=0.3, height=0.4).moved(offset, turn.as_quat())
    np.testing.assert_allclose(moved.vertices, [turn.apply([0.0, 0.0, 0.4]) + offset], atol=1e-15)
    assert moved.rims[0].center == pytest.approx(tuple(offset))
    assert moved.rims[0].axis == pytest.approx(tuple(turn.apply([0.0, 0.0, 1.0])))
    assert moved.rims[0].radius == 0.3


def test_polygons_and_polyhedra() -> None:
    triangle = polygon([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    assert triangle.vertices.shape == (3, 3)
    assert triangle.is_polyhedron
    assert not sphere(radius=1.0).is_polyhedron
    assert ConvexShape().is_empty
    assert not polyhedron(np.eye(3)).is_empty
    assert len(cylinder(radius=1.0, length=0.0).rims) == 1


def test_a_body_has_corners_or_a_shape() -> None:
    corners = np.eye(3)
    short = Body(name="it", mass_properties=STUFF, vertices_B=corners)
    np.testing.assert_array_equal(short.shape.vertices, corners)
    np.testing.assert_array_equal(body(polyhedron(corners)).vertices_B, corners)
    with pytest.raises(InvalidFieldError, match="vertices"):
        Body(name="it", mass_properties=STUFF, vertices_B=corners, shape=sphere(radius=1.0))


def test_too_many_rims() -> None:
    rim = Rim((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.0)
    with pytest.raises(TooLargeError, match="rims"):
        ConvexShape(rims=(rim,) * (MAX_RIMS + 1))
