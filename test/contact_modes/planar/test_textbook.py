# SPDX-License-Identifier: Apache-2.0
"""Textbook problems of frictional contact in closed form, on both sides of each threshold.

Blocks on inclines and pushed or braked blocks, the ladder with a climber, the jamming diagram of a peg, two
fingers that grasp, lecture 26's rod against its mass distribution, and its relation of wrenches and
accelerations for a wrench in a tray. Others stand in `test_statics`.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import nnls

from contact_dynamics.contact_modes import (
    BodyStatics,
    Certainty,
    ModeVerdict,
    PlanarContactProblem,
    contact_modes,
    statics,
    wrench_sets,
)
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.plane.types import friction_cone
from contact_modes.evidence import planar_problem
from oracles.contact_mode_cases import contact, resting, rounded

G = 9.81
BODY = PlanarBody(mass=2.0, inertia=0.7)
WEIGHT = BODY.mass * G
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)
NEAR = 1e-6  # relative: how near a threshold is approached from both sides
frictions = st.floats(0.05, 2.0)
slopes = st.floats(0.05, 1.2)


def feet(width: float, height: float, friction: float) -> list[PlanarContact]:
    """The lower corners of a block, its centre of mass in its middle."""
    return [
        PlanarContact(r=(side * width / 2.0, -height / 2.0), normal=(0.0, 1.0), friction=friction)
        for side in (-1.0, 1.0)
    ]


def modes_of(
    contacts: list[PlanarContact], wrench: PlanarWrench, velocity: PlanarVelocity = AT_REST
) -> list[str]:
    return [mode.mode for mode in contact_modes(planar_problem(BODY, velocity, contacts, wrench)).modes]


def along_incline(slope: float, push: float = 0.0) -> PlanarWrench:
    """Weight and an uphill push through the centre of mass, in axes along the incline; downhill is -x."""
    return PlanarWrench(f=(push - WEIGHT * math.sin(slope), -WEIGHT * math.cos(slope)))


# --------------------------------------------------------------------------------------------- blocks


@given(frictions, st.floats(0.1, 3.0))
def test_a_block_on_a_rising_incline_does_what_comes_first(friction: float, aspect: float) -> None:
    assume(abs(friction - aspect) > 0.01)
    contacts = feet(aspect, 1.0, friction)
    threshold = math.atan(min(friction, aspect))
    assert modes_of(contacts, along_incline(threshold * (1.0 - NEAR))) == ["ff"]
    moves = modes_of(contacts, along_incline(threshold * (1.0 + NEAR)))
    assert moves == (["ll"] if friction < aspect else ["fs"])


@given(slopes, st.floats(0.05, 0.9))
def test_a_push_along_the_incline_holds_between_two_limits(slope: float, friction: float) -> None:
    # W (sin - mu cos) <= push <= W (sin + mu cos); a low and wide block does not tip.
    contacts = feet(20.0, 0.1, friction)
    slack = WEIGHT * friction * math.cos(slope)
    for side, slides in ((-1.0, "ll"), (1.0, "rr")):
        limit = WEIGHT * math.sin(slope) + side * slack
        assert modes_of(contacts, along_incline(slope, limit - side * NEAR * WEIGHT)) == ["ff"]
        assert modes_of(contacts, along_incline(slope, limit + side * NEAR * WEIGHT)) == [slides]


@given(st.floats(0.1, 2.0), st.floats(0.1, 2.0), st.floats(0.05, 1.0))
def test_a_sliding_block_is_braked_and_its_leading_foot_carries_more(
    half_base: float, centre_height: float, friction: float
) -> None:
    assume(friction * centre_height < 0.99 * half_base)
    contacts = feet(2.0 * half_base, 2.0 * centre_height, friction)
    down = PlanarWrench(f=(0.0, -WEIGHT))
    answer = contact_modes(planar_problem(BODY, PlanarVelocity(v=(3.0, 0.0), w=0.0), contacts, down))
    (mode,) = answer.modes
    assert mode.mode == "rr"
    assert mode.acceleration == pytest.approx((-friction * G, 0.0), abs=1e-9)
    shift = friction * centre_height / half_base
    (_, trailing), (_, leading) = mode.contact_forces
    assert leading == pytest.approx(0.5 * WEIGHT * (1.0 + shift), rel=1e-9)
    assert trailing == pytest.approx(0.5 * WEIGHT * (1.0 - shift), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("half_base", [0.3, 0.7])
def test_a_sliding_block_trips_where_friction_times_height_exceeds_its_half_base(half_base: float) -> None:
    friction = 0.5
    threshold = half_base / friction  # of the height of the centre of mass
    down, moving = PlanarWrench(f=(0.0, -WEIGHT)), PlanarVelocity(v=(3.0, 0.0), w=0.0)
    for height, expected in ((threshold * (1.0 - NEAR), "rr"), (threshold * (1.0 + NEAR), "sr")):
        contacts = feet(2.0 * half_base, 2.0 * height, friction)
        assert modes_of(contacts, down, moving) == [expected]
    # It turns over its leading foot, which goes on sliding: N = m g / (1 + m b (b - mu h) / I).
    height = 1.1 * threshold
    answer = contact_modes(planar_problem(BODY, moving, feet(2.0 * half_base, 2.0 * height, friction), down))
    (mode,) = answer.modes
    lever = half_base - friction * height
    load = WEIGHT / (1.0 + BODY.mass * half_base * lever / BODY.inertia)
    assert mode.contact_forces[1] == pytest.approx((-friction * load, load))
    assert mode.angular_acceleration == pytest.approx(load * lever / BODY.inertia)
    assert mode.angular_acceleration < 0.0


# --------------------------------------------------------------------------------------------- ladder


def ladder(angle: float, share: float, floor: float, wall: float) -> BodyStatics:
    """A light ladder of length 4 with a climber at a share of it; both the floor and the wall are rough."""
    x, y = math.cos(angle), math.sin(angle)
    below, above = 4.0 * share, 4.0 * (1.0 - share)
    contacts = [
        PlanarContact(r=(-below * x, -below * y), normal=(0.0, 1.0), friction=floor),
        PlanarContact(r=(above * x, above * y), normal=(-1.0, 0.0), friction=wall),
    ]
    return statics(PlanarContactProblem(body=BODY, contacts=contacts, wrench=PlanarWrench(f=(0.0, -WEIGHT))))


@given(st.floats(0.2, 1.0), st.floats(0.1, 1.0), st.floats(0.0, 1.0))
def test_a_ladder_holds_its_climber_above_an_angle(share: float, floor: float, wall: float) -> None:
    # Moments about the foot, both contacts slipping: s (1 + mu_f mu_w) = mu_f (tan(theta) + mu_w).
    tangent = (share * (1.0 + floor * wall) - floor * wall) / floor
    assume(tangent > 0.05)
    angle = math.atan(tangent)
    slips = ladder(angle - NEAR, share, floor, wall)
    assert slips.equilibrium == Certainty.NO
    assert math.isnan(slips.stable_disturbance)
    assert not slips.is_stable_against(0.0)
    stands = ladder(angle + NEAR, share, floor, wall)
    assert stands.equilibrium != Certainty.NO
    assert stands.jammed == stands.equilibrium, "without friction every ladder slips"
    assert not stands.wedged, "floor and wall do not face each other"


# ------------------------------------------------------------------------------------------------ peg

RADIUS, DEPTH, MU = 1.0, 3.0, 0.3
RATIO = DEPTH / (2.0 * RADIUS * MU)  # Whitney's lambda; above 1 a peg does not wedge
TIP_LEFT = PlanarContact(r=(-RADIUS, 0.0), normal=(1.0, 0.0), friction=MU)
TIP_RIGHT = PlanarContact(r=(RADIUS, 0.0), normal=(-1.0, 0.0), friction=MU)
RIM_LEFT = PlanarContact(r=(-RADIUS, DEPTH), normal=(1.0, 0.0), friction=MU)
RIM_RIGHT = PlanarContact(r=(RADIUS, DEPTH), normal=(-1.0, 0.0), friction=MU)
HOLDS = {
    "two points, leaning right": [TIP_LEFT, RIM_RIGHT],
    "two points, leaning left": [TIP_RIGHT, RIM_LEFT],
    "along the left wall": [TIP_LEFT, RIM_LEFT],
    "along the right wall": [TIP_RIGHT, RIM_RIGHT],
}


def jams(side: float, moment: float) -> set[str]:
    """In which states of contact a peg pushed down by 1 can be held, with the wrench given at its tip."""
    wrench = PlanarWrench(f=(side, -1.0), moment=moment)
    return {
        name
        for name, contacts in HOLDS.items()
        if statics(PlanarContactProblem(body=BODY, contacts=contacts, wrench=wrench)).equilibrium
        != Certainty.NO
    }


def test_the_jamming_diagram_is_simunovics_parallelogram() -> None:
    # Whitney 1982, figure 14: a peg slides in where |F_x / F_z| < 1 / mu and
    # |M / (r F_z) + mu (1 + lambda) F_x / F_z| < lambda, and can jam everywhere else.
    chance = np.random.default_rng(0)
    inside = 0
    for _ in range(400):
        side, moment = (float(x) for x in chance.uniform([-4.0, -12.0], [4.0, 12.0]))
        level = moment / RADIUS + MU * (1.0 + RATIO) * side
        slides = abs(side) < 1.0 / MU and abs(level) < RATIO
        assert (not jams(side, moment)) == slides, (side, moment)
        inside += slides
    assert 50 < inside < 350


@pytest.mark.parametrize("side", [-3.0, -1.0, 0.0, 1.5, 3.0])
def test_the_parallelograms_slanted_sides_are_two_point_contact(side: float) -> None:
    for sign, name in ((1.0, "two points, leaning left"), (-1.0, "two points, leaning right")):
        border = RADIUS * (sign * RATIO - MU * (1.0 + RATIO) * side)
        assert jams(side, border - sign * NEAR) == set()
        assert name in jams(side, border + sign * NEAR)


def test_the_held_wrenches_of_two_points_end_at_the_parallelograms_side() -> None:
    # M + mu r (1 + lambda) F_x - lambda r F_y' <= 0 with F_y' = -F_z is a half-space of the map's set.
    (held,) = [
        one
        for one in wrench_sets(
            PlanarContactProblem(
                body=BODY, contacts=HOLDS["two points, leaning right"], wrench=PlanarWrench(f=(0.0, 0.0))
            )
        )
        if one.mode == "ff"
    ]
    expected = np.array([MU * RADIUS * (1.0 + RATIO), -RATIO * RADIUS, 1.0])
    found = [np.array(side.a) / side.a[2] for side in held.half_spaces if side.a[2] > 0.0]
    assert any(np.allclose(row, expected, rtol=1e-12) for row in found)
    assert all(side.b == pytest.approx(0.0, abs=1e-12) for side in held.half_spaces)


# ---------------------------------------------------------------------------------------------- grasp


@given(
    st.floats(-1.4, 1.4),
    st.floats(-1.4, 1.4),
    st.floats(0.05, 2.0),
    st.floats(0.05, 2.0),
    st.floats(0.2, 3.0),
)
def test_two_fingers_close_a_grasp_where_their_line_is_in_both_cones(
    lean_one: float, lean_two: float, friction_one: float, friction_two: float, distance: float
) -> None:
    # Nguyen 1988. The fingers face each other along x, their normals lean off that line by two angles.
    margins = [math.atan(friction_one) - abs(lean_one), math.atan(friction_two) - abs(lean_two)]
    assume(min(abs(margin) for margin in margins) > 1e-6)
    fingers = [
        PlanarContact(
            r=(-distance, 0.3), normal=(math.cos(lean_one), math.sin(lean_one)), friction=friction_one
        ),
        PlanarContact(
            r=(distance, 0.3), normal=(-math.cos(lean_two), math.sin(lean_two)), friction=friction_two
        ),
    ]
    closes = min(margins) > 0.0
    held = statics(PlanarContactProblem(body=BODY, contacts=fingers, wrench=PlanarWrench(f=(0.0, 0.0))))
    assert held.wedged == closes
    assert math.isinf(held.stable_disturbance) == closes
    assert held.is_stable_against(1e9) == closes


# ----------------------------------------------------------------------------------------- lecture 26


def test_the_rod_is_inconsistent_below_a_moment_of_inertia() -> None:
    # Eq. 2, "violated by large values of mu, or small values of I": m = 1, l = 4, alpha = 30, theta = 75.
    alpha, theta, length = math.radians(30.0), math.radians(75.0), 4.0
    threshold = -(length**2) * math.cos(theta) / math.cos(alpha) * math.cos(alpha + theta)
    tip = PlanarContact(
        r=(-length * math.cos(theta), -length * math.sin(theta)), normal=(0.0, 1.0), friction=math.tan(alpha)
    )
    sliding, down = PlanarVelocity(v=(-1.0, 0.0), w=0.0), PlanarWrench(f=(0.0, -1.0))
    for inertia, verdict in (
        (threshold * (1.0 - NEAR), ModeVerdict.INCONSISTENT),
        (threshold * (1.0 + NEAR), ModeVerdict.UNIQUE),
    ):
        rod = PlanarBody(mass=1.0, inertia=inertia)
        assert contact_modes(planar_problem(rod, sliding, [tip], down)).verdict == verdict


@given(st.floats(0.3, 1.4), st.floats(0.05, 20.0), st.floats(0.2, 5.0))
def test_the_rod_along_its_wall_can_stay_from_a_friction_on(
    theta: float, inertia: float, length: float
) -> None:
    # The lecture's two equations in f_n and s = f_t / f_n, solved by hand:
    # s = (I + m l^2 cos^2) / (m l^2 sin cos), f_n = (m l)^2 g sin cos / (I + m l^2). It may always fall.
    mass, cosine, sine = 1.5, math.cos(theta), math.sin(theta)
    reach = mass * length**2
    ratio = (inertia + reach * cosine**2) / (reach * sine * cosine)
    assume(
        ratio < 20.0
    )  # at far more friction, rounding of the wrench moves the threshold by as much as NEAR
    load = mass * reach * G * sine * cosine / (inertia + reach)
    rod, sideways = PlanarBody(mass=mass, inertia=inertia), PlanarWrench(f=(-mass * G, 0.0))
    for friction, expected in ((ratio * (1.0 - NEAR), {"l"}), (ratio * (1.0 + NEAR), {"l", "f"})):
        tip = PlanarContact(r=(-length * cosine, -length * sine), normal=(0.0, 1.0), friction=friction)
        by_letter = {
            mode.mode: mode for mode in contact_modes(planar_problem(rod, AT_REST, [tip], sideways)).modes
        }
        assert set(by_letter) == expected
        assert by_letter["l"].contact_forces == ((0.0, 0.0),)
        if "f" in by_letter:
            assert by_letter["f"].contact_forces[0] == pytest.approx((ratio * load, load), rel=1e-9)


TRAY = (
    contact(-10, -2, (0, 1), "1/4"),
    contact(10, -2, (0, 1), "1/4"),
    contact(-12, 2, (1, 0), "1/4"),
    contact(12, 4, (-1, 0), "1/4"),
)


def test_wrenches_accelerations_and_contact_forces_are_related_as_the_lecture_says() -> None:
    """A wrench brings a mode about just where w + sum s_i c_i = s m a (lecture 26, "Extend relation")."""
    body, _, contacts, _ = rounded(resting(*TRAY))
    chance = np.random.default_rng(26)
    seen = set()
    for _ in range(300):
        f_x, f_y, moment = chance.normal(size=3) * [1.0, 1.0, 15.0]
        wrench = PlanarWrench(f=(float(f_x), float(f_y)), moment=float(moment))
        for mode in contact_modes(planar_problem(body, AT_REST, contacts, wrench)).modes:
            seen.add(mode.mode)
            edges = []
            for letter, touching in zip(mode.mode, contacts, strict=True):
                right, left = friction_cone(touching)
                edges += {"s": [], "l": [right], "r": [left], "f": [right, left]}[letter]
            (a_x, a_y), alpha = mode.acceleration, mode.angular_acceleration
            columns = [(body.mass * a_x, body.mass * a_y, body.inertia * alpha)]
            columns += [(-edge.f[0], -edge.f[1], -edge.moment) for edge in edges]
            applied = np.array([f_x, f_y, moment])
            residual = nnls(np.array(columns).T, applied)[1]
            assert residual <= 1e-9 * float(np.linalg.norm(applied))
    assert len(seen) >= 8
