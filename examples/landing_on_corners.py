# SPDX-License-Identifier: Apache-2.0
"""A brick lands nearly flat: corner after corner in time, and what laws for all at once make of it."""

import numpy as np

from contact_dynamics import (
    Body,
    BodyState,
    Surface,
    World,
    find_contacts,
    impact_sequence,
    next_landing,
    several_impact,
)
from contact_dynamics.impact import SeveralContactsLaw, outcomes_over_orders

brick = Body.box((0.15, 0.09, 0.05), mass=0.4, name="brick")
floor = Surface(
    name="floor", p_WS_W=np.zeros(3), normal_W=np.array([0.0, 0.0, 1.0]), friction=0.3, restitution=0.3
)
world = World(bodies=(brick,), surfaces=(floor,))
dropped = BodyState(
    p_WB_W=np.array([0.0, 0.0, 0.3]),
    q_WB=np.array([0.01, 0.02, 0.0, 0.99975]),  # tilted by 2.6 degrees
    v_WB_W=np.zeros(3),
    w_WB_W=np.zeros(3),
)
landing = next_landing(brick, dropped, world, horizon=1.0)
if landing is None:
    raise SystemExit("it does not land within 1 s")

print("in time, going on over corners that stay:")
sequence = impact_sequence(brick, landing.state, world, window=0.03, hold_step=1e-3)
for strike in sequence.strikes[:6]:
    print(
        f"  {1e3 * strike.seconds:7.3f} ms: corner {strike.contact} {strike.outcome.name.lower()},"
        f" impulse {strike.impulse_W[2]:.3f} N s"
    )
print(f"  in all {len(sequence.strikes)} strikes, then it {sequence.end.name.lower().replace('_', ' ')}")

corners = find_contacts(brick, landing.state, world, distance_tolerance=0.01)
print(f"as if its {len(corners)} corners struck at once, velocity and spin after:")
for law in SeveralContactsLaw:
    after = several_impact(brick, landing.state, corners, several_contacts_law=law).state
    print(f"  {law.name.lower()}: {after.v_WB_W.round(3)} m/s, {after.w_WB_W.round(2)} rad/s")
spread = outcomes_over_orders(brick, landing.state, corners).spread
print(f"  over all orders they differ by up to {spread[:3].max():.2f} m/s and {spread[3:].max():.1f} rad/s")
