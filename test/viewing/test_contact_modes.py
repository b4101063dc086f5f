from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.viewing import palette
from contact_dynamics.viewing.contact_modes import (
    MOST_MODES,
    ContactModesPicture,
    DrawnMode,
    color_of_letters,
    draw_contact_modes,
    letters_of_contacts,
    mode_names,
)
from contact_dynamics.viewing.shape import convex_shape

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body
    from viewing.drawn import Drawn

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
    assert color_of_letters("l") == color_of_letters("r") == color_of_letters("c") == palette.SLIDE
    assert color_of_letters("f") == palette.FIXED
    assert color_of_letters("s") == palette.SEPARATE
    assert color_of_letters("l|f") == color_of_letters("?") == palette.UNDECIDED


def mode_of(mode: str, forces: FloatArray, *, slides: FloatArray | None = None) -> DrawnMode:
    return DrawnMode(
        mode=mode,
        forces_W=forces,
        sliding_W=np.zeros_like(forces) if slides is None else slides,
        acceleration_W=np.array([0.0, 0.0, -2.0]),
    )


def picture_of(contacts: ContactSet, *modes: DrawnMode) -> ContactModesPicture:
    return ContactModesPicture(
        p_WB_W=np.array([0.0, 0.0, 0.1]), q_WB=np.array([0.0, 0.0, 0.0, 1.0]), contacts=contacts, modes=modes
    )


def test_points_carry_letters_and_forces_their_direction(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, two_contacts: ContactSet
) -> None:
    forces = np.array([[0.0, 0.0, 0.0], [-0.3, 0.0, 0.4]])
    slides = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    picture = picture_of(two_contacts, mode_of("sr", forces, slides=slides))
    draw_contact_modes(recording, "brick", convex_shape(body.vertices_B), picture)
    drawn = read()
    assert drawn.last(f"{CONTACTS}/points", "Points3D:labels") == ["s", "r"]
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


def test_each_mode_is_an_entity_of_its_own(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, two_contacts: ContactSet
) -> None:
    up = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    many = [mode_of("ff", up * (i + 1)) for i in range(MOST_MODES + 2)]
    draw_contact_modes(recording, "brick", convex_shape(body.vertices_B), picture_of(two_contacts, *many))
    drawn = read()
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


def test_no_consistent_mode_is_drawn_as_a_question(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, two_contacts: ContactSet
) -> None:
    draw_contact_modes(recording, "brick", convex_shape(body.vertices_B), picture_of(two_contacts))
    drawn = read()
    assert drawn.last(f"{CONTACTS}/points", "Points3D:labels") == ["?", "?"]
    assert drawn.last(f"{CONTACTS}/mode_1", "Clear:is_recursive") == [True]
