"""What a request is about: body, state and contacts, as the request says or the server knows them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from contact_dynamics.contact.found import find_contacts
from contact_dynamics.errors import InvalidFieldError, NoContactError, TooLargeError
from contact_dynamics.motion.free_fit import FitResult, fit_free_motion
from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion, best_plane, project_onto_plane
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.validation import check_not_negative
from contact_dynamics.world import Body
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, covariance_from_msg
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.frames import (
    origin_of_published_frame,
    state_of_center_of_mass,
    velocity_of_published_frame,
)
from msg_adapters.geometry import mass_properties_from_msg, vector_from_msg
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from builtin_interfaces.msg import Time
    from geometry_msgs.msg import Inertia

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.questions.state_store import StateStore
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg

    Fitting: TypeAlias = Callable[[MassProperties, Sequence[BodyState]], FitResult]

_LONGEST_NAME = 256
_REMEMBERED = 16  # bodies that questions describe; who sends an inertia sends it with every question


@dataclass(frozen=True, slots=True, kw_only=True)
class Knowledge:
    """What the server knows when it is asked."""

    parameters: ServerParameters
    states: StateStore
    now_ns: Callable[[], int]


@dataclass(frozen=True, slots=True, kw_only=True)
class Subject:
    """The body that a question is about, with the mass properties and the state that were taken."""

    body: Body
    state: BodyState
    world_frame: str
    covariance: FloatArray | None = None  # (12, 12), of the state; None: not known
    fit: FitResult | None = None  # where the state is a fit to several

    def state_to_msg(self, state: BodyState, *, into: BodyStateMsg | None = None) -> BodyStateMsg:
        """Return a state of this body as a message: a new one, or the one to fill."""
        return body_state_to_msg(
            state,
            body_name=self.body.name,
            world_frame=self.world_frame,
            p_FB_F=self.body.p_FB_F,
            into=into,
        )


def subject_of(request: Any, knowledge: Knowledge, *, fit: Fitting | None = None) -> Subject:
    """Return the body and the state that a request of any of the three services names or carries.

    ``fit`` finds the state that fits a window of published ones best; None: that of a free flight.

    Raises:
        ContactDynamicsError: the body is unknown, its state unknown or stale, or a number not allowed.
    """
    if request.state_source not in {request.STATE_PUBLISHED, request.STATE_EXPLICIT}:
        raise InvalidFieldError(
            "state_source", request.state_source, "STATE_PUBLISHED (0) or STATE_EXPLICIT (1)"
        )
    explicit = request.state if request.state_source == request.STATE_EXPLICIT else None
    window = check_not_negative("fit_window", getattr(request, "fit_window", 0.0))
    if window > 0.0 and explicit is not None:
        raise InvalidFieldError("fit_window", window, "0 for an explicit state: published states are fitted")
    return _subject(
        request.body_name,
        request.inertia,
        knowledge,
        explicit=explicit,
        stamp=request.stamp,
        window=window,
        fit=fit,
    )


def other_subject_of(request: Any, knowledge: Knowledge) -> Subject | None:
    """Return the second body of an impact, or None where the first one strikes the world.

    Raises:
        ContactDynamicsError: as `subject_of`.
    """
    explicit = request.other_state[0] if request.other_state else None
    if not request.other_body_name and request.other_inertia.m == 0.0 and explicit is None:
        return None
    return _subject(
        request.other_body_name, request.other_inertia, knowledge, explicit=explicit, stamp=request.stamp
    )


def covariance_of(subject: Subject) -> FloatArray:
    """Return the covariance of a subject's state, (12, 12); without one raise `InvalidFieldError`."""
    if subject.covariance is None:
        raise InvalidFieldError(
            "state.covariance",
            "none",
            "144 numbers of an explicit state, or a fit_window",
        )
    return subject.covariance


def _subject(
    name: str,
    inertia: Inertia,
    knowledge: Knowledge,
    *,
    explicit: BodyStateMsg | None,
    stamp: Time,
    window: float = 0.0,
    fit: Fitting | None = None,
) -> Subject:
    parameters = knowledge.parameters
    body = _body_of(name, inertia, knowledge)
    if explicit is not None:
        return Subject(
            body=body,
            state=body_state_from_msg(explicit, world_frame=parameters.world_frame, p_FB_F=body.p_FB_F),
            world_frame=parameters.world_frame,
            covariance=covariance_from_msg(explicit),
        )
    if not name:
        raise InvalidFieldError("body_name", name, "the name of a configured body, or an explicit state")
    newest = _published_state(name, stamp, knowledge)
    states = knowledge.states.window(name, newest, window) if window > 0.0 else [newest]
    configured = parameters.world.body(name)
    if body is not configured:
        states = [_carried_over(state, configured, body) for state in states]
    if window == 0.0:
        return Subject(body=body, state=states[-1], world_frame=parameters.world_frame)
    if fit is None:
        best = fit_free_motion(body.mass_properties, states, gravity_W=parameters.world.gravity_W)
    else:
        best = fit(body.mass_properties, states)
    return Subject(
        body=body, state=best.state, world_frame=parameters.world_frame, covariance=best.covariance, fit=best
    )


