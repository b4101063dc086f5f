# SPDX-License-Identifier: Apache-2.0
"""Contacts with low rebounds are closed only if the body hardly moves otherwise."""

from __future__ import annotations

import math

import pytest

from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.toss import TossEnd, TossEventKind, toss
from contact_dynamics.world import Body, Surface, World


def floor(friction: float, restitution: float) -> World:
    surface = Surface(
        name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=friction, restitution=restitution
    )
    return World(surfaces=(surface,))


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_a_stick_that_turns_about_one_end_slides_on_after_a_low_rebound(restitution: float) -> None:
    """The corners of that end are so slow that they could stick, which would stop the turn.

    The friction of the strike, at 2 mm/s, takes at most 0.8 mm/s of the 15 mm/s of the centre of mass, and
    with it 4 of the 49 micrometres of the slide. The allowed difference is twice that.
    """
    stick, turn = Body.box((0.3, 0.03, 0.03), mass=0.4), 0.1
    state = {"p_WB_W": [0, 0, 0.015], "q_WB": [0, 0, 0, 1], "w_WB_W": [0, 0, turn]}
    places = []
    for fall in (0.0, -2e-3):
        went = toss(
            stick, BodyState(**state, v_WB_W=[0, 0.15 * turn, fall]), floor(0.3, restitution), error=1e-10
        )
        assert went.end == TossEnd.RESTS
        places.append(went.state.p_WB_W[1])
    assert places[0] > 40e-6
    assert abs(places[1] - places[0]) < 8e-6


def test_a_plate_rocks_on_its_narrow_face_and_loses_what_housner_says() -> None:
    """Its corners rise by a tenth of a millimetre at less than 4 mm/s (Housner 1963)."""
    thick, tall, tilt = 0.01, 0.2, 0.0126
    plate = Body.box((thick, 0.15, tall), mass=0.4)
    radius, alpha = 0.5 * math.hypot(thick, tall), math.atan2(thick, tall)
    state = BodyState(
        p_WB_W=[0, 0, radius * math.cos(alpha - tilt)],
        q_WB=[0, math.sin(0.5 * tilt), 0, math.cos(0.5 * tilt)],
    )
    went = toss(plate, state, floor(0.5, 0.0), horizon=1.0)
    assert went.end == TossEnd.HORIZON
    first = next(event for event in went.events if event.kind == TossEventKind.STRIKES)
    before = went.state_at(first.seconds - 1e-6).w_WB_W[1]
    after = went.state_at(first.seconds + 1e-6).w_WB_W[1]
    assert abs(before) > 0.2
    assert after / before == pytest.approx(1.0 - 1.5 * math.sin(alpha) ** 2, abs=1e-3)
