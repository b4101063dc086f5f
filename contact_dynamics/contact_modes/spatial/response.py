# SPDX-License-Identifier: Apache-2.0
"""Contact modes of a mechanism, whose W = J M^-1 J^T is known, and of several bodies that touch each other.

W is how contact points respond to forces. Under contact forces f, the points have the accelerations W f + b.
Any factor of W = L L^T is the Jacobian of a mechanism with unit mass that responds alike. Its motion has as
many components as W has rank, and its case is searched as that of one body (`answer`).

What b has along the columns of L is the motion without contact forces. If nothing else remains at contacts
that touch, and none of them slides, the mechanism is as one at rest, whatever causes b: for example, bodies
at rest on a tray that accelerates, under inertial forces.

At a contact between two bodies, the second is a surface that moves: its velocity, its turning and the part of
its acceleration that its velocities cause are known, and the rest follows from the forces on it. J has the
Jacobians of both bodies with opposite signs, so that all else is that of a mechanism.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.contact.pairs import check_pairs, pair_jacobians
from contact_dynamics.contact.velocities import check_speeds, velocity_accelerations, warn_if_far
from contact_dynamics.contact_modes.result import (
    BodiesMode,
    BodiesModeAnswer,
    ResponseMode,
    ResponseModeAnswer,
)
from contact_dynamics.contact_modes.spatial.answer import Considered, answer_fields, considered, shown_modes
from contact_dynamics.contact_modes.spatial.problem import (
    AccelerationMap,
    SpatialCase,
    made_flush,
    reach_of,
    sliding_of,
    touching_of,
)
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import inverse_mass_matrix
from contact_dynamics.tolerances import (
    LARGEST_NUMBER,
    ROW_TOLERANCE,
    SINGULAR_RESPONSE,
    SYMMETRY_TOLERANCE,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import check_array, check_magnitude, check_not_negative, check_vector3

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ResponseContactProblem(Record):
    """Contact problem of a mechanism, such as a robot arm or several joined bodies.

    The mechanism is described by the response of its contact points to forces, W = J M^-1 J^T, where M is the
    mass matrix and J, (3 n, d), the Jacobian of all contact points. W may be singular: a planar arm, for
    example, cannot move across its plane, and a mechanism can have more contacts than freedoms. Responses
    below `SINGULAR_RESPONSE` of the largest count as zero.

    Attributes:
        inverse_inertia_W: (3 n, 3 n), 1/kg, W, world axes, symmetric and positive semidefinite. Element 3 i +
            k belongs to axis k of contact i.
        accelerations_W: (n, 3), m/s^2, accelerations of the contact points without contact forces, world
            axes: J M^-1 t + dJ/dt u, where t are the generalized forces of gravity, actuators and velocities,
            and u the generalized velocities.
        contacts: Contacts with their normals into the mechanism, of which at most `MAX_DYNAMIC_CONTACTS`
            touch. Their positions and curvatures have no effect. Where two parts of the mechanism touch, J is
            that of the part into which the normal points less that of the other.
        velocities_W: (n, 3), m/s, velocities of the contact points, J u, world axes. The default is zero. One
            vector may be given for all contacts, here and above. If contacts have moving surfaces, what
            counts is the motion relative to these.
        velocity_tolerance: m/s, >= 0. Components of a contact's velocity up to this size count as zero.

    Raises:
        InvalidFieldError: an array has another shape or is not finite, the tolerance is negative, W is not
            symmetric or has a negative eigenvalue, or a contact cannot move along its normal.
    """

    inverse_inertia_W: FloatArray
    accelerations_W: FloatArray
    contacts: ContactSet
    velocities_W: FloatArray = field(default_factory=lambda: np.zeros(3))
    velocity_tolerance: float = VELOCITY_TOLERANCE

    if TYPE_CHECKING:  # what the constructor takes, beside what the fields then hold

        def __init__(
            self,
            *,
            inverse_inertia_W: ArrayLike,
            accelerations_W: ArrayLike,
            contacts: ContactSet,
            velocities_W: ArrayLike = (0.0, 0.0, 0.0),
            velocity_tolerance: float = VELOCITY_TOLERANCE,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Check the response, which becomes exactly symmetric, the motion and the tolerance."""
        n = len(self.contacts)
        response = _checked_response(self.inverse_inertia_W, self.contacts.normals_W)
        object.__setattr__(self, "inverse_inertia_W", response)
        for name in ("accelerations_W", "velocities_W"):
            object.__setattr__(self, name, for_each(name, getattr(self, name), n))
        tolerance = check_not_negative("velocity_tolerance", self.velocity_tolerance)
        object.__setattr__(self, "velocity_tolerance", tolerance)


