# SPDX-License-Identifier: Apache-2.0
"""The applied wrench that belongs to a mode's accelerations and forces, by Newton's and Euler's laws."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes.spatial.result import SpatialMode
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


def applied_wrench(
    body: MassProperties, state: BodyState, contacts: ContactSet, mode: SpatialMode
) -> FloatArray:
    """Return the wrench under which a mode's contact forces give its accelerations.

    Args:
        body: Mass properties.
        state: The body's pose and velocity.
        contacts: The contacts that the mode is about.
        mode: The mode.

    Returns:
        (6,), the force, N, then the torque about the centre of mass, N m, in world axes. Gravity is part of
        it.
    """
    I_W = body.inertia_in_world(state.R_WB)
    force_W = body.mass * mode.acceleration_W - mode.contact_forces_W.sum(axis=0)
    torques_W = np.cross(contacts.p_WC_W - state.p_WB_W, mode.contact_forces_W)
    spun_W = I_W @ mode.angular_acceleration_W + np.cross(state.w_WB_W, I_W @ state.w_WB_W)
    return np.concatenate([force_W, spun_W - torques_W.sum(axis=0)])
