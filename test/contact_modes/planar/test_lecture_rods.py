# SPDX-License-Identifier: Apache-2.0
"""Lecture 26's two rods, with the worked numbers of the project's physics page."""

from __future__ import annotations

import math

import pytest

from contact_dynamics.contact_modes import ModeVerdict, PlanarModeAnswer, Refusal, contact_modes
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_modes.evidence import planar_problem

LENGTH = 4.0
THETA = math.radians(75.0)
ROD = PlanarBody(mass=1.0, inertia=1.0)
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)
TO_THE_LEFT = PlanarVelocity(v=(-1.0, 0.0), w=0.0)
DOWN = PlanarWrench(f=(0.0, -1.0))
SIDEWAYS = PlanarWrench(f=(-1.0, 0.0))
PRINTED = 5e-8  # the worked numbers are printed to seven or six decimals


def rod_tip(friction: float) -> PlanarContact:
    r = (-LENGTH * math.cos(THETA), -LENGTH * math.sin(THETA))
    return PlanarContact(r=r, normal=(0.0, 1.0), friction=friction)


def ask(velocity: PlanarVelocity, wrench: PlanarWrench, friction: float) -> PlanarModeAnswer:
    return contact_modes(planar_problem(ROD, velocity, [rod_tip(friction)], wrench))


def test_no_mode_of_the_sliding_rod_is_consistent() -> None:
    answer = ask(TO_THE_LEFT, DOWN, math.tan(math.radians(30.0)))
    assert answer.verdict == ModeVerdict.INCONSISTENT
    assert answer.modes == ()
    separating, sliding = answer.refused
    assert (separating.mode, separating.refusal) == ("s", Refusal.PENETRATES)
    assert separating.amount == pytest.approx(-1.0)
    assert (sliding.mode, sliding.refusal) == ("l", Refusal.NO_SOLUTION)
    assert sliding.amount == pytest.approx(-0.2376043, abs=PRINTED)


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.5179491])
def test_below_the_threshold_the_rod_slides_left(friction: float) -> None:
    answer = ask(TO_THE_LEFT, DOWN, friction)
    assert answer.verdict == ModeVerdict.UNIQUE
    (mode,) = answer.modes
    assert mode.mode == "l"
    ((f_t, f_n),) = mode.contact_forces
    # Lecture 26, eq. 2.
    alpha = math.atan(friction)
    factor = 1.0 + LENGTH**2 * math.cos(THETA) / math.cos(alpha) * math.cos(alpha + THETA)
    assert f_n == pytest.approx(1.0 / factor, rel=1e-6)
    assert f_t == pytest.approx(friction * f_n)


@pytest.mark.parametrize("friction", [0.5179493, 0.6, 2.0])
def test_above_the_threshold_nothing_is_consistent(friction: float) -> None:
    assert ask(TO_THE_LEFT, DOWN, friction).verdict == ModeVerdict.INCONSISTENT


def test_at_the_threshold_a_pressed_rod_has_no_solution() -> None:
    r_t, r_n = LENGTH * math.cos(THETA), LENGTH * math.sin(THETA)
    threshold = (1.0 + r_t**2) / (r_t * r_n)
    assert threshold == pytest.approx(0.5179492, abs=PRINTED)
    answer = ask(TO_THE_LEFT, DOWN, threshold)
    assert answer.verdict == ModeVerdict.INCONSISTENT
    assert answer.refused[1].refusal == Refusal.NO_SOLUTION


def test_the_rod_along_the_wall_falls_or_stays() -> None:
    answer = ask(AT_REST, SIDEWAYS, math.tan(math.radians(30.0)))
    assert answer.verdict == ModeVerdict.INDETERMINATE
    falling, fixed = answer.modes
    assert falling.mode == "l"
    assert falling.contact_forces == ((0.0, 0.0),)
    assert falling.contact_accelerations == ((-1.0, 0.0),)
    assert fixed.mode == "f"
    ((f_t, f_n),) = fixed.contact_forces
    assert f_n == pytest.approx(0.235294, abs=5e-7)
    assert f_t == pytest.approx(0.121870, abs=5e-7)
    assert f_t / f_n == pytest.approx(0.518, abs=5e-4)
    separating = answer.refused[0]
    assert (separating.mode, separating.refusal, separating.amount) == ("s", Refusal.WRONG_MOTION, 0.0)


def test_with_little_friction_the_rod_only_falls() -> None:
    answer = ask(AT_REST, SIDEWAYS, 0.5)
    assert answer.verdict == ModeVerdict.UNIQUE
    assert answer.modes[0].mode == "l"
    assert answer.refused[-1].mode == "f"
    assert answer.refused[-1].refusal == Refusal.OUTSIDE_CONE
