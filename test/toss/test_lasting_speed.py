# SPDX-License-Identifier: Apache-2.0
"""The friction of slow strikes, between that of sustained contact and that of fast strikes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import (
    Body,
    BodyState,
    Contact,
    Surface,
    World,
    sampled_toss,
    spatial_impact,
    state_covariance,
    toss,
)
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.toss import Toss, TossEventKind
from sweeps import seeds

BRICK = Body.box((0.1, 0.12, 0.07), mass=0.4, name="brick")
FLOOR = Surface(
    name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.1, restitution=0.3, lasting_factor=1.5
)
WALL = Surface(name="wall", p_WS_W=[0.4, 0, 0], normal_W=[-1, 0, 0], friction=0.2, restitution=0.3)


def thrown(seed: int) -> BodyState:
    """A rotating brick in the air; with seed 0 it is level, and its corners strike at one instant."""
    chance = np.random.default_rng(seed)
    q = chance.standard_normal(4) if seed else np.array([0.0, 0.0, 0.0, 1.0])
    w = chance.normal(0.0, 5.0, 3) if seed else np.zeros(3)
    return BodyState(p_WB_W=[0, 0, 0.3], q_WB=q / np.linalg.norm(q), v_WB_W=[1.0, 0.5, 0.0], w_WB_W=w)


def course(went: Toss) -> list[object]:
    """All that a toss says of its events, to the last bit."""
    return [(each.seconds, each.kind, each.corners, each.state.to_dict()) for each in went.events]


@seeds(range(1, 5))
def test_a_strike_has_the_coefficient_of_its_approach_speed(seed: int) -> None:
    """At half the lasting speed, it is the mean of the two, for the toss and for samples."""
    went = toss(BRICK, thrown(seed), World(surfaces=(FLOOR,)))
    first = went.events[0]
    (corner,) = first.corners
    before = went.state_at(first.seconds - 1e-9)
    p_WC_W = before.p_WB_W + before.R_WB @ BRICK.shape.vertices[corner]
    approach = -(before.v_WB_W + np.cross(before.w_WB_W, p_WC_W - before.p_WB_W))[2]
    contact = Contact(p_WC_W=p_WC_W, normal_W=[0, 0, 1], friction=0.5 * (0.1 + 0.15), restitution=0.3)
    law = RestitutionLaw.POISSON
    expected = spatial_impact(BRICK.mass_properties, before, contact, restitution_law=law).state
    world = World(surfaces=(replace(FLOOR, lasting_speed=2.0 * approach),))
    struck = toss(BRICK, thrown(seed), world, restitution_law=law).events[0].state
    sampled = sampled_toss(BRICK, thrown(seed), world, count=20, strikes=1, restitution_law=law).strikes[0]
    # Gravity acts for another nanosecond, and samples arrive to 1e-7 m.
    for velocity, spin in ((struck.v_WB_W, struck.w_WB_W), (sampled.velocity.mean, sampled.spin.mean)):
        np.testing.assert_allclose(velocity, expected.v_WB_W, atol=1e-6)
        np.testing.assert_allclose(spin, expected.w_WB_W, atol=1e-4)
    faster = World(surfaces=(replace(FLOOR, lasting_speed=0.9 * approach),))
    unchanged = toss(BRICK, thrown(seed), faster, restitution_law=law).events[0].state
    assert unchanged.to_dict() == first.state.to_dict()
    assert np.linalg.norm(struck.v_WB_W - first.state.v_WB_W) > 1e-3


@pytest.mark.parametrize("law", SeveralContactsLaw)
@seeds(range(4))
def test_below_a_speed_that_is_never_reached_all_contacts_have_one_friction(
    seed: int, law: SeveralContactsLaw
) -> None:
    """That of sustained contact, to the last bit. If it is the same for fast strikes, no speed matters."""
    slow = replace(FLOOR, lasting_speed=1e300)
    one = replace(FLOOR, friction=1.5 * FLOOR.friction, lasting_factor=1.0)
    for same, other in ((slow, one), (one, replace(one, lasting_speed=0.5))):
        went, expected = (
            toss(BRICK, thrown(seed), World(surfaces=(floor, WALL)), several_contacts_law=law)
            for floor in (same, other)
        )
        assert course(went) == course(expected)
        assert any(each.kind == TossEventKind.STRIKES for each in went.events)


def test_samples_have_it_until_they_rest() -> None:
    found = [
        sampled_toss(
            BRICK,
            thrown(1),
            World(surfaces=(floor,)),
            covariance=state_covariance(velocity=0.02, angular_velocity=0.1),
            count=40,
            to_rest=True,
        ).rest
        for floor in (
            replace(FLOOR, lasting_speed=1e300),
            replace(FLOOR, friction=1.5 * FLOOR.friction, lasting_factor=1.0),
            FLOOR,
        )
    ]
    slow, one, fast = (each.positions.tolist() for each in found if each is not None)
    assert slow == one != fast
