# SPDX-License-Identifier: Apache-2.0
"""What must not change the modes in space: names of contacts, axes, handedness, units of mass."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties
from contact_dynamics.contact_modes import SpatialModeAnswer, contact_modes
from contact_modes.evidence import spatial_problem
from sweeps import seeds

INERTIA = np.diag([0.3, 0.4, 0.5])


class Case:
    """A body at rest or sliding on drawn contacts; axes of the body and of the world are the same."""

    def __init__(self, seed: int) -> None:
        chance = np.random.default_rng(seed)
        n = int(chance.integers(2, 5))
        self.points = chance.normal(size=(n, 3))
        normals = np.array([0.0, 0.0, 1.0]) + 0.6 * chance.normal(size=(n, 3))
        self.normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        self.frictions = chance.choice([0.3, 1.0, 2.5], size=n)
        self.wrench = chance.normal(size=6) - [0.0, 0.0, 2.0, 0.0, 0.0, 0.0]
        # Two contacts can slide together along the line that both surfaces share.
        self.v = np.zeros(3)
        if n == 2 and seed % 2:
            self.v = np.cross(self.normals[0], self.normals[1])
        self.inertia, self.mass = INERTIA, 2.0

    def answer(self, facets: int = 7) -> SpatialModeAnswer:
        return contact_modes(
            spatial_problem(
                MassProperties(mass=self.mass, I_B=self.inertia),
                BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=self.v),
                ContactSet(p_WC_W=self.points, normals_W=self.normals, frictions=self.frictions),
                self.wrench[:3],
                self.wrench[3:],
                friction_facets=facets,
            )
        )


def same_modes(one: SpatialModeAnswer, other: SpatialModeAnswer, turned: np.ndarray, axial: float) -> None:
    """Compare letters, and accelerations where they are unique, after turning (or mirroring) the axes."""
    assert one.verdict == other.verdict
    assert sorted(mode.mode for mode in one.modes) == sorted(mode.mode for mode in other.modes)
    for mode in one.modes:
        if not mode.motion_unique:
            continue
        expected = np.concatenate(
            [turned @ mode.acceleration_W, axial * turned @ mode.angular_acceleration_W]
        )
        found = [
            np.concatenate([twin.acceleration_W, twin.angular_acceleration_W])
            for twin in other.modes
            if twin.mode == mode.mode
        ]
        assert min(np.abs(twin - expected).max() for twin in found) <= 1e-6 * (1.0 + np.abs(expected).max())


@seeds(range(4), slow=range(4, 60))
def test_other_axes(seed: int) -> None:
    # A mirror image has its torques and angular accelerations reversed, as axial vectors are.
    mirrored = 1.0 if seed % 4 < 2 else -1.0
    case = Case(seed)
    before = case.answer(facets=8)
    turned = np.linalg.qr(np.random.default_rng(seed + 2).normal(size=(3, 3)))[0]
    turned[:, 0] *= mirrored * np.sign(np.linalg.det(turned))
    case.points, case.normals, case.v = case.points @ turned.T, case.normals @ turned.T, turned @ case.v
    case.inertia = turned @ case.inertia @ turned.T
    case.wrench = np.concatenate([turned @ case.wrench[:3], mirrored * turned @ case.wrench[3:]])
    same_modes(before, case.answer(facets=8), turned, mirrored)


@seeds(range(4), slow=range(4, 60))
def test_other_units_of_mass(seed: int) -> None:
    factor = (1e-6, 1e-2, 1e4)[seed % 3]
    case = Case(seed)
    before = case.answer()
    case.mass, case.inertia, case.wrench = (factor * case.mass, factor * case.inertia, factor * case.wrench)
    after = case.answer()
    same_modes(before, after, np.eye(3), 1.0)
    for one, other in zip(before.modes, after.modes, strict=True):
        size = np.abs(one.contact_forces_W).max()
        np.testing.assert_allclose(
            other.contact_forces_W, factor * one.contact_forces_W, atol=1e-6 * factor * (1.0 + size)
        )


@pytest.mark.parametrize("length", [1e-3, 1e3])
def test_other_units_of_length(length: float) -> None:
    for seed in range(4):
        case = Case(seed)
        before = case.answer()
        case.points, case.inertia, case.v = length * case.points, length**2 * case.inertia, length * case.v
        case.wrench = case.wrench * np.array([length] * 3 + [length**2] * 3)
        after = case.answer()
        assert sorted(mode.mode for mode in before.modes) == sorted(mode.mode for mode in after.modes)
