# SPDX-License-Identifier: Apache-2.0
"""This file puts the consistent modes of a planar answer side by side, and says what the map of modes shows.

The plane's normal points towards the eye.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.contact_modes.planar.wrench_sets import length_of
from contact_dynamics.contact_modes.result import applied_wrench
from contact_dynamics.diagrams.mode_map import LIVE_RESOLUTION, chart_for
from contact_dynamics.diagrams.planar_scene import planar_scene_of
from contact_dynamics.diagrams.words import margin_in_words
from contact_dynamics.diagrams.wrench_chart import DirectionChart, ForceDualChart
from contact_dynamics.questions.plane_of_motion import seen_contacts, seen_modes, seen_wrench, seen_wrench_set

if TYPE_CHECKING:
    from contact_dynamics.contact_modes import PlanarMode, PlanarWrenchSet
    from contact_dynamics.diagrams.marks import Diagram
    from contact_dynamics.diagrams.wrench_chart import WrenchChart
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.plane.types import PlanarContact, PlanarWrench
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray

NO_SIZE: Final = 0.1  # m. A body without shape is drawn with this size at its only contact.

MAX_SETS: Final = 100
"""A map of more modes than this is not drawn, because its regions are too small to see and take seconds."""

_AROUND: Final = 0.35  # room around body and contacts in each picture, relative to the body's size
_WALL: Final = 0.1  # half of the length of a contact's flat, relative to the body's size


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModesSideBySide:
    """The consistent modes of a planar answer.

    Attributes:
        titles: What is said of each picture. There is one picture without a mode if no mode is consistent.
        modes: The modes. There may be none.
        contacts: The contacts.
        walls: The flats of the contacts, a strip (2, 2) each, m.
        outline: Outline of the body, a closed strip, (k, 2), m, which may be empty.
        size: m, the size of body and contacts.
        low: (2,), m, the lower left corner of each picture.
        high: (2,), m, the upper right corner.
    """

    titles: list[str]
    modes: tuple[PlanarMode, ...]
    contacts: tuple[PlanarContact, ...]
    walls: list[FloatArray]
    outline: FloatArray
    size: float
    low: FloatArray
    high: FloatArray

    @property
    def scenes(self) -> list[Diagram]:
        """The picture of each mode, or the one without a mode."""
        return [
            planar_scene_of(
                self.outline, self.contacts, walls=self.walls, mode=mode, size=self.size, title=title
            )
            for mode, title in zip(self.modes or (None,), self.titles, strict=True)
        ]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AnswersMap:
    """What the map of modes of a planar answer shows.

    Attributes:
        sets: The applied wrenches of each mode.
        chart: The chart that suits them.
        applied: The wrench in question, or None if it is not known.
        change: The least change that takes it out of the first mode, or None if it is not known.
    """

    sets: tuple[PlanarWrenchSet, ...]
    chart: WrenchChart
    applied: PlanarWrench | None
    change: PlanarWrench | None


def modes_side_by_side(
    answer: ContactModeAnswer, plane: PlaneOfMotion, *, outline: FloatArray
) -> ModesSideBySide:
    """Return the consistent modes of an answer.

    Args:
        answer: The answer, in world axes.
        plane: The plane of motion.
        outline: Outline of the body, a closed strip, (k, 2), m from the centre of mass. It may be empty.
    """
    modes = seen_modes(answer, plane)
    margins = [margin_in_words(margin) for margin in answer.margins or ()] or [""] * len(modes)
    titles = [
        f"{mode.mode}: {mode_in_words(mode.mode)}\n{margin}".rstrip()
        for mode, margin in zip(modes, margins, strict=True)
    ]
    return side_by_side(
        seen_contacts(answer, plane),
        modes,
        titles or ["approaches" if answer.approaching else "no consistent mode"],
        outline=outline,
    )


def side_by_side(
    contacts: tuple[PlanarContact, ...],
    modes: tuple[PlanarMode, ...],
    titles: list[str],
    *,
    outline: FloatArray,
) -> ModesSideBySide:
    """Return modes of a planar body with titles, of which there is one where there is no mode."""
    reach = [contact.r for contact in contacts]
    everything = np.vstack([outline, np.reshape(reach, (-1, 2)), np.zeros((1, 2))])
    low, high = everything.min(axis=0), everything.max(axis=0)
    size = float(np.linalg.norm(high - low)) or NO_SIZE
    return ModesSideBySide(
        titles=titles,
        modes=modes,
        contacts=contacts,
        walls=[_flat_of(contact, size) for contact in contacts],
        outline=outline,
        size=size,
        low=low - _AROUND * size,
        high=high + _AROUND * size,
    )


def map_of_answer(
    answer: ContactModeAnswer,
    plane: PlaneOfMotion,
    *,
    body: MassProperties | None = None,
    resolution: int = LIVE_RESOLUTION,
) -> AnswersMap | None:
    """Return the map of an answer, or None if it has no wrench sets, or more than `MAX_SETS`.

    Args:
        answer: The answer, in world axes.
        plane: The plane of motion.
        body: Mass properties, from which the wrench in question follows. If it is None, the wrench is not
            known.
        resolution: Points on a side of the chart.
    """
    if not answer.wrench_sets or len(answer.wrench_sets) > MAX_SETS:
        return None
    sets = tuple(seen_wrench_set(wrenches, plane) for wrenches in answer.wrench_sets)
    applied = applied_of(answer, plane, body)
    return AnswersMap(
        sets=sets,
        chart=chart_for(sets, length=length_of(sets), applied=applied, resolution=resolution),
        applied=applied,
        change=_change(answer, plane),
    )


def dual_chart_of(view: ModesSideBySide, shown: AnswersMap, *, resolution: int) -> ForceDualChart | None:
    """Return the chart of force duals for the modes of an answer, as wide as each of their pictures.

    It is None where there is no such construction: without a consistent mode, or for a moving body.

    Args:
        view: The modes.
        shown: The map of the same answer.
        resolution: Points on a side of each of the chart's squares.
    """
    if not view.modes or not isinstance(shown.chart, DirectionChart):
        return None
    middle = 0.5 * (view.low + view.high)
    return ForceDualChart(
        length=shown.chart.length,
        half_side=0.5 * float(np.max(view.high - view.low)),
        centre=(float(middle[0]), float(middle[1])),
        resolution=resolution,
    )


def applied_of(
    answer: ContactModeAnswer, plane: PlaneOfMotion, body: MassProperties | None
) -> PlanarWrench | None:
    """Return the wrench in question, or None if it is not known: without modes or mass properties."""
    if body is None or not answer.modes:
        return None
    return seen_wrench(applied_wrench(body, answer.state, answer.contacts, answer.modes[0]), plane)


def _change(answer: ContactModeAnswer, plane: PlaneOfMotion) -> PlanarWrench | None:
    """Return the least change that takes the wrench out of the first mode, or None if it is not known."""
    if not answer.margins or not math.isfinite(answer.margins[0].margin):
        return None
    return seen_wrench(answer.margins[0].change_W, plane)


def _flat_of(contact: PlanarContact, size: float) -> FloatArray:
    along = _WALL * size * np.array(contact.tangent)
    flat: FloatArray = np.array(contact.r) + np.array([-along, along])
    return flat
