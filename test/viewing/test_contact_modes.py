# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pytest
import rerun as rr

from contact_dynamics.contact_modes import SpatialMode
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.contact_scene import (
    LABEL_DEPTH,
    MAX_MODES,
    contact_marks,
    letters_of_contacts,
    mode_names,
    paint_of_letters,
)
from contact_dynamics.diagrams.shape import Shape, convex_shape
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import ContactModeAnswer
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.validation import FloatArray
from contact_dynamics.viewing.drawing import draw_marks
from viewing.answers import contact_mode_answer
from viewing.drawn import Canvas
from viewing.known import BODY, TWO_CONTACTS

CONTACTS = "/world/contacts/brick"


@pytest.mark.parametrize(
    ("modes", "letters"),
    [
        (("fs",), ["f", "s"]),
        (("ll", "fl"), ["l|f", "l"]),
        (("ff", "fl", "ff"), ["f", "f|l"]),
        ((), ["?", "?"]),
    ],
)
def test_a_contact_carries_its_letter_in_every_mode(modes: tuple[str, ...], letters: list[str]) -> None:
    assert letters_of_contacts(modes, 2) == letters


def test_every_letter_has_a_colour_and_a_doubtful_contact_its_own() -> None:
    assert (
        paint_of_letters("l").dark
        == paint_of_letters("r").dark
        == paint_of_letters("c").dark
        == palette.SLIDE
    )
    assert paint_of_letters("f").dark == palette.FIXED
    assert paint_of_letters("s").dark == palette.SEPARATE
    assert paint_of_letters("l|f").dark == paint_of_letters("?").dark == palette.UNDECIDED


AT_REST = BodyState(p_WB_W=[0.0, 0.0, 0.1], q_WB=[0.0, 0.0, 0.0, 1.0])


def draw(
    recording: rr.RecordingStream, shape: Shape, answer: ContactModeAnswer, body: MassProperties | None = None
) -> None:
    draw_marks(recording, contact_marks(shape, answer, body=body), CONTACTS)


def mode_of(mode: str, forces: FloatArray, *, slides: FloatArray | None = None) -> SpatialMode:
    return SpatialMode(
        mode=mode,
        acceleration_W=np.array([0.0, 0.0, -2.0]),
        angular_acceleration_W=np.zeros(3),
        contact_forces_W=forces,
        contact_accelerations_W=np.zeros_like(forces),
        tangential_directions_W=np.zeros_like(forces) if slides is None else slides,
        misdirection=0.0,
        forces_unique=True,
        motion_unique=True,
    )


def test_points_carry_letters_and_forces_their_direction(canvas: Canvas) -> None:
    forces = np.array([[0.0, 0.0, 0.0], [-0.3, 0.0, 0.4]])
    slides = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    answer = contact_mode_answer(AT_REST, TWO_CONTACTS, mode_of("sr", forces, slides=slides))
    draw(canvas.stream, convex_shape(BODY.vertices_B), answer)
    drawn = canvas.read()
    assert drawn.last(f"{CONTACTS}/letters", "Points3D:labels") == ["separates", "slides right"]
    colors = [color.to_bytes(4, "big") for color in drawn.last(f"{CONTACTS}/points", "Points3D:colors")]
    assert colors == [bytes(palette.SEPARATE), bytes(palette.SLIDE)]
    assert drawn.last(f"{CONTACTS}/mode_1/forces", "Arrows3D:labels") == ["0.5 N"]
    arrow = drawn.array(f"{CONTACTS}/mode_1/forces", "Arrows3D:vectors")[0]
    np.testing.assert_allclose(arrow / np.linalg.norm(arrow), [-0.6, 0.0, 0.8], atol=1e-6)
    (slide,) = drawn.array(f"{CONTACTS}/mode_1/sliding", "Arrows3D:vectors")
    np.testing.assert_allclose(slide / np.linalg.norm(slide), [1.0, 0.0, 0.0], atol=1e-6)
    assert drawn.last(f"{CONTACTS}/mode_1/acceleration", "Arrows3D:labels") == ["sr: 2 m/s²"]
    assert (f"{CONTACTS}/cones", "Mesh3D:vertex_positions") in drawn.values
    edges = drawn.array(f"{CONTACTS}/body", "LineStrips3D:strips")  # where the answer is about it
    np.testing.assert_allclose(edges.reshape(-1, 3).mean(axis=0), [0.0, 0.0, 0.1], atol=1e-6)


