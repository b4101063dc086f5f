# SPDX-License-Identifier: Apache-2.0
"""A predicted impact in space: contact, friction cone, impulse, velocities before and after.

The path of the impulse as it accumulates rises from each contact, to the scale of the impulse's arrow. A
second moving body is drawn where it is struck, with its velocities. If there are several strikes in time, all
impulses are drawn, and the largest have their number, their time, and the body as it is then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.contact_scene import friction_cones
from contact_dynamics.diagrams.marks import Arrows, Labels, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import outline

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.impact import SequenceStrike
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.validation import FloatArray

ARROW_LENGTH: Final = 1.1
"""Length of the longest arrow of a kind, relative to the body's size. Labels contain the amounts."""

ARROW_WIDTH: Final = 0.016  # relative to the size of the body
LABEL_REACH: Final = 1.15  # how far out the label of a velocity is, relative to its arrow

LABEL_DEPTH: Final = 0.35
"""How far below the contact the label of its impulse is, relative to the body's size."""

AFTER_DEPTH: Final = 0.95  # the same for the label of the velocity after it

LABELS: Final = ("impulse_label", "velocity_label")
"""The labels of an impact. Only those of the newest impact are in view."""

CONE_HEIGHT: Final = 0.35  # relative to the size of the body

MAX_STRIKES: Final = 5
"""This many strikes of a sequence, those with the largest impulses, have a label and the body drawn."""

_POINT_SIZE: Final = 0.02  # radius of points, relative to the body's size

_IMPACT: Final = Paint(palette.IMPACT, paper.RED)
_BEFORE: Final = Paint(palette.BEFORE_IMPACT, paper.SKY)
_AFTER: Final = Paint(palette.AFTER_IMPACT, paper.BLUE)
_NORMAL: Final = Paint(palette.NORMAL, paper.GREY)


def impact_marks(shape: Shape, answer: ImpactAnswer, *, other_shape: Shape | None = None) -> list[Mark]:
    """Return the marks of an impact. A struck body without a known shape has velocities alone."""
    size, impact, other = shape.size, answer.impact, answer.other
    struck, points, impulses_W = _struck(answer)
    scale, radius = drawn_scale(impulses_W, size), ARROW_WIDTH * size
    main = main_strikes(impact.strikes)
    once = [struck.index(contact) for contact in dict.fromkeys(struck)]
    normals_W = answer.contacts.normals_W[struck]
    where, normals = points[once], normals_W[once]
    frictions = answer.contacts.frictions[struck][once]
    height = CONE_HEIGHT * size
    bodies = [(shape, answer.state), *((shape, impact.strikes[i].state_before) for i in main)]
    if other is not None and other_shape is not None:
        bodies.append((other_shape, other.state))
    edges = [edge for drawn, state in bodies for edge in outline(drawn, state.p_WB_W, state.q_WB)]
    lengths = np.linalg.norm(impulses_W, axis=1).tolist()
    places, texts = points - LABEL_DEPTH * size * normals_W, [f"{length:.3g} N s" for length in lengths]
    if impact.strikes:
        places = (points + scale * impulses_W)[main]
        texts = [f"{i + 1}. at {1e3 * impact.strikes[i].seconds:.1f} ms: {texts[i]}" for i in main]
    return [
        Arrows("impulse", _IMPACT, points, scale * impulses_W, radius=radius),
        Labels("impulse_label", _IMPACT, places, texts),
        *_velocity_marks(answer, size),
        # The impact before had one.
        Arrows("measured_velocity", _NORMAL, np.zeros((0, 3)), np.zeros((0, 3))),
        Lines("impulse_path", _IMPACT, [] if impact.strikes else _paths(answer, scale=scale), width=3.0),
        Arrows("normal", _NORMAL, where, normals * height, radius=0.5 * radius),
        Points("point", _IMPACT, where, radius=_POINT_SIZE * size),
        friction_cones("cone", where, normals, frictions, height=height),
        Lines("body", _IMPACT, edges, opacity=0.7, width=1.5),
    ]


