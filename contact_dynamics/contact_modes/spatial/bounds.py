# SPDX-License-Identifier: Apache-2.0
"""If contacts in space are known only to some uncertainty, this file bounds their rows and forces.

If the angle between a normal and the true one is at most theta, the smallest rotation that takes one to the
other moves every unit vector by at most 2 sin(theta / 2). This rotation also takes tangents to true tangents,
so that forces and accelerations have the same components in both frames. A point that is off by d changes the
moment of a unit force by at most d. What is proven for a box holds in each smaller one, so that errors too
small for linear programs are taken for larger ones.

Motions are (a, rho alpha), and wrenches (force, torque / rho), in world axes, where rho is the mean radius of
gyration.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.numerics.vectors import point_jacobians, tangents_towards
from contact_dynamics.tolerances import LEAST_UNCERTAINTY

if TYPE_CHECKING:
    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.validation import FloatArray


class BoundedContact(NamedTuple):
    """One contact of a body at rest.

    Attributes:
        frame: (3, 3), the normal and two tangents, one a row.
        rows: (3, 6), the components of the contact's acceleration in that frame, as functions of the motion.
            Each is also the wrench of a unit force along that axis.
        errors: (6,), by how much each coordinate of such a row, or of a row of any unit vector, may be off.
        size: The largest length of a row's error.
        min_friction: The smallest coefficient of friction in the box.
        max_friction: The largest coefficient of friction in the box.
    """

    frame: FloatArray
    rows: FloatArray
    errors: FloatArray
    size: float
    min_friction: float
    max_friction: float


class BoundedBody(NamedTuple):
    """A body at rest with its contacts.

    Attributes:
        contacts: The contacts.
        inertia: (6, 6), kg, the wrench that a unit motion needs.
        wrench: (6,), N, the applied wrench.
    """

    contacts: list[BoundedContact]
    inertia: FloatArray
    wrench: FloatArray


def bounded_body(problem: SpatialContactProblem, box: ContactUncertainty) -> BoundedBody:
    """Return the body of a problem with contacts anywhere in a box."""
    body, state, contacts = problem.body, problem.state, problem.contacts
    rho = body.mean_radius_of_gyration
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = body.mass * np.eye(3)
    inertia[3:, 3:] = body.inertia_in_world(state.R_WB) / rho**2
    arms = contacts.p_WC_W - state.p_WB_W
    jacobians = point_jacobians(arms) / np.array([1.0, 1.0, 1.0, rho, rho, rho])
    far = np.linalg.norm(arms, axis=1)
    found = []
    for i, (points, normals, frictions) in enumerate(box.of_each(len(contacts))):
        frame = np.array([contacts.normals_W[i], *tangents_towards(contacts.normals_W[i])])
        turned = 2.0 * math.sin(0.5 * normals)
        moved = (points + (float(far[i]) + points) * turned) / rho
        turned, moved = max(turned, LEAST_UNCERTAINTY), max(moved, LEAST_UNCERTAINTY)
        friction = float(contacts.frictions[i])
        found.append(
            BoundedContact(
                frame=frame,
                rows=frame @ jacobians[i],
                errors=np.array([turned] * 3 + [moved] * 3),
                size=turned + moved,
                min_friction=max(0.0, friction - frictions),
                max_friction=friction + frictions,
            )
        )
    return BoundedBody(found, inertia, np.concatenate([problem.force_W, problem.torque_W / rho]))
