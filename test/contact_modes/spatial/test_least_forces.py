# SPDX-License-Identifier: Apache-2.0
"""Where many contact forces cause one motion, the answer shows those of least sum of squares."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties
from contact_dynamics.contact_modes import SpatialModeAnswer, contact_modes
from contact_modes.evidence import spatial_problem
from sweeps import seeds

CUBE = MassProperties(mass=1.0, I_B=np.eye(3) / 6.0)
AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
FEET = np.array([[x, y, -0.5] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
UP = [0.0, 0.0, 1.0]


def answer_of(
    contacts: ContactSet, force: list[float], torque: list[float] | None = None
) -> SpatialModeAnswer:
    problem = spatial_problem(CUBE, AT_REST, contacts, force, torque or [0.0, 0.0, 0.0])
    return contact_modes(problem)


def least_by_projections(A: np.ndarray, b: np.ndarray, normals: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return the f of least norm with A f = b in round cones, by Dykstra's alternating projections."""
    inverse = np.linalg.pinv(A, rcond=1e-10)
    x = np.zeros(3 * len(mu))
    of_plane, of_cones = np.zeros_like(x), np.zeros_like(x)
    for _ in range(20_000):
        y = x + of_plane
        met = y - inverse @ (A @ y - b)
        of_plane = y - met
        z = met + of_cones
        f = z.reshape(-1, 3).copy()
        for i, force in enumerate(f):
            along = float(force @ normals[i])
            across = force - along * normals[i]
            lean = float(np.linalg.norm(across))
            if lean > mu[i] * along:
                share = max(0.0, (along + mu[i] * lean) / (1.0 + mu[i] ** 2))
                f[i] = share * (normals[i] + mu[i] * across / lean)
        change = float(np.abs(f.ravel() - x).max())
        x, of_cones = f.ravel(), z - f.ravel()
        if change <= 1e-13:
            break
    return x.reshape(-1, 3)


@seeds(range(5), slow=range(5, 400))
def test_forces_of_a_body_at_rest_are_those_of_alternating_projections(seed: int) -> None:
    chance = np.random.default_rng(seed)
    n = int(chance.integers(3, 9))
    points = chance.uniform(-0.5, 0.5, size=(n, 3))
    normals = np.tile(UP, (n, 1))
    if seed % 2:
        points[:, 2] = -0.5
        mu = np.full(n, 0.5)
    else:
        normals[n // 2 :] = [0.0, 0.6, 0.8]
        mu = chance.uniform(0.3, 0.8, size=n)
    # Forces inside the cones make the load, so that a body at rest can stay there.
    pressing = chance.uniform(0.1, 1.0, size=(n, 1))
    sideways = np.cross(normals, chance.normal(size=(n, 3)))
    sideways *= 0.9 * mu[:, None] / np.linalg.norm(sideways, axis=1)[:, None]
    held = pressing * (normals + sideways)
    A = np.vstack([np.tile(np.eye(3), n), np.hstack([np.cross(p, np.eye(3)).T for p in points])])
    b = A @ held.ravel()
    answer = answer_of(
        ContactSet(p_WC_W=points, normals_W=normals, frictions=mu), (-b[:3]).tolist(), (-b[3:]).tolist()
    )
    rest = next(mode for mode in answer.modes if mode.mode == "f" * n)
    least = least_by_projections(A, b, normals, mu)
    forces = rest.contact_forces_W
    size = float(np.linalg.norm(least))
    # The projections creep where a force is on its cone: they end within 1e-6.
    assert float(np.linalg.norm(forces)) <= size * (1.0 + 1e-6)
    np.testing.assert_allclose(A @ forces.ravel(), b, rtol=0.0, atol=1e-11 * size)
    np.testing.assert_allclose(forces, least, rtol=0.0, atol=1e-3 * size)


def test_a_cube_pushed_along_its_diagonal_has_forces_that_are_the_same_on_both_sides_of_it() -> None:
    answer = answer_of(ContactSet(p_WC_W=FEET, normals_W=UP, frictions=0.5), [2.5, 2.5, -9.81])
    (mode,) = answer.modes
    assert mode.mode == "ffff"
    mirrored = mode.contact_forces_W[[0, 2, 1, 3]][:, [1, 0, 2]]
    np.testing.assert_allclose(mode.contact_forces_W, mirrored, rtol=0.0, atol=1e-12)


def test_two_fingers_hold_a_cube_with_no_more_than_it_takes() -> None:
    fingers = ContactSet(
        p_WC_W=[[0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]],
        normals_W=[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        frictions=0.5,
    )
    held = next(mode for mode in answer_of(fingers, [0.0, 0.0, -2.0]).modes if mode.mode == "ff")
    expected = [
        [-2.0, 0.0, 1.0],
        [2.0, 0.0, 1.0],
    ]  # half of the weight each, which takes a squeeze of twice that
    np.testing.assert_allclose(held.contact_forces_W, expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("scale", [1e-12, 1e-9, 1e-6, 1e-3, 0.1])
def test_forces_at_the_limit_of_friction_are_found_from_near_and_far(scale: float) -> None:
    # Friction holds a push of half the weight, and each foot then has friction mu f_n along the push.
    push = 0.5 * 9.81 * (1.0 - scale)
    answer = answer_of(ContactSet(p_WC_W=FEET, normals_W=UP, frictions=0.5), [push, 0.0, -9.81])
    for mode in answer.modes:
        assert mode.mode in ("ffff", "cccc")
        forces = mode.contact_forces_W
        assert np.all(np.abs(forces[:, 0]) <= 0.5 * forces[:, 2] * (1.0 + 1e-9))
        np.testing.assert_allclose(forces[[0, 2]], forces[[1, 3]], rtol=0.0, atol=1e-6)
        np.testing.assert_allclose(forces[:2, 2] + forces[2:, 2], 9.81 / 2.0, rtol=1e-9)
