# SPDX-License-Identifier: Apache-2.0
"""Which velocities follow an impact? Routh's frictional rigid impact (lecture 27)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.velocities import relative_velocities
from contact_dynamics.errors import NORMAL_HINT, NoContactError, NotSupportedError, SeparatingContactError
from contact_dynamics.impact import (
    SequenceEnd,
    bodies_impact,
    impact_sequence,
    outcomes_over_orders,
    planar_impact,
    several_impact,
    spatial_impact,
    spatial_impact_distribution,
    spatial_pair_impact,
)
from contact_dynamics.impact.several.orders import order_warning, with_orders
from contact_dynamics.impact.several.result import SeveralContactsLaw, of_one_contact
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.motion.covariance import propagate_covariance
from contact_dynamics.plane.lifting import (
    check_mirrored,
    mirror_partners,
    planar_in_space,
)
from contact_dynamics.questions.context import Context, Problem, or_default
from contact_dynamics.questions.extent import check_contacts, check_extent
from contact_dynamics.questions.impact_question import ImpactAnswer, ImpactQuestion, InTime
from contact_dynamics.questions.plane_of_motion import (
    lifted_impact,
    planar_problem_of,
    several_in_plane,
)
from contact_dynamics.questions.subject import (
    NamedState,
    Subject,
    at_stamp,
    check_different,
    covariance_of,
    subject_of,
)
from contact_dynamics.questions.touching import (
    check_has_shape,
    contacts_of,
    friction_in_tosses,
    moves_into,
    outside_shape,
)
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState

if TYPE_CHECKING:
    from contact_dynamics.impact import ImpactDistribution, ImpactSequence, ResolvedImpact
    from contact_dynamics.plane.projection import PlanarProblem
    from contact_dynamics.rigid_body.body import MassProperties

    _InSpace: TypeAlias = tuple[MassProperties, BodyState, ContactSet]
    """A body, its state and its contacts, as the orders of strikes take them."""

SAMPLES: Final = 2000
"""Number of states that are drawn for an uncertain impact. They give probabilities to 0.011 and take some 20
ms, during which a server answers nobody else."""

_OPEN_AT_AN_INSTANT: Final = (
    "several contacts approach at the same instant, and rigid-body mechanics does not determine their order: "
    "the fastest approach is resolved first, and equal ones together"
)

_NO_WRENCH: Final = np.zeros(3)


def answer(question: ImpactQuestion, context: Context | None = None) -> ImpactAnswer:
    """Answer a question about an impact. Without ``context`` no body is known by name, and no surface.

    Raises:
        ContactDynamicsError: nothing strikes, or something is asked for that is not known, not allowed or not
            supported. The message names it.
    """
    known = Context() if context is None else context
    strike = _strike_of(question, known)
    problem: PlanarProblem | None = None
    resolved: ResolvedImpact
    warnings = (*(known.notes or ()), *_outside(question, strike), *_slower_friction(question, strike, known))
    law = question.several_contacts_law
    ordered = strike.subject.body.mass_properties, strike.state, strike.contacts
    if isinstance(law, InTime):
        sequence = _in_time(question, law, strike, known)
        strike = _from_first(sequence, strike)
        resolved = _since_first(sequence)
        if sequence.order_is_open:
            warnings += (_OPEN_AT_AN_INSTANT,)
    elif question.problem is Problem.PLANAR:
        problem = _problem(question, strike, known)
        if len(problem.contacts) > 1:
            ordered = planar_in_space(
                problem.body, problem.velocity, problem.contacts, axes_W=problem.plane.axes_W
            )
        resolved = _in_plane(question, law, strike, problem, ordered)
    else:  # AUTOMATIC goes here too, because space contains the plane
        resolved = _in_space(question, law, strike)
    if law is SeveralContactsLaw.SEQUENTIAL:
        warnings += _order_warning(question, strike, ordered)
    warnings += _into_the_world(strike, resolved, known)
    if question.include_orders:
        outcomes = outcomes_over_orders(
            *ordered,
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        resolved = with_orders(resolved, outcomes)
    if question.include_covariance:
        distribution = _distribution(question, strike, known)
        resolved = replace(
            resolved,
            covariance=distribution.covariance,
            outcome_probabilities=distribution.probabilities,
            miss_probability=distribution.missed,
        )
    body, other = strike.subject.body, strike.other
    return ImpactAnswer(
        body_name=body.name,
        p_FB_F=body.p_FB_F,
        state=strike.state,
        fit=strike.subject.fit,
        other=None
        if other is None
        else NamedState(name=other.body.name, p_FB_F=other.body.p_FB_F, state=other.state),
        seconds_to_contact=strike.seconds,
        contacts=strike.contacts,
        impact=resolved,
        problem=Problem.SPATIAL if problem is None else Problem.PLANAR,
        plane=None if problem is None else problem.plane,
        out_of_plane=math.nan if problem is None else problem.out_of_plane,
        velocity_tolerance=strike.velocity_tolerance,
        distance_tolerance=strike.distance_tolerance,
        warnings=warnings,
    )


def _outside(question: ImpactQuestion, strike: _Strike) -> tuple[str, ...]:
    """Return warnings of stated contacts that are outside of the shape of a body."""
    subjects = (strike.subject, strike.other) if question.contacts is not None else ()
    return tuple(
        text
        for subject in subjects
        if subject is not None
        for text in outside_shape(
            subject.body,
            points_W=strike.contacts.p_WC_W,
            p_WB_W=subject.state.p_WB_W,
            R_WB=subject.state.R_WB,
            distance_tolerance=strike.distance_tolerance,
        )
    )


def _slower_friction(question: ImpactQuestion, strike: _Strike, context: Context) -> tuple[str, ...]:
    """Return warnings of contacts that approach so slowly that they have another friction in tosses."""
    if question.contacts is not None:
        return ()
    velocities = relative_velocities(strike.state, strike.contacts)
    speeds = -np.einsum("ij,ij->i", velocities, strike.contacts.normals_W)
    strikes = [speed if speed > strike.velocity_tolerance else None for speed in speeds.tolist()]
    return friction_in_tosses(context.world, strike.contacts, strikes)


def _into_the_world(strike: _Strike, resolved: ResolvedImpact, context: Context) -> tuple[str, ...]:
    """Return warnings of bodies that move into a surface where the impact had no contacts."""
    world = context.world.after(strike.seconds) if strike.seconds > 0.0 else context.world
    return tuple(
        text
        for subject, state in zip((strike.subject, strike.other), resolved.states, strict=False)
        if subject is not None
        for text in moves_into(
            subject.body,
            state,
            world,
            distance_tolerance=strike.distance_tolerance,
            velocity_tolerance=strike.velocity_tolerance,
        )
    )


def _order_warning(question: ImpactQuestion, strike: _Strike, ordered: _InSpace) -> tuple[str, ...]:
    """Return a warning where the order of strikes decides the answer, with the difference that it makes."""
    body, state, contacts = ordered
    if len(contacts) == 1:
        return ()
    bodies, states, pair = [body], [state], None
    if strike.other is not None:
        bodies.append(strike.other.body.mass_properties)
        states.append(strike.other.state)
        pair = 1
    words = order_warning(
        bodies,
        states,
        contacts,
        [(0, pair)] * len(contacts),
        restitution_law=question.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    return (words,) if words else ()


def _in_time(question: ImpactQuestion, law: InTime, strike: _Strike, context: Context) -> ImpactSequence:
    """Return the strikes from a state on. Without any, raise `SeparatingContactError` or `NoContactError`."""
    world = context.world.after(strike.seconds)
    sequence = impact_sequence(
        strike.subject.body,
        strike.state,
        world,
        contacts=None if question.contacts is None else strike.contacts,
        restitution_law=question.restitution_law,
        window=law.strike_window,
        max_strikes=law.max_strikes,
        distance_tolerance=strike.distance_tolerance,
        velocity_tolerance=strike.velocity_tolerance,
        hold_step=law.hold_step,
    )
    if not sequence.strikes and sequence.end == SequenceEnd.STAYS:
        raise NoContactError(
            "contacts: at least one must approach, got one that stays closed (compute its contact mode, or "
            "set hold_step to continue)"
        )
    if not sequence.strikes:
        allowed = f"one that approaches or comes back within the strike_window of {law.strike_window:g} s"
        if question.contacts is not None:
            velocities = relative_velocities(strike.state, strike.contacts)
            speeds = np.einsum("ij,ij->i", velocities, strike.contacts.normals_W)
            if (speeds > strike.velocity_tolerance).any():
                allowed += f" ({NORMAL_HINT})"
        raise SeparatingContactError("contacts", "none that strikes", allowed)
    return sequence


def _from_first(sequence: ImpactSequence, strike: _Strike) -> _Strike:
    """Return the impact that begins with the first of several strikes, with the contacts of all of them."""
    first = sequence.strikes[0]
    return replace(
        strike, seconds=strike.seconds + first.seconds, state=first.state_before, contacts=sequence.contacts
    )


def _since_first(sequence: ImpactSequence) -> ImpactSequence:
    """Return a sequence whose times are those since its first strike."""
    first = sequence.strikes[0].seconds
    limit = sequence.limit_seconds
    return replace(
        sequence,
        strikes=tuple(replace(one, seconds=one.seconds - first) for one in sequence.strikes),
        limit_seconds=None if limit is None else limit - first,
    )


def _in_space(question: ImpactQuestion, law: SeveralContactsLaw, strike: _Strike) -> ResolvedImpact:
    contacts, (bodies, states) = strike.contacts, strike.before
    if len(contacts) == 1:
        hit = partial(spatial_impact, bodies[0], states[0])
        if len(bodies) > 1:
            hit = partial(spatial_pair_impact, bodies[0], states[0], bodies[1], states[1])
        impact = hit(
            contacts[0],
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        return of_one_contact(impact, bodies, states)
    return bodies_impact(
        bodies,
        states,
        contacts,
        [(0, None if len(bodies) == 1 else 1)] * len(contacts),
        several_contacts_law=law,
        restitution_law=question.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )


def _problem(question: ImpactQuestion, strike: _Strike, context: Context) -> PlanarProblem:
    """Return the problem in its plane of motion. Refuse contacts beside it that have no mirror image."""
    problem = planar_problem_of(
        strike.subject.body.mass_properties,
        strike.state,
        strike.contacts,
        plane=question.plane,
        force_W=_NO_WRENCH,
        torque_W=_NO_WRENCH,
        speed_tolerance=or_default(question.out_of_plane_tolerance, context.defaults.out_of_plane_tolerance),
    )
    if len(problem.contacts) > 1:
        partners = mirror_partners(
            problem.plane, strike.state, strike.contacts, distance_tolerance=strike.distance_tolerance
        )
        check_mirrored(problem.plane, strike.state, strike.contacts, partners)
    return problem


def _in_plane(
    question: ImpactQuestion,
    law: SeveralContactsLaw,
    strike: _Strike,
    problem: PlanarProblem,
    ordered: _InSpace,
) -> ResolvedImpact:
    body = strike.subject.body.mass_properties
    if len(problem.contacts) == 1:
        impact = planar_impact(
            problem.body,
            problem.velocity,
            problem.contacts[0],
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        return of_one_contact(lifted_impact(impact, problem, strike.state), [body], [strike.state])
    several = several_impact(
        *ordered,
        several_contacts_law=law,
        restitution_law=question.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    return several_in_plane(several, problem, body, strike.state)


def _distribution(question: ImpactQuestion, strike: _Strike, context: Context) -> ImpactDistribution:
    """Return the distribution of the state after the impact, from the covariance of the state before."""
    covariance = covariance_of(strike.subject)
    body = strike.subject.body.mass_properties
    if strike.seconds > 0.0:
        flight = propagate_covariance(
            body,
            strike.subject.state,
            covariance,
            [strike.seconds],
            gravity_W=context.world.gravity_W,
        )
        covariance = flight.covariances[0]
    return spatial_impact_distribution(
        body,
        strike.state,
        strike.contacts[0],
        covariance=covariance,
        restitution_law=question.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
        samples=SAMPLES,
    )


_kept_landing = lru_cache(maxsize=4)(next_landing)
"""`next_landing`, for the several questions about one landing, each with another law."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class _Strike(Record):
    """An impact before its resolution."""

    subject: Subject  # the first body, in the question's state
    other: Subject | None  # the second body, or None if the world is struck
    seconds: float  # the time from that state to the impact, s
    state: BodyState  # the first body just before
    contacts: ContactSet  # the contacts at which it strikes
    velocity_tolerance: float  # m/s. A slower approach counts as none.
    distance_tolerance: float  # m. A body with a smaller gap touches.

    @property
    def before(self) -> tuple[list[MassProperties], list[BodyState]]:
        """The bodies, one or both, and their states just before."""
        bodies, states = [self.subject.body.mass_properties], [self.state]
        if self.other is not None:
            bodies.append(self.other.body.mass_properties)
            states.append(self.other.state)
        return bodies, states


