# SPDX-License-Identifier: Apache-2.0
"""Which velocities follow an impact? Routh's frictional rigid impact (lecture 27)."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.errors import NORMAL_HINT, NoContactError, SeparatingContactError
from contact_dynamics.impact import (
    SequenceEnd,
    bodies_impact,
    impact_sequence,
    impact_sequence_of,
    outcomes_over_orders,
    planar_impact,
    several_impact,
    spatial_impact,
    spatial_impact_distribution,
    spatial_pair_impact,
)
from contact_dynamics.impact.several.orders import order_warning
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.motion.covariance import propagate_covariance
from contact_dynamics.plane.lifting import (
    check_mirrored,
    mirror_partners,
    planar_in_space,
    planar_velocity,
    with_planar_velocity,
)
from contact_dynamics.questions.context import Context, or_default
from contact_dynamics.questions.impact_answer import ImpactAnswer, StruckBody
from contact_dynamics.questions.impact_question import ImpactQuestion, InTime
from contact_dynamics.questions.problem import Problem, planar_problem_of
from contact_dynamics.questions.resolved_impact import Before, ResolvedImpact
from contact_dynamics.questions.resolving import (
    planar_resolved,
    sequence_resolved,
    several_resolved,
    spatial_resolved,
    with_distribution,
    with_orders,
)
from contact_dynamics.questions.subject import Subject, covariance_of
from contact_dynamics.questions.touching import outside_shape
from contact_dynamics.questions.which_impact import Strike, strike_of
from contact_dynamics.rigid_body.body import BodyState

if TYPE_CHECKING:
    from contact_dynamics.impact import ImpactDistribution, ImpactSequence, OrderedOutcomes
    from contact_dynamics.plane.projection import PlanarProblem
    from contact_dynamics.rigid_body.body import MassProperties

SAMPLES: Final = 2000
"""Number of states that are drawn for an uncertain impact. They give probabilities to 0.011 and take some 20
ms, during which a server answers nobody else."""

_OPEN_AT_AN_INSTANT: Final = (
    "contacts approach at one instant, and their order is open: the fastest strikes first, and those that "
    "tie strike as one"
)

_NO_WRENCH: Final = np.zeros(3)


def answer(question: ImpactQuestion, context: Context | None = None) -> ImpactAnswer:
    """Answer a question about an impact. Without ``context`` no body is known by name, and no surface.

    Raises:
        ContactDynamicsError: nothing strikes, or something is asked for that is not known, not allowed or not
            supported. The message names it.
    """
    known = Context() if context is None else context
    strike = strike_of(question, known)
    problem: PlanarProblem | None = None
    warnings = _outside(question, strike)
    law = question.several_contacts_law
    if isinstance(law, InTime):
        sequence = _in_time(question, law, strike, known)
        strike = _from_first(sequence, strike)
        resolved = sequence_resolved(sequence, strike.before)
        if sequence.order_is_open:
            warnings += (_OPEN_AT_AN_INSTANT,)
    elif question.problem is Problem.PLANAR:
        problem = _problem(question, strike, known)
        resolved = _in_plane(question, law, strike, problem)
    else:  # AUTOMATIC goes here too, because space contains the plane
        resolved = _in_space(question, law, strike)
    if law is SeveralContactsLaw.SEQUENTIAL:
        warnings += _order_warning(question, strike, problem)
    if question.include_covariance:
        resolved = with_distribution(resolved, _distribution(question, strike, known))
    body, other = strike.subject.body, strike.other
    return ImpactAnswer(
        body_name=body.name,
        p_FB_F=body.p_FB_F,
        state=strike.state,
        fit=strike.subject.fit,
        other=None
        if other is None
        else StruckBody(name=other.body.name, p_FB_F=other.body.p_FB_F, state=other.state),
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


def _outside(question: ImpactQuestion, strike: Strike) -> tuple[str, ...]:
    """Return warnings of stated contacts that are outside of the body's shape."""
    if question.contacts is None:
        return ()
    return outside_shape(
        strike.subject.body,
        points_W=strike.contacts.p_WC_W,
        p_WB_W=strike.subject.state.p_WB_W,
        R_WB=strike.subject.state.R_WB,
        distance_tolerance=strike.distance_tolerance,
    )


def _order_warning(
    question: ImpactQuestion, strike: Strike, problem: PlanarProblem | None
) -> tuple[str, ...]:
    """Return a warning where the order of strikes decides the answer, with the difference that it makes."""
    body, state, contacts = strike.before.body, strike.state, strike.contacts
    if problem is not None and len(problem.contacts) > 1:
        axes = problem.plane.axes_W
        body, state, contacts = planar_in_space(problem.body, problem.velocity, problem.contacts, axes_W=axes)
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


