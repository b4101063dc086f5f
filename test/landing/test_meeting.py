# SPDX-License-Identifier: Apache-2.0
"""Two bodies that meet in flight, beside closed forms of balls and distances of hulls by optimisation."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import contact_dynamics as cd
from contact_dynamics.errors import InvalidFieldError, NoShapeError, NotSupportedError
from contact_dynamics.impact import bodies_impact, spatial_pair_impact
from contact_dynamics.shapes import ConvexShape, box, polyhedron, rounded, union
from oracles.hull_distance import distance
from sweeps import seeds

G = 9.80665
PAIR = {"friction": 0.2, "restitution": 0.9}
SMALL, LARGE = cd.Body.sphere(0.1, 1.0, name="small"), cd.Body.sphere(0.2, 3.0, name="large")


def at(p: list[float], v: list[float], w: list[float] | None = None) -> cd.BodyState:
    return cd.BodyState(p_WB_W=p, q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=[0.0] * 3 if w is None else w)


def test_two_thrown_balls_meet_when_a_quadratic_says_and_bounce_off_each_other() -> None:
    one, other = at([0, 0, 1], [1, 0, 2], [1, 2, 3]), at([2, 0.1, 1.2], [-1, 0, 1.8], [5, 0, 0])
    meeting = cd.next_meeting(SMALL, one, LARGE, other, **PAIR)
    assert meeting is not None
    p, v = one.p_WB_W - other.p_WB_W, one.v_WB_W - other.v_WB_W  # in free fall, v is constant
    b, c = p @ v, p @ p - 0.3**2
    t = (-b - math.sqrt(b * b - v @ v * c)) / (v @ v)
    assert meeting.seconds == pytest.approx(t, rel=1e-14)
    (contact,) = meeting.contacts
    normal = (p + v * t) / 0.3
    np.testing.assert_allclose(contact.normal_W, normal, atol=1e-14)
    center = other.p_WB_W + other.v_WB_W * t - [0, 0, 0.5 * G * t * t]
    np.testing.assert_allclose(contact.p_WC_W, center + 0.2 * normal, atol=1e-14)
    assert (meeting.strikes, contact.surface) == (True, "large")
    impact = spatial_pair_impact(SMALL, meeting.state, LARGE, meeting.other_state, contact)
    assert impact.other_state is not None
    before = 1.0 * meeting.state.v_WB_W + 3.0 * meeting.other_state.v_WB_W
    np.testing.assert_allclose(impact.state.v_WB_W + 3.0 * impact.other_state.v_WB_W, before, atol=1e-14)
    assert cd.next_meeting(SMALL, impact.state, LARGE, impact.other_state, **PAIR) is None


def test_a_carried_body_does_not_fall() -> None:
    # A ball falls past a racket that is carried sideways at 2 m/s.
    racket = cd.Body.box((0.2, 0.4, 0.02), 0.3, name="racket")
    ball, hand = at([1.0, 0, 1.11], [0, 0, 0]), at([0, 0, 0.0], [2.0, 0, 0])
    t = math.sqrt(2.0 * 1.0 / G)  # from 1.11 m down to half the racket's thickness and the ball's radius
    carried = cd.next_meeting(SMALL, ball, racket, hand, other_gravity_W=[0, 0, 0], **PAIR)
    assert carried is not None
    assert carried.seconds == pytest.approx(t, rel=1e-12)
    np.testing.assert_allclose(carried.contacts.normals_W, [[0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(carried.velocities_W, [[-2.0, 0, -G * t]], rtol=1e-12)
    assert cd.next_meeting(SMALL, ball, racket, hand, **PAIR) is None  # let go, it falls as fast


def test_boxes_that_meet_face_to_face_have_four_contacts() -> None:
    one, other = cd.Body.box((0.2, 0.2, 0.2), 1.0), cd.Body.box((0.2, 0.1, 0.3), 2.0, name="other")
    meeting = cd.next_meeting(one, at([-1, 0, 0], [1, 0, 0]), other, at([1, 0, 0], [-1, 0, 0]), **PAIR)
    assert meeting is not None
    assert meeting.seconds == pytest.approx(0.9, rel=1e-14)
    corners = meeting.contacts.p_WC_W + np.array([0, 0, 0.5 * G * 0.9**2])
    expected = [[0, y, z] for y in (-0.05, 0.05) for z in (-0.1, 0.1)]
    np.testing.assert_allclose(sorted(corners.round(12).tolist()), expected, atol=1e-12)
    states = [meeting.state, meeting.other_state]
    impact = bodies_impact([one, other], states, meeting.contacts, meeting.pairs)
    gap = impact.states[1].v_WB_W - impact.states[0].v_WB_W
    assert gap[0] == pytest.approx(0.9 * 2.0, rel=1e-12)


def test_contacts_of_a_meeting_are_no_contacts_with_the_world() -> None:
    one, other = cd.Body.box((0.2, 0.2, 0.2), 1.0), cd.Body.box((0.2, 0.1, 0.3), 2.0, name="other")
    meeting = cd.next_meeting(one, at([-1, 0, 0], [1, 0, 0]), other, at([1, 0, 0], [-1, 0, 0]), **PAIR)
    assert meeting is not None
    state, contacts = meeting.state, meeting.contacts
    rest = cd.World()
    again = cd.ContactSet.of([*contacts])
    for call in (
        lambda: cd.spatial_impact(one, state, contacts[0]),
        lambda: cd.several_impact(one, state, contacts),
        lambda: cd.several_impact(one, state, again.subset([1, 3])),
        lambda: cd.impact_sequence(one, state, rest, contacts=contacts),
        lambda: cd.SpatialContactProblem(body=one, state=state, contacts=contacts, force_W=[0, 0, -G]),
        lambda: bodies_impact(
            [one, other], [state, meeting.other_state], contacts, [(0, 1)] * 3 + [(0, None)]
        ),
    ):
        with pytest.raises(
            InvalidFieldError, match=r"be with the world, got one with the body 'other' \(bodies_im"
        ):
            call()
    as_wall = replace(contacts, surfaces=())  # a surface of the world at the same place
    assert cd.several_impact(one, state, as_wall).states[0].v_WB_W[0] == pytest.approx(-0.9, rel=1e-12)


@seeds(range(12), slow=range(12, 2000))
def test_spinning_bodies_meet_when_their_hulls_first_touch(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rounding = 0.02 * (seed % 3)  # also rounded boxes, and a rod or a ball beside a box
    bodies, states = [], []
    for side in (-1.0, 1.0):
        size = rng.uniform(0.05, 0.3, 3)
        if seed % 4 == 3 and side > 0.0:
            size[1:] = 1e-3
        shape = rounded(box(size), radius=rounding)
        mass = cd.MassProperties(mass=1.0, I_B=np.diag([0.002, 0.003, 0.004]))
        bodies.append(cd.Body(name=f"b{side}", mass_properties=mass, shape=shape))
        states.append(
            cd.BodyState(
                p_WB_W=np.array([side, 0, 0]) + rng.uniform(-0.15, 0.15, 3),
                q_WB=Rotation.random(random_state=rng).as_quat(),
                v_WB_W=[-1.5 * side, 0, 0],
                w_WB_W=rng.normal(0, 6, 3),
            )
        )
    flights = [cd.free_motion(body, state) for body, state in zip(bodies, states, strict=True)]

    def gap(seconds: float) -> float:
        hulls = [
            then.p_WB_W + body.vertices_B @ then.R_WB.T
            for body, then in zip(bodies, (flight.state_at(seconds) for flight in flights), strict=True)
        ]
        return distance(*hulls) - 2.0 * rounding

    found = cd.next_meeting(bodies[0], states[0], bodies[1], states[1], **PAIR)
    swapped = cd.next_meeting(bodies[1], states[1], bodies[0], states[0], **PAIR)
    times = np.linspace(0.0, 2.0 if found is None else 0.999 * found.seconds, 100)
    # They are never nearer than the search may miss, and touch at the end. The optimisation is right to 2e-12
    # (in 2,000 draws); the plane between the bodies leaves 1e-16.
    assert min(map(gap, times.tolist())) > 1e-9
    if found is None:
        assert swapped is None
        return
    assert abs(gap(found.seconds)) <= 5e-12
    assert found.strikes
    assert swapped is not None
    assert swapped.seconds == pytest.approx(found.seconds, abs=1e-12)
    np.testing.assert_allclose(swapped.contacts.p_WC_W, found.contacts.p_WC_W, atol=1e-9)
    np.testing.assert_allclose(swapped.contacts.normals_W, -found.contacts.normals_W, atol=1e-9)
    np.testing.assert_allclose(swapped.velocities_W, -found.velocities_W, atol=1e-8)


def test_bodies_that_touch_meet_at_once_unless_they_part() -> None:
    beside = at([0.3, 0, 0], [0, 0, 0])
    for v, seconds in ((1.0, 0.0), (0.0, 0.0), (-1.0, None)):
        meeting = cd.next_meeting(SMALL, at([0, 0, 0], [v, 0, 0]), LARGE, beside, **PAIR)
        assert (None if meeting is None else meeting.seconds) == seconds
        assert meeting is None or meeting.strikes is (v > 0.0)
    # A ball that is thrown up from a carried one comes back after 2 v / g.
    up = cd.next_meeting(
        SMALL, at([0, 0, 0.3], [0, 0, 3]), LARGE, at([0, 0, 0], [0, 0, 0]), other_gravity_W=[0, 0, 0], **PAIR
    )
    assert up is not None
    assert up.seconds == pytest.approx(6.0 / G, rel=1e-12)


@pytest.mark.parametrize("depth", np.geomspace(1e-15, 1e-8, 15))
@pytest.mark.parametrize("speed", [0.01, 30.0])
def test_balls_that_graze_each_other_meet_in_a_contact_or_not_at_all(depth: float, speed: float) -> None:
    """They are in contact for about sqrt(depth) s. A touch is found within 2 nm, and no deeper is missed."""
    for y in (0.3 - depth, 0.3 + depth):
        thrown, still = at([0, 0, 0], [speed, 0, 0]), at([1, y, 0], [0, 0, 0])
        meeting = cd.next_meeting(SMALL, thrown, LARGE, still, horizon=2.0 / speed, **PAIR)
        if meeting is None:
            assert y > 0.3 - 2e-9
        else:
            assert len(meeting.contacts) == len(meeting.velocities_W) == 1
            apart = np.linalg.norm(meeting.state.p_WB_W - meeting.other_state.p_WB_W)
            assert apart == pytest.approx(0.3, abs=2e-9)


def test_states_of_different_times_are_an_error() -> None:
    """A stamp of 0 is none. Two trackers are seldom within 0.1 ms of each other."""
    one, other = at([0, 0, 0], [1, 0, 0]), at([0.3, 0, 0], [0, 0, 0])
    one, late = replace(one, stamp_ns=10**18), replace(other, stamp_ns=10**18 + 8 * 10**6)
    near = cd.ContactSet(p_WC_W=[[0.1, 0, 0]], normals_W=[-1, 0, 0], frictions=0.1, restitutions=0.5)
    for call in (
        lambda there: cd.next_meeting(SMALL, one, LARGE, there, **PAIR),
        lambda there: spatial_pair_impact(SMALL, one, LARGE, there, near[0]),
        lambda there: bodies_impact([SMALL, LARGE], [one, there], near, [(0, 1)]),
    ):
        with pytest.raises(
            InvalidFieldError, match=r"state.* must be of the same time .*, got .* by 0\.008 s"
        ):
            call(late)
        call(other)
        call(replace(late, stamp_ns=10**18 + 10**4))


def test_what_cannot_meet_is_refused_by_name() -> None:
    here, there = at([0, 0, 0], [0, 0, 0]), at([0.25, 0, 0], [0, 0, 0])
    with pytest.raises(
        InvalidFieldError, match=r"other_state must be at most 1e-06 m deep .*'large' 0.05 m deep"
    ):
        cd.next_meeting(SMALL, here, LARGE, there, **PAIR)
    with pytest.raises(NotSupportedError, match="body 'can' must have a shape without circular rims"):
        cd.next_meeting(cd.Body.cylinder(0.1, 0.2, 1.0, name="can"), here, LARGE, there, **PAIR)
    bare = cd.Body(name="large", mass_properties=LARGE.mass_properties)
    with pytest.raises(NoShapeError, match="body 'large' must have"):
        cd.next_meeting(SMALL, here, bare, there, **PAIR)


def u_shape(*, upside_down: bool = False) -> ConvexShape:
    """Two legs, 0.1 m wide and 0.4 m long, 0.3 m apart, on a base 0.1 m thick that begins at z = 0."""
    base = box(0.5, 0.2, 0.1).moved([0, 0, 0.05])
    legs = [box(0.1, 0.2, 0.4).moved([x, 0, 0.3]) for x in (-0.2, 0.2)]
    return union([base, *legs]).moved([0, 0, 0], [1, 0, 0, 0] if upside_down else [0, 0, 0, 1])


def of_shape(shape: ConvexShape, name: str = "body") -> cd.Body:
    return cd.Body(name=name, mass_properties=cd.MassProperties(mass=1.0, I_B=np.eye(3) * 0.02), shape=shape)


def test_two_u_shapes_interlock() -> None:
    """Each has a leg in the other's slot, 0.25 m to the side. Both legs come down on the bases together."""
    lower, upper = of_shape(u_shape(), "lower"), of_shape(u_shape(upside_down=True), "upper")
    resting, sinking = at([0, 0, 0], [0, 0, 0]), at([0.25, 0, 1.1], [0, 0, -0.5])
    meeting = cd.next_meeting(upper, sinking, lower, resting, **PAIR)
    assert meeting is not None
    assert meeting.seconds == pytest.approx((1.1 - 0.6) / 0.5, rel=1e-14)
    fall = 0.5 * G * meeting.seconds**2
    np.testing.assert_allclose(meeting.contacts.normals_W, [[0, 0, 1]] * 8, atol=1e-12)
    points = sorted(np.add(meeting.contacts.p_WC_W, [0, 0, fall]).round(9).tolist())
    tips = [[x, y, 0.1] for x in (0.0, 0.1) for y in (-0.1, 0.1)]
    assert points == sorted(tips + [[x, y, 0.5] for x in (0.15, 0.25) for y in (-0.1, 0.1)])
    hulls = [of_shape(polyhedron(each.vertices_B)) for each in (upper, lower)]
    earlier = cd.next_meeting(hulls[0], sinking, hulls[1], resting, **PAIR)
    assert earlier is not None
    assert earlier.seconds == pytest.approx((1.1 - 1.0) / 0.5, rel=1e-14)
    # The slot leaves a leg 0.05 m on one side and 0.15 m on the other.
    for speed, seconds in ((-0.1, 0.5), (0.1, 1.5)):
        aside = cd.next_meeting(
            upper, at([0.25, 0, 0.7], [0, 0, 0]), lower, at([0, 0, 0], [speed, 0, 0]), **PAIR
        )
        assert aside is not None
        assert aside.seconds == pytest.approx(seconds, rel=1e-14)
        np.testing.assert_allclose(np.abs(aside.contacts.normals_W[:, 0]), 1.0, atol=1e-12)


