# SPDX-License-Identifier: Apache-2.0
"""Calls about impacts."""

import numpy as np

from contact_dynamics import (
    BodyState,
    PlanarContact,
    PlanarVelocity,
    impact,
    impact_sequence,
    planar_impact,
    response_impact,
    several_impact,
    spatial_impact,
)
from contact_dynamics.impact import StrikingBodies
from hostile_values.shared import (
    BALL,
    BOX,
    CONTACT,
    CONTACTS,
    FALLING,
    LEAN,
    RESTING,
    ROD,
    SEVERAL,
    STATE,
    STRIKERS,
    TIP,
    WHERE,
    WORLD,
    Calls,
)

IMPACTS: Calls = {
    "StrikingBodies": (StrikingBodies, STRIKERS),
    "StrikingBodies.of": (StrikingBodies.of, {"body": BALL, **FALLING, "p_WC_W": [0.0, 0.0, 0.0]}),
    "spatial_impact": (spatial_impact, {**WHERE, "contact": CONTACT, "velocity_tolerance": 1e-9}),
    "response_impact": (
        response_impact,
        {
            "inverse_inertia_W": np.eye(3),
            "velocity_W": [0.3, 0.0, -1.0],
            "contact": CONTACT,
            "velocity_tolerance": 1e-9,
        },
    ),
    "response_impacts": (
        impact.response_impacts,
        {
            "inverse_inertias_W": np.eye(3),
            "velocities_W": [0.3, 0.0, -1.0],
            "normals_W": [0.0, 0.0, 1.0],
            "frictions": 0.5,
            "restitutions": 0.5,
            "velocity_tolerance": 1e-9,
        },
    ),
    "several_impact": (several_impact, SEVERAL),
    "outcomes_over_orders": (impact.outcomes_over_orders, {**SEVERAL, "max_orders": 2}),
    "outcomes_over_interleavings": (impact.outcomes_over_interleavings, {**SEVERAL, "samples": 1, "seed": 0}),
    "jamming_impact": (
        impact.jamming_impact,
        {
            **SEVERAL,
            "state": RESTING,
            "force_W": [1.0, 0.0, -9.8],
            "torque_W": [0.1, 0.0, 0.0],
            "plane_normal_W": [0.0, 1.0, 0.0],
            "friction_facets": 8,
        },
    ),
    "planar_impact": (
        planar_impact,
        {
            "body": ROD,
            "velocity": PlanarVelocity(**LEAN),
            "contact": PlanarContact(**TIP),
            "velocity_tolerance": 1e-9,
        },
    ),
    "planar_impacts": (
        impact.planar_impacts,
        {
            "masses": 1.0,
            "inertias": 0.5,
            "v": (0.3, -1.0),
            "w": 0.5,
            "r": (0.2, -0.5),
            "normals": (0.0, 1.0),
            "frictions": 0.5,
            "restitutions": 0.5,
            "velocity_tolerance": 1e-9,
        },
    ),
    "spatial_impacts": (
        impact.spatial_impacts,
        {
            "bodies": StrikingBodies(**STRIKERS),
            "normals_W": [0.0, 0.0, 1.0],
            "frictions": 0.5,
            "restitutions": 0.5,
            "surface_velocities_W": [0.1, 0.0, 0.2],
            "velocity_tolerance": 1e-9,
        },
    ),
    "spatial_impact_distribution": (
        impact.spatial_impact_distribution,
        {
            **WHERE,
            "contact": CONTACT,
            "covariance": 1e-4 * np.eye(12),
            "samples": 10,
            "seed": 0,
            "velocity_tolerance": 1e-9,
        },
    ),
    "impact_sequence": (
        impact_sequence,
        {
            "body": BOX,
            "state": STATE,
            "world": WORLD,
            "window": 0.5,
            "max_strikes": 3,
            "distance_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
            "hold_step": None,
        },
    ),
    "impact_sequence at contacts": (
        impact_sequence,
        {"body": BOX, "state": STATE, "world": WORLD, "contacts": CONTACTS, "max_strikes": 3},
    ),
    "spatial_pair_impact": (
        impact.spatial_pair_impact,
        {
            **WHERE,
            "other": BALL,
            "other_state": BodyState(**{**FALLING, "v_WB_W": [0, 0, 1]}),
            "contact": CONTACT,
            "velocity_tolerance": 1e-9,
        },
    ),
    "bodies_impact": (
        impact.bodies_impact,
        {"bodies": [BALL], "states": [STATE], "contacts": CONTACTS, "pairs": [(0, None), (0, None)]},
    ),
}
