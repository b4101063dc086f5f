"""Contact modes of a body in space that are consistent with mechanics: separate, stick, or slide which way.

Model: as in the plane (lecture 26), with Coulomb's round cone. A contact that moves slides in a known
direction and has its exact friction. For one at rest the cone is a pyramid with a stated number of edges, the
first of which opposes the tangential acceleration that the contact would have without any contact force. On
the pyramid friction does the most it can against the sliding: a contact that slides within the sector
opposite to an edge has its force on that edge, one that slides on a sector's border has it on the side
between two edges. Letters are s (separates), f (sticks) and c (stays and slides); the sector or border
belongs to the mode. All of them are found (`spatial_search`); then friction is turned exactly against the
sliding where that has a solution (`spatial_sharpening`). A contact without friction is one letter, sliding or
not.

Does not cover: margins.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_curvature import velocity_accelerations
from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.contact_modes.spatial_forces import least_forces, misdirection
from contact_dynamics.contact_modes.spatial_letters import STRICT
from contact_dynamics.contact_modes.spatial_result import SpatialMode, SpatialModeAnswer
from contact_dynamics.contact_modes.spatial_search import Found, Search, Touching
from contact_dynamics.contact_modes.spatial_sharpening import Sliding, sharpened
from contact_dynamics.errors import TooLargeError
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import check_array, check_not_negative

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.contact import ContactSet
    from contact_dynamics.rigid_body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MOST_DYNAMIC_CONTACTS: Final = 32
"""Longest list of touching contacts accepted: a tenth of a second, more where many modes are consistent."""

FRICTION_FACETS: Final = 8
"""Edges of a friction pyramid where nothing else is asked for: it holds at least 92 % of the round cone's."""

_SAME: Final = 1e-6
"""Relative: how far the ends of what a mode allows may lie apart where it counts as unique."""


