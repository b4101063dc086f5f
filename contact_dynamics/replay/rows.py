# SPDX-License-Identifier: Apache-2.0
"""Makes a table row for each request of a recording: the request, the response, and the measured outcome.

A request about many states or candidates has a row for each of them, the first of which contains the request.
Positions are those of the body's published frame, linear velocities those of its centre of mass, in world
axes.

The records of services name the functions ``cells_of_...``, which yield cells by the names of their columns:
once, or once for each of many states or candidates. `Rows` adds the cells that all rows of a request share.

The measured outcome of a flight is the last state published before the predicted time, extrapolated to that
time as free flight (over a few ms at usual rates). The measured outcome of an impact is the free flight that
best fits the poses of the 50 ms after it, extrapolated back to it; a tracker's velocities across the impact
do not enter. If the body does not fly then, or strikes again, the measured values are not comparable with the
prediction.
"""

from __future__ import annotations

import json
import math
from collections import deque
from collections.abc import Sized
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.constants import ns_after, seconds_between
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.replay.events import Monitored, StateCame, WorldChanged
from contact_dynamics.rigid_body.published_frame import origin_of_published_frame, origins_of_published_frame
from contact_dynamics.tumbling.motion import free_motion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from contact_dynamics.questions.bodies_contact_modes import BodiesContactModeAnswer
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
    from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer
    from contact_dynamics.replay.events import Answered, Events
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

Cell: TypeAlias = str | int | float | None
Cells: TypeAlias = dict[str, Cell]

STATE: Final = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")
"""The numbers of a state, as columns name them."""

_MAX_WAITING: Final = 10_000  # rows that wait for measurements; beyond, the oldest is yielded without

COLUMNS: Final[dict[str, type]] = {
    "log": str,
    "service": str,
    "number": int,
    "state": int,
    "log_time_ns": int,
    "request_ns": int,
    "body": str,
    "request": str,
    "status": str,
    "message": str,
    "computation_time": float,
    "state_stamp_ns": int,
    "states_fitted": int,
    "summary": str,
    "surface": str,
    **{f"contact_{axis}": float for axis in "xyz"},
    "mode_count": int,
    "margins": str,
    "contact_forces": str,
    "contact_accelerations": str,
    "predicted_ns": int,
    **{f"predicted_{name}": float for name in STATE},
    "measured_ns": int,
    **{f"measured_{name}": float for name in STATE},
    "position_error": float,
    "angle_error": float,
    "velocity_error": float,
    "spin_error": float,
}
"""The columns of a row and their types. Any cell can be empty.

If a question is about many states or candidates, ``state`` is the row's place among them, from 0. Times are
ns, ``computation_time`` is s. The state that the answer used is stamped ``state_stamp_ns``: the one that was
taken, or the newest of ``states_fitted``. Lengths are m, quaternions x, y, z, w with w >= 0, velocities m/s
and rad/s. The errors are the distance, m, the angle, rad, and the differences of the velocities, in the same
units.

``mode_count`` is the number of consistent modes, and ``margins`` is the margin of each of them, N, as JSON.
The contact forces on the body, N, and its accelerations at the contacts, m/s^2, both (modes, contacts, 3) in
world axes, are JSON too.
"""


@dataclass(slots=True, kw_only=True)
class _Waiting:
    row: dict[str, Cell]  # cells that all rows of the request share
    answered: Answered
    measuring: Measuring | None = None  # None if no outcome can be measured

    @property
    def weight(self) -> int:
        """Approximate number of rows."""
        return len(self.answered.answer) if isinstance(self.answered.answer, Sized) else 1


