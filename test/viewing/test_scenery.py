# SPDX-License-Identifier: Apache-2.0
"""Surfaces and bodies, where they stand, and from when on they have another form."""

from __future__ import annotations

import numpy as np
import pytest
import rerun as rr
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics import Body, BodyState, Obstacle, Surface, World
from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.diagrams.world_scene import MAX_GRID_LINES, body_marks, surface_marks
from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.viewing.drawing import parts_of
from contact_dynamics.viewing.entities import BODIES, SURFACES, entity
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.scenery import Scenery, draw_axes
from contact_dynamics.world import box_vertices
from viewing.drawn import STAMP_NS, Canvas
from viewing.known import BODY, FLOOR

TILTED = Surface(name="ramp", p_WS_W=[0.0, 0.0, 0.5], normal_W=[0.6, 0.0, 0.8], friction=0.3, restitution=0.5)


@pytest.mark.parametrize("side", [0.05, 2.0, 25.0, 3000.0])
def test_a_surface_is_a_square_in_its_plane_below_the_centre(canvas: Canvas, side: float) -> None:
    center = np.array([2.0, 3.0, 4.0])
    parts = parts_of(surface_marks(TILTED, center_W=center, side=side))
    Scenery(canvas.stream).draw(entity(SURFACES, TILTED.name), parts)
    drawn = canvas.read()
    corners = drawn.array("/world/surfaces/ramp/patch", "Mesh3D:vertex_positions")
    tolerance = 1e-6 * (side + 5.0)  # float32
    np.testing.assert_allclose(TILTED.gaps(corners), np.zeros(4), atol=tolerance)
    lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1)
    np.testing.assert_allclose(lengths, np.full(4, side), rtol=1e-5)
    foot = corners.mean(axis=0)
    np.testing.assert_allclose(np.cross(center - foot, TILTED.normal_W), np.zeros(3), atol=10 * tolerance)
    grid = drawn.array("/world/surfaces/ramp/grid", "LineStrips3D:strips")
    assert 2 <= len(grid) <= 2 * (MAX_GRID_LINES + 2)
    np.testing.assert_allclose(TILTED.gaps(grid), np.zeros(grid.shape[:2]), atol=tolerance)
    distances = np.abs((grid - foot) @ np.array(tangents_near_x(TILTED.normal_W)).T).max()
    assert distances <= 0.5 * side * (1.0 + 1e-5) + tolerance


def test_arrows_show_how_a_turntable_moves_above_the_floor_alone(canvas: Canvas) -> None:
    floor = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=[0.0, 0.0, 1.0], friction=0.3, restitution=0.5)
    disc = Surface(
        name="disc",
        p_WS_W=np.zeros(3),
        normal_W=[1.0, 0.0, 0.0],
        friction=0.3,
        restitution=0.5,
        w_WS_W=[2.0, 0.0, 0.0],
    )
    for surface in (floor, disc):
        parts = parts_of(surface_marks(surface, center_W=np.zeros(3), side=1.0, among=(floor, disc)))
        assert ("motion" in parts) is surface.moves
        Scenery(canvas.stream).draw(entity(SURFACES, surface.name), parts)
    drawn = canvas.read()
    places = drawn.array("/world/surfaces/disc/motion", "Arrows3D:origins")
    vectors = drawn.array("/world/surfaces/disc/motion", "Arrows3D:vectors")
    assert places[:, 2].min() >= 0.0
    velocities = np.cross([2.0, 0.0, 0.0], places)
    longest = np.linalg.norm(velocities, axis=1).max()
    np.testing.assert_allclose(vectors, 0.1 * velocities / longest, atol=1e-7)


def test_a_wall_rises_from_the_floor_and_the_floor_ends_at_the_wall(canvas: Canvas) -> None:
    floor = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=[0.0, 0.0, 1.0], friction=0.3, restitution=0.5)
    wall = Surface(name="wall", p_WS_W=[0.15, 0, 0], normal_W=[-1.0, 0.0, 0.0], friction=0.3, restitution=0.5)
    for surface in (floor, wall):
        parts = parts_of(surface_marks(surface, center_W=np.zeros(3), side=1.0, among=(floor, wall)))
        Scenery(canvas.stream).draw(entity(SURFACES, surface.name), parts)
    drawn = canvas.read()
    tolerance = 1e-6  # m, float32
    for name in ("floor", "wall"):
        for part in (
            drawn.array(f"/world/surfaces/{name}/patch", "Mesh3D:vertex_positions"),
            drawn.array(f"/world/surfaces/{name}/grid", "LineStrips3D:strips"),
        ):
            assert floor.gaps(part).min() >= -tolerance
            assert wall.gaps(part).min() >= -tolerance
            assert part[..., 1].min() < -0.49


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3))
def test_tangents_and_normal_are_a_right_handed_frame(direction: tuple[float, float, float]) -> None:
    normal = np.array(direction) / np.linalg.norm(direction)
    frame = np.array([*tangents_near_x(normal), normal])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) > 0.0


