"""Every public constructor and function of the physics meets hostile values: it answers, or refuses by name.

Each argument in turn becomes a value that is not allowed, or one at the ends of what doubles hold. Then there
is an answer whose numbers are finite, or a `ContactDynamicsError` that names the argument. There is no other
exception, no warning (pytest makes errors of them) and no hang.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import signal
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

import numpy as np
import pytest

from contact_dynamics import (
    Body,
    BodyState,
    Contact,
    ContactSet,
    MassProperties,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarVelocity,
    PlanarWrench,
    SpatialContactProblem,
    Surface,
    World,
    find_contacts,
    free_motion,
    impact,
    impact_sequence,
    next_landing,
    planar_impact,
    several_impact,
    shapes,
    spatial_impact,
)
from contact_dynamics.contact import ContactUncertainty
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.impact import StrikingBodies
from contact_dynamics.motion import ConstantWrench, Drag, motion_of
from contact_dynamics.questions import (
    AtRate,
    AtTimes,
    ContactModeQuestion,
    ImpactQuestion,
    PublishedState,
    TumblingQuestion,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.many import ManyImpactsQuestion, ManyStates, ManyTumblingsQuestion
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from contact_dynamics.rigid_body import inertia
from contact_dynamics.toss import toss

SECONDS = 20
"""A call may take no longer, even on a loaded machine. The slowest takes less than one."""

HOSTILE = [
    math.nan,
    math.inf,
    -math.inf,
    -1.0,
    0.0,
    8.5,
    1e300,
    1e160,
    1e61,
    1e-300,
    1.0 + 2.0j,
    "text",
    None,
    True,
    [],
    [[1.0]],
    [1.0, 2.0],
    {"a": 1.0},
]

BALL = MassProperties(mass=1.0, I_B=np.diag([0.1, 0.2, 0.25]))
FALLING = {
    "p_WB_W": [0.0, 0.0, 0.5],
    "q_WB": [0.0, 0.0, 0.0, 1.0],
    "v_WB_W": [0.3, 0.1, -1.0],
    "w_WB_W": [1.0, 2.0, 0.5],
}
STATE = BodyState(**FALLING)
TOUCH = {"p_WC_W": [0.1, 0.2, 0.0], "normal_W": [0.0, 0.0, 1.0], "friction": 0.5, "restitution": 0.5}
CORNERS = {
    "p_WC_W": [[0.1, 0.1, 0.0], [-0.1, 0.1, 0.0]],
    "normals_W": [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]],
    "frictions": [0.5, 0.4],
    "restitutions": [0.5, 0.5],
}
CONTACT, CONTACTS = Contact(**TOUCH), ContactSet(**CORNERS)
FLOOR = {"name": "floor", "p_WS_W": [0, 0, 0], "normal_W": [0, 0, 1], "friction": 0.4, "restitution": 0.5}
BOX = Body(name="box", mass_properties=BALL, vertices_B=shapes.box_vertices((0.2, 0.2, 0.2)))
WORLD = World(bodies=(BOX,), surfaces=(Surface(**FLOOR),))
ROD, LEAN = PlanarBody(mass=1.0, inertia=0.5), {"v": (0.3, -1.0), "w": 0.5}
TIP = {"r": (0.2, -0.5), "normal": (0.0, 1.0), "friction": 0.5, "restitution": 0.5}
RESTING = BodyState(**{**FALLING, "v_WB_W": [0, 0, 0], "w_WB_W": [0, 0, 0]})
STRIKERS = {
    "masses": 1.0,
    "inertias_B": np.diag([0.1, 0.2, 0.25]),
    "q_WB": [0.0, 0.0, 0.0, 1.0],
    "v_WB_W": [0.3, 0.1, -1.0],
    "w_WB_W": [1.0, 2.0, 0.5],
    "r_W": [0.1, 0.2, -0.5],
}
WHERE = {"body": BALL, "state": STATE}
SEVERAL = {**WHERE, "contacts": CONTACTS, "velocity_tolerance": 1e-9}

STATES = {
    "p_WB_W": [[0.0, 0.0, 0.5]],
    "q_WB": [[0.0, 0.0, 0.0, 1.0]],
    "v_WB_W": [[0.3, 0.1, -1.0]],
    "w_WB_W": [[1.0, 2.0, 0.5]],
}
TETRAHEDRON = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.2]]
OUTWARD = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]

CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any], set[str]]] = {
    # The call, its arguments, and those that become hostile.
    "MassProperties": (MassProperties, {"mass": 1.0, "I_B": np.diag([0.1, 0.2, 0.25])}, set()),
    "BodyState": (BodyState, FALLING, set()),
    "Contact": (Contact, TOUCH, set()),
    "ContactSet": (ContactSet, CORNERS, set()),
    "Surface": (Surface, FLOOR, {"p_WS_W", "normal_W", "friction", "restitution"}),
    "World": (
        World,
        {"bodies": (BOX,), "surfaces": (Surface(**FLOOR),), "gravity_W": [0, 0, -9.8]},
        {"gravity_W"},
    ),
    "PlanarBody": (PlanarBody, {"mass": 1.0, "inertia": 0.5}, set()),
    "PlanarVelocity": (PlanarVelocity, LEAN, set()),
    "PlanarWrench": (PlanarWrench, {"f": (0.0, -9.8), "moment": 0.1}, set()),
    "PlanarContact": (PlanarContact, TIP, set()),
    "StrikingBodies": (StrikingBodies, STRIKERS, set()),
    "spatial_impact": (
        spatial_impact,
        {**WHERE, "contact": CONTACT, "velocity_tolerance": 1e-9},
        {"velocity_tolerance"},
    ),
    "several_impact": (several_impact, SEVERAL, {"velocity_tolerance"}),
    "outcomes_over_orders": (
        impact.outcomes_over_orders,
        {**SEVERAL, "most_orders": 2},
        {"velocity_tolerance", "most_orders"},
    ),
    "outcomes_at_once": (
        impact.outcomes_at_once,
        {**SEVERAL, "most_orders": 2},
        {"velocity_tolerance", "most_orders"},
    ),
    "outcomes_over_interleavings": (
        impact.outcomes_over_interleavings,
        {**SEVERAL, "samples": 1, "seed": 0},
        {"velocity_tolerance", "samples", "seed"},
    ),
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
        {"velocity_tolerance", "force_W", "torque_W", "friction_facets", "plane_normal_W"},
    ),
    "planar_impact": (
        planar_impact,
        {
            "body": ROD,
            "velocity": PlanarVelocity(**LEAN),
            "contact": PlanarContact(**TIP),
            "velocity_tolerance": 1e-9,
        },
        {"velocity_tolerance"},
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
        set(),
    ),
    "spatial_impacts": (
        impact.spatial_impacts,
        {
            "bodies": StrikingBodies(**STRIKERS),
            "normals_W": [0.0, 0.0, 1.0],
            "frictions": 0.5,
            "restitutions": 0.5,
            "velocity_tolerance": 1e-9,
        },
        {"normals_W", "frictions", "restitutions", "velocity_tolerance"},
    ),
    "planar_impact_distribution": (
        impact.planar_impact_distribution,
        {
            "body": ROD,
            "velocity": PlanarVelocity(**LEAN),
            "contact": PlanarContact(**TIP),
            "covariance": 1e-4 * np.eye(3),
            "samples": 10,
            "seed": 0,
            "velocity_tolerance": 1e-9,
        },
        {"covariance", "samples", "seed", "velocity_tolerance"},
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
        {"covariance", "samples", "seed", "velocity_tolerance"},
    ),
    "impact_sequence": (
        impact_sequence,
        {
            "body": BOX,
            "state": STATE,
            "world": WORLD,
            "window": 0.5,
            "most_strikes": 3,
            "distance_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
            "hold_step": None,
        },
        {"window", "most_strikes", "distance_tolerance", "velocity_tolerance", "hold_step"},
    ),
    "impact_sequence_of": (
        impact.impact_sequence_of,
        {
            **WHERE,
            "contacts": CONTACTS,
            "gravity_W": [0.0, 0.0, -9.8],
            "window": 0.05,
            "most_strikes": 3,
            "distance_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
            "hold_step": None,
        },
        {"gravity_W", "window", "most_strikes", "distance_tolerance", "velocity_tolerance", "hold_step"},
    ),
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
        {"horizon", "distance_tolerance", "velocity_tolerance"},
    ),
    "find_contacts": (
        find_contacts,
        {"body": BOX, "state": STATE, "surfaces": WORLD.surfaces, "distance_tolerance": 1.0},
        {"distance_tolerance"},
    ),
    "free_motion": (free_motion, {**WHERE, "gravity_W": [0.0, 0.0, -9.8]}, {"gravity_W"}),
    "state_at": (free_motion(BALL, STATE).state_at, {"seconds": 0.5}, {"seconds"}),
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
        {"velocity_tolerance", "acceleration_tolerance"},
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
        {"force_W", "torque_W", "friction_facets", "velocity_tolerance"},
    ),
    "ContactUncertainty": (ContactUncertainty, {"points": 1e-3, "normals": 1e-3, "frictions": 0.1}, set()),
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
    "spatial_pair_impact": (
        impact.spatial_pair_impact,
        {
            **WHERE,
            "other": BALL,
            "other_state": BodyState(**{**FALLING, "v_WB_W": [0, 0, 1]}),
            "contact": CONTACT,
            "velocity_tolerance": 1e-9,
        },
        {"velocity_tolerance"},
    ),
    "ContactModeQuestion": (
        ContactModeQuestion,
        {
            "body": BOX,
            "force_W": [0.0, 0.0, 1.0],
            "torque_W": [0.0, 0.0, 0.1],
            "gravity_W": [0.0, 0.0, -9.8],
            "out_of_plane_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
            "distance_tolerance": 1e-6,
            "friction_facets": 8,
            "margin_length": 0.1,
        },
        {
            "force_W",
            "torque_W",
            "gravity_W",
            "out_of_plane_tolerance",
            "velocity_tolerance",
            "distance_tolerance",
            "friction_facets",
            "margin_length",
        },
    ),
    "ImpactQuestion": (
        ImpactQuestion,
        {"body": BOX, "horizon": 1.0, "velocity_tolerance": 1e-9, "distance_tolerance": 1e-6},
        {"horizon", "velocity_tolerance", "distance_tolerance"},
    ),
    "planar_pair_impact": (
        impact.planar_pair_impact,
        {
            "body": ROD,
            "velocity": PlanarVelocity(**LEAN),
            "other": ROD,
            "other_velocity": PlanarVelocity(v=(0.0, 1.0), w=0.0),
            "contact": PlanarContact(**TIP),
            "other_r": (0.1, 0.5),
            "velocity_tolerance": 1e-9,
        },
        {"other_r", "velocity_tolerance"},
    ),
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
    "TumblingQuestion": (
        TumblingQuestion,
        {"body": BOX, "gravity_W": [0.0, 0.0, -9.8], "curve_points": 10},
        {"gravity_W", "curve_points"},
    ),
    "AtTimes": (AtTimes, {"times": [0.1, 0.2]}, set()),
    "AtRate": (AtRate, {"rate": 100.0, "duration": 0.5}, set()),
    "UntilContact": (UntilContact, {"rate": 100.0, "duration": 0.5}, set()),
    "UntilPlane": (
        UntilPlane,
        {
            "rate": 100.0,
            "duration": 0.5,
            "plane_point": [0.0, 0.0, 0.0],
            "plane_normal": [0.0, 0.0, 1.0],
            "body_point": [0.1, 0.0, 0.0],
        },
        set(),
    ),
    "PublishedState": (PublishedState, {"fit_window": 0.1}, set()),
    "ManyStates": (ManyStates, STATES, set()),
    "ManyTumblingsQuestion": (
        ManyTumblingsQuestion,
        {"body": BOX, "states": ManyStates(**STATES), "seconds": [0.5]},
        {"seconds"},
    ),
    "ManyImpactsQuestion": (
        ManyImpactsQuestion,
        {
            "body": BOX,
            "states": ManyStates(**STATES),
            "p_WC_W": [[0.1, 0.2, 0.0]],
            "normals_W": [[0.0, 0.0, 1.0]],
            "frictions": [0.5],
            "restitutions": [0.5],
            "velocity_tolerance": 1e-9,
        },
        {"p_WC_W", "normals_W", "frictions", "restitutions", "velocity_tolerance"},
    ),
    "ManyContactModesQuestion": (
        ManyContactModesQuestion,
        {
            "asked": ContactModeQuestion(body=BOX, contacts=CONTACTS),
            "forces_W": [[0.0, 0.0, 1.0]],
            "torques_W": [[0.0, 0.0, 0.1]],
            "contact_counts": (2,),
        },
        {"forces_W", "torques_W", "contact_counts"},
    ),
    "toss": (
        toss,
        {
            "body": BOX,
            "state": STATE,
            "world": WORLD,
            "horizon": 0.1,
            "most_events": 3,
            "most_alternatives": 0,
            "error": 1e-6,
        },
        {"horizon", "most_events", "most_alternatives", "error"},
    ),
}

ALIASES = {
    "I_B": ("inertia",),
    "inertia": ("inertia",),
    "p_WB_W": ("position",),
    "p_WC_W": ("position",),
    "p_WS_W": ("point",),
    "q_WB": ("orientation",),
    "v_WB_W": ("velocity",),
    "w_WB_W": ("velocity",),
    "normal_W": ("normal",),
    "normals_W": ("normals",),
    "gravity_W": ("gravity",),
    "moment": ("torque",),
    "p_FV_F": ("vertices", "triangles"),
    "frictions": ("positions",),
    "seconds": ("time",),
    "masses": ("points",),
    "p_FP_F": ("points",),
    "outline": ("vertices",),
    "forces_W": ("forces",),
    "torques_W": ("torques",),
}
"""How errors name an argument that messages and configurations have under another name.

