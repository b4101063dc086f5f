# SPDX-License-Identifier: Apache-2.0
"""Bodies that are unions of convex parts: closed forms, and the same answers however a body is divided."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import contact_dynamics as cd
from contact_dynamics.contact.noise import NoisyState, touching
from contact_dynamics.errors import InvalidFieldError, NotSupportedError, TooLargeError
from contact_dynamics.rigid_body import inertia
from contact_dynamics.shapes import (
    ConvexShape,
    box,
    box_vertices,
    capsule,
    cylinder,
    polyhedron,
    rounded,
    sphere,
    union,
)
from contact_dynamics.shapes.convex import MAX_PARTS, NO_SHAPE
from oracles.hull_distance import distance
from sweeps import seeds

G = 9.80665
STUFF = cd.MassProperties(mass=1.0, I_B=np.diag([0.02, 0.03, 0.04]))
FLOOR = cd.Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5)

# A bracket in the x, z plane: a plate, and a leg down from its left end. Its hull closes the notch.
BRACKET = union([box(0.3, 0.1, 0.05).moved([0.15, 0, 0.225]), box(0.05, 0.1, 0.2).moved([0.025, 0, 0.1])])
SPIKE = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, -1.0], [-0.3, 0.4, -1.0], [-0.3, -0.4, -1.0]])
RIDGE = np.array([[x, y, z] for x, z in ((0.0, 0.0), (0.5, -1.0), (-0.5, -1.0)) for y in (-1.0, 1.0)])


def body(shape: ConvexShape) -> cd.Body:
    return cd.Body(name="body", mass_properties=STUFF, shape=shape)


def obstacle(vertices: np.ndarray) -> cd.Obstacle:
    return cd.Obstacle(name="post", vertices_W=vertices, friction=0.3, restitution=0.5)


def at(p: object, q: object = (0, 0, 0, 1), v: object = (0, 0, 0), w: object = (0, 0, 0)) -> cd.BodyState:
    return cd.BodyState(
        p_WB_W=np.array(p), q_WB=np.array(q), v_WB_W=np.array(v, float), w_WB_W=np.array(w, float)
    )


def landing(shape: ConvexShape, state: cd.BodyState, *surfaces: cd.Surface | cd.Obstacle) -> cd.Landing:
    found = cd.next_landing(body(shape), state, cd.World(surfaces=surfaces))
    assert found is not None
    return found


def rows(contacts: cd.ContactSet) -> np.ndarray:
    """Points and normals, in an order of their own, to a micrometre: the tolerance of contacts."""
    found = np.hstack([contacts.p_WC_W, contacts.normals_W]).round(6) + 0.0
    return found[np.lexsort(found.T)]


def test_a_bracket_lands_on_a_post_with_the_bottom_of_its_notch() -> None:
    """The post, 0.1 m <= x <= 0.2 m, enters the notch. The hull rises there from (0.05, 0) to (0.3, 0.2).

    At x = 0.1 m the hull is at z = 0.04 m, and the bottom of the notch at z = 0.2 m.
    """
    post = obstacle(np.add(box_vertices((0.1, 0.06, 1.0)), [0.15, 0.0, -0.5]))
    dropped = at([0.0, 0.0, 0.5])
    found = landing(BRACKET, dropped, post)
    assert found.seconds == pytest.approx(math.sqrt(2 * 0.7 / G), rel=1e-8)  # to `GRAZING_DEPTH`
    expected = [[x, y, 0, 0, 0, 1] for x in (0.1, 0.2) for y in (-0.03, 0.03)]
    assert sorted(rows(found.contacts).tolist()) == expected
    of_hull = landing(polyhedron(BRACKET.vertices), dropped, post)
    assert of_hull.seconds == pytest.approx(
        math.sqrt(2 * 0.54 / G), rel=1e-8
    )  # obstacles: to `GRAZING_DEPTH`


def test_a_box_that_fits_into_a_notch_touches_both_sides_of_it() -> None:
    fitting = obstacle(np.add(box_vertices((0.1, 0.06, 0.1)), [0.1, 0.0, 0.15]))
    found = cd.find_contacts(body(BRACKET), at([0, 0, 0]), cd.World(surfaces=(fitting,)))
    up = [[x, y, 0.2, 0, 0, 1] for x in (0.05, 0.15) for y in (-0.03, 0.03)]
    left = [[0.05, y, z, -1, 0, 0] for y in (-0.03, 0.03) for z in (0.1, 0.2)]
    assert sorted(rows(found).tolist()) == sorted(up + left)
    with pytest.raises(InvalidFieldError, match="deep in 'post'"):
        cd.find_contacts(body(polyhedron(BRACKET.vertices)), at([0, 0, 0]), cd.World(surfaces=(fitting,)))


def test_a_plane_touches_only_corners_of_the_hull() -> None:
    """A table with four legs stands on the outer corners of its legs."""
    legs = [box(0.05, 0.05, 0.7).moved([x, y, 0.35]) for x in (-0.4, 0.4) for y in (-0.3, 0.3)]
    table = union([box(0.9, 0.7, 0.04).moved([0, 0, 0.72]), *legs])
    found = cd.find_contacts(body(table), at([0, 0, 0]), cd.World(surfaces=(FLOOR,)))
    corners = [[x, y, 0, 0, 0, 1] for x in (-0.425, 0.425) for y in (-0.325, 0.325)]
    assert sorted(rows(found).tolist()) == corners
    on_obstacle = cd.find_contacts(
        body(table), at([0, 0, 0]), cd.World(surfaces=(obstacle(box_vertices((2, 2, 1)) - [0, 0, 0.5]),))
    )
    np.testing.assert_array_equal(rows(on_obstacle), rows(found))


def test_a_hammer_of_two_boxes_has_the_mass_of_both() -> None:
    head, handle = cd.Body.box((0.1, 0.03, 0.03), 0.5), cd.Body.box((0.02, 0.02, 0.3), 0.1)
    hammer = cd.Body.union([head.placed([0, 0, 0.165]), handle], name="hammer")
    assert (hammer.name, hammer.mass_properties.mass) == ("hammer", pytest.approx(0.6, rel=1e-15))
    assert hammer.p_FB_F == pytest.approx([0, 0, 0.5 * 0.165 / 0.6], abs=1e-15)
    apart = 0.5 * 0.1 / 0.6 * 0.165**2  # of two masses at a distance, about the centre of both
    of_parts = [0.5 * (0.03**2 + 0.03**2) + 0.1 * (0.3**2 + 0.02**2)]
    of_parts += [0.5 * (0.1**2 + 0.03**2) + 0.1 * (0.3**2 + 0.02**2)]
    of_parts += [0.5 * (0.1**2 + 0.03**2) + 0.1 * (0.02**2 + 0.02**2)]
    moments = np.array(of_parts) / 12 + [apart, apart, 0]
    np.testing.assert_allclose(hammer.mass_properties.I_B, np.diag(moments), atol=1e-17)
    # It hangs on the edge of a table: the head lies on the top, and the handle leans against the side.
    table = obstacle(np.add(box_vertices((1, 1, 1)), [0.51, 0, -0.35]))
    found = cd.find_contacts(hammer, at(hammer.p_FB_F), cd.World(surfaces=(table,)))
    on_top = [[x, y, 0.15, 0, 0, 1] for x in (0.01, 0.05) for y in (-0.015, 0.015)]
    beside = [[0.01, y, z, -1, 0, 0] for y in (-0.01, 0.01) for z in (-0.15, 0.15)]
    assert sorted(rows(found).tolist()) == sorted(on_top + beside)


def test_placed_moves_the_frame_and_not_the_body() -> None:
    turn = Rotation.from_euler("xyz", [0.3, 0.1, -0.4])
    brick = cd.Body.of("brick", inertia.box((0.3, 0.2, 0.1), mass=1.0), shape_F=box(0.3, 0.2, 0.1))
    moved = brick.placed([0.1, 0.2, 0.3], turn.as_quat())
    R = turn.as_matrix()
    np.testing.assert_allclose(moved.p_FB_F, [0.1, 0.2, 0.3], atol=1e-16)
    np.testing.assert_allclose(moved.vertices_B, brick.vertices_B @ R.T, atol=1e-16)
    np.testing.assert_allclose(moved.mass_properties.I_B, R @ brick.mass_properties.I_B @ R.T, atol=1e-17)


HALVES = union([box(0.2, 0.2, 0.1).moved([x, 0, 0]) for x in (-0.1, 0.1)])
OVERLAPPING = union([box(0.3, 0.2, 0.1).moved([x, 0, 0]) for x in (-0.05, 0.05)])
QUARTERS = union([box(0.2, 0.1, 0.1).moved([x, y, 0]) for x in (-0.1, 0.1) for y in (-0.05, 0.05)])


@pytest.mark.parametrize(
    "divided", [HALVES, OVERLAPPING, QUARTERS], ids=["halves", "overlapping", "quarters"]
)
@seeds(range(8), slow=range(8, 400))
def test_a_divided_box_lands_as_the_whole(divided: ConvexShape, seed: int) -> None:
    """Seams have sides that the whole does not have: every second box comes down on a tip right at a seam."""
    rng = np.random.default_rng(seed)
    post = obstacle(SPIKE if seed % 4 < 2 else RIDGE)
    q = Rotation.random(random_state=seed).as_quat() if seed % 2 else (0, 0, 0, 1)
    offset = [*(rng.uniform(-0.2, 0.2, 2) * (seed % 2)), 1.0]
    state = at(offset, q, rng.normal(size=3) * 0.3 * (seed % 2), rng.normal(size=3) * 2 * (seed % 2))
    world = cd.World(surfaces=(post,))
    whole = cd.next_landing(body(box(0.4, 0.2, 0.1)), state, world, horizon=1.0)
    parts = cd.next_landing(body(divided), state, world, horizon=1.0)
    assert (whole is None) == (parts is None)
    if whole is not None and parts is not None:
        assert parts.seconds == pytest.approx(whole.seconds, abs=1e-8)  # both within `GRAZING_DEPTH`
        np.testing.assert_allclose(rows(parts.contacts), rows(whole.contacts), atol=2e-6)
        again = cd.next_landing(body(divided), parts.state.with_velocities([0, 0, 1], [0, 0, 0]), world)
        same = cd.next_landing(
            body(box(0.4, 0.2, 0.1)), parts.state.with_velocities([0, 0, 1], [0, 0, 0]), world
        )
        assert (again is None) == (same is None)
        assert again is None or again.seconds == pytest.approx(same.seconds, abs=1e-7)
    on_floor = landing(divided, state, FLOOR)
    assert on_floor.seconds == pytest.approx(landing(box(0.4, 0.2, 0.1), state, FLOOR).seconds, rel=1e-14)


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-9, 1e-7, 9e-7, 1.1e-6, 1e-5, 1e-3])
def test_a_tip_near_a_seam_touches_the_face(gap: float) -> None:
    """Within the tolerance of a seam, the tip is within that of both parts."""
    for turn in (0.0, 0.7, math.pi):
        post = obstacle(SPIKE @ Rotation.from_euler("z", turn).as_matrix().T)
        for sign in (-1.0, 1.0):
            found = cd.find_contacts(body(HALVES), at([sign * gap, 0, 0.05]), cd.World(surfaces=(post,)))
            np.testing.assert_allclose(found.p_WC_W, np.zeros((1, 3)), atol=1e-12)
            np.testing.assert_allclose(found.normals_W, [[0, 0, 1]], atol=1e-12)


@seeds(range(4), slow=range(4, 200))
def test_without_a_tolerance_parts_still_touch(seed: int) -> None:
    """Rounding puts a box of quarters that lies flush in any direction a little into a table, or above it."""
    turn = Rotation.random(random_state=seed)
    table = obstacle(turn.apply(box_vertices((1, 1, 1)) - [0, 0, 0.5]))
    lying = at(turn.apply([0, 0, 0.05 - 1e-12]), turn.as_quat())
    found = cd.find_contacts(body(QUARTERS), lying, cd.World(surfaces=(table,)), distance_tolerance=0.0)
    assert len(found) == 4


def random_parts(rng: np.random.Generator) -> list[ConvexShape]:
    return [
        box(rng.uniform(0.05, 0.4, 3)).moved(
            rng.uniform(-0.2, 0.2, 3), Rotation.random(random_state=rng).as_quat()
        )
        for _ in range(3)
    ]


@seeds(range(8), slow=range(8, 400))
def test_a_union_lands_when_its_first_part_does(seed: int) -> None:
    """Each part is followed alone, in any order, and an optimiser finds how far the nearest part is then."""
    rng = np.random.default_rng(seed)
    parts = random_parts(rng)
    post = obstacle([SPIKE, RIDGE, box_vertices((0.5, 0.5, 1.0)) - [0, 0, 0.5]][seed % 3])
    q = Rotation.random(random_state=seed).as_quat()
    state = at([*rng.uniform(-0.3, 0.3, 2), 1.0], q, rng.normal(size=3) * 0.5, rng.normal(size=3) * 3)
    world = cd.World(surfaces=(post,))
    alone = [found for part in parts if (found := cd.next_landing(body(part), state, world, horizon=0.9))]
    first = min((found.seconds for found in alone), default=None)
    for order in (parts, parts[::-1]):
        found = cd.next_landing(body(union(order)), state, world, horizon=0.9)
        assert (found is None) == (first is None)
        if found is not None and first is not None:
            assert found.seconds == pytest.approx(first, abs=1e-12)
            corners = [found.state.p_WB_W + part.vertices @ found.state.R_WB.T for part in parts]
            assert min(distance(each, post.vertices_W) for each in corners) <= 1e-6
    lowest = landing(union(parts), state, FLOOR)
    of_parts = [landing(part, state, FLOOR).seconds for part in parts]
    assert lowest.seconds == pytest.approx(min(of_parts), rel=1e-14)


def test_round_parts_touch_too() -> None:
    """A dumbbell of two balls straddles a ridge, and so does a wheel pair of two cylinders a table's edge."""
    balls = union([sphere(0.1).moved([x, 0, 0]) for x in (-0.2, 0.2)])
    wide = obstacle(box_vertices((0.2, 1, 1)) - [0, 0, 0.5])
    dropped = landing(balls, at([0, 0, 0.5]), obstacle(box_vertices((0.3, 1, 1)) - [0, 0, 0.5]))
    # The ball at x = 0.2 m comes down on the edge at x = 0.15 m, 0.05 m beside its centre.
    height = 0.5 - math.sqrt(0.1**2 - 0.05**2)
    assert dropped.seconds == pytest.approx(math.sqrt(2 * height / G), rel=1e-8)
    np.testing.assert_allclose(dropped.contacts.p_WC_W, [[-0.15, 0, 0], [0.15, 0, 0]], atol=1e-8)
    passing = cd.next_landing(body(balls), at([0, 0, 0.5]), cd.World(surfaces=(wide,)), horizon=0.2)
    assert passing is None
    wheels = union([cylinder(0.1, 0.04).moved([0, 0, z]) for z in (-0.3, 0.3)])
    lying = at([0, 0, 0.1], Rotation.from_euler("x", math.pi / 2).as_quat())
    on_table = cd.find_contacts(
        body(wheels), lying, cd.World(surfaces=(obstacle(box_vertices((2, 2, 1)) - [0, 0, 0.5]),))
    )
    assert sorted(on_table.p_WC_W[:, 1].round(12)) == [-0.32, 0.32]


