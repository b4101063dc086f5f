# SPDX-License-Identifier: Apache-2.0
"""Textbook statics in closed form: incline, ladder, two-finger grasp, peg in a hole."""

from __future__ import annotations

import math

import pytest

from contact_dynamics.contact_modes import (
    BodyStatics,
    Certainty,
    ModeVerdict,
    PlanarContactProblem,
    contact_modes,
    statics,
)
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_modes.evidence import planar_problem

BODY = PlanarBody(mass=2.0, inertia=0.7)
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)
G = 9.81
NEAR = 1e-6  # how near a threshold is approached from both sides


def on_incline(slope: float, friction: float, width: float, height: float) -> tuple[list, PlanarWrench]:
    """Return contacts and weight of a block, in axes along the incline; downhill is -x."""
    feet = [
        PlanarContact(r=(side * width / 2.0, -height / 2.0), normal=(0.0, 1.0), friction=friction)
        for side in (-1.0, 1.0)
    ]
    weight = BODY.mass * G
    return feet, PlanarWrench(f=(-weight * math.sin(slope), -weight * math.cos(slope)))


def modes_on_incline(slope: float, friction: float, width: float, height: float) -> list[str]:
    answer = contact_modes(planar_problem(BODY, AT_REST, *on_incline(slope, friction, width, height)))
    return [mode.mode for mode in answer.modes]


@pytest.mark.parametrize("friction", [0.1, 0.5, 0.9])
def test_a_low_block_slides_above_the_angle_of_friction(friction: float) -> None:
    slope = math.atan(friction)
    assert modes_on_incline(slope - NEAR, friction, 2.0, 1.0) == ["ff"]
    assert modes_on_incline(slope + NEAR, friction, 2.0, 1.0) == ["ll"]
    steep = 0.8
    answer = contact_modes(planar_problem(BODY, AT_REST, *on_incline(steep, 0.5, 2.0, 0.5)))
    downhill = G * (math.sin(steep) - 0.5 * math.cos(steep))
    assert answer.modes[0].acceleration == pytest.approx((-downhill, 0.0))


@pytest.mark.parametrize(("width", "height"), [(1.0, 2.0), (1.0, 4.0), (0.3, 1.0)])
def test_a_tall_block_tips_when_its_weight_leaves_its_base(width: float, height: float) -> None:
    slope = math.atan(width / height)
    assert modes_on_incline(slope - NEAR, 2.0, width, height) == ["ff"]
    assert modes_on_incline(slope + NEAR, 2.0, width, height) == ["fs"]
    # It turns about the lower foot with the moment of its weight about it.
    feet, weight = on_incline(slope + 0.1, 2.0, width, height)
    (tipping,) = contact_modes(planar_problem(BODY, AT_REST, feet, weight)).modes
    x, y = feet[0].r
    moment = -(x * weight.f[1] - y * weight.f[0])
    assert tipping.angular_acceleration == pytest.approx(
        moment / (BODY.inertia + BODY.mass * (x * x + y * y))
    )


def test_the_slope_that_is_exactly_the_angle_of_friction_holds() -> None:
    feet = [PlanarContact(r=(x, -0.5), normal=(0.0, 1.0), friction=0.75) for x in (-1.0, 1.0)]
    answer = contact_modes(planar_problem(BODY, AT_REST, feet, PlanarWrench(f=(-3.0, -4.0))))
    assert [mode.mode for mode in answer.modes] == ["ff"]
    held = statics(PlanarContactProblem(body=BODY, contacts=feet, wrench=PlanarWrench(f=(-3.0, -4.0))))
    assert held.equilibrium == Certainty.CERTAIN
    assert held.stable_disturbance == pytest.approx(0.0, abs=1e-12)


