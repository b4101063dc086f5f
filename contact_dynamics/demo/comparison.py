# SPDX-License-Identifier: Apache-2.0
"""The demo's table of predictions and subsequent measurements."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.diagrams.words import OUTCOMES
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.rotations.many import rotation_vectors
from msg_adapters.geometry import vector_from_msg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.demo.questioner import Asked, Questioner
    from contact_dynamics.measured.flights import Strike
    from contact_dynamics.measured.recorded_toss import Toss
    from contact_dynamics.validation import FloatArray

SAME_STRIKE: Final = 0.03  # s, largest difference in time between a predicted strike and its measurement

_AVERAGED: Final = 12  # frames at the beginning and end of the rest whose mean positions are compared

_UNKNOWN: Final = "no clean strike"

Row: TypeAlias = tuple[str, str, str, str]
"""A line of the table: the quantity, its predicted and measured values, and their difference."""


class Section(NamedTuple):
    """A request, and the rows of its response."""

    time: float  # time of the request, s, on the recording's clock
    title: str
    rows: list[Row]


def sections(toss: Toss, strikes: Sequence[Strike], questioner: Questioner) -> list[Section]:
    """Return the requests in the order of time."""
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
        for quantity, predicted, measured, difference in section.rows:
            print(f"  {quantity:32}{predicted:>27}{measured:>27}{difference:>16}")
    print(
        f"\nThe states that were published carry noise: {1e3 * toss.velocity_noise:.0f} mm/s and "
        f"{toss.angular_velocity_noise:.2f} rad/s in each component of their velocities.\n"
        f"They were on their way for at most {1e3 * questioner.latest:.0f} ms."
    )


def _strike_at(strikes: Sequence[Strike], time: float) -> Strike | None:
    near = [strike for strike in strikes if abs(strike.time - time) < SAME_STRIKE]
    return min(near, key=lambda strike: abs(strike.time - time), default=None)


def _flight_section(asked: Asked, strikes: Sequence[Strike], questioner: Questioner) -> Section:
    response = asked.response
    landing = questioner.seconds_of(response.state.header.stamp) + response.event_time
    title = f"in flight, {landing - asked.time:.2f} s before landing: where will it be? {_answered(asked)}"
    strike = _strike_at(strikes, landing)
    if strike is None:
        return Section(asked.time, title, [("time of landing, s", f"{landing:.4f}", _UNKNOWN, "")])
    state = strike.before.state
    position = np.array(response.trajectory.positions[-3:])
    turn = rotation_vectors(np.array(response.trajectory.orientations[-4:])[None], state.q_WB)[0]
    late, off = 1e3 * (landing - strike.time), 1e3 * _length(position - state.p_WB_W)
    rows = [
        ("time of landing, s", f"{landing:.4f}", f"{strike.time:.4f}", f"{late:+.1f} ms"),
        ("position then, m", _vector(position), _vector(state.p_WB_W), f"{off:.1f} mm"),
        ("attitude then", "", "", f"{math.degrees(_length(turn)):.1f} deg"),
    ]
    return Section(asked.time, title, rows)


def _impact_section(asked: Asked, strikes: Sequence[Strike], questioner: Questioner) -> Section:
    response = asked.response
    if response.status != response.OK:
        return Section(asked.time, f"what after the impact? {response.message}", [])
    time = questioner.seconds_of(response.state_before.header.stamp)
    title = f"{1e3 * (time - asked.time):.0f} ms before landing: what after the impact? {_answered(asked)}"
    after, strike = response.impact.state_after, _strike_at(strikes, time)
    v, w = vector_from_msg(after.linear_velocity), vector_from_msg(after.angular_velocity)
    outcome = OUTCOMES[ImpactOutcome(response.impact.outcome)]
    measured_v = measured_w = (_UNKNOWN, "")
    if strike is not None:
        before, measured = strike.before.state, strike.after.state
        measured_v = _measured(v, before.v_WB_W, measured.v_WB_W)
        measured_w = _measured(w, before.w_WB_W, measured.w_WB_W)
    rows = [
        ("velocity after, m/s", _vector(v), *measured_v),
        ("spin after, rad/s", _vector(w), *measured_w),
        ("the contact", outcome, "", ""),
    ]
    return Section(asked.time, title, rows)


def _measured(predicted: FloatArray, before: FloatArray, after: FloatArray) -> tuple[str, str]:
    """Return the measured value, and the error of the prediction with the measured change."""
    return _vector(after), f"{_length(predicted - after):.2f} of {_length(after - before):.2f}"


def _mode_section(asked: Asked, toss: Toss) -> Section:
    response, title = asked.response, "it rests, or nearly: which contact mode?"
    if response.status != response.OK:
        return Section(asked.time, f"{title} {response.message}", [])
    modes = " or ".join(mode.mode for mode in response.modes) or "none"
    verdict = ModeVerdict(response.verdict).name.lower()
    later = toss.p_WB_W[toss.times > asked.time]
    few = max(1, min(_AVERAGED, len(later) // 2))
    moved = _length(later[-few:].mean(axis=0) - later[:few].mean(axis=0)) if len(later) else 0.0
    row = (
        f"modes of {len(response.contacts.frictions)} contacts",
        f"{modes} ({verdict})",
        f"moved {1e3 * moved:.1f} mm",
        f"in {toss.times[-1] - asked.time:.2f} s",
    )
    return Section(asked.time, f"{title} {_answered(asked)}", [row])


def _answered(asked: Asked) -> str:
    return f"[answered in {1e3 * asked.round_trip:.1f} ms]"


def _length(vector: FloatArray) -> float:
    return float(np.linalg.norm(vector))


def _vector(vector: FloatArray) -> str:
    return " ".join(f"{number:8.3f}" for number in vector)