MALLET = cd.Body.union(
    [cd.Body.box((0.02, 0.02, 0.3), 0.1), cd.Body.sphere(0.05, 0.5).placed([0, 0, 0.18])], name="mallet"
)
"""A box as its handle and a ball as its head, with the frame in the middle of the handle."""


@pytest.mark.parametrize(
    "surface", [FLOOR, obstacle(box_vertices((4, 4, 1)) - [0, 0, 0.5])], ids=["", "table"]
)
def test_parts_of_different_roundings_land_each_by_its_own(surface: cd.Surface | cd.Obstacle) -> None:
    """The mallet falls lying, standing on its head, and upside down, from 1 m to the frame's origin."""
    for angles, lowest, count in (([-90, 0, 0], 0.05, 1), ([180, 0, 0], 0.23, 1), ([0, 0, 0], 0.15, 4)):
        turn = Rotation.from_euler("xyz", angles, degrees=True)
        state = at(np.add(turn.apply(np.array(MALLET.p_FB_F)), [0, 0, 1]), turn.as_quat())
        found = cd.next_landing(MALLET, state, cd.World(surfaces=(surface,)))
        assert found is not None
        assert found.seconds == pytest.approx(math.sqrt(2 * (1 - lowest) / G), rel=1e-8)
        assert len(found.contacts) == count
        below = turn.apply([0, 0, 0.18 if count == 1 else 0])
        np.testing.assert_allclose(found.contacts.p_WC_W.mean(axis=0), [*below[:2], 0], atol=1e-8)