def measured_marks(
    answer: ImpactAnswer, v_WB_W: FloatArray, *, size: float, color: palette.Color
) -> list[Mark]:
    """Return the mark of the velocity, (3,), m/s, that was measured after an impact, and labels with it.

    It is beside those of the impact, to their scale. It has a label together with that of the predicted one,
    since the better the prediction, the more they would overlap.
    """
    _, vectors_W = _velocities(answer)
    vector_W = drawn_scale(vectors_W, size) * v_WB_W
    paint = Paint(color, paper.BLACK)
    origin_W = answer.state.p_WB_W[None]
    _, labels = _velocity_marks(answer, size, measured=f"measured after {np.linalg.norm(v_WB_W):.3g} m/s")
    return [Arrows("measured_velocity", paint, origin_W, vector_W[None], radius=ARROW_WIDTH * size), labels]


def drawn_scale(vectors: FloatArray, size: float) -> float:
    """Return the drawn length of one unit of vectors, (n, 3), m, for a body of that size, m."""
    longest = float(np.linalg.norm(vectors, axis=1).max(initial=0.0))
    return ARROW_LENGTH * size / longest if longest > 0.0 else 0.0


def _velocities(answer: ImpactAnswer) -> tuple[FloatArray, FloatArray]:
    """Return where the moving bodies are, and their velocities before and after an impact, (2 n, 3) each."""
    impact, other = answer.impact, answer.other
    moving = [(answer.state.p_WB_W, answer.state.v_WB_W, impact.state.v_WB_W)]
    if other is not None and impact.other_state is not None:
        moving.append((other.state.p_WB_W, other.state.v_WB_W, impact.other_state.v_WB_W))
    places_W = np.array([p_W for p_W, _, _ in moving for _ in range(2)])
    return places_W, np.array([v_W for _, *both in moving for v_W in both])


def _velocity_marks(answer: ImpactAnswer, size: float, *, measured: str = "") -> tuple[Arrows, Labels]:
    """Return the velocities before and after an impact, with labels that may contain the measured one.

    The first arrow of a body ends at its centre of mass, and the second begins there.
    """
    places_W, vectors_W = _velocities(answer)
    drawn_W = drawn_scale(vectors_W, size) * vectors_W
    n = len(places_W) // 2
    before = np.tile([[1.0], [0.0]], (n, 1))
    paints = (_BEFORE, _AFTER) * n
    arrows = Arrows(
        "velocity", _AFTER, places_W - before * drawn_W, drawn_W, paints=paints, radius=ARROW_WIDTH * size
    )
    words = ["before", "predicted after"] * n
    if measured:
        words[1] = f"{measured}, predicted"
    lengths = np.linalg.norm(vectors_W, axis=1).tolist()
    texts = [f"{word} {length:.3g} m/s" for word, length in zip(words, lengths, strict=True)]
    labels_W = places_W + (1.0 - 2.0 * before) * LABEL_REACH * drawn_W
    contacts = answer.contacts
    if len(contacts):  # the body leaves along this velocity, where a label would cover it
        labels_W[1] = (contacts.p_WC_W - AFTER_DEPTH * size * contacts.normals_W).mean(axis=0)
    return arrows, Labels("velocity_label", _AFTER, labels_W, texts, paints=paints)


def main_strikes(strikes: Sequence[SequenceStrike]) -> list[int]:
    """Return the indices of the strikes with the largest impulses, in the order of time."""
    sizes = [float(np.linalg.norm(strike.impulse_W)) for strike in strikes]
    return sorted(sorted(range(len(strikes)), key=lambda i: -sizes[i])[:MAX_STRIKES])


def _struck(answer: ImpactAnswer) -> tuple[list[int], FloatArray, FloatArray]:
    """Return the contacts that are struck, with their points and impulses, (n, 3) each, in world axes."""
    strikes, impulses_W = answer.impact.strikes, answer.impact.impulses_W
    if strikes:
        return (
            [strike.contact for strike in strikes],
            np.array([strike.p_WC_W for strike in strikes]),
            np.array([strike.impulse_W for strike in strikes]),
        )
    struck = np.flatnonzero(np.linalg.norm(impulses_W, axis=1) > 0.0).tolist()
    return struck, answer.contacts.p_WC_W[struck], impulses_W[struck]


def _paths(answer: ImpactAnswer, *, scale: float) -> list[FloatArray]:
    """Return the path of the accumulated impulse of each contact, (k, 3), m, world."""
    owners = np.array(answer.impact.path_contacts, dtype=np.int64)
    return [
        answer.contacts.p_WC_W[contact] + scale * answer.impact.path_W[owners == contact]
        for contact in np.unique(owners).tolist()
    ]
