# SPDX-License-Identifier: Apache-2.0
"""Bodies that turn by half a turn and more from state to state: no fit takes another motion for the true one.

True motions are integrated (`oracles.tumbling_stepped`).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion import ConstantWrench, Drag, StateNoise, fit_free_motion, fit_motion
from contact_dynamics.motion.between_states import state_between
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from motion.evidence import turned
from oracles.tumbling_stepped import stepped
from sweeps import seeds

BALL = MassProperties(mass=1.0, I_B=np.eye(3) * 4e-3)
MOMENTS = {
    "ball": [1.0, 1.0, 1.0],
    "top": [1.0, 1.0, 1.6],
    "rod": [1.0, 1.0, 0.3],
    "brick": [0.35, 0.83, 1.02],
    "asymmetric": [1.0, 1.4, 1.9],
}


class Draw(NamedTuple):
    body: MassProperties
    states: list[BodyState]
    w_W: np.ndarray  # the true angular velocity at the newest state
    noise: StateNoise | None
    turns: float  # from state to state

    def differs(self, state: BodyState) -> bool:
        """Whether a state has another number of turns: its velocity is off by 0.4 turns per interval."""
        longest = max(
            later.stamp_ns - earlier.stamp_ns
            for earlier, later in zip(self.states, self.states[1:], strict=False)
        )
        return bool(np.linalg.norm(state.w_WB_W - self.w_W) * longest * 1e-9 > 0.4 * 2.0 * math.pi)


def drawn(rng: np.random.Generator, *, with_velocities: bool) -> Draw:
    """States 1 to 100 ms apart, even or not, of a body that turns up to four times from one to the next."""
    moments = MOMENTS[str(rng.choice(list(MOMENTS)))]
    body = MassProperties(mass=1.0, I_B=1e-3 * np.diag(moments))
    axis = np.eye(3)[rng.integers(3)] if rng.random() < 0.5 else rng.normal(size=3)
    axis += 0.01 * rng.integers(2) * rng.normal(size=3)
    interval = 10.0 ** rng.uniform(-3.0, -1.0)
    turns = rng.uniform(0.0, 4.0) if rng.random() < 0.7 else abs(0.5 * rng.integers(8) + 0.01 * rng.normal())
    rate = 2.0 * math.pi * turns / interval * axis / np.linalg.norm(axis)
    count = int(rng.choice([3, 4, 5, 8, 12]))
    gaps = interval * (1.0 - rng.choice([0.0, 0.02, 0.7]) * rng.random(count - 1))
    stamps = np.round(1e9 * np.concatenate([[0.0], np.cumsum(gaps)])).astype(int)
    q0 = Rotation.random(random_state=int(rng.integers(2**31))).as_quat()
    attitudes, rates = stepped(body.I_B, q0, rate, list(stamps * 1e-9))
    orientation = float(rng.choice([1e-5, 1e-3, 1e-2]))
    velocity = float(rng.choice([1e-6, 1e-3, 1e-2, 0.1])) * 2.0 * math.pi / interval
    states = [
        BodyState(
            p_WB_W=np.zeros(3),
            q_WB=(Rotation.from_rotvec(rng.normal(scale=orientation, size=3)) * attitude).as_quat(),
            w_WB_W=w + rng.normal(scale=velocity, size=3) if with_velocities else np.zeros(3),
            stamp_ns=int(stamp),
        )
        for stamp, attitude, w in zip(stamps, attitudes, rates, strict=True)
    ]
    known = {"position": 1e-3, "orientation": orientation}
    noises = [None, StateNoise(**known)]
    if with_velocities:
        noises.append(StateNoise(**known, angular_velocity=velocity))
    return Draw(body, states, rates[-1], noises[rng.integers(len(noises))], turns)


@seeds(range(1), slow=range(1, 250))
def test_with_velocities_no_fit_has_another_number_of_turns(seed: int) -> None:
    """Of 12 draws. And nearly all are found, also where the body turns several times from state to state."""
    rng = np.random.default_rng(seed)
    found = 0
    for _ in range(12):
        draw = drawn(rng, with_velocities=True)
        fit = fit_free_motion(draw.body, draw.states, gravity_W=np.zeros(3), noise=draw.noise)
        if fit.converged and not fit.alternatives:
            assert not draw.differs(fit.state), (fit, draw)
            found += fit.turns_known
    assert found >= 8


@seeds(range(1), slow=range(1, 300))
def test_without_velocities_another_number_of_turns_is_never_certain(seed: int) -> None:
    """Nor is it silent: below half a turn every fit that converges is right or has an alternative."""
    rng = np.random.default_rng(1000 + seed)
    for _ in range(6):
        draw = drawn(rng, with_velocities=False)
        fit = fit_free_motion(draw.body, draw.states, gravity_W=np.zeros(3), noise=draw.noise)
        if fit.converged and not fit.alternatives and draw.differs(fit.state):
            assert not fit.turns_known, (fit, draw)
            assert draw.turns > 0.5, (fit, draw)


def spinning(rate: float, per_second: float, count: int = 10) -> list[BodyState]:
    """Exact states of a ball about a fixed axis."""
    return [
        BodyState(
            p_WB_W=np.zeros(3),
            q_WB=Rotation.from_rotvec([0.0, 0.0, rate * k / per_second]).as_quat(),
            w_WB_W=[0.0, 0.0, rate],
            stamp_ns=round(1e9 * k / per_second),
        )
        for k in range(count)
    ]


def poses_of(states: list[BodyState]) -> list[BodyState]:
    return [replace(s, w_WB_W=np.zeros(3)) for s in states]


@pytest.mark.parametrize(
    ("rate", "per_second", "noise"),
    [
        (100.0, 30.0, None),
        (400.0, 120.0, StateNoise(position=1e-3, orientation=5e-3)),
        (
            -700.0,
            120.0,
            StateNoise(position=1e-3, orientation=5e-3, linear_velocity=0.01, angular_velocity=0.05),
        ),
    ],
)
def test_a_ball_keeps_its_sense_of_rotation(rate: float, per_second: float, noise: StateNoise | None) -> None:
    """At 100 rad/s and 30 Hz it turns by 191 degrees from state to state: as seen, by 169 backwards."""
    states = spinning(rate, per_second)
    free = fit_free_motion(BALL, states, gravity_W=np.zeros(3), noise=noise)
    # so little torque that the free motion is right to 1e-5 rad/s, but the fit is that of integrated motions
    torque = ConstantWrench(torque=[0.0, 0.0, 1e-9])
    forced = fit_motion(BALL, states, gravity_W=np.zeros(3), noise=noise, wrench=torque)
    for fit in (free, forced):
        assert fit.state.w_WB_W[2] == pytest.approx(rate, abs=1e-3)
        assert fit.converged
        assert fit.turns_known
        assert fit.alternatives == ()


@pytest.mark.parametrize("noise", [None, StateNoise(position=1e-3, orientation=5e-3)])
def test_without_velocities_the_other_motions_are_alternatives(noise: StateNoise | None) -> None:
    states = poses_of(spinning(100.0, 30.0))
    fit = fit_free_motion(BALL, states, gravity_W=np.zeros(3), noise=noise)
    assert not fit.turns_known
    turn = 2.0 * math.pi * 30.0
    assert fit.state.w_WB_W[2] == pytest.approx(100.0 - turn, abs=1e-3)  # fewer turns than one more
    more = np.array([(state.w_WB_W[2] - 100.0) / turn for state in (fit.state, *fit.alternatives)])
    np.testing.assert_allclose(more, np.round(more), rtol=0.0, atol=1e-5)
    assert {-3, -2, -1, 0, 1} <= {int(number) for number in np.round(more)}
    assert all(state.stamp_ns == states[-1].stamp_ns for state in fit.alternatives)


def test_velocities_that_are_as_far_from_one_motion_as_from_another_decide_nothing() -> None:
    halfway = [replace(s, w_WB_W=[0.0, 0.0, 5.0]) for s in spinning(100.0, 30.0)]
    fit = fit_free_motion(BALL, halfway, gravity_W=np.zeros(3))
    assert not fit.turns_known
    assert fit.alternatives


def test_a_body_that_rests_needs_no_velocities() -> None:
    rng = np.random.default_rng(0)
    resting = [turned(s, rng.normal(scale=2e-3, size=3)) for s in spinning(0.0, 240.0, 24)]
    fit = fit_free_motion(BALL, resting, gravity_W=np.zeros(3))
    assert fit.converged
    assert fit.turns_known


@pytest.mark.parametrize("wrong", ["position", "orientation", "angular_velocity"])
def test_residuals_that_do_not_fit_the_noise_are_not_converged(wrong: str) -> None:
    """A jump in the middle of the window: by 20 deviations for half of the states."""
    noise = {"position": 1e-3, "orientation": 2e-3, "angular_velocity": 0.05}
    jump = {name: 20.0 * size * (name == wrong) * np.ones(3) for name, size in noise.items()}
    states = [
        turned(
            s,
            (k % 2) * jump["orientation"],
            p_WB_W=s.p_WB_W + (k % 2) * jump["position"],
            w_WB_W=s.w_WB_W + (k % 2) * jump["angular_velocity"],
        )
        for k, s in enumerate(spinning(9.0, 240.0, 24))
    ]
    given = StateNoise(**noise)
    assert not fit_free_motion(BALL, states, gravity_W=np.zeros(3), noise=given).converged
    drag = Drag(linear_angular=1e-12)
    assert not fit_motion(BALL, states, gravity_W=np.zeros(3), noise=given, drag=drag).converged
    exact = spinning(9.0, 240.0, 24)
    assert fit_free_motion(BALL, exact, gravity_W=np.zeros(3), noise=given).converged


def test_residuals_of_half_a_radian_are_no_noise() -> None:
    """A body that is turned back and forth."""
    states = spinning(9.0, 240.0, 24)
    swapped = [
        replace(s, q_WB=Rotation.from_rotvec([0.5 * (-1.0) ** k, 0.0, 0.0]).as_quat())
        for k, s in enumerate(states)
    ]
    assert not fit_free_motion(BALL, swapped, gravity_W=np.zeros(3)).converged


# Between two states


@pytest.mark.parametrize("turns", [0.3, 0.5, 0.53, 1.0, 1.5, 2.25, -0.53, -3.5])
def test_between_two_states_a_body_turns_as_its_velocities_say(turns: float) -> None:
    earlier, later = spinning(2.0 * math.pi * 30.0 * turns, 30.0, 2)
    for share in (0.1, 0.5, 0.9):
        between = state_between(earlier, later, round(share * later.stamp_ns))
        true = Rotation.from_rotvec([0.0, 0.0, 2.0 * math.pi * turns * share])
        assert (Rotation.from_quat(between.q_WB) * true.inv()).magnitude() < 1e-6


def test_between_states_with_other_velocities_nothing_is_known() -> None:
    earlier, later = poses_of(spinning(100.0, 30.0, 2))
    with pytest.raises(InvalidFieldError, match=r"stamp must be .*, got one between states 0\.0333 s apart"):
        state_between(earlier, later, 10_000_000)
