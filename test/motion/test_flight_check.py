# SPDX-License-Identifier: Apache-2.0
"""Fits to windows that contain an impact, and to windows that contain none."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Surface, World
from contact_dynamics.errors import NotInFlightError
from contact_dynamics.motion import Drag, FitResult, fit_free_motion, fit_motion
from contact_dynamics.motion.integrated import ForcedMotion, forced_motion
from contact_dynamics.questions import Context, ImpactQuestion, PublishedState, TumblingQuestion, ask
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.tumbling import FreeMotion, free_motion
from sweeps import seeds

BALL = Body.sphere(name="ball", radius=0.03, mass=0.1)
BRICK = Body.box(name="brick", size=[0.2, 0.1, 0.05], mass=1.0)
FLOOR = Surface(name="floor", p_WS_W=[0, 0, -0.03], normal_W=[0, 0, 1], friction=0.3, restitution=0.6)
G = 9.81
RATE = 120.0


def bouncing(
    count: int, after: float, *, noise: float, seed: int = 0, fall: float = -2.0, e: float = 0.6
) -> list[BodyState]:
    """States of a ball that does not spin and bounces once, ``after`` intervals after the first."""
    rng = np.random.default_rng(seed)
    at = after / RATE
    strike = fall - G * at
    states = []
    for t in np.arange(count) / RATE:
        since = t - at
        velocity = strike if since < 0.0 else -e * strike
        height = velocity * since - 0.5 * G * since**2
        states.append(
            BodyState(
                p_WB_W=np.array([0.3 * t, 0.0, height]) + noise * rng.standard_normal(3),
                q_WB=[0, 0, 0, 1],
                v_WB_W=[0.3, 0.0, velocity - G * since],
                stamp_ns=round(1e9 * t),
            )
        )
    return states


def watching(body: Body, states: list[BodyState], *surfaces: Surface) -> Context:
    """What a server knows that was sent these states of a body."""
    store = StateStore(history=1.0, timeout=1e9)
    for state in states:
        store.add(body.name, state)
    return Context(world=World(bodies=[body], surfaces=surfaces), states=store)


@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-4, 1e-3])
def test_a_fit_across_an_impact_has_not_converged(noise: float) -> None:
    least = 1.5 if noise < 1e-3 else 2.5  # intervals before and after, with two and three states
    for count, seed in itertools.product((8, 12, 20, 60) if noise < 1e-3 else (12, 20, 60), range(5)):
        alone = [count - 1.5] if noise < 1e-3 else []  # the newest state is the only one after it
        for after in (least, 0.5 * count, count - 1.0 - least, *alone):
            states = bouncing(count, after, noise=noise, seed=seed)
            fit = fit_free_motion(BALL, states)
            assert not fit.converged
            assert fit.velocity_jump is not None
            at = after / RATE - 1e-9 * states[-1].stamp_ns
            assert fit.velocity_jump == pytest.approx(at, abs=1.01 / RATE)


def test_the_first_state_after_a_bounce_is_an_error_and_not_a_landing_now() -> None:
    """The fitted flight was in the floor at that state, and was said to land in 0 s."""
    context = watching(BALL, bouncing(20, 18.5, noise=1e-4), FLOOR)
    question = ImpactQuestion(body="ball", state=PublishedState(fit_window=0.5))
    with pytest.raises(NotInFlightError, match=r"fit_window must be a window that begins after the impact"):
        ask(question, context)


def test_of_several_impacts_the_latest_is_found() -> None:
    first = bouncing(30, 14.5, noise=1e-4, e=0.5)
    again = bouncing(20, 10.5, noise=1e-4, seed=1, fall=-1.0)
    start = first[-1]
    later = [
        replace(
            state,
            p_WB_W=state.p_WB_W - again[0].p_WB_W + start.p_WB_W,
            stamp_ns=start.stamp_ns + state.stamp_ns,
        )
        for state in again[1:]
    ]
    fit = fit_free_motion(BALL, first + later)
    assert fit.velocity_jump == pytest.approx(-8.5 / RATE, abs=1.01 / RATE)


def noisy(
    motion: FreeMotion | ForcedMotion, times: np.ndarray, rng: np.random.Generator, noise: float
) -> list[BodyState]:
    states = map(motion.state_at, times)
    return [replace(state, p_WB_W=state.p_WB_W + noise * rng.standard_normal(3)) for state in states]


@pytest.mark.parametrize("tilt", [0.0, 0.3])
@pytest.mark.parametrize(("noise", "count"), [(0.0, 12), (5e-4, 12), (0.0, 4)])
def test_a_fit_to_a_body_that_lies_or_slides_has_not_converged(noise: float, count: int, tilt: float) -> None:
    """It seems to fall, and to have been thrown upwards, if only the residuals are not looked at."""
    rng = np.random.default_rng(5)
    slope = np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    states = []
    for t in np.arange(count) / RATE:
        along = 0.5 * G * np.sin(tilt) * t**2
        states.append(
            BodyState(
                p_WB_W=along * slope + noise * rng.standard_normal(3),
                q_WB=[0, 0, 0, 1],
                v_WB_W=G * np.sin(tilt) * t * slope,
                stamp_ns=round(1e9 * t),
            )
        )
    for fit in (fit_free_motion(BRICK, states), fit_motion(BRICK, states, drag=Drag(linear=0.05))):
        assert (fit.falls, fit.converged) == (False, False)
    context = watching(BRICK, states)
    question = TumblingQuestion(body="brick", state=PublishedState(fit_window=0.2))
    with pytest.raises(
        NotInFlightError, match=f"got {count} states of a body that does not fall: it rests, slides"
    ):
        ask(question, context)


@seeds(range(80), slow=range(80, 300))
def test_no_impact_is_found_in_a_flight(seed: int) -> None:
    """White noise of every size and gravity that leans."""
    rng = np.random.default_rng(seed)
    start = BodyState(
        p_WB_W=rng.normal(size=3), q_WB=[0, 0, 0, 1], v_WB_W=rng.normal(size=3), w_WB_W=rng.normal(size=3)
    )
    times = np.arange(int(rng.integers(3, 80))) / RATE
    noise = float(10.0 ** rng.uniform(-12, -2)) if seed % 10 else 0.0
    leaning = [0.2 * rng.normal(), 0.2 * rng.normal(), -G + 0.2 * rng.normal()]
    states = noisy(free_motion(BRICK, start, gravity_W=leaning), times, rng, noise)
    fit = fit_free_motion(BRICK, states)
    assert (fit.velocity_jump, fit.falls, fit.converged) == (None, True, True)


@seeds(range(0, 10, 3), slow=range(10))
def test_no_impact_is_found_in_a_flight_with_drag(seed: int) -> None:
    """Whether or not the drag is known."""
    drag, rng = Drag(linear=0.4), np.random.default_rng(seed)
    start = BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[4, 0, 3], w_WB_W=[0, 0.5, 0])
    states = noisy(forced_motion(BRICK, start, drag=drag), np.arange(40) / RATE, rng, 10.0 ** -(seed + 3.0))
    assert fit_free_motion(BRICK, states).velocity_jump is None
    known = fit_motion(BRICK, states, drag=drag)
    assert known.velocity_jump is None
    assert known.converged


@pytest.mark.parametrize("fit", [fit_free_motion, partial(fit_motion, drag=Drag(linear=0.05))])
def test_a_tumbling_body_that_bounces_names_the_impact_too(fit: Callable[..., FitResult]) -> None:
    rng = np.random.default_rng(3)
    before = free_motion(
        BRICK, BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[0.5, 0, -2], w_WB_W=[3, 4, 1])
    )
    struck = before.state_at(0.1)
    bounced = free_motion(BRICK, replace(struck, v_WB_W=[0.3, 0.1, 1.2], w_WB_W=[-5, 2, 6], stamp_ns=0))
    states = noisy(before, np.arange(0.004, 0.1, 1 / RATE), rng, 1e-4)
    for state in noisy(bounced, np.arange(0.004, 0.1, 1 / RATE), rng, 1e-4):
        states.append(replace(state, stamp_ns=state.stamp_ns + 100_000_000))
    found = fit(BRICK, states)
    assert not found.converged
    assert found.velocity_jump == pytest.approx(0.1 - 1e-9 * states[-1].stamp_ns, abs=1.01 / RATE)


def test_a_question_with_a_window_across_an_impact_is_an_error_that_says_when_it_was() -> None:
    context = watching(BALL, bouncing(20, 14.5, noise=1e-4))
    question = TumblingQuestion(body="ball", state=PublishedState(fit_window=0.5))
    with pytest.raises(
        NotInFlightError, match=r"fit_window must be a window that begins after the impact.*0\.03"
    ):
        ask(question, context)
    after = TumblingQuestion(body="ball", state=PublishedState(fit_window=0.034))
    assert ask(after, context).state.v_WB_W[2] > 0.0
