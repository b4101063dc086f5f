# SPDX-License-Identifier: Apache-2.0
"""Where a tossed box lands, which corner strikes first, and what it does after that."""

import numpy as np

from contact_dynamics import Body, BodyState, Surface, World, next_landing, spatial_impact

box = Body.box((0.15, 0.09, 0.05), mass=0.4, name="box")
floor = Surface(
    name="floor", p_WS_W=np.zeros(3), normal_W=np.array([0.0, 0.0, 1.0]), friction=0.3, restitution=0.45
)
tossed = BodyState(
    p_WB_W=np.array([0.0, 0.0, 1.0]),
    q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
    v_WB_W=np.array([1.0, 0.0, 2.0]),
    w_WB_W=np.array([3.0, 8.0, 1.0]),
)
landing = next_landing(box, tossed, World(bodies=(box,), surfaces=(floor,)), horizon=2.0)
if landing is None:
    raise SystemExit("it does not land within 2 s")
corner, velocity = landing.contacts.p_WC_W[0].round(4) + 0.0, landing.velocities_W[0].round(3)
print(f"a corner strikes after {landing.seconds:.4f} s, at {corner} m, with {velocity} m/s")

(contact,) = landing.contacts  # one corner; an edge or a face has several
impact = spatial_impact(box, landing.state, contact)
outcome = impact.outcome.name.lower().replace("_", " ")
print(f"its contact {outcome}, with an impulse of {impact.impulse_W.round(3)} N s")
after = impact.state
print(f"the box then has v = {after.v_WB_W.round(3)} m/s and w = {after.w_WB_W.round(2)} rad/s", end="")
print(f", and has lost {-impact.energy_change:.3f} J")