def test_a_body_is_drawn_in_its_own_axes(canvas: Canvas) -> None:
    Scenery(canvas.stream).draw(entity(BODIES, "brick"), parts_of(body_marks(convex_shape(BODY.vertices_B))))
    drawn = canvas.read()
    faces = drawn.array("/world/bodies/brick/faces", "Mesh3D:vertex_positions")
    np.testing.assert_allclose(np.unique(np.abs(faces), axis=0), [[0.075, 0.045, 0.025]], rtol=1e-6)
    assert len(drawn.last("/world/bodies/brick/edges", "LineStrips3D:strips")) == 12


def test_an_obstacle_is_drawn_where_it_stands(canvas: Canvas) -> None:
    corners = box_vertices((0.4, 0.2, 0.1)) + np.array([1.0, 2.0, 0.05])
    step = Obstacle(name="step", vertices_W=corners, friction=0.3, restitution=0.0)
    Picture(canvas.stream, World(bodies=(BODY,), surfaces=(FLOOR, step)), surface_side=1.0)
    drawn = canvas.read()
    faces = drawn.array("/world/surfaces/step/patch", "Mesh3D:vertex_positions")
    np.testing.assert_allclose(faces.min(axis=0), [0.8, 1.9, 0.0], atol=1e-6)
    np.testing.assert_allclose(faces.max(axis=0), [1.2, 2.1, 0.1], atol=1e-6)
    assert "/world/surfaces/floor/grid" in drawn.entities


def test_a_body_without_shape_is_a_ball(canvas: Canvas) -> None:
    Scenery(canvas.stream).draw(entity(BODIES, ""), parts_of(body_marks(convex_shape(np.zeros((0, 3))))))
    assert canvas.read().last("/world/bodies/unnamed/faces", "Points3D:radii")[0] > 0.0


@pytest.mark.parametrize("up", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (-0.99, 0.0, 0.1)])
def test_up_is_told_to_the_viewer(canvas: Canvas, up: tuple[float, float, float]) -> None:
    draw_axes(canvas.stream, np.array(up))
    (axes,) = canvas.read().last("/world", "ViewCoordinates:xyz")
    names = rr.components.ViewCoordinates.ViewDir
    vertical = np.array([{names.Up: 1.0, names.Down: -1.0}.get(names(axis), 0.0) for axis in axes])
    assert vertical @ np.array(up) > 0.9


LATER_NS = STAMP_NS + 1_000_000_000
PATCH = "/world/surfaces/floor/patch"
FACES = "/world/bodies/brick/faces"


def raised(floor: Surface, height: float) -> Surface:
    return Surface(
        name=floor.name, p_WS_W=[0.0, 0.0, height], normal_W=floor.normal_W, friction=0.3, restitution=0.0
    )


def state(stamp_ns: int) -> BodyState:
    return BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], stamp_ns=stamp_ns)


def test_each_form_is_drawn_from_when_it_came(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, World(bodies=(BODY,), surfaces=(FLOOR,)), surface_side=1.0)
    picture.add_states("brick", [state(STAMP_NS)])
    larger = Body(
        name="brick",
        mass_properties=BODY.mass_properties,
        shape=type(BODY.shape)(vertices=box_vertices((0.3, 0.2, 0.1))),
    )
    for height, stamp_ns in ((0.25, LATER_NS), (0.5, LATER_NS + 5)):
        world = World(bodies=(larger,), surfaces=(raised(FLOOR, height),))
        picture.change_world(world, stamp_ns=stamp_ns)
    picture.change_world(World(bodies=(larger,)), stamp_ns=LATER_NS + 7)
    drawn = canvas.read()
    for path in (PATCH, FACES):  # what was drawn for all times is emptied, since rerun would always show it
        assert [] in [value for _, value in drawn.values[path, "Mesh3D:vertex_positions"]]
    heights = [drawn.array(f"{PATCH}/{form}", "Mesh3D:vertex_positions")[0, 2] for form in (1, 2, 3)]
    np.testing.assert_allclose(heights, [0.0, 0.25, 0.5], atol=1e-7)
    assert drawn.stamps(f"{PATCH}/1", "Mesh3D:vertex_positions") == [STAMP_NS]
    assert drawn.stamps(f"{PATCH}/2", "Mesh3D:vertex_positions") == [LATER_NS]
    assert drawn.stamps(f"{PATCH}/1", "Clear:is_recursive") == [LATER_NS]
    assert drawn.stamps(f"{PATCH}/3", "Clear:is_recursive") == [LATER_NS + 7]
    np.testing.assert_allclose(
        drawn.array(f"{FACES}/1", "Mesh3D:vertex_positions").max(axis=0), [0.075, 0.045, 0.025]
    )
    np.testing.assert_allclose(
        drawn.array(f"{FACES}/2", "Mesh3D:vertex_positions").max(axis=0), [0.15, 0.1, 0.05]
    )
    assert drawn.stamps(f"{FACES}/2", "Mesh3D:vertex_positions") == [LATER_NS]


def test_a_change_before_the_first_state_is_drawn_for_all_times(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, World(bodies=(BODY,), surfaces=(FLOOR,)), surface_side=1.0)
    picture.change_world(World(bodies=(BODY,), surfaces=(raised(FLOOR, 0.25),)), stamp_ns=LATER_NS)
    drawn = canvas.read()
    heights = [value[0][2] for _, value in drawn.values[PATCH, "Mesh3D:vertex_positions"]]
    assert 0.25 in heights
    assert f"{PATCH}/1" not in drawn.entities