def test_rings_meet_when_a_pair_of_their_boxes_does() -> None:
    """Each of the 64 pairs alone is the reference: only parts of rings are left out while far apart."""
    parts = [
        box(0.1, 0.05, 0.05).moved(
            [0.2 * math.cos(t), 0.2 * math.sin(t), 0], [0, 0, math.sin(t / 2), math.cos(t / 2)]
        )
        for t in np.arange(8) * math.pi / 4
    ]
    for spin in (0.0, 3.0, 20.0):
        one, other = at([1, 0, 0], [-2, 0, 0], [spin, 1, 2]), at([0, 0.05, 0.02], [0, 0, 0], [1, spin, -2])
        whole = cd.next_meeting(of_shape(union(parts)), one, of_shape(union(parts)), other, **PAIR)
        assert whole is not None
        alone = [
            cd.next_meeting(of_shape(mine), one, of_shape(theirs), other, horizon=0.5, **PAIR)
            for mine in parts
            for theirs in parts
        ]
        assert whole.seconds == pytest.approx(min(each.seconds for each in alone if each), abs=1e-9)


@seeds(range(6), slow=range(6, 300))
def test_divided_bodies_meet_as_whole_ones(seed: int) -> None:
    """Also at seams, which meet in every third draw, and in any order of the parts and the bodies."""
    rng = np.random.default_rng(seed)
    whole, parts = box(0.4, 0.2, 0.1), [box(0.2, 0.2, 0.1).moved([x, 0, 0]) for x in (-0.1, 0.1)]
    still = 0 if seed % 3 == 0 else 1
    q = Rotation.random(2, random_state=seed).as_quat() if still else [[0, 0, 0, 1]] * 2
    states = [
        cd.BodyState(
            p_WB_W=[x, *(still * rng.uniform(-0.1, 0.1, 2))],
            q_WB=turn,
            v_WB_W=[-2 * x, 0, 0],
            w_WB_W=still * rng.normal(size=3),
        )
        for x, turn in zip((-1, 1), q, strict=True)
    ]

    def meets(one: ConvexShape, other: ConvexShape, *, swapped: bool = False) -> cd.Meeting | None:
        pairs = [(of_shape(one), states[0]), (of_shape(other), states[1])]
        (body, state), (second, second_state) = pairs[::-1] if swapped else pairs
        return cd.next_meeting(body, state, second, second_state, horizon=1.0, **PAIR)

    expected = meets(whole, whole)
    for shapes in ((union(parts), whole), (whole, union(parts)), (union(parts), union(parts[::-1]))):
        for swapped in (False, True):
            found = meets(*shapes, swapped=swapped)
            assert (found is None) == (expected is None)
            if found is None or expected is None:
                continue
            assert found.seconds == pytest.approx(expected.seconds, abs=1e-9)
            points = [sorted(each.contacts.p_WC_W.round(6).tolist()) for each in (found, expected)]
            np.testing.assert_allclose(*points, atol=2e-6)
            sign = -1.0 if swapped else 1.0
            np.testing.assert_allclose(
                sign * found.contacts.normals_W[0], expected.contacts.normals_W[0], atol=1e-6
            )
