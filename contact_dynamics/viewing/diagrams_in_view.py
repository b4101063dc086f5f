# SPDX-License-Identifier: Apache-2.0
"""Draws the diagrams of answers beside the scene, and keeps track of those in view.

A planar answer about contact modes has its consistent modes side by side, seen against the plane's normal.
With wrench sets, it has the map of modes over applied wrenches, and lecture 26's construction for the first
mode. Both take long to draw; while they look the same, only the applied wrench is redrawn in them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import rerun as rr

from contact_dynamics.diagrams.contact_scene import MAX_MODES
from contact_dynamics.diagrams.force_dual import answer_marks, force_dual
from contact_dynamics.diagrams.impulse_space import impulse_space, impulse_space_in_3d
from contact_dynamics.diagrams.mode_map import (
    LIVE_RESOLUTION,
    applied_marks,
    look_alike,
    mode_map,
    paint_of_modes,
)
from contact_dynamics.diagrams.planar_scene import (
    applied_of,
    dual_chart_of,
    map_of_answer,
    modes_side_by_side,
)
from contact_dynamics.diagrams.wrench_chart import DirectionChart
from contact_dynamics.viewing.drawing import draw_diagram, draw_side_by_side, redraw
from contact_dynamics.viewing.entities import (
    FORCE_DUAL,
    IMPULSE_SPACE,
    IMPULSE_SPACE_IN_3D,
    MODE_MAP,
    PLANAR_MODES,
)

if TYPE_CHECKING:
    from contact_dynamics.diagrams.marks import Diagram, Mark
    from contact_dynamics.diagrams.planar_scene import AnswersMap, ModesSideBySide
    from contact_dynamics.diagrams.wrench_chart import ForceDualChart
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.plane.types import PlanarWrench
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray


class _MapInView(NamedTuple):
    shown: AnswersMap
    diagram: Diagram


class _DualInView(NamedTuple):
    of_map: AnswersMap
    mode: str
    chart: ForceDualChart
    diagram: Diagram


class DiagramsInView:
    """The diagrams of the newest answers. Each method draws at the recording's current time."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._map: _MapInView | None = None
        self._dual: _DualInView | None = None
        self._in_3d = False

    def draw_impact(
        self, answer: ImpactAnswer, *, body: MassProperties | None, other: MassProperties | None
    ) -> list[str]:
        """Draw an impact in impulse space, also in 3-D if it is not planar, and return the drawn diagrams.

        ``body`` and ``other``, which is struck, are None if unknown.
        """
        if len(answer.impact.path_W) == 0:
            return []
        draw_diagram(self._recording, impulse_space(body, answer, other=other), IMPULSE_SPACE)
        if answer.plane is None:
            self._in_3d = True
            in_3d = impulse_space_in_3d(body, answer, other=other)
            draw_diagram(self._recording, in_3d, IMPULSE_SPACE_IN_3D)
            return [IMPULSE_SPACE, IMPULSE_SPACE_IN_3D]
        if self._in_3d:  # that of an earlier impact
            self._in_3d = False
            self._recording.log(IMPULSE_SPACE_IN_3D, rr.Clear(recursive=True))
        return [IMPULSE_SPACE]

    def draw_planar_modes(
        self,
        answer: ContactModeAnswer,
        plane: PlaneOfMotion,
        *,
        outline: FloatArray,
        body: MassProperties | None,
    ) -> list[str]:
        """Draw the modes of a planar answer, their map and the force dual, and return the drawn diagrams.

        The ``outline`` of the body is a closed strip, (k, 2), m from the centre of mass. It may be empty.
        """
        view = modes_side_by_side(answer, plane, outline=outline)
        draw_side_by_side(self._recording, view.scenes[:MAX_MODES], PLANAR_MODES, name="mode")
        if not answer.wrench_sets:
            return [PLANAR_MODES, *([] if self._dual is None else [FORCE_DUAL])]
        self._draw_map(map_of_answer(answer, plane, body=body))
        self._draw_dual(view, applied_of(answer, plane, body))
        return [PLANAR_MODES, MODE_MAP, *([] if self._dual is None else [FORCE_DUAL])]

    def _draw_map(self, new: AnswersMap | None) -> None:
        before, self._map = self._map, None
        if new is None:
            self._recording.log(MODE_MAP, rr.Clear(recursive=True))
        elif (
            before is not None
            and isinstance(new.chart, DirectionChart)
            and isinstance(before.shown.chart, DirectionChart)
            and look_alike(before.shown.sets, new.sets, length=new.chart.length)
        ):
            marks = applied_marks(before.shown.chart, new.applied, new.change)
            self._map = before._replace(diagram=_replaced(before.diagram, "applied", marks))
            redraw(self._recording, self._map.diagram, MODE_MAP, "applied")
        else:
            diagram = mode_map(new.sets, new.chart, applied=new.applied, change=new.change)
            self._map = _MapInView(new, diagram)
            draw_diagram(self._recording, diagram, MODE_MAP)

    def _draw_dual(self, view: ModesSideBySide, applied: PlanarWrench | None) -> None:
        """Draw the construction for the first mode, if the map contains its wrenches."""
        before, self._dual = self._dual, None
        shown = None if self._map is None else self._map.shown
        chart = None if shown is None else dual_chart_of(view, shown, resolution=LIVE_RESOLUTION)
        sets = () if shown is None or chart is None else shown.sets
        one = next((one for one in sets if one.mode == view.modes[0].mode), None)
        if shown is None or chart is None or one is None:
            self._recording.log(FORCE_DUAL, rr.Clear(recursive=True))
            return
        mode = view.modes[0]
        if before is not None and before.of_map is shown and before.mode == one.mode:
            marks = answer_marks(before.chart, applied=applied, mode=mode)
            self._dual = before._replace(diagram=_replaced(before.diagram, "answer", marks))
            redraw(self._recording, self._dual.diagram, FORCE_DUAL, "answer")
            return
        color = paint_of_modes([one.mode], sorted(each.mode for each in sets)).dark
        outlines = [view.outline, *view.walls]
        diagram = force_dual(
            one, view.contacts, chart, outlines=outlines, color=color, applied=applied, mode=mode
        )
        self._dual = _DualInView(shown, one.mode, chart, diagram)
        draw_diagram(self._recording, diagram, FORCE_DUAL)


def _replaced(diagram: Diagram, part: str, marks: list[Mark]) -> Diagram:
    """Return a diagram with other marks in place of those whose names have a prefix."""
    kept = [mark for mark in diagram.marks if not mark.name.startswith(part)]
    return replace(diagram, marks=[*kept, *marks])
