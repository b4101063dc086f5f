"""Draws a planar body and its contacts in 2D: outline, walls, friction cones, one mode's letters and forces.

Coordinates are in metres from the centre of mass, x to the right, y up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.planar_scene import planar_scene_of
from contact_dynamics.viewing.entities import PLANAR_SCENE
from contact_dynamics.viewing.strips import strips_2d
from contact_dynamics.viewing.words import words_2d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarMode
    from contact_dynamics.plane.types import PlanarContact
    from contact_dynamics.validation import FloatArray

_OUTLINE_WIDTH: Final = -1.8  # a negative size is in points of the screen
_WALL_WIDTH: Final = -3.6
_CONE_WIDTH: Final = -1.2
_ARROW_WIDTH: Final = -2.0
_POINT_SIZE: Final = -4.0


def draw_planar_scene(
    recording: rr.RecordingStream,
    outline: FloatArray,
    contacts: Sequence[PlanarContact],
    *,
    walls: Sequence[FloatArray] = (),
    mode: PlanarMode | None = None,
    size: float | None = None,
    shift: float = 0.0,
    entity: str = PLANAR_SCENE,
) -> None:
    """Draw a body and its contacts, at the recording's current time.

    Args:
        recording: to draw into.
        outline: (k, 2), m, outline of the body, whose last point is its first.
        contacts: numbered from 1.
        walls: strips, (k, 2) each, m.
        mode: the mode whose letters, contact forces and accelerations are drawn, if any.
        size: m, the size that arrows and cones suit. By default it is that of the outline.
        shift: m, how far to the right the picture stands.
        entity: where the picture is put.
    """
    scene = planar_scene_of(outline, contacts, walls=walls, mode=mode, size=size)
    aside = np.array([shift, 0.0])
    wall_strips = [wall + aside for wall in scene.walls]
    _strips(recording, f"{entity}/walls", wall_strips, palette.NORMAL, _WALL_WIDTH)
    _strips(recording, f"{entity}/body", [scene.outline + aside], palette.MEASURED, _OUTLINE_WIDTH)
    cones = [cone + aside for cone in scene.cones]
    _strips(recording, f"{entity}/cones", cones, palette.translucent(palette.FRICTION_CONE, 1.0), _CONE_WIDTH)
    colors = [_color(letter) for letter in scene.letters]
    points = rr.Points2D(upright(scene.points + aside), colors=colors, radii=_POINT_SIZE)
    recording.log(f"{entity}/contacts", points)
    names = words_2d(
        upright(np.array([label.place for label in scene.labels]).reshape(-1, 2) + aside),
        [label.text for label in scene.labels],
        [_color(scene.letters[label.contacts[0]]) for label in scene.labels],
    )
    recording.log(f"{entity}/letters", names)
    centre = rr.Points2D(
        [aside], colors=palette.MEASURED, radii=_POINT_SIZE, labels="centre of mass", show_labels=False
    )
    recording.log(f"{entity}/centre_of_mass", centre)
    for name, arrows, color in (
        ("forces", scene.forces, palette.IMPACT),
        ("accelerations", scene.accelerations, palette.PREDICTED),
    ):
        if arrows is None:
            recording.log(f"{entity}/{name}", rr.Clear(recursive=False))
            continue
        drawn = rr.Arrows2D(
            origins=upright(arrows.origins + aside),
            vectors=upright(arrows.vectors),
            colors=color,
            radii=_ARROW_WIDTH,
            labels=[f"{size:.3g} {arrows.unit}" for size in arrows.sizes.tolist()],
            show_labels=False,
        )
        recording.log(f"{entity}/{name}", drawn)


def _color(letter: str) -> palette.Color:
    return palette.LETTER_COLORS.get(letter, palette.UNDECIDED)


def upright(points: FloatArray) -> FloatArray:
    """Return points with the second coordinate downwards, as rerun's 2D views have it."""
    flipped: FloatArray = np.reshape(points, (-1, 2)) * (1.0, -1.0)
    return flipped


def _strips(
    recording: rr.RecordingStream,
    path: str,
    strips: Sequence[FloatArray],
    color: palette.Color,
    width: float,
) -> None:
    recording.log(
        path, rr.LineStrips2D(strips_2d([upright(strip) for strip in strips]), colors=color, radii=width)
    )
