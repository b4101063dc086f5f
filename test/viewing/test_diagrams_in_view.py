# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from contact_dynamics import Body, BodyState, ContactSet, MassProperties
from contact_dynamics.diagrams.planar_scene import MAX_SETS, silhouette
from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.plane import PlaneOfMotion
from contact_dynamics.questions import ContactModeAnswer, ContactModeQuestion, Context, Problem
from contact_dynamics.questions.contact_modes import answer
from contact_dynamics.viewing.diagrams_in_view import DiagramsInView
from contact_dynamics.viewing.entities import FORCE_DUAL, MODE_MAP, PLANAR_MODES
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.world import box_vertices
from viewing.drawn import STAMP_NS, Canvas
from viewing.known import WORLD

ROD = MassProperties(mass=1.0, I_B=np.eye(3))
TIP = np.array([-4.0 * math.cos(math.radians(75.0)), 0.0, -4.0 * math.sin(math.radians(75.0))])
FRICTION = math.tan(math.radians(30.0))
PLANE = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])  # x to the right, z up
ALONG = (-1.0, 0.0, 0.0)
DOWN = (0.0, 0.0, -1.0)


def answer_of(
    *,
    force: tuple[float, float, float],
    speed: float = 0.0,
    tip: np.ndarray = TIP,
    friction: float = FRICTION,
) -> ContactModeAnswer:
    """What the lecture's rod does in its plane, with margins and the map."""
    state = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=(speed, 0.0, 0.0))
    contacts = ContactSet(
        p_WC_W=tip[None], normals_W=[[0.0, 0.0, 1.0]], frictions=[friction], restitutions=[0.0]
    )
    question = ContactModeQuestion(
        body=Body(name="rod", mass_properties=ROD),
        state=state,
        contacts=contacts,
        force_W=force,
        gravity_W=np.zeros(3),
        problem=Problem.PLANAR,
        plane=PLANE,
        include_margins=True,
        include_wrenches=True,
    )
    return answer(question)


NO_OUTLINE = np.zeros((0, 2))


def test_the_modes_of_the_indeterminate_rod_stand_side_by_side(canvas: Canvas) -> None:
    outline = np.array([TIP[[0, 2]], -TIP[[0, 2]]])
    shown = DiagramsInView(canvas.stream)
    drawn_names = shown.draw_planar_modes(answer_of(force=ALONG), PLANE, outline=outline, body=ROD)
    assert drawn_names == [PLANAR_MODES, MODE_MAP, FORCE_DUAL]
    drawn = canvas.read()
    titles = [
        drawn.last(f"/planar_modes/mode_{i}/frame/title", "LineStrips2D:labels")[-1].splitlines()
        for i in (1, 2)
    ]
    assert {first for first, _ in titles} == {"f: it turns (1 contact stays fixed)", "l: it slides left"}
    assert all(" N to " in second for _, second in titles)
    places = [
        drawn.array(f"/planar_modes/mode_{i}/body", "LineStrips2D:strips").reshape(-1, 2) for i in (1, 2)
    ]
    assert places[1].min(axis=0)[0] - places[0].max(axis=0)[0] > 1.0
    np.testing.assert_allclose(places[1][:, 1], places[0][:, 1])


def test_the_inconsistent_rod_says_so_and_has_no_force_dual(canvas: Canvas) -> None:
    shown = DiagramsInView(canvas.stream)
    shown.draw_planar_modes(answer_of(force=ALONG), PLANE, outline=NO_OUTLINE, body=ROD)
    found = answer_of(force=(0.0, 0.0, -9.81), speed=-1.0)
    names = shown.draw_planar_modes(found, PLANE, outline=NO_OUTLINE, body=ROD)
    assert names == [PLANAR_MODES, MODE_MAP]
    drawn = canvas.read()
    title = drawn.last("/planar_modes/mode_1/frame/title", "LineStrips2D:labels")[-1]
    assert title == "no consistent mode"
    assert len(drawn.values["/planar_modes/mode_2/frame/title", "LineStrips2D:labels"]) == 1
    assert drawn.values["/planar_modes", "Clear:is_recursive"] == [(STAMP_NS, [True])] * 2
    assert "black: none" in drawn.last("/mode_map/frame/title", "LineStrips2D:labels")[-1]
    assert drawn.last("/force_dual", "Clear:is_recursive") == [True]
    assert len(drawn.values["/force_dual/wrenches", "Image:buffer"]) == 1


def test_a_map_that_looks_as_before_is_not_drawn_again(canvas: Canvas) -> None:
    shown = DiagramsInView(canvas.stream)
    found = answer_of(force=ALONG)
    for each in (
        found,
        answer_of(force=DOWN, tip=TIP * (1.001, 1.0, 1.0)),
        answer_of(force=ALONG, friction=0.9),
        replace(found, wrench_sets=None),
    ):
        shown.draw_planar_modes(each, PLANE, outline=NO_OUTLINE, body=ROD)
    drawn = canvas.read()
    assert len(drawn.values["/mode_map/regions", "Image:buffer"]) == 2
    places = drawn.values["/mode_map/applied", "Points2D:positions"]
    assert len(places) == 3
    assert places[0][1] != places[1][1]
    notes = [texts[0] for _, texts in drawn.values["/mode_map/frame/notes/applied", "LineStrips2D:labels"]]
    assert [note.partition(" N,")[0] for note in notes] == [
        "applied: (-1, 0)",
        "applied: (0, -1)",
        "applied: (-1, 0)",
    ]


