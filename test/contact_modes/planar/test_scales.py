# SPDX-License-Identifier: Apache-2.0
"""Lever arms much longer and much shorter than the radius of gyration, beside exact trials of all strings.

Long ones end at a thousand radii for sets of any shape: what accelerates at ten thousand can be a difference
of terms 1e14 times its size, so that doubles do not say whether it is zero.
"""

from __future__ import annotations

import math
import random
from dataclasses import replace
from fractions import Fraction

import pytest

from contact_dynamics.contact_modes import (
    ModeVerdict,
    PlanarContactProblem,
    contact_modes,
    mode_margins,
    statics,
)
from contact_dynamics.errors import UndecidedError
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_modes.evidence import planar_problem
from oracles.contact_mode_cases import contact, draw, resting, rounded
from oracles.contact_modes import ExactCase, consistent_modes, kinematic_modes
from sweeps import seeds

# Fine enough for the angles between contact rows at these arms, and still far above rounding.
ACCURACY = 1e-13


def stretched(case: ExactCase, factor: Fraction) -> ExactCase:
    """Return the case with all contacts moved away from the centre of mass, or towards it; mass as it was.

    Velocities go with them, so that nothing approaches.
    """
    contacts = [replace(one, r=(one.r[0] * factor, one.r[1] * factor)) for one in case.contacts]
    return replace(case, contacts=tuple(contacts), v=(case.v[0] * factor, case.v[1] * factor))


def compare(seed: int, power: int, most_contacts: int) -> None:
    factor = Fraction(10) ** power
    exact = stretched(draw(seed, most_contacts), factor)
    if seed % 2:  # a wrench whose moment counts as much as its force does
        exact = replace(exact, moment=exact.moment * factor)
    kinematic = kinematic_modes(exact)
    answer = contact_modes(planar_problem(*rounded(exact), acceleration_tolerance=ACCURACY))
    assert set(answer.kinematic_modes) == kinematic
    assert {mode.mode for mode in answer.modes} == consistent_modes(exact, kinematic)


@pytest.mark.parametrize("power", [-5, -3, -1, 1, 3])
@seeds(range(10), slow=range(10, 300))
def test_long_and_short_arms(seed: int, power: int) -> None:
    compare(seed, power, most_contacts=4)


@pytest.mark.parametrize("power", [6, 7, 8, 9, 10])
@seeds((10, 62, 66, 90, 128, 207, 213, 220, 252, 286), slow=range(400))
def test_no_friction_up_to_the_limit_gives_a_wrong_verdict(seed: int, power: int) -> None:
    # Each of the first ten seeds had a wrong verdict at 1e9 or 1e10.
    exact = draw(seed, 4)
    grip = Fraction(10) ** power
    exact = replace(
        exact, contacts=tuple(replace(one, friction=one.friction * grip) for one in exact.contacts)
    )
    answer = contact_modes(planar_problem(*rounded(exact)))
    assert answer.verdict != ModeVerdict.IMPACT
    possible = {mode.mode for mode in answer.modes}
    true = consistent_modes(exact, kinematic_modes(exact))
    assert possible <= true <= possible.union(answer.undecided_modes)
    assert (answer.verdict == ModeVerdict.UNDECIDED) or possible == true


@pytest.mark.parametrize("reach", [Fraction(1, 1000), Fraction(1), Fraction(1000), Fraction(10**6)])
@pytest.mark.parametrize(("share", "rests"), [(Fraction(9, 10), True), (Fraction(11, 10), False)])
def test_a_body_on_two_feet_tips_where_its_weight_passes_a_foot(
    reach: Fraction, share: Fraction, *, rests: bool
) -> None:
    feet = [
        replace(foot, r=(foot.r[0] * reach, foot.r[1] * reach)) for foot in (contact(-1, -1), contact(1, -1))
    ]
    case = replace(resting(*feet), moment=-share * reach)
    answer = contact_modes(planar_problem(*rounded(case)))  # with the default tolerance
    assert ("ff" in {mode.mode for mode in answer.modes}) == rests
    assert {mode.mode for mode in answer.modes} == consistent_modes(case, kinematic_modes(case))


