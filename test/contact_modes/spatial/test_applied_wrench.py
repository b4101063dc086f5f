# SPDX-License-Identifier: Apache-2.0
"""From every consistent mode the wrench that was applied comes back."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import SpatialContactProblem, contact_modes
from contact_dynamics.contact_modes.result import applied_wrench
from contact_dynamics.errors import InvalidFieldError, NoContactError
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.world import Body, Surface, World
from contact_modes.evidence import spatial_problem
from sweeps import seeds

BODY = MassProperties(mass=0.7, I_B=np.diag([0.02, 0.05, 0.06]))


@seeds(range(20))
def test_the_applied_wrench_follows_from_each_mode(seed: int) -> None:
    """The body is turned and spins, and up to three contacts leave or stay."""
    random = np.random.default_rng(seed)
    q = random.normal(size=4)
    state = BodyState(
        p_WB_W=random.normal(size=3),
        q_WB=q / np.linalg.norm(q),
        w_WB_W=random.normal(size=3) * (0.0 if seed % 2 else 3.0),
    )
    arms = random.uniform(-0.2, 0.2, size=(1 + seed % 3, 3)) - (0.0, 0.0, 0.2)
    points = state.p_WB_W + arms
    contacts = ContactSet(p_WC_W=points, normals_W=np.tile([0.0, 0.0, 1.0], (len(arms), 1)), frictions=0.5)
    approach = min(0.0, float(state.velocity_of_point(points)[:, 2].min()))
    state = BodyState(p_WB_W=state.p_WB_W, q_WB=state.q_WB, v_WB_W=[0.0, 0.0, -approach], w_WB_W=state.w_WB_W)
    force_W, torque_W = random.normal(size=3) - (0.0, 0.0, 5.0), 0.1 * random.normal(size=3)
    problem = spatial_problem(BODY, state, contacts, force_W, torque_W)
    found = contact_modes(problem)
    assert found.modes
    for mode in found.modes:
        wrench_W = applied_wrench(BODY, state, contacts, mode)
        size = math.hypot(*force_W) + float(np.abs(mode.contact_forces_W).sum())
        np.testing.assert_allclose(wrench_W, [*force_W, *torque_W], atol=1e-9 * size)


def test_a_push_at_a_point_and_the_weight_make_the_wrench() -> None:
    """By hand: a crate of 20 kg that is pushed 0.2 m above its centre, and tips from m g 0.2 / 0.5 on."""
    crate = Body.box((0.4, 0.3, 0.6), mass=20.0, name="crate")
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=0.3)
    world = World(surfaces=(floor,), gravity_W=[0, 0, -10.0])
    state = BodyState(p_WB_W=[1, 0, 0.3], q_WB=[0, 0, 0, 1])
    for push, mode in ((79.9, "ffff"), (80.1, "ssff")):
        problem = SpatialContactProblem.of(
            crate, state, world, force_W=[push, 0, 0], at_W=[0.8, 0, 0.5], torque_W=[0, 0, 0.1]
        )
        np.testing.assert_allclose(problem.wrench_W, [push, 0, -200.0, 0, 0.2 * push, 0.1], atol=1e-12)
        assert [found.mode for found in contact_modes(problem).modes] == [mode]
    # A point without a force would be ignored. A sweep of pushes may begin at zero.
    with pytest.raises(InvalidFieldError, match=r"^at_W must be left out unless force_W is given"):
        SpatialContactProblem.of(crate, state, world, torque_W=[0, 0, 0.1], at_W=[0.8, 0, 0.5])
    SpatialContactProblem.of(crate, state, world, force_W=[0, 0, 0], at_W=[0.8, 0, 0.5])
    with pytest.raises(NoContactError, match=r"no point of 'crate' is within 1e-06 m of a surface"):
        SpatialContactProblem.of(crate, replace(state, p_WB_W=[0, 0, 0.31]), world)
