"""Answers `~/predict_impact`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NoContactError, NotSupportedError
from contact_dynamics.impact import (
    RestitutionLaw,
    SeveralContactsLaw,
    outcomes_over_orders,
    planar_impact,
    several_impact,
    spatial_impact,
    spatial_impact_distribution,
    spatial_pair_impact,
)
from contact_dynamics.landing import next_landing
from contact_dynamics.nodes.subject import (
    Knowledge,
    Subject,
    check_has_shape,
    contacts_of,
    covariance_of,
    distance_tolerance_of,
    or_configured,
    other_subject_of,
    planar_problem_of,
    subject_of,
    velocity_tolerance_of,
)
from contact_dynamics.uncertainty import propagate_covariance
from msg_adapters.contacts import contacts_to_msg
from msg_adapters.geometry import vector_to_msg
from msg_adapters.impact import (
    Before,
    planar_impact_to_msg,
    several_impact_to_msg,
    spatial_impact_to_msg,
    write_distribution,
    write_orders,
)
from msg_adapters.tumbling import write_fit

if TYPE_CHECKING:
    from contact_dynamics.contact import ContactSet
    from contact_dynamics.impact import ImpactDistribution
    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import Impact as ImpactMsg

SAMPLES: Final = 200
"""Drawn states of an uncertain impact: probabilities to 0.035; some 0.1 s, in which nobody else is served."""

_NO_WRENCH: Final = np.zeros(3)
Law = TypeVar("Law", bound=Enum)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Strike:
    """An impact that is to be resolved."""

    subject: Subject
    other: Subject | None
    seconds: float  # s from the state's stamp
    state: BodyState  # just before
    contacts: ContactSet
    law: RestitutionLaw
    several_law: SeveralContactsLaw
    velocity_tolerance: float  # m/s
    gravity_W: FloatArray  # (3,), m/s^2, of the flight before

    @property
    def before(self) -> Before:
        """What the adapters need of the first body."""
        subject = self.subject
        return Before(body=subject.body.mass_properties, state=self.state, state_to_msg=subject.state_to_msg)

    def one_contact(self) -> dict[str, Any]:
        """Return the arguments of the laws for one contact in space."""
        return {
            "p_WC_W": self.contacts.p_WC_W[0],
            "n_W": self.contacts.normals_W[0],
            "friction": float(self.contacts.frictions[0]),
            "restitution": float(self.contacts.restitutions[0]),
            "law": self.law,
            "velocity_tolerance": self.velocity_tolerance,
        }


def predict_impact(request: Any, response: Any, knowledge: Knowledge) -> None:
    """Answer one request, or raise a `ContactDynamicsError` that says what is wrong with it."""
    if request.problem not in {request.AUTOMATIC, request.PLANAR, request.SPATIAL}:
        raise InvalidFieldError("problem", request.problem, "AUTOMATIC (0), PLANAR (1) or SPATIAL (2)")
    if request.several_contacts_law == request.SEQUENTIAL_IN_TIME:
        raise NotSupportedError("several_contacts_law: found SEQUENTIAL_IN_TIME (2), allowed are 0 and 1 yet")
    strike = _strike(request, knowledge)
    if request.problem == request.PLANAR:
        response.problem = request.PLANAR
        response.impact = _in_plane(request, response, strike, knowledge)
    else:  # space contains the plane
        response.problem = request.SPATIAL
        response.impact = _in_space(strike)
    if request.want_orders:
        write_orders(
            response.impact,
            outcomes_over_orders(
                strike.before.body,
                strike.state,
                strike.contacts,
                restitution_law=strike.law,
                velocity_tolerance=strike.velocity_tolerance,
            ),
        )
    if request.want_covariance:
        write_distribution(response.impact, _distribution(request, strike))
    write_fit(response, strike.subject.fit)
    response.time_to_contact = strike.seconds
    response.state_before = strike.subject.state_to_msg(strike.state)
    if strike.other is not None:
        response.other_state_before = [strike.other.state_to_msg(strike.other.state)]
    response.contacts = contacts_to_msg(strike.contacts)
    response.velocity_tolerance = strike.velocity_tolerance
    response.distance_tolerance = distance_tolerance_of(request, knowledge)


def _strike(request: Any, knowledge: Knowledge) -> _Strike:
    """Return the impact that a request means: at the contacts that it carries, or at the next landing."""
    subject = subject_of(request, knowledge)
    other = other_subject_of(request, knowledge)
    seconds, state, contacts = 0.0, subject.state, None
    if request.contact_source != request.CONTACTS_FROM_GEOMETRY:
        contacts = contacts_of(request, subject, knowledge)
    elif other is not None:
        message = "contact_source: found CONTACTS_FROM_GEOMETRY (0) for two bodies, allowed is 1 (explicit)"
        raise NotSupportedError(message)
    else:
        seconds, state, contacts = _landing(request, subject, knowledge)
    if other is not None and (len(contacts) > 1 or request.want_orders or request.problem == request.PLANAR):
        message = "other_body_name: found a second body, allowed is one contact in space for two bodies"
        raise NotSupportedError(message)
    if request.problem == request.PLANAR and len(contacts) > 1:
        message = f"contacts: found {len(contacts)} in the plane, allowed is 1 (SPATIAL takes several)"
        raise NotSupportedError(message)
    return _Strike(
        subject=subject,
        other=other,
        seconds=seconds,
        state=state,
        contacts=contacts,
        law=_law("restitution_law", request.restitution_law, RestitutionLaw),
        several_law=_law("several_contacts_law", request.several_contacts_law, SeveralContactsLaw),
        velocity_tolerance=velocity_tolerance_of(request, knowledge),
        gravity_W=knowledge.parameters.world.gravity_W,
    )


def _law(field: str, value: int, laws: type[Law]) -> Law:
    try:
        return laws(value)
    except ValueError:
        allowed = ", ".join(f"{law.name} ({law.value})" for law in laws)
        raise InvalidFieldError(field, value, allowed) from None


def _landing(request: Any, subject: Subject, knowledge: Knowledge) -> tuple[float, BodyState, ContactSet]:
    check_has_shape(subject.body)
    horizon = or_configured("horizon", request.horizon, knowledge.parameters.horizon)
    tolerance = velocity_tolerance_of(request, knowledge)
    landing = next_landing(
        subject.body,
        subject.state,
        knowledge.parameters.world,
        horizon=horizon,
        distance_tolerance=distance_tolerance_of(request, knowledge),
        velocity_tolerance=tolerance,
    )
    name = subject.body.name
    if landing is None:
        raise NoContactError(f"contacts: {name!r} touches no surface within the horizon of {horizon:g} s")
    if not landing.strikes:
        raise NoContactError(
            f"contacts: {name!r} touches {landing.contacts.surfaces[0]!r} and does not approach it by more "
            f"than {tolerance:g} m/s (~/predict_contact_mode says what follows)"
        )
    return landing.seconds, landing.state, landing.contacts


def _in_space(strike: _Strike) -> ImpactMsg:
    before, other = strike.before, strike.other
    if len(strike.contacts) > 1:
        several = several_impact(
            before.body,
            strike.state,
            strike.contacts,
            law=strike.several_law,
            restitution_law=strike.law,
            velocity_tolerance=strike.velocity_tolerance,
        )
        return several_impact_to_msg(several, before)
    if other is None:
        return spatial_impact_to_msg(
            spatial_impact(before.body, strike.state, **strike.one_contact()), before
        )
    other_before = Before(body=other.body.mass_properties, state=other.state, state_to_msg=other.state_to_msg)
    impact = spatial_pair_impact(
        before.body, strike.state, other_before.body, other.state, **strike.one_contact()
    )
    return spatial_impact_to_msg(impact, before, other_before)


def _in_plane(request: Any, response: Any, strike: _Strike, knowledge: Knowledge) -> ImpactMsg:
    problem = planar_problem_of(
        request,
        strike.subject.body,
        strike.state,
        strike.contacts,
        knowledge,
        force_W=_NO_WRENCH,
        torque_W=_NO_WRENCH,
    )
    impact = planar_impact(
        problem.body,
        problem.velocity,
        problem.contacts[0],
        law=strike.law,
        velocity_tolerance=strike.velocity_tolerance,
    )
    response.plane_normal = vector_to_msg(problem.plane.normal_W)
    response.out_of_plane = problem.out_of_plane
    return planar_impact_to_msg(impact, problem, strike.before)


def _distribution(request: Any, strike: _Strike) -> ImpactDistribution:
    """Return where the state after the impact lies, for the covariance of the state that was taken."""
    if strike.other is not None or len(strike.contacts) > 1 or request.problem == request.PLANAR:
        raise NotSupportedError("want_covariance: found true, allowed at one contact with the world in space")
    covariance = covariance_of(strike.subject)
    body = strike.before.body
    if strike.seconds > 0.0:
        flight = propagate_covariance(
            body, strike.subject.state, covariance, [strike.seconds], gravity_W=strike.gravity_W
        )
        covariance = flight.covariances[0]
    return spatial_impact_distribution(
        body, strike.state, covariance=covariance, samples=SAMPLES, **strike.one_contact()
    )