@seeds(range(60))
def test_numbers_of_any_size_give_finite_evidence(seed: int) -> None:
    chance = random.Random(seed)

    def number() -> float:
        if chance.random() < 0.4:
            return float(chance.randint(-2, 2))
        return chance.choice([-1.0, 1.0]) * 10.0 ** chance.uniform(-30.0, 30.0)

    angles = [chance.choice([0.0, 0.5 * math.pi, math.pi, chance.uniform(0.0, 7.0)]) for _ in range(2)]
    places = [(number(), number()) for _ in range(3)]
    contacts = []
    for _ in range(chance.choice([1, 2, 3, 5, 30])):
        angle = chance.choice(angles) + chance.choice([0.0, 1e-15, 1e-10, 1e-8])
        contacts.append(
            PlanarContact(
                r=chance.choice(places),
                normal=(-math.sin(angle), math.cos(angle)),
                friction=chance.choice([0.0, 0.5, abs(number()), 1e300]),
            )
        )
    body = PlanarBody(mass=10.0 ** chance.uniform(-30.0, 30.0), inertia=10.0 ** chance.uniform(-30.0, 30.0))
    velocity = PlanarVelocity(v=(0.0, 0.0), w=0.0)
    if chance.random() < 0.4:
        velocity = PlanarVelocity(v=(number(), number()), w=number())
    answer = contact_modes(
        planar_problem(body, velocity, contacts, PlanarWrench(f=(number(), number()), moment=number()))
    )
    for mode in answer.modes:
        pairs = (mode.acceleration, *mode.contact_forces, *mode.contact_accelerations)
        assert all(math.isfinite(x) and math.isfinite(y) for x, y in pairs)
        assert math.isfinite(mode.angular_acceleration)


@pytest.mark.parametrize("arm", [1e9, 1e30, 1e60])
def test_arms_beyond_the_domain_are_undecided_by_name(arm: float) -> None:
    feet = [PlanarContact(r=(x, -1.0), normal=(0.0, 1.0), friction=0.5) for x in (-arm, arm)]
    problem = PlanarContactProblem(
        body=PlanarBody(mass=1.0, inertia=1.0), contacts=feet, wrench=PlanarWrench(f=(0.0, -9.8))
    )
    answer = contact_modes(problem)
    assert (answer.verdict, answer.modes, answer.refused) == (ModeVerdict.UNDECIDED, (), ())
    assert "1e+08 radii of gyration" in answer.undecided
    assert mode_margins(problem) == ()
    with pytest.raises(UndecidedError, match="radii of gyration"):
        statics(problem)


@pytest.mark.parametrize("friction", [0.0, 1e-6, 1.0, 1e3, 1e6])
@pytest.mark.parametrize("arm", [1e-4, 1.0, 1e2, 1e4])
def test_a_block_of_any_arms_and_friction_slips_where_friction_ends(friction: float, arm: float) -> None:
    """The domain is friction to 1e6 and arms to 1e4. Friction is a hundredth too little, or enough."""
    feet = [
        PlanarContact(r=(side * arm, -1e-9 * arm), normal=(0.0, 1.0), friction=friction)
        for side in (-1.0, 1.0)
    ]
    for share, mode in ((0.99, "ff"), (1.01, "rr")):
        wrench = PlanarWrench(f=(share * friction if friction else share - 0.99, -1.0))
        answer = contact_modes(
            PlanarContactProblem(body=PlanarBody(mass=1.0, inertia=1.0), contacts=feet, wrench=wrench)
        )
        assert mode in {one.mode for one in answer.modes}
        assert answer.verdict in {ModeVerdict.UNIQUE, ModeVerdict.INDETERMINATE}
