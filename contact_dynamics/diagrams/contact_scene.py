# SPDX-License-Identifier: Apache-2.0
"""Contact modes in space: friction cones, words for what the contacts do, each consistent mode.

Each mode has an entity of its own, `mode_1`, `mode_2` and so on, with its contact forces, sliding directions
and acceleration. The viewer shows the first. The eye beside a mode's name switches it on. A diagram of one
mode, in the plane and in space alike, has the contact forces in their friction cones: these look the same
from all sides, so each contact is one point, friction force to the right and normal force up. A point on its
cone's edge slides or is about to, and one inside sticks.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SLIDES_LEFT, SLIDES_RIGHT
from contact_dynamics.contact_modes.result import applied_wrench
from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Arrows, Axis, Diagram, Faces, Labels, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import outline
from contact_dynamics.diagrams.words import contacts_in_words
from contact_dynamics.numerics.vectors import tangents_near_x

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes import SpatialMode
    from contact_dynamics.contact_modes.result import AnyMode, ResponseMode
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray


FORCE_LENGTH: Final = 0.6
"""Length of the longest force arrow, relative to the body's size. Labels contain the forces."""

MAX_MODES: Final = 6  # largest number of modes that are drawn. Further modes are only listed in words.
LETTERS: Final = "letters"  # the labels of the contacts. Only those of the newest answer are in view.

LABEL_DEPTH: Final = 0.6
"""How far below the contacts their label is, relative to the body's size, so that they are seen."""

CENTRE_LENGTH: Final = 0.6  # length of the arrows at the centre of mass, relative to the body's size
_SLIDING_LENGTH: Final = 0.3  # length of the arrows of sliding directions, relative to the body's size
_CONE_HEIGHT: Final = 0.25  # relative to the body's size
_POINT_SIZE: Final = 0.035  # radius of points, relative to the body's size
_ARROW_WIDTH: Final = 0.01  # relative to the body's size
_CONE_FACETS: Final = 32
_CONE_OPACITY: Final = 0.43

_UNDECIDED: Final = Paint(palette.UNDECIDED, paper.BLACK)
_BODY: Final = Paint(palette.NORMAL, paper.GREY)
_SLIDES: Final = Paint(palette.SLIDE, paper.YELLOW)
_ACCELERATION: Final = Paint(palette.PREDICTED, paper.ORANGE)


def contact_marks(
    shape: Shape, answer: ContactModeAnswer, *, body: MassProperties | None = None
) -> list[Mark]:
    """Return the marks of an answer about contact modes.

    ``shape`` is that of the body. Its applied force is drawn if its mass properties, ``body``, are known.
    """
    size, contacts = shape.size, answer.contacts
    edges = list(outline(shape, answer.state.p_WB_W, answer.state.q_WB))
    return [
        *_at_contacts(contacts, answer.modes, size=size),
        Lines("body", _BODY, edges, opacity=0.6, width=1.0),
        _applied(answer, body, size=size),
        *(
            mark
            for name, mode in zip(mode_names(), answer.modes, strict=False)
            for mark in _mode_marks(name, mode, answer, size=size)
        ),
    ]


def bodies_contact_marks(contacts: ContactSet, modes: Sequence[ResponseMode], *, size: float) -> list[Mark]:
    """Return the marks of the modes of several bodies, the largest of which has this size, m.

    The contact forces are those on the first body of each pair.
    """
    return [
        *_at_contacts(contacts, modes, size=size),
        *(
            mark
            for name, mode in zip(mode_names(), modes, strict=False)
            for mark in _force_marks(name, mode, contacts, mode.tangential_directions_W, size=size)
        ),
    ]


def _at_contacts(contacts: ContactSet, modes: Sequence[AnyMode], *, size: float) -> list[Mark]:
    """Return the contacts with their letters in all modes, and their friction cones."""
    letters = letters_of_contacts(tuple(mode.mode for mode in modes), len(contacts))
    paints = [paint_of_letters(text) for text in letters]
    return [
        Points("points", _UNDECIDED, contacts.p_WC_W, paints=paints, radius=_POINT_SIZE * size),
        _labels(letters, contacts, size=size),
        friction_cones(
            "cones",
            contacts.p_WC_W,
            contacts.normals_W,
            contacts.holding_frictions,
            height=_CONE_HEIGHT * size,
        ),
    ]