def test_contacts_that_do_the_same_have_one_label_below_them(canvas: Canvas) -> None:
    up = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    answer = contact_mode_answer(AT_REST, TWO_CONTACTS, mode_of("ff", up), mode_of("rr", up))
    shape = convex_shape(BODY.vertices_B)
    draw(canvas.stream, shape, answer)
    drawn = canvas.read()
    assert drawn.last(f"{CONTACTS}/letters", "Points3D:labels") == ["2 contacts stay fixed or slide right"]
    (place,) = drawn.array(f"{CONTACTS}/letters", "Points3D:positions")
    below = TWO_CONTACTS.p_WC_W.mean(axis=0) - LABEL_DEPTH * shape.size * TWO_CONTACTS.normals_W[0]
    np.testing.assert_allclose(place, below, atol=1e-6)  # float32 positions


def test_what_acts_besides_the_contacts_is_an_arrow(canvas: Canvas) -> None:
    """What the mode of 2 m/s^2 downwards has from its two contacts of 1 N upwards, and from this force."""
    up = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    answer = contact_mode_answer(AT_REST, TWO_CONTACTS, mode_of("ff", up))
    draw(canvas.stream, convex_shape(BODY.vertices_B), answer, body=BODY.mass_properties)
    drawn = canvas.read()
    amount = 2.0 * BODY.mass_properties.mass + 2.0
    assert drawn.last(f"{CONTACTS}/applied", "Arrows3D:labels") == [f"gravity and load: {amount:.3g} N"]
    (arrow,) = drawn.array(f"{CONTACTS}/applied", "Arrows3D:vectors")
    np.testing.assert_allclose(arrow / np.linalg.norm(arrow), [0.0, 0.0, -1.0], atol=1e-6)


def test_each_mode_is_an_entity_of_its_own(canvas: Canvas) -> None:
    up = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    many = [mode_of("ff", up * (i + 1)) for i in range(MAX_MODES + 2)]
    answer = contact_mode_answer(AT_REST, TWO_CONTACTS, *many)
    draw(canvas.stream, convex_shape(BODY.vertices_B), answer)
    drawn = canvas.read()
    forces = [f"{CONTACTS}/{name}/forces" for name in mode_names()]
    assert [drawn.last(path, "Arrows3D:labels")[0] for path in forces] == [
        "1 N",
        "2 N",
        "3 N",
        "4 N",
        "5 N",
        "6 N",
    ]
    assert not any("mode_7" in entity for entity in drawn.entities)


def test_no_consistent_mode_is_drawn_as_a_question(canvas: Canvas) -> None:
    draw(canvas.stream, convex_shape(BODY.vertices_B), contact_mode_answer(AT_REST, TWO_CONTACTS))
    drawn = canvas.read()
    assert drawn.last(f"{CONTACTS}/letters", "Points3D:labels") == ["no mode"]
    assert not any("mode_1" in entity for entity in drawn.entities)


def test_in_a_plane_the_letters_say_which_way_a_contact_slides(canvas: Canvas) -> None:
    """Seen from -y, x is to the right: r slides along it, l against it."""
    plane = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])
    mode = mode_of("lr", np.zeros((2, 3)), slides=np.zeros((0, 3)))
    answer = contact_mode_answer(AT_REST, TWO_CONTACTS, mode, plane=plane)
    draw(canvas.stream, convex_shape(BODY.vertices_B), answer)
    slides = canvas.read().array(f"{CONTACTS}/mode_1/sliding", "Arrows3D:vectors")
    directions = slides / np.linalg.norm(slides, axis=1, keepdims=True)
    np.testing.assert_allclose(directions, [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], atol=1e-6)