def _in_time(question: ImpactQuestion, law: InTime, strike: Strike, context: Context) -> ImpactSequence:
    """Return the strikes from a state on. Without any, raise `SeparatingContactError` or `NoContactError`."""
    world = context.world
    if question.contacts is not None:
        follow = partial(
            impact_sequence_of,
            strike.before.body,
            strike.state,
            strike.contacts,
            gravity_W=world.gravity_W,
        )
    else:
        follow = partial(impact_sequence, strike.subject.body, strike.state, world)
    sequence = follow(
        restitution_law=question.restitution_law,
        window=law.strike_window,
        max_strikes=law.max_strikes,
        distance_tolerance=strike.distance_tolerance,
        velocity_tolerance=strike.velocity_tolerance,
        hold_step=law.hold_step,
    )
    if not sequence.strikes and sequence.end == SequenceEnd.STAYS:
        message = (
            "contacts: at least one must strike, got one that stays (a contact mode question says what "
            "follows; a hold_step continues beyond it)"
        )
        raise NoContactError(message)
    if not sequence.strikes:
        allowed = f"one that approaches or comes back within the strike_window of {law.strike_window:g} s"
        if question.contacts is not None:
            velocities = strike.state.velocity_of_point(strike.contacts.p_WC_W)
            speeds = np.einsum("ij,ij->i", velocities, strike.contacts.normals_W)
            if (speeds > strike.velocity_tolerance).any():
                allowed += f" ({NORMAL_HINT})"
        raise SeparatingContactError("contacts", "none that strikes", allowed)
    return sequence


def _from_first(sequence: ImpactSequence, strike: Strike) -> Strike:
    """Return the impact that begins with the first of several strikes, with the contacts of all of them."""
    first = sequence.strikes[0]
    return replace(
        strike, seconds=strike.seconds + first.seconds, state=first.state_before, contacts=sequence.contacts
    )


def _in_space(question: ImpactQuestion, law: SeveralContactsLaw, strike: Strike) -> ResolvedImpact:
    before, contacts = strike.before, strike.contacts
    if strike.other is not None:
        return _of_two(question, law, strike, strike.other)
    if len(contacts) == 1:
        impact = spatial_impact(
            before.body,
            strike.state,
            contacts[0],
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        resolved = spatial_resolved(impact, before)
    else:
        several = several_impact(
            before.body,
            strike.state,
            contacts,
            several_contacts_law=law,
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        resolved = several_resolved(several, before)
    if not question.include_orders:
        return resolved
    return with_orders(resolved, _orders(question, strike, before.body, strike.state, contacts))


def _of_two(
    question: ImpactQuestion, law: SeveralContactsLaw, strike: Strike, other: Subject
) -> ResolvedImpact:
    before, contacts = strike.before, strike.contacts
    other_before = Before(body=other.body.mass_properties, state=other.state)
    if len(contacts) == 1:
        impact = spatial_pair_impact(
            before.body,
            strike.state,
            other_before.body,
            other.state,
            contacts[0],
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        return spatial_resolved(impact, before, other_before)
    several = bodies_impact(
        [before.body, other_before.body],
        [strike.state, other.state],
        contacts,
        [(0, 1)] * len(contacts),
        several_contacts_law=law,
        restitution_law=question.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    return several_resolved(several, before, other_before)


def _problem(question: ImpactQuestion, strike: Strike, context: Context) -> PlanarProblem:
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
    question: ImpactQuestion, law: SeveralContactsLaw, strike: Strike, problem: PlanarProblem
) -> ResolvedImpact:
    before = strike.before
    if len(problem.contacts) == 1:
        impact = planar_impact(
            problem.body,
            problem.velocity,
            problem.contacts[0],
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        resolved = planar_resolved(impact, problem, before)
        ordered = (before.body, strike.state, strike.contacts)
    else:
        ordered = planar_in_space(
            problem.body, problem.velocity, problem.contacts, axes_W=problem.plane.axes_W
        )
        several = several_impact(
            *ordered,
            several_contacts_law=law,
            restitution_law=question.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        velocity = planar_velocity(problem.plane, several.state)
        after = with_planar_velocity(problem, strike.state, velocity)
        resolved = several_resolved(replace(several, state=after), before)
    return with_orders(resolved, _orders(question, strike, *ordered)) if question.include_orders else resolved


def _orders(
    question: ImpactQuestion, strike: Strike, body: MassProperties, state: BodyState, contacts: ContactSet
) -> OrderedOutcomes:
    return outcomes_over_orders(
        body,
        state,
        contacts,
        restitution_law=question.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )


def _distribution(question: ImpactQuestion, strike: Strike, context: Context) -> ImpactDistribution:
    """Return the distribution of the state after the impact, from the covariance of the state before."""
    covariance = covariance_of(strike.subject)
    body = strike.before.body
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
