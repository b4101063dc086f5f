# SPDX-License-Identifier: Apache-2.0
"""Draws what the physics returns, each result as one figure: `toss` and `modes`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes import (
    PlanarContactProblem,
    PlanarModeAnswer,
    SpatialContactProblem,
    SpatialModeAnswer,
)
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.diagrams.planar_modes import side_by_side
from contact_dynamics.diagrams.shape import drawn_shape
from contact_dynamics.plots.draw import draw_contact_forces, draw_planar_scene, draw_toss
from contact_dynamics.plots.figures import MAX_MODES, blank_figure, from_side_and_above
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contact_dynamics.toss import Toss, TossDistribution
    from contact_dynamics.world import Body


@checks_types
def toss(toss: Toss, body: Body | None = None, *, distribution: TossDistribution | None = None) -> Figure:
    """Return a figure of a toss, from the side and from above, with other ways that it has followed.

    Args:
        toss: What `contact_dynamics.toss.toss` returns.
        body: The body, whose outline is drawn on its way and where it ends, or None for the path alone.
        distribution: What `sampled_toss` returns, whose samples are drawn too, or None.
    """
    outline = drawn_shape(NO_SHAPE if body is None else body.shape)
    figure = from_side_and_above(
        lambda axes, up: draw_toss(axes, toss, outline, across="x", up=up, distribution=distribution)
    )
    figure.suptitle(f"Toss: {toss.end} at {toss.seconds:.4g} s")
    return figure


@checks_types
def modes(answer: PlanarModeAnswer | SpatialModeAnswer) -> Figure:
    """Return a figure of the first `MAX_MODES` consistent modes, one below the other, with their forces.

    In the plane it has contacts, friction cones, forces and accelerations. In space it has the force at each
    contact beside the edge of its friction cone.

    Args:
        answer: What `contact_dynamics.contact_modes.contact_modes` returns.
    """
    found = answer.modes[:MAX_MODES]
    titles = [f"{mode.mode}: {mode_in_words(mode.mode)}" for mode in found]
    rows = max(len(found), 1)
    figure = blank_figure(8.0, 4.6 * rows)
    each = figure.subplots(rows, 1, squeeze=False)[:, 0]
    problem = answer.problem
    if isinstance(answer, PlanarModeAnswer) and isinstance(problem, PlanarContactProblem):
        view = side_by_side(
            tuple(problem.contacts),
            answer.modes[:MAX_MODES],
            titles or [str(answer.verdict)],
            outline=np.zeros((0, 2)),
        )
        for axes, scene in zip(each, view.scenes, strict=True):
            draw_planar_scene(axes, scene)
    elif isinstance(answer, SpatialModeAnswer) and isinstance(problem, SpatialContactProblem):
        for axes, mode, title in zip(each, answer.modes, titles, strict=False):
            draw_contact_forces(axes, problem.contacts, mode, title=title)
    figure.suptitle(answer.in_short())
    return figure
