# SPDX-License-Identifier: Apache-2.0
"""The answer about many states in space: where each is then, how it moves, and the impulses on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Arrows, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import outline
from contact_dynamics.diagrams.words import OUTCOMES
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.questions.many import ManyImpactsAnswer

if TYPE_CHECKING:
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.many import ManyTumblingsAnswer
    from contact_dynamics.validation import FloatArray

MAX_OUTLINES: Final = 100
"""Outlines of the body for this many states, evenly among all. Each state has its point and its arrows."""

ARROW_SECONDS: Final = 0.1  # s. An arrow of a velocity is as long as the way in this time.
_MARKERS: Final = "os^Dv<>Pp*"  # beside the colours, for print in grey


def many_states_marks(shape: Shape, answer: ManyTumblingsAnswer | ManyImpactsAnswer) -> list[Mark]:
    """Return the marks of the states. Impacts have a marker for each outcome.

    Impulses are drawn at the centre of mass. The longest is as long as the longest velocity.
    """
    states, is_impact = answer.states, isinstance(answer, ManyImpactsAnswer)
    color = palette.IMPACT if is_impact else palette.PREDICTED
    chosen = np.unique(np.linspace(0, len(states) - 1, min(len(states), MAX_OUTLINES)).round().astype(int))
    edges = [edge for i in chosen for edge in outline(shape, states.p_WB_W[i], states.q_WB[i])]
    velocities = ARROW_SECONDS * states.v_WB_W
    faint = Paint(color, paper.GREY)
    marks: list[Mark] = [
        Lines("outlines", faint, edges, opacity=0.45, width=1.0, on_paper=False),
        Arrows(
            "velocities",
            Paint(palette.AFTER_IMPACT if is_impact else palette.PREDICTED, paper.GREY),
            states.p_WB_W,
            velocities,
            width=1.0,
            legend=f"velocity, way in {ARROW_SECONDS:g} s",
        ),
    ]
    groups = [("state then", np.ones(len(states), dtype=bool))]
    if isinstance(answer, ManyImpactsAnswer):
        impulses = _fitted(answer.impulses_W, velocities)
        paint = Paint(palette.IMPACT, paper.RED)
        marks.append(Arrows("impulses", paint, states.p_WB_W, impulses, width=1.5, on_paper=False))
        groups = [
            (OUTCOMES[outcome], (answer.outcomes == outcome) & ~answer.separates) for outcome in ImpactOutcome
        ]
        groups.append(("separates", answer.separates))
    for i, (word, some) in enumerate([each for each in groups if each[1].any()]):
        marks.append(
            Points(
                f"states/{word.replace(' ', '_')}",
                Paint(color, paper.SERIES[i % len(paper.SERIES)]),
                states.p_WB_W[some],
                size=4.5,
                marker=_MARKERS[i % len(_MARKERS)],
                legend=f"{word} ({np.count_nonzero(some)})",
            )
        )
    return marks


def _fitted(vectors: FloatArray, others: FloatArray) -> FloatArray:
    """Return vectors, (n, 3), scaled so that the longest is as long as the longest of others, (n, 3)."""
    longest, other = (np.linalg.norm(each, axis=1).max(initial=0.0) for each in (vectors, others))
    return vectors * (other / longest) if longest > 0.0 else vectors
