"""The sliding rod of lecture 27 (worked number 4), drawn in impulse space."""

from __future__ import annotations

import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import rerun as rr
from hypothesis import assume, given
from hypothesis import strategies as st

from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.diagrams.impulse_space import Line, contact_axes, line_in_box, main_contact
from contact_dynamics.impact.law import ImpactOutcome, PathEvent
from contact_dynamics.impact.several.orders import several_impact
from contact_dynamics.impact.spatial.one_contact import spatial_impact, spatial_pair_impact
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ImpactAnswer, StruckBody
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.viewing.impulse_space import draw_impulse_space
from contact_dynamics.viewing.measured import set_time
from viewing.answers import impact_answer, of_two
from viewing.drawn import STAMP_NS, read_drawn

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.impact import SpatialImpact
    from viewing.drawn import Drawn

MU = math.tan(math.radians(30.0))
STICKS = (MU * 0.1719704, 0.1719704)
COMPRESSED = (1.0 / 9.0, 2.0 / 9.0)
ENDS = (0.1372549, 0.3333333)
DIGITS = 1e-6  # the lecture's numbers have seven, the picture is float32

# Seen from -y, the plane of motion has x to the right and z up.
PLANE = PlaneOfMotion(normal_W=np.array([0.0, -1.0, 0.0]))
ROD = MassProperties(mass=1.0, I_B=np.eye(3))


