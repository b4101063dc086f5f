"""Draws a predicted impact in the scene: contact, friction cone, impulse, velocities before and after.

The path of the impulse as it accumulates rises from each contact, to the scale of the impulse's arrow. A
second moving body is drawn where it is struck, with its velocities. If there are several strikes in time, all
impulses are drawn, and the largest have their number, their time, and the body as it is then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.contact_scene import friction_cones
from contact_dynamics.diagrams.shape import outline
from contact_dynamics.viewing.drawing import draw_marks
from contact_dynamics.viewing.entities import impact_entity
from contact_dynamics.viewing.strips import strips_3d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.questions.resolved_impact import SequenceStrike
    from contact_dynamics.validation import FloatArray

ARROW_LENGTH: Final = 1.1
"""Length of the longest arrow of a kind, relative to the body's size. Labels say how much it stands for."""

ARROW_WIDTH: Final = 0.016
"""Relative to the size of the body."""

LABEL_REACH: Final = 1.15
"""How far out the label of a velocity is, relative to its arrow."""

LABEL_DEPTH: Final = 0.35
"""How far below the contact the label of its impulse is, relative to the body's size."""

AFTER_DEPTH: Final = 0.95
"""The same for the label of the velocity after it."""

LABELS: Final = ("impulse_label", "velocity_label")
"""The labels of an impact. Only those of the newest impact are in view."""

CONE_HEIGHT: Final = 0.35
"""Relative to the size of the body."""

MAX_STRIKES: Final = 5
"""This many strikes of a sequence, those with the largest impulses, have a label and the body drawn."""

_POINT_SIZE: Final = 0.02  # radius of points, relative to the body's size
_OUTLINE_WIDTH: Final = -1.2  # a negative size is in points of the screen


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arrows:
    """Arrows of one unit, which are drawn to their own scale."""

    origins: FloatArray  # (n, 3), m, world
    vectors: FloatArray  # (n, 3), in the unit, world axes
    unit: str
    colors: tuple[palette.Color, ...]  # (n,)
    arrives: tuple[bool, ...] = ()  # (n,), whether the arrow ends at its origin; by default none does

    def drawn(self, size: float) -> rr.Arrows3D:
        """Return the arrows to draw. The longest suits a body of that size, m."""
        vectors = self.vectors * self.scale(size)
        back = np.reshape(self.arrives or np.zeros(len(vectors)), (-1, 1))
        return rr.Arrows3D(
            origins=self.origins - back * vectors,
            vectors=vectors,
            colors=self._colors(),
            radii=ARROW_WIDTH * size,
        )

    def labels(self, places: FloatArray, *, before: Sequence[str] = ()) -> rr.Points3D:
        """Return labels with the size of each, at places, (n, 3), m, world, after the words ``before``."""
        lengths = np.linalg.norm(self.vectors, axis=1).tolist()
        words = [f"{length:.3g} {self.unit}" for length in lengths]
        if before:
            words = [f"{one} {word}" for one, word in zip(before, words, strict=True)]
        colors = [palette.readable(color) for color in self.colors]
        return rr.Points3D(places, colors=colors, radii=0.0, labels=words, show_labels=True)

    def far_ends(self, size: float, *, reach: float = 1.0) -> FloatArray:
        """Return the ends away from the origins, (n, 3), m, world, for a body of that size, m.

        With a ``reach`` above 1 they are that much farther out.
        """
        sides = np.where(np.reshape(self.arrives or np.zeros(len(self.vectors)), (-1, 1)), -1.0, 1.0)
        return self.origins + sides * self.vectors * (reach * self.scale(size))

    def scale(self, size: float) -> float:
        """Return the drawn length of one unit, m, for a body of that size, m."""
        longest = float(np.linalg.norm(self.vectors, axis=1).max(initial=0.0))
        return ARROW_LENGTH * size / longest if longest > 0.0 else 0.0

    def _colors(self) -> NDArray[np.uint8]:
        return np.array(self.colors, dtype=np.uint8).reshape(-1, 4)