def for_each(name: str, given: ArrayLike, n: int) -> FloatArray:
    """Return vectors, (n, 3), of which one may be given for all, or refuse what is not finite."""
    values = np.tile(check_vector3(name, given), (n, 1)) if np.shape(given) == (3,) else given
    return check_magnitude(name, check_array(name, values, (n, 3)))


def _checked_response(given: ArrayLike, normals: FloatArray) -> FloatArray:
    name, n = "inverse_inertia_W", len(normals)
    if n > 0 and np.shape(given) == (2 * n, 2 * n):
        raise InvalidFieldError(
            name,
            f"shape {np.shape(given)}",
            f"of shape ({3 * n}, {3 * n})",
            hint="for a planar mechanism, add rows and columns of zeros across its plane",
        )
    response = check_magnitude(name, check_array(name, given, (3 * n, 3 * n)))
    largest = float(np.abs(response).max(initial=0.0))
    if 0.0 < largest < 1.0 / LARGEST_NUMBER:
        allowed = f"at least {1.0 / LARGEST_NUMBER:g} 1/kg in its largest element"
        raise InvalidFieldError(name, f"{largest:g}", allowed)
    if np.abs(response - response.T).max(initial=0.0) > SYMMETRY_TOLERANCE * largest:
        raise InvalidFieldError(name, "an asymmetric matrix", "symmetric, as J M^-1 J^T is")
    response = 0.5 * (response + response.T)
    if n > 0 and np.linalg.eigvalsh(response)[0] < -SINGULAR_RESPONSE * largest:
        found = "a matrix with a negative eigenvalue"
        raise InvalidFieldError(name, found, "positive semidefinite, as J M^-1 J^T is")
    for i, normal in enumerate(normals):
        along = float(normal @ response[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] @ normal)
        if not along > SINGULAR_RESPONSE * largest:
            found = f"{along:g} 1/kg along the normal of contact {i}"
            raise InvalidFieldError(name, found, "positive there, where the mechanism must be able to move")
    response.flags.writeable = False
    return response


def response_contact_modes(problem: ResponseContactProblem) -> ResponseModeAnswer:
    """Return the verdict on the contacts of a mechanism and all consistent modes."""
    sizes, axes = np.linalg.eigh(problem.inverse_inertia_W)
    seen = sizes > SINGULAR_RESPONSE * sizes.max(initial=0.0)
    contacts = replace(problem.contacts, body_curvatures=None, surface_curvatures=None)
    velocities = problem.velocities_W
    if contacts.surface_velocities_W is not None:
        velocities = velocities - contacts.surface_velocities_W
    case = response_case(
        contacts,
        axes[:, seen] * np.sqrt(sizes[seen]),
        accelerations_W=problem.accelerations_W + velocity_accelerations(contacts, velocities, np.zeros(3)),
        velocities_W=velocities,
        tolerance=problem.velocity_tolerance,
    )
    found = considered(lambda _: case)
    return ResponseModeAnswer(
        modes=tuple(shown_modes(found)), problem=problem, **answer_fields(found, problem.velocity_tolerance)
    )


