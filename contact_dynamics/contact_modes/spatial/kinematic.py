# SPDX-License-Identifier: Apache-2.0
"""Kinematics alone gives a body in space lecture 26's strings, with `c` where a contact stays.

The accelerations (a, alpha) that do not penetrate form a polyhedral cone in R^6, and each mode is one of its
faces: the contacts that stay are the rows that vanish on the face. Extreme rays span every face, so its
contacts that stay are the intersection of the sets of its rays. The modes are therefore all intersections of
the sets of rays, which are kept as the bits of integers. The rays are the facets of the convex hull of the
rows, seen from an inner point (Huang, Cheng and Mason, Efficient Contact Mode Enumeration in 3D, 2020). The
time grows in proportion to the number of modes.

A body that turns adds centripetal terms, and curved contacts add those of their kind (`contact.curvature`).
The polyhedron is then the section at height one of a cone in R^7.

This file does not say whether a contact that stays sticks or which way it slides, nor with which forces.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.velocities import check_speeds, velocity_accelerations
from contact_dynamics.contact_modes.letters import SEPARATES, STAYS
from contact_dynamics.contact_modes.spatial.cone import cone_of
from contact_dynamics.errors import TooLargeError
from contact_dynamics.tolerances import (
    ACCELERATION_TOLERANCE,
    NEARLY_PARALLEL,
    ROW_TOLERANCE,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

MAX_SPATIAL_CONTACTS: Final = 64
"""The longest list of contacts that is accepted. A cone in R^6 can have n^2 rays, and more faces than
that."""


def spatial_kinematic_modes(
    state: BodyState, contacts: ContactSet, *, velocity_tolerance: float = VELOCITY_TOLERANCE
) -> tuple[str, ...]:
    """Return every contacting/separating mode that some acceleration realises, in alphabetical order.

    A mode has one letter for each contact, in the contacts' order: `c` if it stays in contact, `s` if it
    separates. There are no modes where a contact approaches, and where every acceleration penetrates.

    Args:
        state: The state of the body, with its origin at the centre of mass.
        contacts: At most `MAX_SPATIAL_CONTACTS`.
        velocity_tolerance: m/s, >= 0. A contact's normal velocity within it counts as zero, and so does an
            angular velocity that moves no contact relative to the centre of mass by more than that.

    Raises:
        InvalidFieldError: the tolerance is negative.
        TooLargeError: more than `MAX_SPATIAL_CONTACTS` contacts.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    n = len(contacts)
    if n > MAX_SPATIAL_CONTACTS:
        raise TooLargeError("contacts", f"{n} contacts", f"at most {MAX_SPATIAL_CONTACTS}")
    check_speeds(state, contacts)
    velocities = state.velocity_of_point(contacts.p_WC_W)
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    if np.any(v_n < -tolerance):
        return ()
    touching = np.flatnonzero(v_n <= tolerance)
    if touching.size == 0:
        return (SEPARATES * n,)
    r_W = contacts.p_WC_W - state.p_WB_W
    rows = _contact_rows(r_W[touching], contacts.normals_W[touching])
    w_W = state.w_WB_W
    if float(np.linalg.norm(w_W)) * float(np.linalg.norm(r_W, axis=1).max()) <= tolerance:
        w_W = np.zeros(3)
    turning, rolling = np.cross(w_W, np.cross(w_W, r_W)), velocity_accelerations(contacts, velocities, w_W)
    offsets = np.sum(contacts.normals_W * (turning + rolling), axis=1)[touching]
    scale = float(np.abs(offsets).max())
    below = 0
    # Where a body rolls, the two cancel, and what remains is rounding.
    if scale > ACCELERATION_TOLERANCE * float(np.abs(turning).max() + np.abs(rolling).max()):
        below = 1 << touching.size
        rows = np.vstack(
            [np.column_stack([rows, offsets / scale]), np.eye(1, rows.shape[1] + 1, rows.shape[1])]
        )
    faces = cone_faces(rows / np.linalg.norm(rows, axis=1)[:, None])
    return tuple(sorted(_string(n, touching, face) for face in faces if not face & below))


def cone_faces(rows: FloatArray) -> set[int]:
    """Return the faces of {x : rows x >= 0} as the bit sets of the rows that vanish on them.

    Args:
        rows: Unit rows, (m, d).
    """
    everything = (1 << len(rows)) - 1
    cone = cone_of(rows)
    implied = everything & ~_mask(cone.strict)
    if not cone.strict.any():
        return {everything}
    heights = np.abs(cone.rays @ cone.rows.T)
    positions = [1 << int(i) for i in np.flatnonzero(cone.strict)]
    faces = {everything}
    for vanishing in np.unique(heights <= 10.0 * ROW_TOLERANCE, axis=0):
        ray = implied | sum(bit for bit, zero in zip(positions, vanishing, strict=True) if zero)
        faces |= {face & ray for face in faces}
    return faces


def faces_in_space(rows: FloatArray) -> set[int] | None:
    """Return the same for rows, (m, 3), that span all directions, or None if some rows are nearly parallel.

    Extreme rays are across two rows each, so that neither an inner point nor a convex hull is needed.
    """
    unit = rows / np.sqrt((rows * rows).sum(axis=1))[:, None]
    rays = np.cross(unit[:, None], unit[None]).reshape(-1, 3)
    sizes = np.sqrt((rays * rays).sum(axis=1))
    apart = sizes > ROW_TOLERANCE
    if sizes[apart].min() < NEARLY_PARALLEL:
        return None
    heights = (rays[apart] / sizes[apart, None]) @ unit.T
    faces = {(1 << len(rows)) - 1}
    zero = np.abs(heights) <= ROW_TOLERANCE
    for vanishing in np.unique(zero[heights.min(axis=1) >= -ROW_TOLERANCE], axis=0):
        ray = _mask(vanishing)
        faces |= {face & ray for face in faces}
    return faces


def _contact_rows(r_W: FloatArray, normals_W: FloatArray) -> FloatArray:
    """Return the row (n, r x n / reach) of each contact, (m, 6)."""
    reach = float(np.linalg.norm(r_W, axis=1).max())
    return np.hstack([normals_W, np.cross(r_W, normals_W) / (reach if reach > 0.0 else 1.0)])


def _mask(chosen: NDArray[np.bool_]) -> int:
    return sum(1 << int(i) for i in np.flatnonzero(chosen))


def _string(n: int, touching: NDArray[np.intp], face: int) -> str:
    letters = bytearray(SEPARATES.encode() * n)
    for position, contact in enumerate(touching.tolist()):
        if face >> position & 1:
            letters[contact] = ord(STAYS)
    return letters.decode()
