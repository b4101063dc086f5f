# SPDX-License-Identifier: Apache-2.0
"""A question about contact modes in space, and its case: the question in the units of the computation.

Accelerations of the body and of its contact points are affine functions of the contact forces. The units are
such that accelerations of contact points are about 1, so that one tolerance serves all.

Contacts that are flush but for noise are made exactly flush. Where normals, or places, are nearly the same,
rounding or noise decides how contacts share a load and which of them leave first, and proofs hang on
differences that nobody can measure. So modes are sought for contacts that lie within a small tolerance of the
given ones. Normals and places are stated in axes along two of the normals. Coordinates along one axis that
agree within the tolerance, up to their signs, become one, and those that vanish within it become zero. So
normals that are nearly parallel, opposite or at right angles, and points that are nearly in one plane, become
so exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.found import find_contacts
from contact_dynamics.contact.friction import check_facets
from contact_dynamics.contact.pairs import check_with_world
from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact.velocities import (
    check_speeds,
    relative_velocities,
    velocity_accelerations,
    warn_if_far,
)
from contact_dynamics.contact_modes.letters import SEPARATES
from contact_dynamics.contact_modes.spatial.options import Touching
from contact_dynamics.contact_modes.spatial.search import Search
from contact_dynamics.errors import InvalidFieldError, NoContactError, TooLargeError
from contact_dynamics.numerics.vectors import point_jacobians, tangents_towards
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import inverse_mass_matrix
from contact_dynamics.tolerances import (
    DISTANCE_TOLERANCE,
    FEASIBLE,
    FLUSH_ROUNDING,
    LARGEST_NUMBER,
    OUT_OF_PLANE_RATIO,
    SAME_DIRECTION,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import check_not_negative, check_vector3
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

MAX_EDGES: Final = 128
"""The largest number of edges of all friction pyramids together. Their cone in R^6 has thousands of
facets."""

MAX_DYNAMIC_CONTACTS: Final = 32
"""The largest number of touching contacts that is accepted. They take a tenth of a second, or two seconds
where many modes are consistent."""

FRICTION_FACETS: Final = 8
"""The number of edges of a friction pyramid, unless another number is asked for. The pyramid allows at least
92 % of the round cone's friction."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialContactProblem(Record):
    """Spatial (3-D) contact problem of one body. The planar counterpart is `PlanarContactProblem`.

    ``SpatialContactProblem.of(body, state, world, force_W=push)`` detects the contacts and adds the weight;
    the help of `contact_modes` contains an example.

    Modes, margins and the reasons for rejected modes are those of round friction cones, regardless of the
    number of facets. In statics and wrench sets, pyramids approximate the cones of contacts at rest. With the
    default 8 facets, the largest disturbance that a body withstands is underestimated by 8 % of friction, 1 -
    cos(pi / facets), and with 16 facets by 2 %. The number of wrench sets grows with the square or cube of
    the facets: a box on four feet has about 200 to 350 sets with 4 facets and 1300 with 8, so use 4 facets
    for wrench sets (`dataclasses.replace`). Statics support 128 edges in total.

    Attributes:
        body: A `Body`, or its `MassProperties`, which are stored.
        state: State of the body, with its origin at the centre of mass.
        contacts: Contacts of any kind, of which at most `MAX_DYNAMIC_CONTACTS` touch.
        force_W: (3,), N, applied force, including gravity but not contact forces, world axes.
        torque_W: (3,), N m, applied torque about the centre of mass, without that of contact forces, world
            axes. The default is zero.
        friction_facets: Number of edges of the pyramid that approximates a friction cone, >= 3, in statics
            and wrench sets, and in the modes if ``sharpen`` is false.
        sharpen: Whether the modes are those of round cones, with friction exactly opposite to sliding. Modes
            with the same letters are then merged if their motion is the same, or if one of them has no unique
            motion. If false, each sector of the pyramids is a separate mode, and there can be hundreds if the
            motion on many feet is not unique. Margins always refer to the sharpened modes.
        velocity_tolerance: m/s, >= 0. Components of a contact's velocity up to this size count as zero, and
            so does an angular velocity that moves no contact relative to the centre of mass by more.
        uncertainty: Errors of the contacts. If they are not exact, the answer also lists the verdicts that
            occur within these errors.

    Raises:
        InvalidFieldError: a number is not finite or beyond `LARGEST_NUMBER`, the tolerance is negative, the
            number of facets is not from 3 to 1000, or the uncertainty has another number of contacts.
    """

    body: MassProperties = field(metadata={"accepts": "HasMassProperties"})
    state: BodyState
    contacts: ContactSet
    force_W: FloatArray
    torque_W: FloatArray = field(default_factory=lambda: np.zeros(3))
    friction_facets: int = FRICTION_FACETS
    sharpen: bool = True
    velocity_tolerance: float = VELOCITY_TOLERANCE
    uncertainty: ContactUncertainty = EXACT_CONTACTS

    if TYPE_CHECKING:  # what the constructor takes, beside what the fields then hold

        def __init__(
            self,
            *,
            body: HasMassProperties,
            state: BodyState,
            contacts: ContactSet,
            force_W: ArrayLike,
            torque_W: ArrayLike = (0.0, 0.0, 0.0),
            friction_facets: int = FRICTION_FACETS,
            sharpen: bool = True,
            velocity_tolerance: float = VELOCITY_TOLERANCE,
            uncertainty: ContactUncertainty = EXACT_CONTACTS,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Take the mass properties of a body. Check the wrench, the facets and the tolerance."""
        check_speeds(self.state, self.contacts.p_WC_W)
        check_with_world("contacts", self.contacts.surfaces)
        warn_if_far(self.body, self.state, self.contacts.p_WC_W)
        object.__setattr__(self, "body", self.body.mass_properties)
        object.__setattr__(self, "force_W", check_vector3("force_W", self.force_W))
        object.__setattr__(self, "torque_W", check_vector3("torque_W", self.torque_W))
        tolerance = check_not_negative("velocity_tolerance", self.velocity_tolerance)
        object.__setattr__(self, "velocity_tolerance", tolerance)
        object.__setattr__(self, "friction_facets", check_facets(self.friction_facets))
        self.uncertainty.check_count(len(self.contacts))

    @classmethod
    @checks_types
    def of(
        cls,
        body: Body,
        state: BodyState,
        world: World,
        *,
        force_W: ArrayLike | None = None,
        torque_W: ArrayLike = (0.0, 0.0, 0.0),
        at_W: ArrayLike | None = None,
        distance_tolerance: float = DISTANCE_TOLERANCE,
    ) -> SpatialContactProblem:
        """Return the problem of a body that touches the world, under its weight and an additional load.

        Args:
            body: Body with a shape.
            state: State of the body. Contacts are detected as by `find_contacts`.
            world: Surfaces, which may move, and gravity.
            force_W: (3,), N, force of the load, without gravity, world axes, or None for no force.
            torque_W: (3,), N m, torque of the load about the centre of mass, in addition to that of the
                force, world axes.
            at_W: (3,), m, point at which the force acts, world axes, or None for the centre of mass.
            distance_tolerance: m, >= 0, as in `find_contacts`.

        Raises:
            NoContactError: the body has no shape, or touches nothing.
            InvalidFieldError: `find_contacts` rejects an argument, a number is not finite, or ``at_W`` is
                given without a force.
        """
        contacts = find_contacts(body, state, world, distance_tolerance=distance_tolerance)
        if len(contacts) == 0:
            message = f"state: no point of {body.name!r} is within {distance_tolerance:g} m of a surface"
            raise NoContactError(message)
        push, torque = load_at(check_vector3, state.p_WB_W, force_W=force_W, torque_W=torque_W, at_W=at_W)
        weight = body.mass_properties.mass * world.gravity_W
        return cls(body=body, state=state, contacts=contacts, force_W=weight + push, torque_W=torque)

    @property
    def wrench_W(self) -> FloatArray:
        """Return the applied force, N, and torque, N m, (6,)."""
        return np.concatenate([self.force_W, self.torque_W])


def load_at(
    checked: Callable[[str, ArrayLike], FloatArray],
    p_WB_W: FloatArray,
    *,
    force_W: ArrayLike | None,
    torque_W: ArrayLike,
    at_W: ArrayLike | None,
) -> tuple[FloatArray, FloatArray]:
    """Return the force, N, and the torque, N m, about centres of mass, (..., 3), of a load at a point.

    Raises:
        InvalidFieldError: a number is not finite, or a point is given without a force.
    """
    force = checked("force_W", (0.0, 0.0, 0.0) if force_W is None else force_W)
    torque = checked("torque_W", torque_W)
    if at_W is None:
        return force, torque
    if force_W is None:
        raise InvalidFieldError("at_W", at_W, "left out unless force_W is given")
    return force, torque + np.cross(checked("at_W", at_W) - p_WB_W, force)


@dataclass(slots=True, kw_only=True)
class AccelerationMap:
    """Motions of a body or mechanism, and of its contact points, as affine functions of contact forces."""

    points: FloatArray  # (3 n, d), the accelerations of the contact points on unit motions
    turning: FloatArray  # (n, 3), m/s^2, the part of these that no motion causes
    of_forces: FloatArray  # (d, 3 n), the motions on unit forces
    free: FloatArray  # (d,), the motion without contact forces
    inertia: FloatArray  # (d, d), the wrenches that unit motions need
    wrench: FloatArray  # (d,), that of the motion without contact forces
    mass: float  # kg, which makes forces of accelerations
    lengths: (
        FloatArray  # (d,), by which a motion is multiplied, so that points of the body have about as much
    )
    at_rest: bool  # whether nothing moves
    of_body: bool  # whether motions are those of one body, linear and angular accelerations
    points_free: FloatArray = field(init=False)  # (n, 3), m/s^2, of the contact points without contact forces
    scale: float = field(init=False)  # the largest acceleration, the unit of motions

    def __post_init__(self) -> None:
        """Find the accelerations without contact forces."""
        self.points_free = (self.points @ self.free).reshape(-1, 3) + self.turning
        largest = max(
            float(np.abs(self.points_free).max(initial=0.0)),
            float(np.abs(self.free * self.lengths).max(initial=0.0)),
        )
        self.scale = largest if largest > 0.0 else 1.0

    def motion(self, forces: FloatArray) -> FloatArray:
        """Return the motion, (d,), under contact forces, (n, 3), N."""
        found: FloatArray = self.free + self.of_forces @ forces.ravel()
        return found

    def accelerations(self, motion: FloatArray) -> FloatArray:
        """Return the accelerations, (n, 3), m/s^2, of the contact points in a motion, (d,)."""
        found: FloatArray = (self.points @ motion).reshape(-1, 3) + self.turning
        return found


class SpatialCase(NamedTuple):
    """A body, or a mechanism, with its contacts, none of which approaches."""

    motion: AccelerationMap
    contacts: ContactSet
    sliding: FloatArray  # (n, 3), m/s, tangential velocities on the surfaces; zero for a contact at rest
    touching: NDArray[np.intp]  # the numbers of the contacts that neither approach nor leave
    given: SpatialCase | None = None  # that of the contacts as they were given, or None if these are flush

    def of_all(self, letters: Iterable[str]) -> str:
        """Return one letter for each contact from those of the touching contacts. The others separate."""
        every = [SEPARATES] * len(self.contacts)
        for i, letter in zip(self.touching.tolist(), letters, strict=True):
            every[i] = letter
        return "".join(every)

    def of_touching(self, letters: str) -> str:
        """Return the letters of the touching contacts from those of all."""
        return "".join(letters[i] for i in self.touching.tolist())

    def own_forces(self, forces_W: FloatArray) -> FloatArray:
        """Return the forces of the touching contacts in the units of the motion."""
        own: FloatArray = forces_W[self.touching] / self.motion.scale
        return own


def spatial_case(problem: SpatialContactProblem, *, within: float = 0.0) -> SpatialCase | tuple[int, ...]:
    """Return the case, with contacts moved ``within`` so far to be flush, or the contacts that approach."""
    state, contacts, tolerance = problem.state, problem.contacts, problem.velocity_tolerance
    velocities = relative_velocities(state, contacts)
    touching = touching_of(contacts, velocities, tolerance)
    if isinstance(touching, tuple):
        return touching
    flush = contacts if within == 0.0 else made_flush(contacts, state.p_WB_W, within)
    given = None if flush is contacts else _case_of(problem, contacts, velocities, touching)
    return _case_of(problem, flush, velocities, touching)._replace(given=given)


def touching_of(
    contacts: ContactSet, velocities: FloatArray, tolerance: float
) -> NDArray[np.intp] | tuple[int, ...]:
    """Return the contacts that neither approach nor leave, or a tuple of those that approach.

    Raise `TooLargeError` if more touch than `MAX_DYNAMIC_CONTACTS`. Velocities are relative to the surfaces.
    """
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    if np.any(v_n < -tolerance):
        return tuple(int(i) for i in np.flatnonzero(v_n < -tolerance))
    touching = np.flatnonzero(v_n <= tolerance)
    if len(touching) > MAX_DYNAMIC_CONTACTS:
        raise TooLargeError("contacts", f"{len(touching)} contacts", f"at most {MAX_DYNAMIC_CONTACTS}")
    return touching


def sliding_of(contacts: ContactSet, velocities: FloatArray, tolerance: float) -> FloatArray:
    """Return the tangential parts of velocities, (n, 3), m/s, which are zero up to a tolerance."""
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    sliding: FloatArray = velocities - v_n[:, None] * contacts.normals_W
    sliding[np.linalg.norm(sliding, axis=1) <= tolerance] = 0.0
    return sliding


def _case_of(
    problem: SpatialContactProblem, contacts: ContactSet, velocities: FloatArray, touching: NDArray[np.intp]
) -> SpatialCase:
    """Return the case of contacts whose points have given velocities, (n, 3), relative to the surfaces."""
    body, state, tolerance = problem.body, problem.state, problem.velocity_tolerance
    r_W = contacts.p_WC_W - state.p_WB_W
    sliding = sliding_of(contacts, velocities, tolerance)
    w = state.w_WB_W
    if len(r_W) > 0 and np.linalg.norm(w) * reach_of(body, r_W, contacts) <= tolerance:
        w = np.zeros(3)
    relative = sliding
    if contacts.surfaces_move:  # where contacts leave, normal parts count too
        relative = velocities.copy()
        relative[touching] = sliding[touching]
    rolling = velocity_accelerations(contacts, relative, w)
    # Contacts that were made flush have the velocities of the given points, and so their accelerations.
    arms = problem.contacts.p_WC_W - state.p_WB_W
    inertia_W, J = body.inertia_in_world(state.R_WB), point_jacobians(r_W).reshape(-1, 6)
    inverse = inverse_mass_matrix(body.mass, inertia_W)
    wrench = problem.wrench_W
    if np.any(w):
        wrench = wrench - np.concatenate([np.zeros(3), np.cross(w, inertia_W @ w)])
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = body.mass * np.eye(3)
    inertia[3:, 3:] = inertia_W
    reach = float(np.linalg.norm(r_W, axis=1).max(initial=0.0))
    motion = AccelerationMap(
        points=J,
        of_forces=inverse @ J.T,
        free=inverse @ wrench,
        turning=np.cross(w, np.cross(w, arms)) + rolling if np.any(w) else rolling,
        inertia=inertia,
        wrench=wrench,
        mass=body.mass,
        lengths=np.array([1.0, 1.0, 1.0, *[reach if reach > 0.0 else 1.0] * 3]),
        at_rest=not (np.any(w) or (contacts.surfaces_move and np.any(rolling[touching]))),
        of_body=True,
    )
    return SpatialCase(motion, contacts, sliding, touching)


def search_of(case: SpatialCase, facets: int, *, from_rest: bool = False) -> Search:
    """Return the search for the modes of a case, in the motion's units.

    If ``from_rest``, one body that turns about contacts at rest is seen as one at rest. Its points there all
    have the same centripetal acceleration. With that taken from the acceleration of the mass centre, it moves
    from rest under another load, and the motion of the search is not the case's.
    """
    motion, contacts, sliding, touching, _ = case
    turning, free = motion.turning[touching], motion.free
    at_rest = motion.at_rest and not np.any(sliding[touching])
    if from_rest and np.any(turning) and not np.any(sliding[touching]):
        mean = turning.mean(axis=0)
        if np.abs(turning - mean).max() <= FEASIBLE * motion.scale:
            turning, free, at_rest = np.zeros_like(turning), free + np.append(mean, np.zeros(3)), True
    stated = []
    for i, constant in zip(touching.tolist(), turning, strict=True):
        point = np.column_stack([motion.points[3 * i : 3 * i + 3] / motion.lengths, constant / motion.scale])
        stated.append(
            Touching(
                contacts.normals_W[i],
                min(float(contacts.frictions[i]), LARGEST_NUMBER),
                sliding=sliding[i],
                point=point,
                free=motion.points_free[i],
                holding=min(float(contacts.holding_frictions[i]), LARGEST_NUMBER),
            )
        )
    forces = (3 * touching[:, None] + np.arange(3)).ravel()
    return Search(
        stated,
        of_forces=motion.lengths[:, None] * motion.of_forces[:, forces],
        free=free * motion.lengths / motion.scale,
        mass=motion.inertia / np.outer(motion.lengths, motion.lengths),
        at_rest=at_rest,
        facets=facets,
    )


def reach_of(body: MassProperties, r_W: FloatArray, contacts: ContactSet) -> float:
    """Return the length, m, by which an angular velocity counts, for curved sides with the body's size."""
    far = float(np.linalg.norm(r_W, axis=1).max())
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return far
    return far + math.sqrt(float(np.trace(body.I_B)) / body.mass)


_ALONG: Final = 0.9
"""A cosine. The component of a normal along an axis counts as close to 1 if it is larger."""

_MOVED: Final = 0.75
"""The share of contacts that are not flush if noise is the reason. By luck one of them may be."""


def made_flush(contacts: ContactSet, centre: FloatArray, within: float) -> ContactSet:
    """Return contacts within a tolerance of the given ones that are flush; the given ones if those are.

    Noise moves them all. Where fewer are not flush, chance made their coordinates nearly the same, and they
    stay as they are. Normals may turn by ``within`` rad, and points move by this share of the reach.
    """
    if len(contacts) < 2:
        return contacts
    normals, arms = contacts.normals_W, contacts.p_WC_W - centre
    axes = _axes(normals)
    reach = float(np.sqrt((arms * arms).sum(axis=1).max()))
    places = (arms / (reach if reach > 0.0 else 1.0)) @ axes.T
    leaning = normals @ axes.T
    apart = np.diff(np.sort(np.abs(np.hstack([leaning, places])), axis=0), axis=0, prepend=0.0)
    if not np.any((apart > FLUSH_ROUNDING) & (apart <= within)):
        return contacts
    flush_normals, flush_places = (
        np.column_stack([_gathered(along, within) for along in of.T]) for of in (leaning, places)
    )
    # The component along an axis that a normal hardly leans from follows from the others.
    squares = np.where(np.abs(leaning) > _ALONG, 0.0, flush_normals * flush_normals)
    along = np.sqrt(np.maximum(1.0 - squares.sum(axis=1), 0.0))[:, None]
    flush_normals = np.where(np.abs(leaning) > _ALONG, np.copysign(along, leaning), flush_normals)
    flush_normals /= np.sqrt((flush_normals * flush_normals).sum(axis=1))[:, None]
    moved = np.maximum(np.abs(flush_normals - leaning), np.abs(flush_places - places)).max(axis=1)
    if not np.count_nonzero(moved > FLUSH_ROUNDING) >= _MOVED * len(contacts):
        return contacts
    return replace(contacts, p_WC_W=centre + reach * (flush_places @ axes), normals_W=flush_normals @ axes)


def _axes(normals: FloatArray) -> FloatArray:
    """Return orthonormal axes, (3, 3), the first two of them along frequent normals if there are two."""
    one = _most_frequent(normals, np.ones(len(normals), dtype=bool))
    across = normals - (normals @ one)[:, None] * one
    leaning = np.sqrt((across * across).sum(axis=1))
    apart = leaning > OUT_OF_PLANE_RATIO
    if not apart.any():
        return np.array([one, *tangents_towards(one)])
    two = _most_frequent(across / np.where(apart, leaning, 1.0)[:, None], apart)
    two = two - (two @ one) * one
    two /= np.sqrt(two @ two)
    return np.array([one, two, np.cross(one, two)])


def _most_frequent(units: FloatArray, among: np.ndarray) -> FloatArray:
    """Return the mean of the most frequent unit vector, (3,), where opposite ones count as the same."""
    cosines = units @ units.T
    alike = (np.abs(cosines) >= 1.0 - SAME_DIRECTION) & among
    first = int((alike.sum(axis=1) * among).argmax())
    found: FloatArray = (np.sign(cosines[first]) * alike[first]) @ units
    return found / np.sqrt(found @ found)


def _gathered(values: FloatArray, within: float) -> FloatArray:
    """Return values of which those that agree in size, to a tolerance, are one, and zero if they vanish."""
    sizes = np.abs(values)
    order = sizes.argsort()
    ranked = sizes[order]
    groups = np.concatenate([[0], (np.diff(ranked) > within).cumsum()])
    counts = np.bincount(groups)
    means = np.bincount(groups, weights=ranked) / counts
    least = ranked[np.concatenate([[0], counts.cumsum()[:-1]])]
    means[least <= within] = 0.0
    gathered = means[groups]
    off = np.abs(gathered - ranked) > within  # a long row of neighbours stays as it is
    if off.any():
        spoilt = np.isin(groups, groups[off])
        gathered[spoilt] = ranked[spoilt]
    found = np.empty_like(sizes)
    found[order] = gathered
    return np.copysign(found, values)
