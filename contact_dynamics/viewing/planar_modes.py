"""Draws a planar answer about contact modes in 2D: its consistent modes side by side, and the map of modes.

The plane's normal points towards the eye, and each mode has its own picture. If wrench sets were asked for,
the map of modes over applied wrenches shows the wrench in question and its least change into another mode.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.contact_modes.planar.wrench_sets import length_of
from contact_dynamics.contact_modes.spatial.applied_wrench import applied_wrench
from contact_dynamics.questions.planar_view import seen_contacts, seen_modes, seen_wrench, seen_wrench_set
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.contact_modes import MOST_MODES
from contact_dynamics.viewing.entities import MODE_MAP, PLANAR_MODES
from contact_dynamics.viewing.mode_map import chart_for, draw_applied, draw_mode_map, look_alike
from contact_dynamics.viewing.planar_scene import draw_planar_scene, upright
from contact_dynamics.viewing.shape import FLAT
from contact_dynamics.viewing.words import margin_in_words
from contact_dynamics.viewing.wrench_chart import DirectionChart

if TYPE_CHECKING:
    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.plane.types import PlanarContact, PlanarWrench
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.shape import Shape
    from contact_dynamics.viewing.wrench_chart import WrenchChart

NO_SIZE: Final = 0.1
"""m. A body without shape is drawn with this size at its only contact."""

MOST_SETS: Final = 100
"""A map of more modes than this is not drawn, because its regions are too small to see and take seconds."""

_AROUND: Final = 0.45  # room around body and contacts in each picture, relative to the body's size
_WALL: Final = 0.15  # half of the length of a contact's flat, relative to the body's size


def draw_planar_modes(
    recording: rr.RecordingStream, answer: ContactModeAnswer, plane: PlaneOfMotion, *, outline: FloatArray
) -> None:
    """Draw the consistent modes side by side, at the current time.

    Args:
        recording: To draw into.
        answer: The answer, in world axes.
        plane: The plane of motion.
        outline: Outline of the body, a closed strip, (k, 2), m from the centre of mass. It may be empty.
    """
    contacts, modes = seen_contacts(answer, plane), seen_modes(answer, plane)
    reach = [contact.r for contact in contacts]
    everything = np.vstack([outline, np.reshape(reach, (-1, 2)), np.zeros((1, 2))])
    low, high = everything.min(axis=0), everything.max(axis=0)
    size = float(np.linalg.norm(high - low)) or NO_SIZE
    low, high = low - _AROUND * size, high + _AROUND * size
    margins = [margin_in_words(margin) for margin in answer.margins or ()] or [""] * len(modes)
    titles = [f"{mode.mode} {margin}" for mode, margin in zip(modes, margins, strict=True)]
    if not titles:
        titles = ["approaches" if answer.approaching else "no consistent mode"]
    for i in range(MOST_MODES):
        path = f"{PLANAR_MODES}/mode_{i + 1}"
        if i >= len(titles):
            recording.log(path, rr.Clear(recursive=True))
            continue
        aside = np.array([i * float(high[0] - low[0]), 0.0])
        draw_planar_scene(
            recording,
            outline,
            contacts,
            size=size,
            walls=[_flat_of(contact, size) for contact in contacts],
            mode=modes[i] if modes else None,
            shift=float(aside[0]),
            entity=path,
        )
        place = upright(np.array([0.5 * (low[0] + high[0]), high[1]]) + aside)
        points = rr.Points2D(place, colors=palette.NORMAL, radii=0.0, labels=[titles[i]], show_labels=True)
        recording.log(f"{path}/title", points)
        room = rr.Points2D(upright(np.array([low, high]) + aside), colors=palette.BACKGROUND, radii=0.0)
        recording.log(f"{path}/room", room)  # the viewer fits these points into the view


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnMap:
    """The map that is in the picture."""

    sets: tuple[PlanarWrenchSet, ...]
    chart: WrenchChart


def draw_planar_map(
    recording: rr.RecordingStream,
    answer: ContactModeAnswer,
    plane: PlaneOfMotion,
    before: DrawnMap | None,
    *,
    body: MassProperties | None = None,
) -> DrawnMap | None:
    """Draw the answer's map at the current time, and return the map that is in the picture then.

    If it looks like the map before, only the wrench in question moves.

    Args:
        recording: To draw into.
        answer: The answer, in world axes.
        plane: The plane of motion.
        before: The map in the picture so far, if there is one.
        body: Mass properties, from which the wrench in question follows. If it is None, the wrench is not
            drawn.
    """
    if not answer.wrench_sets:
        return before
    if len(answer.wrench_sets) > MOST_SETS:
        recording.log(MODE_MAP, rr.Clear(recursive=True))
        return None
    sets = tuple(seen_wrench_set(wrenches, plane) for wrenches in answer.wrench_sets)
    applied, change = _applied(answer, plane, body), _change(answer, plane)
    chart = chart_for(sets, length=length_of(sets), applied=applied)
    if (
        before is not None
        and isinstance(chart, DirectionChart)
        and isinstance(before.chart, DirectionChart)
        and look_alike(before.sets, sets, length=chart.length)
    ):
        draw_applied(recording, before.chart, applied=applied, change=change)
        return before
    draw_mode_map(recording, sets, chart, applied=applied, change=change)
    return DrawnMap(sets=sets, chart=chart)


def _applied(
    answer: ContactModeAnswer, plane: PlaneOfMotion, body: MassProperties | None
) -> PlanarWrench | None:
    """Return the wrench in question, or None if it is not known."""
    if body is None or not answer.modes:
        return None
    return seen_wrench(applied_wrench(body, answer.state, answer.contacts, answer.modes[0]), plane)


def _change(answer: ContactModeAnswer, plane: PlaneOfMotion) -> PlanarWrench | None:
    """Return the least change that takes the wrench out of the first mode, or None if it is not known."""
    if not answer.margins or not math.isfinite(answer.margins[0].margin):
        return None
    return seen_wrench(answer.margins[0].change_W, plane)


def silhouette(shape: Shape, axes_B: FloatArray) -> FloatArray:
    """Return a convex shape's outline on two axes, (2, 3), unit, as a closed strip, (k, 2), m."""
    from scipy.spatial import ConvexHull

    corners = np.vstack([shape.triangles_B.reshape(-1, 3), shape.edges_B.reshape(-1, 3)]) @ axes_B.T
    if len(corners) == 0 or np.linalg.matrix_rank(corners - corners[0], tol=FLAT * shape.size) < 2:
        return corners[:2]  # a rod is a line, and so is a disc seen from the side
    hull = ConvexHull(corners).vertices
    strip: FloatArray = corners[[*hull, hull[0]]]
    return strip


def _flat_of(contact: PlanarContact, size: float) -> FloatArray:
    along = _WALL * size * np.array(contact.tangent)
    flat: FloatArray = np.array(contact.r) + np.array([-along, along])
    return flat
