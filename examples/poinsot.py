# SPDX-License-Identifier: Apache-2.0
"""Poinsot's picture of a tumbling body: its inertia ellipsoid rolls, without slipping, on a fixed plane.

Writes `poinsot.rrd` (or the path given) for rerun's viewer, to be played there: `rerun poinsot.rrd`.
"""

import sys

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from contact_dynamics import BodyState, MassProperties, free_motion
from contact_dynamics.tumbling import RollingCurves, poinsot, rolling_curves
from contact_dynamics.viewing.blueprint import diagram_view
from contact_dynamics.viewing.entities import POINSOT, TIMELINE
from contact_dynamics.viewing.in_view import draw_poinsot, draw_rolling
from contact_dynamics.viewing.measured import set_time

body = MassProperties(mass=0.2, I_B=np.diag([1.0e-4, 2.0e-4, 2.6e-4]))
spin = BodyState(
    p_WB_W=np.zeros(3),
    q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
    v_WB_W=np.zeros(3),
    w_WB_W=np.array([2.0, 6.0, -6.0]),  # rad/s
)
motion = free_motion(body, spin, gravity_W=(0.0, 0.0, 0.0))
constants = poinsot(motion)
print(f"the polhode repeats every {constants.polhode_period:.3f} s: {constants.regime.name.lower()}")

times = np.linspace(0.0, 5.0 * constants.polhode_period, 1500)
# The polhode closes after one period, the herpolhode never does.
curves = RollingCurves(
    seconds=times, polhode_B=rolling_curves(motion, 200).polhode_B, herpolhode_W=motion.at(times).w_WB_W
)
with rr.RecordingStream("contact_dynamics") as recording:
    recording.save(sys.argv[1] if len(sys.argv) > 1 else "poinsot.rrd")
    set_time(recording, 0)
    draw_poinsot(recording, "body", constants, curves)
    draw_rolling(recording, "body", [motion.state_at(seconds) for seconds in times.tolist()])
    panel = rrb.TimePanel(
        timeline=TIMELINE, play_state="Playing", loop_mode="All", state=rrb.PanelState.Collapsed
    )
    recording.send_blueprint(rrb.Blueprint(diagram_view(POINSOT), panel, collapse_panels=True))
