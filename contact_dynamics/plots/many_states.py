"""Draws the states of an answer about many, seen along one of the world's axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.words import OUTCOMES
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.plots.style import legend_beside
from contact_dynamics.questions.many import ManyImpactsAnswer

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from contact_dynamics.questions.many import ManyTumblingsAnswer

_XYZ: Final = "xyz"
_MARKERS: Final = "os^Dv<>Pp*"  # beside the colours, for print in grey


def draw_many_states(
    axes: Axes, answer: ManyTumblingsAnswer | ManyImpactsAnswer, *, across: str = "x", up: str = "z"
) -> None:
    """Draw the position of each centre of mass, m, with an arrow along its velocity.

    Arrows have one scale, which fits the diagram. Impacts have a marker for each outcome.

    Args:
        axes: where to draw.
        answer: the answer.
        across: the world's axis, "x", "y" or "z", to the right.
        up: the one upwards.
    """
    columns = [_XYZ.index(across), _XYZ.index(up)]
    positions, velocities = answer.states.p_WB_W[:, columns], answer.states.v_WB_W[:, columns]
    axes.quiver(*positions.T, *velocities.T, angles="xy", color=colors.GREY, width=0.003, gid="velocities")
    for i, (word, chosen) in enumerate(_groups(answer)):
        axes.scatter(
            positions[chosen, 0],
            positions[chosen, 1],
            s=16.0,
            color=colors.SERIES[i % len(colors.SERIES)],
            marker=_MARKERS[i % len(_MARKERS)],
            label=f"{word} ({np.count_nonzero(chosen)})",
            gid=f"states_{word.replace(' ', '_')}",
        )
    axes.set_xlabel(f"{across}, m")
    axes.set_ylabel(f"{up}, m")
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(visible=True, color=colors.AXIS, linewidth=0.6)
    legend_beside(axes)


def _groups(answer: ManyTumblingsAnswer | ManyImpactsAnswer) -> list[tuple[str, np.ndarray]]:
    """Return which states have something in common, with the words for it."""
    if not isinstance(answer, ManyImpactsAnswer):
        return [("state then", np.ones(len(answer.states), dtype=bool))]
    groups = [
        (OUTCOMES[outcome], (answer.outcomes == outcome) & ~answer.separates) for outcome in ImpactOutcome
    ]
    groups.append(("separates", answer.separates))
    return [(word, chosen) for word, chosen in groups if chosen.any()]
