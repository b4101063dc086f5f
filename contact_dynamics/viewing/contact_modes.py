"""Draws contact modes in the scene: friction cones, words for what the contacts do, each consistent mode.

Each mode has an entity of its own, `mode_1`, `mode_2` and so on, with its contact forces, sliding directions
and acceleration. The viewer shows the first. The eye beside a mode's name switches it on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.contact_modes.spatial.applied_wrench import applied_wrench
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.shape import outline
from contact_dynamics.diagrams.words import contacts_in_words
from contact_dynamics.questions.planar_view import beyond, sliding_directions
from contact_dynamics.viewing.entities import contacts_entity
from contact_dynamics.viewing.impact import friction_cones
from contact_dynamics.viewing.strips import strips_3d

if TYPE_CHECKING:
    from contact_dynamics.contact_modes import SpatialMode
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.rigid_body.body import MassProperties

FORCE_LENGTH: Final = 0.6
"""Length of the longest force arrow, relative to the body's size. Labels say how much force it stands for."""

MAX_MODES: Final = 6
"""Largest number of modes that are drawn. Further modes are only listed in words."""

LETTERS: Final = "letters"
"""The labels of the contacts. Only those of the newest answer are in view."""

LABEL_DEPTH: Final = 0.6
"""How far below the contacts their label is, relative to the body's size, so that they are seen."""

_ACCELERATION_LENGTH: Final = 0.6  # length of the arrow at the centre of mass, relative to the body's size
_SLIDING_LENGTH: Final = 0.3  # length of the arrows of sliding directions, relative to the body's size
_CONE_HEIGHT: Final = 0.25  # relative to the body's size
_OUTLINE_WIDTH: Final = -0.8  # a negative size is in points of the screen
_POINT_SIZE: Final = 0.035  # radius of points, relative to the body's size
_ARROW_WIDTH: Final = 0.01  # relative to the body's size


def draw_contact_modes(
    recording: rr.RecordingStream,
    shape: Shape,
    answer: ContactModeAnswer,
    *,
    body: MassProperties | None = None,
) -> None:
    """Draw an answer about contact modes in the scene, at the recording's current time.

    ``shape`` is that of the body. Its applied force is drawn if its mass properties, ``body``, are known.
    """
    path, size = contacts_entity(answer.body_name), shape.size
    contacts = answer.contacts
    letters = letters_of_contacts(tuple(mode.mode for mode in answer.modes), len(contacts))
    colors = np.array([color_of_letters(text) for text in letters], dtype=np.uint8).reshape(-1, 4)
    points = rr.Points3D(contacts.p_WC_W, colors=colors, radii=_POINT_SIZE * size)
    recording.log(f"{path}/points", points)
    recording.log(f"{path}/{LETTERS}", _labels(letters, answer, size=size))
    cones = friction_cones(
        contacts.p_WC_W, contacts.normals_W, contacts.frictions, height=_CONE_HEIGHT * size
    )
    recording.log(f"{path}/cones", rr.Clear(recursive=False) if cones is None else cones)
    edges = list(outline(shape, answer.state.p_WB_W, answer.state.q_WB))
    lines = rr.LineStrips3D(
        strips_3d(edges), colors=palette.translucent(palette.NORMAL, 0.6), radii=_OUTLINE_WIDTH
    )
    recording.log(f"{path}/body", lines)
    _draw_applied(recording, f"{path}/applied", answer, body, size=size)
    for i, name in enumerate(mode_names()):
        mode_path = f"{path}/{name}"
        if i < len(answer.modes):
            _draw_mode(recording, mode_path, answer.modes[i], answer, size=size)
        else:
            recording.log(mode_path, rr.Clear(recursive=True))


