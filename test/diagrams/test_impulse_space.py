# SPDX-License-Identifier: Apache-2.0
"""The sliding rod of lecture 27 (worked number 4) and impacts in space, in impulse space."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.diagrams.impulse_space import (
    contact_axes,
    impulse_space,
    impulse_space_in_3d,
    main_contact,
    part_in_box,
)
from contact_dynamics.diagrams.marks import Diagram
from contact_dynamics.impact import SpatialImpact
from contact_dynamics.impact.law import ImpactOutcome, PathEvent
from contact_dynamics.impact.several.orders import several_impact
from contact_dynamics.impact.spatial.one_contact import spatial_impact, spatial_pair_impact
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ImpactAnswer, ImpactQuestion, NamedState, ask
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.world import Body
from diagrams.marks_of import marks_of
from viewing.answers import impact_answer, of_two

MU = math.tan(math.radians(30.0))
STICKS = (MU * 0.1719704, 0.1719704)
COMPRESSED = (1.0 / 9.0, 2.0 / 9.0)
ENDS = (0.1372549, 0.3333333)
DIGITS = 1e-6  # the lecture's numbers have seven

# Seen from -y, the plane of motion has x to the right and z up.
PLANE = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])
ROD = MassProperties(mass=1.0, I_B=np.eye(3))


def sliding_rod(*, in_plane: bool = True) -> ImpactAnswer:
    path = np.array([[t, 0.0, n] for t, n in ((0.0, 0.0), STICKS, COMPRESSED, ENDS)])
    return impact_answer(
        BodyState(p_WB_W=[1.0, 0.0, 4.0], q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=[-1.0, 0.0, 0.0]),
        ContactSet(p_WC_W=np.zeros((1, 3)), normals_W=[[0.0, 0.0, 1.0]], frictions=[MU], restitutions=[0.5]),
        impulses_W=path[-1:],
        path_W=path,
        path_events=(
            PathEvent.START,
            PathEvent.SLIDING_STOPS,
            PathEvent.COMPRESSION_ENDS,
            PathEvent.RESTITUTION_ENDS,
        ),
        path_contacts=(0, 0, 0, 0),
        v_after_W=(-0.8627451, 0.0, 0.3333333),
        plane=PLANE if in_plane else None,
    )


def of_one(answer: ImpactAnswer, impact: SpatialImpact) -> ImpactAnswer:
    """The answer with the path of another impact at its one contact."""
    resolved = replace(
        answer.impact,
        impulses_W=impact.impulse_W[None],
        path_W=impact.path_W,
        path_events=impact.path_events,
        path_contacts=(0,) * len(impact.path_W),
    )
    return replace(answer, impact=resolved)


def events_of(diagram: Diagram) -> list[tuple[str, np.ndarray]]:
    """The words and the place of each event."""
    events = [mark for name, mark in marks_of(diagram).items() if name.startswith("event_")]
    return [(mark.legend, mark.places[0]) for mark in events]


@pytest.mark.parametrize("in_plane", [True, False])
def test_the_lines_pass_through_the_lectures_points(*, in_plane: bool) -> None:
    diagram = impulse_space(ROD, sliding_rod(in_plane=in_plane))
    marks = marks_of(diagram)
    (path,) = marks["path"].strips
    np.testing.assert_allclose(path, [(0.0, 0.0), STICKS, COMPRESSED, ENDS], atol=DIGITS)
    (sticking,), (compression,) = marks["sticking_line"].strips, marks["compression_line"].strips
    for point in (STICKS, COMPRESSED, ENDS):  # it sticks until the end
        assert distance(point, sticking) < DIGITS
    assert distance(COMPRESSED, compression) < DIGITS
    assert distance(ENDS, compression) > 0.01
    assert [words for words, _ in events_of(diagram)] == [
        "sliding stops:\n(0.0993, 0.172) N s",
        "compression ends:\n(0.111, 0.222) N s",
        "restitution ends:\n(0.137, 0.333) N s",
    ]
    assert ("projected" in marks["sticking_line"].legend) != in_plane


def distance(point: tuple[float, float], line: np.ndarray) -> float:
    along, across = line[1] - line[0], np.array(point) - line[0]
    return float(abs(along[0] * across[1] - along[1] * across[0]) / np.linalg.norm(along))


@given(
    velocity=st.tuples(*[st.floats(-2.0, 2.0)] * 2, st.floats(-3.0, -0.5)),
    spin=st.tuples(*[st.floats(-8.0, 8.0)] * 3),
    arm=st.tuples(*[st.floats(-0.6, 0.6)] * 2, st.floats(-1.0, -0.3)),
    friction=st.floats(0.05, 1.0),
    restitution=st.floats(0.0, 1.0),
)
def test_every_dot_of_a_path_that_swerves_lies_on_the_line_that_names_it(
    velocity: tuple[float, ...],
    spin: tuple[float, ...],
    *,
    arm: tuple[float, ...],
    friction: float,
    restitution: float,
) -> None:
    body = MassProperties(mass=1.3, I_B=np.diag([0.2, 0.5, 0.6]))
    state = replace(
        sliding_rod().state, p_WB_W=-np.array(arm), v_WB_W=np.array(velocity), w_WB_W=np.array(spin)
    )
    up = np.array([0.0, 0.0, 1.0])
    assume(state.velocity_of_point(np.zeros(3))[2] < -0.05)
    struck = Contact(p_WC_W=np.zeros(3), normal_W=up, friction=friction, restitution=restitution)
    impact = spatial_impact(body, state, struck)
    check_dots(body, of_one(replace(sliding_rod(in_plane=False), state=state), impact))


def check_dots(body: MassProperties, answer: ImpactAnswer) -> None:
    """Each dot lies on the line that names it, within a millionth of the diagram."""
    diagram = impulse_space(body, answer)
    for words, dot in events_of(diagram):
        for begin, name in (("compression ends", "compression_line"), ("sliding stops", "sticking_line")):
            if words.startswith(begin):
                distances = [distance(tuple(dot), line) for line in marks_of(diagram)[name].strips]
                assert min(distances) < 1e-6 * diagram.axes[1].high, words


def test_a_contact_that_strikes_after_another_has_its_dots_on_its_lines() -> None:
    """The impulse of the first changes the velocity of the second, and its lines with it."""
    body = MassProperties(mass=1.0, I_B=np.diag([0.02, 0.05, 0.06]))
    state = replace(
        sliding_rod().state,
        p_WB_W=np.array([0.05, 0.02, 0.2]),
        v_WB_W=np.array([-0.6, -0.5, -1.0]),
        w_WB_W=np.array([-0.9, -0.1, 1.9]),
    )
    contacts = ContactSet(
        p_WC_W=[[0.3, 0.1, 0.0], [-0.3, 0.0, 0.0]], normals_W=[0.0, 0.0, 1.0], frictions=0.3, restitutions=0.5
    )
    impact = several_impact(body, state, contacts)
    assert impact.order[:2] == (0, 1)
    begins = [i for i, event in enumerate(impact.path_events) if event is PathEvent.START]
    second, end = [*begins, len(impact.path_events)][1:3]
    answer = impact_answer(
        state,
        contacts,
        impulses_W=impact.path_W[[second - 1, end - 1]],
        path_W=impact.path_W[:end],
        path_events=impact.path_events[:end],
        path_contacts=impact.path_contacts[:end],
    )
    assert main_contact(answer.impact) == 1
    check_dots(body, answer)


def test_without_mass_properties_the_lines_are_left_out() -> None:
    struck = NamedState(name="", p_FB_F=np.zeros(3), state=sliding_rod().state)
    of_both = of_two(sliding_rod(), struck, other_after=sliding_rod().state)
    for body, answer in ((None, sliding_rod()), (ROD, of_both)):
        assert set(marks_of(impulse_space(body, answer))) & {"path", "sticking_line"} == {"path"}
    in_space = marks_of(impulse_space_in_3d(None, in_space_answer()))
    assert set(in_space) == {"friction_cone", "path", "event_0", "event_1", "event_2"}


def test_between_two_bodies_the_lines_are_those_of_their_relative_motion() -> None:
    """Where the bodies stick while they are pressed, the path's corners lie on the lines, as for one body."""
    rod = sliding_rod()
    bat = MassProperties(mass=3.0, I_B=2.0 * np.eye(3))
    bat_state = BodyState(
        p_WB_W=[0.5, 0.0, -2.0], q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=[0.2, 0.0, 1.0], w_WB_W=[0.0, 0.1, 0.0]
    )
    impact = spatial_pair_impact(
        ROD,
        rod.state,
        bat,
        bat_state,
        Contact(p_WC_W=np.zeros(3), normal_W=[0.0, 0.0, 1.0], friction=2.0, restitution=0.5),
    )
    assert impact.outcome is ImpactOutcome.STICKS_IN_COMPRESSION
    struck = NamedState(name="bat", p_FB_F=np.zeros(3), state=bat_state)
    sticking_rod = replace(rod, contacts=replace(rod.contacts, frictions=np.array([2.0])))
    answer = of_two(of_one(sticking_rod, impact), struck, other_after=bat_state)
    marks = marks_of(impulse_space(ROD, answer, other=bat))
    (sticking,), (compression,) = marks["sticking_line"].strips, marks["compression_line"].strips
    compressed, ends = ((x, z) for x, _, z in (impact.compression_W.tolist(), impact.impulse_W.tolist()))
    assert distance(compressed, sticking) < DIGITS
    assert distance(compressed, compression) < DIGITS
    assert distance(ends, sticking) < DIGITS
    assert distance(ends, compression) > 0.1


