# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import rerun as rr

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.diagrams.contact_scene import friction_cones
from contact_dynamics.diagrams.impact_scene import LABEL_DEPTH, impact_marks, main_strikes
from contact_dynamics.diagrams.impulse_space import main_contact
from contact_dynamics.diagrams.shape import Shape, convex_shape
from contact_dynamics.impact import ImpactOutcome, PathEvent, SequenceStrike
from contact_dynamics.questions import ImpactAnswer, NamedState
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray
from contact_dynamics.viewing.drawing import draw_marks
from viewing.answers import impact_answer, of_two
from viewing.drawn import Canvas
from viewing.known import BODY, STATE, TWO_CONTACTS

IMPACT = "/world/impact/brick"


def draw_impact(
    recording: rr.RecordingStream, shape: Shape, answer: ImpactAnswer, *, other_shape: Shape | None = None
) -> None:
    draw_marks(recording, impact_marks(shape, answer, other_shape=other_shape), IMPACT)


def answer_of(state: BodyState, contacts: ContactSet, impulses: FloatArray) -> ImpactAnswer:
    return impact_answer(
        state,
        contacts,
        impulses_W=impulses,
        path_W=np.array([[0.0, 0.0, 0.0], impulses[1]]),
        path_events=(PathEvent.START, PathEvent.RESTITUTION_ENDS),
        path_contacts=(1, 1),
        v_after_W=(0.25, 0.1, 0.5),
    )


def test_arrows_point_along_what_they_stand_for_and_say_how_much(canvas: Canvas) -> None:
    impulses = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.4]])
    shape = convex_shape(BODY.vertices_B)
    draw_impact(canvas.stream, shape, answer_of(STATE, TWO_CONTACTS, impulses))
    drawn = canvas.read()
    assert drawn.last(f"{IMPACT}/impulse_label", "Points3D:labels") == ["0.5 N s"]
    arrow = drawn.array(f"{IMPACT}/impulse", "Arrows3D:vectors")
    np.testing.assert_allclose(np.cross(arrow, impulses[1:]), [[0.0, 0.0, 0.0]], atol=1e-7)
    assert arrow[0] @ impulses[1] > 0.0
    np.testing.assert_allclose(
        drawn.array(f"{IMPACT}/impulse", "Arrows3D:origins"), [[-0.1, 0, 0]], rtol=1e-6
    )
    (place,) = drawn.array(f"{IMPACT}/impulse_label", "Points3D:positions")
    np.testing.assert_allclose(place, [-0.1, 0.0, -LABEL_DEPTH * shape.size], rtol=1e-6)
    before, after = drawn.array(f"{IMPACT}/velocity", "Arrows3D:vectors")
    np.testing.assert_allclose(before / after, STATE.v_WB_W / [0.25, 0.1, 0.5], rtol=1e-5)  # one scale
    np.testing.assert_allclose(
        drawn.array(f"{IMPACT}/point", "Points3D:positions"), [[-0.1, 0, 0]], rtol=1e-6
    )


def test_an_impact_without_impulse_is_drawn(canvas: Canvas) -> None:
    answer = answer_of(STATE, TWO_CONTACTS, np.zeros((2, 3)))
    draw_impact(canvas.stream, convex_shape(BODY.vertices_B), answer)
    drawn = canvas.read()
    assert (f"{IMPACT}/impulse", "Arrows3D:vectors") not in drawn.values
    assert drawn.last(f"{IMPACT}/cone", "Clear:is_recursive") == [False]


def test_the_path_of_the_impulse_rises_from_its_contact_to_the_arrows_tip(canvas: Canvas) -> None:
    impulses = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.4]])
    draw_impact(canvas.stream, convex_shape(BODY.vertices_B), answer_of(STATE, TWO_CONTACTS, impulses))
    drawn = canvas.read()
    (path,) = drawn.array(f"{IMPACT}/impulse_path", "LineStrips3D:strips")
    np.testing.assert_allclose(path[0], [-0.1, 0.0, 0.0], atol=1e-7)
    arrow = drawn.array(f"{IMPACT}/impulse", "Arrows3D:vectors")[0]
    np.testing.assert_allclose(path[-1] - path[0], arrow, atol=1e-6)


