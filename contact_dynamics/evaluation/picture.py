# SPDX-License-Identifier: Apache-2.0
"""Draws measured and predicted events side by side in rerun.

The measured body at the event is blue grey, with its path shortly before and after. Orange outlines are the
predicted poses, one for each horizon, fainter for longer horizons. At impacts, arrows are the velocities of
the centre of mass afterwards: blue for measured, yellow for predicted under each law. A table lists the
errors by event number.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.shape import drawn_shape, outline
from contact_dynamics.diagrams.world_scene import body_marks
from contact_dynamics.evaluation.asking import known_body
from contact_dynamics.evaluation.log_states import parameters_of
from contact_dynamics.evaluation.report import COLUMNS, UNITS
from contact_dynamics.evaluation.settings import Method
from contact_dynamics.measured.events import EventKind, find_events
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.questions.subject import carried_over
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.viewing.drawing import parts_of
from contact_dynamics.viewing.entities import entity
from contact_dynamics.viewing.kept_recording import APPLICATION
from contact_dynamics.viewing.side_by_side import EVENTS, MAX_DRAWN, TABLE, SideBySide

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from contact_dynamics.evaluation.comparison import Comparison
    from contact_dynamics.evaluation.result import Evaluation
    from contact_dynamics.evaluation.sources import Source
    from contact_dynamics.measured.events import FoundEvent
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body

TRAIL_S: Final = 0.08  # duration of the measured path that is drawn before and after an event, s
_ARROW: Final = 1.0  # length of the longest arrow, in sizes of the body
_FAINTEST: Final = 0.35
_WIDTH: Final = -1.8  # negative: points of the screen


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class _Cell(Record):
    """One drawn event, with the impact that follows it."""

    name: str
    event: FoundEvent
    motion: MeasuredMotion
    rows: tuple[Comparison, ...]
    impact: FoundEvent | None
    impact_rows: tuple[Comparison, ...]


def write_picture(
    path: Path, evaluation: Evaluation, sources: Sequence[Source], *, config: Path | None
) -> int:
    """Draw the first events of an evaluation into a file, which is replaced, and return how many were drawn.

    The ``sources`` with drawn events are read again, with the bodies in the parameter file ``config``
    (`Source.read`). Raise `OSError` if the file cannot be written.
    """
    cells = []
    for cell in _cells(evaluation, sources, config):
        cells.append(cell)
        if len(cells) == MAX_DRAWN:
            break
    recording = rr.RecordingStream(APPLICATION)
    recording.set_sinks(rr.FileSink(str(path)))
    places = SideBySide(
        count=len(cells),
        size=max((drawn_shape(cell.motion.body.shape).size for cell in cells), default=1.0),
        gravity_W=cells[0].motion.gravity_W if cells else np.zeros(3),
    )
    recording.send_blueprint(places.blueprint("Events, measured and predicted", "How far off"))
    for number, cell in enumerate(cells):
        _draw(recording, number, cell, places)
    lines = ["| | event | horizon | error |", "| --- | --- | --- | --- |"]
    for number, cell in enumerate(cells):
        lines += [f"| {number} | {cell.name} | {answer} |" for answer in _answers(cell)]
    table = rr.TextDocument("\n".join(lines), media_type=rr.MediaType.MARKDOWN)
    recording.log(TABLE, table, static=True)
    recording.disconnect()
    return len(cells)


def _cells(evaluation: Evaluation, sources: Sequence[Source], config: Path | None) -> Iterator[_Cell]:
    """Yield the ends of flights with their impacts, rests and slides, in their order."""
    named = {source.name: source for source in sources}
    for result in evaluation.results:
        if result.problem or result.source not in named:
            continue
        recording = named[result.source].read(config=config)
        asker = recording.informed if config is None else parameters_of(ParameterFile(config))[1]
        found = [(event, motion) for motion in recording.motions for event in find_events(motion)]
        numbers = {(event.kind, event.body, event.time_ns): i for i, (event, _) in enumerate(found)}
        for number, (event, motion) in enumerate(found):
            landed = (EventKind.LANDING, event.body)
            ends_in_landing = event.kind is EventKind.FLIGHT and any(
                key[:2] == landed and found[i][0].first_sample == event.first_sample
                for key, i in numbers.items()
            )
            if event.kind is EventKind.IMPACT or ends_in_landing:
                continue
            known = known_body(motion, asker)
            struck = numbers.get((EventKind.IMPACT, event.body, event.time_ns))
            is_struck = event.kind is EventKind.LANDING and struck is not None
            yield _Cell(
                name=f"{result.source.rpartition('/')[2]}, {event.kind.value} at {event.time:.3f} s",
                event=event,
                motion=motion,
                rows=_rows(result.comparisons, number, known, motion.body),
                impact=found[struck][0] if is_struck and struck is not None else None,
                impact_rows=_rows(result.comparisons, struck, known, motion.body) if is_struck else (),
            )


def _rows(
    rows: Sequence[Comparison], number: int | None, known: Body, measured: Body
) -> tuple[Comparison, ...]:
    """Return the predictions of an event, as those of the measured body's centre of mass.

    They were made for the centre of mass of the body in the predicting configuration.
    """
    return tuple(
        replace(row, predicted=None if row.predicted is None else _of_center(row.predicted, known, measured))
        for row in rows
        if row.event == number and not row.refused
    )


def _of_center(predicted: FloatArray, known: Body, measured: Body) -> FloatArray:
    p, q, v, w = np.split(predicted, [3, 7, 10])
    state = BodyState(p_WB_W=p, q_WB=q, v_WB_W=v, w_WB_W=w)
    moved = state_of(carried_over(state, known, measured))
    return np.concatenate([moved.p_WB_W, moved.q_WB, moved.v_WB_W, moved.w_WB_W])


def _draw(recording: rr.RecordingStream, number: int, cell: _Cell, places: SideBySide) -> None:
    path = entity(EVENTS, f"{number:02d} {cell.name}")
    motion, event = cell.motion, cell.event
    shape = drawn_shape(motion.body.shape)
    at_W = event.state.p_WB_W
    recording.log(path, rr.Transform3D(translation=places.place(number) - at_W), static=True)
    pose = rr.Transform3D(translation=at_W, quaternion=rr.Quaternion(xyzw=event.state.q_WB))
    recording.log(f"{path}/measured", pose, static=True)
    for name, part in parts_of(body_marks(shape)).items():
        recording.log(f"{path}/measured/{name}", part, static=True)
    near = np.abs(motion.times - event.time) <= TRAIL_S
    trail = rr.LineStrips3D([motion.p_WB_W[near]], colors=palette.MEASURED, radii=_WIDTH)
    recording.log(f"{path}/path", trail, static=True)
    fits = [row for row in cell.rows if row.method is Method.FIT and row.predicted is not None]
    for rank, row in enumerate(sorted(fits, key=lambda each: each.horizon)):
        if row.predicted is None:
            continue
        color = palette.translucent(palette.PREDICTED, max(_FAINTEST, 1.0 - 0.25 * rank))
        lines = outline(shape, row.predicted[:3], row.predicted[3:7])
        strips = rr.LineStrips3D(list(lines), colors=color, radii=_WIDTH)
        recording.log(entity(f"{path}/predicted", f"{1e3 * row.horizon:.0f} ms before"), strips, static=True)
    _draw_velocities(recording, path, cell, shape.size)
    below_W = at_W - 0.75 * shape.size * places.up_W
    name = f"{number} {event.kind.value}"
    label = rr.Points3D([below_W], labels=[name], radii=0.0, show_labels=True)
    recording.log(f"{path}/label", label, static=True)


def _draw_velocities(recording: rr.RecordingStream, path: str, cell: _Cell, size: float) -> None:
    if cell.impact is None:
        return
    shortest = min((row.horizon for row in cell.impact_rows), default=0.0)
    predicted = {
        row.law.value: row.predicted[7:10]
        for row in cell.impact_rows
        if row.method is Method.FIT
        and row.law is not None
        and row.predicted is not None
        and row.horizon == shortest
    }
    measured = cell.impact.state.v_WB_W
    longest = max(float(np.linalg.norm(v)) for v in [measured, *predicted.values()])
    scale = _ARROW * size / longest if longest > 0.0 else 0.0
    at_W = cell.event.state.p_WB_W
    for name, velocity, color in (
        ("measured", measured, palette.MEASURED),
        *((name, velocity, palette.AFTER_IMPACT) for name, velocity in predicted.items()),
    ):
        arrow = rr.Arrows3D(origins=[at_W], vectors=[scale * velocity], colors=color, radii=_WIDTH)
        recording.log(entity(path, "velocity after", name), arrow, static=True)


def _answers(cell: _Cell) -> Iterator[str]:
    """Yield the horizon and the errors of an event and its impact, at the shortest horizon, in Markdown."""
    for rows, event in ((cell.rows, cell.event), (cell.impact_rows, cell.impact)):
        if event is None or not rows:
            continue
        row = min(rows, key=lambda each: (each.horizon, list(Method).index(each.method)))
        asked = f"{1e3 * row.horizon:.0f} ms{f', {row.law.value}' if row.law else ''}"
        if row.predicted_mode:
            yield f"{asked} | {row.predicted_mode.replace('|', ' or ')}, measured {row.measured_mode}"
            continue
        errors = [
            f"{UNITS[name][1] * error:.2g} {UNITS[name][0].rpartition(' ')[2]}"
            for name in COLUMNS[event.kind]
            if (error := getattr(row, name)) is not None
        ]
        yield f"{asked} | {', '.join(errors)}"