class Rows:
    """Makes rows of events. Only rows that wait for measurements are kept in memory."""

    def __init__(self, events: Events, *, log: str) -> None:
        """Read ``events`` of the recording named ``log``."""
        self._events = events
        self._world: World = events.world
        self._log = log
        self._newest: dict[str, BodyState] = {}
        self._waiting: deque[_Waiting] = deque()
        self._weight = 0
        self._monitored = 0

    def __iter__(self) -> Iterator[dict[str, Cell]]:
        """Yield the rows in the order of the requests."""
        for event in self._events:
            if isinstance(event, StateCame):
                for waiting in self._waiting:
                    if waiting.measuring is not None:
                        waiting.measuring.see(event.body_name, event.state)
                self._newest[event.body_name] = event.state
            elif isinstance(event, WorldChanged):
                self._world = event.world
            elif isinstance(event, Monitored):
                yield self._of_monitor(event)
            else:
                self._waiting.append(self._row(event))
                self._weight += self._waiting[-1].weight
            while self._waiting and (self._is_done(self._waiting[0]) or self._weight > _MAX_WAITING):
                self._weight -= self._waiting[0].weight
                yield from self._finished(self._waiting.popleft())
        for waiting in self._waiting:
            yield from self._finished(waiting)

    @staticmethod
    def _is_done(waiting: _Waiting) -> bool:
        return waiting.measuring is None or waiting.measuring.is_complete

    def _finished(self, waiting: _Waiting) -> Iterator[dict[str, Cell]]:
        row, answered, measuring = waiting.row, waiting.answered, waiting.measuring
        measured = None if measuring is None else measuring.result()
        if measuring is not None and measured is not None:
            row["measured_ns"] = measured.stamp_ns
            row |= self._cells("measured", measuring.body_name, measured)
            row |= _errors(measuring.predicted, measured)
        if answered.answer is None:
            yield row
            return
        cells_of = answered.service.cells
        if cells_of is None:
            yield row | {"summary": answered.service.in_words(answered.answer)[0]}
            return
        for cells in cells_of(answered.answer):
            yield row | cells
            row["request"] = None

    def _of_monitor(self, event: Monitored) -> dict[str, Cell]:
        self._monitored += 1
        return dict.fromkeys(COLUMNS) | {
            "log": self._log,
            "service": "monitor",
            "number": self._monitored,
            "log_time_ns": event.log_time_ns,
            "body": event.body_name,
            "summary": event.text,
            "surface": event.surface_name,
            "measured_ns": event.stamp_ns,
        }

    def _row(self, answered: Answered) -> _Waiting:
        row: dict[str, Cell] = dict.fromkeys(COLUMNS)
        body, states = answered.question.get("body_name", ""), answered.question.get("states")
        if isinstance(states, list):  # of several bodies
            body = ", ".join(str(state.get("body_name", "")) for state in states)
        row |= {
            "log": self._log,
            "service": answered.service_name,
            "number": answered.number,
            "log_time_ns": answered.log_time_ns,
            "request_ns": answered.asked_ns,
            "body": body if isinstance(body, str) else "",
            "request": json.dumps(dict(answered.question)),
            "status": answered.status,
            "message": answered.message,
            "computation_time": answered.computation_time,
        }
        answer = answered.answer
        if answer is None:
            return _Waiting(row=row, answered=answered)
        row["body"] = name = answer.body_name
        if hasattr(answer, "state"):
            fit = getattr(answer, "fit", None)
            row |= {
                "state_stamp_ns": answer.stamp_ns or None,
                "states_fitted": 0 if fit is None else fit.count,
            }
        predicted = answer.predicted_state
        if predicted is None:
            return _Waiting(row=row, answered=answered)
        row["predicted_ns"] = predicted.stamp_ns
        row |= self._cells("predicted", name, predicted)
        newest = self._newest.get(name)
        if predicted.stamp_ns == 0 or newest is None:
            return _Waiting(row=row, answered=answered)
        return _Waiting(
            row=row,
            answered=answered,
            measuring=Measuring(
                body=self._world.body(name),
                predicted=predicted,
                newest=newest,
                gravity_W=self._world.gravity_W,
                is_impact=answer.is_after_impact,
            ),
        )

    def _cells(self, kind: str, body_name: str, state: BodyState) -> dict[str, Cell]:
        offset = self._offset(body_name)
        numbers = [
            *origin_of_published_frame(state, offset).tolist(),
            *_with_positive_w(state.q_WB).tolist(),
            *state.v_WB_W.tolist(),
            *state.w_WB_W.tolist(),
        ]
        return {f"{kind}_{name}": number for name, number in zip(STATE, numbers, strict=True)}

    def _offset(self, body_name: str) -> FloatArray:
        known = [body.p_FB_F for body in self._world.bodies if body.name == body_name]
        return known[0] if known else np.zeros(3)