def test_right_is_right_seen_against_the_planes_normal() -> None:
    axes_W = contact_axes(sliding_rod(), 0)
    np.testing.assert_allclose(axes_W, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def test_in_space_right_is_where_friction_pushes() -> None:
    np.testing.assert_allclose(contact_axes(sliding_rod(in_plane=False), 0)[0], [1.0, 0.0, 0.0])


@given(
    dimensions=st.sampled_from([2, 3]),
    numbers=st.lists(st.floats(-10.0, 10.0), min_size=12, max_size=12),
    sizes=st.lists(st.floats(1e-3, 1e3), min_size=3, max_size=3),
)
def test_what_is_drawn_of_a_line_is_all_that_lies_in_the_diagram(
    dimensions: int, numbers: list[float], sizes: list[float]
) -> None:
    start, slope, low = np.reshape(numbers[:9], (3, 3))[:, :dimensions]
    high = low + sizes[:dimensions]
    assume(np.abs(slope).max() > 1e-3)
    found = part_in_box(start, slope, low, high)
    slack = 1e-9 * np.abs([low, high]).max()
    if len(found) > 0:
        assert np.all((found >= low - slack) & (found <= high + slack))
        beyond = np.array([found[0] - 1e-3 * (found[1] - found[0]), found[1] + 1e-3 * (found[1] - found[0])])
        assert not np.all((beyond > low + slack) & (beyond < high - slack), axis=1).any()
    else:
        places = start + np.linspace(-1e4, 1e4, 1001)[:, None] * slope
        assert not np.all((places > low + slack) & (places < high - slack), axis=1).any()


def in_space_answer() -> ImpactAnswer:
    """A rod that strikes the ground, whose path swerves."""
    falling = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[-1, 0.4, -1])
    ground = ContactSet(p_WC_W=[ARM], normals_W=[0, 0, 1], frictions=FRICTION, restitutions=0.5)
    return ask(ImpactQuestion(body=THIN_ROD, state=falling, contacts=ground))


