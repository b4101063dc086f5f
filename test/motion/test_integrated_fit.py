# SPDX-License-Identifier: Apache-2.0
"""Fits under torque and drag: exact states are found again, errors are as large as their covariance says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion import ConstantWrench, Drag, StateNoise, WrenchAxes
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.motion.integrated import forced_motion
from contact_dynamics.motion.integrated_fit import fit_motion
from contact_dynamics.rigid_body import BodyState, MassProperties
from motion.evidence import error, published

BODY = MassProperties(mass=0.4, I_B=np.diag([3.5e-4, 8.3e-4, 1.02e-3]))
NEWEST = BodyState(
    p_WB_W=[0.1, -0.2, 1.0],
    q_WB=Rotation.from_euler("xyz", [0.3, -1.1, 2.0]).as_quat(),
    v_WB_W=[5.0, 0.5, -1.0],
    w_WB_W=[0.5, 9.0, 1.0],
    stamp_ns=5_000_000_000,
)
FORCES = {
    "drag": {"drag": Drag(quadratic=0.02, quadratic_angular=1e-5)},
    "body wrench": {
        "wrench": ConstantWrench(force=[2.0, 0.0, 1.0], torque=[0.01, 0.0, 0.02], axes=WrenchAxes.BODY)
    },
    "a function": {"wrench_of": lambda t, sample: ([-4.0 * x for x in sample.p_WB_W], [0.01 * t, 0.0, 0.02])},
}
POSE = StateNoise(position=2e-4, orientation=2e-3)
ALL = StateNoise(position=2e-4, orientation=2e-3, linear_velocity=0.02, angular_velocity=0.2)


def window(forces: dict, *, noise: StateNoise | None = None, seed: int = 0) -> list[BodyState]:
    """24 states over 0.1 s that end with `NEWEST`; without noise their velocities are useless."""
    rng = np.random.default_rng(seed)
    motion = forced_motion(BODY, NEWEST, **forces)
    states = [motion.state_at(float(seconds)) for seconds in np.arange(-23, 1) / 240.0]
    if noise is None:
        return [replace(state, v_WB_W=[9.0, 9.0, 9.0], w_WB_W=np.zeros(3)) for state in states]
    return [published(state, rng, noise) for state in states]


@pytest.mark.parametrize(("name", "noise"), [*((name, None) for name in FORCES), (next(iter(FORCES)), POSE)])
def test_exact_poses_are_found_again(name: str, noise: StateNoise | None) -> None:
    """Stamps are whole nanoseconds, of 5 m/s and 9 rad/s."""
    fit = fit_motion(BODY, window(FORCES[name]), noise=noise, **FORCES[name])
    assert fit.converged
    assert np.abs(error(fit.state, NEWEST)[:6]).max() < 2e-8
    assert np.abs(error(fit.state, NEWEST)[6:]).max() < 1e-6
    assert fit.position_residual < 1e-8
    assert fit.orientation_residual < 2e-8
    assert (fit.count, fit.state.stamp_ns) == (24, NEWEST.stamp_ns)


def test_a_free_fit_is_wrong_where_drag_acts() -> None:
    states = window(FORCES["drag"])
    free = fit_free_motion(BODY, states)
    assert np.abs(error(free.state, NEWEST)[6:9]).max() > 0.05
    assert np.abs(error(fit_motion(BODY, states, **FORCES["drag"]).state, NEWEST)[6:9]).max() < 1e-6


@pytest.mark.parametrize(("name", "assumed"), [("drag", ALL), ("body wrench", None)])
def test_errors_are_as_large_as_the_covariance_says(name: str, assumed: StateNoise | None) -> None:
    """e^T C^-1 e is of chi^2 with 12 degrees of freedom: its mean over 12 fits is 12 +- 1.4.

    A covariance from residuals of 60 degrees of freedom is itself uncertain, which makes the tail longer.
    """
    squares = []
    for seed in range(12):
        fit = fit_motion(BODY, window(FORCES[name], noise=ALL, seed=seed), noise=assumed, **FORCES[name])
        assert fit.converged
        off = error(fit.state, NEWEST)
        squares.append(float(off @ np.linalg.solve(fit.covariance, off)))
    assert 12.0 - 4.0 < np.mean(squares) < 12.0 + 5.0


def test_without_forces_it_is_the_free_fit_in_the_fall_that_remains() -> None:
    pushed = {"wrench": ConstantWrench(force=[0.4, 0.0, 0.8])}
    states = window(pushed, noise=POSE)
    found = fit_motion(BODY, states, **pushed)
    expected = fit_free_motion(BODY, states, gravity_W=[1.0, 0.0, 2.0 - 9.80665])
    np.testing.assert_array_equal(found.covariance, expected.covariance)
    np.testing.assert_array_equal(found.state.v_WB_W, expected.state.v_WB_W)


def test_misuse_is_refused_by_name() -> None:
    states = window(FORCES["drag"])
    with pytest.raises(InvalidFieldError, match=r"states must be .*, got 2 states"):
        fit_motion(BODY, states[-2:], **FORCES["drag"])
    with pytest.raises(InvalidFieldError, match=r"seconds must be .* the motion stays within bounds"):
        fit_motion(BODY, states, drag=Drag(quadratic=50.0))
    with pytest.raises(InvalidFieldError, match=r"no further than 2 steps"):
        fit_motion(BODY, states, max_steps=2, **FORCES["drag"])
