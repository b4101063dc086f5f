"""The fan of a toss: what is drawn is what the answer says."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.diagrams.toss_tree import tree_of
from contact_dynamics.diagrams.words import toss_in_words
from contact_dynamics.questions import Context, TossQuestion, TossSampling, UncertainState, ask
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.toss import TossEventKind
from contact_dynamics.viewing.toss import MAX_STRIKING, draw_toss

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.questions import TossAnswer
    from contact_dynamics.world import Body, World
    from viewing.drawn import Drawn

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


def test_path_strikes_and_tree_are_those_of_the_answer(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, world: World
) -> None:
    answer = thrown(world)
    draw_toss(recording, convex_shape(body.vertices_B), answer, up_W=UP)
    drawn = read()
    path = drawn.array(f"{TOSS}/path", "LineStrips3D:strips")[0]
    np.testing.assert_allclose(path, answer.toss.trajectory.p_WB_W, atol=1e-6)  # float32
    strikes = [event.p_WC_W[0] for event in answer.toss.events if event.kind == TossEventKind.STRIKES]
    np.testing.assert_allclose(drawn.array(f"{TOSS}/strikes", "Points3D:positions"), strikes, atol=1e-6)
    told = answer.distribution
    assert told is not None
    nodes = tree_of(told)
    assert len(nodes) >= 2
    means = [node.regions.position.mean for node in nodes]
    np.testing.assert_allclose(drawn.array(f"{TOSS}/tree/nodes", "Points3D:positions"), means, atol=1e-6)
    assert drawn.last(f"{TOSS}/tree/labels", "Points3D:labels") == [node.text for node in nodes]
    assert [node.text[:2] for node in nodes] == [
        f"{branch.strike}." for branch in told.branches if branch.regions is not None
    ]
    raised = drawn.array(f"{TOSS}/tree/labels", "Points3D:positions")
    for mean, label, leader in zip(
        means, raised, drawn.array(f"{TOSS}/tree/leaders", "LineStrips3D:strips"), strict=True
    ):
        np.testing.assert_allclose(leader, [mean, label], atol=1e-6)
    begin = drawn.array(f"{TOSS}/begin", "LineStrips3D:strips")
    assert np.mean(begin, axis=(0, 1)) == pytest.approx(answer.toss.trajectory.p_WB_W[0], abs=1e-6)
    assert f"corner {answer.toss.events[0].corners[0]} strikes" in nodes[0].text
    outlines = drawn.array(f"{TOSS}/samples/strikes", "LineStrips3D:strips")
    shown = (told.ghosts.strikes > 0) & (told.ghosts.samples < MAX_STRIKING)
    assert len(outlines) == 12 * np.count_nonzero(shown)


def test_a_later_toss_without_samples_has_no_fan(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, world: World
) -> None:
    answer = thrown(world)
    shape = convex_shape(body.vertices_B)
    draw_toss(recording, shape, answer, up_W=UP)
    draw_toss(recording, shape, replace(answer, distribution=None, alternatives=()), up_W=UP)
    drawn = read()
    assert drawn.last(f"{TOSS}/tree", "Clear:is_recursive") == [True]
    assert drawn.last(f"{TOSS}/samples", "Clear:is_recursive") == [True]
    assert drawn.last(f"{TOSS}/other_ways", "LineStrips3D:strips") == []


def test_the_words_say_where_it_rests_and_what_strikes_first(world: World) -> None:
    answer = thrown(world)
    words = "; ".join(toss_in_words(answer))
    assert f"rests after {answer.toss.seconds:.3g} s on corners" in words
    assert "what 40 samples do first: corner" in words
