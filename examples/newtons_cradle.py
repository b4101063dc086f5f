# SPDX-License-Identifier: Apache-2.0
"""Newton's cradle: the law for several contacts decides which balls leave. Steel balls follow one of them."""

import numpy as np

from contact_dynamics import BodyState, ContactSet, MassProperties
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw, bodies_impact

N, RADIUS = 5, 0.02
ball = MassProperties(mass=0.1, I_B=0.4 * 0.1 * RADIUS**2 * np.eye(3))
states = [
    BodyState(
        p_WB_W=np.array([2.0 * RADIUS * i, 0.0, 0.0]),
        q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
        v_WB_W=np.array([1.0 if i == 0 else 0.0, 0.0, 0.0]),
        w_WB_W=np.zeros(3),
    )
    for i in range(N)
]
contacts = ContactSet(
    p_WC_W=np.array([[RADIUS * (2 * i + 1), 0.0, 0.0] for i in range(N - 1)]),
    normals_W=np.tile([-1.0, 0.0, 0.0], (N - 1, 1)),  # into the left ball of each pair
    frictions=np.full(N - 1, 0.2),
    restitutions=np.ones(N - 1),
)
pairs = [(i, i + 1) for i in range(N - 1)]
for law in SeveralContactsLaw:
    answer = bodies_impact(
        [ball] * N, states, contacts, pairs, several_contacts_law=law, restitution_law=RestitutionLaw.NEWTON
    )
    velocities = " ".join(f"{state.v_WB_W[0] + 0.0:6.3f}" for state in answer.states)
    print(f"{law.name.lower():>12}: {velocities} m/s")
