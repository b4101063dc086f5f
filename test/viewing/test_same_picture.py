# SPDX-License-Identifier: Apache-2.0
"""An answer from Python and the same answer out of a response give the same picture."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rerun as rr

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import (
    AtRate,
    BodiesContactModeQuestion,
    ContactModeQuestion,
    Context,
    ImpactQuestion,
    Problem,
    TossQuestion,
    TossSampling,
    TumblingQuestion,
    UncertainState,
    bodies_contact_modes,
    contact_modes,
    impact,
    toss,
    tumbling,
)
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.world import Body, World
from msg_adapters.bodies_contact_mode import (
    bodies_contact_mode_answer_from_msg,
    bodies_contact_mode_answer_to_msg,
)
from msg_adapters.contact_mode import contact_mode_answer_from_msg, contact_mode_answer_to_msg
from msg_adapters.impact import impact_answer_from_msg, impact_answer_to_msg
from msg_adapters.toss import toss_answer_from_msg, toss_answer_to_msg
from msg_adapters.tumbling import tumbling_answer_from_msg, tumbling_answer_to_msg
from viewing.drawn import STAMP_NS, Drawn, read_drawn
from viewing.known import WORLD

FALLING = BodyState(
    p_WB_W=[0.1, -0.2, 0.5],
    q_WB=[0.1, -0.5, 0.7, 0.5],
    v_WB_W=[0.5, 0.3, -1.0],
    w_WB_W=[3.0, -8.0, 1.0],
    stamp_ns=STAMP_NS,
)
SEEN_FROM_THE_SIDE = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])


def draw_tumbling(picture: Picture, world: World, read_back: Callable[[Any], Any]) -> None:
    question = TumblingQuestion(
        body="brick", state=FALLING, sampling=AtRate(rate=50.0, duration=0.5), curve_points=40
    )
    answer = tumbling.answer(question, Context(world=world))
    picture.show(read_back(answer))


def draw_impact(picture: Picture, world: World, read_back: Callable[[Any], Any]) -> None:
    answer = impact.answer(ImpactQuestion(body="brick", state=FALLING), Context(world=world))
    picture.show(read_back(answer))


def draw_modes(picture: Picture, world: World, read_back: Callable[[Any], Any]) -> None:
    resting = BodyState(p_WB_W=[0.0, 0.0, 0.025], q_WB=[0, 0, 0, 1], stamp_ns=STAMP_NS)
    question = ContactModeQuestion(
        body="brick",
        state=resting,
        contacts=ContactSet(
            p_WC_W=[[-0.075, 0.0, 0.0], [0.075, 0.0, 0.0]],
            normals_W=[0.0, 0.0, 1.0],
            frictions=0.3,
            restitutions=0.5,
        ),
        force_W=[1.5, 0.0, 0.0],
        problem=Problem.PLANAR,
        plane=SEEN_FROM_THE_SIDE,
        include_margins=True,
        include_wrenches=True,
        include_statics=True,
    )
    picture.show(read_back(contact_modes.answer(question, Context(world=world))))


def draw_bodies(picture: Picture, world: World, read_back: Callable[[Any], Any]) -> None:
    """The brick on the floor, and a box on it that nobody has configured."""
    box = Body.box((0.05, 0.05, 0.05), mass=0.2, name="box")
    feet = [[x, y, z] for z in (0.0, 0.05) for x, y in ((0.02, 0.0), (-0.02, 0.02), (-0.02, -0.02))]
    question = BodiesContactModeQuestion(
        bodies=["brick", box],
        states=[
            BodyState(p_WB_W=[0, 0, z], q_WB=[0, 0, 0, 1], stamp_ns=STAMP_NS + i)
            for i, z in enumerate((0.025, 0.075))
        ],
        contacts=ContactSet(p_WC_W=feet, normals_W=[0, 0, 1], frictions=[0.5] * 3 + [0.2] * 3),
        pairs=[(0, None)] * 3 + [(1, 0)] * 3,
        forces_W=[[0, 0, 0], [0.6, 0, 0]],
    )
    picture.show(read_back(bodies_contact_modes.answer(question, Context(world=world))))


def draw_toss(picture: Picture, world: World, read_back: Callable[[Any], Any]) -> None:
    question = TossQuestion(
        body="brick",
        state=UncertainState(state=FALLING, covariance=1e-4 * np.eye(12)),
        max_alternatives=1,
        sampling=TossSampling(count=25),
    )
    picture.show(read_back(toss.answer(question, Context(world=world))))


PAIRS = {
    draw_toss: (toss_answer_to_msg, toss_answer_from_msg),
    draw_tumbling: (tumbling_answer_to_msg, tumbling_answer_from_msg),
    draw_impact: (impact_answer_to_msg, impact_answer_from_msg),
    draw_modes: (contact_mode_answer_to_msg, contact_mode_answer_from_msg),
    draw_bodies: (bodies_contact_mode_answer_to_msg, bodies_contact_mode_answer_from_msg),
}


@pytest.mark.parametrize("draw", PAIRS)
def test_a_response_and_its_answer_are_drawn_alike(
    draw: Callable[[Picture, World, Callable[[Any], Any]], None], tmp_path: Path
) -> None:
    to_msg, from_msg = PAIRS[draw]

    def drawn(name: str, read_back: Callable[[Any], Any]) -> Drawn:
        path = tmp_path / f"{name}.rrd"
        stream = rr.RecordingStream("test")
        stream.save(path)
        draw(Picture(stream, WORLD, surface_side=2.0), WORLD, read_back)
        stream.disconnect()
        return read_drawn(path)

    asked = drawn("asked", lambda answer: answer)
    served = drawn("served", lambda answer: from_msg(to_msg(answer, world_frame="map"), world=WORLD))
    described = {key for key in asked.values if key[0] != "/__properties"}  # when it was made
    assert described == {key for key in served.values if key[0] != "/__properties"}
    assert len(described) > 30
    for key in described:
        if served.values[key] != asked.values[key]:  # as they are where one of the numbers is NaN
            np.testing.assert_equal(served.values[key], asked.values[key])
