"""Where a tossed box lands, which corner strikes first, and what it does after that."""

import numpy as np

from contact_dynamics import Body, BodyState, MassProperties, Surface, World, next_landing, spatial_impact
from contact_dynamics.shapes import box_vertices

box = Body(
    name="box",
    mass_properties=MassProperties(mass=0.4, I_B=np.diag([3.53e-4, 8.33e-4, 1.02e-3])),
    vertices_B=box_vertices((0.15, 0.09, 0.05)),
)
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
print(f"in {landing.seconds:.6f} s at {landing.contacts.p_WC_W[0]}, at {landing.velocities_W[0]} m/s")

impact = spatial_impact(box.mass_properties, landing.state, landing.contacts[0])
print(f"the contact {impact.outcome.name.lower().replace('_', ' ')}; impulse {impact.impulse_W} N s")
print(
    f"then v = {impact.state.v_WB_W} m/s, w = {impact.state.w_WB_W} rad/s; {-impact.energy_change:.3f} J lost"
)