def ladder(angle: float, floor: float, wall: float) -> BodyStatics:
    """Return the statics of a uniform ladder of length 4 under its weight; the wall is at its right."""
    x, y = 2.0 * math.cos(angle), 2.0 * math.sin(angle)
    contacts = [
        PlanarContact(r=(-x, -y), normal=(0.0, 1.0), friction=floor),
        PlanarContact(r=(x, y), normal=(-1.0, 0.0), friction=wall),
    ]
    return statics(
        PlanarContactProblem(body=BODY, contacts=contacts, wrench=PlanarWrench(f=(0.0, -BODY.mass * G)))
    )


@pytest.mark.parametrize("floor", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("wall", [0.0, 0.3, 0.7])
def test_a_ladder_stands_above_its_angle(floor: float, wall: float) -> None:
    # Textbook: tan(theta) = (1 - mu_floor mu_wall) / (2 mu_floor).
    angle = math.atan((1.0 - floor * wall) / (2.0 * floor))
    assert ladder(angle - NEAR, floor, wall).equilibrium == Certainty.NO
    stands = ladder(angle + NEAR, floor, wall)
    assert stands.equilibrium != Certainty.NO
    assert stands.jammed == stands.equilibrium, "without friction every ladder slips"
    assert math.isnan(ladder(angle - NEAR, floor, wall).stable_disturbance)
    assert not ladder(angle - NEAR, floor, wall).is_stable_against(0.0)


@pytest.mark.parametrize("friction", [0.2, 0.5, 1.0])
def test_two_fingers_hold_when_the_line_between_them_is_in_both_cones(friction: float) -> None:
    # Nguyen 1988: force closure in the plane.
    nothing = PlanarWrench(f=(0.0, 0.0))
    for offset, holds in ((0.99 * friction, True), (1.01 * friction, False)):
        fingers = [
            PlanarContact(r=(-1.0, -offset), normal=(1.0, 0.0), friction=friction),
            PlanarContact(r=(1.0, offset), normal=(-1.0, 0.0), friction=friction),
        ]
        held = statics(PlanarContactProblem(body=BODY, contacts=fingers, wrench=nothing))
        assert held.wedged == holds
        assert math.isinf(held.stable_disturbance) == holds
        assert held.is_stable_against(1e9) == holds


def peg(
    f_x: float, f_z: float, moment: float, *, depth: float, radius: float, friction: float
) -> BodyStatics:
    """Return the statics of a peg in a hole in two-point contact, with the wrench given at its tip.

    The peg points down; its tip's left corner touches the left wall, the hole's right rim touches its right
    side at height ``depth``. The centre of mass is put at the tip, where Whitney measures the wrench.
    """
    contacts = [
        PlanarContact(r=(-radius, 0.0), normal=(1.0, 0.0), friction=friction),
        PlanarContact(r=(radius, depth), normal=(-1.0, 0.0), friction=friction),
    ]
    return statics(
        PlanarContactProblem(body=BODY, contacts=contacts, wrench=PlanarWrench(f=(f_x, -f_z), moment=moment))
    )


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_the_jamming_diagram_of_a_peg(friction: float) -> None:
    # Whitney 1982, two-point contact: the wrenches at the tip that friction balances, found by hand below.
    radius, depth, push = 1.0, 3.0, 1.0
    for f_x in (-4.0, -1.0, 0.0, 1.0, 4.0):
        for moment in (-9.3, -4.1, -1.2, 0.0, 1.3, 4.2, 9.1):
            # Forces: f_x + N1 - N2 = 0; -push + T1 + T2 = 0; moment - r T1 + r T2 + depth N2 = 0.
            held = peg(f_x, push, moment, depth=depth, radius=radius, friction=friction)
            assert (held.equilibrium != Certainty.NO) == peg_holds(
                f_x, push, moment, depth=depth, radius=radius, friction=friction
            )
            if held.equilibrium != Certainty.NO:
                assert held.jammed == held.equilibrium, "a smooth peg slides in"


def peg_holds(
    f_x: float, push: float, moment: float, *, depth: float, radius: float, friction: float
) -> bool:
    """Balance by hand: N2 is free, N1 = N2 - f_x, T1 - T2 = (moment + depth N2) / r, T1 + T2 = push.

    Every bound is linear in N2, so that the allowed N2 are an interval.
    """
    low, high = max(0.0, f_x), math.inf
    # T1 = (push + (moment + depth N2) / r) / 2 within mu (N2 - f_x); T2 = (push - ...) / 2 within mu N2.
    bounds = []
    for sign in (1.0, -1.0):
        bounds.append(
            (sign * depth / radius / 2.0 - friction, -friction * f_x - sign * (push + moment / radius) / 2.0)
        )
        bounds.append((-sign * depth / radius / 2.0 - friction, -sign * (push - moment / radius) / 2.0))
    for slope, limit in bounds:  # slope N2 <= limit
        if slope > 0.0:
            high = min(high, limit / slope)
        elif slope < 0.0:
            low = max(low, limit / slope)
        elif limit < 0.0:
            return False
    return low <= high


@pytest.mark.parametrize("friction", [0.1, 0.3, 0.6])
def test_a_shallow_peg_wedges(friction: float) -> None:
    # Whitney 1982: wedging is possible up to the depth mu d, when each contact lies in the other's cone.
    for depth, wedges in ((1.98 * friction, True), (2.02 * friction, False)):
        shallow = peg(0.0, 1.0, 0.0, depth=depth, radius=1.0, friction=friction)
        assert shallow.wedged == wedges
        if wedges:
            assert shallow.equilibrium != Certainty.NO


def test_no_contact_holds_nothing_but_no_wrench() -> None:
    falling = statics(PlanarContactProblem(body=BODY, contacts=[], wrench=PlanarWrench(f=(0.0, -1.0))))
    assert falling.equilibrium == Certainty.NO
    floating = statics(PlanarContactProblem(body=BODY, contacts=[], wrench=PlanarWrench(f=(0.0, 0.0))))
    assert floating.equilibrium == Certainty.CERTAIN
    assert floating.stable_disturbance == 0.0
    assert not floating.wedged


def test_a_rod_against_a_wall_may_stay_or_fall() -> None:
    theta = math.radians(75.0)
    tip = PlanarContact(
        r=(-4.0 * math.cos(theta), -4.0 * math.sin(theta)),
        normal=(0.0, 1.0),
        friction=math.tan(math.pi / 6.0),
    )
    body, sideways = PlanarBody(mass=1.0, inertia=1.0), PlanarWrench(f=(-1.0, 0.0))
    held = statics(PlanarContactProblem(body=body, contacts=[tip], wrench=sideways))
    # The fixed rod of lecture 26 swings about its tip: it does not stay at rest.
    assert held.equilibrium == Certainty.NO
    assert contact_modes(planar_problem(body, AT_REST, [tip], sideways)).verdict == ModeVerdict.INDETERMINATE


def test_disturbance_of_a_block_in_both_metrics() -> None:
    feet = [PlanarContact(r=(x, -1.0), normal=(0.0, 1.0), friction=0.5) for x in (-0.5, 0.5)]
    weight = PlanarWrench(f=(0.0, -20.0))
    long = statics(PlanarContactProblem(body=BODY, contacts=feet, wrench=weight), margin_length=1e3)
    assert long.stable_disturbance == pytest.approx(20.0 * 0.5 / 1e3, rel=1e-5)
    assert long.is_stable_against(0.00999)
    assert not long.is_stable_against(0.01001)
    assert long.margin_length == 1e3
    assert (
        statics(PlanarContactProblem(body=BODY, contacts=feet, wrench=weight)).margin_length
        == BODY.radius_of_gyration
    )
    assert long.jammed == Certainty.NO, "a block on a level floor needs no friction"
    with pytest.raises(InvalidFieldError, match="margin_length"):
        statics(PlanarContactProblem(body=BODY, contacts=feet, wrench=weight), margin_length=-1.0)
