# SPDX-License-Identifier: Apache-2.0
"""Verdicts within an uncertainty of contacts in space: proofs against samples, margins against formulas."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.contact import ContactSet, ContactUncertainty
from contact_dynamics.contact_modes import ModeVerdict, SpatialContactProblem, contact_modes, geometry_margins
from contact_dynamics.contact_modes.spatial.uncertain import no_other_mode
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import check_proofs, spatial_problem

BODY = MassProperties(mass=1.0, I_B=np.diag([0.0043, 0.0043, 0.0053]))
FRICTION = 0.5
WEIGHT = 9.8
HEIGHT = 0.1
TRIPOD = [(0.1, 0.0), (-0.05, 0.0866), (-0.05, -0.0866)]
SQUARE = [(x, y) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]


def state(**fields: tuple[float, float, float]) -> BodyState:
    return BodyState(
        p_WB_W=(0.0, 0.0, HEIGHT), q_WB=(0.0, 0.0, 0.0, 1.0), v_WB_W=fields.get("v_WB_W", (0.0, 0.0, 0.0))
    )


def on_feet(
    places: list[tuple[float, float]],
    push: tuple[float, float] = (0.0, 0.0),
    box: ContactUncertainty | None = None,
) -> SpatialContactProblem:
    feet = ContactSet(p_WC_W=[(x, y, 0.0) for x, y in places], normals_W=(0.0, 0.0, 1.0), frictions=FRICTION)
    return spatial_problem(BODY, state(), feet, (*push, -WEIGHT), uncertainty=box or ContactUncertainty())


def drawn(chance: np.random.Generator) -> SpatialContactProblem:
    """Return one to three contacts anywhere, or up to four feet on a floor, under any load."""
    on_floor = chance.random() < 0.6
    n = int(chance.integers(1, 5 if on_floor else 4))
    points, normals = chance.uniform(-1.0, 1.0, (n, 3)), chance.normal(size=(n, 3))
    if on_floor:
        points[:, 2], normals = -1.0, np.tile([0.0, 0.0, 1.0], (n, 1))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    contacts = ContactSet(p_WC_W=points, normals_W=normals, frictions=chance.uniform(0.0, 1.2, n))
    body = MassProperties(
        mass=1.0, I_B=np.diag(chance.uniform(0.6, 1.0, 3)) * 10.0 ** chance.uniform(-1.0, 1.0)
    )
    return spatial_problem(
        body,
        BodyState(p_WB_W=np.zeros(3), q_WB=(0.0, 0.0, 0.0, 1.0)),
        contacts,
        (*chance.uniform(-3.0, 3.0, 2), chance.uniform(-10.0, 1.0)),
        chance.uniform(-1.0, 1.0, 3),
    )


def moved(
    problem: SpatialContactProblem, box: ContactUncertainty, chance: np.random.Generator
) -> SpatialContactProblem:
    """Return a problem in the box: at its border, or anywhere in it."""
    points, normals, frictions = [], [], []
    for contact, sizes in zip(problem.contacts, box.of_each(len(problem.contacts)), strict=True):
        share = [chance.choice([1.0, chance.uniform(0.0, 1.0)]) for _ in range(3)]
        step, turn, less = (size * part for size, part in zip(sizes, share, strict=True))
        way, axis = chance.normal(size=3), np.cross(contact.normal_W, chance.normal(size=3))
        axis /= np.linalg.norm(axis)
        points.append(contact.p_WC_W + step * way / np.linalg.norm(way))
        normals.append(math.cos(turn) * contact.normal_W + math.sin(turn) * np.cross(axis, contact.normal_W))
        frictions.append(max(0.0, contact.friction + less * chance.choice([-1.0, 1.0])))
    contacts = ContactSet(p_WC_W=points, normals_W=normals, frictions=frictions)
    return replace(problem, contacts=contacts, uncertainty=ContactUncertainty())


def boxed(seed: int) -> tuple[SpatialContactProblem, Callable[[], SpatialContactProblem]]:
    """Return a problem with an uncertainty, and what draws problems within it."""
    chance = np.random.default_rng(seed)
    box = ContactUncertainty(
        points=10.0 ** chance.uniform(-14.0, -2.0),
        normals=10.0 ** chance.uniform(-14.0, -2.0),
        frictions=10.0 ** chance.uniform(-14.0, -2.0),
    )
    problem = replace(drawn(chance), uncertainty=box)
    return problem, lambda: moved(problem, box, chance)


def test_what_is_certain_holds_at_every_sample() -> None:
    assert check_proofs(map(boxed, range(9)), samples=4) >= 6


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_what_is_certain_holds_at_many_samples(block: int) -> None:
    assert check_proofs(map(boxed, range(1000 + 15 * block, 1015 + 15 * block)), samples=60) > 0


@pytest.mark.parametrize("push", [(0.0, 0.0), (3.0, 1.0), (6.0, 1.0)])
def test_a_tripod_is_sure_of_its_mode_within_a_tenth_of_a_milliradian(push: tuple[float, float]) -> None:
    answer = contact_modes(
        on_feet(TRIPOD, push, ContactUncertainty(points=1e-5, normals=1e-4, frictions=1e-3))
    )
    assert answer.within is not None
    assert answer.within.certain
    assert answer.within.verdicts == (ModeVerdict.UNIQUE,)
    assert answer.within.modes == (answer.modes[0].mode,)


def test_a_pushed_box_holds_where_an_eighth_of_friction_is_not_known() -> None:
    """It slips if friction falls by 0.2. With SciPy's linear programs this was not proven."""
    feet = ContactSet(
        p_WC_W=[(x, y, -0.5) for x in (-0.5, 0.5) for y in (-0.5, 0.5)],
        normals_W=(0.0, 0.0, 1.0),
        frictions=0.5,
    )
    problem = spatial_problem(
        MassProperties(mass=1.0, I_B=np.diag([0.1, 0.12, 0.15])),
        replace(state(), p_WB_W=np.zeros(3)),
        feet,
        (3.0, 0.0, -10.0),
    )
    assert no_other_mode(problem, "ffff", ContactUncertainty(frictions=0.125))
    assert not no_other_mode(problem, "ffff", ContactUncertainty(frictions=0.21))


