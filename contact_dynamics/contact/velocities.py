# SPDX-License-Identifier: Apache-2.0
"""What a body's state says of its contacts in space: which are at rest, and which the body cannot have.

Velocities also add to the accelerations of contacts, by the terms of their kind (`curvature`).
"""

from __future__ import annotations

import math
import warnings
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.curvature import least_and_most, rolling, side_of
from contact_dynamics.errors import FarContactWarning, frames_to_caller
from contact_dynamics.numerics.vectors import tangent_rows
from contact_dynamics.tolerances import FAR_CONTACT, VELOCITY_TOLERANCE
from contact_dynamics.validation import FloatArray, check_magnitude, check_not_negative
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties
    from contact_dynamics.shapes.convex import ConvexShape


def spatial_contact_velocities(
    state: BodyState, contacts: ContactSet, *, velocity_tolerance: float = VELOCITY_TOLERANCE
) -> FloatArray:
    """Return the velocities of the body's contact points relative to their surfaces, (n, 3), m/s, world axes.

    Normal and tangential components up to ``velocity_tolerance``, m/s, are exactly 0.

    Raises:
        InvalidFieldError: the tolerance is negative, or a velocity or the distance of a contact from the
            centre of mass exceeds `LARGEST_NUMBER`.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    check_speeds(state, contacts.p_WC_W)
    velocities = relative_velocities(state, contacts)
    along = np.einsum("ij,ij->i", velocities, contacts.normals_W)
    across = velocities - along[:, None] * contacts.normals_W
    along[np.abs(along) <= tolerance] = 0.0
    across[np.linalg.norm(across, axis=1) <= tolerance] = 0.0
    cleaned: FloatArray = across + along[:, None] * contacts.normals_W
    return cleaned


def relative_velocities(state: BodyState, contacts: ContactSet) -> FloatArray:
    """Return the velocities of the body's contact points relative to their surfaces, (n, 3), m/s."""
    velocities = state.velocity_of_point(contacts.p_WC_W)
    return velocities if contacts.surface_velocities_W is None else velocities - contacts.surface_velocities_W


def velocity_accelerations(contacts: ContactSet, velocities_W: FloatArray, w_W: FloatArray) -> FloatArray:
    """Return what velocities add to the accelerations of the body's points at contacts, (n, 3), m/s^2.

    With them, the acceleration along the normal is the gap's second derivative. At a contact at rest, the
    tangential acceleration is the rate of its sliding velocity. A surface that moves adds what makes the
    acceleration relative to it: -a_S - 2 W x v, where v is the relative velocity.
    Velocities, m/s, are those of the body's points relative to the surfaces, of which curved sides do not use
    the normal parts, and ``w_W``, rad/s, is that of the body.
    """
    added = np.zeros((len(contacts), 3))
    turning_W = np.broadcast_to(w_W, added.shape)
    if contacts.surface_accelerations_W is not None:
        added -= contacts.surface_accelerations_W
    if contacts.surface_angular_velocities_W is not None:
        turning_W = w_W - contacts.surface_angular_velocities_W
        added -= 2.0 * np.cross(contacts.surface_angular_velocities_W, velocities_W)
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return added
    n = len(contacts)
    mine = least_and_most(contacts.body_curvatures, n, math.inf)
    theirs = least_and_most(contacts.surface_curvatures, n, 0.0)
    for i in np.flatnonzero(np.isfinite(mine[0]) | (theirs != 0.0).any(axis=0)).tolist():  # not point on flat
        normal = contacts.normals_W[i]
        frame = tangent_rows(normal)
        m = frame @ np.cross(normal, turning_W[i])
        v = frame @ velocities_W[i]
        found = rolling(
            side_of(contacts.body_curvatures, i, frame, math.inf),
            side_of(contacts.surface_curvatures, i, frame, 0.0),
            (float(m[0]), float(m[1])),
            (float(v[0]), float(v[1])),
        )
        if found is not None:  # which `check_pairs` has made sure of
            eta_W = np.array(found.eta) @ frame
            added[i] += found.gap * normal + float(normal @ turning_W[i]) * np.cross(normal, eta_W)
    return added


def check_speeds(state: BodyState, points_W: FloatArray) -> None:
    """Refuse velocities, and distances of contacts from the centre of mass, beyond `LARGEST_NUMBER`."""
    check_magnitude("v_WB_W", state.v_WB_W)
    check_magnitude("w_WB_W", state.w_WB_W)
    check_magnitude("p_WC_W", points_W - state.p_WB_W)


def warn_if_far(body: HasMassProperties, state: BodyState, points_W: FloatArray) -> None:
    """Warn of contact points, (3,) or (n, 3), m, world axes, out of reach of a `Body` that has a shape."""
    if not isinstance(body, Body) or body.shape.is_empty:
        return
    reach = _reach(body.shape)
    numbers = iter((points_W - state.p_WB_W).ravel().tolist())
    far = max((math.hypot(*arm) for arm in zip(numbers, numbers, numbers, strict=True)), default=0.0)
    if far > (1.0 + FAR_CONTACT) * reach:
        message = (
            f"a contact is {far:.4g} m from the centre of mass of {body.name!r}, whose shape reaches "
            f"{reach:.4g} m: state and contact must be of one time, as landing.state and landing.contacts"
        )
        warnings.warn(message, FarContactWarning, stacklevel=frames_to_caller())


@lru_cache(maxsize=64)
def _reach(shape: ConvexShape) -> float:
    """Return the largest distance of a shape's points from the centre of mass, m."""
    return shape.reach