def _draw_applied(
    recording: rr.RecordingStream,
    path: str,
    answer: ContactModeAnswer,
    body: MassProperties | None,
    *,
    size: float,
) -> None:
    """Draw the force that acts on the body besides its contacts: gravity, and what pushes it."""
    if body is None or not answer.modes:
        recording.log(path, rr.Clear(recursive=False))
        return
    force_W = applied_wrench(body, answer.state, answer.contacts, answer.modes[0])[:3]
    amount = float(np.linalg.norm(force_W))
    vectors = [force_W / amount * (FORCE_LENGTH * size)] if amount > 0.0 else []
    arrows = rr.Arrows3D(
        origins=[answer.state.p_WB_W] * len(vectors),
        vectors=vectors,
        colors=palette.NORMAL,
        radii=_ARROW_WIDTH * size,
        labels=[f"gravity and load: {amount:.3g} N"] * len(vectors),
        show_labels=True,
    )
    recording.log(path, arrows)


def mode_names() -> list[str]:
    """Return the names of the entities that hold one mode each."""
    return [f"mode_{i}" for i in range(1, MAX_MODES + 1)]


def _draw_mode(
    recording: rr.RecordingStream, path: str, mode: SpatialMode, answer: ContactModeAnswer, *, size: float
) -> None:
    points, forces_W = answer.contacts.p_WC_W, mode.contact_forces_W
    colors = np.array([color_of_letters(letter) for letter in mode.mode], dtype=np.uint8).reshape(-1, 4)
    magnitudes = np.linalg.norm(forces_W, axis=1)
    pressed = magnitudes > 0.0
    scale = FORCE_LENGTH * size / float(magnitudes.max(initial=0.0)) if pressed.any() else 0.0
    forces = rr.Arrows3D(
        origins=points[pressed],
        vectors=forces_W[pressed] * scale,
        colors=colors[pressed],
        radii=_ARROW_WIDTH * size,
        labels=[f"{magnitude:.3g} N" for magnitude in magnitudes[pressed].tolist()],
        show_labels=False,  # four labels would hide the body, so the viewer shows the one under the mouse
    )
    recording.log(f"{path}/forces", forces)
    sliding_W = sliding_directions(answer, mode)
    slides = sliding_W.any(axis=1)
    directions = rr.Arrows3D(
        origins=points[slides],
        vectors=sliding_W[slides] * (_SLIDING_LENGTH * size),
        colors=palette.SLIDE,
        radii=0.5 * _ARROW_WIDTH * size,
    )
    recording.log(f"{path}/sliding", directions)
    (acceleration_W,) = beyond(mode.acceleration_W[None], answer.acceleration_tolerance)
    amount = float(np.linalg.norm(acceleration_W))
    vectors = [acceleration_W / amount * (_ACCELERATION_LENGTH * size)] if amount > 0.0 else []
    acceleration = rr.Arrows3D(
        origins=[answer.state.p_WB_W] * len(vectors),
        vectors=vectors,
        colors=palette.PREDICTED,
        radii=_ARROW_WIDTH * size,
        labels=[f"{mode.mode}: {amount:.3g} m/s²"] * len(vectors),
    )
    recording.log(f"{path}/acceleration", acceleration)


def letters_of_contacts(modes: tuple[str, ...], count: int) -> list[str]:
    """Return each contact's letters in all modes, each once, joined by `|`, or `?` if there is no mode."""
    return ["|".join(dict.fromkeys(mode[i] for mode in modes)) or "?" for i in range(count)]


def _labels(letters: list[str], answer: ContactModeAnswer, *, size: float) -> rr.Points3D:
    """Return one label for the contacts with the same letters and the same normal, below them."""
    normals_W = answer.contacts.normals_W
    groups: dict[tuple[str, tuple[float, ...]], list[int]] = {}
    for i, text in enumerate(letters):
        groups.setdefault((text, tuple(normals_W[i].round(2).tolist())), []).append(i)
    places = [
        answer.contacts.p_WC_W[group].mean(axis=0) - LABEL_DEPTH * size * normals_W[group[0]]
        for group in groups.values()
    ]
    return rr.Points3D(
        places,
        colors=[palette.readable(color_of_letters(text)) for text, _ in groups],
        radii=0.0,
        labels=[contacts_in_words(text, len(group)) for (text, _), group in groups.items()],
        show_labels=True,
    )


def color_of_letters(letters: str) -> palette.Color:
    """Return the colour of a contact with these letters."""
    return palette.LETTER_COLORS.get(letters, palette.UNDECIDED)