def _strike_of(question: ImpactQuestion, context: Context) -> _Strike:
    """Return the impact that a question means, at the contacts that it states or at the next landing.

    Raises:
        ContactDynamicsError: nothing strikes, or a part of the question is not known or not supported.
    """
    subject = subject_of(question.body, question.state, context)
    other = None
    if question.other is not None:
        check_different((question.body, question.other), (question.state, question.other_state))
        source = at_stamp(question.other_state, subject.state.stamp_ns)
        other = subject_of(question.other, source, context)
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
    return _Strike(
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
        raise NotSupportedError(
            "with a second body (other), problem must be SPATIAL or AUTOMATIC, several_contacts_law "
            "SEQUENTIAL or SIMULTANEOUS, and include_orders false"
        )
    if in_time and is_planar:
        raise NotSupportedError("problem must be SPATIAL or AUTOMATIC for impacts over time, got PLANAR")
    if in_time and question.include_orders:
        message = "include_orders must be false for impacts over time, got true (their order is that of time)"
        raise NotSupportedError(message)
    one_contact = contact_count == 1 and not is_planar and not in_time
    if question.include_covariance and (has_other or not one_contact):
        raise NotSupportedError(
            "include_covariance must be false unless a spatial problem has one contact with the world, and "
            f"for impacts over time, got true for {contact_count} contacts"
        )


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
