# SPDX-License-Identifier: Apache-2.0
"""What cannot matter does not: order, mirror, units of mass, copies, contacts that leave."""

from __future__ import annotations

import math
import random
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.contact_modes import PlanarModeAnswer, contact_modes
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_modes.evidence import check_evidence, planar_problem
from oracles.contact_mode_cases import FloatCase, draw, rounded

cases = st.integers(0, 10**6).map(lambda seed: rounded(draw(seed, most_contacts=5)))


def ask(case: FloatCase) -> PlanarModeAnswer:
    return contact_modes(planar_problem(case[0], case[1], case[2], case[3]))


def strings(answer: PlanarModeAnswer) -> tuple[set[str], set[str]]:
    return set(answer.kinematic_modes), {mode.mode for mode in answer.modes}


@given(cases, st.floats(0.0, 7.0), st.randoms(use_true_random=False))
def test_copies_that_rounding_parts_are_copies_all_the_same(
    case: FloatCase, angle: float, chance: random.Random
) -> None:
    """The feet are those on both sides of a box's plane of motion, and the lower ones of an inclined face."""
    body, velocity, contacts, wrench = case
    c, s = math.cos(angle), math.sin(angle)
    near = [
        replace(one, r=(one.r[0] + 1e-16 * c, one.r[1] + 1e-16 * s), normal=one.normal) for one in contacts
    ]
    order = list(range(len(contacts)))
    chance.shuffle(order)
    answer, doubled = ask(case), ask((body, velocity, [*contacts, *(near[i] for i in order)], wrench))
    for found, expected in zip(strings(doubled), strings(answer), strict=True):
        assert found == {mode + "".join(mode[i] for i in order) for mode in expected}
    others = {mode.mode: mode for mode in doubled.modes}  # the order of consistent modes is not stated
    for one in answer.modes:
        other = others[one.mode + "".join(one.mode[i] for i in order)]
        assert other.motion_unique == one.motion_unique
        pressed = any(f_n > 1e-6 for _, f_n in one.contact_forces)
        assert other.forces_unique == (one.forces_unique and not pressed)


@given(cases, st.integers(10, 20))
def test_many_copies_of_all_contacts_repeat_the_letters(case: FloatCase, copies: int) -> None:
    """So that the cones have many rows, most of which change nothing."""
    body, velocity, contacts, wrench = case
    many = ask((body, velocity, contacts * copies, wrench))
    answer = ask(case)
    for found, expected in zip(strings(many), strings(answer), strict=True):
        assert found == {mode * copies for mode in expected}
    for one, other in zip(answer.modes, many.modes, strict=True):
        assert one.motion_unique == other.motion_unique
    check_evidence(many, body, velocity, contacts * copies, wrench)


@given(cases, st.floats(0.1, 10.0), st.integers(20, 60))
def test_many_feet_between_two_add_only_letters(case: FloatCase, width: float, count: int) -> None:
    body, _, contacts, wrench = case
    resting = PlanarVelocity(v=(0.0, 0.0), w=0.0)
    feet = [
        PlanarContact(r=(width * (2.0 * i / count - 1.0), -3.0), normal=(0.0, 1.0), friction=0.5)
        for i in range(count + 1)
    ]
    answer = ask((body, resting, [feet[0], feet[-1], *contacts], wrench))
    wider = ask((body, resting, [*feet, *contacts], wrench))
    for found, expected in zip(strings(wider), strings(answer), strict=True):
        assert {mode[0] + mode[count:] for mode in found} == expected
        assert len(found) == len(expected)
    check_evidence(wider, body, resting, [*feet, *contacts], wrench)


def test_noise_within_the_tolerance_does_not_move_a_resting_block() -> None:
    body = PlanarBody(mass=0.4, inertia=3e-4)
    contacts = [PlanarContact(r=(x, -0.05), normal=(0.0, 1.0), friction=0.18) for x in (-0.05, 0.0, 0.05)]
    weight = PlanarWrench(f=(0.0, -0.4 * 9.81))
    chance = random.Random(1)
    for _ in range(200):
        noisy = PlanarVelocity(
            v=(chance.uniform(-4e-3, 4e-3), chance.uniform(-4e-3, 4e-3)), w=chance.uniform(-0.05, 0.05)
        )
        answer = contact_modes(planar_problem(body, noisy, contacts, weight, velocity_tolerance=0.01))
        assert [mode.mode for mode in answer.modes] == ["fff"]
        assert answer.modes[0].motion_unique
        assert not answer.modes[0].forces_unique
