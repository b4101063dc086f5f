# SPDX-License-Identifier: Apache-2.0
"""Converts requests about impacts to questions, and answers to responses and back.

Messages are new, unless ``into`` is an empty one that a response has already. A message costs more to build
than to fill.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.impact.in_time.sequence import MAX_STRIKES, STRIKE_WINDOW
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.several.result import (
    ResolvedImpact,
    SequenceEnd,
    SequenceStrike,
    SeveralContactsLaw,
)
from contact_dynamics.questions.context import Problem
from contact_dynamics.questions.impact_question import ImpactAnswer, ImpactQuestion, InTime
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rigid_body.published_frame import centers_of_mass, origin_of_published_frame
from contact_dynamics_interfaces.msg import Impact as ImpactMsg
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters import fields
from msg_adapters.asked_fields import (
    asked_contacts,
    asked_member,
    asked_other,
    asked_plane,
    asked_problem,
    asked_subject,
    optional,
)
from msg_adapters.contacts import flat, rows
from msg_adapters.rejected_fields import IMPACT, check_unread
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World

_NO_END: Final = ImpactMsg().sequence_end  # end of the sequence of an impact at one instant


def impact_question_from_msg(
    request: PredictImpact.Request, *, world: World, world_frame: str
) -> ImpactQuestion:
    """Return the question of a `PredictImpact` request; see `tumbling_question_from_msg`."""
    problem, law = asked_problem(request.problem), _several_contacts_law(request)
    body, state = asked_subject(request, world, world_frame, fit_window=request.fit_window)
    other, other_state = asked_other(request, world, world_frame)
    contacts = asked_contacts(request)
    check_unread(request, IMPACT)
    return ImpactQuestion(
        body=body,
        state=state,
        other=other,
        other_state=other_state,
        contacts=contacts,
        horizon=optional(request.horizon),
        restitution_law=asked_member("restitution_law", RestitutionLaw, request.restitution_law),
        several_contacts_law=law,
        include_orders=request.include_orders,
        include_covariance=request.include_covariance,
        problem=problem,
        plane=asked_plane(request.plane_normal),
        out_of_plane_tolerance=optional(request.out_of_plane_tolerance),
        velocity_tolerance=optional(request.velocity_tolerance),
        distance_tolerance=optional(request.distance_tolerance),
    )


def _several_contacts_law(request: PredictImpact.Request) -> SeveralContactsLaw | InTime:
    """Return the law for several contacts in a request, or raise `InvalidFieldError`."""
    value = request.several_contacts_law
    if value == request.SEQUENTIAL_IN_TIME:
        window = optional(request.strike_window)
        most = optional(request.max_strikes)
        return InTime(
            strike_window=STRIKE_WINDOW if window is None else window,
            max_strikes=MAX_STRIKES if most is None else most,
            hold_step=request.hold_step or None,
        )
    return asked_member("several_contacts_law", SeveralContactsLaw, value, "SEQUENTIAL_IN_TIME (2)")


def _write_law(msg: ImpactMsg, field: str, law: SeveralContactsLaw, _: fields.Frame) -> None:
    setattr(msg, field, int(law))


def _read_law(msg: ImpactMsg, field: str, _: fields.Frame) -> SeveralContactsLaw:
    in_time = len(msg.strike_times) > 0
    return SeveralContactsLaw.SEQUENTIAL if in_time else SeveralContactsLaw(getattr(msg, field))


def _write_states(msg: ImpactMsg, _: str, states: tuple[BodyState, ...], frame: fields.Frame) -> None:
    fields.STATE.write(msg, "state_after", states[0], frame)
    if isinstance(frame.answer, ImpactAnswer) and frame.answer.other is not None:
        struck = [replace(frame.answer.other, state=state) for state in states[1:]]
        msg.other_state_after = [fields.NAMED_STATE.to_msg(each, frame) for each in struck]


def _read_states(msg: ImpactMsg, _: str, frame: fields.Frame) -> tuple[BodyState, ...]:
    state: BodyState = fields.STATE.read(msg, "state_after", frame)  # type: ignore[assignment]
    return state, *(fields.NAMED_STATE.from_msg(each, frame).state for each in msg.other_state_after)


def _write_strikes(msg: ImpactMsg, _: str, strikes: tuple[SequenceStrike, ...], frame: fields.Frame) -> None:
    """Write strikes in time, which go with a law of their own."""
    if not strikes:
        return
    msg.several_contacts_law = PredictImpact.Request.SEQUENTIAL_IN_TIME
    msg.strike_times = [strike.seconds for strike in strikes]
    msg.strike_contacts = [strike.contact for strike in strikes]
    msg.strike_outcomes = [int(strike.outcome) for strike in strikes]
    msg.strike_positions = flat(np.array([strike.p_WC_W for strike in strikes]))
    msg.strike_impulses = flat(np.array([strike.impulse_W for strike in strikes]))
    before = [strike.state_before for strike in strikes]
    msg.strike_body_positions = flat(
        np.array([origin_of_published_frame(state, frame.p_FB_F) for state in before])
    )
    msg.strike_body_orientations = flat(np.array([state.q_WB for state in before]))
    msg.strike_velocities_before = flat(_twists(before))
    msg.strike_velocities_after = flat(_twists([strike.state_after for strike in strikes]))


def _read_strikes(msg: ImpactMsg, _: str, frame: fields.Frame) -> tuple[SequenceStrike, ...]:
    """Return strikes in time, if there are any. The last of them leads to the state after the impact."""
    orientations = rows(msg.strike_body_orientations, 4)
    places = centers_of_mass(rows(msg.strike_body_positions), orientations, frame.p_FB_F)
    last_ns = stamp_ns_from_msg(msg.state_after.header.stamp)
    strikes = []
    for i, (seconds, contact) in enumerate(zip(msg.strike_times, msg.strike_contacts, strict=True)):
        before, after = (
            BodyState(
                p_WB_W=places[i],
                q_WB=orientations[i],
                v_WB_W=twist[:3],
                w_WB_W=twist[3:],
                stamp_ns=ns_after(last_ns, seconds - msg.strike_times[-1]),
            )
            for twist in (rows(msg.strike_velocities_before, 6)[i], rows(msg.strike_velocities_after, 6)[i])
        )
        strikes.append(
            SequenceStrike(
                seconds=seconds,
                contact=contact,
                outcome=ImpactOutcome(msg.strike_outcomes[i]),
                p_WC_W=rows(msg.strike_positions)[i],
                impulse_W=rows(msg.strike_impulses)[i],
                state_before=before,
                state_after=after,
            )
        )
    return tuple(strikes)


def _twists(states: Sequence[BodyState]) -> FloatArray:
    return np.array([np.concatenate([state.v_WB_W, state.w_WB_W]) for state in states])


RESOLVED_IMPACT: Final = fields.Table(
    ResolvedImpact,
    ImpactMsg,
    fields.Row("restitution_law", "restitution_law", fields.one_of(RestitutionLaw)),
    fields.Row("several_contacts_law", "several_contacts_law", fields.Kind(_write_law, _read_law)),
    fields.Row("outcome", "outcome", fields.one_of(ImpactOutcome, none=ImpactMsg.NOT_TOLD)),
    fields.Row("jams", "jams"),
    fields.Row("converged", "converged"),
    fields.Row("states", "", fields.Kind(_write_states, _read_states)),
    fields.Row("impulses_W", "impulses", fields.rows_of(3)),
    fields.Row("compression_impulses_W", "compression_impulses", fields.rows_of(3)),
    fields.Row("velocities_before_W", "contact_velocities_before", fields.rows_of(3)),
    fields.Row("velocities_after_W", "contact_velocities_after", fields.rows_of(3)),
    fields.Row("path_W", "path", fields.rows_of(3)),
    fields.Row("path_events", "path_events", fields.some_of(PathEvent)),
    fields.Row("path_contacts", "path_contacts", fields.TUPLE),
    fields.Row("kinetic_energy_before", "kinetic_energy_before"),
    fields.Row("kinetic_energy_after", "kinetic_energy_after"),
    fields.Row("creates_energy", "creates_energy"),
    fields.Row(
        "orders",
        "orders",
        fields.Converted(
            lambda orders: [",".join(map(str, order)) for order in orders],
            lambda texts: tuple(tuple(int(i) for i in text.split(",") if i) for text in texts),
        ),
    ),
    fields.Row("order_velocities_W", "order_velocities", fields.rows_of(6)),
    fields.Row("orders_complete", "orders_complete"),
    fields.Row("orders_not_converged", "orders_not_converged"),
    fields.Row(
        "covariance",
        "state_after",
        fields.Kind(
            lambda msg, field, value, frame: fields.NUMBERS_OR_NONE.write(
                getattr(msg, field), "covariance", value, frame
            ),
            lambda msg, field, _: rows(found, 12) if len(found := getattr(msg, field).covariance) else None,
        ),
    ),
    fields.Row("outcome_probabilities", "outcome_probabilities", fields.NUMBERS_OR_NONE),
    fields.Row("miss_probability", "miss_probability"),
    fields.Row("strikes", "", fields.Kind(_write_strikes, _read_strikes)),
    fields.Row("end", "sequence_end", fields.one_of(SequenceEnd, none=_NO_END)),
    fields.Row("staying", "staying_contacts", fields.TUPLE),
    fields.Row("limit_seconds", "limit_time", fields.NUMBER_OR_NONE),
)
"""An impact of the body, and of a second one if there is one."""

_ANSWER: Final = fields.AnswerTable(
    ImpactAnswer,
    PredictImpact.Response,
    fields.Row("warnings", "message", fields.WARNINGS),
    fields.Row("state", "state_before", fields.STATE),
    fields.Row("fit", "", fields.FIT),
    fields.Row("other", "other_state_before", fields.NAMED_STATE.at_most_one()),
    fields.Row("seconds_to_contact", "time_to_contact"),
    fields.Row("contacts", "contacts", fields.CONTACTS),
    fields.Row("impact", "impact", RESOLVED_IMPACT.nested()),
    fields.Row("problem", "problem", fields.one_of(Problem)),
    fields.Row("plane", "plane_normal", fields.PLANE),
    fields.Row("out_of_plane", "out_of_plane"),
    fields.Row("velocity_tolerance", "velocity_tolerance"),
    fields.Row("distance_tolerance", "distance_tolerance"),
    body_name="state_before.body_name",
)
impact_answer_to_msg: Final = _ANSWER.response_of
impact_answer_from_msg: Final = _ANSWER.answer_of