A flat mesh is one of its triangles as much as of its vertices.
"""

NEVER = {"contact_path", "body_curvature", "surface_curvature", "semi_axes"}
"""Fields that may be infinite: a stop that never comes, a corner's curvature, an axis without inertia."""


def hostile_cases() -> Iterator[tuple[str, str, object]]:
    for name, (_, arguments, chosen) in CALLS.items():
        for argument in arguments:
            if not chosen or argument in chosen:
                for value in HOSTILE:
                    yield name, argument, value
                    good = arguments[argument]
                    if isinstance(value, float) and isinstance(good, (list, tuple, np.ndarray)):
                        worse = np.array(good, dtype=np.float64)
                        worse.ravel()[0] = value
                        yield name, argument, worse
                        yield name, argument, np.full(np.shape(good), value)


def numbers(value: object) -> Iterator[float]:
    """All numbers in a result."""
    if isinstance(value, (float, int, np.number)):
        yield float(value)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "fiu":
        yield from value.ravel().tolist()
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        for entry in dataclasses.fields(value):
            if entry.name in NEVER:
                continue
            yield from numbers(getattr(value, entry.name))
    elif isinstance(value, (list, tuple)):
        for one in value:
            yield from numbers(one)


def too_long(_number: int, _frame: FrameType | None) -> None:
    raise TimeoutError


