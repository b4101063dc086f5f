# SPDX-License-Identifier: Apache-2.0
"""Impacts of a brick with known restitution and friction, and with the scatter that is stated."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from calibration.made_tosses import BRICK
from contact_dynamics.evaluation.model_error import FREEDOM
from contact_dynamics.impact.spatial.batch import StrikingBodies
from contact_dynamics.monitoring.evidence import ImpactEvidence
from contact_dynamics.rigid_body.body import BodyState

CONFIGURED = np.array([0.4, 0.3])
"""Restitution and friction."""

PUSH = 0.07  # m/s, scatter of the velocity by an impulse at the contact
TURN = 0.3  # rad/s, scatter of the spin besides


def made_impact(random: np.random.Generator, restitution: float, friction: float) -> ImpactEvidence:
    """An impact of one corner. The scatter has the tails of Student's t."""
    properties = BRICK.mass_properties
    while True:
        q = random.standard_normal(4)
        state = BodyState(
            p_WB_W=[0.0, 0.0, 0.0],
            q_WB=q / np.linalg.norm(q),
            v_WB_W=[*random.uniform(-1.5, 1.5, 2), random.uniform(-2.5, -1.2)],
            w_WB_W=random.uniform(-7.0, 7.0, 3),
        )
        corners = BRICK.vertices_B @ state.R_WB.T
        low = np.sort(corners[:, 2])
        arm = corners[corners[:, 2].argmin()]
        if low[1] - low[0] > 0.02 and state.velocity_of_point(arm)[2] < -0.5:
            break
    inertia_W = state.R_WB @ properties.I_B @ state.R_WB.T
    turns = properties.mass * np.linalg.solve(inertia_W, np.cross(arm, np.eye(3)).T)
    through = np.vstack([np.eye(3), turns])
    scatter = PUSH**2 * through @ through.T + np.diag([1e-6] * 3 + [TURN**2] * 3)
    off = np.linalg.cholesky(scatter) @ random.standard_normal(6)
    unmeasured = ImpactEvidence(
        struck=StrikingBodies.of(
            properties,
            p_WB_W=state.p_WB_W,
            q_WB=state.q_WB,
            v_WB_W=state.v_WB_W,
            w_WB_W=state.w_WB_W,
            p_WC_W=arm,
        ),
        normal_W=np.array([0.0, 0.0, 1.0]),
        measured=np.zeros(6),
        inverse=np.linalg.inv(scatter),
        configured=CONFIGURED,
        freedom=FREEDOM,
    )
    exact = -unmeasured.differences(np.array([[restitution, friction]]))[0]
    return replace(unmeasured, measured=exact + off * math.sqrt(FREEDOM / random.chisquare(FREEDOM)))
