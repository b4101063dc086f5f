# SPDX-License-Identifier: Apache-2.0
"""Ordinary values, of which calls are made before one of their arguments becomes hostile."""

from collections.abc import Callable
from typing import Any

import numpy as np

from contact_dynamics import (
    Body,
    BodyState,
    Contact,
    ContactSet,
    MassProperties,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarWrench,
    SpatialContactProblem,
    Surface,
    World,
    shapes,
)

Calls = dict[str, tuple[Callable[..., Any], dict[str, Any]]]
"""By name: a call, and arguments that it takes. It may have further ones with a default."""

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
LYING = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1])
WORLD = World(bodies=(BOX,), surfaces=(Surface(**FLOOR),))
HELD = SpatialContactProblem.of(BOX, LYING, WORLD)
ROD, LEAN = PlanarBody(mass=1.0, inertia=0.5), {"v": (0.3, -1.0), "w": 0.5}
TIP = {"r": (0.2, -0.5), "normal": (0.0, 1.0), "friction": 0.5, "restitution": 0.5}
PUSH = PlanarWrench(f=(0.3, -9.8), moment=0.1)
FLAT = PlanarContactProblem(body=ROD, contacts=(PlanarContact(**TIP),), wrench=PUSH)
RESTING = BodyState(**{**FALLING, "v_WB_W": [0, 0, 0], "w_WB_W": [0, 0, 0]})
DEEP = SpatialContactProblem(
    body=BALL, state=RESTING, contacts=CONTACTS, force_W=[0.0, 0.0, -9.8], friction_facets=4
)
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
