from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.diagrams.planar_modes import MAX_SETS
from contact_dynamics.diagrams.planar_scene import silhouette
from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ContactModeQuestion, Context, Problem
from contact_dynamics.questions.contact_modes import answer
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.planar_dual import draw_planar_dual
from contact_dynamics.viewing.planar_modes import draw_planar_map, draw_planar_modes
from contact_dynamics.world import Body, World, box_vertices

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.questions import ContactModeAnswer
    from viewing.drawn import Drawn

ROD = MassProperties(mass=1.0, I_B=np.eye(3))
TIP = np.array([-4.0 * math.cos(math.radians(75.0)), 0.0, -4.0 * math.sin(math.radians(75.0))])
FRICTION = math.tan(math.radians(30.0))
PLANE = PlaneOfMotion(normal_W=np.array([0.0, -1.0, 0.0]))  # x to the right, z up
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
    state = BodyState(
        p_WB_W=np.zeros(3), q_WB=np.array([0.0, 0.0, 0.0, 1.0]), v_WB_W=(speed, 0.0, 0.0), w_WB_W=np.zeros(3)
    )
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


def test_the_modes_of_the_indeterminate_rod_stand_side_by_side(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    found = answer_of(force=ALONG)
    draw_planar_modes(recording, found, PLANE, outline=np.array([TIP[[0, 2]], -TIP[[0, 2]]]))
    drawn = read()
    titles = [drawn.last(f"/planar_modes/mode_{i}/title", "LineStrips2D:labels")[0] for i in (1, 2)]
    assert sorted(title[0] for title in titles) == ["f", "l"]
    assert all(" N from " in title for title in titles)
    assert {title.partition(" (")[0] for title in titles} == {"f: it stays fixed", "l: it slides left"}
    places = [drawn.array(f"/planar_modes/mode_{i}/contacts", "Points2D:positions")[0] for i in (1, 2)]
    assert places[1][0] - places[0][0] > 2.0 * abs(TIP[0]) + 1.0
    assert places[1][1] == places[0][1]
    assert drawn.last("/planar_modes/mode_3", "Clear:is_recursive") == [True]


def test_the_inconsistent_rod_says_so(recording: rr.RecordingStream, read: Callable[[], Drawn]) -> None:
    found = answer_of(force=(0.0, 0.0, -9.81), speed=-1.0)
    draw_planar_modes(recording, found, PLANE, outline=np.zeros((0, 2)))
    draw_planar_map(recording, found, PLANE, None, body=ROD)
    drawn = read()
    assert drawn.last("/planar_modes/mode_1/title", "LineStrips2D:labels") == ["no consistent mode"]
    assert drawn.last("/planar_modes/mode_2", "Clear:is_recursive") == [True]
    assert "black: none is" in drawn.last("/mode_map/captions", "LineStrips2D:labels")[-1]


def test_a_map_that_looks_as_before_is_not_drawn_again(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    found = answer_of(force=ALONG)
    nearly = answer_of(force=DOWN, tip=TIP * (1.001, 1.0, 1.0))
    drawn_map = draw_planar_map(recording, found, PLANE, None, body=ROD)
    assert draw_planar_map(recording, nearly, PLANE, drawn_map, body=ROD) is drawn_map
    other = draw_planar_map(recording, answer_of(force=ALONG, friction=0.9), PLANE, drawn_map, body=ROD)
    assert other is not drawn_map
    assert draw_planar_map(recording, replace(found, wrench_sets=None), PLANE, other, body=ROD) is other
    drawn = read()
    assert len(drawn.values["/mode_map/regions", "Image:buffer"]) == 2
    assert len(drawn.values["/mode_map/applied", "Points2D:positions"]) == 3


def test_of_a_body_that_is_not_known_the_applied_wrench_is_not_drawn(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    draw_planar_map(recording, answer_of(force=ALONG), PLANE, None)
    drawn = read()
    assert ("/mode_map/regions", "Image:buffer") in drawn.values
    assert drawn.last("/mode_map/applied", "Clear:is_recursive") == [True]


def test_a_map_of_too_many_modes_is_left_out(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    found = answer_of(force=ALONG)
    assert found.wrench_sets is not None
    many = replace(found, wrench_sets=found.wrench_sets[:1] * (MAX_SETS + 1))
    assert draw_planar_map(recording, many, PLANE, None) is None
    drawn = read()
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


def test_the_force_dual_shows_the_wrench_in_question_and_the_acceleration_centre(
    recording: rr.RecordingStream, read: Callable[[], Drawn], world: World
) -> None:
    """A brick on two feet is pushed aside and lifted on the left, so that it tips about its right foot.

    A body at rest accelerates about the foot that stays, where the lecture has the centre. The force dual of
    a wrench is the centre about which it would turn the free body.
    """
    (brick,) = world.bodies
    feet = np.array([[-0.075, 0.0, 0.0], [0.075, 0.0, 0.0]])
    known = brick.mass_properties
    weight = known.mass * 9.80665
    question = ContactModeQuestion(
        body="brick",
        state=BodyState(p_WB_W=[0, 0, 0.025], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0]),
        contacts=ContactSet(p_WC_W=feet, normals_W=[[0.0, 0.0, 1.0]] * 2, frictions=2.0, restitutions=0.0),
        torque_W=[0.0, 0.1 * weight, 0.0],
        problem=Problem.PLANAR,
        plane=PLANE,
        include_wrenches=True,
    )
    found = answer(question, Context(world=world))
    assert [mode.mode for mode in found.modes] == ["sf"]
    picture = Picture(recording, world, surface_side=1.0)
    for stamp_ns in (1, 2):
        picture.show(found, now_ns=stamp_ns)
    drawn = read()
    assert len(drawn.values["/force_dual/wrenches", "Image:buffer"]) == 1  # the second is the same
    labels = drawn.last("/force_dual/answer", "Points2D:labels")
    places = dict(zip(labels, drawn.last("/force_dual/answer", "Points2D:positions"), strict=True))
    # Pictures of the body, below the construction, tell where its points are on the clockwise half.
    strips = [np.array(strip) for strip in drawn.last("/force_dual/body", "LineStrips2D:strips")]
    low, high = np.min(strips[1], axis=0), np.max(strips[1], axis=0)
    middle, scale = 0.5 * (low + high), float(high[0] - low[0]) / 0.15  # points, points per m
    np.testing.assert_allclose(
        places["acceleration centre"], middle + scale * np.array([0.075, 0.025]), atol=0.1
    )
    rho_square = known.I_B[1, 1] / known.mass
    beside = -rho_square / 0.1  # m: the weight moves the body down, the torque moves points on the left up
    np.testing.assert_allclose(places["applied wrench"], middle + scale * np.array([beside, 0.0]), atol=0.1)
    words = np.array(drawn.last("/force_dual/words", "LineStrips2D:strips"))[:, 0]
    frames = np.vstack(drawn.last("/force_dual/frame", "LineStrips2D:strips"))
    assert (words[:, 0] > frames[:, 0].max()).all()  # beside the chart, where they cover nothing
    assert abs(words[1, 1] - words[0, 1]) > 0.15 * np.ptp(frames[:, 1])


def test_a_moving_body_and_one_without_a_mode_have_no_force_dual(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    found = answer_of(force=(0.0, 0.0, -9.81), speed=-1.0)
    shown = draw_planar_map(recording, found, PLANE, None, body=ROD)
    outline = np.zeros((0, 2))
    assert draw_planar_dual(recording, found, PLANE, None, shown=shown, applied=None, outline=outline) is None
    drawn = read()
    assert drawn.last("/force_dual", "Clear:is_recursive") == [True]
    assert "/force_dual/wrenches" not in drawn.entities
