# SPDX-License-Identifier: Apache-2.0
"""A brick above a floor, in flight and on two contacts, for the tests that draw."""

from __future__ import annotations

import numpy as np

from contact_dynamics import Body, BodyState, ContactSet, Surface, World, free_motion
from viewing.drawn import STAMP_NS

BODY = Body.box((0.15, 0.09, 0.05), mass=0.4, name="brick")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5)
WORLD = World(bodies=(BODY,), surfaces=(FLOOR,))
STATE = BodyState(
    p_WB_W=[0.1, -0.2, 1.0],
    q_WB=[0.1, -0.5, 0.7, 0.5],
    v_WB_W=[0.5, 0.3, 1.0],
    w_WB_W=[3.0, -8.0, 1.0],
    stamp_ns=STAMP_NS,
)
TRAJECTORY = free_motion(BODY.mass_properties, STATE).at(np.linspace(0.0, 0.4, 41))
"""0.4 s of flight at 100 Hz."""

TWO_CONTACTS = ContactSet(
    p_WC_W=[[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]],
    normals_W=[0.0, 0.0, 1.0],
    frictions=0.3,
    restitutions=0.5,
    surfaces=("floor", "floor"),
)