def _with_positive_w(q_WB: FloatArray) -> FloatArray:
    """Return the quaternions, (..., 4), with the sign that makes w positive, so that rows are comparable."""
    return np.where(q_WB[..., 3:] < 0.0, -q_WB, q_WB)


def _errors(predicted: BodyState, measured: BodyState) -> dict[str, Cell]:
    """Return the differences between measured and predicted values."""
    apart = np.linalg.norm(predicted.q_WB - measured.q_WB), np.linalg.norm(predicted.q_WB + measured.q_WB)
    return {
        "position_error": float(np.linalg.norm(predicted.p_WB_W - measured.p_WB_W)),
        "angle_error": 4.0 * math.asin(min(1.0, 0.5 * float(min(apart)))),
        "velocity_error": float(np.linalg.norm(predicted.v_WB_W - measured.v_WB_W)),
        "spin_error": float(np.linalg.norm(predicted.w_WB_W - measured.w_WB_W)),
    }


def cells_of_tumbling(answer: TumblingAnswer) -> Iterator[Cells]:
    """Yield the event that ends the flight."""
    event = answer.event
    summary, surface = ("flight", "") if event is None else (event.kind.name.lower(), event.surface)
    yield _cells(summary, [surface])


def cells_of_impact(answer: ImpactAnswer) -> Iterator[Cells]:
    """Yield the outcome of the impact, and the position of its first contact."""
    outcome = answer.impact.outcome
    summary = "several at once" if outcome is None else outcome.name.lower()
    place = zip("xyz", answer.contacts.p_WC_W[0].tolist(), strict=True)
    yield {**_cells(summary, answer.contacts.surfaces), **{f"contact_{axis}": x for axis, x in place}}


def cells_of_toss(answer: TossAnswer) -> Iterator[Cells]:
    """Yield the end of the toss, and the corners on which the body rests."""
    corners = " ".join(map(str, answer.toss.resting_corners))
    end = answer.toss.end.name.lower()
    surfaces = [name for event in answer.toss.events[-1:] for name in event.surfaces]
    yield _cells(f"{end} on {corners}" if corners else end, surfaces)


def cells_of_contact_modes(answer: ContactModeAnswer | BodiesContactModeAnswer) -> Iterator[Cells]:
    """Yield the verdict with its modes, and their distinguishing quantities."""
    modes, margins = answer.modes, getattr(answer, "margins", None)
    yield {
        **_cells(_verdict(answer.verdict, [mode.mode for mode in modes]), answer.contacts.surfaces),
        "mode_count": len(modes),
        "margins": None if margins is None else json.dumps([one.margin for one in margins]),
        "contact_forces": json.dumps([mode.contact_forces_W.tolist() for mode in modes]),
        "contact_accelerations": json.dumps([mode.contact_accelerations_W.tolist() for mode in modes]),
    }


def cells_of_tumblings(answer: ManyTumblingsAnswer) -> Iterator[Cells]:
    """Yield each state at the end of its flight."""
    return _of_states(answer, lambda _: "flight")


def cells_of_impacts(answer: ManyImpactsAnswer) -> Iterator[Cells]:
    """Yield the outcome of each impact, and the state after it."""

    def summary(i: int) -> str:
        return "separates" if answer.separates[i] else ImpactOutcome(int(answer.outcomes[i])).name.lower()

    return _of_states(answer, summary)


