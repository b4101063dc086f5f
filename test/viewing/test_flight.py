# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import BodyState, World
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.flight import DEVIATIONS, MAX_OUTLINES, MAX_PATH_POINTS, flight_marks
from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.diagrams.toss_scene import MAX_STRIKING, toss_marks, tree_of
from contact_dynamics.diagrams.words import toss_in_words
from contact_dynamics.motion.covariance import CarriedCovariance, PropagationMethod, orientation_deviations
from contact_dynamics.questions import Context, TossAnswer, TossQuestion, TossSampling, UncertainState, ask
from contact_dynamics.toss import TossEventKind
from contact_dynamics.tumbling import Trajectory, free_motion
from contact_dynamics.validation import FloatArray
from contact_dynamics.viewing.drawing import draw_marks
from contact_dynamics.viewing.picture import Picture
from diagrams.marks_of import marks_of
from viewing.answers import tumbling_answer
from viewing.drawn import Canvas
from viewing.known import BODY, STATE, TRAJECTORY, WORLD

PREDICTED = "/world/predicted/brick"


def test_path_outlines_and_end_are_those_of_the_trajectory() -> None:
    marks = marks_of(flight_marks(convex_shape(BODY.vertices_B), TRAJECTORY))
    np.testing.assert_array_equal(marks["path"].strips[0], TRAJECTORY.p_WB_W)
    outlines = np.reshape(marks["outlines"].strips, (-1, 24, 3))
    ends = np.reshape(marks["end"].strips, (-1, 24, 3))
    corners = Rotation.from_quat(TRAJECTORY.q_WB[-1]).apply(BODY.vertices_B.copy()) + TRAJECTORY.p_WB_W[-1]
    faces = marks["newest_end/faces"].corners
    np.testing.assert_allclose(np.linalg.norm(faces[:, None] - corners, axis=2).min(axis=1), 0.0, atol=1e-9)
    np.testing.assert_allclose(ends[0].mean(axis=0), TRAJECTORY.p_WB_W[-1], atol=1e-6)
    assert len(outlines) > 0
    for outline in (*outlines, *ends):
        sample = int(np.linalg.norm(TRAJECTORY.p_WB_W - outline.mean(axis=0), axis=1).argmin())
        turned_vertices = Rotation.from_quat(TRAJECTORY.q_WB[sample]).apply(BODY.vertices_B.copy())
        corners = TRAJECTORY.p_WB_W[sample] + turned_vertices
        distances = np.linalg.norm(outline[:, None] - corners, axis=2).min(axis=1)
        np.testing.assert_allclose(distances, 0.0, atol=1e-6)


def carried_along(trajectory: Trajectory, covariances: FloatArray, trusted: np.ndarray) -> CarriedCovariance:
    return CarriedCovariance(
        seconds=trajectory.seconds,
        covariances=covariances,
        orientation_deviations=orientation_deviations(covariances),
        trusted=trusted,
        method=PropagationMethod.LINEARISED,
    )


def test_ellipsoids_have_two_deviations_along_the_axes_of_the_covariance(canvas: Canvas) -> None:
    axes = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()
    deviations = np.array([0.01, 0.02, 0.05])
    covariance = axes @ np.diag(deviations**2) @ axes.T
    growing = np.zeros((len(TRAJECTORY), 12, 12))
    growing[:, :3, :3] = covariance * np.linspace(0.0, 1.0, len(TRAJECTORY))[:, None, None]
    trusted = np.array([True] * (len(TRAJECTORY) - 1) + [False])
    carried = carried_along(TRAJECTORY, growing, trusted)
    marks = marks_of(flight_marks(convex_shape(BODY.vertices_B), TRAJECTORY, covariance=carried))
    (last,) = marks["uncertainty/other"].centers
    np.testing.assert_array_equal(last, TRAJECTORY.p_WB_W[-1])
    np.testing.assert_allclose(marks["uncertainty/other"].covariances[0], covariance, atol=1e-12)
    assert len(marks["uncertainty/relied_on"].centers) > 0
    colors = [marks[f"uncertainty/{name}"].paint.dark for name in ("relied_on", "other")]
    assert colors == [palette.PREDICTED, palette.UNDECIDED]
    draw_marks(canvas.stream, [marks["uncertainty/other"]], PREDICTED)
    drawn = canvas.read()
    path = f"{PREDICTED}/uncertainty/other"
    half_axes = drawn.array(path, "Ellipsoids3D:half_sizes")[-1]
    np.testing.assert_allclose(np.sort(half_axes), DEVIATIONS * deviations, rtol=1e-5)
    R = Rotation.from_quat(drawn.array(path, "Ellipsoids3D:quaternions")[-1]).as_matrix()
    found = R @ np.diag((half_axes / DEVIATIONS) ** 2) @ R.T
    np.testing.assert_allclose(found, covariance, atol=1e-7)


def test_what_no_double_holds_is_not_drawn() -> None:
    n = len(TRAJECTORY)
    unknown = carried_along(TRAJECTORY, np.full((n, 12, 12), np.nan), np.zeros(n, dtype=bool))
    marks = marks_of(flight_marks(convex_shape(BODY.vertices_B), TRAJECTORY, covariance=unknown))
    assert len(marks["uncertainty/relied_on"].centers) == len(marks["uncertainty/other"].centers) == 0


