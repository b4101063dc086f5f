# SPDX-License-Identifier: Apache-2.0
"""Mass properties and states: what is refused, and momenta and energies beside sums over particles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.rigid_body.body import (
    angular_momentum,
    kinetic_energy,
    momentum,
    rotational_energy,
    state_covariance,
)

REST = {
    "p_WB_W": np.zeros(3),
    "q_WB": np.array([0.0, 0.0, 0.0, 1.0]),
    "v_WB_W": np.zeros(3),
    "w_WB_W": np.zeros(3),
}
vectors = st.tuples(*[st.floats(-5.0, 5.0)] * 3).map(np.array)
quaternions = st.integers(0, 2**32 - 1).map(lambda seed: Rotation.random(random_state=seed).as_quat())


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        (np.diag([1.0, 1.0, 2.1]), r"I1 \+ I2 >= I3"),
        (np.diag([1.0, -1.0, 1.0]), "positive definite"),
        (np.diag([0.0, 1.0, 1.0]), "positive definite"),
        (np.array([[1.0, 0.1, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]]), "symmetric"),
    ],
)
def test_an_inertia_that_no_body_has_is_refused(inertia: np.ndarray, words: str) -> None:
    with pytest.raises(InvalidFieldError, match=f"I_B must be .*{words}"):
        MassProperties(mass=1.0, I_B=inertia)


def test_a_flat_body_is_accepted() -> None:
    """I1 + I2 = I3, also where the last printed digit is rounded."""
    MassProperties(mass=1.0, I_B=np.diag([1.0, 2.0, 3.0]))
    MassProperties(mass=1.0, I_B=np.diag([0.3333333, 0.3333333, 0.6666667]))


def test_what_was_given_stays_the_callers_and_what_is_kept_cannot_change() -> None:
    inertia = np.eye(3)
    body = MassProperties(mass=1.0, I_B=inertia)
    inertia[0, 0] = 7.0
    assert body.I_B[0, 0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        body.I_B[0, 0] = 2.0


def test_a_quaternion_of_four_decimals_is_taken_and_made_unit() -> None:
    state = BodyState(**{**REST, "q_WB": np.array([0.5774, 0.5774, 0.5774, 0.0])})
    assert np.linalg.norm(state.q_WB) == pytest.approx(1.0, abs=1e-15)


@given(q=quaternions)
def test_an_attitude_may_be_given_with_w_first(q: np.ndarray) -> None:
    moving = {"p_WB_W": np.zeros(3), "v_WB_W": np.zeros(3), "w_WB_W": np.zeros(3)}
    state = BodyState(quaternion_wxyz=[q[3], q[0], q[1], q[2]], **moving)
    np.testing.assert_array_equal(state.q_WB, BodyState(q_WB=q, **moving).q_WB)
    assert not state.q_WB.flags.writeable
    np.testing.assert_array_equal(replace(state, stamp_ns=1).q_WB, state.q_WB)
    with pytest.raises(InvalidFieldError, match=r"q_WB or quaternion_wxyz must be given.*, got both"):
        BodyState(q_WB=q, quaternion_wxyz=q, **moving)
    with pytest.raises(InvalidFieldError, match=r"q_WB or quaternion_wxyz must be .*, got neither"):
        BodyState(**moving)
    with pytest.raises(InvalidFieldError, match=r"quaternion_wxyz must be .*, got"):
        BodyState(quaternion_wxyz=2.0 * q, **moving)


def test_a_state_without_velocities_is_at_rest() -> None:
    state = BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1])
    assert not state.v_WB_W.any()
    assert not state.w_WB_W.any()


@given(q=quaternions, v=vectors, w=vectors, points=st.lists(vectors, min_size=4, max_size=8))
def test_momenta_and_energy_are_the_sums_over_particles(
    q: np.ndarray, v: np.ndarray, w: np.ndarray, points: list[np.ndarray]
) -> None:
    """A body of equal particles: lecture 24's sums, without an inertia matrix."""
    arms = np.array(points) + 1e-3 * np.eye(8, 3)[: len(points)]
    arms = np.vstack([arms, -arms])  # symmetric: the centre of mass is the origin
    mass = 0.1
    inertia = mass * sum((r @ r) * np.eye(3) - np.outer(r, r) for r in arms)
    if np.linalg.eigvalsh(inertia)[0] < 1e-6:
        return  # the particles lie on a line: no rigid body
    body = MassProperties(mass=mass * len(arms), I_B=inertia)
    state = BodyState(p_WB_W=np.zeros(3), q_WB=q, v_WB_W=v, w_WB_W=w)
    arms_W = Rotation.from_quat(q).apply(arms)
    velocities = v + np.cross(w, arms_W)
    scale = 1e-13 * mass * len(arms) * 1e4  # rounding of sums of numbers up to 5 * 5 * 5 * sqrt(3)^3
    np.testing.assert_allclose(momentum(body, state), mass * velocities.sum(axis=0), atol=scale)
    L_W = mass * np.cross(arms_W, velocities).sum(axis=0)
    np.testing.assert_allclose(angular_momentum(body, state), L_W, atol=scale)
    assert kinetic_energy(body, state) == pytest.approx(0.5 * mass * float((velocities**2).sum()), abs=scale)
    assert rotational_energy(body, state) == pytest.approx(0.5 * float(w @ L_W), abs=scale)
    np.testing.assert_allclose(state.velocity_of_point(arms_W), velocities, atol=1e-12)


def test_the_radius_of_gyration_of_a_thin_ring() -> None:
    ring = MassProperties(mass=2.0, I_B=np.diag([4.0, 4.0, 8.0]))  # radius 2 m: m r^2 about its axis
    assert ring.radius_of_gyration(np.array([0.0, 0.0, 1.0])) == pytest.approx(2.0, abs=1e-15)
    assert ring.angular_inertia_about(np.array([1.0, 0.0, 0.0])) == 4.0


def test_a_state_with_other_velocities_keeps_pose_and_time_and_refuses_what_a_state_refuses() -> None:
    state = BodyState(**{**REST, "p_WB_W": [1.0, 2.0, 3.0]}, stamp_ns=7)
    moving = state.with_velocities((1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    other = replace(state, v_WB_W=[1.0, 0.0, 0.0], w_WB_W=[0.0, 2.0, 0.0])
    assert moving.to_dict() == other.to_dict()
    assert not moving.v_WB_W.flags.writeable
    for velocities in (((math.nan, 0.0, 0.0), (0.0, 0.0, 0.0)), ((0.0, 0.0, 0.0), (0.0, 0.0))):
        with pytest.raises(InvalidFieldError, match="_WB_W"):
            state.with_velocities(*velocities)


def test_a_covariance_has_one_deviation_for_all_axes_or_one_for_each() -> None:
    deviations = {"position": 1e-3, "rotation": [0.1, 0.2, 0.0], "velocity": (0.0, 0.3, 0.4)}
    expected = [1e-3, 1e-3, 1e-3, 0.1, 0.2, 0.0, 0.0, 0.3, 0.4, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(state_covariance(**deviations), np.diag(np.square(expected)), rtol=1e-15)
    with pytest.raises(InvalidFieldError, match=r"velocity must be of shape \(3,\), got shape \(2,\)"):
        state_covariance(velocity=[0.1, 0.2])
