# SPDX-License-Identifier: Apache-2.0
"""Computes diagrams as plain data. Nothing here draws.

Two renderers draw it: `contact_dynamics.viewing` in rerun, and `contact_dynamics.plots` with Matplotlib. They
compute no geometry of their own, so that both show the same numbers.

In reading order: what diagrams are made of (`marks`) and their colours in the viewer (`palette`) and on paper
(`paper`), the faces and edges of bodies (`shape`), surfaces and bodies (`world_scene`), lecture 27's impulse
space (`impulse_space`), lecture 26's body with its contacts (`planar_scene`), charts of applied wrenches
(`wrench_chart`) and the map of modes on them (`mode_map`), lecture 26's construction for one mode
(`force_dual`), lecture 25's rolling ellipsoid (`poinsot`), energies and momenta over a trajectory
(`trajectory_curves`), predicted flights until a surface is in their way (`flight`), contact modes and forces
(`contact_scene`), impacts (`impact_scene`) and what was measured after them (`after_impact`), whole tosses
with the tree of their strikes (`toss_scene`), many states (`many_states`), and answers in words (`words`).
"""
