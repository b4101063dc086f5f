"""Answers `~/predict_impact`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NoContactError, SeparatingContactError
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
from contact_dynamics.impact.in_time.sequence import MOST_STRIKES, STRIKE_WINDOW
from contact_dynamics.motion.covariance import propagate_covariance
from contact_dynamics.nodes.strike import strike_of
from contact_dynamics.nodes.subject import (
    covariance_of,
    distance_tolerance_of,
    or_configured,
    planar_problem_of,
)
from contact_dynamics.plane.in_space import planar_in_space
from contact_dynamics.plane.lifting import (
    check_mirrored,
    mirror_partners,
    planar_velocity,
    with_planar_velocity,
)
from msg_adapters.contacts import contacts_to_msg
from msg_adapters.geometry import vector_to_msg
from msg_adapters.impact import (
    Before,
    pair_impact_to_msg,
    planar_impact_to_msg,
    sequence_to_msg,
    several_impact_to_msg,
    spatial_impact_to_msg,
    write_distribution,
    write_orders,
)
from msg_adapters.tumbling import write_fit

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact import ImpactDistribution, ImpactSequence, OrderedOutcomes
    from contact_dynamics.nodes.strike import Strike
    from contact_dynamics.nodes.subject import Knowledge, Subject
    from contact_dynamics.plane.projection import PlanarProblem
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics_interfaces.msg import Impact as ImpactMsg

SAMPLES: Final = 2000
"""Drawn states of an uncertain impact: probabilities to 0.011; some 20 ms, in which nobody else is served."""

_NO_WRENCH: Final = np.zeros(3)


def predict_impact(request: Any, response: Any, knowledge: Knowledge) -> None:
    """Answer one request, or raise a `ContactDynamicsError` that says what is wrong with it."""
    if request.problem not in {request.AUTOMATIC, request.PLANAR, request.SPATIAL}:
        raise InvalidFieldError("problem", request.problem, "AUTOMATIC (0), PLANAR (1) or SPATIAL (2)")
    strike = strike_of(request, knowledge)
    if request.several_contacts_law == request.SEQUENTIAL_IN_TIME:
        sequence = _in_time(request, strike, knowledge)
        strike = _from_first(sequence, strike)
        response.problem = request.SPATIAL
        sequence_to_msg(sequence, strike.before, into=response.impact)
    elif request.problem == request.PLANAR:
        response.problem = request.PLANAR
        _in_plane(request, response, strike, knowledge)
    else:  # space contains the plane
        response.problem = request.SPATIAL
        _in_space(strike, response.impact)
        if request.want_orders:
            write_orders(response.impact, _orders(strike, strike.before.body, strike.state, strike.contacts))
    if request.want_covariance:
        write_distribution(response.impact, _distribution(strike))
    write_fit(response, strike.subject.fit)
    response.time_to_contact = strike.seconds
    strike.subject.state_to_msg(strike.state, into=response.state_before)
    if strike.other is not None:
        response.other_state_before = [strike.other.state_to_msg(strike.other.state)]
    contacts_to_msg(strike.contacts, into=response.contacts)
    response.velocity_tolerance = strike.velocity_tolerance
    response.distance_tolerance = distance_tolerance_of(request, knowledge)


def _in_time(request: Any, strike: Strike, knowledge: Knowledge) -> ImpactSequence:
    """Return the strikes from a state on; without one raise `SeparatingContactError` or `NoContactError`."""
    how: dict[str, Any] = {
        "restitution_law": strike.restitution_law,
        "window": or_configured("strike_window", request.strike_window, STRIKE_WINDOW),
        "most_strikes": request.most_strikes or MOST_STRIKES,
        "hold_step": or_configured("hold_step", request.hold_step, 0.0) or None,
        "distance_tolerance": distance_tolerance_of(request, knowledge),
        "velocity_tolerance": strike.velocity_tolerance,
    }
    world = knowledge.parameters.world
    if request.contact_source == request.CONTACTS_EXPLICIT:
        sequence = impact_sequence_of(
            strike.before.body, strike.state, strike.contacts, gravity_W=world.gravity_W, **how
        )
    else:
        sequence = impact_sequence(strike.subject.body, strike.state, world, **how)
    if not sequence.strikes and sequence.end == SequenceEnd.STAYS:
        message = (
            "contacts: found one that stays and none that strikes (~/predict_contact_mode says what follows; "
            "a hold_step goes on over it)"
        )
        raise NoContactError(message)
    if not sequence.strikes:
        raise SeparatingContactError(
            "contacts",
            "none that strikes",
            f"one that approaches or comes back within the strike_window of {how['window']:g} s",
        )
    return sequence


def _from_first(sequence: ImpactSequence, strike: Strike) -> Strike:
    """Return the impact that begins with the first of the strikes in time, at the contacts of them all."""
    first = sequence.strikes[0]
    return replace(
        strike, seconds=strike.seconds + first.seconds, state=first.state_before, contacts=sequence.contacts
    )


def _in_space(strike: Strike, msg: ImpactMsg) -> None:
    before, other = strike.before, strike.other
    if other is not None:
        _of_two(strike, other, msg)
        return
    if len(strike.contacts) == 1:
        impact = spatial_impact(
            before.body,
            strike.state,
            strike.contacts[0],
            restitution_law=strike.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        spatial_impact_to_msg(impact, before, into=msg)
        return
    several = several_impact(
        before.body,
        strike.state,
        strike.contacts,
        several_contacts_law=strike.several_contacts_law,
        restitution_law=strike.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    several_impact_to_msg(several, before, into=msg)


def _of_two(strike: Strike, other: Subject, msg: ImpactMsg) -> None:
    before = strike.before
    other_before = Before(body=other.body.mass_properties, state=other.state, state_to_msg=other.state_to_msg)
    if len(strike.contacts) == 1:
        impact = spatial_pair_impact(
            before.body,
            strike.state,
            other_before.body,
            other.state,
            strike.contacts[0],
            restitution_law=strike.restitution_law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        spatial_impact_to_msg(impact, before, other_before, into=msg)
        return
    several = bodies_impact(
        [before.body, other_before.body],
        [strike.state, other.state],
        strike.contacts,
        [(0, 1)] * len(strike.contacts),
        several_contacts_law=strike.several_contacts_law,
        restitution_law=strike.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    pair_impact_to_msg(several, before, other_before, into=msg)


def _in_plane(request: Any, response: Any, strike: Strike, knowledge: Knowledge) -> None:
    problem = planar_problem_of(
        request,
        strike.subject.body,
        strike.state,
        strike.contacts,
        knowledge,
        force_W=_NO_WRENCH,
        torque_W=_NO_WRENCH,
    )
    response.plane_normal = vector_to_msg(problem.plane.normal_W)
    response.out_of_plane = problem.out_of_plane
    if len(problem.contacts) > 1:
        partners = mirror_partners(
            problem.plane,
            strike.state,
            strike.contacts,
            distance_tolerance=distance_tolerance_of(request, knowledge),
        )
        check_mirrored(problem.plane, strike.state, strike.contacts, partners)
        _several_in_plane(request, strike, problem, response.impact)
        return
    impact = planar_impact(
        problem.body,
        problem.velocity,
        problem.contacts[0],
        restitution_law=strike.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    planar_impact_to_msg(impact, problem, strike.before, into=response.impact)
    if request.want_orders:
        orders = _orders(strike, strike.before.body, strike.state, strike.contacts)
        write_orders(response.impact, orders)


def _several_in_plane(request: Any, strike: Strike, problem: PlanarProblem, msg: ImpactMsg) -> None:
    flat = planar_in_space(problem.body, problem.velocity, problem.contacts, axes_W=problem.plane.axes_W)
    several = several_impact(
        *flat,
        several_contacts_law=strike.several_contacts_law,
        restitution_law=strike.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    velocity = planar_velocity(problem.plane, several.state)
    after = with_planar_velocity(problem, strike.state, velocity)
    several_impact_to_msg(replace(several, state=after), strike.before, into=msg)
    if request.want_orders:
        write_orders(msg, _orders(strike, *flat))


def _orders(strike: Strike, body: MassProperties, state: BodyState, contacts: ContactSet) -> OrderedOutcomes:
    return outcomes_over_orders(
        body,
        state,
        contacts,
        restitution_law=strike.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
    )


def _distribution(strike: Strike) -> ImpactDistribution:
    """Return where the state after the impact lies, for the covariance of the state that was taken."""
    covariance = covariance_of(strike.subject)
    body = strike.before.body
    if strike.seconds > 0.0:
        flight = propagate_covariance(
            body, strike.subject.state, covariance, [strike.seconds], gravity_W=strike.gravity_W
        )
        covariance = flight.covariances[0]
    return spatial_impact_distribution(
        body,
        strike.state,
        strike.contacts[0],
        covariance=covariance,
        restitution_law=strike.restitution_law,
        velocity_tolerance=strike.velocity_tolerance,
        samples=SAMPLES,
    )
