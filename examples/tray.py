# SPDX-License-Identifier: Apache-2.0
"""Lecture 26's wrench in a tray: the map of contact modes over applied wrenches.

A hex key lies in the lower right corner of a tray, flush with the floor and the wall. Writes `tray.rrd`
(or the path given) for rerun's viewer: `rerun tray.rrd`.
"""

import sys

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from contact_dynamics import (
    PlanarBody,
    PlanarContact,
    PlanarWrench,
)
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes, mode_margins, wrench_sets
from contact_dynamics.diagrams.force_dual import force_dual
from contact_dynamics.diagrams.mode_map import mode_map, paint_of_modes
from contact_dynamics.diagrams.palette import BACKGROUND
from contact_dynamics.diagrams.planar_scene import planar_scene_of
from contact_dynamics.diagrams.wrench_chart import DirectionChart, ForceDualChart
from contact_dynamics.viewing.drawing import draw_diagram

FLAT, TALL, BEND, THICK = 0.08, 0.06, 0.03, 0.012  # m: flush on the floor, on the wall; outer radius; bar

# The key, with the tray's corner as the origin, from the floor's side around to the inner edge and back.
turn = np.linspace(-0.5 * np.pi, 0.0, 40)
arc = np.column_stack([np.cos(turn), np.sin(turn)])
centre = np.array([-BEND, BEND])
ends = np.array([[-BEND - FLAT, 0.0]]), np.array([[0.0, BEND + TALL]])
outer = np.vstack([ends[0], centre + BEND * arc, ends[1]])
inner = np.vstack([ends[0] + (0.0, THICK), centre + (BEND - THICK) * arc, ends[1] - (THICK, 0.0)])

# Mass and inertia of 60 g, as particles along the bar.
middle = 0.5 * (outer + inner)
lengths = np.linalg.norm(np.diff(middle, axis=0), axis=1)
share = 0.06 * lengths / lengths.sum()
between = 0.5 * (middle[1:] + middle[:-1])
mass_centre = share @ between / 0.06
inertia = share @ (((between - mass_centre) ** 2).sum(axis=1) + lengths**2 / 12.0)
key = PlanarBody(mass=0.06, inertia=float(inertia))

floor, wall = (0.0, 1.0), (-1.0, 0.0)
on_floor, on_wall = ((-BEND - FLAT, 0.0), (-BEND, 0.0)), ((0.0, BEND), (0.0, BEND + TALL))
contacts = [
    PlanarContact(r=tuple(np.array(point) - mass_centre), normal=normal, friction=0.5)
    for points, normal in ((on_floor, floor), (on_wall, wall))
    for point in points
]

applied = PlanarWrench(f=(0.5, 0.1), moment=0.03)  # gravity along the tilted tray, and a finger
problem = PlanarContactProblem(body=key, contacts=contacts, wrench=applied)  # at rest
modes = wrench_sets(problem)
print(f"{len(modes)} of 4^{len(contacts)} strings are possible: {', '.join(one.mode for one in modes)}")

answer = contact_modes(problem)
(margin,) = mode_margins(problem, answer)
beyond = " or ".join(margin.modes_beyond)
print(f"mode {margin.mode} with a margin of {margin.margin:.3f} N, then {beyond}")

outline = np.vstack([outer, inner[::-1], outer[:1]]) - mass_centre
tray = np.array([[-0.16, 0.0], [0.0, 0.0], [0.0, 0.11]]) - mass_centre
chosen = next(one for one in modes if one.mode == margin.mode)
with rr.RecordingStream("contact_dynamics") as recording:
    recording.save(sys.argv[1] if len(sys.argv) > 1 else "tray.rrd")
    title = f"{margin.mode}: contact forces, accelerations"
    scene = planar_scene_of(outline, contacts, walls=[tray], mode=answer.modes[0], title=title)
    draw_diagram(recording, scene, "planar_scene")
    chart = ForceDualChart(
        length=key.radius_of_gyration, half_side=0.13, centre=(-0.02, 0.05), resolution=700
    )
    color = paint_of_modes([margin.mode], sorted(one.mode for one in modes)).dark
    dual = force_dual(chosen, contacts, chart, outlines=[outline, tray], color=color)
    draw_diagram(recording, dual, "force_dual")
    discs = DirectionChart(length=key.radius_of_gyration, resolution=900)
    draw_diagram(recording, mode_map(modes, discs, applied=applied, change=margin.change), "mode_map")
    views = [
        rrb.Spatial2DView(origin=origin, name=name, background=BACKGROUND)
        for origin, name in (
            ("planar_scene", "Contact forces"),
            ("force_dual", "Acceleration centres and force duals"),
            ("mode_map", "Contact modes by applied wrench"),
        )
    ]
    rows = rrb.Vertical(rrb.Horizontal(*views[:2], column_shares=[2, 3]), views[2], row_shares=[2, 3])
    recording.send_blueprint(rrb.Blueprint(rows, collapse_panels=True))
