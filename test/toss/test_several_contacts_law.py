# SPDX-License-Identifier: Apache-2.0
"""The law by which contacts that strike at one instant are resolved within a toss."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Contact, ContactSet, Surface, World, inertia, several_impact
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.shapes import polyhedron
from contact_dynamics.toss import Toss, TossEventKind, sampled_toss, toss

SIDES = 12
ANGLES = 2.0 * math.pi * np.arange(SIDES) / SIDES
RING = 0.02 * np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(SIDES)])
HALF = np.array([0.0, 0.0, 0.001])
POINTS = np.vstack([RING + HALF, RING - HALF])
COIN = Body.of("coin", inertia.convex_hull(POINTS, density=8000.0), shape_F=polyhedron(POINTS))
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5)
WORLD = World(surfaces=(FLOOR,))
HEIGHT = 0.2


def dropped(law: SeveralContactsLaw, restitution_law: RestitutionLaw = RestitutionLaw.POISSON) -> Toss:
    """A coin falls flat, without any motion but along the normal."""
    state = BodyState(p_WB_W=[0, 0, HEIGHT], q_WB=[0, 0, 0, 1])
    return toss(
        COIN,
        state,
        WORLD,
        several_contacts_law=law,
        restitution_law=restitution_law,
        horizon=0.25,
        max_alternatives=0,
    )


@pytest.mark.parametrize("law", SeveralContactsLaw)
@pytest.mark.parametrize("restitution_law", [RestitutionLaw.POISSON, RestitutionLaw.NEWTON])
def test_a_coin_that_falls_flat_bounces_level(
    law: SeveralContactsLaw, restitution_law: RestitutionLaw
) -> None:
    """It left with 12.7 rad/s. By symmetry it cannot turn, and the normal velocity is reversed with e."""
    went = dropped(law, restitution_law)
    first = [event for event in went.events if event.kind == TossEventKind.STRIKES]
    together = [event for event in first if event.seconds == first[0].seconds]
    assert sorted(event.corners[0] for event in together) == list(range(SIDES, 2 * SIDES))
    fallen = math.sqrt(2.0 * 9.80665 * (HEIGHT - 0.001))
    after = together[-1].state
    np.testing.assert_allclose(after.v_WB_W, [0.0, 0.0, 0.5 * fallen], atol=1e-9)
    np.testing.assert_allclose(after.w_WB_W, 0.0, atol=1e-7)
    momentum = sum(event.impulse_W for event in together)
    np.testing.assert_allclose(momentum, [0, 0, COIN.mass_properties.mass * 1.5 * fallen], atol=1e-9)


@pytest.mark.parametrize("law", SeveralContactsLaw)
def test_the_strikes_of_one_instant_are_those_of_several_impact(law: SeveralContactsLaw) -> None:
    """A box lands on its edge, sliding and turning, so that the two ends come down at one instant."""
    size = (0.1, 0.16, 0.06)
    brick = Body.box(size, mass=0.5, name="brick")
    lean = 0.5 * 0.7
    state = BodyState(
        p_WB_W=[0, 0, 0.2],
        q_WB=[0, math.sin(lean), 0, math.cos(lean)],
        v_WB_W=[0.3, 0.4, -1.0],
        w_WB_W=[0, 0.5, 0],
    )
    went = toss(brick, state, WORLD, several_contacts_law=law, horizon=0.3, max_alternatives=0)
    time = went.events[0].seconds
    struck = [event for event in went.events if event.seconds == time]
    assert {event.kind for event in struck} >= {TossEventKind.STRIKES}
    touching = sorted({event.corners[0] for event in struck if event.kind == TossEventKind.STRIKES})
    assert len(touching) == 2
    before = went.state_at(time - 1e-9)
    at = replace(before, p_WB_W=struck[0].state.p_WB_W, q_WB=struck[0].state.q_WB)
    contacts = [
        Contact(
            p_WC_W=at.p_WB_W + at.R_WB @ brick.shape.vertices[corner],
            normal_W=FLOOR.normal_W,
            friction=FLOOR.friction,
            restitution=FLOOR.restitution,
        )
        for corner in touching
    ]
    known = several_impact(
        brick.mass_properties, at, ContactSet.of(contacts), several_contacts_law=law, velocity_tolerance=1e-9
    )
    np.testing.assert_allclose(struck[-1].state.v_WB_W, known.state.v_WB_W, atol=1e-6)
    np.testing.assert_allclose(struck[-1].state.w_WB_W, known.state.w_WB_W, atol=1e-5)


def test_the_energetic_law_has_no_simultaneous_form() -> None:
    with pytest.raises(InvalidFieldError, match="POISSON or NEWTON for SIMULTANEOUS"):
        dropped(SeveralContactsLaw.SIMULTANEOUS, RestitutionLaw.ENERGETIC)


def test_samples_take_the_law_too() -> None:
    """Where a box comes to rest depends on it, with the same seed and without any spread."""
    state = BodyState(p_WB_W=[0, 0, HEIGHT], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0, 0], w_WB_W=[5, 0, 0])
    brick = Body.box((0.1, 0.06, 0.02), 0.5)

    def place(law: SeveralContactsLaw, restitution_law: RestitutionLaw) -> np.ndarray:
        told = sampled_toss(
            brick,
            state,
            WORLD,
            count=1,
            to_rest=True,
            restitution_law=restitution_law,
            several_contacts_law=law,
        )
        assert told.rest
        return told.rest.positions[0]

    first, other = (place(law, RestitutionLaw.POISSON) for law in SeveralContactsLaw)
    assert np.linalg.norm(first - other) > 1e-3
    with pytest.raises(InvalidFieldError, match="POISSON or NEWTON for SIMULTANEOUS"):
        place(SeveralContactsLaw.SIMULTANEOUS, RestitutionLaw.ENERGETIC)


@pytest.mark.parametrize("law", SeveralContactsLaw)
@pytest.mark.parametrize("spin", [0.0, 5.0], ids=["face", "edge"])
def test_samples_of_a_flush_landing_come_to_rest_as_the_toss_does(
    law: SeveralContactsLaw, spin: float
) -> None:
    """Whatever the depth of their tree. Corners that strike one after the other would turn the box.

    Samples leave out rebounds below a tenth of a millimetre, so that they rest by millimetres elsewhere.
    """
    box = Body.box((0.12, 0.08, 0.05), 0.6)
    state = BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[0.4 * spin, 0, 0], w_WB_W=[spin, 0, 0])
    single = toss(box, state, WORLD, several_contacts_law=law)
    for strikes in (1, 2, 4):
        told = sampled_toss(
            box, state, WORLD, count=2, strikes=strikes, to_rest=True, several_contacts_law=law
        )
        assert told.rest
        np.testing.assert_allclose(told.face_normals_B, [single.resting_normal_B], atol=1e-6)
        np.testing.assert_allclose(told.rest.positions[0], single.state.p_WB_W, atol=0.01)
