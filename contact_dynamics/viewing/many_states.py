"""Draws the answer about many states: where each is then, how it moves, and the impulses on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.questions.many import ManyImpactsAnswer
from contact_dynamics.viewing.entities import many_entity
from contact_dynamics.viewing.strips import strips_3d
from contact_dynamics.viewing.trajectory import outline

if TYPE_CHECKING:
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.many import ManyTumblingsAnswer
    from contact_dynamics.validation import FloatArray

MAX_OUTLINES: Final = 100
"""Outlines of the body for this many states, evenly among all. Each state has its point and its arrows."""

ARROW_SECONDS: Final = 0.1
"""s. An arrow of a velocity is as long as the way in this time."""

_POINT: Final = -3.0  # a negative size is in points of the screen
_WIDTH: Final = -1.2
_OUTLINE_WIDTH: Final = -0.8


def draw_many_states(
    recording: rr.RecordingStream, shape: Shape, answer: ManyTumblingsAnswer | ManyImpactsAnswer
) -> None:
    """Draw the states at the recording's current time, in place of those of an earlier answer.

    Impulses are drawn at the centre of mass. The longest is as long as the longest velocity.
    """
    states, path = answer.states, many_entity(answer.body_name)
    is_impact = isinstance(answer, ManyImpactsAnswer)
    color = palette.IMPACT if is_impact else palette.PREDICTED
    recording.log(f"{path}/states", rr.Points3D(states.p_WB_W, colors=color, radii=_POINT))
    chosen = np.unique(np.linspace(0, len(states) - 1, min(len(states), MAX_OUTLINES)).round().astype(int))
    edges = [edge for i in chosen for edge in outline(shape, states.p_WB_W[i], states.q_WB[i])]
    faint = palette.translucent(color, 0.45)
    recording.log(f"{path}/outlines", rr.LineStrips3D(strips_3d(edges), colors=faint, radii=_OUTLINE_WIDTH))
    velocities = rr.Arrows3D(
        origins=states.p_WB_W,
        vectors=ARROW_SECONDS * states.v_WB_W,
        colors=palette.AFTER_IMPACT if is_impact else palette.PREDICTED,
        radii=_WIDTH,
    )
    recording.log(f"{path}/velocities", velocities)
    impulses_W = np.zeros((0, 3))
    if isinstance(answer, ManyImpactsAnswer):
        impulses_W = _fitted(answer.impulses_W, ARROW_SECONDS * states.v_WB_W)
    impulses = rr.Arrows3D(
        origins=states.p_WB_W[: len(impulses_W)], vectors=impulses_W, colors=palette.IMPACT, radii=_WIDTH
    )
    recording.log(f"{path}/impulses", impulses)


def _fitted(vectors: FloatArray, others: FloatArray) -> FloatArray:
    """Return vectors, (n, 3), scaled so that the longest is as long as the longest of others, (n, 3)."""
    longest, other = (np.linalg.norm(each, axis=1).max(initial=0.0) for each in (vectors, others))
    return vectors * (other / longest) if longest > 0.0 else vectors
