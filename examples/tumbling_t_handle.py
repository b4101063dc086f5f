# SPDX-License-Identifier: Apache-2.0
"""Spin a body about its middle axis, and see it flip: the Dzhanibekov effect, hours ahead and to rounding."""

import math

import numpy as np

from contact_dynamics import BodyState, MassProperties, free_motion
from contact_dynamics.tumbling import poinsot

body = MassProperties(mass=0.2, I_B=np.diag([1.0e-4, 2.0e-4, 2.8e-4]))
spin = BodyState(
    p_WB_W=np.zeros(3),
    q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
    v_WB_W=np.zeros(3),
    w_WB_W=np.array([0.001, 10.0, 0.0]),  # rad/s: the middle axis, but for 1 mrad/s
)
motion = free_motion(body, spin, gravity_W=(0.0, 0.0, 0.0))
picture = poinsot(motion)

print(f"regime: {picture.regime.name.lower()}, the polhode repeats every {picture.polhode_period:.4f} s")
for seconds in (0.0, 0.25 * picture.polhode_period, 0.5 * picture.polhode_period, 3600.0):
    state = motion.state_at(seconds)
    w_B = state.R_WB.T @ state.w_WB_W
    axis_W = state.R_WB[:, 1]
    tilt = math.degrees(math.acos(max(-1.0, min(1.0, axis_W[1]))))
    print(
        f"t = {seconds:9.3f} s: spin in the body {np.round(w_B, 3)}, its axis has turned by {tilt:6.1f} deg"
    )
print(f"an error of 1e-9 of the spin grows to {1e-9 * picture.sensitivity:.1e} rad of attitude a rad turned")
