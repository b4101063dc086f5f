from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.viewing import palette
from contact_dynamics.viewing.contact_modes import (
    ContactModesPicture,
    color_of_letters,
    draw_contact_modes,
    letters_of_contacts,
)
from contact_dynamics.viewing.shape import convex_shape

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.contact import ContactSet
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
    assert color_of_letters("l") == color_of_letters("r") == palette.SLIDE
    assert color_of_letters("f") == color_of_letters("c") == palette.FIXED
    assert color_of_letters("s") == palette.SEPARATE
    assert color_of_letters("l|f") == color_of_letters("?") == palette.UNDECIDED


def test_points_carry_letters_and_forces_their_direction(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, two_contacts: ContactSet
) -> None:
    forces = np.array([[0.0, 0.0, 0.0], [-0.3, 0.0, 0.4]])
    picture = ContactModesPicture(contacts=two_contacts, modes=("sr",), forces_W=forces)
    draw_contact_modes(recording, "brick", convex_shape(body.vertices_B), picture)
    drawn = read()
    assert drawn.last(f"{CONTACTS}/points", "Points3D:labels") == ["s", "r"]
    colors = [color.to_bytes(4, "big") for color in drawn.last(f"{CONTACTS}/points", "Points3D:colors")]
    assert colors == [bytes(palette.SEPARATE), bytes(palette.SLIDE)]
    assert drawn.last(f"{CONTACTS}/forces", "Arrows3D:labels") == ["0.5 N"]
    arrow = drawn.array(f"{CONTACTS}/forces", "Arrows3D:vectors")[0]
    np.testing.assert_allclose(arrow / np.linalg.norm(arrow), [-0.6, 0.0, 0.8], atol=1e-6)


def test_no_consistent_mode_is_drawn_as_a_question(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, two_contacts: ContactSet
) -> None:
    picture = ContactModesPicture(contacts=two_contacts, modes=(), forces_W=np.zeros((2, 3)))
    draw_contact_modes(recording, "brick", convex_shape(body.vertices_B), picture)
    drawn = read()
    assert drawn.last(f"{CONTACTS}/points", "Points3D:labels") == ["?", "?"]
    assert drawn.last(f"{CONTACTS}/forces", "Arrows3D:vectors") == []