THIN_ROD = Body(name="rod", mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.2, 0.5, 0.6])))
ARM = np.array([0.3, 0.2, -0.9])
FRICTION = 0.6


def velocity_after(answer: ImpactAnswer, impulse_W: np.ndarray) -> np.ndarray:
    """The velocity of the contact after an impulse at it, from Newton's and Euler's laws."""
    known = THIN_ROD.mass_properties
    v = answer.state.v_WB_W + impulse_W / known.mass
    w = np.linalg.solve(known.I_B, np.cross(ARM, impulse_W))
    return v + np.cross(w, ARM)


def test_in_space_path_dots_lines_and_plane_are_what_they_are_named() -> None:
    answer = in_space_answer()
    along = answer.impact.impulses_W[0] * (1.0, 1.0, 0.0)
    along /= np.linalg.norm(along)
    axes_W = np.array([along, np.cross([0.0, 0.0, 1.0], along), [0.0, 0.0, 1.0]])
    diagram = impulse_space_in_3d(THIN_ROD, answer)
    marks, top = marks_of(diagram), diagram.axes[2].high
    slack = 1e-9  # m/s, of impulses of 1 N s on 1 kg
    np.testing.assert_allclose(marks["path"].strips[0] @ axes_W, answer.impact.path_W, atol=slack)
    happened = {words.partition(":")[0]: dot @ axes_W for words, dot in events_of(diagram)}
    assert set(happened) == {"sliding stops", "compression ends", "restitution ends"}
    assert np.abs(velocity_after(answer, happened["sliding stops"])[:2]).max() < slack
    assert abs(velocity_after(answer, happened["compression ends"])[2]) < slack
    for end in marks["sticking_line"].strips[0] @ axes_W:
        assert np.abs(velocity_after(answer, end)[:2]).max() < slack
    for corner in marks["compression_plane"].corners @ axes_W:
        assert abs(velocity_after(answer, corner)[2]) < slack
        assert -slack <= corner[2] <= top + slack
    for ring in marks["friction_cone"].strips[:4]:
        t1, t2, n = ring.T
        np.testing.assert_allclose(np.hypot(t1, t2), FRICTION * n, rtol=slack)
    words, dot = events_of(diagram)[-1]
    numbers = [float(x) for x in words.partition("(")[2].partition(")")[0].split(",")]
    np.testing.assert_allclose(numbers, dot, atol=2e-3)
