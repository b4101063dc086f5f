# SPDX-License-Identifier: Apache-2.0
"""Second strikes of made tosses: whether they are in their regions, and whether a recording tells them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from benchmarks._toss_strikes import second_arrival
from contact_dynamics.calibration.observed import observe
from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.measured.motion import StateColumns, motions_of
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import quaternions_of, rotation_vectors, turned
from contact_dynamics.rotations.one import product
from contact_dynamics.toss import TossEventKind, TossUncertainty, sampled_toss, toss
from contact_dynamics.world import Body, Surface, World

if TYPE_CHECKING:
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.toss import TossEvent

CUBE = Body.box((0.1,) * 3, mass=0.4, name="cube")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.16, restitution=0.3)
WORLD = World(bodies=(CUBE,), surfaces=(FLOOR,))
RATE = 148.0  # Hz
NOISE = (2.5e-5, 3.5e-4)  # m, rad
STATE_STDS = np.repeat([1e-3, 5e-3, 5e-3, 0.05], 3)
PARAMETER_STDS = np.array([0.01, 0.02, 0.0, 0.0, 0.0, 0.0])  # friction, restitution, mass centre, inertia


def thrown(chance: np.random.Generator) -> BodyState:
    q = chance.standard_normal(4)
    return BodyState(
        p_WB_W=[0, 0, 0.2],
        q_WB=q / np.linalg.norm(q),
        v_WB_W=chance.normal(0.0, 0.6, 3),
        w_WB_W=chance.normal(0.0, 3.0, 3),
    )


def first_strikes(state: BodyState, world: World) -> list[TossEvent]:
    """The first two strikes, with what happens between them left out."""
    went = toss(CUBE, state, world, max_events=8, max_alternatives=0)
    return [event for event in went.events if event.kind == TossEventKind.STRIKES][:2]


def test_second_strikes_of_made_tosses_are_in_their_regions() -> None:
    """The made tosses are single ones with a state, friction and restitution that were drawn for them."""
    chance = np.random.default_rng(3)
    held = []
    while len(held) < 60:
        known = thrown(chance)
        off = STATE_STDS * chance.standard_normal(12)
        mu, e = np.array([0.16, 0.3]) + PARAMETER_STDS[:2] * chance.standard_normal(2)
        true = BodyState(
            p_WB_W=known.p_WB_W + off[:3],
            q_WB=np.array(product(quaternions_of(off[None, 3:6])[0].tolist(), known.q_WB.tolist())),
            v_WB_W=known.v_WB_W + off[6:9],
            w_WB_W=known.w_WB_W + off[9:],
        )
        floor = replace(FLOOR, friction=float(mu), restitution=float(e))
        strikes = first_strikes(true, replace(WORLD, surfaces=(floor,)))
        told = sampled_toss(
            CUBE,
            known,
            WORLD,
            covariance=np.diag(STATE_STDS**2),
            uncertainty=TossUncertainty(covariance=np.diag(PARAMETER_STDS**2)),
            count=100,
            restitution_law=RestitutionLaw.POISSON,
            horizon=2.0,
        )
        if len(strikes) < 2 or len(told.strikes) < 2 or told.strikes[1].probability < 1.0:
            continue
        event, regions = strikes[1], told.strikes[1]
        turn = rotation_vectors(event.state.q_WB[None], regions.q_WB)[0]
        held.append(
            [
                regions.seconds.holds([[event.seconds]])[0],
                regions.position.holds([event.state.p_WB_W])[0],
                regions.turn.holds([turn])[0],
                regions.velocity.holds([event.state.v_WB_W])[0],
                regions.spin.holds([event.state.w_WB_W])[0],
            ]
        )
    half, most = np.mean(held, axis=0).T
    np.testing.assert_allclose(half, 0.5, atol=0.19)  # of 60, three standard errors
    np.testing.assert_allclose(most, 0.9, atol=0.12)
    assert 0.85 < most.mean() < 0.95


@pytest.mark.slow
def test_regions_hold_where_the_law_is_off_by_impulses_at_the_contact() -> None:
    """The impulses are drawn here, and the toss goes on from the velocities that they leave."""
    chance = np.random.default_rng(8)
    velocity = 0.018  # m/s
    mass, moment = CUBE.mass_properties.mass, CUBE.mass_properties.I_B[0, 0]
    lever = np.linalg.norm(CUBE.shape.vertices[0]) * mass / moment
    spin = velocity * lever * np.sqrt(2.0 / 3.0)  # rad/s, by such impulses at any corner of a cube
    held = []
    while len(held) < 60:
        state = thrown(chance)
        went = toss(CUBE, state, WORLD, max_events=1, max_alternatives=0)
        (first,) = went.events
        tail = 0.8881 * np.sqrt(3.0 / chance.chisquare(3.0))
        push = tail * np.sqrt(0.9) * velocity * chance.standard_normal(3)
        pushed = np.cross(first.p_WC_W[0] - first.state.p_WB_W, mass * push)
        off_v, off_w = tail * np.sqrt(0.1) * np.outer([velocity, spin], chance.standard_normal(3))
        after = replace(
            first.state,
            v_WB_W=first.state.v_WB_W + push + off_v,
            w_WB_W=first.state.w_WB_W + pushed / moment + off_w,
        )
        told = sampled_toss(
            CUBE,
            state,
            WORLD,
            uncertainty=TossUncertainty(velocity=velocity, spin=spin),
            count=100,
            restitution_law=RestitutionLaw.POISSON,
            horizon=2.0,
        )
        rebound = after.velocity_of_point(first.p_WC_W[0])[2]
        follows = first_strikes(after, WORLD)[:1]
        if rebound < 0.05 or not follows or len(told.strikes) < 2 or told.strikes[1].probability < 1.0:
            continue
        regions, event = told.strikes[1], follows[0]
        if regions.seconds.mean[0] - first.seconds < 0.03:
            continue
        turn = rotation_vectors(event.state.q_WB[None], regions.q_WB)[0]
        held.append(
            [
                told.strikes[0].velocity.holds([after.v_WB_W])[0],
                told.strikes[0].spin.holds([after.w_WB_W])[0],
                regions.seconds.holds([[first.seconds + event.seconds]])[0],
                regions.position.holds([event.state.p_WB_W])[0],
                regions.turn.holds([turn])[0],
            ]
        )
    half, most = np.mean(held, axis=0).T
    np.testing.assert_allclose(half, 0.5, atol=0.19)  # of 60, three standard errors
    np.testing.assert_allclose(most, 0.9, atol=0.12)
    assert 0.85 < most.mean() < 0.95


def recorded(state: BodyState, seconds: float, chance: np.random.Generator) -> Observed | None:
    """What is found in a made recording of a toss, or None if it has no first strike."""
    went = toss(CUBE, state, WORLD, horizon=seconds, max_alternatives=0)
    times = np.arange(chance.uniform(0.0, 1.0 / RATE), seconds, 1.0 / RATE)
    states = [
        replace(
            each,
            p_WB_W=each.p_WB_W + NOISE[0] * chance.standard_normal(3),
            q_WB=turned(each.q_WB[None], NOISE[1] * chance.standard_normal((1, 3)))[0],
            v_WB_W=np.zeros(3),
            w_WB_W=np.zeros(3),
            stamp_ns=round(1e9 * t),
        )
        for each, t in zip([went.state_at(t) for t in times.tolist()], times.tolist(), strict=True)
    ]
    (motion,) = motions_of(CUBE, WORLD, StateColumns(states, [each.stamp_ns for each in states]), noise=NOISE)
    found = observe("made", motion)
    return found[0] if found and found[0].strikes else None


def test_a_recording_tells_second_strikes_whether_or_not_a_flight_follows_them() -> None:
    chance = np.random.default_rng(5)
    followed, off = [], []
    while len(off) < 4:
        state = thrown(chance)
        strikes = first_strikes(state, WORLD)
        if len(strikes) < 2 or strikes[1].seconds - strikes[0].seconds < 0.06:
            continue
        observed = recorded(state, strikes[1].seconds + 0.3, chance)
        if observed is None or abs(observed.strikes[0].time - strikes[0].seconds) > 1e-3:
            continue
        arrival = second_arrival(observed, WORLD, WORLD.gravity_W)
        assert arrival is not None
        assert arrival.corner == strikes[1].corners[0]
        np.testing.assert_allclose(arrival.state.p_WB_W, strikes[1].state.p_WB_W, atol=1e-3)
        off.append(arrival.seconds - strikes[1].seconds)
        followed.append(len(observed.strikes) > 1)
    assert np.abs(off).max() < 2e-3
    assert any(followed)
    assert not all(followed)
