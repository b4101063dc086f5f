# SPDX-License-Identifier: Apache-2.0
"""Calls about planes of motion, contact modes and what follows from them."""

from contact_dynamics import PlanarContact, PlanarVelocity, contact_modes, plane
from hostile_values.shared import BALL, CONTACTS, DEEP, FLAT, LEAN, RESTING, ROD, TIP, Calls

FLAT_ANSWER, DEEP_ANSWER = contact_modes.contact_modes(FLAT), contact_modes.contact_modes(DEEP)
UPRIGHT = plane.PlaneOfMotion(normal_W=[1.0, 0.0, 0.0])
LOADED = {
    "body": BALL,
    "state": RESTING,
    "contacts": CONTACTS,
    "force_W": [0.0, 0.0, -9.8],
    "torque_W": [0.1, 0.0, 0.0],
    "speed_tolerance": 1e-6,
}

MODES: Calls = {
    "PlaneOfMotion": (plane.PlaneOfMotion, {"normal_W": [0.0, 0.6, 0.8]}),
    "best_plane": (plane.best_plane, LOADED),
    "planar_in_space": (
        plane.planar_in_space,
        {
            "body": ROD,
            "velocity": PlanarVelocity(**LEAN),
            "contacts": [PlanarContact(**TIP)],
            "axes_W": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        },
    ),
    "project_onto_plane": (plane.project_onto_plane, {**LOADED, "plane": UPRIGHT}),
    "contact_modes in the plane": (contact_modes.contact_modes, {"problem": FLAT}),
    "contact_modes": (contact_modes.contact_modes, {"problem": DEEP}),
    "geometry_margins": (contact_modes.geometry_margins, {"problem": FLAT, "answer": FLAT_ANSWER}),
    "mode_margins in the plane": (
        contact_modes.mode_margins,
        {"problem": FLAT, "answer": FLAT_ANSWER, "margin_length": 0.1},
    ),
    "mode_margins": (
        contact_modes.mode_margins,
        {"problem": DEEP, "answer": DEEP_ANSWER, "margin_length": 0.1},
    ),
    "refused_modes": (
        contact_modes.refused_modes,
        {"problem": DEEP, "answer": DEEP_ANSWER, "margin_length": 0.1},
    ),
    "statics in the plane": (contact_modes.statics, {"problem": FLAT, "margin_length": 0.1}),
    "statics": (contact_modes.statics, {"problem": DEEP, "margin_length": 0.1}),
    "wrench_sets in the plane": (contact_modes.wrench_sets, {"problem": FLAT, "modes": ["f"]}),
    "wrench_sets": (contact_modes.wrench_sets, {"problem": DEEP, "modes": ["ss"]}),
    "spatial_kinematic_modes": (
        contact_modes.spatial_kinematic_modes,
        {"state": RESTING, "contacts": CONTACTS, "velocity_tolerance": 1e-9},
    ),
    "spatial_sliding_modes": (contact_modes.spatial_sliding_modes, {"contacts": CONTACTS, "planes": 2}),
    "BodyStatics.is_stable_against": (contact_modes.statics(FLAT).is_stable_against, {"disturbance": 0.1}),
}
