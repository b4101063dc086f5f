"""Draws the force dual of a planar answer about contact modes, beside the map of its modes.

It is lecture 26's construction for the first consistent mode, with what the answer says in it: the wrench in
question, at its force dual, and the centre of the body's acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.mode_map import LIVE_RESOLUTION
from contact_dynamics.diagrams.planar_modes import dual_chart_of, modes_side_by_side
from contact_dynamics.diagrams.wrench_chart import HIDDEN, ForceDualChart, picture_size
from contact_dynamics.viewing.entities import FORCE_DUAL
from contact_dynamics.viewing.force_dual import draw_force_dual
from contact_dynamics.viewing.mode_map import color_of_modes
from contact_dynamics.viewing.strips import strips_2d
from contact_dynamics.viewing.words import room_2d, words_2d

if TYPE_CHECKING:
    from contact_dynamics.contact_modes import PlanarMode
    from contact_dynamics.diagrams.planar_modes import AnswersMap
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.plane.types import PlanarWrench
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.validation import FloatArray

_POINT_SIZE: Final = -6.5  # a negative size is in points of the screen
_LEADER_WIDTH: Final = -0.8
_WORDS: Final = 0.3  # distance of the words' middle from the chart, relative to the chart's width


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DualInView:
    """The construction that is in the picture.

    Attributes:
        of_map: The map that is in the picture beside it.
        mode: The mode's letters.
        chart: How it is laid out.
    """

    of_map: AnswersMap
    mode: str
    chart: ForceDualChart


def draw_planar_dual(
    recording: rr.RecordingStream,
    answer: ContactModeAnswer,
    plane: PlaneOfMotion,
    before: DualInView | None,
    *,
    shown: AnswersMap | None,
    applied: PlanarWrench | None,
    outline: FloatArray,
) -> DualInView | None:
    """Draw the construction at the current time, and return the one that is in the picture then.

    If map and mode are those of the picture before, only the answer's dots move.

    Args:
        recording: To draw into.
        answer: The answer, in world axes.
        plane: The plane of motion.
        before: The construction in the picture so far, if there is one.
        shown: The map in the picture, of `draw_planar_map`.
        applied: The wrench in question, or None if it is not known.
        outline: Outline of the body, a closed strip, (k, 2), m from the centre of mass. It may be empty.
    """
    if not answer.wrench_sets:
        return before
    view = modes_side_by_side(answer, plane, outline=outline)
    chart = None if shown is None else dual_chart_of(view, shown, resolution=LIVE_RESOLUTION)
    sets = () if shown is None or chart is None else shown.sets
    one = next((one for one in sets if one.mode == view.modes[0].mode), None)
    if shown is None or chart is None or one is None:  # the map may have no wrenches of the answer's mode
        recording.log(FORCE_DUAL, rr.Clear(recursive=True))
        return None
    if before is None or before.of_map is not shown or before.mode != one.mode:
        every = sorted(each.mode for each in shown.sets)
        color = color_of_modes([one.mode], every)
        draw_force_dual(recording, one, view.contacts, chart, outlines=[outline, *view.walls], color=color)
        before = DualInView(of_map=shown, mode=one.mode, chart=chart)
    _draw_dots(recording, before.chart, applied=applied, mode=view.modes[0])
    return before


def _draw_dots(
    recording: rr.RecordingStream, chart: ForceDualChart, *, applied: PlanarWrench | None, mode: PlanarMode
) -> None:
    """Draw the wrench in question and the centre of the acceleration, where the chart shows them."""
    a_x, a_y = mode.acceleration
    turn = mode.angular_acceleration * chart.length**2
    told = [("acceleration centre", (a_x, a_y, turn), palette.PREDICTED)]
    if applied is not None:
        told.append(("applied wrench", (*applied.f, applied.moment), palette.IMPACT))
    places, part = chart.place(np.array([row for _, row, _ in told]))
    there = np.flatnonzero(part != HIDDEN).tolist()
    colors = [told[i][2] for i in there]
    labels = [told[i][0] for i in there]
    recording.log(
        f"{FORCE_DUAL}/answer",
        rr.Points2D(places[there], colors=colors, radii=_POINT_SIZE, labels=labels, show_labels=False),
    )
    # Dots are often near each other and near those of the construction, so words stand beside the chart.
    width, height = picture_size(chart)
    beside = [np.array([(1.0 + _WORDS) * width, (0.3 + 0.2 * i) * height]) for i in there]
    leaders = [np.array([places[i], (width, word[1])]) for i, word in zip(there, beside, strict=True)]
    strips = rr.LineStrips2D(
        strips_2d(leaders), colors=[palette.translucent(color, 0.5) for color in colors], radii=_LEADER_WIDTH
    )
    recording.log(f"{FORCE_DUAL}/leaders", strips)
    recording.log(f"{FORCE_DUAL}/words", words_2d(np.reshape(beside, (-1, 2)), labels, colors))
    room = np.array([(-2.0 * _WORDS * width, 0.0), ((1.0 + 2.0 * _WORDS) * width, 0.0)])
    recording.log(f"{FORCE_DUAL}/words_room", room_2d(room))
