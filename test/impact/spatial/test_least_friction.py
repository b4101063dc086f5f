# SPDX-License-Identifier: Apache-2.0
"""Friction so small that it changes nothing acts as none does, down to the least number there is."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics import BodyState, Contact, MassProperties
from contact_dynamics.impact import RestitutionLaw, spatial_impact

BODIES = {
    "ball": MassProperties(mass=0.1, I_B=4e-5 * np.eye(3)),
    "brick": MassProperties(mass=0.4, I_B=np.diag([3.5e-4, 8.3e-4, 1.02e-3])),
}
STATE = BodyState(p_WB_W=[0.0, 2.9, 1.0], q_WB=[0, 0, 1, 0], v_WB_W=[0, -0.4, 1.0], w_WB_W=[2.4, -0.5, 0.0])
SIZES = [5e-324, *(10.0**-k for k in (320, 308, 300, 200, 100, 60, 35, 30, 25, 21, 19, 17, 15))]


@pytest.mark.parametrize("friction", SIZES)
@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("body", BODIES)
def test_the_least_friction_acts_as_none(body: str, law: RestitutionLaw, friction: float) -> None:
    slid, free = (
        spatial_impact(
            BODIES[body],
            STATE,
            Contact(p_WC_W=[-0.45, -0.45, 1.0], normal_W=[0, 0, 1], friction=mu, restitution=0.3),
            restitution_law=law,
        ).state
        for mu in (friction, 0.0)
    )
    # The arm is ten times the body, so that friction acts a hundred times as much, and rounding too.
    np.testing.assert_allclose(slid.v_WB_W, free.v_WB_W, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(slid.w_WB_W, free.w_WB_W, rtol=0.0, atol=1e-11)