def contacts_of(request: Any, subject: Subject, knowledge: Knowledge) -> ContactSet:
    """Return the contacts that a request carries, or those that geometry finds.

    Raises:
        ContactDynamicsError: nothing touches, or a number is not allowed.
    """
    if request.contact_source == request.CONTACTS_EXPLICIT:
        contacts = contacts_from_msg(request.contacts)
        if len(contacts) == 0:
            message = "contacts: found none, allowed is at least one"
            raise NoContactError(message)
        return contacts
    if request.contact_source != request.CONTACTS_FROM_GEOMETRY:
        raise InvalidFieldError(
            "contact_source", request.contact_source, "CONTACTS_FROM_GEOMETRY (0) or CONTACTS_EXPLICIT (1)"
        )
    check_has_shape(subject.body)
    tolerance = distance_tolerance_of(request, knowledge)
    contacts = find_contacts(
        subject.body, subject.state, knowledge.parameters.world.surfaces, distance_tolerance=tolerance
    )
    if len(contacts) == 0:
        message = f"contacts: no point of {subject.body.name!r} is within {tolerance:g} m of a surface"
        raise NoContactError(message)
    return contacts


def check_has_shape(body: Body) -> None:
    """Raise `NoContactError` where a body has no shape that could touch anything."""
    if body.shape.is_empty:
        message = (
            f"contacts: body {body.name!r} has no shape to find them from, allowed are explicit contacts"
        )
        raise NoContactError(message)


def distance_tolerance_of(request: Any, knowledge: Knowledge) -> float:
    """Return the request's distance tolerance, m, or the configured one where it is zero."""
    return or_configured(
        "distance_tolerance", request.distance_tolerance, knowledge.parameters.distance_tolerance
    )


def velocity_tolerance_of(request: Any, knowledge: Knowledge) -> float:
    """Return the request's velocity tolerance, m/s, or the configured one where it is zero."""
    return or_configured(
        "velocity_tolerance", request.velocity_tolerance, knowledge.parameters.velocity_tolerance
    )


def planar_problem_of(
    request: Any,
    body: Body,
    state: BodyState,
    contacts: ContactSet,
    knowledge: Knowledge,
    *,
    force_W: FloatArray,
    torque_W: FloatArray,
) -> PlanarProblem:
    """Return a problem in the plane of motion that a request names, or in the one that fits best.

    Raises:
        ContactDynamicsError: the plane's normal is not unit, or something leaves the plane by too much.
    """
    tolerance = or_configured(
        "out_of_plane_tolerance", request.out_of_plane_tolerance, knowledge.parameters.out_of_plane_tolerance
    )
    normal = vector_from_msg(request.plane_normal)
    inputs: dict[str, Any] = {"force_W": force_W, "torque_W": torque_W, "speed_tolerance": tolerance}
    plane = (
        PlaneOfMotion(normal_W=normal)
        if normal.any()
        else best_plane(body.mass_properties, state, contacts, **inputs)
    )
    return project_onto_plane(body.mass_properties, state, contacts, plane=plane, **inputs)


def gravity_of(request: Any, knowledge: Knowledge) -> FloatArray:
    """Return the acceleration of gravity that a request asks for, (3,), m/s^2, world axes."""
    if request.gravity == request.GRAVITY_AS_CONFIGURED:
        return knowledge.parameters.world.gravity_W
    if request.gravity == request.GRAVITY_NONE:
        return np.zeros(3)
    raise InvalidFieldError("gravity", request.gravity, "GRAVITY_AS_CONFIGURED (0) or GRAVITY_NONE (1)")


def or_configured(field: str, asked: float, configured: float) -> float:
    """Return what a request asks for, or what is configured where that is zero; negative or NaN raises."""
    return check_not_negative(field, asked) or configured


def _body_of(name: str, inertia: Inertia, knowledge: Knowledge) -> Body:
    if len(name) > _LONGEST_NAME:
        raise TooLargeError("body_name", f"{len(name)} characters", f"at most {_LONGEST_NAME}")
    if not name and inertia.m == 0.0:
        raise InvalidFieldError("body_name", name, "the name of a configured body, or an inertia of mass > 0")
    configured = knowledge.parameters.world.body(name) if name else None
    if configured is not None and inertia.m == 0.0:
        return configured
    mass_properties, p_FB_F = mass_properties_from_msg(inertia)
    return _changed_body(name, mass_properties, tuple(p_FB_F.tolist()), configured)


@lru_cache(maxsize=_REMEMBERED)
def _changed_body(
    name: str, mass_properties: MassProperties, com: tuple[float, ...], configured: Body | None
) -> Body:
    """Return a body of other mass properties than the configured one's, and its shape, if there is one."""
    p_FB_F = np.array(com)
    shape = NO_SHAPE if configured is None else configured.shape.moved(configured.p_FB_F - p_FB_F)
    return Body(name=name, mass_properties=mass_properties, p_FB_F=p_FB_F, shape=shape)


def _published_state(name: str, stamp: Time, knowledge: Knowledge) -> BodyState:
    stamp_ns = stamp_ns_from_msg(stamp)
    if stamp_ns == 0:
        return knowledge.states.newest(name, now_ns=knowledge.now_ns())
    return knowledge.states.at(name, stamp_ns)


def _carried_over(state: BodyState, configured: Body, body: Body) -> BodyState:
    return state_of_center_of_mass(
        p_WF_W=origin_of_published_frame(state, configured.p_FB_F),
        q_WF=state.q_WB,
        v_WF_W=velocity_of_published_frame(state, configured.p_FB_F),
        w_WF_W=state.w_WB_W,
        p_FB_F=body.p_FB_F,
        stamp_ns=state.stamp_ns,
    )