def test_parts_of_different_roundings_meet_each_by_its_own() -> None:
    """Two mallets that lie side by side meet head on head, and head on the end of a handle."""
    level = Rotation.from_euler("x", -90, degrees=True)  # the head is towards +y
    left = at(level.apply(np.array(MALLET.p_FB_F)), level.as_quat(), v=(1, 0, 0))
    for aside, seconds in ((0.0, 1.0 - 2 * 0.05), (0.18, 1.0 - 0.05 - 0.01)):
        right = at(np.add(left.p_WB_W, [1, aside, 0]), level.as_quat())
        expected = [seconds + 0.05, 0.18, -0.5 * G * seconds**2]
        for one, other in (((MALLET, left), (MALLET, right)), ((MALLET, right), (MALLET, left))):
            found = cd.next_meeting(*one, *other, friction=0.1, restitution=0.5)
            assert found is not None
            assert found.seconds == pytest.approx(seconds, rel=1e-12)
            np.testing.assert_allclose(found.contacts.p_WC_W, [expected], atol=1e-9)


def test_parts_of_different_roundings_have_a_hull_for_each() -> None:
    handle, head = MALLET.shape.hulls
    assert (handle.rounding, head.rounding, len(MALLET.shape.parts)) == (0.0, 0.05, 2)
    assert not MALLET.shape.is_empty
    assert not MALLET.shape.is_polyhedron
    assert MALLET.shape.reach == pytest.approx(math.hypot(0.15 + MALLET.p_FB_F[2], 0.01, 0.01), rel=1e-15)
    with pytest.raises(
        NotSupportedError, match=r"parts of one rounding for a whole toss, got \[0\.0, 0\.05\] m"
    ):
        cd.toss(MALLET, at([0, 0, 1]), cd.World(surfaces=(FLOOR,)))