@pytest.mark.parametrize("samples", [1, 2, 3, 50 * MAX_PATH_POINTS + 7])
def test_any_number_of_samples_keeps_both_ends(samples: int) -> None:
    trajectory = free_motion(BODY.mass_properties, STATE).at(np.linspace(0.0, 0.5, samples))
    (path,) = marks_of(flight_marks(convex_shape(BODY.vertices_B), trajectory))["path"].strips
    assert len(path) == min(samples, MAX_PATH_POINTS)
    np.testing.assert_array_equal(path[[0, -1]], trajectory.p_WB_W[[0, -1]])


def test_an_empty_trajectory_takes_away_the_former(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=1.0)
    picture.show(tumbling_answer(STATE, TRAJECTORY))
    picture.show(tumbling_answer(STATE, free_motion(BODY.mass_properties, STATE).at([])))
    drawn = canvas.read()
    assert len(drawn.values[f"{PREDICTED}/path", "LineStrips3D:strips"]) == 1
    assert drawn.last(PREDICTED, "Clear:is_recursive") == [True]


def test_a_body_without_shape_has_a_path_all_the_same() -> None:
    marks = marks_of(flight_marks(convex_shape(np.zeros((0, 3))), TRAJECTORY))
    assert len(marks["path"].strips) == 1
    assert len(marks["end"].strips) == 0


@pytest.mark.parametrize(("speed", "count"), [(0.0, 0), (1.0, 0), (10.0, 2), (1000.0, MAX_OUTLINES)])
def test_a_longer_path_has_more_outlines(speed: float, count: int) -> None:
    """The time is 0.05 s, and the box is 0.182 m from corner to corner."""
    start = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=[speed, 0, 0])
    flight = free_motion(BODY.mass_properties, start, gravity_W=np.zeros(3)).at(np.linspace(0.0, 0.05, 50))
    marks = marks_of(flight_marks(convex_shape(BODY.vertices_B), flight))
    assert len(marks["outlines"].strips) == 12 * count
    assert len(marks["end"].strips) == 12 * (speed > 0.0)
    assert (len(marks["newest_end/faces"].corners) > 0) == (speed > 0.0)


TOSS = "/world/toss/brick"
UP = np.array([0.0, 0.0, 1.0])


def thrown(world: World) -> TossAnswer:
    state = BodyState(
        p_WB_W=[0.1, -0.2, 0.3], q_WB=[0.1, -0.5, 0.7, 0.5], v_WB_W=[0.5, 0.3, 0.0], w_WB_W=[3.0, -2.0, 1.0]
    )
    question = TossQuestion(
        body="brick",
        state=UncertainState(state=state, covariance=4e-4 * np.eye(12)),
        max_alternatives=1,
        sampling=TossSampling(count=40),
    )
    return ask(question, Context(world=world))


def test_path_strikes_and_tree_are_those_of_the_answer() -> None:
    answer = thrown(WORLD)
    marks = marks_of(toss_marks(convex_shape(BODY.vertices_B), answer, up_W=UP))
    np.testing.assert_array_equal(marks["path"].strips[0], answer.toss.trajectory.p_WB_W)
    strikes = [event.p_WC_W[0] for event in answer.toss.events if event.kind == TossEventKind.STRIKES]
    np.testing.assert_array_equal(marks["strikes"].places, strikes)
    told = answer.distribution
    assert told is not None
    nodes = tree_of(told)
    assert len(nodes) >= 2
    means = [node.regions.position.mean for node in nodes]
    np.testing.assert_array_equal(marks["tree/nodes"].places, means)
    assert list(marks["tree/labels"].texts) == [node.text for node in nodes]
    assert [node.text[:2] for node in nodes] == [
        f"{branch.strike}." for branch in told.branches if branch.regions is not None
    ]
    for leader, ends in zip(
        marks["tree/leaders"].strips, zip(means, marks["tree/labels"].places, strict=True), strict=True
    ):
        np.testing.assert_array_equal(leader, ends)
    begin = np.mean(marks["begin"].strips, axis=(0, 1))
    assert begin == pytest.approx(answer.toss.trajectory.p_WB_W[0])
    assert f"corner {answer.toss.events[0].corners[0]} strikes" in nodes[0].text
    shown = (told.ghosts.strikes > 0) & (told.ghosts.samples < MAX_STRIKING)
    assert len(marks["samples/strikes"].strips) == 12 * np.count_nonzero(shown)


def test_a_later_toss_without_samples_has_no_fan(canvas: Canvas) -> None:
    answer = thrown(WORLD)
    picture = Picture(canvas.stream, WORLD, surface_side=1.0)
    picture.show(answer, now_ns=1)
    picture.show(replace(answer, distribution=None, alternatives=()), now_ns=2)
    drawn = canvas.read()
    assert drawn.stamps(TOSS, "Clear:is_recursive") == [1, 2]
    assert drawn.stamps(f"{TOSS}/path", "LineStrips3D:strips") == [1, 2]
    assert drawn.stamps(f"{TOSS}/tree/nodes", "Points3D:positions") == [1]
    assert drawn.stamps(f"{TOSS}/samples/ways", "LineStrips3D:strips") == [1]


def test_the_words_say_where_it_rests_and_what_strikes_first() -> None:
    answer = thrown(WORLD)
    words = "; ".join(toss_in_words(answer))
    assert (
        f"rests after {answer.toss.seconds:.3g} s with {answer.toss.face_on_top} on top, on corners" in words
    )
    assert "first event of 40 samples: corner" in words