def spatial_contact_modes(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    force_W: ArrayLike,
    torque_W: ArrayLike = (0.0, 0.0, 0.0),
    friction_facets: int = FRICTION_FACETS,
    sharpen: bool = True,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> SpatialModeAnswer:
    """Return the verdict on a contact set in space and all consistent modes.

    Args:
        body: Mass and angular inertia.
        state: Of the body, with its origin at the centre of mass.
        contacts: Of any kind (`contact_curvature`); at most `MOST_DYNAMIC_CONTACTS` of them touching.
        force_W: (3,), N, applied to the body besides its contact forces, gravity included, world axes.
        torque_W: (3,), N m, applied about the centre of mass, world axes.
        friction_facets: Edges of the pyramid that stands for a friction cone at rest, >= 3.
        sharpen: Whether friction is then turned exactly against the sliding, in modes of unique motion where
            that has a solution (`spatial_sharpening`). Modes that become the same by it are one.
        velocity_tolerance: m/s, >= 0. A component of a contact's velocity within it counts as zero, and so
            does an angular velocity that moves no contact relative to the centre of mass by more than that.

    Raises:
        InvalidFieldError: a wrench that is not finite, a negative tolerance, too few facets.
        TooLargeError: more contacts touch than `MOST_DYNAMIC_CONTACTS`.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    force = check_array("force", force_W, (3,))
    torque = check_array("torque", torque_W, (3,))
    r_W = contacts.p_WC_W - state.p_WB_W
    velocities = state.velocity_of_point(contacts.p_WC_W)
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    approaching = tuple(int(i) for i in np.flatnonzero(v_n < -tolerance))
    modes: list[SpatialMode] = []
    examined = 0
    if not approaching:
        if int((v_n <= tolerance).sum()) > MOST_DYNAMIC_CONTACTS:
            raise TooLargeError("contacts", f"{len(v_n)} contacts", f"at most {MOST_DYNAMIC_CONTACTS}")
        sliding = velocities - v_n[:, None] * contacts.normals_W
        sliding[np.linalg.norm(sliding, axis=1) <= tolerance] = 0.0
        w = state.w_WB_W
        if len(r_W) > 0 and np.linalg.norm(w) * _reach(body, r_W, contacts) <= tolerance:
            w = np.zeros(3)
        motion = _Motion(
            body.mass,
            body.inertia_in_world(state.R_WB),
            r_W=r_W,
            w_W=w,
            wrench_W=np.concatenate([force, torque]),
            rolling_W=velocity_accelerations(contacts, sliding, w),
        )
        case = _Case(motion, contacts, sliding, np.flatnonzero(v_n <= tolerance))
        search = _search(case, friction_facets)
        modes = _distinct(_evidence(case, search, found, sharpen=sharpen) for found in search.run())
        examined = search.examined
    verdict = ModeVerdict.UNIQUE if len(modes) == 1 else ModeVerdict.INDETERMINATE
    if not modes:
        verdict = ModeVerdict.IMPACT if approaching else ModeVerdict.INCONSISTENT
    return SpatialModeAnswer(
        verdict=verdict,
        modes=tuple(modes),
        approaching=approaching,
        velocity_tolerance=tolerance,
        friction_facets=friction_facets,
        examined=examined,
    )


def _reach(body: MassProperties, r_W: FloatArray, contacts: ContactSet) -> float:
    """Return how far, m, an angular velocity counts: where sides are curved, the body's size too."""
    far = float(np.linalg.norm(r_W, axis=1).max())
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return far
    return far + math.sqrt(float(np.trace(body.I_B)) / body.mass)


class _Motion:
    """Accelerations of the body and of its contact points as affine functions of the contact forces."""

    def __init__(
        self,
        mass: float,
        inertia: FloatArray,
        *,
        r_W: FloatArray,
        w_W: FloatArray,
        wrench_W: FloatArray,
        rolling_W: FloatArray,
    ) -> None:
        n = len(r_W)
        # J maps (a, alpha) to the accelerations of the contact points, its transpose forces to wrenches.
        J = np.zeros((3 * n, 6))
        for i, (x, y, z) in enumerate(r_W):
            J[3 * i : 3 * i + 3, :3] = np.eye(3)
            J[3 * i : 3 * i + 3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
        inverse = np.zeros((6, 6))
        inverse[:3, :3] = np.eye(3) / mass
        inverse[3:, 3:] = np.linalg.inv(inertia)
        self.points = J
        # (n, 3), m/s^2, of the points without a and alpha, and of where contact goes over curved sides
        self.turning = np.cross(w_W, np.cross(w_W, r_W)) + rolling_W
        self.of_forces = inverse @ J.T  # (6, 3 n)
        self.wrench = wrench_W - np.concatenate([np.zeros(3), np.cross(w_W, inertia @ w_W)])
        self.free = inverse @ self.wrench
        self.points_free = (J @ self.free).reshape(-1, 3) + self.turning
        # In these units a motion is six accelerations, of which points of the body have about 1.
        reach = float(np.linalg.norm(r_W, axis=1).max(initial=0.0))
        self.lengths = np.array([1.0, 1.0, 1.0, *[reach if reach > 0.0 else 1.0] * 3])
        largest = max(
            float(np.abs(self.points_free).max(initial=0.0)),
            float(np.abs(self.free * self.lengths).max()),
        )
        self.scale = largest if largest > 0.0 else 1.0
        self.at_rest = not np.any(w_W)


class _Case(NamedTuple):
    motion: _Motion
    contacts: ContactSet
    sliding: FloatArray  # (n, 3), m/s, tangential velocities; zero: at rest
    touching: NDArray[np.intp]  # contacts that neither approach nor leave


def _search(case: _Case, facets: int) -> Search:
    """State the search in the motion's units."""
    motion, contacts, sliding, touching = case
    stated = []
    for i in touching.tolist():
        point = np.column_stack(
            [motion.points[3 * i : 3 * i + 3] / motion.lengths, motion.turning[i] / motion.scale]
        )
        stated.append(
            Touching(
                contacts.normals_W[i],
                float(contacts.frictions[i]),
                sliding=sliding[i],
                point=point,
                free=motion.points_free[i],
            )
        )
    power = motion.wrench / motion.lengths
    size = float(np.linalg.norm(power))
    at_rest = motion.at_rest and size > 0.0 and not np.any(sliding[touching])
    forces = (3 * touching[:, None] + np.arange(3)).ravel()
    return Search(
        stated,
        of_forces=motion.lengths[:, None] * motion.of_forces[:, forces],
        free=motion.free * motion.lengths / motion.scale,
        power=power / size if at_rest else None,
        facets=facets,
    )


def _evidence(case: _Case, search: Search, found: Found, *, sharpen: bool) -> SpatialMode:
    """Return a mode with accelerations and forces that realise it."""
    motion, contacts, sliding, touching = case
    count = search.edges.shape[1]
    shares = found.program.shares(count)
    mixture = np.random.default_rng(26).normal(size=(1, 6 + len(search.edges)))
    motion_unique, low, high = _ends(found, mixture[0, :6] @ search.motion[:, :-1])
    if not motion_unique and low is not None and high is not None:
        shares = 0.5 * (low + high)  # away from the borders of the mode
    forces_unique = _ends(found, mixture[0, 6:] @ search.edges)[0]
    own, acting = (search.edges @ shares).reshape(-1, 3), search.acting(found)
    if sharpen and motion_unique:
        own, acting = _sharpened(search, found, own, acting)
    if not forces_unique:
        own = least_forces(search.of_forces, own, acting)
    forces = np.zeros((len(contacts), 3))
    forces[touching] = own * motion.scale
    body = motion.free + motion.of_forces @ forces.ravel()
    points = (motion.points @ body).reshape(-1, 3) + motion.turning
    across = points - np.sum(points * contacts.normals_W, axis=1)[:, None] * contacts.normals_W
    letters = ["s"] * len(contacts)
    directions = np.zeros_like(points)
    for i, letter in zip(touching.tolist(), found.letters, strict=True):
        way = sliding[i] if np.any(sliding[i]) else across[i]
        size = float(np.linalg.norm(way))
        # Without friction one letter stands for both, and the acceleration says which it is.
        rests = letter.letter == "c" and not np.any(sliding[i]) and size <= STRICT * motion.scale
        letters[i] = "f" if rests else letter.letter
        if letters[i] == "c":
            directions[i] = way / size
    return SpatialMode(
        mode="".join(letters),
        acceleration_W=body[:3],
        angular_acceleration_W=body[3:],
        contact_forces_W=forces,
        contact_accelerations_W=points,
        tangential_directions_W=directions,
        misdirection=misdirection(forces, directions, contacts.normals_W),
        forces_unique=forces_unique,
        motion_unique=motion_unique or forces_unique,
    )


def _sharpened(
    search: Search, found: Found, forces: FloatArray, acting: list[FloatArray]
) -> tuple[FloatArray, list[FloatArray]]:
    """Return forces, and the edges that may act, with friction exactly against the sliding if that can be."""
    letters = "".join(one.letter for one in found.letters)
    if all(one.item < 0 for one in found.letters):
        return forces, acting
    mode = Sliding(search.touching, search.pyramids, letters, search.of_forces, search.motion[:, -1])
    exact = sharpened(mode, forces)
    return (forces, acting) if exact is None else (exact.forces, exact.edges)


def _distinct(modes: Iterable[SpatialMode]) -> list[SpatialMode]:
    """Return modes without those that have another's letters and its motion, if unique."""
    found: list[SpatialMode] = []
    for mode in modes:
        own = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
        alike = [other for other in found if other.mode == mode.mode and other.motion_unique]
        others = [np.concatenate([one.acceleration_W, one.angular_acceleration_W]) for one in alike]
        near = _SAME * (1.0 + float(np.abs(own).max()))
        if not mode.motion_unique or all(np.abs(own - other).max() > near for other in others):
            found.append(mode)
    return found


def _ends(found: Found, weights: FloatArray) -> tuple[bool, FloatArray | None, FloatArray | None]:
    """Return whether a combination of edge forces is the same for all that the mode allows, and its ends."""
    ends = found.program.spread(weights)
    if ends is None:
        return False, None, None
    low, high = float(weights @ ends[0]), float(weights @ ends[1])
    return high - low <= _SAME * (1.0 + abs(low)), ends[0], ends[1]
