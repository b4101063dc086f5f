# SPDX-License-Identifier: Apache-2.0
"""Tosses of bodies that begin inside a surface, as measured poses do: they come to rest as others do."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import Body, BodyState, Surface, World
from contact_dynamics.contact import find_contacts
from contact_dynamics.contact_modes import ModeVerdict, SpatialContactProblem, contact_modes
from contact_dynamics.rigid_body import state_covariance
from contact_dynamics.toss import TossEnd, sampled_toss, toss

TABLE = Surface(name="table", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.4, restitution=0.5)
WORLD = World(surfaces=(TABLE,))
DEEP = 0.02  # m


def tilted(size: list[float], depth: float, chance: np.random.Generator) -> BodyState:
    turn = Rotation.from_rotvec(np.radians(3.0) * chance.normal(size=3))
    return BodyState(p_WB_W=[0, 0, 0.5 * size[2] - depth], q_WB=turn.as_quat())


@pytest.mark.parametrize("depth", [0.0, 1e-4, 1e-3, 3e-3])
@pytest.mark.parametrize(("size", "mass"), [([0.016] * 3, 0.004), ([0.15, 0.09, 0.05], 0.4)])
def test_a_body_at_rest_but_for_noise_comes_to_rest(size: list[float], mass: float, depth: float) -> None:
    """Corners that were lifted out of the table stayed microns above it, so 43 of 100 dice never rested."""
    body, chance = Body.box(size, mass=mass), np.random.default_rng(7)
    for _ in range(10):
        found = toss(body, tilted(size, depth, chance), WORLD, horizon=3.0, distance_tolerance=DEEP)
        assert found.end is TossEnd.RESTS
        assert len(found.resting_corners) >= 3
        problem = SpatialContactProblem.of(body, found.state, WORLD)
        assert contact_modes(problem).verdict is ModeVerdict.UNIQUE
        assert len(find_contacts(body, found.state, WORLD)) >= 3


def test_all_samples_of_a_die_at_rest_rest() -> None:
    die = Body.box([0.016] * 3, mass=0.004)
    resting = BodyState(p_WB_W=[0, 0, 0.008], q_WB=[0, 0, 0, 1])
    noise = state_covariance(position=5e-4, rotation=np.radians(3.0), velocity=0.05, angular_velocity=1.0)
    found = sampled_toss(
        die, resting, WORLD, covariance=noise, count=100, to_rest=True, distance_tolerance=DEEP
    )
    assert sum(found.face_probabilities) == pytest.approx(1.0)
