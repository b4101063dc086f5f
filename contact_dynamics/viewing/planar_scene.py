"""Draws a planar body and its contacts in 2D: outline, walls, friction cones, one mode's letters and forces.

Coordinates are in metres from the centre of mass, x to the right, y up.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import PLANAR_SCENE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarMode
    from contact_dynamics.plane.types import PlanarContact
    from contact_dynamics.validation import FloatArray

CONE_LENGTH: Final = 0.2
"""Length of a friction cone's edges, relative to the body's size."""

ARROW_LENGTH: Final = 0.4
"""Length of the longest arrow of a kind, relative to the body's size."""

_LABEL_OFFSET: Final = 0.07  # distance of a label from its contact, relative to the body's size
_COVERED: Final = 0.06  # labels nearer than this would cover each other, relative to the body's size
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
    if size is None:
        size = float(np.linalg.norm(np.ptp(outline, axis=0)))
    aside = np.array([shift, 0.0])
    points = np.array([contact.r for contact in contacts]).reshape(-1, 2) + aside
    normals = np.array([contact.normal for contact in contacts]).reshape(-1, 2)
    tangents = np.array([contact.tangent for contact in contacts]).reshape(-1, 2)
    _strips(recording, f"{entity}/walls", [wall + aside for wall in walls], palette.NORMAL, _WALL_WIDTH)
    _strips(recording, f"{entity}/body", [outline + aside], palette.MEASURED, _OUTLINE_WIDTH)
    cones = [cone_edges(contact, length=CONE_LENGTH * size) + aside for contact in contacts]
    _strips(recording, f"{entity}/cones", cones, palette.translucent(palette.FRICTION_CONE, 1.0), _CONE_WIDTH)
    letters = mode.mode if mode else "?" * len(contacts)
    colors = np.array([palette.LETTER_COLORS.get(letter, palette.UNDECIDED) for letter in letters])
    places = points - _LABEL_OFFSET * size * normals
    labels = [f"{i} {letter}" if mode else str(i) for i, letter in enumerate(letters, start=1)]
    recording.log(f"{entity}/contacts", rr.Points2D(upright(points), colors=colors, radii=_POINT_SIZE))
    together = _same_places(places, size)
    names = rr.Points2D(
        upright(places[[same[0] for same in together]]),
        colors=colors[[same[0] for same in together]],
        radii=0.0,
        labels=[", ".join(labels[i] for i in same) for same in together],
        show_labels=True,
    )
    recording.log(f"{entity}/letters", names)
    centre = rr.Points2D(
        [aside], colors=palette.MEASURED, radii=_POINT_SIZE, labels="centre of mass", show_labels=False
    )
    recording.log(f"{entity}/centre_of_mass", centre)
    if mode is None:
        for name in ("forces", "accelerations"):
            recording.log(f"{entity}/{name}", rr.Clear(recursive=False))
        return
    for name, pairs, unit in (
        ("forces", mode.contact_forces, "N"),
        ("accelerations", mode.contact_accelerations, "m/s²"),
    ):
        rows = np.array(pairs).reshape(-1, 2)
        vectors = rows[:, :1] * tangents + rows[:, 1:] * normals
        lengths = np.linalg.norm(vectors, axis=1)
        longest = float(lengths.max(initial=0.0))
        chosen = lengths > 1e-6 * longest
        arrows = rr.Arrows2D(
            origins=upright(points[chosen]),
            vectors=upright(vectors[chosen]) * (ARROW_LENGTH * size / longest if longest > 0.0 else 0.0),
            colors=palette.IMPACT if name == "forces" else palette.PREDICTED,
            radii=_ARROW_WIDTH,
            labels=[f"{length:.3g} {unit}" for length in lengths[chosen].tolist()],
            show_labels=False,
        )
        recording.log(f"{entity}/{name}", arrows)


def cone_edges(contact: PlanarContact, *, length: float) -> FloatArray:
    """Return a friction cone as a strip, (3, 2), m, with edges of that length, m."""
    angle = math.atan(contact.friction)
    normal, tangent = np.array(contact.normal), np.array(contact.tangent)
    upward, sideways = length * math.cos(angle) * normal, length * math.sin(angle) * tangent
    strip: FloatArray = np.array(contact.r) + np.array([upward + sideways, np.zeros(2), upward - sideways])
    return strip


def upright(points: FloatArray) -> FloatArray:
    """Return points with the second coordinate downwards, as rerun's 2D views have it."""
    flipped: FloatArray = np.reshape(points, (-1, 2)) * (1.0, -1.0)
    return flipped


def _same_places(places: FloatArray, size: float) -> list[list[int]]:
    """Return the indices of places, (k, 2), m, grouped by those whose labels would cover each other."""
    groups: list[list[int]] = []
    for i, place in enumerate(places):
        near = (same for same in groups if np.linalg.norm(places[same[0]] - place) <= _COVERED * size)
        group = next(near, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    return groups


def _strips(
    recording: rr.RecordingStream,
    path: str,
    strips: Sequence[FloatArray],
    color: palette.Color,
    width: float,
) -> None:
    recording.log(path, rr.LineStrips2D([upright(strip) for strip in strips], colors=color, radii=width))
