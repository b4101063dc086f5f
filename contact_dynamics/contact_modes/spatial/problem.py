"""A question about contact modes in space, in the terms that it is answered in.

Accelerations of the body and of its contact points are affine functions of the contact forces. They are
stated in units in which those of contact points are about 1, so that one tolerance serves all.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.kinds import velocity_accelerations
from contact_dynamics.contact_modes.spatial.search import Search, Touching
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.vectors import point_jacobians
from contact_dynamics.rigid_body.body import inverse_mass_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MOST_DYNAMIC_CONTACTS: Final = 32
"""Longest list of touching contacts accepted: a tenth of a second, two where many modes are consistent."""


class AccelerationMap:
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
        # J maps (a, alpha) to the accelerations of the contact points, its transpose forces to wrenches.
        J = point_jacobians(r_W).reshape(-1, 6)
        inverse = inverse_mass_matrix(mass, inertia)
        self.mass = mass
        self.inertia = inertia
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


class SpatialCase(NamedTuple):
    """A body with its contacts, none of which approaches."""

    motion: AccelerationMap
    contacts: ContactSet
    sliding: FloatArray  # (n, 3), m/s, tangential velocities; zero: at rest
    touching: NDArray[np.intp]  # contacts that neither approach nor leave


def spatial_case(
    body: MassProperties, state: BodyState, contacts: ContactSet, wrench_W: FloatArray, tolerance: float
) -> SpatialCase | tuple[int, ...]:
    """Return the case, or the contacts that approach.

    Args:
        body: Mass and angular inertia.
        state: Of the body, with its origin at the centre of mass.
        contacts: Of any kind.
        wrench_W: (6,), applied force and torque, world axes.
        tolerance: m/s, within which velocities count as zero.

    Raises:
        TooLargeError: more contacts touch than `MOST_DYNAMIC_CONTACTS`.
    """
    r_W = contacts.p_WC_W - state.p_WB_W
    velocities = state.velocity_of_point(contacts.p_WC_W)
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    if np.any(v_n < -tolerance):
        return tuple(int(i) for i in np.flatnonzero(v_n < -tolerance))
    touching = np.flatnonzero(v_n <= tolerance)
    if len(touching) > MOST_DYNAMIC_CONTACTS:
        raise TooLargeError("contacts", f"{len(touching)} contacts", f"at most {MOST_DYNAMIC_CONTACTS}")
    sliding = velocities - v_n[:, None] * contacts.normals_W
    sliding[np.linalg.norm(sliding, axis=1) <= tolerance] = 0.0
    w = state.w_WB_W
    if len(r_W) > 0 and np.linalg.norm(w) * _reach(body, r_W, contacts) <= tolerance:
        w = np.zeros(3)
    motion = AccelerationMap(
        body.mass,
        body.inertia_in_world(state.R_WB),
        r_W=r_W,
        w_W=w,
        wrench_W=wrench_W,
        rolling_W=velocity_accelerations(contacts, sliding, w),
    )
    return SpatialCase(motion, contacts, sliding, touching)


def search_of(case: SpatialCase, facets: int) -> Search:
    """Return the search for the modes of a case, in the motion's units."""
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
    mass = np.zeros((6, 6))
    mass[:3, :3] = motion.mass * np.eye(3)
    mass[3:, 3:] = motion.inertia / motion.lengths[3] ** 2
    forces = (3 * touching[:, None] + np.arange(3)).ravel()
    return Search(
        stated,
        of_forces=motion.lengths[:, None] * motion.of_forces[:, forces],
        free=motion.free * motion.lengths / motion.scale,
        mass=mass,
        at_rest=motion.at_rest and not np.any(sliding[touching]),
        facets=facets,
    )


def _reach(body: MassProperties, r_W: FloatArray, contacts: ContactSet) -> float:
    """Return how far, m, an angular velocity counts: where sides are curved, the body's size too."""
    far = float(np.linalg.norm(r_W, axis=1).max())
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return far
    return far + math.sqrt(float(np.trace(body.I_B)) / body.mass)
