# SPDX-License-Identifier: Apache-2.0
"""Statics beside those of `test_textbook`: exactly at a limit, wedged, without contacts, in both metrics."""

from __future__ import annotations

import math

import pytest

from contact_dynamics.contact_modes import (
    Certainty,
    ModeVerdict,
    PlanarContactProblem,
    contact_modes,
    statics,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_modes.evidence import planar_problem

BODY = PlanarBody(mass=2.0, inertia=0.7)
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)


def test_the_slope_that_is_exactly_the_angle_of_friction_holds() -> None:
    feet = [PlanarContact(r=(x, -0.5), normal=(0.0, 1.0), friction=0.75) for x in (-1.0, 1.0)]
    answer = contact_modes(planar_problem(BODY, AT_REST, feet, PlanarWrench(f=(-3.0, -4.0))))
    assert [mode.mode for mode in answer.modes] == ["ff"]
    held = statics(PlanarContactProblem(body=BODY, contacts=feet, wrench=PlanarWrench(f=(-3.0, -4.0))))
    assert held.equilibrium == Certainty.CERTAIN
    assert held.stable_disturbance == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("friction", [0.1, 0.3, 0.6])
def test_a_shallow_peg_wedges(friction: float) -> None:
    # Whitney 1982: wedging is possible up to the depth mu d, when each contact lies in the other's cone.
    for depth, wedges in ((1.98 * friction, True), (2.02 * friction, False)):
        contacts = [
            PlanarContact(r=(-1.0, 0.0), normal=(1.0, 0.0), friction=friction),
            PlanarContact(r=(1.0, depth), normal=(-1.0, 0.0), friction=friction),
        ]
        shallow = statics(planar_problem(BODY, AT_REST, contacts, PlanarWrench(f=(0.0, -1.0))))
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
