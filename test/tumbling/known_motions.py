# SPDX-License-Identifier: Apache-2.0
"""Free motions of every kind, by name."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, Regime, free_motion

TURN = Rotation.from_euler("xyz", [0.3, -1.1, 2.0])
ALIGNED = Rotation.identity()
OBLIQUE = Rotation.from_euler("xyz", [-0.7, 0.4, 1.3])

MOTIONS = {
    # moments, their axes in the body, angular velocity in those axes
    "about the major axis": ((1.0, 1.4, 1.9), OBLIQUE, (0.3, -0.5, 1.2), Regime.ABOUT_MAJOR_AXIS),
    "about the opposite of it": ((1.0, 1.4, 1.9), OBLIQUE, (0.3, 0.5, -1.2), Regime.ABOUT_MAJOR_AXIS),
    "about the minor axis": ((1.0, 1.4, 1.9), OBLIQUE, (-1.3, 0.5, 0.2), Regime.ABOUT_MINOR_AXIS),
    "moments out of order": ((1.9, 1.0, 1.4), ALIGNED, (0.3, 1.5, -0.2), Regime.ABOUT_MINOR_AXIS),
    "a rod": ((0.001, 1.0, 1.0005), OBLIQUE, (3.0, 0.5, 0.4), Regime.ABOUT_MINOR_AXIS),
    "flat": ((1.0, 2.0, 3.0), OBLIQUE, (0.1, 0.2, 1.4), Regime.ABOUT_MAJOR_AXIS),
    "near the middle axis": ((1.0, 1.4, 1.9), OBLIQUE, (1e-3, 1.2, 1e-4), Regime.ABOUT_MINOR_AXIS),
    "nearer to it": ((1.0, 1.4, 1.9), OBLIQUE, (1e-4, 1.2, 1e-3), Regime.ABOUT_MAJOR_AXIS),
    "about the middle axis": ((1.0, 1.4, 1.9), ALIGNED, (0.0, -1.2, 0.0), Regime.PRINCIPAL_AXIS),
    "about the major axis alone": ((1.0, 1.4, 1.9), ALIGNED, (0.0, 0.0, 1.2), Regime.PRINCIPAL_AXIS),
    "about the minor axis alone": ((1.0, 1.4, 1.9), ALIGNED, (-1.2, 0.0, 0.0), Regime.PRINCIPAL_AXIS),
    "near the major axis": ((1.0, 1.4, 1.9), OBLIQUE, (1e-9, 0.0, 1.2), Regime.ABOUT_MAJOR_AXIS),
    "separatrix": ((3.0, 4.0, 6.0), ALIGNED, (2.0, -0.5, 1.0), Regime.SEPARATRIX),
    "its other branch": ((3.0, 4.0, 6.0), ALIGNED, (-2.0, -0.5, 1.0), Regime.SEPARATRIX),
    "sphere": ((0.7, 0.7, 0.7), ALIGNED, (0.3, -0.5, 1.2), Regime.SPHERICAL),
    "sphere to rounding": ((0.7, 0.7, 0.7), OBLIQUE, (0.3, -0.5, 1.2), Regime.SPHERICAL),
    "oblate": ((1.0, 1.0, 1.6), ALIGNED, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "oblate to rounding": ((1.0, 1.0, 1.6), OBLIQUE, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "oblate in its plane": ((1.0, 1.0, 1.6), ALIGNED, (0.3, -0.5, 0.0), Regime.AXISYMMETRIC),
    "oblate near its plane": ((1.0, 1.0, 1.6), OBLIQUE, (0.3, -0.5, 1e-9), Regime.AXISYMMETRIC),
    "prolate": ((0.4, 1.0, 1.0), ALIGNED, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "prolate to rounding": ((0.4, 1.0, 1.0), OBLIQUE, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "prolate about its axis": ((0.4, 1.0, 1.0), ALIGNED, (1.2, 0.0, 0.0), Regime.AXISYMMETRIC),
    "at rest": ((1.0, 1.4, 1.9), OBLIQUE, (0.0, 0.0, 0.0), Regime.AT_REST),
}


def motion_of(name: str) -> FreeMotion:
    moments, axes, w_P, _ = MOTIONS[name]
    R_BP = axes.as_matrix()
    inertia = R_BP @ np.diag(moments) @ R_BP.T if axes is OBLIQUE else np.diag(moments)
    attitude = TURN if axes is OBLIQUE else ALIGNED  # exact numbers stay exact
    state = BodyState(
        p_WB_W=[0.1, 0.2, 1.5],
        q_WB=attitude.as_quat(),
        v_WB_W=[1.0, -0.5, 2.0],
        w_WB_W=attitude.as_matrix() @ R_BP @ np.array(w_P),
        stamp_ns=1_700_000_000_123_456_789,
    )
    return free_motion(MassProperties(mass=1.3, I_B=inertia), state)