def test_a_body_that_is_struck_is_drawn_with_its_velocities(canvas: Canvas) -> None:
    struck = replace(STATE, p_WB_W=np.array([2.0, 0.0, 0.0]), v_WB_W=np.array([0.0, 0.0, 1.0]))
    other = NamedState(name="bat", p_FB_F=np.zeros(3), state=struck)
    after = replace(struck, v_WB_W=np.array([0.0, 0.0, 0.5]))
    impulses = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.4]])
    answer = of_two(answer_of(STATE, TWO_CONTACTS, impulses), other, other_after=after)
    shape = convex_shape(BODY.vertices_B)
    draw_impact(canvas.stream, shape, answer, other_shape=shape)
    drawn = canvas.read()
    assert drawn.last(f"{IMPACT}/velocity_label", "Points3D:labels")[2:] == [
        "before 1 m/s",
        "predicted after 0.5 m/s",
    ]
    origins = drawn.array(f"{IMPACT}/velocity", "Arrows3D:origins")[2:]
    before, _ = drawn.array(f"{IMPACT}/velocity", "Arrows3D:vectors")[2:]
    np.testing.assert_allclose([origins[0] + before, origins[1]], np.tile([2.0, 0.0, 0.0], (2, 1)))
    edges = drawn.array(f"{IMPACT}/body", "LineStrips3D:strips")
    assert len(edges) == 2 * len(shape.edges_B)
    assert edges[len(shape.edges_B) :, :, 0].min() > 1.5


def test_of_strikes_in_sequence_the_largest_are_numbered(canvas: Canvas) -> None:
    sizes = [0.2, 0.01, 0.15, 0.1, 0.3, 0.02, 0.05]
    strikes = tuple(
        SequenceStrike(
            seconds=0.004 * i,
            contact=(i + 1) % 2,
            outcome=ImpactOutcome.SLIDES,
            p_WC_W=TWO_CONTACTS.p_WC_W[(i + 1) % 2],
            impulse_W=np.array([0.0, 0.0, size]),
            state_before=replace(STATE, p_WB_W=STATE.p_WB_W + np.array([0.0, 0.0, 0.01 * i])),
            state_after=STATE,
        )
        for i, size in enumerate(sizes)
    )
    assert main_strikes(strikes) == [0, 2, 3, 4, 6]
    at_once = answer_of(STATE, TWO_CONTACTS, np.tile([0.0, 0.0, 0.2], (2, 1)))
    answer = replace(at_once, impact=replace(at_once.impact, strikes=strikes))
    assert main_contact(answer.impact) == 1
    shape = convex_shape(BODY.vertices_B)
    draw_impact(canvas.stream, shape, answer)
    drawn = canvas.read()
    assert drawn.last(f"{IMPACT}/impulse_label", "Points3D:labels") == [
        "1. at 0.0 ms: 0.2 N s",
        "3. at 8.0 ms: 0.15 N s",
        "4. at 12.0 ms: 0.1 N s",
        "5. at 16.0 ms: 0.3 N s",
        "7. at 24.0 ms: 0.05 N s",
    ]
    assert len(drawn.array(f"{IMPACT}/impulse", "Arrows3D:vectors")) == len(sizes)
    assert len(drawn.array(f"{IMPACT}/normal", "Arrows3D:origins")) == 2
    assert len(drawn.array(f"{IMPACT}/body", "LineStrips3D:strips")) == 6 * len(shape.edges_B)


@pytest.mark.parametrize("friction", [1e-3, 0.3, 1.0, 50.0])
def test_a_friction_cone_opens_by_the_friction_angle(friction: float) -> None:
    normal = np.array([0.6, 0.0, 0.8])
    cones = friction_cones(
        "cones", np.array([[1.0, 2.0, 3.0]]), normal[None], np.array([friction]), height=0.1
    )
    apex, rim = cones.corners[0], cones.corners[1:]
    np.testing.assert_allclose(apex, [1.0, 2.0, 3.0])
    along = (rim - apex) @ normal
    across = np.linalg.norm(rim - apex - np.outer(along, normal), axis=1)
    np.testing.assert_allclose(np.arctan2(across, along), math.atan(friction), atol=1e-12)


def test_cones_of_several_contacts_do_not_share_triangles() -> None:
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    normals, frictions = np.tile([0.0, 0.0, 1.0], (3, 1)), np.array([0.5, 0.0, 0.5])
    cones = friction_cones("cones", points, normals, frictions, height=0.1)
    triangles = cones.corners[cones.fan]
    assert np.ptp(triangles[..., 0], axis=1).max() < 0.2
    assert {round(x) for x in triangles[..., 0].ravel().tolist()} == {0, 2}


def test_without_friction_there_is_no_cone() -> None:
    up = np.array([[0.0, 0.0, 1.0]])
    assert len(friction_cones("cones", np.zeros((1, 3)), up, np.zeros(1), height=0.1).fan) == 0