def accepted(kind: Callable[..., object], fields: dict[str, Any], *changes: dict[str, Any]) -> list[object]:
    """Return the values that a constructor makes of fields with changes, without those that it refuses."""
    made = []
    for change in changes:
        with contextlib.suppress(ContactDynamicsError):
            made.append(kind(**{**fields, **change}))
    return made


def extreme_objects() -> dict[str, list[object]]:
    """Values that constructors accept, with a number at an end of what doubles hold, by argument."""
    sizes = (1e-300, 1e-160, 1e-60, 1e60, 1e61, 1e160, 1e300)
    moments = np.diag([0.1, 0.2, 0.25])
    mass, flat = {"mass": 1.0, "I_B": moments}, {"mass": 1.0, "inertia": 0.5}
    return {
        "body": [
            *accepted(MassProperties, mass, *({"mass": x} for x in sizes)),
            *accepted(MassProperties, mass, *({"I_B": x * moments} for x in sizes)),
            *accepted(PlanarBody, flat, *({"mass": x} for x in sizes)),
            *accepted(PlanarBody, flat, *({"inertia": x} for x in sizes)),
        ],
        "state": [
            state
            for field in ("p_WB_W", "v_WB_W", "w_WB_W")
            for state in accepted(BodyState, FALLING, *({field: [x, -x, -x]} for x in sizes))
        ],
        "contact": [
            *accepted(Contact, TOUCH, *({"friction": x} for x in sizes)),
            *accepted(Contact, TOUCH, *({"p_WC_W": [x, 0.0, 0.0]} for x in sizes)),
            *accepted(PlanarContact, TIP, *({"friction": x} for x in sizes)),
            *accepted(PlanarContact, TIP, *({"r": (x, -x)} for x in sizes)),
        ],
        "contacts": [
            *accepted(ContactSet, CORNERS, *({"frictions": [x, 0.1]} for x in sizes)),
            *accepted(ContactSet, CORNERS, *({"p_WC_W": [[x, 0, 0], [0.1, 0, 0]]} for x in sizes)),
        ],
        "velocity": accepted(PlanarVelocity, LEAN, *({"v": (x, -x)} for x in sizes)),
    }


