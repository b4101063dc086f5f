"""One prediction beside what was measured: the row of every table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact_dynamics.evaluation.found_event import EventKind
from contact_dynamics.evaluation.settings import Law, Method
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Comparison(Record):
    """One question about one event, and how far its answer was from what came.

    Attributes:
        event: Number of the event in its recording, from 0.
        kind: What happened.
        body: The body's name.
        surface: The surface's name; empty for a flight.
        time: When the event was, s after the recording's first state.
        horizon: How long before it was asked, s.
        method: What the prediction was made from.
        law: The law of the impact. It is None where no impact was asked about.
        refused: Why there was no answer. It is empty if there was one.
        time_error: s, predicted less measured.
        position_error: m, distance of the centre of mass from where it was.
        attitude_error: rad, angle to the attitude that it had.
        velocity_error: m/s, size of the difference of linear velocities.
        spin_error: rad/s, size of the difference of angular velocities.
        predicted_mode: All consistent modes, or the verdict where there is none.
        measured_mode: The letters of the measured contacts.
        mode_is_right: Whether a consistent mode does what was measured: rest or slide.
        distance: How far the answer is off in standard deviations (Mahalanobis), by its own covariance and
            that of the measurement.
        degrees: Number of components that ``distance`` is over.
        predicted: (13,), position, quaternion, linear and angular velocity as predicted.
    """

    event: int
    kind: EventKind
    body: str
    surface: str
    time: float
    horizon: float
    method: Method
    law: Law | None = None
    refused: str = ""
    time_error: float | None = None
    position_error: float | None = None
    attitude_error: float | None = None
    velocity_error: float | None = None
    spin_error: float | None = None
    predicted_mode: str = ""
    measured_mode: str = ""
    mode_is_right: bool | None = None
    distance: float | None = None
    degrees: int = 0
    predicted: FloatArray | None = None