def _applied(answer: ContactModeAnswer, body: MassProperties | None, *, size: float) -> Arrows:
    """Return the force that acts on the body besides its contacts: gravity, and what pushes it."""
    force_W = np.zeros(3)
    if body is not None and answer.modes:
        force_W = applied_wrench(body, answer.state, answer.contacts, answer.modes[0])[:3]
    return _at_centre(
        "applied", _BODY, answer, force_W, "gravity and load: {:.3g} N", size=size, label_all=True
    )


def _at_centre(
    name: str,
    paint: Paint,
    answer: ContactModeAnswer,
    vector_W: FloatArray,
    label: str,
    *,
    size: float,
    label_all: bool = False,
) -> Arrows:
    """Return an arrow at the centre of mass with its amount, or none for a vector that is zero."""
    amount = float(np.linalg.norm(vector_W))
    n = int(amount > 0.0)
    vectors = (vector_W / (amount or 1.0) * (CENTRE_LENGTH * size))[None][:n]
    return Arrows(
        name,
        paint,
        answer.state.p_WB_W[None][:n],
        vectors,
        radius=_ARROW_WIDTH * size,
        labels=[label.format(amount)] * n,
        label_all=label_all,
    )


def mode_names() -> list[str]:
    """Return the names of the entities that hold one mode each."""
    return [f"mode_{i}" for i in range(1, MAX_MODES + 1)]


def _mode_marks(name: str, mode: SpatialMode, answer: ContactModeAnswer, *, size: float) -> list[Mark]:
    (acceleration_W,) = beyond(mode.acceleration_W[None], answer.acceleration_tolerance)
    label = f"{mode.mode}: {{:.3g}} m/s²"
    return [
        *_force_marks(name, mode, answer.contacts, _sliding_directions(answer, mode), size=size),
        _at_centre(f"{name}/acceleration", _ACCELERATION, answer, acceleration_W, label, size=size),
    ]


def _force_marks(
    name: str, mode: ResponseMode, contacts: ContactSet, sliding_W: FloatArray, *, size: float
) -> list[Mark]:
    """Return the contact forces of a mode, and the directions in which contacts slide, (n, 3) or zero."""
    points, forces_W = contacts.p_WC_W, mode.contact_forces_W
    magnitudes = np.linalg.norm(forces_W, axis=1)
    pressed = np.flatnonzero(magnitudes > 0.0)
    scale = FORCE_LENGTH * size / float(magnitudes.max()) if len(pressed) > 0 else 0.0
    slides = sliding_W.any(axis=1)
    return [
        Arrows(
            f"{name}/forces",
            _UNDECIDED,
            points[pressed],
            forces_W[pressed] * scale,
            paints=[paint_of_letters(mode.mode[i]) for i in pressed.tolist()],
            radius=_ARROW_WIDTH * size,
            labels=[f"{magnitude:.3g} N" for magnitude in magnitudes[pressed].tolist()],
        ),
        Arrows(
            f"{name}/sliding",
            _SLIDES,
            points[slides],
            sliding_W[slides] * (_SLIDING_LENGTH * size),
            radius=0.5 * _ARROW_WIDTH * size,
        ),
    ]


def letters_of_contacts(modes: tuple[str, ...], count: int) -> list[str]:
    """Return each contact's letters in all modes, each once, joined by `|`, or `?` if there is no mode."""
    return ["|".join(dict.fromkeys(mode[i] for mode in modes)) or "?" for i in range(count)]


def _labels(letters: list[str], contacts: ContactSet, *, size: float) -> Labels:
    """Return one label for the contacts with the same letters and the same normal, below them."""
    normals_W = contacts.normals_W
    groups: dict[tuple[str, tuple[float, ...]], list[int]] = {}
    for i, text in enumerate(letters):
        groups.setdefault((text, tuple(normals_W[i].round(2).tolist())), []).append(i)
    places = [
        contacts.p_WC_W[group].mean(axis=0) - LABEL_DEPTH * size * normals_W[group[0]]
        for group in groups.values()
    ]
    texts = [contacts_in_words(text, len(group)) for (text, _), group in groups.items()]
    paints = [paint_of_letters(text) for text, _ in groups]
    return Labels(LETTERS, _UNDECIDED, np.reshape(places, (-1, 3)), texts, paints=paints)


def paint_of_letters(letters: str) -> Paint:
    """Return the colour of a contact with these letters."""
    if letters not in palette.LETTER_COLORS:
        return _UNDECIDED
    return Paint(palette.LETTER_COLORS[letters], paper.LETTERS[letters])