def sliding_rod(*, in_plane: bool = True) -> ImpactAnswer:
    path = np.array([[t, 0.0, n] for t, n in ((0.0, 0.0), STICKS, COMPRESSED, ENDS)])
    return impact_answer(
        BodyState(
            p_WB_W=np.array([1.0, 0.0, 4.0]),
            q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
            v_WB_W=np.array([-1.0, 0.0, 0.0]),
            w_WB_W=np.zeros(3),
        ),
        ContactSet(
            p_WC_W=np.zeros((1, 3)),
            normals_W=np.array([[0.0, 0.0, 1.0]]),
            frictions=np.array([MU]),
            restitutions=np.array([0.5]),
        ),
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


def on_paper(points: object) -> np.ndarray:
    """Points as the lecture draws them: rerun's 2D views have the second coordinate downwards."""
    return np.array(points, dtype=np.float64) * (1.0, -1.0)


@pytest.mark.parametrize("in_plane", [True, False])
def test_the_lines_pass_through_the_lectures_points(
    recording: rr.RecordingStream, read: Callable[[], Drawn], *, in_plane: bool
) -> None:
    draw_impulse_space(recording, ROD, sliding_rod(in_plane=in_plane))
    drawn = read()
    path = on_paper(drawn.last("/impulse_space/path", "LineStrips2D:strips")[0])
    np.testing.assert_allclose(path, [(0.0, 0.0), STICKS, COMPRESSED, ENDS], atol=DIGITS)
    (sticking,) = on_paper(drawn.last(r"/impulse_space/sticking\ line", "LineStrips2D:strips"))
    (compression,) = on_paper(drawn.last(r"/impulse_space/compression\ line", "LineStrips2D:strips"))
    for point in (STICKS, COMPRESSED, ENDS):  # it sticks until the end
        assert distance(point, sticking) < DIGITS
    assert distance(COMPRESSED, compression) < DIGITS
    assert distance(ENDS, compression) > 0.01
    labels = drawn.last(r"/impulse_space/event\ labels", "LineStrips2D:labels")
    assert labels == [
        "sliding stops: 0.0993, 0.172",
        "compression ends: 0.111, 0.222",
        "restitution ends: 0.137, 0.333",
    ]


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
    """In a file of each example's own, read back."""
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
    """Each dot lies on the line that names it, within a thousandth of the picture's width."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "drawn.rrd"
        stream = rr.RecordingStream("test")
        stream.save(path)
        set_time(stream, STAMP_NS)
        draw_impulse_space(stream, body, answer)
        stream.disconnect()
        drawn = read_drawn(path)
    extent = np.abs(drawn.last("/impulse_space/axes", "LineStrips2D:strips")[0]).max()
    dots = on_paper(drawn.last("/impulse_space/events", "Points2D:positions")).reshape(-1, 2)
    labels = drawn.last(r"/impulse_space/event\ labels", "LineStrips2D:labels")
    for dot, label in zip(dots, labels, strict=True):
        for words, name in (("compression ends", "compression"), ("sliding stops", "sticking")):
            if label.startswith(words):
                lines = drawn.last(rf"/impulse_space/{name}\ line", "LineStrips2D:strips")
                distances = [distance(tuple(dot), on_paper(line)) for line in lines]
                assert min(distances) < 1e-3 * extent, label


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
        p_WC_W=np.array([[0.3, 0.1, 0.0], [-0.3, 0.0, 0.0]]),
        normals_W=np.array([[0.0, 0.0, 1.0]] * 2),
        frictions=np.array([0.3, 0.3]),
        restitutions=np.array([0.5, 0.5]),
    )
    impact = several_impact(body, state, contacts)
    strikes = impact.strikes[:2]
    assert impact.order[:2] == (0, 1)
    answer = impact_answer(
        state,
        contacts,
        impulses_W=np.array([strike.impulse_W for _, strike in strikes]),
        path_W=np.concatenate([strike.path_W for _, strike in strikes]),
        path_events=tuple(event for _, strike in strikes for event in strike.path_events),
        path_contacts=tuple(contact for contact, strike in strikes for _ in strike.path_events),
    )
    assert main_contact(answer.impact) == 1
    check_dots(body, answer)


def test_without_mass_properties_the_lines_are_left_out(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    draw_impulse_space(recording, None, sliding_rod())
    drawn = read()
    assert drawn.last(r"/impulse_space/sticking\ line", "LineStrips2D:strips") == []
    assert len(drawn.last("/impulse_space/path", "LineStrips2D:strips")) == 1


def test_between_two_bodies_the_lines_are_those_of_their_relative_motion(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    """Where the bodies stick while they are pressed, the path's corners lie on the lines, as for one body."""
    rod = sliding_rod()
    bat = MassProperties(mass=3.0, I_B=2.0 * np.eye(3))
    bat_state = BodyState(
        p_WB_W=np.array([0.5, 0.0, -2.0]),
        q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
        v_WB_W=np.array([0.2, 0.0, 1.0]),
        w_WB_W=np.array([0.0, 0.1, 0.0]),
    )
    impact = spatial_pair_impact(
        ROD,
        rod.state,
        bat,
        bat_state,
        Contact(p_WC_W=np.zeros(3), normal_W=np.array([0.0, 0.0, 1.0]), friction=2.0, restitution=0.5),
    )
    assert impact.outcome is ImpactOutcome.STICKS_IN_COMPRESSION
    struck = StruckBody(name="bat", p_FB_F=np.zeros(3), state=bat_state)
    sticking_rod = replace(rod, contacts=replace(rod.contacts, frictions=np.array([2.0])))
    answer = of_two(of_one(sticking_rod, impact), struck, other_after=bat_state)
    draw_impulse_space(recording, ROD, answer, other=bat)
    drawn = read()
    (sticking,) = on_paper(drawn.last(r"/impulse_space/sticking\ line", "LineStrips2D:strips"))
    (compression,) = on_paper(drawn.last(r"/impulse_space/compression\ line", "LineStrips2D:strips"))
    compressed, ends = ((x, z) for x, _, z in (impact.compression_W.tolist(), impact.impulse_W.tolist()))
    assert distance(compressed, sticking) < DIGITS
    assert distance(compressed, compression) < DIGITS
    assert distance(ends, sticking) < DIGITS
    assert distance(ends, compression) > 0.1


def test_without_the_struck_bodys_mass_the_lines_are_left_out(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    rod = sliding_rod()
    other = StruckBody(name="", p_FB_F=np.zeros(3), state=rod.state)
    draw_impulse_space(recording, ROD, of_two(rod, other, other_after=rod.state))
    assert read().last(r"/impulse_space/sticking\ line", "LineStrips2D:strips") == []


def test_right_is_right_seen_against_the_planes_normal() -> None:
    np.testing.assert_allclose(contact_axes(sliding_rod(), 0), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def test_in_space_right_is_where_friction_pushes() -> None:
    np.testing.assert_allclose(contact_axes(sliding_rod(in_plane=False), 0)[0], [1.0, 0.0, 0.0])


@given(
    normal=st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0)).filter(lambda n: math.hypot(*n) > 1e-3),
    offset=st.floats(-20.0, 20.0),
    extent=st.floats(1e-3, 1e3),
)
def test_what_is_drawn_of_a_line_is_all_that_lies_in_the_picture(
    normal: tuple[float, float], offset: float, extent: float
) -> None:
    line = Line(np.array(normal), offset)
    found = line_in_box(line, extent)
    scale = abs(offset) + extent * math.hypot(*normal)
    for end in found.reshape(-1, 2):
        assert abs(line.normal @ end + offset) <= 1e-9 * scale
        assert np.abs(end).max() <= extent * (1.0 + 1e-9)
        at_border = np.isclose(np.abs(end), extent, rtol=1e-9).any() or end[1] <= 0.0
        assert at_border
    corners = np.array([(x, y) for x in (-extent, extent) for y in (0.0, extent)])
    sides = corners @ line.normal + offset
    if sides.min() < -1e-9 * scale and sides.max() > 1e-9 * scale:
        assert len(found) == 1  # it separates corners of the part above the origin


def test_a_line_of_no_direction_is_not_drawn() -> None:
    assert len(line_in_box(Line(np.zeros(2), 1.0), 1.0)) == 0


def test_words_stand_beside_the_lines_and_apart_and_the_axes_have_names(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    body, answer = MassProperties(mass=1.0, I_B=np.eye(3)), sliding_rod()
    draw_impulse_space(recording, body, answer)
    drawn = read()
    (right, _) = drawn.last("/impulse_space/axes", "LineStrips2D:strips")[0]
    extent = abs(right[0])
    for name in (r"event\ labels", "names"):
        places = on_paper([strip[0] for strip in drawn.last(f"/impulse_space/{name}", "LineStrips2D:strips")])
        assert (np.abs(places[:, 0]) > 1.2 * extent).all()
        # A word is 20 points high, and a picture in a grid of two columns has 125 from its lower axis up.
        assert (np.diff(np.sort(places[:, 1])) > 0.16 * extent).all()
    axes = drawn.last(r"/impulse_space/axis\ names", "LineStrips2D:labels")
    assert axes == ["tangential impulse, N s", "normal impulse, N s"]
    name_of_axis = on_paper(drawn.last(r"/impulse_space/axis\ names", "LineStrips2D:strips")[0])[0]
    labels = on_paper(
        [strip[0] for strip in drawn.last(r"/impulse_space/event\ labels", "LineStrips2D:strips")]
    )
    assert (name_of_axis[0] * labels[:, 0] < 0.0).all()  # low labels would cover it
