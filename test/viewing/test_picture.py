from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.impact import PathEvent
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.world import World
from viewing.answers import contact_mode_answer, impact_answer, tumbling_answer
from viewing.drawn import STAMP_NS

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions import ImpactAnswer
    from contact_dynamics.tumbling import Trajectory
    from viewing.drawn import Drawn

LATER_NS = STAMP_NS + 100_000_000


def moved(state: BodyState, stamp_ns: int) -> BodyState:
    return BodyState(
        p_WB_W=state.p_WB_W, q_WB=state.q_WB, v_WB_W=state.v_WB_W, w_WB_W=state.w_WB_W, stamp_ns=stamp_ns
    )


def an_impact(
    state: BodyState, contacts: ContactSet, *, stamp_ns: int = STAMP_NS, name: str = "brick"
) -> ImpactAnswer:
    return impact_answer(
        moved(state, stamp_ns),
        contacts,
        impulses_W=np.array([[0.0, 0.0, 0.4], [0.0, 0.0, 0.0]]),
        path_W=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.4]]),
        path_events=(PathEvent.START, PathEvent.RESTITUTION_ENDS),
        path_contacts=(0, 0),
        body_name=name,
    )


def test_each_answer_appears_at_its_stamp(
    recording: rr.RecordingStream,
    read: Callable[[], Drawn],
    *,
    world: World,
    state: BodyState,
    trajectory: Trajectory,
    two_contacts: ContactSet,
) -> None:
    picture = Picture(recording, world, surface_side=2.0)
    picture.add_states("brick", [state])
    picture.show_tumbling(tumbling_answer(state, trajectory))
    picture.show_impact(an_impact(state, two_contacts, stamp_ns=STAMP_NS + 1))
    picture.show_contact_modes(contact_mode_answer(moved(state, STAMP_NS + 2), two_contacts))
    drawn = read()
    assert drawn.stamps("/world/predicted/brick/path", "LineStrips3D:strips") == [STAMP_NS]
    assert drawn.stamps("/world/impact/brick/impulse", "Arrows3D:vectors") == [STAMP_NS + 1]
    assert drawn.stamps("/impulse_space/path", "LineStrips2D:strips") == [STAMP_NS + 1]
    assert drawn.stamps("/world/contacts/brick/points", "Points3D:labels") == [STAMP_NS + 2]


def test_measured_states_after_a_prediction_stand_beside_it(
    recording: rr.RecordingStream,
    read: Callable[[], Drawn],
    world: World,
    state: BodyState,
    trajectory: Trajectory,
) -> None:
    picture = Picture(recording, world, surface_side=2.0)
    picture.add_states("brick", [state])
    picture.show_tumbling(tumbling_answer(state, trajectory))
    picture.add_states("brick", [moved(state, LATER_NS)])
    drawn = read()
    assert drawn.stamps("/height/brick/measured", "Scalars:scalars") == [STAMP_NS, LATER_NS]
    assert drawn.stamps("/height/brick/predicted", "Scalars:scalars") == [LATER_NS]
    assert picture.newest_stamp_ns() == LATER_NS


def test_the_first_trajectory_is_looked_at_with_the_ground_below_it_and_later_ones_are_not(
    recording: rr.RecordingStream,
    read: Callable[[], Drawn],
    world: World,
    state: BodyState,
    trajectory: Trajectory,
) -> None:
    picture = Picture(recording, world, surface_side=0.5)
    for offset in (0, 1, 2):
        picture.show_tumbling(tumbling_answer(moved(state, STAMP_NS + offset), trajectory))
    drawn = read()
    assert drawn.blueprints == 2  # without, then with the trajectory
    patch = drawn.array("/world/surfaces/floor/patch", "Mesh3D:vertex_positions")
    center = 0.5 * (trajectory.p_WB_W.min(axis=0) + trajectory.p_WB_W.max(axis=0))
    np.testing.assert_allclose(patch.mean(axis=0), [*center[:2], 0.0], atol=1e-6)


def test_a_diagram_gets_its_tab_when_it_is_first_drawn(
    recording: rr.RecordingStream,
    read: Callable[[], Drawn],
    *,
    world: World,
    state: BodyState,
    two_contacts: ContactSet,
) -> None:
    picture = Picture(recording, world, surface_side=0.5)
    for _ in range(3):
        picture.show_impact(an_impact(state, two_contacts))
    assert read().blueprints == 2  # without, then with impulse space


def test_the_last_look_is_at_what_is_in_view_then(
    recording: rr.RecordingStream, read: Callable[[], Drawn], world: World, state: BodyState
) -> None:
    picture = Picture(recording, world, surface_side=0.5)
    picture.frame_all()  # nothing to look at yet
    picture.add_states("brick", [state])
    long_after = BodyState(
        p_WB_W=np.array([70.0, 80.0, 9.0]),
        q_WB=state.q_WB,
        v_WB_W=np.zeros(3),
        w_WB_W=np.zeros(3),
        stamp_ns=STAMP_NS + 60_000_000_000,
    )
    picture.add_states("brick", [long_after])
    picture.frame_all()
    drawn = read()
    assert drawn.blueprints == 2
    patch = drawn.array("/world/surfaces/floor/patch", "Mesh3D:vertex_positions")
    np.testing.assert_allclose(patch.mean(axis=0), [70.0, 80.0, 0.0], atol=1e-5)


def test_the_newest_answer_of_each_kind_stands_in_words_and_all_in_the_log(
    recording: rr.RecordingStream, read: Callable[[], Drawn], world: World
) -> None:
    picture = Picture(recording, world, surface_side=2.0)
    assert picture.newest_stamp_ns() is None
    picture.tell("Impact", "first", stamp_ns=STAMP_NS)
    assert picture.newest_stamp_ns() == STAMP_NS
    picture.tell("Tumbling", "second", stamp_ns=STAMP_NS + 1)
    picture.tell("Impact", "third", stamp_ns=STAMP_NS + 2, is_error=True)
    drawn = read()
    assert drawn.last("/answers/newest", "TextDocument:text") == ["**Impact**: third\n\n**Tumbling**: second"]
    texts = [text for _, (text,) in drawn.values["/answers/log", "TextLog:text"]]
    assert texts == ["Impact: first", "Tumbling: second", "Impact: third"]
    levels = [level for _, (level,) in drawn.values["/answers/log", "TextLog:level"]]
    assert levels == ["INFO", "INFO", "WARN"]


@pytest.mark.parametrize("name", ["", "somebody", "arm/tool 1"])
def test_a_body_that_is_not_of_the_world_is_drawn_too(
    recording: rr.RecordingStream,
    read: Callable[[], Drawn],
    *,
    world: World,
    state: BodyState,
    trajectory: Trajectory,
    two_contacts: ContactSet,
    name: str,
) -> None:
    picture = Picture(recording, world, surface_side=2.0)
    picture.add_states(name, [state])
    picture.show_tumbling(tumbling_answer(state, trajectory, body_name=name))
    picture.show_impact(an_impact(state, two_contacts, name=name))
    escaped = {"": "unnamed", "somebody": "somebody", "arm/tool 1": r"arm\/tool\ 1"}[name]
    drawn = read()
    assert f"/world/bodies/{escaped}" in drawn.entities
    assert f"/world/predicted/{escaped}/path" in drawn.entities
    assert f"/world/impact/{escaped}/impulse" in drawn.entities


def test_a_world_without_gravity_bodies_or_surfaces_is_drawn(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    Picture(recording, World(gravity_W=np.zeros(3)), surface_side=2.0)
    assert "/legend" in read().entities
