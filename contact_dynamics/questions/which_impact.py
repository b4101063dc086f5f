# SPDX-License-Identifier: Apache-2.0
"""Finds the impact that a question is about: the bodies, their states just before, and the contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.errors import NoContactError, NotSupportedError
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.questions.context import Context, or_default
from contact_dynamics.questions.extent import check_contacts, check_extent
from contact_dynamics.questions.impact_question import ImpactQuestion, InTime
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.resolved_impact import Before
from contact_dynamics.questions.subject import Subject, subject_of
from contact_dynamics.questions.touching import check_has_shape, contacts_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState

_kept_landing = lru_cache(maxsize=4)(next_landing)
"""`next_landing`, for the several questions about one landing, each with another law."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Strike(Record):
    """An impact that is to be resolved.

    Attributes:
        subject: The first body, in the question's state.
        other: The second body, or None for the world.
        seconds: The time from that state to the impact, s.
        state: The first body just before.
        contacts: The contacts at which it strikes.
        velocity_tolerance: m/s. A slower approach counts as none.
        distance_tolerance: m. A body with a smaller gap touches.
    """

    subject: Subject
    other: Subject | None
    seconds: float
    state: BodyState
    contacts: ContactSet
    velocity_tolerance: float
    distance_tolerance: float

    @property
    def before(self) -> Before:
        """The first body just before."""
        return Before(body=self.subject.body.mass_properties, state=self.state)


def strike_of(question: ImpactQuestion, context: Context) -> Strike:
    """Return the impact that a question means, at the contacts that it states or at the next landing.

    Raises:
        ContactDynamicsError: nothing strikes, or a part of the question is not known or not supported.
    """
    subject = subject_of(question.body, question.state, context)
    other = None if question.other is None else subject_of(question.other, question.other_state, context)
    for one in (subject, other):
        if one is not None:
            check_extent(one.body.mass_properties, one.state)
    velocity_tolerance = or_default(question.velocity_tolerance, context.defaults.velocity_tolerance)
    distance_tolerance = or_default(question.distance_tolerance, context.defaults.distance_tolerance)
    seconds, state = 0.0, subject.state
    if question.contacts is not None:
        contacts = contacts_of(
            question.contacts, subject, context.world, distance_tolerance=distance_tolerance
        )
        _ = contacts.impact_restitutions
    elif other is not None:
        message = "contacts of two bodies must be given explicitly: only those with the world are found"
        raise NotSupportedError(message)
    else:
        seconds, state, contacts = _landing(
            question,
            subject,
            context,
            velocity_tolerance=velocity_tolerance,
            distance_tolerance=distance_tolerance,
        )
    check_contacts(contacts)
    _check_supported(question, contact_count=len(contacts))
    return Strike(
        subject=subject,
        other=other,
        seconds=seconds,
        state=state,
        contacts=contacts,
        velocity_tolerance=velocity_tolerance,
        distance_tolerance=distance_tolerance,
    )


def _check_supported(question: ImpactQuestion, *, contact_count: int) -> None:
    """Raise `NotSupportedError` for combinations that a question can ask for and no law here answers."""
    in_time = isinstance(question.several_contacts_law, InTime)
    is_planar, has_other = question.problem is Problem.PLANAR, question.other is not None
    if has_other and (question.include_orders or is_planar or in_time):
        message = (
            "with a second body (other), problem must be SPATIAL or AUTOMATIC, several_contacts_law "
            "SEQUENTIAL or SIMULTANEOUS, and include_orders false"
        )
        raise NotSupportedError(message)
    if in_time and is_planar:
        message = "problem must be SPATIAL for strikes in time, got PLANAR: space contains the plane"
        raise NotSupportedError(message)
    if in_time and question.include_orders:
        message = "include_orders must be false for strikes in time, got true: time is the order"
        raise NotSupportedError(message)
    one_contact = contact_count == 1 and not is_planar and not in_time
    if question.include_covariance and (has_other or not one_contact):
        message = (
            "include_covariance must be false except at one contact with the world in space, and without "
            f"strikes in time, got true for {contact_count} contacts"
        )
        raise NotSupportedError(message)


def _landing(
    question: ImpactQuestion,
    subject: Subject,
    context: Context,
    *,
    velocity_tolerance: float,
    distance_tolerance: float,
) -> tuple[float, BodyState, ContactSet]:
    """Return when a body lands, s after its state, its state then, and its contacts."""
    check_has_shape(subject.body)
    horizon = or_default(question.horizon, context.defaults.horizon)
    landing = _kept_landing(
        subject.body,
        subject.state,
        context.world,
        horizon=horizon,
        distance_tolerance=distance_tolerance,
        velocity_tolerance=velocity_tolerance,
    )
    name = subject.body.name
    if landing is None:
        raise NoContactError(f"contacts: {name!r} touches no surface within the horizon of {horizon:g} s")
    in_time = isinstance(question.several_contacts_law, InTime)
    if not landing.strikes and not in_time:  # in time, another corner may strike while this one rests
        raise NoContactError(
            f"contacts: {name!r} touches {landing.contacts.surfaces[0]!r} and does not approach it by more "
            f"than {velocity_tolerance:g} m/s (a question about contact modes says what follows)"
        )
    return landing.seconds, landing.state, landing.contacts
