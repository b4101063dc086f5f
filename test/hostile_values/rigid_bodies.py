# SPDX-License-Identifier: Apache-2.0
"""Calls about the rigid body and its shape."""

import numpy as np

from contact_dynamics import BodyState, MassProperties, rigid_body, shapes
from contact_dynamics.rigid_body import inertia
from hostile_values.shared import BALL, FALLING, OUTWARD, STATE, TETRAHEDRON, WHERE, Calls

HAMMER = inertia.box(size=[0.1, 0.2, 0.3], mass=1.0).placed(p_GF_G=[0.0, 0.0, 0.2])
RIM = shapes.Rim((0.0, 0.0, 0.1), (0.0, 0.0, 1.0), 0.1)

RIGID_BODIES: Calls = {
    "MassProperties": (MassProperties, {"mass": 1.0, "I_B": np.diag([0.1, 0.2, 0.25])}),
    "BodyState": (BodyState, FALLING),
    "BodyState.with_velocities": (
        STATE.with_velocities,
        {"v_WB_W": [0.3, 0.1, -1.0], "w_WB_W": [1.0, 2.0, 0.5]},
    ),
    "MassProperties.angular_inertia_about": (BALL.angular_inertia_about, {"axis_B": [0.0, 0.6, 0.8]}),
    "MassProperties.radius_of_gyration": (BALL.radius_of_gyration, {"axis_B": [0.0, 0.6, 0.8]}),
    "angular_momentum": (rigid_body.angular_momentum, WHERE),
    "kinetic_energy": (rigid_body.kinetic_energy, WHERE),
    "momentum": (rigid_body.momentum, WHERE),
    "state_covariance": (
        rigid_body.state_covariance,
        {"position": 1e-3, "rotation": 0.01, "velocity": 0.1, "angular_velocity": 0.2},
    ),
    "rotational_energy": (rigid_body.rotational_energy, WHERE),
    "MassDistribution": (
        inertia.MassDistribution,
        {"mass": 1.0, "p_FB_F": [0.0, 0.1, 0.0], "I_B": np.diag([0.1, 0.2, 0.25])},
    ),
    "MassDistribution.of": (
        inertia.MassDistribution.of,
        {"mass_properties": BALL, "p_FB_F": [0.0, 0.1, 0.0]},
    ),
    "MassDistribution.from_inertia_about": (
        inertia.MassDistribution.from_inertia_about,
        {
            "p_FQ_F": [0.1, 0.0, 0.0],
            "I_Q": np.diag([0.1, 0.21, 0.26]),
            "mass": 1.0,
            "p_FB_F": [0.0, 0.0, 0.0],
        },
    ),
    "MassDistribution.placed": (HAMMER.placed, {"p_GF_G": [0.1, 0.2, 0.3], "q_GF": [0.0, 0.0, 0.6, 0.8]}),
    "MassDistribution.mirrored": (HAMMER.mirrored, {"normal_F": [0.0, 0.6, 0.8]}),
    "MassDistribution.with_mass": (HAMMER.with_mass, {"mass": 2.0}),
    "MassDistribution.inertia_about": (HAMMER.inertia_about, {"p_FQ_F": [0.1, 0.2, 0.3]}),
    "MassDistribution.angular_inertia_about": (
        HAMMER.angular_inertia_about,
        {"axis_F": [0.0, 0.6, 0.8], "p_FQ_F": [0.1, 0.2, 0.3]},
    ),
    "MassDistribution.radius_of_gyration": (
        HAMMER.radius_of_gyration,
        {"axis_F": [0.0, 0.6, 0.8], "p_FQ_F": [0.1, 0.2, 0.3]},
    ),
    "inertia.combined": (inertia.combined, {"parts": [HAMMER, HAMMER]}),
    "inertia.without": (
        inertia.without,
        {"whole": inertia.sphere(radius=0.2, mass=2.0), "part": inertia.sphere(radius=0.1, mass=0.5)},
    ),
    "inertia.box": (inertia.box, {"size": [0.1, 0.2, 0.3], "mass": 1.0}),
    "inertia.sphere": (inertia.sphere, {"radius": 0.1, "density": 1e3}),
    "inertia.hollow_sphere": (inertia.hollow_sphere, {"outer_radius": 0.2, "inner_radius": 0.1, "mass": 1.0}),
    "inertia.ellipsoid": (inertia.ellipsoid, {"semi_axes": [0.1, 0.2, 0.3], "mass": 1.0}),
    "inertia.hemisphere": (inertia.hemisphere, {"radius": 0.1, "mass": 1.0}),
    "inertia.cylinder": (inertia.cylinder, {"radius": 0.1, "length": 0.3, "mass": 1.0}),
    "inertia.tube": (inertia.tube, {"outer_radius": 0.2, "inner_radius": 0.1, "length": 0.3, "mass": 1.0}),
    "inertia.capsule": (inertia.capsule, {"radius": 0.1, "length": 0.3, "mass": 1.0}),
    "inertia.cone": (inertia.cone, {"radius": 0.1, "height": 0.3, "top_radius": 0.05, "mass": 1.0}),
    "inertia.torus": (inertia.torus, {"ring_radius": 0.3, "tube_radius": 0.1, "mass": 1.0}),
    "inertia.convex_hull": (
        inertia.convex_hull,
        {"p_FV_F": shapes.box_vertices((0.2, 0.2, 0.2)), "mass": 1.0},
    ),
    "shapes.sphere": (shapes.sphere, {"radius": 0.1}),
    "shapes.capsule": (shapes.capsule, {"radius": 0.1, "length": 0.3}),
    "shapes.cylinder": (shapes.cylinder, {"radius": 0.1, "length": 0.3}),
    "shapes.cone": (shapes.cone, {"radius": 0.1, "height": 0.3}),
    "shapes.box": (shapes.box, {"size": [0.1, 0.2, 0.3]}),
    "shapes.box_vertices": (shapes.box_vertices, {"size": [0.1, 0.2, 0.3]}),
    "shapes.polyhedron": (shapes.polyhedron, {"vertices": TETRAHEDRON}),
    "shapes.polygon": (shapes.polygon, {"outline": [[0.0, 0.0], [0.2, 0.0], [0.0, 0.2]]}),
    "shapes.rounded": (shapes.rounded, {"shape": shapes.box(size=[0.1, 0.2, 0.3]), "radius": 0.01}),
    "shapes.union": (shapes.union, {"shapes": [shapes.box([0.1, 0.2, 0.3]), shapes.cone(0.1, 0.2)]}),
    "inertia.mesh": (inertia.mesh, {"p_FV_F": TETRAHEDRON, "triangles": OUTWARD, "mass": 1.0}),
    "inertia.particles": (inertia.particles, {"masses": [1.0, 2.0, 3.0, 1.0], "p_FP_F": TETRAHEDRON}),
    "inertia.plate": (inertia.plate, {"size": [0.1, 0.2], "mass": 1.0}),
    "inertia.disc": (inertia.disc, {"radius": 0.1, "mass": 1.0}),
    "inertia.ring": (inertia.ring, {"radius": 0.1, "mass": 1.0}),
    "inertia.rod": (inertia.rod, {"length": 0.1, "mass": 1.0}),
    "inertia.spherical_shell": (inertia.spherical_shell, {"radius": 0.1, "density": 10.0}),
    "inertia.cylindrical_shell": (inertia.cylindrical_shell, {"radius": 0.1, "length": 0.3, "density": 10.0}),
    "inertia.principal_axes": (inertia.principal_axes, {"I_B": np.diag([0.1, 0.2, 0.25])}),
    "inertia.inertia_ellipsoid": (
        inertia.inertia_ellipsoid,
        {"I_B": np.diag([0.1, 0.2, 0.25]), "level": 1.0},
    ),
    "InertiaEllipsoid.distance": (
        inertia.inertia_ellipsoid(np.diag([0.1, 0.2, 0.25])).distance,
        {"axis_B": [0.0, 0.6, 0.8]},
    ),
    "ConvexShape": (shapes.ConvexShape, {"vertices": TETRAHEDRON, "rims": (RIM,), "rounding": 0.01}),
    "ConvexShape.moved": (
        shapes.box(size=[0.1, 0.2, 0.3]).moved,
        {"offset": [0.1, 0.2, 0.3], "q": [0.0, 0.0, 0.6, 0.8]},
    ),
    "Rim": (
        lambda center, axis, radius: shapes.ConvexShape(rims=(shapes.Rim(center, axis, radius),)),
        RIM._asdict(),
    ),
    "Obstacle": (
        shapes.Obstacle,
        {"name": "block", "vertices_W": TETRAHEDRON, "friction": 0.4, "restitution": 0.5},
    ),
}
