# SPDX-License-Identifier: Apache-2.0
"""Why contacting and separating strings in space are refused: closed forms, and the margin of what holds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties
from contact_dynamics.contact_modes import (
    Refusal,
    RefusedMode,
    contact_modes,
    refused_modes,
    spatial_kinematic_modes,
)
from contact_modes.evidence import spatial_problem
from sweeps import seeds

MASS, WEIGHT, HEIGHT = 2.0, 20.0, 0.2
BODY = MassProperties(mass=MASS, I_B=np.diag([0.3, 0.4, 0.5]))
LENGTH = math.sqrt(1.2 / (3.0 * MASS))  # the radius of gyration, root mean square


def state(v: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> BodyState:
    return BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=np.array(v))


def on_floor(corners: list[tuple[float, float]], friction: float) -> ContactSet:
    n = len(corners)
    return ContactSet(
        p_WC_W=np.column_stack([np.array(corners), np.full(n, -HEIGHT)]),
        normals_W=[0.0, 0.0, 1.0],
        frictions=friction,
    )


def refused(
    contacts: ContactSet, wrench: np.ndarray, now: BodyState | None = None, facets: int = 16
) -> dict[str, RefusedMode]:
    """Return the refusals by their strings, which with the consistent ones are all, each once."""
    now = now or state()
    force, torque = wrench[:3], wrench[3:]
    problem = spatial_problem(BODY, now, contacts, force, torque, friction_facets=facets)
    answer = contact_modes(problem)
    found = refused_modes(problem, answer)
    consistent = {mode.mode.replace("f", "c") for mode in answer.modes}
    strings = [one.mode for one in found]
    assert not consistent & set(strings)
    if not answer.approaching:
        assert sorted([*consistent, *strings]) == sorted(spatial_kinematic_modes(now, contacts))
    return {one.mode: one for one in found}


BOX = [(-1.0, -0.5), (1.0, -0.5), (1.0, 0.5), (-1.0, 0.5)]


def test_how_far_a_box_that_rests_is_from_tipping() -> None:
    friction = 0.9
    contacts, wrench = on_floor(BOX, friction), np.array([0.0, 0.0, -WEIGHT, 0.0, 0.0, 0.0])
    found = refused(contacts, wrench)
    for string, half in (("ccss", 0.5), ("sscc", 0.5), ("sccs", 1.0), ("cssc", 1.0)):
        # Friction that pushes at the edge, while it slides, takes its part of the moment of the load there.
        arm = half - friction * HEIGHT
        assert found[string].refusal == Refusal.NO_SOLUTION
        expected = WEIGHT * arm / math.hypot(arm, LENGTH)
        assert found[string].amount == pytest.approx(expected, rel=1e-7)
    assert (found["ssss"].refusal, found["ssss"].amount) == (Refusal.PENETRATES, pytest.approx(-10.0))
    assert found["ssss"].contact in range(4)


def test_a_foot_without_friction_that_would_have_to_pull() -> None:
    corners = [(-1.0, 0.0), (1.0, 1.0), (1.0, -1.0)]
    load = np.array([-1.25, 0.0])  # where the weight acts: beyond foot 0
    wrench = np.array([0.0, 0.0, -WEIGHT, 0.0, WEIGHT * load[0], 0.0])
    shares = np.linalg.solve(np.vstack([np.array(corners).T, np.ones(3)]), np.append(load, 1.0))
    found = refused(on_floor(corners, 0.0), wrench)
    assert found["ccc"].refusal == Refusal.PULLS
    assert shares[found["ccc"].contact] == pytest.approx(shares.min())
    assert found["ccc"].amount == pytest.approx(WEIGHT * shares.min(), rel=1e-9)


def test_feet_that_slide_already_have_known_forces() -> None:
    # It brakes so hard that the front edge would go down: what should separate penetrates.
    corners = [(-0.3, -0.5), (0.3, 0.0), (-0.3, 0.5)]
    found = refused(on_floor(corners, 0.2), np.array([0.0, 0.0, -WEIGHT, 0.0, 0.0, 0.0]), state((1.0, 0, 0)))
    assert found["sss"].refusal == Refusal.PENETRATES
    assert found["sss"].amount == pytest.approx(-10.0)
    assert {one.refusal for one in found.values()} <= {Refusal.PENETRATES, Refusal.PULLS}
    for string, one in found.items():
        assert (string[one.contact] == "s") == (one.refusal == Refusal.PENETRATES)
        assert one.amount < 0.0


@seeds(range(2), slow=range(2, 24))
def test_the_least_change_is_what_the_string_is_short_of(seed: int) -> None:
    # As in the definition: less than that in any direction leaves the string refused.
    chance = np.random.default_rng(seed)
    n = int(chance.integers(2, 5))
    normals = np.array([0.0, 0.0, 1.0]) + 0.4 * chance.normal(size=(n, 3))
    contacts = ContactSet(
        p_WC_W=chance.normal(size=(n, 3)),
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=chance.choice([0.2, 0.6], size=n),
    )
    wrench = 3.0 * chance.normal(size=6) - [0.0, 0.0, 5.0, 0.0, 0.0, 0.0]
    for string, one in refused(contacts, wrench, facets=24).items():
        if one.refusal != Refusal.NO_SOLUTION:
            continue
        change = chance.normal(size=6)
        # Pyramids that turn with the wrench hold up to a part of 1 / cos(pi / 24) more: 0.9 %.
        change *= 0.9 * one.amount / np.linalg.norm(change)
        changed = wrench + change * [1.0, 1.0, 1.0, LENGTH, LENGTH, LENGTH]
        slack = 0.01 * float(np.linalg.norm(wrench / [1.0, 1.0, 1.0, LENGTH, LENGTH, LENGTH]))
        if one.amount > 10.0 * slack:
            there = contact_modes(
                spatial_problem(BODY, state(), contacts, changed[:3], changed[3:], friction_facets=24)
            )
            assert string not in {mode.mode.replace("f", "c") for mode in there.modes}


def test_nothing_is_refused_before_an_impact() -> None:
    down = state((0.0, 0.0, -1.0))
    assert refused(on_floor(BOX, 0.5), np.array([0.0, 0.0, -WEIGHT, 0.0, 0.0, 0.0]), down) == {}
