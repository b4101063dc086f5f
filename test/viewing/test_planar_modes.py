from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.diagrams.planar_modes import MOST_SETS
from contact_dynamics.diagrams.planar_scene import silhouette
from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ContactModeQuestion, Problem
from contact_dynamics.questions.contact_modes import answer
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.viewing.planar_modes import draw_planar_map, draw_planar_modes
from contact_dynamics.world import Body, box_vertices

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
        want_margins=True,
        want_wrenches=True,
    )
    return answer(question)


def test_the_modes_of_the_indeterminate_rod_stand_side_by_side(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    found = answer_of(force=ALONG)
    draw_planar_modes(recording, found, PLANE, outline=np.array([TIP[[0, 2]], -TIP[[0, 2]]]))
    drawn = read()
    titles = [drawn.last(f"/planar_modes/mode_{i}/title", "Points2D:labels")[0] for i in (1, 2)]
    assert sorted(title[0] for title in titles) == ["f", "l"]
    assert all(title[1:3] == " (" and " N from " in title for title in titles)
    places = [drawn.array(f"/planar_modes/mode_{i}/contacts", "Points2D:positions")[0] for i in (1, 2)]
    assert places[1][0] - places[0][0] > 2.0 * abs(TIP[0]) + 1.0
    assert places[1][1] == places[0][1]
    assert drawn.last("/planar_modes/mode_3", "Clear:is_recursive") == [True]


def test_the_inconsistent_rod_says_so(recording: rr.RecordingStream, read: Callable[[], Drawn]) -> None:
    found = answer_of(force=(0.0, 0.0, -9.81), speed=-1.0)
    draw_planar_modes(recording, found, PLANE, outline=np.zeros((0, 2)))
    draw_planar_map(recording, found, PLANE, None, body=ROD)
    drawn = read()
    assert drawn.last("/planar_modes/mode_1/title", "Points2D:labels") == ["no consistent mode"]
    assert drawn.last("/planar_modes/mode_2", "Clear:is_recursive") == [True]
    assert "black: none is" in drawn.last("/mode_map/captions", "Points2D:labels")[-1]


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
    many = replace(found, wrench_sets=found.wrench_sets[:1] * (MOST_SETS + 1))
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