def test_a_proof_fails_where_more_friction_would_hold_the_tripod() -> None:
    """It slides, and would stick if friction rose to push / weight."""
    problem = on_feet(TRIPOD, (6.0, 0.0))
    gained = 6.0 / WEIGHT - FRICTION
    assert no_other_mode(problem, "ccc", ContactUncertainty(frictions=0.6 * gained))
    assert not no_other_mode(problem, "ccc", ContactUncertainty(frictions=1.001 * gained))


def test_each_contact_may_have_its_own_uncertainty() -> None:
    """One foot of friction that is hardly known lets the tripod slip, unless it is the one that is off."""
    problem = on_feet(TRIPOD, (3.0, 0.0))
    assert no_other_mode(problem, "fff", ContactUncertainty(frictions=(0.0, 0.0, 0.1)))
    assert not no_other_mode(problem, "fff", ContactUncertainty(frictions=(0.5, 0.5, 0.1)))
    with pytest.raises(InvalidFieldError, match="each of 3 contacts"):
        replace(problem, uncertainty=ContactUncertainty(points=(1e-3, 1e-3)))


def test_two_modes_that_hold_everywhere_leave_the_verdict_indeterminate() -> None:
    theta = math.radians(75.0)
    tip = ContactSet(
        p_WC_W=[(-4.0 * math.cos(theta), 0.0, -4.0 * math.sin(theta))],
        normals_W=(0.0, 0.0, 1.0),
        frictions=0.8,
    )
    problem = spatial_problem(
        MassProperties(mass=1.0, I_B=np.eye(3)),
        replace(state(), p_WB_W=np.zeros(3)),
        tip,
        (-1.0, 0.0, 0.05),
        uncertainty=ContactUncertainty(points=1e-3, normals=1e-3, frictions=1e-3),
    )
    answer = contact_modes(problem)
    assert answer.verdict == ModeVerdict.INDETERMINATE
    assert {"s", "f"} <= {mode.mode for mode in answer.modes}
    assert answer.within is not None
    assert answer.within.certain


def test_a_moving_body_has_samples_only() -> None:
    box = ContactUncertainty(frictions=1e-3)
    within = contact_modes(replace(on_feet(TRIPOD, box=box), state=state(v_WB_W=(1.0, 0.0, 0.0)))).within
    assert within is not None
    assert not within.certain
    assert within.verdicts == (ModeVerdict.UNIQUE,)


def test_exact_contacts_are_not_asked_about() -> None:
    assert contact_modes(on_feet(TRIPOD)).within is None


def test_four_feet_that_slide_may_do_so_in_many_ways_but_never_in_none() -> None:
    """They slide together only if they lie exactly in a plane. Rounding once left no mode at all."""
    within = contact_modes(on_feet(SQUARE, (6.0, 1.0), ContactUncertainty(normals=1e-6))).within
    assert within is not None
    assert not within.certain
    assert "cccc" in within.modes
    assert len(within.modes) > 1
    assert ModeVerdict.INCONSISTENT not in within.verdicts


def test_margins_bracket_the_angle_and_the_friction_at_which_a_tripod_slips() -> None:
    """It slips where the floor turns by atan(mu) - atan(push / weight), or mu falls to push / weight."""
    push = 3.0
    points, normals, frictions = geometry_margins(on_feet(TRIPOD, (push, 0.0)))
    assert [points.kind, normals.kind, frictions.kind] == ["points", "normals", "frictions"]
    angle = math.atan(FRICTION) - math.atan(push / WEIGHT)
    assert 0.1 * angle < normals.holds_within <= angle <= normals.changes_at < 3.0 * angle
    assert normals.modes_beyond == ("ccc",)
    lost = FRICTION - push / WEIGHT
    assert 0.4 * lost < frictions.holds_within <= lost <= frictions.changes_at < 2.0 * lost
    assert 0.0 < points.holds_within < points.changes_at
    chance = np.random.default_rng(0)
    for one in (points, normals, frictions):  # just below the margin nothing changes
        box = ContactUncertainty(**{one.kind: 0.999 * one.holds_within})
        for _ in range(5):
            assert contact_modes(moved(on_feet(TRIPOD, (push, 0.0)), box, chance)).modes[0].mode == "fff"
