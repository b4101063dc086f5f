# SPDX-License-Identifier: Apache-2.0
"""The fan of a toss: what is drawn is what the answer says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import BodyState, World
from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.diagrams.toss_scene import MAX_STRIKING, toss_marks, tree_of
from contact_dynamics.diagrams.words import toss_in_words
from contact_dynamics.questions import Context, TossAnswer, TossQuestion, TossSampling, UncertainState, ask
from contact_dynamics.toss import TossEventKind
from contact_dynamics.viewing.picture import Picture
from diagrams.marks_of import marks_of
from viewing.drawn import Canvas
from viewing.known import BODY, WORLD

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