def test_a_union_is_tossed_as_its_hull() -> None:
    """Tosses have only planes, so the divided box moves as the whole one."""
    state = at([0, 0, 0.3], Rotation.from_euler("xyz", [0.2, 0.3, 0.1]).as_quat(), (1, 0, 0), (1, 2, 3))
    whole = box(0.4, 0.2, 0.1)
    nearly = union([whole, whole.moved([1e-9, 0, 0])])  # corners so near to each other count as one
    tosses = [cd.toss(body(shape), state, cd.World(surfaces=(FLOOR,))) for shape in (whole, HALVES, nearly)]
    assert {found.end.name for found in tosses} == {"RESTS"}
    np.testing.assert_allclose(tosses[1].state.p_WB_W, tosses[0].state.p_WB_W, atol=1e-9)


def test_shapes_stay_unions_and_single_ones_convex() -> None:
    brick = box(0.4, 0.2, 0.1)
    assert union([brick]) is brick
    assert union([]) is NO_SHAPE
    assert union([NO_SHAPE, brick]) is brick
    nested = union([HALVES, brick.moved([0, 0, 1])])
    assert len(nested.parts) == 3
    assert nested.moved([1, 0, 0]).parts[2].vertices[:, 0].max() == pytest.approx(1.2)
    assert rounded(HALVES, 0.01).parts[1].rounding == rounded(HALVES, 0.01).rounding == 0.01
    assert sorted(HALVES.vertices.tolist()) == sorted(brick.vertices.tolist())
    plate = union([polyhedron(np.add(box_vertices((1, 1, 0)), [x, 0, 0])) for x in (0, 1)])
    assert sorted(plate.vertices.tolist()) == [[x, y, 0] for x in (-0.5, 1.5) for y in (-0.5, 0.5)]
    rod = union([polyhedron([[0, 0, 0], [1, 0, 0]]), polyhedron([[1, 0, 0], [3, 0, 0]])])
    assert rod.vertices.tolist() == [[0, 0, 0], [3, 0, 0]]
    assert len(union([capsule(0.1, 1), capsule(0.1, 2)]).vertices) == 2


