# SPDX-License-Identifier: Apache-2.0
"""An oracle's toss in the demo's own type."""

from __future__ import annotations

import numpy as np

from contact_dynamics import Body, MassProperties, Surface
from contact_dynamics.measured.recorded_toss import Toss
from oracles.bouncing_toss import MOMENTS, RATE, KnownToss

P_NOISE = 2e-4
Q_NOISE = 1.75e-3
CORNERS = np.array([[x, y, z] for x in (-0.075, 0.075) for y in (-0.045, 0.045) for z in (-0.025, 0.025)])


def as_toss(known: KnownToss, *, p_noise: float = P_NOISE, q_noise: float = Q_NOISE) -> Toss:
    """The toss as measured; velocities, which nothing here reads, are zero."""
    return Toss(
        source="oracle",
        body=Body(
            name="brick", mass_properties=MassProperties(mass=0.4, I_B=np.diag(MOMENTS)), vertices_B=CORNERS
        ),
        box_size=np.array([0.15, 0.09, 0.05]),
        surface=Surface(
            name="floor", p_WS_W=[0.0, 0.0, 0.3], normal_W=[0.0, 0.0, 1.0], friction=0.3, restitution=0.45
        ),
        gravity_W=np.array([0.0, 0.0, -9.81]),
        rate=RATE,
        position_noise=p_noise,
        orientation_noise=q_noise,
        times=known.times,
        p_WB_W=known.p,
        q_WB=known.q,
        v_WB_W=np.zeros_like(known.p),
        w_WB_W=np.zeros_like(known.p),
    )
