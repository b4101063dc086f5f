"""Draws a planar answer about contact modes in 2D: its consistent modes side by side, and the map of modes.

The plane's normal points towards the eye, and each mode has its own picture. If wrench sets were asked for,
the map of modes over applied wrenches shows the wrench in question and its least change into another mode.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.mode_map import look_alike
from contact_dynamics.diagrams.planar_modes import map_of_answer, modes_side_by_side
from contact_dynamics.diagrams.wrench_chart import DirectionChart
from contact_dynamics.viewing.contact_modes import MAX_MODES
from contact_dynamics.viewing.entities import MODE_MAP, PLANAR_MODES
from contact_dynamics.viewing.mode_map import draw_applied, draw_mode_map
from contact_dynamics.viewing.planar_scene import draw_planar_scene, upright
from contact_dynamics.viewing.words import room_2d, words_2d

if TYPE_CHECKING:
    from contact_dynamics.diagrams.planar_modes import AnswersMap
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray


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
    view = modes_side_by_side(answer, plane, outline=outline)
    low, high = view.low, view.high
    for i in range(MAX_MODES):
        path = f"{PLANAR_MODES}/mode_{i + 1}"
        if i >= len(view.titles):
            recording.log(path, rr.Clear(recursive=True))
            continue
        aside = np.array([i * float(high[0] - low[0]), 0.0])
        draw_planar_scene(
            recording,
            outline,
            view.contacts,
            size=view.size,
            walls=view.walls,
            mode=view.modes[i] if view.modes else None,
            shift=float(aside[0]),
            entity=path,
        )
        place = upright(np.array([0.5 * (low[0] + high[0]), high[1]]) + aside)
        recording.log(f"{path}/title", words_2d(place, [view.titles[i]], [palette.NORMAL]))
        recording.log(f"{path}/room", room_2d(upright(np.array([low, high]) + aside)))


def draw_planar_map(
    recording: rr.RecordingStream,
    answer: ContactModeAnswer,
    plane: PlaneOfMotion,
    before: AnswersMap | None,
    *,
    body: MassProperties | None = None,
) -> AnswersMap | None:
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
    new = map_of_answer(answer, plane, body=body)
    if new is None:
        recording.log(MODE_MAP, rr.Clear(recursive=True))
        return None
    if (
        before is not None
        and isinstance(new.chart, DirectionChart)
        and isinstance(before.chart, DirectionChart)
        and look_alike(before.sets, new.sets, length=new.chart.length)
    ):
        draw_applied(recording, before.chart, applied=new.applied, change=new.change)
        return before
    draw_mode_map(recording, new.sets, new.chart, applied=new.applied, change=new.change)
    return new