def draw_impact(
    recording: rr.RecordingStream,
    shape: Shape,
    answer: ImpactAnswer,
    *,
    other_shape: Shape | None = None,
) -> None:
    """Draw an impact in the scene, at the recording's current time.

    Args:
        recording: To draw into.
        shape: The shape of the body.
        answer: The impact.
        other_shape: The shape of the body that is struck. If it is None, only its velocities are drawn.
    """
    path, size = impact_entity(answer.body_name), shape.size
    impact, other = answer.impact, answer.other
    struck, points, impulses_W = _struck(answer)
    impulses = Arrows(origins=points, vectors=impulses_W, unit="N s", colors=(palette.IMPACT,) * len(points))
    velocities = velocity_arrows(answer)
    recording.log(f"{path}/impulse", impulses.drawn(size))
    main = main_strikes(impact.strikes)
    recording.log(f"{path}/impulse_label", _impulse_labels(answer, struck, impulses, main, size=size))
    recording.log(f"{path}/velocity", velocities.drawn(size))
    recording.log(f"{path}/velocity_label", velocity_labels(answer, size))
    recording.log(f"{path}/measured_velocity", rr.Clear(recursive=False))  # the impact before had one
    paths = _paths(answer, scale=impulses.scale(size)) if not impact.strikes else []
    strips = rr.LineStrips3D(strips_3d(paths), colors=palette.IMPACT, radii=2.0 * _OUTLINE_WIDTH)
    recording.log(f"{path}/impulse_path", strips)
    height = CONE_HEIGHT * size
    width = 0.5 * ARROW_WIDTH * size
    once = [struck.index(contact) for contact in dict.fromkeys(struck)]
    points = points[once]
    normals = answer.contacts.normals_W[struck][once]
    frictions = answer.contacts.frictions[struck][once]
    arrows = rr.Arrows3D(origins=points, vectors=normals * height, colors=palette.NORMAL, radii=width)
    recording.log(f"{path}/normal", arrows)
    spheres = rr.Points3D(points, radii=_POINT_SIZE * size, colors=palette.IMPACT)
    recording.log(f"{path}/point", spheres)
    draw_marks(recording, [friction_cones("cone", points, normals, frictions, height=height)], path)
    bodies = [(shape, answer.state), *((shape, impact.strikes[i].state_before) for i in main)]
    if other is not None and other_shape is not None:
        bodies.append((other_shape, other.state))
    edges = [edge for drawn, state in bodies for edge in outline(drawn, state.p_WB_W, state.q_WB)]
    body = rr.LineStrips3D(
        strips_3d(edges), colors=palette.translucent(palette.IMPACT, 0.7), radii=_OUTLINE_WIDTH
    )
    recording.log(f"{path}/body", body)


def velocity_arrows(answer: ImpactAnswer) -> Arrows:
    """Return the velocities of the moving bodies before and after an impact, two arrows for each body.

    The first ends at the centre of mass and the second begins there.
    """
    impact, other = answer.impact, answer.other
    moving = [(answer.state.p_WB_W, answer.state.v_WB_W, impact.state.v_WB_W)]
    if other is not None and impact.other_state is not None:
        moving.append((other.state.p_WB_W, other.state.v_WB_W, impact.other_state.v_WB_W))
    return Arrows(
        origins=np.array([p_W for p_W, _, _ in moving for _ in range(2)]),
        vectors=np.array([v_W for _, *both in moving for v_W in both]),
        unit="m/s",
        colors=(palette.BEFORE_IMPACT, palette.AFTER_IMPACT) * len(moving),
        arrives=(True, False) * len(moving),
    )


def velocity_labels(answer: ImpactAnswer, size: float, measured: str = "") -> rr.Points3D:
    """Return the labels of these arrows, for a body of that size, m, with what was measured after it."""
    velocities = velocity_arrows(answer)
    words = ["before", "predicted after"] * (len(velocities.origins) // 2)
    if measured:
        words[1] = f"{measured}, predicted"
    places = velocities.far_ends(size, reach=LABEL_REACH)
    contacts = answer.contacts
    if len(contacts):  # the body leaves along this velocity, where a label would cover it
        places[1] = (contacts.p_WC_W - AFTER_DEPTH * size * contacts.normals_W).mean(axis=0)
    return velocities.labels(places, before=words)


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


def _impulse_labels(
    answer: ImpactAnswer, struck: list[int], impulses: Arrows, main: list[int], *, size: float
) -> rr.Points3D:
    strikes = answer.impact.strikes
    if not strikes:
        return impulses.labels(impulses.origins - LABEL_DEPTH * size * answer.contacts.normals_W[struck])
    labelled = replace(
        impulses,
        origins=impulses.origins[main],
        vectors=impulses.vectors[main],
        colors=(palette.IMPACT,) * len(main),
    )
    numbers = [f"{i + 1}. at {1e3 * strikes[i].seconds:.1f} ms:" for i in main]
    return labelled.labels(impulses.far_ends(size)[main], before=numbers)


def _paths(answer: ImpactAnswer, *, scale: float) -> list[FloatArray]:
    """Return the path of the accumulated impulse of each contact, (k, 3), m, world."""
    owners = np.array(answer.impact.path_contacts, dtype=np.int64)
    return [
        answer.contacts.p_WC_W[contact] + scale * answer.impact.path_W[owners == contact]
        for contact in np.unique(owners).tolist()
    ]
