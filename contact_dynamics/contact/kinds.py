# SPDX-License-Identifier: Apache-2.0
"""What the velocities of a body add to the accelerations at its contacts, for contacts of every kind.

`curvature` has the derivation, and the terms of the known kinds.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.curvature import least_and_most, rolling, side_of
from contact_dynamics.numerics.vectors import tangent_rows

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.validation import FloatArray


def velocity_accelerations(contacts: ContactSet, velocities_W: FloatArray, w_W: FloatArray) -> FloatArray:
    """Return what velocities add to the accelerations of the body's points at contacts, (n, 3), m/s^2.

    With them, the acceleration along the normal is the gap's second derivative. At a contact at rest, the
    tangential acceleration is the rate of its sliding velocity.

    Args:
        contacts: n contacts.
        velocities_W: (n, 3), m/s, of the body's points there, world axes. Normal parts are not used.
        w_W: (3,), rad/s, angular velocity of the body, world axes.
    """
    added = np.zeros((len(contacts), 3))
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return added
    n = len(contacts)
    mine = least_and_most(contacts.body_curvatures, n, math.inf)
    theirs = least_and_most(contacts.surface_curvatures, n, 0.0)
    for i in np.flatnonzero(np.isfinite(mine[0]) | (theirs != 0.0).any(axis=0)).tolist():  # not point on flat
        normal = contacts.normals_W[i]
        frame = tangent_rows(normal)
        m = frame @ np.cross(normal, w_W)
        v = frame @ velocities_W[i]
        found = rolling(
            side_of(contacts.body_curvatures, i, frame, math.inf),
            side_of(contacts.surface_curvatures, i, frame, 0.0),
            (float(m[0]), float(m[1])),
            (float(v[0]), float(v[1])),
        )
        if found is not None:  # which `check_pairs` has made sure of
            eta_W = np.array(found.eta) @ frame
            added[i] = found.gap * normal + float(normal @ w_W) * np.cross(normal, eta_W)
    return added
