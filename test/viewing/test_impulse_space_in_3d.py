"""Impacts in space, drawn in impulse space with all three components, and read back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ImpactQuestion, Problem, ask
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.viewing.impulse_space_in_3d import draw_impulse_space_in_3d
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.world import Body, World

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.questions import ImpactAnswer
    from viewing.drawn import Drawn

ROD = Body(name="rod", mass_properties=MassProperties(mass=1.0, I_B=np.diag([0.2, 0.5, 0.6])))
ARM = np.array([0.3, 0.2, -0.9])
FRICTION = 0.6
ORIGIN = "/impulse_space_in_3d"  # of the view, which shows what is below it to scale
AT = f"{ORIGIN}/contact"
DIGITS = 1e-6  # relative to the picture: what is drawn has single precision


def an_impact(**told: object) -> ImpactAnswer:
    falling = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[-1, 0.4, -1], w_WB_W=[0, 0, 0])
    ground = ContactSet(p_WC_W=[ARM], normals_W=[0, 0, 1], frictions=FRICTION, restitutions=0.5)
    return ask(ImpactQuestion(body=ROD, state=falling, contacts=ground, **told))


def to_world(answer: ImpactAnswer, points: np.ndarray) -> np.ndarray:
    """Impulses in world axes: the first axis of the picture is along the tangential impulse."""
    along = answer.impact.impulses_W[0] * (1.0, 1.0, 0.0)
    along /= np.linalg.norm(along)
    up = np.array([0.0, 0.0, 1.0])
    return np.asarray(points) @ np.array([along, np.cross(up, along), up])


def velocity_after(answer: ImpactAnswer, impulse_W: np.ndarray) -> np.ndarray:
    """The velocity of the contact after an impulse at it, from Newton's and Euler's laws."""
    known = ROD.mass_properties
    v = answer.state.v_WB_W + impulse_W / known.mass
    w = np.linalg.solve(known.I_B, np.cross(ARM, impulse_W))
    return v + np.cross(w, ARM)


def test_path_dots_lines_and_plane_are_what_they_are_named(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    answer = an_impact()
    draw_impulse_space_in_3d(recording, ROD.mass_properties, answer)
    drawn = read()
    scale = 1.0 / drawn.array(AT, "Transform3D:scale")[0][0]
    path = to_world(answer, drawn.last(f"{AT}/path", "LineStrips3D:strips")[0])
    np.testing.assert_allclose(path, answer.impact.path_W, atol=DIGITS * scale)
    dots = to_world(answer, drawn.last(f"{AT}/events", "Points3D:positions"))
    labels = drawn.last(f"{AT}/event_labels", "Points3D:labels")
    happened = {label.partition(":")[0]: dot for label, dot in zip(labels, dots, strict=True)}
    assert set(happened) == {"sliding stops", "compression ends", "restitution ends"}
    slack = 10.0 * DIGITS  # m/s, of impulses of 1 N s on 1 kg
    assert np.abs(velocity_after(answer, happened["sliding stops"])[:2]).max() < slack
    assert abs(velocity_after(answer, happened["compression ends"])[2]) < slack
    for end in to_world(answer, drawn.last(f"{AT}/sticking_line", "LineStrips3D:strips")[0]):
        assert np.abs(velocity_after(answer, end)[:2]).max() < slack
    for corner in to_world(answer, drawn.last(f"{AT}/compression_plane/patch", "Mesh3D:vertex_positions")):
        assert abs(velocity_after(answer, corner)[2]) < slack
        assert -slack <= corner[2] <= scale * (1.0 + DIGITS)
    for ring in drawn.last(f"{AT}/friction_cone", "LineStrips3D:strips")[:4]:
        t1, t2, n = np.array(ring).T
        np.testing.assert_allclose(np.hypot(t1, t2), FRICTION * n, atol=DIGITS * scale)
    numbers = [float(x) for x in labels[-1].partition("(")[2].partition(")")[0].split(",")]
    np.testing.assert_allclose(to_world(answer, np.array(numbers)), dots[-1], atol=2e-3)


def test_labels_of_events_are_apart_and_all_is_named(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    draw_impulse_space_in_3d(recording, ROD.mass_properties, an_impact())
    drawn = read()
    scale = 1.0 / drawn.array(AT, "Transform3D:scale")[0][0]
    heights = np.sort(np.array(drawn.last(f"{AT}/event_labels", "Points3D:positions"))[:, 2])
    assert (np.diff(heights) > 0.15 * scale).all()
    names = drawn.last(f"{AT}/names", "Points3D:labels")
    assert names[:3] == ["along the tangential impulse, N s", "across, N s", "normal impulse, N s"]
    assert set(names[3:]) == {"friction cone", "sticking line", "compression plane"}


def test_without_mass_properties_there_is_neither_line_nor_plane(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    draw_impulse_space_in_3d(recording, None, an_impact())
    drawn = read()
    assert drawn.last(f"{AT}/sticking_line", "LineStrips3D:strips") == []
    assert drawn.last(f"{AT}/compression_plane", "Clear:is_recursive") == [True]
    assert "sticking line" not in drawn.last(f"{AT}/names", "Points3D:labels")


@pytest.mark.parametrize("first_in_space", [True, False])
def test_a_planar_impact_takes_away_the_picture_in_3d(
    recording: rr.RecordingStream, read: Callable[[], Drawn], *, first_in_space: bool
) -> None:
    picture = Picture(recording, World(bodies=(ROD,), surfaces=()), surface_side=1.0)
    side = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])
    flat = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[-1, 0, -1], w_WB_W=[0, 0, 0])
    ground = ContactSet(p_WC_W=[[0.3, 0, -0.9]], normals_W=[0, 0, 1], frictions=0.6, restitutions=0.5)
    planar = ImpactQuestion(body=ROD, state=flat, contacts=ground, problem=Problem.PLANAR, plane=side)
    if first_in_space:
        picture.show(an_impact(), now_ns=1)
    picture.show(ask(planar), now_ns=2)
    drawn = read()
    if first_in_space:
        assert drawn.last(ORIGIN, "Clear:is_recursive") == [True]
    else:
        assert not any(entity.startswith(ORIGIN) for entity in drawn.entities)