def answered_or_refused(call: Callable[[], object]) -> str:
    """Return what is wrong with the answer, the text of a refusal after a colon, or nothing."""
    signal.signal(signal.SIGALRM, too_long)
    signal.alarm(SECONDS)
    try:
        return "" if all(map(math.isfinite, numbers(call()))) else "not finite"
    except ContactDynamicsError as error:
        return f":{error}"
    except Exception as error:  # noqa: BLE001  this is what is looked for
        return f"{type(error).__name__}: {error}"
    finally:
        signal.alarm(0)


@pytest.mark.parametrize("name", CALLS)
def test_hostile_values_are_answered_or_refused_by_name(name: str) -> None:
    call, arguments, _ = CALLS[name]
    call(**arguments)
    wrong = []
    for which, argument, value in hostile_cases():
        if which == name:
            found = answered_or_refused(lambda a=argument, v=value: call(**{**arguments, a: v}))
            named = any(one in found for one in (argument, *ALIASES.get(argument, ())))
            if found and not (found.startswith(":") and named):
                wrong.append((argument, value, found))
    assert wrong == []


@pytest.mark.parametrize(
    "name",
    # Interleavings take half a second for each of some fifty values.
    [pytest.param(one, marks=pytest.mark.slow if "interleavings" in one else ()) for one in CALLS],
)
def test_extreme_objects_are_answered_or_refused(name: str) -> None:
    call, arguments, _ = CALLS[name]
    wrong = []
    for argument, values in extreme_objects().items():
        for value in values:
            if isinstance(value, type(arguments.get(argument))):
                found = answered_or_refused(lambda a=argument, v=value: call(**{**arguments, a: v}))
                if found and not found.startswith(":"):
                    wrong.append((argument, value, found))
    assert wrong == []
