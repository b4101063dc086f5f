"""Draws the diagrams of `contact_dynamics.diagrams` with Matplotlib, each into the axes that are given."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from contact_dynamics.diagrams.impulse_space import impulse_space, impulse_space_in_3d
from contact_dynamics.plots.drawing import draw_diagram

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.rigid_body.body import HasMassProperties


def draw_impulse_space(
    axes: Axes,
    body: HasMassProperties | None,
    answer: ImpactAnswer,
    *,
    other: HasMassProperties | None = None,
) -> None:
    """Draw the impulse path of an impact's main contact, N s, with what bounds and bends it.

    In space, path and sticking line are projected onto the plane of the normal and the total impulse, and the
    legend says so.

    Args:
        axes: The axes to draw into.
        body: The body, or its mass properties. If it is None, there are no sticking and compression lines.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it there are no lines for two bodies.
    """
    draw_diagram(axes, impulse_space(body, answer, other=other))


def draw_impulse_space_in_3d(
    axes: Any,
    body: HasMassProperties | None,
    answer: ImpactAnswer,
    *,
    other: HasMassProperties | None = None,
) -> None:
    """Draw the impulse path of an impact's main contact in all three dimensions, N s.

    Args:
        axes: Axes in 3D, as ``figure.add_subplot(projection="3d")`` makes them. They have no type.
        body: The body, or its mass properties. If it is None, sticking line and compression plane are not
            drawn.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it both are missing for two bodies.
    """
    draw_diagram(axes, impulse_space_in_3d(body, answer, other=other))
