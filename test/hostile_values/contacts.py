# SPDX-License-Identifier: Apache-2.0
"""Calls about contacts, worlds and contact problems."""

from dataclasses import replace

import numpy as np

from contact_dynamics import (
    BodiesContactProblem,
    Body,
    Contact,
    ContactSet,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarVelocity,
    PlanarWrench,
    SpatialContactProblem,
    Surface,
    World,
    closure,
    find_contacts,
    free_motion,
    largest_acceleration,
    largest_load,
    largest_spin,
    largest_tilt,
    least_friction,
    next_landing,
    next_meeting,
    shapes,
)
from contact_dynamics.contact import (
    ContactUncertainty,
    Curvatures,
    linearised_cone,
    spatial_contact_velocities,
)
from contact_dynamics.contact_modes import ResponseContactProblem
from contact_dynamics.landing import first_contact
from hostile_values.rigid_bodies import HAMMER
from hostile_values.shared import (
    BALL,
    BOX,
    CONTACT,
    CONTACTS,
    CORNERS,
    FLOOR,
    HELD,
    LEAN,
    LYING,
    RESTING,
    ROD,
    STATE,
    TIP,
    TOUCH,
    WORLD,
    Calls,
)

CALLS_WITH_CONTACTS: Calls = {
    "Contact": (Contact, TOUCH),
    "ContactSet": (ContactSet, CORNERS),
    "Surface": (Surface, FLOOR),
    "World": (World, {"bodies": (BOX,), "surfaces": (Surface(**FLOOR),), "gravity_W": [0, 0, -9.8]}),
    "PlanarBody": (PlanarBody, {"mass": 1.0, "inertia": 0.5}),
    "PlanarVelocity": (PlanarVelocity, LEAN),
    "PlanarWrench": (PlanarWrench, {"f": (0.0, -9.8), "moment": 0.1}),
    "PlanarContact": (PlanarContact, {**TIP, "surface_angular_velocity": 0.5}),
    "next_landing": (
        next_landing,
        {
            "body": BOX,
            "state": STATE,
            "world": WORLD,
            "horizon": 0.5,
            "distance_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
        },
    ),
    "next_meeting": (
        next_meeting,
        {
            "body": BOX,
            "state": STATE,
            "other": BOX,
            "other_state": replace(STATE, p_WB_W=STATE.p_WB_W + np.array([0.0, 0.0, 5.0])),
            "friction": 0.3,
            "restitution": 0.5,
            "gravity_W": [0.0, 0.0, -9.8],
            "other_gravity_W": [0.0, 0.0, -12.0],
            "horizon": 0.5,
            "distance_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
        },
    ),
    "find_contacts": (
        find_contacts,
        {"body": BOX, "state": STATE, "world": WORLD, "distance_tolerance": 1.0},
    ),
    "PlanarContactProblem": (
        PlanarContactProblem,
        {
            "body": ROD,
            "velocity": PlanarVelocity(v=(0.0, 0.0), w=0.0),
            "contacts": [PlanarContact(**TIP)],
            "wrench": PlanarWrench(f=(0.0, -9.8)),
            "velocity_tolerance": 1e-9,
            "acceleration_tolerance": 1e-9,
        },
    ),
    "SpatialContactProblem": (
        SpatialContactProblem,
        {
            "body": BALL,
            "state": RESTING,
            "contacts": CONTACTS,
            "force_W": [0.0, 0.0, -9.8],
            "torque_W": [0.0, 0.0, 0.0],
            "friction_facets": 8,
            "velocity_tolerance": 1e-9,
        },
    ),
    "BodiesContactProblem": (
        BodiesContactProblem,
        {
            "bodies": [BALL],
            "states": [RESTING],
            "contacts": CONTACTS,
            "pairs": [(0, None), (0, None)],
            "forces_W": [[0.0, 0.0, -9.8]],
            "torques_W": [[0.0, 0.0, 0.0]],
            "velocity_tolerance": 1e-9,
        },
    ),
    "ResponseContactProblem": (
        ResponseContactProblem,
        {
            "inverse_inertia_W": np.eye(6),
            "accelerations_W": [[0.0, 0.0, -9.8], [0.0, 0.0, -9.8]],
            "contacts": CONTACTS,
            "velocities_W": [0.0, 0.0, 0.0],
            "velocity_tolerance": 1e-9,
        },
    ),
    "SpatialContactProblem.of": (
        SpatialContactProblem.of,
        {
            "body": BOX,
            "state": LYING,
            "world": WORLD,
            "force_W": [1.0, 0.0, 0.0],
            "torque_W": [0.0, 0.1, 0.0],
            "at_W": [0.0, 0.0, 0.1],
        },
    ),
    "largest_load": (
        largest_load,
        {
            "problem": HELD,
            "force_W": [1.0, 0.0, 0.0],
            "torque_W": [0.0, 0.1, 0.0],
            "at_W": [0.0, 0.0, 0.1],
            "max_normal_forces": [1e3] * 4,
        },
    ),
    "largest_acceleration": (largest_acceleration, {"problem": HELD, "direction_W": [1.0, 0.0, 0.0]}),
    "largest_spin": (largest_spin, {"problem": HELD, "axis_W": [0.0, 0.0, 1.0], "at_W": [1.0, 0.0, 0.0]}),
    "largest_tilt": (
        largest_tilt,
        {"problem": HELD, "axis_W": [0.0, 1.0, 0.0], "gravity_W": [0.0, 0.0, -9.8]},
    ),
    "least_friction": (least_friction, {"problem": HELD}),
    "closure": (closure, {"contacts": CONTACTS}),
    "ContactUncertainty": (ContactUncertainty, {"points": 1e-3, "normals": 1e-3, "frictions": 0.1}),
    "ContactSet.of": (ContactSet.of, {"contacts": [CONTACT]}),
    "Curvatures": (Curvatures, {"along": [1.0], "across": [2.0], "directions_W": [[1.0, 0.0, 0.0]]}),
    "linearised_cone": (
        linearised_cone,
        {"normal": [0.0, 0.0, 1.0], "friction": 0.5, "facets": 8, "towards": [1.0, 0.0, 0.0]},
    ),
    "spatial_contact_velocities": (
        spatial_contact_velocities,
        {"state": STATE, "contacts": CONTACTS, "velocity_tolerance": 1e-9},
    ),
    "first_contact": (
        first_contact,
        {
            "motion": free_motion(BALL, STATE),
            "shape_B": BOX.shape,
            "p_WS_W": [0.0, 0.0, 0.0],
            "normal_W": [0.0, 0.0, 1.0],
            "horizon": 0.5,
        },
    ),
    "Body": (Body, {"name": "box", "mass_properties": BALL, "p_FB_F": [0.0, 0.0, 0.1], "shape": BOX.shape}),
    "Body.of": (Body.of, {"name": "box", "mass": HAMMER, "vertices_F": shapes.box_vertices((0.2, 0.2, 0.2))}),
    "Body.union": (Body.union, {"parts": [BOX, BOX], "name": "two"}),
    "Body.placed": (BOX.placed, {"p_GF_G": [0.1, 0.2, 0.3], "q_GF": [0.0, 0.0, 0.0, 1.0]}),
    "World.body": (WORLD.body, {"name": "box"}),
}
