# SPDX-License-Identifier: Apache-2.0
"""Contact modes of a mechanism, of which W = J M^-1 J^T is known: how its contact points respond to forces.

Under contact forces f, the points have the accelerations W f + b. Any factor of W = L L^T is the Jacobian of
a mechanism with unit mass that responds alike. Its motion has as many components as W has rank, and its
case is searched as that of one body (`answer`).

What b has along the columns of L is the motion without contact forces. If nothing else remains at contacts
that touch, and none of them slides, the mechanism is as one at rest, whatever causes b: for example, bodies
at rest on a tray that accelerates, under inertial forces.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.velocities import velocity_accelerations
from contact_dynamics.contact_modes.result import ResponseModeAnswer
from contact_dynamics.contact_modes.spatial.answer import answer_fields, considered, shown_modes
from contact_dynamics.contact_modes.spatial.problem import (
    AccelerationMap,
    SpatialCase,
    sliding_of,
    touching_of,
)
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import Record
from contact_dynamics.tolerances import (
    LARGEST_NUMBER,
    ROW_TOLERANCE,
    SINGULAR_RESPONSE,
    SYMMETRY_TOLERANCE,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import check_array, check_magnitude, check_not_negative, check_vector3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
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
    """Return the verdict on the contacts of a mechanism and all consistent modes.

    Raises:
        TooLargeError: as for `answer.spatial_contact_modes`.
    """
    sizes, axes = np.linalg.eigh(problem.inverse_inertia_W)
    seen = sizes > SINGULAR_RESPONSE * sizes.max(initial=0.0)
    contacts, velocities = _on_surfaces(problem)
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

    Args:
        contacts: Its n contacts.
        factor: (3 n, d), a factor L of W = L L^T.
        accelerations_W: (n, 3), m/s^2, those of the contact points without contact forces, relative to the
            surfaces.
        velocities_W: (n, 3), m/s, those of the contact points, relative to the surfaces.
        tolerance: m/s, >= 0. Velocities up to this size count as zero.

    Raises:
        TooLargeError: more contacts touch than `MAX_DYNAMIC_CONTACTS`.
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
        points,
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


def _on_surfaces(problem: ResponseContactProblem) -> tuple[ContactSet, FloatArray]:
    """Return the contacts without curvatures, and their velocities, (n, 3), relative to the surfaces."""
    contacts, velocities = problem.contacts, problem.velocities_W
    if contacts.surface_velocities_W is not None:
        velocities = velocities - contacts.surface_velocities_W
    return replace(contacts, body_curvatures=None, surface_curvatures=None), velocities