def cells_of_many_contact_modes(answer: ManyContactModesAnswer) -> Iterator[Cells]:
    """Yield the verdict on each candidate with its modes."""
    mode_ends, set_ends = np.cumsum(answer.mode_counts).tolist(), np.cumsum(answer.contact_counts).tolist()
    for i, verdict in enumerate(answer.verdicts.tolist()):
        of_modes = slice(mode_ends[i] - answer.mode_counts[i], mode_ends[i])
        modes = answer.modes[of_modes]
        k = i % len(set_ends)
        begin, end = set_ends[k] - answer.contact_counts[k], set_ends[k]
        yield {
            **_cells(_verdict(ModeVerdict(verdict), modes), answer.contacts.surfaces[begin:end]),
            "state": i,
            "mode_count": len(modes),
            "margins": None if answer.margins is None else json.dumps(answer.margins[of_modes].tolist()),
        }


def _cells(summary: str, surfaces: Iterable[str]) -> Cells:
    return {"summary": summary, "surface": ", ".join(dict.fromkeys(surfaces))}


def _verdict(verdict: ModeVerdict, modes: Sequence[str]) -> str:
    listed = ", ".join(f"{mode} ({mode_in_words(mode)})" for mode in modes)
    return f"{verdict.name.lower()}: {listed}" if modes else verdict.name.lower()


def _of_states(
    answer: ManyTumblingsAnswer | ManyImpactsAnswer, summary: Callable[[int], str]
) -> Iterator[Cells]:
    """Yield the cells of each state, without times, because such a request has none."""
    states = answer.states
    origins = origins_of_published_frame(states.p_WB_W, states.q_WB, answer.p_FB_F)
    numbers = np.concatenate([origins, _with_positive_w(states.q_WB), states.v_WB_W, states.w_WB_W], axis=1)
    for i, row in enumerate(numbers.tolist()):
        yield {
            "state": i,
            "summary": summary(i),
            **{f"predicted_{name}": number for name, number in zip(STATE, row, strict=True)},
        }


WITHIN: Final = 0.1
"""s. Largest age of a state from which the outcome is extrapolated."""

AFTER_IMPACT: Final = 0.05  # s. Span of the states after an impact to which the flight is fitted.

_AT_IMPACT: Final = 1
"""Number of states after an impact that are left out, since it may be a little later than predicted."""


class Measuring:
    """Collects the states of a body until the predicted outcome has been measured."""

    def __init__(
        self, *, body: Body, predicted: BodyState, newest: BodyState, gravity_W: FloatArray, is_impact: bool
    ) -> None:
        """Begin with a body's newest state; collect states until the stamp of the predicted one has passed.

        ``is_impact`` means that the predicted state follows an impact; otherwise it ends a flight.
        """
        self.body_name = body.name
        self.predicted = predicted
        self.is_complete = False
        self._body = body.mass_properties
        self._gravity_W = gravity_W
        self._is_impact = is_impact
        self._before = newest
        self._after: list[BodyState] = []

    def see(self, body_name: str, state: BodyState) -> None:
        """Process a published state of any body."""
        if body_name != self.body_name or self.is_complete:
            return
        if state.stamp_ns <= self.predicted.stamp_ns:
            self._before = state
            return
        until_ns = ns_after(self.predicted.stamp_ns, AFTER_IMPACT)
        if self._is_impact and state.stamp_ns <= until_ns:
            self._after.append(state)
        else:
            self.is_complete = True

    def result(self) -> BodyState | None:
        """Return the measured state, stamped with the predicted time, or None if there are too few states."""
        if not self.is_complete:
            return None
        try:
            state = self._before
            if self._is_impact:
                fitted = fit_free_motion(self._body, self._after[_AT_IMPACT:], gravity_W=self._gravity_W)
                if not (fitted.converged and fitted.turns_known):
                    return None
                state = fitted.state
            seconds = seconds_between(state.stamp_ns, self.predicted.stamp_ns)
            if abs(seconds) > WITHIN:
                return None
            return free_motion(self._body, state, gravity_W=self._gravity_W).state_at(seconds)
        except ContactDynamicsError:  # too few states, or not a flight
            return None
