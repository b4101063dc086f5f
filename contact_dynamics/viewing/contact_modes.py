"""Contact modes: each contact coloured by its letter, with the forces of the first consistent mode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import contacts_entity

if TYPE_CHECKING:
    from contact_dynamics.contact import ContactSet
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.shape import Shape

FORCE_LENGTH: Final = 0.6
"""Length of the longest force arrow, relative to the body's size; labels say how much it stands for."""

_POINT_SIZE: Final = 0.035  # relative to the size of the body
_ARROW_WIDTH: Final = 0.01  # likewise


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactModesPicture:
    """What the picture of an answer about contact modes is made of."""

    contacts: ContactSet  # n contacts
    modes: tuple[str, ...]  # every consistent mode, one letter a contact
    forces_W: FloatArray  # (n, 3), N, on the body, of the first mode, world axes; zero where there is no mode


def draw_contact_modes(
    recording: rr.RecordingStream, body_name: str, shape: Shape, picture: ContactModesPicture
) -> None:
    """Draw an answer about contact modes in the scene, at the recording's current time."""
    path = contacts_entity(body_name)
    letters = letters_of_contacts(picture.modes, len(picture.contacts))
    colors = np.array([color_of_letters(text) for text in letters], dtype=np.uint8).reshape(-1, 4)
    recording.log(
        f"{path}/points",
        rr.Points3D(
            picture.contacts.p_WC_W,
            colors=colors,
            radii=_POINT_SIZE * shape.size,
            labels=letters,
            show_labels=True,
        ),
    )
    magnitudes = np.linalg.norm(picture.forces_W, axis=1)
    pressed = magnitudes > 0.0
    scale = FORCE_LENGTH * shape.size / float(magnitudes.max(initial=0.0)) if pressed.any() else 0.0
    recording.log(
        f"{path}/forces",
        rr.Arrows3D(
            origins=picture.contacts.p_WC_W[pressed],
            vectors=picture.forces_W[pressed] * scale,
            colors=colors[pressed],
            radii=_ARROW_WIDTH * shape.size,
            labels=[f"{magnitude:.3g} N" for magnitude in magnitudes[pressed].tolist()],
            show_labels=False,  # four of them hide the body; the viewer shows one where the mouse is
        ),
    )


def letters_of_contacts(modes: tuple[str, ...], count: int) -> list[str]:
    """Return each contact's letters in all modes, each once, joined by `|`; `?` where there is no mode."""
    return ["|".join(dict.fromkeys(mode[i] for mode in modes)) or "?" for i in range(count)]


def color_of_letters(letters: str) -> palette.Color:
    """Return the colour of a contact with these letters."""
    return palette.LETTER_COLORS.get(letters, palette.UNDECIDED)
