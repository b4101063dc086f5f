# SPDX-License-Identifier: Apache-2.0
"""A body deep in a surface is an error wherever contacts are found, never a landing at once or a rest."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from contact_dynamics import (
    Body,
    BodyState,
    MassProperties,
    Surface,
    World,
    find_contacts,
    impact_sequence,
    next_landing,
)
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.questions import contact_modes as modes_questions
from contact_dynamics.questions import impact as impact_questions
from contact_dynamics.questions import toss as toss_questions
from contact_dynamics.questions import tumbling as tumbling_questions
from contact_dynamics.questions.contact_modes import ContactModeQuestion
from contact_dynamics.questions.context import Context, Defaults
from contact_dynamics.questions.impact_question import ImpactQuestion, InTime
from contact_dynamics.questions.sample_times import UntilContact
from contact_dynamics.questions.toss import TossQuestion
from contact_dynamics.questions.tumbling import TumblingQuestion
from contact_dynamics.shapes import box, cylinder, rounded
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.toss.one_toss import toss
from contact_dynamics.toss.sampled import sampled_toss

MASS = MassProperties(mass=0.4, I_B=4e-4 * np.eye(3))
CUBE = Body(name="cube", mass_properties=MASS, shape=box(size=(0.1, 0.1, 0.1)))
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.3)
WORLD = World(bodies=(CUBE,), surfaces=(FLOOR,))


def sunk(depth: float) -> BodyState:
    return BodyState(p_WB_W=[0, 0, 0.05 - depth], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -0.5])


def known(tolerance: float) -> Context:
    return Context(world=WORLD, defaults=Defaults(distance_tolerance=tolerance))


FINDERS: dict[str, Callable[[float, float], object]] = {
    "contacts": lambda d, t: find_contacts(CUBE, sunk(d), WORLD, distance_tolerance=t),
    "landing": lambda d, t: next_landing(CUBE, sunk(d), WORLD, horizon=1.0, distance_tolerance=t),
    "in time": lambda d, t: impact_sequence(CUBE, sunk(d), WORLD, distance_tolerance=t),
    "toss": lambda d, t: toss(CUBE, sunk(d), WORLD, distance_tolerance=t),
    "samples": lambda d, t: sampled_toss(
        CUBE,
        sunk(d),
        WORLD,
        count=2,
        restitution_law=RestitutionLaw.POISSON,
        horizon=1.0,
        distance_tolerance=t,
    ),
    "modes' question": lambda d, t: modes_questions.answer(
        ContactModeQuestion(body="cube", state=sunk(d), distance_tolerance=t), known(1e-6)
    ),
    "impact's question": lambda d, t: impact_questions.answer(
        ImpactQuestion(body="cube", state=sunk(d), distance_tolerance=t), known(1e-6)
    ),
    "question in time": lambda d, t: impact_questions.answer(
        ImpactQuestion(body="cube", state=sunk(d), several_contacts_law=InTime()), known(t)
    ),
    "toss's question": lambda d, t: toss_questions.answer(TossQuestion(body="cube", state=sunk(d)), known(t)),
    "flight's question": lambda d, t: tumbling_questions.answer(
        TumblingQuestion(body="cube", state=sunk(d), sampling=UntilContact()), known(t)
    ),
}


@pytest.mark.parametrize("name", FINDERS)
def test_a_body_in_the_floor_is_an_error_that_names_the_depth(name: str) -> None:
    expected = (
        r"^state must be at most 0\.001 m deep in a surface \(distance_tolerance\), "
        r"got 'cube' 0\.05 m deep in 'floor' \(is p_WB_W that of the centre of mass\?\)$"
    )
    with pytest.raises(InvalidFieldError, match=expected):
        FINDERS[name](0.05, 0.001)  # the centre of mass at the height of the floor
    FINDERS[name](0.0005, 0.001)  # noise of measured poses
    with pytest.raises(
        InvalidFieldError, match=r"1e-06 m.* \(measured poses need a larger distance_tolerance\)$"
    ):
        FINDERS[name](0.0005, 0.0)


@pytest.mark.parametrize(
    ("shape", "height"),
    [
        (box(size=(0.2, 0.2, 0.2)), 0.1),
        (cylinder(radius=0.1, length=0.3), 0.15),
        (rounded(box(size=(0.1, 0.1, 0.1)), radius=0.05), 0.1),
    ],
)
@pytest.mark.parametrize("depth", [2e-6, 0.03])
def test_the_depth_is_that_of_the_lowest_point(shape: ConvexShape, height: float, depth: float) -> None:
    body = Body(name="it", mass_properties=MASS, shape=shape)
    table = Obstacle(
        name="table",
        vertices_W=[[x, y, z] for x in (-2, 2) for y in (-2, 2) for z in (-1, 0)],
        friction=0,
        restitution=0,
    )
    state = BodyState(p_WB_W=[0, 0, height - depth], q_WB=[0, 0, 0, 1])
    for surface in (FLOOR, table):
        with pytest.raises(InvalidFieldError, match=rf"'it' {depth:.6g}\d* m deep in '{surface.name}'"):
            find_contacts(body, state, World(surfaces=(surface,)))
        assert (
            len(find_contacts(body, state, World(surfaces=(surface,)), distance_tolerance=1.01 * depth)) > 0
        )


def test_a_ceiling_and_a_wall_count_from_their_own_side() -> None:
    ceiling = Surface(name="ceiling", p_WS_W=[0, 0, 1], normal_W=[0, 0, -1], friction=0.3, restitution=0.3)
    for height in (0.9, 0.95):
        free = BodyState(p_WB_W=[0, 0, height], q_WB=[0, 0, 0, -1])
        found = find_contacts(CUBE, free, World(surfaces=(FLOOR, ceiling)))
        assert len(found) == (4 if math.isclose(height, 0.95) else 0)
    through = BodyState(p_WB_W=[0, 0, 0.96], q_WB=[0, 0, 0, 1])
    with pytest.raises(InvalidFieldError, match=r"0\.01 m deep in 'ceiling'"):
        find_contacts(CUBE, through, World(surfaces=(FLOOR, ceiling)))
