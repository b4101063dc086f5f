# SPDX-License-Identifier: Apache-2.0
"""A small world that the tests of questions ask about, and a question of each kind with its answer."""

from __future__ import annotations

import math
from typing import Any

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, Surface, World
from contact_dynamics.questions import (
    AtTimes,
    ContactModeQuestion,
    Context,
    Defaults,
    ImpactQuestion,
    TumblingQuestion,
    ask,
)
from contact_dynamics.world import box_vertices

GRAVITY = 9.80665  # m/s^2
MASS = 2.0  # kg
SIDE = 0.2  # m, of a cube
MOMENT = MASS * SIDE * SIDE / 6.0  # kg m^2, about any axis
FRICTION, RESTITUTION = 0.4, 0.5

CUBE = Body(
    name="cube",
    mass_properties=MassProperties(mass=MASS, I_B=[[MOMENT, 0, 0], [0, MOMENT, 0], [0, 0, MOMENT]]),
    vertices_B=box_vertices([SIDE, SIDE, SIDE]),
)
FLOOR = Surface(
    name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=FRICTION, restitution=RESTITUTION
)
WORLD = World(bodies=(CUBE,), surfaces=(FLOOR,))
CONTEXT = Context(world=WORLD, defaults=Defaults(distance_tolerance=1e-9))


def state(
    height: float = 1.0,
    *,
    v: tuple[float, float, float] = (0.0, 0.0, 0.0),
    w: tuple[float, float, float] = (0.0, 0.0, 0.0),
    stamp_ns: int = 0,
) -> BodyState:
    """Return a state of the cube with its faces along the axes, its centre above the floor by a height, m."""
    return BodyState(p_WB_W=[0, 0, height], q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=w, stamp_ns=stamp_ns)


RESTING = state(0.5 * SIDE)


def below(*, friction: float = FRICTION, restitution: float = RESTITUTION, height: float = 1.0) -> ContactSet:
    """Return one contact, straight below the centre of mass, of a cube at a height, m."""
    return ContactSet(
        p_WC_W=[[0, 0, height - 0.5 * SIDE]],
        normals_W=[[0, 0, 1]],
        frictions=[friction],
        restitutions=[restitution],
    )


def ask_each() -> dict[str, Any]:
    """Ask a question of each kind; return what each answer says, as JSON has it."""
    spinning = state(v=(1.0, 0.0, 0.0), w=(0.0, 3.0, 0.1))
    falling = state(v=(0.3, 0.0, -1.0), w=(0.0, 2.0, 0.0))
    answers = {
        "tumbling": ask(
            TumblingQuestion(body=CUBE, state=spinning, sampling=AtTimes(times=[0.0, 0.1]), curve_points=3)
        ),
        "impact": ask(ImpactQuestion(body="cube", state=falling), CONTEXT),
        "contact_modes": ask(
            ContactModeQuestion(
                body="cube",
                state=RESTING,
                force_W=[math.pi, 0, 0],
                include_margins=True,
                include_statics=True,
            ),
            CONTEXT,
        ),
    }
    return {name: one.to_dict() for name, one in answers.items()}
