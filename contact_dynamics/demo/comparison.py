# SPDX-License-Identifier: Apache-2.0
"""The demo's table of predictions beside what was then measured."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.demo.questioner import LAST_MOMENT
from contact_dynamics.motion.velocity_estimate import WINDOW
from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics_interfaces.msg import Impact
from msg_adapters.geometry import vector_from_msg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.demo.questioner import Asked, Questioner
    from contact_dynamics.measured.flights import Strike
    from contact_dynamics.measured.recorded_toss import Toss
    from contact_dynamics.validation import FloatArray

SAME_STRIKE: Final = 0.03
"""s. A predicted strike and a measured one that are closer than this are the same."""

ENOUGH_FLIGHT: Final = 2.0 * WINDOW + LAST_MOMENT
"""s. A landing after so much flight can be predicted: velocities look back over one window, and another one
passes until the bounce is out of it. Shorter flights are left out without a word."""

_AVERAGED: Final = 12  # number of frames at each end of the rest, whose means show whether the body moved

_OUTCOMES: Final = {
    getattr(Impact, name): name.lower().replace("_", " ")
    for name in (
        "NO_IMPULSE",
        "SLIDES",
        "STICKS_IN_COMPRESSION",
        "STICKS_IN_RESTITUTION",
        "REVERSES_IN_COMPRESSION",
        "REVERSES_IN_RESTITUTION",
        "STICKS_THROUGHOUT",
    )
}
_VERDICTS: Final = ("unique", "indeterminate", "inconsistent", "impact")


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A line of the table, as text."""

    quantity: str
    predicted: str
    measured: str
    difference: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A question, and the rows of its answer.

    Attributes:
        time: When it was asked, s, on the recording's clock.
    """

    time: float
    title: str
    rows: list[Row]


def sections(toss: Toss, strikes: Sequence[Strike], questioner: Questioner) -> list[Section]:
    """Return the questions in the order of time."""
    found = [
        *(_flight_section(asked, strikes, questioner) for asked in questioner.flights),
        *(_impact_section(asked, strikes, questioner) for asked in questioner.impacts),
        *(_mode_section(asked, toss) for asked in questioner.modes),
    ]
    return sorted(found, key=lambda section: section.time)


def print_table(toss: Toss, strikes: Sequence[Strike], questioner: Questioner) -> None:
    """Print the table."""
    print(f"\n{'':34}{'predicted':>27}{'measured':>27}{'difference':>16}")
    for section in sections(toss, strikes, questioner):
        print(f"\nt = {section.time:.3f} s, {section.title}")
        for row in section.rows:
            print(f"  {row.quantity:32}{row.predicted:>27}{row.measured:>27}{row.difference:>16}")
    if missed := not_asked(strikes, [asked.time for asked in questioner.flights]):
        times = ", ".join(f"{time:.3f} s" for time in missed)
        print(f"\nNot asked in time, so not in the table: the landing at t = {times}. The machine was busy.")
    print(
        f"\nThe states that were published carry noise: {1e3 * toss.velocity_noise:.0f} mm/s and "
        f"{toss.angular_velocity_noise:.2f} rad/s in each component of their velocities.\n"
        f"They were on their way for at most {1e3 * questioner.latest:.0f} ms."
    )


def not_asked(strikes: Sequence[Strike], times: list[float]) -> list[float]:
    """Return when the body landed after enough flight, s, although nobody asked during that flight.

    Args:
        strikes: the measured strikes.
        times: when somebody asked where the body will be, s.
    """
    times_of_strikes = [0.0, *(strike.time for strike in strikes)]
    return [
        landing
        for start, landing in pairwise(times_of_strikes)
        if landing - start >= ENOUGH_FLIGHT and not any(start <= time < landing for time in times)
    ]


def _strike_at(strikes: Sequence[Strike], time: float) -> Strike | None:
    near = [strike for strike in strikes if abs(strike.time - time) < SAME_STRIKE]
    return min(near, key=lambda strike: abs(strike.time - time), default=None)


def _flight_section(asked: Asked, strikes: Sequence[Strike], questioner: Questioner) -> Section:
    response = asked.response
    landing = questioner.seconds_of(response.state.header.stamp) + response.event_time
    return Section(
        time=asked.time,
        title=f"in flight, {landing - asked.time:.2f} s before landing: where will it be? {_answered(asked)}",
        rows=_landing_rows(response, landing, _strike_at(strikes, landing)),
    )


def _impact_section(asked: Asked, strikes: Sequence[Strike], questioner: Questioner) -> Section:
    response = asked.response
    if response.status != response.OK:
        return Section(time=asked.time, title=f"what after the impact? {response.message}", rows=[])
    strike = questioner.seconds_of(response.state_before.header.stamp)
    before = 1e3 * (strike - asked.time)
    return Section(
        time=asked.time,
        title=f"{before:.0f} ms before landing: what after the impact? {_answered(asked)}",
        rows=_impact_rows(response, _strike_at(strikes, strike)),
    )


def _mode_section(asked: Asked, toss: Toss) -> Section:
    response = asked.response
    if response.status != response.OK:
        return Section(
            time=asked.time, title=f"it rests, or nearly: which contact mode? {response.message}", rows=[]
        )
    title = f"it rests, or nearly: which contact mode? {_answered(asked)}"
    return Section(time=asked.time, title=title, rows=_mode_rows(asked, toss))


def _answered(asked: Asked) -> str:
    return f"[answered in {1e3 * asked.round_trip:.1f} ms]"


def _landing_rows(response: Any, landing: float, strike: Strike | None) -> list[Row]:
    position = np.array(response.trajectory.positions[-3:])
    rows = [
        Row(
            quantity="time of landing, s",
            predicted=f"{landing:.4f}",
            measured="no clean strike",
            difference="",
        )
    ]
    if strike is None:
        return rows
    state = strike.before.state
    turn = rotation_vectors(np.array(response.trajectory.orientations[-4:])[None], state.q_WB)[0]
    return [
        Row(
            quantity="time of landing, s",
            predicted=f"{landing:.4f}",
            measured=f"{strike.time:.4f}",
            difference=f"{1e3 * (landing - strike.time):+.1f} ms",
        ),
        Row(
            quantity="position then, m",
            predicted=_vector(position),
            measured=_vector(state.p_WB_W),
            difference=f"{1e3 * float(np.linalg.norm(position - state.p_WB_W)):.1f} mm",
        ),
        Row(
            quantity="attitude then",
            predicted="",
            measured="",
            difference=f"{math.degrees(float(np.linalg.norm(turn))):.1f} deg",
        ),
    ]


def _impact_rows(response: Any, strike: Strike | None) -> list[Row]:
    after = response.impact.state_after
    v, w = vector_from_msg(after.linear_velocity), vector_from_msg(after.angular_velocity)
    outcome = _OUTCOMES[response.impact.outcome]
    if strike is None:
        return [
            Row(
                quantity="velocity after, m/s",
                predicted=_vector(v),
                measured="no clean strike",
                difference="",
            ),
            Row(
                quantity="spin after, rad/s", predicted=_vector(w), measured="no clean strike", difference=""
            ),
            Row(quantity="the contact", predicted=outcome, measured="", difference=""),
        ]
    measured = strike.after.state
    jump_v = float(np.linalg.norm(measured.v_WB_W - strike.before.state.v_WB_W))
    jump_w = float(np.linalg.norm(measured.w_WB_W - strike.before.state.w_WB_W))
    return [
        _after("velocity after, m/s", v, measured.v_WB_W, jump_v),
        _after("spin after, rad/s", w, measured.w_WB_W, jump_w),
        Row(quantity="the contact", predicted=outcome, measured="", difference=""),
    ]


def _after(quantity: str, predicted: FloatArray, measured: FloatArray, jump: float) -> Row:
    error = float(np.linalg.norm(predicted - measured))
    return Row(
        quantity=quantity,
        predicted=_vector(predicted),
        measured=_vector(measured),
        difference=f"{error:.2f} of {jump:.2f}",
    )


def _mode_rows(asked: Asked, toss: Toss) -> list[Row]:
    response = asked.response
    modes = " or ".join(mode.mode for mode in response.modes) or "none"
    later = toss.p_WB_W[toss.times > asked.time]
    few = max(1, min(_AVERAGED, len(later) // 2))
    moved = float(np.linalg.norm(later[-few:].mean(axis=0) - later[:few].mean(axis=0))) if len(later) else 0.0
    return [
        Row(
            quantity=f"modes of {len(response.contacts.frictions)} contacts",
            predicted=f"{modes} ({_VERDICTS[response.verdict]})",
            measured=f"moved {1e3 * moved:.1f} mm",
            difference=f"in {toss.times[-1] - asked.time:.2f} s",
        )
    ]


def _vector(vector: FloatArray) -> str:
    return " ".join(f"{number:8.3f}" for number in vector)