def response_case(
    contacts: ContactSet,
    factor: FloatArray,
    *,
    accelerations_W: FloatArray,
    velocities_W: FloatArray,
    tolerance: float,
) -> SpatialCase | tuple[int, ...]:
    """Return the case of a mechanism, or the contacts that approach.

    The factor, (3 n, d), is an L of W = L L^T. Accelerations without contact forces and velocities of the
    contact points, (n, 3), are relative to the surfaces.
    """
    touching = touching_of(contacts, velocities_W, tolerance)
    if isinstance(touching, tuple):
        return touching
    rows = (3 * touching[:, None] + np.arange(3)).ravel()
    # Forces act at contacts that touch alone. The motion has the components that these can move.
    sizes, axes = np.linalg.svd(factor[rows], full_matrices=False)[1:]
    axes = axes[sizes > ROW_TOLERANCE * sizes.max(initial=0.0)]
    points = factor @ axes.T if len(axes) > 0 else np.zeros((len(factor), 1))
    given = accelerations_W.ravel()
    free = np.linalg.lstsq(points[rows], given[rows], rcond=None)[0]
    turning = given - points @ free
    if np.abs(turning[rows]).max(initial=0.0) <= SINGULAR_RESPONSE * np.abs(given[rows]).max(initial=0.0):
        turning[rows] = 0.0
    length = float(np.linalg.norm(points[rows], axis=1).max(initial=0.0))
    length = length if length > 0.0 else 1.0
    motion = AccelerationMap(
        points=points,
        of_forces=points.T,
        free=free,
        turning=turning.reshape(-1, 3),
        inertia=np.eye(len(free)),
        wrench=free,
        mass=1.0 / length**2,
        lengths=np.full(len(free), length),
        at_rest=not np.any(turning[rows]),
        of_body=False,
    )
    return SpatialCase(motion, contacts, sliding_of(contacts, velocities_W, tolerance), touching)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodiesContactProblem(Record):
    """Contact problem of several bodies in space, which touch each other and the world.

    Attributes:
        bodies: Each a `Body`, or its `MassProperties`, which are stored.
        states: State of each body, with its origin at the centre of mass.
        contacts: Contacts of any kind, of which at most `MAX_DYNAMIC_CONTACTS` touch. Only surfaces of the
            world may move. Where two bodies touch, the surface is the second body, whose motion is that of
            its state, and the surface's curvatures are its own.
        pairs: For each contact, the body into which its normal points, and the other body. Both are indices
            into ``bodies``; the second is None for the world.
        forces_W: (k, 3), N, applied force on each body, including gravity but not contact forces, world axes.
        torques_W: (k, 3), N m, applied torque on each body about its centre of mass, without that of contact
            forces, world axes. The default is zero. One vector may be given for all bodies, here and above.
        velocity_tolerance: m/s, >= 0. Components of a contact's velocity up to this size count as zero, and
            so does an angular velocity that moves no contact relative to the centre of mass by more.

    Raises:
        InvalidFieldError: lists differ in length, an index is out of range, a number is not finite or
            beyond `LARGEST_NUMBER`, the tolerance is negative, or the surface of a body is given a motion.
    """

    bodies: tuple[MassProperties, ...] = field(metadata={"accepts": "Sequence[HasMassProperties]"})
    states: tuple[BodyState, ...] = field(metadata={"accepts": "Sequence[BodyState]"})
    contacts: ContactSet
    pairs: tuple[tuple[int, int | None], ...] = field(
        metadata={"accepts": "Sequence[tuple[int, int | None]]"}
    )
    forces_W: FloatArray
    torques_W: FloatArray = field(default_factory=lambda: np.zeros(3))
    velocity_tolerance: float = VELOCITY_TOLERANCE

    if TYPE_CHECKING:  # what the constructor takes, beside what the fields then hold

        def __init__(
            self,
            *,
            bodies: Sequence[HasMassProperties],
            states: Sequence[BodyState],
            contacts: ContactSet,
            pairs: Sequence[tuple[int, int | None]],
            forces_W: ArrayLike,
            torques_W: ArrayLike = (0.0, 0.0, 0.0),
            velocity_tolerance: float = VELOCITY_TOLERANCE,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Take the mass properties of the bodies. Check the lists, the loads and the tolerance."""
        count = len(self.bodies)
        check_pairs(count, self.states, self.contacts, self.pairs)
        for index, (body, state) in enumerate(zip(self.bodies, self.states, strict=True)):
            own = [i for i, pair in enumerate(self.pairs) if index in pair]
            check_speeds(state, self.contacts.p_WC_W[own])
            warn_if_far(body, state, self.contacts.p_WC_W[own])
        object.__setattr__(self, "bodies", tuple(body.mass_properties for body in self.bodies))
        object.__setattr__(self, "states", tuple(self.states))
        object.__setattr__(self, "pairs", tuple((first, second) for first, second in self.pairs))
        for name in ("forces_W", "torques_W"):
            object.__setattr__(self, name, for_each(name, getattr(self, name), count))
        tolerance = check_not_negative("velocity_tolerance", self.velocity_tolerance)
        object.__setattr__(self, "velocity_tolerance", tolerance)

    @property
    def wrench_W(self) -> FloatArray:
        """Return the applied force, N, and torque, N m, of each body, (6 k,)."""
        return np.hstack([self.forces_W, self.torques_W]).ravel()


class _Dynamics(NamedTuple):
    """The equations of motion of all bodies."""

    points: FloatArray  # (3 n, 6 k), accelerations of the contact points on unit ones of the bodies
    root: FloatArray  # (6 k, 6 k), a factor R of the inverse mass matrix, R R^T
    free: FloatArray  # (6 k,), the accelerations of the bodies without contact forces
    velocities: FloatArray  # (n, 3), m/s, of the contact points, relative to the other body or surface
    accelerations: FloatArray  # (n, 3), m/s^2, the same without contact forces


def bodies_contact_modes(problem: BodiesContactProblem) -> BodiesModeAnswer:
    """Return the verdict on all contacts of several bodies, and all consistent modes."""
    found = considered(partial(_case_within, problem))
    modes = shown_modes(found)
    seen = found.case.contacts if isinstance(found, Considered) else problem.contacts
    dynamics = _dynamics(problem, seen)
    return BodiesModeAnswer(
        modes=tuple(_with_bodies(dynamics, mode) for mode in modes),
        problem=problem,
        **answer_fields(found, problem.velocity_tolerance),
    )


def _with_bodies(dynamics: _Dynamics, mode: ResponseMode) -> BodiesMode:
    """Return a mode with the accelerations of the bodies that its forces cause."""
    pushed = dynamics.root @ (dynamics.root.T @ (dynamics.points.T @ mode.contact_forces_W.ravel()))
    motion = (dynamics.free + pushed).reshape(-1, 2, 3)
    of_contacts = {one.name: getattr(mode, one.name) for one in fields(mode)}
    return BodiesMode(accelerations_W=motion[:, 0], angular_accelerations_W=motion[:, 1], **of_contacts)


def _case_within(problem: BodiesContactProblem, within: float) -> SpatialCase | tuple[int, ...]:
    """Return the case, with contacts that are moved ``within`` so far to be flush (`problem.made_flush`)."""
    contacts = problem.contacts
    centre = np.mean([state.p_WB_W for state in problem.states], axis=0) if problem.states else np.zeros(3)
    flush = contacts if within == 0.0 else made_flush(contacts, centre, within)
    case = _case_of(problem, flush)
    if flush is contacts or not isinstance(case, SpatialCase):
        return case
    given = _case_of(problem, contacts)
    return case._replace(given=given) if isinstance(given, SpatialCase) else given


def _case_of(problem: BodiesContactProblem, contacts: ContactSet) -> SpatialCase | tuple[int, ...]:
    dynamics = _dynamics(problem, contacts)
    return response_case(
        contacts,
        dynamics.points @ dynamics.root,
        accelerations_W=dynamics.accelerations,
        velocities_W=dynamics.velocities,
        tolerance=problem.velocity_tolerance,
    )


def _dynamics(problem: BodiesContactProblem, contacts: ContactSet) -> _Dynamics:
    states, count, n = problem.states, len(problem.bodies), len(contacts)
    root, free = np.zeros((6 * count, 6 * count)), np.zeros(6 * count)
    # Motions of the first and of the second body of each contact, those of the world's surfaces included.
    velocities, turning, centripetal = np.zeros((3, 2, n, 3))
    for values, field_name in zip((velocities, turning, centripetal), contacts.SURFACE_MOTION, strict=True):
        given = getattr(contacts, field_name)
        values[1] = 0.0 if given is None else given
    for index, (body, state) in enumerate(zip(problem.bodies, states, strict=True)):
        own = slice(6 * index, 6 * index + 6)
        inertia = body.inertia_in_world(state.R_WB)
        touched = [
            (side, i) for i, pair in enumerate(problem.pairs) for side in (0, 1) if pair[side] == index
        ]
        arms = contacts.p_WC_W[[i for _, i in touched]] - state.p_WB_W
        w = state.w_WB_W
        if touched and np.linalg.norm(w) * reach_of(body, arms, contacts) <= problem.velocity_tolerance:
            w = np.zeros(3)
        moved, bent = state.velocity_of_point(state.p_WB_W + arms), np.cross(w, np.cross(w, arms))
        for (side, i), velocity, part in zip(touched, moved, bent, strict=True):
            velocities[side, i], turning[side, i], centripetal[side, i] = velocity, w, part
        inverse = inverse_mass_matrix(body.mass, inertia)
        load = np.concatenate([problem.forces_W[index], problem.torques_W[index] - np.cross(w, inertia @ w)])
        root[own, own] = np.linalg.cholesky(inverse)
        free[own] = inverse @ load
    points = pair_jacobians(states, contacts.p_WC_W, problem.pairs).reshape(3 * n, 6 * count)
    relative = velocities[0] - velocities[1]
    surfaces = replace(
        contacts,
        surface_velocities_W=velocities[1],
        surface_angular_velocities_W=turning[1],
        surface_accelerations_W=centripetal[1],
    )
    near = np.sum(contacts.normals_W * relative, axis=1) <= problem.velocity_tolerance
    sliding = sliding_of(contacts, relative, problem.velocity_tolerance)
    counted = np.where(near[:, None], sliding, relative)
    added = centripetal[0] + velocity_accelerations(surfaces, counted, turning[0])
    return _Dynamics(points, root, free, relative, (points @ free).reshape(-1, 3) + added)
