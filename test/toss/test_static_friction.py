# SPDX-License-Identifier: Apache-2.0
"""Tosses on a slope between the angles of kinetic and of static friction: what has stopped there stays."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Surface, World, sampled_toss, toss
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.toss import Toss, TossEnd
from sweeps import seeds

BRICK = Body.box((0.2, 0.2, 0.04), mass=0.4, name="brick")
KINETIC, STATIC, SLOPE, G = 0.3, 0.5, math.atan(0.4), 9.81
WITHIN = 1e-6  # m, ten steps of the largest error that a toss allows by default


def world(static: float | None, *, friction: float = KINETIC, lasting_factor: float = 1.0) -> World:
    """Return a flat along x that rises against gravity in the direction of x."""
    floor = Surface(
        name="floor",
        p_WS_W=[0, 0, 0],
        normal_W=[0, 0, 1],
        friction=friction,
        restitution=0.2,
        lasting_factor=lasting_factor,
        static_friction=static,
    )
    return World(surfaces=(floor,), gravity_W=[-G * math.sin(SLOPE), 0, -G * math.cos(SLOPE)])


def on_slope(speed: float) -> BodyState:
    return BodyState(p_WB_W=[0, 0, 0.02], q_WB=[0, 0, 0, 1], v_WB_W=[speed, 0, 0])


def test_what_is_put_on_the_slope_stays_with_static_friction_and_slides_without() -> None:
    still = toss(BRICK, on_slope(0.0), world(STATIC))
    assert (still.end, still.seconds) == (TossEnd.RESTS, 0.0)
    assert still.state.p_WB_W == pytest.approx([0, 0, 0.02], abs=1e-12)
    slides = toss(BRICK, on_slope(0.0), world(None), horizon=0.5)
    rate = G * (math.sin(SLOPE) - KINETIC * math.cos(SLOPE))
    assert slides.end != TossEnd.RESTS
    assert slides.state.p_WB_W[0] == pytest.approx(-0.5 * rate * 0.5**2, abs=WITHIN)


def test_what_slides_up_has_kinetic_friction_until_it_stops_and_then_stays() -> None:
    speed = 1.5
    slowing = G * (math.sin(SLOPE) + KINETIC * math.cos(SLOPE))
    went = toss(BRICK, on_slope(speed), world(STATIC))
    assert went.end == TossEnd.RESTS
    assert went.seconds == pytest.approx(speed / slowing, abs=1e-3)  # it stops within a micrometre of rest
    assert went.state.p_WB_W[0] == pytest.approx(0.5 * speed**2 / slowing, abs=2.0 * WITHIN)
    returns = toss(BRICK, on_slope(speed), world(None), horizon=1.0)
    assert returns.state.v_WB_W[0] < 0.0


def test_the_lasting_factor_applies_to_static_friction_too() -> None:
    assert toss(BRICK, on_slope(0.0), world(STATIC, lasting_factor=0.81)).end == TossEnd.RESTS
    assert toss(BRICK, on_slope(0.0), world(STATIC, lasting_factor=0.79), horizon=0.2).end != TossEnd.RESTS


def test_a_box_beyond_static_friction_begins_to_slide_with_kinetic_friction() -> None:
    slides = toss(BRICK, on_slope(0.0), world(0.39), horizon=0.5)
    rate = G * (math.sin(SLOPE) - KINETIC * math.cos(SLOPE))
    assert slides.state.p_WB_W[0] == pytest.approx(-0.5 * rate * 0.5**2, abs=WITHIN)


def course(went: Toss) -> list[object]:
    return [(each.seconds, each.kind, each.corners, each.state.to_dict()) for each in went.events]


@seeds(range(4))
def test_equal_static_friction_changes_no_bit(seed: int) -> None:
    chance = np.random.default_rng(seed)
    q = chance.standard_normal(4)
    state = BodyState(
        p_WB_W=[0, 0, 0.3], q_WB=q / np.linalg.norm(q), v_WB_W=[1, 0.5, 0], w_WB_W=chance.normal(0.0, 5.0, 3)
    )
    one, other = (toss(BRICK, state, world(static, friction=0.6), horizon=3.0) for static in (None, 0.6))
    assert course(one) == course(other)


def test_samples_stay_where_static_friction_holds_them() -> None:
    """Samples leave out motions below a hundredth of a millimetre, such as chatter."""
    speed = 1.0
    there = sampled_toss(BRICK, on_slope(speed), world(STATIC), count=5, to_rest=True)
    stopped = 0.5 * speed**2 / (G * (math.sin(SLOPE) + KINETIC * math.cos(SLOPE)))
    assert there.rest is not None
    assert there.rest.positions[:, 0] == pytest.approx(stopped, abs=1e-4)


def test_static_friction_without_kinetic_friction_is_refused() -> None:
    with pytest.raises(NotSupportedError, match=r"static_friction of 'floor' must be 0 .*, got 0.5"):
        toss(BRICK, on_slope(0.0), world(STATIC, friction=0.0))
