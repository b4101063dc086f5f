# SPDX-License-Identifier: Apache-2.0
"""One contact: every row of lecture 26's table, with its strictness."""

from __future__ import annotations

import pytest

from contact_dynamics.contact_modes import ModeVerdict, PlanarModeAnswer, Refusal, contact_modes
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_modes.evidence import planar_problem

BODY = PlanarBody(mass=2.0, inertia=0.5)
BELOW = PlanarContact(r=(0.0, -0.5), normal=(0.0, 1.0), friction=0.5)
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)


def ask(
    *,
    v: tuple[float, float] = (0.0, 0.0),
    w: float = 0.0,
    f: tuple[float, float] = (0.0, -10.0),
    moment: float = 0.0,
) -> PlanarModeAnswer:
    return contact_modes(
        planar_problem(BODY, PlanarVelocity(v=v, w=w), [BELOW], PlanarWrench(f=f, moment=moment))
    )


def letters(answer: PlanarModeAnswer) -> list[str]:
    return [mode.mode for mode in answer.modes]


def test_an_approaching_contact_is_an_impact() -> None:
    answer = ask(v=(0.0, -0.1))
    assert answer.verdict == ModeVerdict.IMPACT
    assert answer.approaching == (0,)
    assert answer.modes == ()
    assert answer.kinematic_modes == ()


def test_no_contact_is_free_motion() -> None:
    answer = contact_modes(planar_problem(BODY, AT_REST, [], PlanarWrench(f=(4.0, 2.0), moment=1.0)))
    assert (answer.verdict, letters(answer)) == (ModeVerdict.UNIQUE, [""])
    assert answer.modes[0].acceleration == (2.0, 1.0)
    assert answer.modes[0].angular_acceleration == 2.0


def test_pulled_away_it_separates() -> None:
    answer = ask(f=(0.0, 10.0))
    assert (answer.verdict, letters(answer)) == (ModeVerdict.UNIQUE, ["s"])
    assert answer.modes[0].contact_accelerations == ((0.0, 5.0),)
    assert {refused.mode: refused.refusal for refused in answer.refused} == {
        "l": Refusal.PULLS,
        "r": Refusal.PULLS,
        "f": Refusal.PULLS,
    }


@pytest.mark.parametrize(("f", "mode"), [((-1.0, 0.0), "l"), ((1.0, 0.0), "r"), ((0.0, 0.0), "f")])
def test_without_normal_force_it_skims_or_stays(f: tuple[float, float], mode: str) -> None:
    answer = ask(f=f)
    assert (answer.verdict, letters(answer)) == (ModeVerdict.UNIQUE, [mode])
    assert answer.modes[0].contact_forces == ((0.0, 0.0),)
    assert answer.refused[0].mode == "s"
    assert answer.refused[0].refusal == Refusal.WRONG_MOTION


def test_velocity_within_the_tolerance_counts_as_zero() -> None:
    noisy = PlanarVelocity(v=(0.004, -0.009), w=0.0)
    wrench = PlanarWrench(f=(0.0, -10.0))
    exact = contact_modes(planar_problem(BODY, noisy, [BELOW], wrench))
    assert exact.verdict == ModeVerdict.IMPACT
    measured = contact_modes(planar_problem(BODY, noisy, [BELOW], wrench, velocity_tolerance=0.01))
    assert letters(measured) == ["f"]
    assert measured.contact_velocities == ((0.0, 0.0),)
    assert measured.velocity_tolerance == 0.01