def friction_cones(
    name: str, points_W: FloatArray, normals_W: FloatArray, frictions: FloatArray, *, height: float
) -> Faces:
    """Return friction cones at points, with sides of length ``height``, m. There is none without friction."""
    angles = np.linspace(0.0, 2.0 * math.pi, _CONE_FACETS, endpoint=False)
    rim_index = 1 + np.arange(_CONE_FACETS)
    facets = np.stack([np.zeros_like(rim_index), rim_index, np.roll(rim_index, -1)], axis=1)
    corners = [np.zeros((0, 3))]
    triangles = [np.zeros((0, 3), dtype=np.int64)]
    for p_W, normal_W, friction in zip(points_W, normals_W, frictions.tolist(), strict=True):
        if friction == 0.0:
            continue
        u_W, v_W = tangents_near_x(normal_W)
        half_angle = math.atan(friction)
        around = np.outer(np.cos(angles), u_W) + np.outer(np.sin(angles), v_W)
        rim = p_W + height * (math.cos(half_angle) * normal_W + math.sin(half_angle) * around)
        triangles.append(facets + (len(corners) - 1) * (1 + _CONE_FACETS))
        corners.append(np.vstack([p_W, rim]))
    paint = Paint(palette.FRICTION_CONE, paper.PURPLE)
    return Faces(name, paint, np.vstack(corners), triangles=np.vstack(triangles), opacity=_CONE_OPACITY)


_MARKERS: Final = "osD^v<>p*h"  # so that points at one place are seen
_MARGIN: Final = 1.15  # how far the axes reach, relative to the largest force
_DASHES: Final = ("-", "--", "-.", ":")


def contact_forces(contacts: ContactSet, mode: ResponseMode, *, title: str = "") -> Diagram:
    """Return the contact forces of a mode, N, with the friction cone of each different friction coefficient.

    Args:
        contacts: The contacts.
        mode: The mode, whose forces may be one choice of many.
        title: The title, which is the mode's letters by default.
    """
    normal = np.einsum("ni,ni->n", mode.contact_forces_W, contacts.normals_W)
    friction = np.linalg.norm(mode.contact_forces_W - normal[:, None] * contacts.normals_W, axis=1)
    top = _MARGIN * float(max(normal.max(initial=0.0), friction.max(initial=0.0))) or 1.0
    marks: list[Mark] = []
    coefficients = np.unique([contacts.frictions, contacts.holding_frictions])
    for i, coefficient in enumerate(coefficients.tolist()):
        reach = min(top, coefficient * top)
        marks.append(
            Lines(
                f"cone_{i + 1}",
                Paint(palette.FRICTION_CONE, paper.PURPLE),
                [np.array([(0.0, 0.0), (reach, reach / coefficient if coefficient > 0.0 else top)])],
                width=1.9,
                dash=_DASHES[i % len(_DASHES)],
                legend=f"edge of the friction cone, μ = {coefficient:.3g}",
            )
        )
    count = len(mode.mode)
    for i, (x, y, letter) in enumerate(zip(friction.tolist(), normal.tolist(), mode.mode, strict=True)):
        marks.append(
            Points(
                f"contact_{i + 1}",
                Paint(palette.LETTER_COLORS[letter], paper.LETTERS[letter]),
                np.array([(x, y)]),
                marker=_MARKERS[i % len(_MARKERS)],
                size=6.0 + 3.0 * (count - 1 - i) / max(count - 1, 1),
                legend=f"contact {i + 1} {letter}: {x:.3g}, {y:.3g} N",
                is_noted=True,
            )
        )
    axes = tuple(Axis(f"{name} force, N", -0.05 * top, top) for name in ("friction", "normal"))
    return Diagram(marks=marks, axes=axes, title=title or mode.mode)


def _sliding_directions(answer: ContactModeAnswer, mode: SpatialMode) -> FloatArray:
    """Return the unit direction in which each contact slides in a mode, (n, 3), world axes, or zero.

    In space the mode has the directions. In a plane its letters give them: l is against the tangent, r along
    it.
    """
    if answer.plane is None:
        return mode.tangential_directions_W
    ways = np.array([{SLIDES_LEFT: -1.0, SLIDES_RIGHT: 1.0}.get(letter, 0.0) for letter in mode.mode])
    tangents = np.cross(answer.contacts.normals_W, answer.plane.normal_W)
    directions: FloatArray = ways[:, None] * tangents / np.linalg.norm(tangents, axis=1, keepdims=True)
    return directions


def beyond(vectors: FloatArray, tolerance: float) -> FloatArray:
    """Return vectors, (n, k), in which those no longer than a tolerance are set to zero."""
    return np.where(np.linalg.norm(vectors, axis=1, keepdims=True) > tolerance, vectors, 0.0)
