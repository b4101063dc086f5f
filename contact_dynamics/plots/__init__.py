# SPDX-License-Identifier: Apache-2.0
"""Draws results with Matplotlib: the viewer's diagrams, for papers, notebooks and terminals without a viewer.

`toss` and `modes` return a figure of what the physics returns, and `save_figure` writes it. Each of the other
functions draws one diagram into the `Axes` that it is given. What it draws are the arrays of
`contact_dynamics.diagrams`, which the viewer draws too. `contact_dynamics.plots` can be imported without
Matplotlib, which the extra ``[plot]`` brings.

In reading order: how marks are drawn (`drawing`), the diagrams, and figures of an answer and of what the
physics returns (`figures`), and the command `contact-dynamics plot` (`arguments`, `run`).
"""

from contact_dynamics.plots.drawing import save_figure
from contact_dynamics.plots.figures import (
    draw_angular_momentum,
    draw_angular_velocity,
    draw_attitude,
    draw_contact_forces,
    draw_energy,
    draw_event_tree,
    draw_force_dual,
    draw_impulse_space,
    draw_impulse_space_in_3d,
    draw_many_states,
    draw_mode_map,
    draw_momentum,
    draw_planar_scene,
    draw_poinsot,
    draw_position,
    draw_toss,
    draw_velocity,
    figures_of,
    modes,
    toss,
)

__all__ = [
    "draw_angular_momentum",
    "draw_angular_velocity",
    "draw_attitude",
    "draw_contact_forces",
    "draw_energy",
    "draw_event_tree",
    "draw_force_dual",
    "draw_impulse_space",
    "draw_impulse_space_in_3d",
    "draw_many_states",
    "draw_mode_map",
    "draw_momentum",
    "draw_planar_scene",
    "draw_poinsot",
    "draw_position",
    "draw_toss",
    "draw_velocity",
    "figures_of",
    "modes",
    "save_figure",
    "toss",
]
