# SPDX-License-Identifier: Apache-2.0
"""What was computed in Python is drawn at its stamps, into a file that rerun opens."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

import contact_dynamics as cd
from contact_dynamics.constants import to_ns
from contact_dynamics.contact_modes import BodiesContactProblem, contact_modes
from contact_dynamics.errors import UnknownBodyError
from contact_dynamics.questions import Context, TossQuestion, ask
from contact_dynamics.viewing import view
from viewing.drawn import read_drawn

BRICK = cd.Body.box((0.15, 0.09, 0.05), mass=0.4, name="brick")
FLOOR = cd.Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.2)
WORLD = cd.World(bodies=(BRICK,), surfaces=(FLOOR,))


def test_a_motion_and_an_answer_are_drawn_at_their_stamps(tmp_path: Path) -> None:
    begin = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1], w_WB_W=[1, 2, 0])
    flight = cd.free_motion(BRICK, begin)
    motion = [flight.state_at(t) for t in np.arange(0.01, 0.1, 0.01)]
    answer = ask(TossQuestion(body="brick", state=motion[4]), Context(world=WORLD))
    view(WORLD, [answer], motions={"brick": motion}, path=tmp_path / "toss.rrd")
    drawn = read_drawn(tmp_path / "toss.rrd")
    moves = drawn.stamps("/world/bodies/brick", "Transform3D:translation")
    assert moves == [state.stamp_ns for state in motion]
    heights = drawn.series("/world/bodies/brick", "Transform3D:translation")[:, 2]
    np.testing.assert_allclose(heights, [state.p_WB_W[2] for state in motion], rtol=1e-6)  # float32
    path = next(entity for entity in drawn.entities if entity.startswith("/world/toss/brick/path"))
    assert drawn.stamps(path, "LineStrips3D:strips") == [motion[4].stamp_ns]
    RrdReader(tmp_path / "toss.rrd")  # it would warn about a missing footer, which `rerun rrd verify` wants


def test_modes_of_several_bodies_are_drawn_with_their_forces(tmp_path: Path) -> None:
    upper = cd.Body.box((0.1, 0.1, 0.1), mass=1.0, name="upper")
    lower = cd.Body.box((0.1, 0.1, 0.1), mass=2.0, name="lower")
    feet = [[x, y, z] for z in (0.0, 0.1) for x in (-0.05, 0.05) for y in (-0.05, 0.05)]
    stamp_ns = to_ns(2.0)
    problem = BodiesContactProblem(
        bodies=[lower, upper],
        states=[cd.BodyState(p_WB_W=[0, 0, z], q_WB=[0, 0, 0, 1], stamp_ns=stamp_ns) for z in (0.05, 0.15)],
        contacts=cd.ContactSet(p_WC_W=feet, normals_W=[0, 0, 1], frictions=0.5),
        pairs=[(0, None)] * 4 + [(1, 0)] * 4,
        forces_W=[[0, 0, -20.0], [0, 0, -10.0]],
    )
    world = cd.World(bodies=(lower, upper))
    motions = {body.name: [problem.states[i]] for i, body in enumerate(world.bodies)}
    view(world, [contact_modes(problem)], motions=motions, path=tmp_path / "stack.rrd")
    drawn = read_drawn(tmp_path / "stack.rrd")
    forces = "/world/contacts/lower/mode_1/forces"
    assert drawn.stamps(forces, "Arrows3D:labels") == [stamp_ns]
    labels = [float(label.removesuffix(" N")) for label in drawn.last(forces, "Arrows3D:labels")]
    assert labels == pytest.approx([7.5] * 4 + [2.5] * 4)


def test_a_motion_of_no_body_is_an_error(tmp_path: Path) -> None:
    state = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1])
    with pytest.raises(UnknownBodyError, match="ball"):
        view(WORLD, motions={"ball": [state]}, path=tmp_path / "none.rrd")
    assert not (tmp_path / "none.rrd").exists()
