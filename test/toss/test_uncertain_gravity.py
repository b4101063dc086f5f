# SPDX-License-Identifier: Apache-2.0
"""Samples whose gravity is not known: how far they spread, and whether made tosses are in their regions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.motion.state_noise import StateNoise
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import turned
from contact_dynamics.toss import TossEventKind, TossUncertainty, sampled_toss, toss
from contact_dynamics.tumbling import free_motion
from contact_dynamics.world import Body, Surface, World

SIZE = (0.12, 0.09, 0.07)
BRICK = Body.box(SIZE, mass=0.4, name="brick")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.2, restitution=0.4)
WORLD = World(bodies=(BRICK,), surfaces=(FLOOR,))
G = 9.80665
SIDEWAYS = 0.13  # m/s^2
SCATTERS = TossUncertainty(covariance=np.diag([0.0] * 6 + [SIDEWAYS**2, SIDEWAYS**2, 0.0]))


@pytest.mark.parametrize("by_gravity", [(0.0, 0.0), (0.002, 0.1)])
def test_places_spread_as_gravity_takes_samples_aside(by_gravity: tuple[float, float]) -> None:
    """By delta (a + b t + t^2 / 2), with a and b by which a fitted state changes with gravity."""
    state = BodyState(p_WB_W=[0, 0, 0.4], q_WB=[0.5, 0.1, 0.5, 0.7], v_WB_W=[0.3, 0, 0], w_WB_W=[1, 2, 0])
    first = sampled_toss(
        BRICK,
        state,
        WORLD,
        by_gravity=by_gravity,
        uncertainty=SCATTERS,
        count=2000,
        strikes=1,
        restitution_law=RestitutionLaw.POISSON,
        horizon=2.0,
    ).strikes[0]
    t = float(first.seconds.mean[0])
    assert first.seconds.covariance[0, 0] < 1e-20  # sideways alone, so that all strike at one time
    expected = SIDEWAYS * (by_gravity[0] + t * (by_gravity[1] + 0.5 * t))
    spreads = np.sqrt(first.position.covariance.diagonal())
    assert spreads[:2] == pytest.approx(expected, rel=0.06)  # of 2000 samples, four standard errors
    assert spreads[2] < 1e-9


def test_a_sample_that_goes_on_to_rest_has_the_gravity_of_the_world() -> None:
    """A brick that slides flush stops after v^2 / (2 mu g), whatever gravity was in flights."""
    flush = BodyState(p_WB_W=[0, 0, 0.035], q_WB=[0, 0, 0, 1], v_WB_W=[0.6, 0, 0])
    found = sampled_toss(
        BRICK,
        flush,
        WORLD,
        uncertainty=SCATTERS,
        count=5,
        to_rest=True,
        restitution_law=RestitutionLaw.POISSON,
        horizon=3.0,
    ).rest
    assert found is not None
    np.testing.assert_allclose(found.positions[:, 0], 0.6**2 / (2.0 * 0.2 * G), rtol=1e-3)


def test_made_tosses_are_in_the_regions_that_fits_to_their_flights_lead_to() -> None:
    """Each toss has a gravity of its own, and is fitted under the mean one before it strikes."""
    chance = np.random.default_rng(0)
    times = np.linspace(0.0, 0.08, 12)
    noise = StateNoise(position=2e-5, orientation=2e-4)
    held = []
    for _ in range(60):
        q = chance.standard_normal(4)
        state = BodyState(
            p_WB_W=[0, 0, 0.25],
            q_WB=q / np.linalg.norm(q),
            v_WB_W=chance.normal(0.0, 0.7, 3),
            w_WB_W=chance.normal(0.0, 3.0, 3),
        )
        own = WORLD.gravity_W + np.append(chance.normal(0.0, SIDEWAYS, 2), 0.0)
        went = toss(BRICK, state, replace(WORLD, gravity_W=own), max_alternatives=0, max_events=1)
        (strike,) = went.events
        assert strike.kind == TossEventKind.STRIKES
        flight = free_motion(BRICK.mass_properties, state, gravity_W=own)
        seen = [flight.state_at(t) for t in times.tolist()]
        states = [
            replace(
                each,
                p_WB_W=each.p_WB_W + noise.position * chance.standard_normal(3),
                q_WB=turned(each.q_WB[None], noise.orientation * chance.standard_normal((1, 3)))[0],
                stamp_ns=round(1e9 * t),
            )
            for each, t in zip(seen, times.tolist(), strict=True)
        ]
        fit = fit_free_motion(BRICK.mass_properties, states, gravity_W=WORLD.gravity_W, noise=noise)
        assert fit.by_gravity is not None
        row = []
        for by_gravity in (fit.by_gravity, (0.0, 0.0)):
            region = (
                sampled_toss(
                    BRICK,
                    fit.state,
                    WORLD,
                    covariance=fit.covariance,
                    by_gravity=by_gravity,
                    uncertainty=SCATTERS,
                    count=120,
                    strikes=1,
                    restitution_law=RestitutionLaw.POISSON,
                    horizon=2.0,
                )
                .strikes[0]
                .position
            )
            row.append(region.holds([strike.state.p_WB_W])[0])
        held.append(row)
    half, most = np.mean(held, axis=0).T
    assert abs(half[0] - 0.5) < 0.2  # of 60, three standard errors
    assert abs(most[0] - 0.9) < 0.12
    # A state that is taken as found without gravity makes regions too small.
    assert half[1] < 0.35
    assert most[1] < 0.7
