# SPDX-License-Identifier: Apache-2.0
"""The diagrams of the three lectures on paper, with Matplotlib and without a viewer.

Writes `impulse_space.svg`, `mode_map.svg` and `poinsot.svg` into the folder given, or into this one.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from contact_dynamics import (
    Body,
    BodyState,
    ContactSet,
    MassProperties,
    PlanarBody,
    PlanarContact,
    PlanarWrench,
)
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes, mode_margins, wrench_sets
from contact_dynamics.diagrams.wrench_chart import DirectionChart
from contact_dynamics.plots import draw_impulse_space, draw_mode_map, draw_poinsot, save_figure
from contact_dynamics.questions import ImpactQuestion, TumblingQuestion, ask

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")

# Lecture 27: a rod falls to the left and strikes the ground.
rod = Body(name="rod", mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.2, 0.5, 0.6])))
falling = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[-1, 0.4, -1], w_WB_W=[0, 0, 0])
ground = ContactSet(p_WC_W=[[0.3, 0.2, -0.9]], normals_W=[[0, 0, 1]], frictions=0.6, restitutions=0.5)
impact = ask(ImpactQuestion(body=rod, state=falling, contacts=ground))
figure = Figure(figsize=(8, 4.6), layout="constrained")
draw_impulse_space(figure.add_subplot(), rod, impact)
save_figure(figure, folder / "impulse_space.svg")

# Lecture 26: a block in the corner of a tray, pushed into it.
block = PlanarBody(mass=1.0, inertia=0.25)
corner = [
    *(PlanarContact(r=(x, -0.4), normal=(0, 1), friction=0.8) for x in (-0.9, 0.3)),
    *(PlanarContact(r=(0.6, y), normal=(-1, 0), friction=0.8) for y in (-0.1, 0.5)),
]
problem = PlanarContactProblem(body=block, contacts=corner, wrench=PlanarWrench(f=(3, 3), moment=3))
answer = contact_modes(problem)
(margin,) = mode_margins(problem, answer)
figure = Figure(figsize=(11, 5), layout="constrained")
chart = DirectionChart(length=block.radius_of_gyration, resolution=600)
draw_mode_map(figure.add_subplot(), wrench_sets(problem), chart, applied=problem.wrench, change=margin.change)
save_figure(figure, folder / "mode_map.svg")
print(f"the block in the tray: {margin.mode}, {margin.margin:.2f} N from {' or '.join(margin.modes_beyond)}")

# Lecture 25: the ellipsoid of a tumbling plate rolls on its plane.
plate = Body(name="plate", mass_properties=MassProperties(mass=0.2, I_B=np.diag([1.0e-4, 2.0e-4, 2.6e-4])))
spinning = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[2, 6, -6])
motion = ask(TumblingQuestion(body=plate, state=spinning, curve_points=400))
if motion.poinsot is not None and motion.curves is not None:  # they are None under a torque
    figure = Figure(figsize=(8, 6), layout="constrained")
    draw_poinsot(figure.add_subplot(projection="3d"), motion.poinsot, motion.curves, motion.state)
    save_figure(figure, folder / "poinsot.svg")
print(f"the diagrams are in {folder.resolve()}: impulse_space.svg, mode_map.svg, poinsot.svg")