def test_of_a_body_that_is_not_known_the_applied_wrench_is_not_drawn(canvas: Canvas) -> None:
    shown = DiagramsInView(canvas.stream)
    shown.draw_planar_modes(answer_of(force=ALONG), PLANE, outline=NO_OUTLINE, body=None)
    drawn = canvas.read()
    assert ("/mode_map/regions", "Image:buffer") in drawn.values
    assert ("/mode_map/applied", "Points2D:positions") not in drawn.values
    assert "/mode_map/frame/notes/applied" not in drawn.entities


def test_a_map_of_too_many_modes_is_left_out(canvas: Canvas) -> None:
    found = answer_of(force=ALONG)
    assert found.wrench_sets is not None
    many = replace(found, wrench_sets=found.wrench_sets[:1] * (MAX_SETS + 1))
    DiagramsInView(canvas.stream).draw_planar_modes(many, PLANE, outline=NO_OUTLINE, body=ROD)
    drawn = canvas.read()
    assert drawn.last("/mode_map", "Clear:is_recursive") == [True]
    assert "/mode_map/regions" not in drawn.entities


def test_a_silhouette_is_the_hull_as_seen() -> None:
    box = convex_shape(box_vertices((0.4, 0.2, 0.1)))
    strip = silhouette(box, np.eye(3)[[0, 2]])
    assert len(strip) == 5
    np.testing.assert_allclose(strip[0], strip[-1])
    np.testing.assert_allclose(np.ptp(strip, axis=0), [0.4, 0.1])
    rod = convex_shape(np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    assert len(silhouette(rod, np.eye(3)[:2])) == 2
    assert len(silhouette(convex_shape(np.zeros((0, 3))), np.eye(3)[:2])) == 0


def test_the_force_dual_shows_the_wrench_in_question_and_the_acceleration_centre(canvas: Canvas) -> None:
    """A brick on two feet is pushed aside and lifted on the left, so that it tips about its right foot.

    A body at rest accelerates about the foot that stays, where the lecture has the centre. The force dual of
    a wrench is the centre about which it would turn the free body.
    """
    (brick,) = WORLD.bodies
    feet = np.array([[-0.075, 0.0, 0.0], [0.075, 0.0, 0.0]])
    known = brick.mass_properties
    weight = known.mass * 9.80665
    question = ContactModeQuestion(
        body="brick",
        state=BodyState(p_WB_W=[0, 0, 0.025], q_WB=[0, 0, 0, 1]),
        contacts=ContactSet(p_WC_W=feet, normals_W=[[0.0, 0.0, 1.0]] * 2, frictions=2.0, restitutions=0.0),
        torque_W=[0.0, 0.1 * weight, 0.0],
        problem=Problem.PLANAR,
        plane=PLANE,
        include_wrenches=True,
    )
    found = answer(question, Context(world=WORLD))
    assert [mode.mode for mode in found.modes] == ["sf"]
    picture = Picture(canvas.stream, WORLD, surface_side=1.0)
    for stamp_ns in (1, 2):
        picture.show(found, now_ns=stamp_ns)
    drawn = canvas.read()
    assert len(drawn.values["/force_dual/wrenches", "Image:buffer"]) == 1  # the second is the same
    places = {
        name: drawn.array(f"/force_dual/answer/{name}", "Points2D:positions")[0]
        for name in ("acceleration_centre", "applied_wrench")
    }
    # Pictures of the body, below the construction, tell where its points are on the clockwise half.
    strips = [np.array(strip) for strip in drawn.last("/force_dual/outlines", "LineStrips2D:strips")]
    low, high = np.min(strips[1], axis=0), np.max(strips[1], axis=0)
    middle, scale = 0.5 * (low + high), float(high[0] - low[0]) / 0.15  # points, points per m
    np.testing.assert_allclose(
        places["acceleration_centre"], middle + scale * np.array([0.075, 0.025]), atol=0.1
    )
    rho_square = known.I_B[1, 1] / known.mass
    beside = -rho_square / 0.1  # m: the weight moves the body down, the torque moves points on the left up
    np.testing.assert_allclose(places["applied_wrench"], middle + scale * np.array([beside, 0.0]), atol=0.1)
    frames = np.vstack(drawn.last("/force_dual/outline", "LineStrips2D:strips"))
    for name in ("acceleration_centre", "applied_wrench"):  # beside the chart, where they cover nothing
        words = drawn.last(f"/force_dual/frame/notes/answer/{name}", "LineStrips2D:strips")
        assert words[0][0][0] > frames[:, 0].max()
