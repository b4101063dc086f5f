# SPDX-License-Identifier: Apache-2.0
"""Lecture 27's rigid body example in impulse space, for several places of its contact.

Writes `impulse_space.rrd` (or the path given) for rerun's viewer: `rerun impulse_space.rrd`.
"""

import sys

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from contact_dynamics import Body, BodyState, ContactSet, MassProperties
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.impulse_space import impulse_space
from contact_dynamics.diagrams.words import outcome_in_words
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ImpactQuestion, Problem, ask
from contact_dynamics.viewing.drawing import draw_diagram

# rho = 1, m = 1, v = (-1, -1), w = 0, mu = 0.25, e = 0.5; the plane is x, z. The figure with r is lost.
ARMS = [(0.0, -1.0), (0.1, -1.5), (0.3, -3.0), (1.0, -1.2), (1.0, -2.0), (-1.0, -9.0)]
body = MassProperties(mass=1.0, I_B=np.eye(3))
state = BodyState(
    p_WB_W=np.zeros(3),
    q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
    v_WB_W=np.array([-1.0, 0.0, -1.0]),
    w_WB_W=np.zeros(3),
)

views = []
with rr.RecordingStream("contact_dynamics") as recording:
    recording.save(sys.argv[1] if len(sys.argv) > 1 else "impulse_space.rrd")
    for i, (x, z) in enumerate(ARMS):
        question = ImpactQuestion(
            body=Body(name="body", mass_properties=body),
            state=state,
            contacts=ContactSet(
                p_WC_W=[[x, 0.0, z]], normals_W=[[0.0, 0.0, 1.0]], frictions=0.25, restitutions=0.5
            ),
            problem=Problem.PLANAR,
            plane=PlaneOfMotion(normal_W=[0.0, -1.0, 0.0]),
        )
        answer = ask(question)
        struck = answer.impact
        ((t, _, n),), outcome = struck.impulses_W, outcome_in_words(struck.outcome)
        if struck.jams:
            outcome = f"jams, {outcome}"
        print(f"r = ({x:g}, {z:g}): {outcome}, impulse ({t:.4f}, {n:.4f}) N s")
        entity = f"example_{i}"
        draw_diagram(recording, impulse_space(body, answer), entity)
        name = f"r = ({x:g}, {z:g}): {outcome}"
        views.append(rrb.Spatial2DView(origin=entity, name=name, background=palette.BACKGROUND))
    recording.send_blueprint(rrb.Blueprint(rrb.Grid(*views, grid_columns=2), collapse_panels=True))
