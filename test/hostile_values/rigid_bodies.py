"""Calls about the rigid body, its shape, its motion, and which of their arguments become hostile."""

import numpy as np

from contact_dynamics import (
    BodyState,
    MassProperties,
    free_motion,
    shapes,
)
from contact_dynamics.motion import ConstantWrench, Drag, motion_of
from contact_dynamics.rigid_body import inertia
from hostile_values.shared import BALL, FALLING, OUTWARD, STATE, TETRAHEDRON, WHERE, Calls

RIGID_BODIES: Calls = {
    "MassProperties": (MassProperties, {"mass": 1.0, "I_B": np.diag([0.1, 0.2, 0.25])}, set()),
    "BodyState": (BodyState, FALLING, set()),
    "free_motion": (free_motion, {**WHERE, "gravity_W": [0.0, 0.0, -9.8]}, {"gravity_W"}),
    "state_at": (free_motion(BALL, STATE).state_at, {"seconds": 0.5}, {"seconds"}),
    "motion_of": (
        motion_of,
        {**WHERE, "gravity_W": [0.0, 0.0, -9.8], "most_steps": 100},
        {"gravity_W", "most_steps"},
    ),
    "Drag": (
        Drag,
        {"linear": 0.1, "quadratic": 0.1, "linear_angular": 0.01, "quadratic_angular": 0.01},
        set(),
    ),
    "ConstantWrench": (ConstantWrench, {"force": [1.0, 0.0, 0.0], "torque": [0.0, 0.1, 0.0]}, set()),
    "inertia.box": (inertia.box, {"size": [0.1, 0.2, 0.3], "mass": 1.0}, set()),
    "inertia.sphere": (inertia.sphere, {"radius": 0.1, "density": 1e3}, set()),
    "inertia.hollow_sphere": (
        inertia.hollow_sphere,
        {"outer_radius": 0.2, "inner_radius": 0.1, "mass": 1.0},
        set(),
    ),
    "inertia.ellipsoid": (inertia.ellipsoid, {"semi_axes": [0.1, 0.2, 0.3], "mass": 1.0}, set()),
    "inertia.hemisphere": (inertia.hemisphere, {"radius": 0.1, "mass": 1.0}, set()),
    "inertia.cylinder": (inertia.cylinder, {"radius": 0.1, "length": 0.3, "mass": 1.0}, set()),
    "inertia.tube": (
        inertia.tube,
        {"outer_radius": 0.2, "inner_radius": 0.1, "length": 0.3, "mass": 1.0},
        set(),
    ),
    "inertia.capsule": (inertia.capsule, {"radius": 0.1, "length": 0.3, "mass": 1.0}, set()),
    "inertia.cone": (inertia.cone, {"radius": 0.1, "height": 0.3, "top_radius": 0.05, "mass": 1.0}, set()),
    "inertia.torus": (inertia.torus, {"ring_radius": 0.3, "tube_radius": 0.1, "mass": 1.0}, set()),
    "inertia.convex_hull": (
        inertia.convex_hull,
        {"p_FV_F": shapes.box_vertices((0.2, 0.2, 0.2)), "mass": 1.0},
        set(),
    ),
    "shapes.sphere": (shapes.sphere, {"radius": 0.1}, set()),
    "shapes.capsule": (shapes.capsule, {"radius": 0.1, "length": 0.3}, set()),
    "shapes.cylinder": (shapes.cylinder, {"radius": 0.1, "length": 0.3}, set()),
    "shapes.cone": (shapes.cone, {"radius": 0.1, "height": 0.3}, set()),
    "shapes.box": (shapes.box, {"size": [0.1, 0.2, 0.3]}, set()),
    "shapes.box_vertices": (shapes.box_vertices, {"size": [0.1, 0.2, 0.3]}, set()),
    "shapes.polyhedron": (shapes.polyhedron, {"vertices": TETRAHEDRON}, set()),
    "shapes.polygon": (shapes.polygon, {"outline": [[0.0, 0.0], [0.2, 0.0], [0.0, 0.2]]}, set()),
    "shapes.rounded": (
        shapes.rounded,
        {"shape": shapes.box(size=[0.1, 0.2, 0.3]), "radius": 0.01},
        {"radius"},
    ),
    "inertia.mesh": (
        inertia.mesh,
        {"p_FV_F": TETRAHEDRON, "triangles": OUTWARD, "mass": 1.0},
        set(),
    ),
    "inertia.particles": (inertia.particles, {"masses": [1.0, 2.0, 3.0, 1.0], "p_FP_F": TETRAHEDRON}, set()),
    "inertia.plate": (inertia.plate, {"size": [0.1, 0.2], "mass": 1.0}, set()),
    "inertia.disc": (inertia.disc, {"radius": 0.1, "mass": 1.0}, set()),
    "inertia.ring": (inertia.ring, {"radius": 0.1, "mass": 1.0}, set()),
    "inertia.rod": (inertia.rod, {"length": 0.1, "mass": 1.0}, set()),
    "inertia.spherical_shell": (inertia.spherical_shell, {"radius": 0.1, "density": 10.0}, set()),
    "inertia.cylindrical_shell": (
        inertia.cylindrical_shell,
        {"radius": 0.1, "length": 0.3, "density": 10.0},
        set(),
    ),
    "inertia.principal_axes": (inertia.principal_axes, {"I_B": np.diag([0.1, 0.2, 0.25])}, set()),
    "inertia.inertia_ellipsoid": (
        inertia.inertia_ellipsoid,
        {"I_B": np.diag([0.1, 0.2, 0.25]), "level": 1.0},
        set(),
    ),
}