def test_what_cannot_be_a_union_is_named() -> None:
    with pytest.raises(InvalidFieldError, match="parts must be parts alone"):
        ConvexShape(parts=HALVES.parts, rounding=0.1)
    with pytest.raises(TooLargeError, match=f"at most {MAX_PARTS}"):
        union([box(1, 1, 1)] * (MAX_PARTS + 1))
    with pytest.raises(InvalidFieldError, match="at least one"):
        cd.Body.union([])


def test_a_noisy_pose_of_a_mallet_is_put_on_the_floor() -> None:
    """It lies on its head and on two corners of its handle: a tangent of the circle through the end of it."""
    tilt = math.asin(0.05 / math.hypot(0.33, 0.01)) - math.atan2(0.01, 0.33)
    turn = Rotation.from_euler("y", 0.5 * math.pi - tilt)
    lying = at(
        np.add(turn.apply(np.array(MALLET.p_FB_F)), [0, 0, 0.05 - turn.apply([0, 0, 0.18])[2]]),
        turn.as_quat(),
    )
    world = cd.World(bodies=(MALLET,), surfaces=(FLOOR,))
    exact = cd.find_contacts(MALLET, lying, world)
    assert len(exact) == 3
    ball = exact.p_WC_W[np.isclose(exact.p_WC_W[:, 1], 0.0, atol=1e-9)]
    np.testing.assert_allclose(ball, [[turn.apply([0, 0, 0.18])[0], 0, 0]], atol=1e-9)
    root = np.diag([2e-4] * 3 + [1e-3] * 3 + [0.0] * 6)
    off = cd.BodyState(p_WB_W=np.add(lying.p_WB_W, [0, 0, 2e-4]), q_WB=lying.q_WB)
    closed = touching(MALLET, NoisyState(off, root), (FLOOR,), distance_tolerance=1e-6)
    found = cd.find_contacts(MALLET, closed.state, world)
    assert len(found) == 3
