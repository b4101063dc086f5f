# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, World, free_motion
from contact_dynamics.constants import to_ns
from contact_dynamics.diagrams.impact_scene import LABELS
from contact_dynamics.impact import PathEvent
from contact_dynamics.questions import ImpactAnswer
from contact_dynamics.viewing.entities import ERROR
from contact_dynamics.viewing.in_view import LABELS_S
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.words import sentence
from viewing.answers import contact_mode_answer, impact_answer, tumbling_answer
from viewing.drawn import STAMP_NS, Canvas
from viewing.known import STATE, TRAJECTORY, TWO_CONTACTS, WORLD

LATER_NS = STAMP_NS + 100_000_000


def moved(state: BodyState, stamp_ns: int) -> BodyState:
    return replace(state, stamp_ns=stamp_ns)


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


def test_each_answer_appears_at_its_stamp(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    picture.add_states("brick", [STATE])
    picture.show(tumbling_answer(STATE, TRAJECTORY))
    picture.show(an_impact(STATE, TWO_CONTACTS, stamp_ns=STAMP_NS + 1))
    picture.show(contact_mode_answer(moved(STATE, STAMP_NS + 2), TWO_CONTACTS))
    drawn = canvas.read()
    assert drawn.stamps("/world/predicted/brick/path", "LineStrips3D:strips") == [STAMP_NS]
    assert drawn.stamps("/world/impact/brick/impulse", "Arrows3D:vectors") == [STAMP_NS + 1]
    assert drawn.stamps("/impulse_space/path", "LineStrips2D:strips") == [STAMP_NS + 1]
    assert drawn.stamps("/world/contacts/brick/letters", "Points3D:labels") == [STAMP_NS + 2]


def test_the_body_that_was_asked_about_last_has_letters(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    for offset, name in enumerate(("a", "a", "b", "a")):
        picture.show(contact_mode_answer(moved(STATE, STAMP_NS + offset), TWO_CONTACTS, body_name=name))
    drawn = canvas.read()
    for name, cleared_ns in (("a", STAMP_NS + 2), ("b", STAMP_NS + 3)):
        cleared = drawn.values[f"/world/contacts/{name}/letters", "Clear:is_recursive"]
        assert [stamp for stamp, _ in cleared] == [cleared_ns]


def test_measured_states_after_a_prediction_stand_beside_it(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    picture.add_states("brick", [STATE])
    picture.show(tumbling_answer(STATE, TRAJECTORY))
    picture.add_states("brick", [moved(STATE, LATER_NS)])
    drawn = canvas.read()
    assert drawn.stamps("/height/brick/measured", "Scalars:scalars") == [STAMP_NS, LATER_NS]
    assert drawn.stamps("/height/brick/predicted", "Scalars:scalars") == [LATER_NS]
    seconds = 1e-9 * (LATER_NS - STAMP_NS)
    there = [np.interp(seconds, TRAJECTORY.seconds, each) for each in TRAJECTORY.p_WB_W.T]
    apart = float(np.linalg.norm(STATE.p_WB_W - there))  # the state that was measured later is the same
    assert apart > 0.0
    assert drawn.series("/error/brick", "Scalars:scalars").tolist() == [apart]
    assert picture.newest_stamp_ns() == LATER_NS


def test_an_answer_that_comes_late_stands_beside_the_states_before_it_once(canvas: Canvas) -> None:
    """On a machine under load an answer can take longer than the flight. An answer after it adds nothing."""
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    stamps = [STAMP_NS + i * 100_000_000 for i in range(6)]  # the trajectory has 0.4 s
    picture.add_states("brick", [moved(STATE, stamp_ns) for stamp_ns in stamps])
    picture.show(tumbling_answer(STATE, TRAJECTORY))
    picture.show(tumbling_answer(STATE, TRAJECTORY))
    drawn = canvas.read()
    assert drawn.stamps("/height/brick/predicted", "Scalars:scalars") == stamps[1:5]
    assert drawn.stamps("/error/brick", "Scalars:scalars") == stamps[1:5]
    assert drawn.stamps("/energy/brick/predicted", "Scalars:scalars") == stamps[1:5]
    assert drawn.stamps("/energy/brick/measured", "Scalars:scalars") == stamps
    assert drawn.stamps("/world/predicted/brick/path", "LineStrips3D:strips") == [STAMP_NS, STAMP_NS]


def test_a_prediction_without_states_beside_it_has_no_panel_of_its_error(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    picture.show(tumbling_answer(STATE, TRAJECTORY))
    picture.add_states("brick", [moved(STATE, STAMP_NS + 10_000_000_000)])
    assert ERROR not in picture.shown
    picture.add_states("brick", [moved(STATE, STAMP_NS + 10_100_000_000)])
    picture.show(tumbling_answer(moved(STATE, STAMP_NS + 10_000_000_000), TRAJECTORY))
    assert ERROR in picture.shown


def test_energy_and_momenta_are_drawn_beside_a_prediction(canvas: Canvas) -> None:
    """In free flight the measured curves of energy and angular momentum are those that were predicted."""
    (brick,) = WORLD.bodies
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    picture.add_states("brick", [STATE])
    picture.show(tumbling_answer(STATE, TRAJECTORY))
    flight = free_motion(brick.mass_properties, STATE)
    picture.add_states("brick", [flight.state_at(0.001 * i) for i in range(1, 20)])
    drawn = canvas.read()
    for quantity in ("energy", "angular_momentum"):
        values = {
            kind: drawn.series(f"/{quantity}/brick/{kind}", "Scalars:scalars")
            for kind in ("measured", "predicted")
        }
        assert len(values["measured"]) == 20  # with the state that was asked about
        np.testing.assert_allclose(values["measured"][1:], values["predicted"], rtol=1e-9)
        assert values["measured"][0] > 0.0


def test_the_first_trajectory_is_looked_at_with_the_ground_below_it_and_later_ones_are_not(
    canvas: Canvas,
) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    for offset in (0, 1, 2):
        picture.show(tumbling_answer(moved(STATE, STAMP_NS + offset), TRAJECTORY))
    drawn = canvas.read()
    assert drawn.blueprints == 3  # without, with the trajectory, with its page and the answer in words
    patch = drawn.array("/world/surfaces/floor/patch", "Mesh3D:vertex_positions")
    center = 0.5 * (TRAJECTORY.p_WB_W.min(axis=0) + TRAJECTORY.p_WB_W.max(axis=0))
    np.testing.assert_allclose(patch.mean(axis=0), [*center[:2], 0.0], atol=1e-6)


def test_a_diagram_gets_its_tab_when_it_is_first_drawn(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    for _ in range(3):
        picture.show(an_impact(STATE, TWO_CONTACTS))
    assert canvas.read().blueprints == 2  # without, with impact, impulse space and words


def test_the_last_look_is_at_what_is_in_view_then(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    picture.frame_all()  # nothing to look at yet
    picture.add_states("brick", [STATE])
    long_after = BodyState(p_WB_W=[70.0, 80.0, 9.0], q_WB=STATE.q_WB, stamp_ns=STAMP_NS + 60_000_000_000)
    picture.add_states("brick", [long_after])
    picture.frame_all()
    drawn = canvas.read()
    assert drawn.blueprints == 2
    patch = drawn.array("/world/surfaces/floor/patch", "Mesh3D:vertex_positions")
    np.testing.assert_allclose(patch.mean(axis=0), [70.0, 80.0, 0.0], atol=1e-5)


def test_after_the_clock_was_set_back_the_newest_states_are_those_that_came_last(canvas: Canvas) -> None:
    """The last look has them in view alone, and their stamp is that of answers which have none.

    Another body's states have ended before.
    """
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    for name in ("ball", "brick"):
        picture.add_states(name, [STATE])
    back_ns = STAMP_NS - 60_000_000_000
    picture.add_states("brick", [moved(replace(STATE, p_WB_W=np.array([70.0, 80.0, 9.0])), back_ns)])
    assert picture.newest_stamp_ns() == back_ns
    picture.frame_all()
    patch = canvas.read().array("/world/surfaces/floor/patch", "Mesh3D:vertex_positions")
    np.testing.assert_allclose(patch.mean(axis=0), [70.0, 80.0, 0.0], atol=1e-5)


def test_the_newest_answer_of_each_kind_stands_in_words_and_all_in_the_log(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    assert picture.newest_stamp_ns() is None
    picture.tell("Impact", "first", stamp_ns=STAMP_NS)
    assert picture.newest_stamp_ns() == STAMP_NS
    picture.tell("Tumbling", "second", stamp_ns=STAMP_NS + 1)
    picture.tell("Impact", "third", stamp_ns=STAMP_NS + 2, is_error=True)
    drawn = canvas.read()
    assert drawn.last("/answers/newest", "TextDocument:text") == ["**Impact**: third\n\n**Tumbling**: second"]
    assert drawn.last("/answers/summary", "TextDocument:text") == ["**Impact**: third"]
    texts = [text for _, (text,) in drawn.values["/answers/log", "TextLog:text"]]
    assert texts == ["Impact: first", "Tumbling: second", "Impact: third"]
    levels = [level for _, (level,) in drawn.values["/answers/log", "TextLog:level"]]
    assert levels == ["INFO", "INFO", "WARN"]


@pytest.mark.parametrize("name", ["", "somebody", "arm/tool 1"])
def test_a_body_that_is_not_of_the_world_is_drawn_too(canvas: Canvas, name: str) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    picture.add_states(name, [STATE])
    picture.show(tumbling_answer(STATE, TRAJECTORY, body_name=name))
    picture.show(an_impact(STATE, TWO_CONTACTS, name=name))
    escaped = {"": "unnamed", "somebody": "somebody", "arm/tool 1": r"arm\/tool\ 1"}[name]
    drawn = canvas.read()
    assert f"/world/bodies/{escaped}" in drawn.entities
    assert f"/world/predicted/{escaped}/path" in drawn.entities
    assert f"/world/impact/{escaped}/impulse" in drawn.entities


def test_a_world_without_gravity_bodies_or_surfaces_is_drawn(canvas: Canvas) -> None:
    Picture(canvas.stream, World(gravity_W=np.zeros(3)), surface_side=2.0)
    assert "/legend" in canvas.read().entities


@pytest.mark.parametrize(
    ("predictions", "stamps"), [(1, []), (2, [[1, 2, 3, 4, 5]]), (4, [[1, 4], [2, 5], [3]])]
)
def test_the_newest_predictions_are_in_view_and_no_more(
    canvas: Canvas, predictions: int, stamps: list[list[int]]
) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=0.5, predictions=predictions)
    for offset in range(6):
        picture.show(tumbling_answer(moved(STATE, STAMP_NS + offset), TRAJECTORY))
    drawn = canvas.read()
    earlier = sorted(path for path in drawn.entities if "/earlier/" in path)
    found = [drawn.stamps(path, "LineStrips3D:strips") for path in earlier]
    assert [[stamp - STAMP_NS for stamp in each] for each in found] == stamps


def test_only_the_newest_impact_has_labels_until_it_is_past(canvas: Canvas) -> None:
    """The labels of another body's impact go at once, and its own when it has been measured for a while."""
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    picture.show(an_impact(STATE, TWO_CONTACTS))
    other = an_impact(STATE, TWO_CONTACTS, stamp_ns=STAMP_NS + 1, name="ball")
    picture.show(other)
    over_ns = STAMP_NS + 1 + to_ns(other.seconds_to_contact + LABELS_S)
    picture.add_states("ball", [moved(STATE, over_ns - 1_000_000)])
    picture.add_states("ball", [moved(STATE, over_ns + 1_000_000)])
    drawn = canvas.read()
    for label in LABELS:
        assert drawn.stamps(f"/world/impact/brick/{label}", "Clear:is_recursive") == [STAMP_NS + 1]
        assert drawn.stamps(f"/world/impact/ball/{label}", "Clear:is_recursive") == [over_ns + 1_000_000]


def test_twenty_bodies_have_names_and_colours_of_their_own(canvas: Canvas) -> None:
    names = [f"brick {i}" for i in range(20)]
    (body,) = WORLD.bodies
    many = replace(WORLD, bodies=tuple(replace(body, name=name) for name in names))
    picture = Picture(canvas.stream, many, surface_side=0.5)
    for name in names:
        picture.add_states(name, [STATE])
    drawn = canvas.read()
    paths = [f"/world/bodies/brick\\ {i}" for i in range(20)]
    assert [drawn.last(f"{path}/name", "Points3D:labels") for path in paths] == [[name] for name in names]
    assert len({str(drawn.last(f"{path}/faces", "Mesh3D:albedo_factor")) for path in paths}) == 20


def test_a_single_body_has_no_name_in_its_way(canvas: Canvas) -> None:
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    picture.add_states("brick", [STATE])
    assert "/world/bodies/brick/name" not in canvas.read().entities


@pytest.mark.parametrize(
    ("seconds", "told"), [(1.234e-4, "0.12 ms"), (0.00563, "5.6 ms"), (0.0921, "92 ms"), (0.1114, "111 ms")]
)
def test_the_time_of_an_answer_has_no_power_of_ten(seconds: float, told: str) -> None:
    assert sentence("brick", ["slides"], computation_time=seconds) == f"brick slides ({told})"
