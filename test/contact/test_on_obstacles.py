# SPDX-License-Identifier: Apache-2.0
"""Obstacles with edges and corners: what touches them, by hand and by optimisation, and when."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.contact import ContactSet, Curvatures
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.contact.touches import site_of
from contact_dynamics.errors import InvalidFieldError, NoContactError, NotSupportedError
from contact_dynamics.landing.earliest import first_touch, next_landing
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.shapes import ConvexShape, Obstacle
from contact_dynamics.shapes.convex import box, box_vertices, capsule, cylinder, polyhedron, rounded, sphere
from contact_dynamics.shapes.obstacle import closest_points
from contact_dynamics.tumbling import free_motion
from contact_dynamics.world import Body, Surface, World
from oracles.hull_distance import distance, overlap_support

INF = math.inf
STUFF = MassProperties(mass=1.0, I_B=np.diag([0.02, 0.03, 0.04]))
BRICK = box(size=(0.4, 0.2, 0.1))
DOWN = np.array([0.0, 0.0, -10.0])


def obstacle(vertices: object) -> Obstacle:
    return Obstacle(name="it", vertices_W=np.array(vertices, dtype=float), friction=0.5, restitution=0.25)


TABLE = obstacle([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
SPIKE = obstacle([[0.0, 0.0, 0.0], [0.5, 0.0, -1.0], [-0.3, 0.4, -1.0], [-0.3, -0.4, -1.0]])
ROOF = np.array([[x, y, z] for x, z in ((0.0, 0.0), (0.5, -1.0), (-0.5, -1.0)) for y in (-1.0, 1.0)])
RIDGE = obstacle(ROOF)


def body(shape: ConvexShape) -> Body:
    return Body(name="body", mass_properties=STUFF, shape=shape)


def at(
    p: tuple[float, float, float],
    turn: Rotation | None = None,
    v: tuple[float, float, float] = (0.0, 0.0, 0.0),
    w: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> BodyState:
    q = np.array([0.0, 0.0, 0.0, 1.0]) if turn is None else turn.as_quat()
    return BodyState(p_WB_W=np.array(p), q_WB=q, v_WB_W=np.array(v), w_WB_W=np.array(w))


def corners_of(turn: Rotation, p: object = (0.0, 0.0, 0.0)) -> np.ndarray:
    return BRICK.vertices @ turn.as_matrix().T + np.array(p)


def sides(curvatures: Curvatures | None) -> list[tuple[float, float]]:
    assert curvatures is not None
    return list(zip(curvatures.along.tolist(), curvatures.across.tolist(), strict=True))


def kinds(found: ContactSet) -> list[str]:
    names = {
        ((INF, INF), (0.0, 0.0)): "corner on face",
        ((0.0, 0.0), (INF, INF)): "face on corner",
        ((0.0, INF), (0.0, INF)): "edge on edge",
    }
    pairs = zip(sides(found.body_curvatures), sides(found.surface_curvatures), strict=True)
    return [names[pair] for pair in pairs]


def test_a_brick_that_reaches_over_the_edge_of_a_table() -> None:
    """Half of it: two of its corners, and two places where its sides cross the edge."""
    found = find_contacts(body(BRICK), at((1.0, 0.0, 0.05)), World(surfaces=(TABLE,)))
    assert sorted(kinds(found)) == ["corner on face"] * 2 + ["edge on edge"] * 2
    points = {tuple(point) for point in np.round(found.p_WC_W, 12).tolist()}
    assert points == {(0.8, -0.1, 0.0), (0.8, 0.1, 0.0), (1.0, -0.1, 0.0), (1.0, 0.1, 0.0)}
    np.testing.assert_allclose(found.normals_W, [[0.0, 0.0, 1.0]] * 4, atol=1e-15)
    assert found.surfaces == ("it",) * 4
    assert found.frictions.tolist() == [0.5] * 4
    assert found.restitutions.tolist() == [0.25] * 4


def test_over_the_corner_of_a_table() -> None:
    found = find_contacts(body(BRICK), at((1.0, 1.0, 0.05)), World(surfaces=(TABLE,)))
    assert sorted(kinds(found)) == ["corner on face", "edge on edge", "edge on edge", "face on corner"]


def test_beside_the_table_nothing_touches() -> None:
    assert len(find_contacts(body(BRICK), at((1.3, 0.0, 0.05)), World(surfaces=(TABLE,)))) == 0
    assert len(find_contacts(body(BRICK), at((1.3, 0.0, -0.5)), World(surfaces=(TABLE,)))) == 0
    assert len(find_contacts(body(BRICK), at((0.0, 0.0, -0.5)), World(surfaces=(TABLE,)))) == 0


def test_a_plate_is_touched_from_below_too() -> None:
    found = find_contacts(body(BRICK), at((0.0, 0.0, -0.05)), World(surfaces=(TABLE,)))
    assert len(found) == 4
    np.testing.assert_allclose(found.normals_W, [[0.0, 0.0, -1.0]] * 4, atol=1e-15)


def test_a_brick_on_a_spike_touches_with_its_face() -> None:
    turn = Rotation.from_euler("xyz", [0.1, 0.2, 0.3])
    found = find_contacts(
        body(BRICK), at(tuple(turn.apply([0.03, 0.02, 0.05])), turn), World(surfaces=(SPIKE,))
    )
    assert kinds(found) == ["face on corner"]
    np.testing.assert_allclose(found.p_WC_W, np.zeros((1, 3)), atol=1e-12)
    np.testing.assert_allclose(found.normals_W[0], turn.apply([0.0, 0.0, 1.0]), atol=1e-12)


def test_a_brick_on_a_ridge_flush_and_on_edge() -> None:
    flush = find_contacts(body(BRICK), at((0.0, 0.0, 0.05)), World(surfaces=(RIDGE,)))
    assert kinds(flush) == ["edge on edge"] * 2
    np.testing.assert_allclose(np.abs(flush.p_WC_W), [[0.0, 0.1, 0.0]] * 2, atol=1e-15)
    on_edge = Rotation.from_euler("x", 0.5)
    height = -float(corners_of(on_edge)[:, 2].min())
    crossed = find_contacts(body(BRICK), at((0.05, 0.0, height), on_edge), World(surfaces=(RIDGE,)))
    assert kinds(crossed) == ["edge on edge"]
    np.testing.assert_allclose(crossed.normals_W, [[0.0, 0.0, 1.0]], atol=1e-12)
    np.testing.assert_allclose(crossed.p_WC_W[:, [0, 2]], [[0.0, 0.0]], atol=1e-12)


def test_two_ridges_cross_in_one_point() -> None:
    roof = polyhedron(-ROOF)
    turn = Rotation.from_euler("z", 1.0)
    found = find_contacts(body(roof), at((0.0, 0.2, 0.0), turn), World(surfaces=(RIDGE,)))
    assert kinds(found) == ["edge on edge"]
    np.testing.assert_allclose(found.normals_W, [[0.0, 0.0, 1.0]], atol=1e-12)
    assert found.p_WC_W[0] == pytest.approx((0.0, 0.2, 0.0), abs=1e-12)
    assert found.body_curvatures is not None
    assert abs(found.body_curvatures.directions_W[0] @ turn.apply([0.0, 1.0, 0.0])) == pytest.approx(1.0)


def test_a_brick_on_its_like_touches_with_four_corners() -> None:
    below = obstacle(BRICK.vertices - [0.0, 0.0, 0.05])
    found = find_contacts(body(BRICK), at((0.0, 0.0, 0.05)), World(surfaces=(below,)))
    assert kinds(found) == ["corner on face"] * 4


@pytest.mark.parametrize(
    ("p", "normal", "side"),
    [
        ((0.2, 0.3, 0.1), (0.0, 0.0, 1.0), (0.0, 0.0)),
        ((1.06, 0.3, 0.08), (0.6, 0.0, 0.8), (0.0, INF)),
        ((1.06, 1.0 + 0.08 * 0.6, 0.08 * 0.8), None, (INF, INF)),
    ],
)
def test_a_ball_on_a_face_an_edge_and_a_corner(
    p: tuple[float, float, float], normal: tuple[float, float, float] | None, side: tuple[float, float]
) -> None:
    found = find_contacts(body(sphere(radius=0.1)), at(p), World(surfaces=(TABLE,)))
    assert sides(found.body_curvatures) == [(10.0, 10.0)]
    assert sides(found.surface_curvatures) == [side]
    expected = (np.array(p) - (1.0, 1.0, 0.0)) / 0.1 if normal is None else normal
    np.testing.assert_allclose(found.normals_W, [expected], atol=1e-12)
    np.testing.assert_allclose(found.p_WC_W[0], np.array(p) - 0.1 * np.array(expected), atol=1e-12)
    if side == (0.0, INF):
        assert found.surface_curvatures is not None
        assert abs(found.surface_curvatures.directions_W[0, 1]) == pytest.approx(1.0)


finite = st.floats(-1.0, 1.0)
turns = st.tuples(finite, finite, finite, finite).filter(lambda q: np.linalg.norm(q) > 0.1)
places = st.tuples(finite, finite, finite)


@given(q=turns, p=places, which=st.sampled_from([TABLE, SPIKE, RIDGE]))
def test_the_gap_is_positive_just_where_hulls_are_apart_and_never_above_their_distance(
    q: tuple[float, ...], p: tuple[float, float, float], which: Obstacle
) -> None:
    turn = Rotation.from_quat(q)
    corners = corners_of(turn, p)
    apart = distance(corners, which.vertices_W)
    assume(apart == 0.0 or apart > 1e-6)
    site = site_of(BRICK, np.array(p), turn.as_matrix(), which)
    if apart > 1e-6:
        assert 0.0 < site.gap <= apart + 1e-7  # the oracle's weights
        assert (corners @ site.normal_W).min() - (which.vertices_W @ site.normal_W).max() == pytest.approx(
            site.gap
        )


@given(q=turns, center=places, scale=st.floats(0.1, 2.0), seed=st.integers(0, 10_000))
@pytest.mark.filterwarnings("ignore::contact_dynamics.errors.ConcaveShapeWarning")
def test_a_ball_is_as_far_as_its_centre(
    q: tuple[float, ...], center: tuple[float, float, float], scale: float, seed: int
) -> None:
    points = scale * np.random.default_rng(seed).normal(size=(9, 3))
    cloud = obstacle(points)
    apart = distance(np.array([center]), points)
    assume(apart > 1e-3)
    (nearest,) = closest_points(cloud.features, np.array([center]))
    assert math.dist(nearest, center) == pytest.approx(apart, abs=1e-6)
    site = site_of(sphere(radius=0.05), np.array(center), Rotation.from_quat(q).as_matrix(), cloud)
    assert site.gap == pytest.approx(apart - 0.05, abs=1e-6)


@given(turn=st.floats(-3.0, 3.0), x=st.floats(0.6, 1.4), y=st.floats(0.6, 1.4))
def test_contacts_are_the_extreme_points_of_the_overlap(turn: float, x: float, y: float) -> None:
    rotation = Rotation.from_euler("z", turn)
    base = rotation.apply(box_vertices((0.8, 0.5, 0.0)))[:, :2] + np.array([x, y])
    top = TABLE.vertices_W[:, :2]
    found = find_contacts(
        body(box(size=(0.8, 0.5, 0.1))), at((x, y, 0.05), rotation), World(surfaces=(TABLE,))
    )
    inside = distance(np.c_[base, np.zeros(8)], TABLE.vertices_W) < 1e-9
    assert (len(found) > 0) == inside
    for angle in np.linspace(0.0, 6.0, 9):
        if inside:
            direction = np.array([math.cos(angle), math.sin(angle)])
            reach = (found.p_WC_W[:, :2] @ direction).max()
            assert reach == pytest.approx(overlap_support(base, top, direction), abs=1e-8)


def drop(state: BodyState, shape: ConvexShape = BRICK, where: Obstacle = TABLE) -> float | None:
    return first_touch(free_motion(STUFF, state, gravity_W=DOWN), shape, where, horizon=1.0)


def test_what_falls_on_a_table_lands_and_what_falls_beside_it_does_not() -> None:
    fall = math.sqrt(2.0 * 0.45 / 10.0)
    assert drop(at((0.0, 0.0, 0.5))) == pytest.approx(fall, abs=1e-9)
    assert drop(at((1.19, 0.0, 0.5))) == pytest.approx(fall, abs=1e-9)
    assert drop(at((1.21, 0.0, 0.5))) is None
    assert drop(at((0.0, 0.0, 0.55)), sphere(radius=0.1)) == pytest.approx(fall, abs=1e-9)
    beside = drop(at((1.06, 0.0, 0.53)), sphere(radius=0.1))  # on the edge, 0.08 above its level
    assert beside == pytest.approx(fall, abs=1e-9)
    assert drop(at((1.11, 0.0, 0.55)), sphere(radius=0.1)) is None


def test_thrown_against_the_side_of_a_box() -> None:
    crate = obstacle(box_vertices((1.0, 1.0, 1.0)))
    weightless = free_motion(STUFF, at((-2.0, 0.0, 0.0), v=(3.0, 0.0, 0.0)), gravity_W=np.zeros(3))
    assert first_touch(weightless, BRICK, crate, horizon=1.0) == pytest.approx(1.3 / 3.0, abs=1e-9)


def test_one_that_leaves_comes_back() -> None:
    assert drop(at((0.0, 0.0, 0.05), v=(0.0, 0.0, 2.0))) == pytest.approx(0.4, abs=1e-8)
    assert drop(at((0.0, 0.0, 0.05))) == 0.0
    assert drop(at((0.0, 0.0, 0.05), v=(0.0, 0.0, -1.0))) == 0.0


@settings(max_examples=12)
@given(
    q=turns,
    x=st.floats(0.7, 1.3),
    w=st.tuples(finite, finite, finite),
    which=st.sampled_from([TABLE, RIDGE, SPIKE]),
)
def test_nothing_touches_before_by_optimisation_at_many_times(
    q: tuple[float, ...], x: float, w: tuple[float, float, float], which: Obstacle
) -> None:
    turn = Rotation.from_quat(q)
    center = (x - 1.0 if which is not TABLE else x, 0.1, 0.7)
    motion = free_motion(
        STUFF, at(center, turn, v=(0.0, 0.0, 1.0), w=tuple(15.0 * np.array(w))), gravity_W=DOWN
    )
    found = first_touch(motion, BRICK, which, horizon=0.8)
    end = 0.8 if found is None else found
    trajectory = motion.at(np.linspace(0.0, end, 60))
    poses = zip(trajectory.q_WB, trajectory.p_WB_W, strict=True)
    gaps = [distance(corners_of(Rotation.from_quat(turned), p), which.vertices_W) for turned, p in poses]
    assert min(gaps[:-1]) > 1e-9
    if found is not None:
        assert gaps[-1] < 1e-7


def test_a_landing_on_a_table_s_edge_and_past_it_on_the_floor() -> None:
    floor = Surface(
        name="floor", p_WS_W=[0.0, 0.0, -1.0], normal_W=[0.0, 0.0, 1.0], friction=0.5, restitution=0.0
    )
    brick = body(BRICK)
    world = World(bodies=(brick,), surfaces=(floor, TABLE), gravity_W=DOWN)
    landing = next_landing(brick, at((1.0, 0.0, 0.5)), world, horizon=2.0)
    assert landing is not None
    assert landing.contacts.surfaces == ("it",) * 4
    assert landing.strikes
    assert landing.seconds == pytest.approx(0.3, abs=1e-8)
    past = next_landing(brick, at((1.3, 0.0, 0.5)), world, horizon=2.0)
    assert past is not None
    assert set(past.contacts.surfaces) == {"floor"}
    assert past.seconds == pytest.approx(math.sqrt(2.0 * 1.45 / 10.0), abs=1e-12)


CAN = cylinder(radius=0.1, length=0.4)
PILL = capsule(radius=0.1, length=0.4)
ON_SIDE = Rotation.from_euler("y", 90.0, degrees=True)


def test_a_can_that_stands_on_a_table_and_reaches_over_its_edge() -> None:
    inside = find_contacts(body(CAN), at((0.0, 0.0, 0.2)), World(surfaces=(TABLE,)))
    assert kinds(inside) == ["corner on face"] * 8
    over = find_contacts(body(CAN), at((1.0, 0.0, 0.2)), World(surfaces=(TABLE,)))
    assert sorted(kinds(over)) == ["corner on face"] * 5  # two of the eight are on the edge
    further = find_contacts(body(CAN), at((0.97, 0.0, 0.2)), World(surfaces=(TABLE,)))
    assert sorted(kinds(further)) == ["corner on face"] * 5 + ["edge on edge"] * 2
    assert further.p_WC_W[:, 0].max() == pytest.approx(1.0)
    assert len(find_contacts(body(CAN), at((1.11, 0.0, 0.2)), World(surfaces=(TABLE,)))) == 0


@pytest.mark.parametrize("shape", [CAN, PILL])
def test_a_can_and_a_pill_on_their_sides_reach_over_the_edge_with_their_line(shape: ConvexShape) -> None:
    lying = find_contacts(body(shape), at((0.5, 0.0, 0.1), ON_SIDE), World(surfaces=(TABLE,)))
    np.testing.assert_allclose(np.sort(lying.p_WC_W[:, 0]), [0.3, 0.7], atol=1e-12)
    over = find_contacts(body(shape), at((0.9, 0.0, 0.1), ON_SIDE), World(surfaces=(TABLE,)))
    np.testing.assert_allclose(np.sort(over.p_WC_W[:, 0]), [0.7, 1.0], atol=1e-12)
    at_edge = int(over.p_WC_W[:, 0].argmax())
    assert sides(over.surface_curvatures)[at_edge] == (0.0, INF)
    along, across = sides(over.body_curvatures)[at_edge]
    assert (along, across) == (0.0, pytest.approx(10.0))
    assert over.body_curvatures is not None
    assert abs(over.body_curvatures.directions_W[at_edge, 0]) == pytest.approx(1.0)


ALONG = Rotation.from_euler("x", 90.0, degrees=True)  # the edge of the table at x = 1


def test_a_rim_at_an_edge_is_refused() -> None:
    with pytest.raises(NotSupportedError, match=r"shape must .*, got a rim at an edge of 'it'"):
        find_contacts(
            body(CAN), at((1.06, 0.0, 0.08), ALONG), World(surfaces=(TABLE,)), distance_tolerance=1e-3
        )
    with pytest.raises(NotSupportedError, match=r"shape must .*, got a rim"):
        drop(at((1.06, 0.0, 0.5), ALONG), CAN)
    assert len(find_contacts(body(CAN), at((1.061, 0.0, 0.081), ALONG), World(surfaces=(TABLE,)))) == 0


def test_a_pill_along_an_edge_touches_with_its_two_ends_or_the_edge_s() -> None:
    found = find_contacts(body(PILL), at((1.06, 0.0, 0.08), ALONG), World(surfaces=(TABLE,)))
    np.testing.assert_allclose(found.normals_W, [[0.6, 0.0, 0.8]] * 2, atol=1e-12)
    np.testing.assert_allclose(np.sort(found.p_WC_W[:, 1]), [-0.2, 0.2], atol=1e-12)
    assert sides(found.body_curvatures) == [(10.0, 10.0)] * 2
    assert sides(found.surface_curvatures) == [(0.0, INF)] * 2
    out = find_contacts(body(PILL), at((1.06, 0.9, 0.08), ALONG), World(surfaces=(TABLE,)))
    np.testing.assert_allclose(np.sort(out.p_WC_W[:, 1]), [0.7, 1.0], atol=1e-12)
    corner = int(out.p_WC_W[:, 1].argmax())
    assert sides(out.body_curvatures)[corner] == (0.0, pytest.approx(10.0))
    assert sides(out.surface_curvatures)[corner] == (INF, INF)


def test_a_pill_across_a_ridge_and_one_whose_end_is_on_a_spike() -> None:
    across = find_contacts(body(PILL), at((0.05, 0.3, 0.1), ON_SIDE), World(surfaces=(RIDGE,)))
    np.testing.assert_allclose(across.p_WC_W, [[0.0, 0.3, 0.0]], atol=1e-12)
    assert sides(across.body_curvatures) == [(0.0, 10.0)]
    assert sides(across.surface_curvatures) == [(0.0, INF)]
    upright = find_contacts(body(PILL), at((0.0, 0.0, 0.3)), World(surfaces=(SPIKE,)))
    np.testing.assert_allclose(upright.p_WC_W, [[0.0, 0.0, 0.0]], atol=1e-12)
    assert sides(upright.body_curvatures) == [(10.0, 10.0)]
    assert sides(upright.surface_curvatures) == [(INF, INF)]


def test_a_pill_that_falls_on_an_edge() -> None:
    fall = math.sqrt(2.0 * 0.45 / 10.0)
    assert drop(at((1.06, 0.0, 0.53), ALONG), PILL) == pytest.approx(fall, abs=1e-9)
    assert drop(at((1.101, 0.0, 0.53), ALONG), PILL) is None


PILLOW = rounded(box(size=(0.4, 0.2, 0.1)), radius=0.05)


@given(
    q=turns,
    p=places,
    shape=st.sampled_from([PILL, PILLOW, sphere(radius=0.1), BRICK]),
    which=st.sampled_from([TABLE, SPIKE, RIDGE]),
)
def test_every_contact_is_on_both_and_where_they_are_nearest(
    q: tuple[float, ...], p: tuple[float, float, float], shape: ConvexShape, which: Obstacle
) -> None:
    """The body is brought to where the two touch, along the normal of its site."""
    turn = Rotation.from_quat(q)
    R = turn.as_matrix()
    site = site_of(shape, np.array(p), R, which)
    core = shape.vertices @ R.T + np.array(p)
    assume(distance(core, which.vertices_W) > shape.rounding + 1e-3)
    if shape.rounding > 0.0:  # then the gap is the distance
        assert site.gap == pytest.approx(distance(core, which.vertices_W) - shape.rounding, abs=1e-6)
    place = np.array(p) - site.gap * site.normal_W
    found = find_contacts(body(shape), at(tuple(place), turn), World(surfaces=(which,)))
    if shape.rounding > 0.0:
        assert len(found) > 0
    for point, normal in zip(found.p_WC_W, found.normals_W, strict=True):
        assert distance(point[None], which.vertices_W) < 2e-6
        assert distance(point[None], core - np.array(p) + place) == pytest.approx(shape.rounding, abs=2e-6)
        np.testing.assert_allclose(normal, site.normal_W, atol=1e-6)


def test_a_body_that_hovers_is_refused() -> None:
    still = free_motion(STUFF, at((0.0, 0.0, 0.05 + 1e-8), w=(0.0, 0.0, 30.0)), gravity_W=np.zeros(3))
    with pytest.raises(NotSupportedError, match=r"obstacle 'it': .*, got a body close to it"):
        first_touch(still, BRICK, TABLE, horizon=10.0)


@pytest.mark.parametrize(
    "vertices",
    [np.zeros((0, 3)), np.zeros((3, 3)), np.outer([0.0, 1.0, 3.0], [1.0, 1.0, 1.0]), [[math.nan] * 3] * 4],
)
def test_what_is_no_obstacle_is_refused(vertices: object) -> None:
    with pytest.raises(InvalidFieldError, match="vertices"):
        obstacle(vertices)


def test_a_body_without_shape_is_refused() -> None:
    nothing = Body(name="body", mass_properties=STUFF)
    with pytest.raises(NoContactError, match=r"'body' must have .*"):
        find_contacts(nothing, at((0.0, 0.0, 0.0)), World(surfaces=(TABLE,)))
    with pytest.raises(InvalidFieldError, match=r"shape_B must be .*, got nothing"):
        drop(at((0.0, 0.0, 0.0)), ConvexShape())
