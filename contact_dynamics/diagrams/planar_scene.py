# SPDX-License-Identifier: Apache-2.0
"""Outlines a planar body, walls and friction cones, with one mode's letters and forces, or all side by side.

Coordinates are in metres from the centre of mass, x to the right, y up. The normal of an answer's plane
points towards the eye. What the map of an answer's modes shows is here too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet, WrenchHalfSpace, length_of
from contact_dynamics.contact_modes.result import PlanarMode, applied_wrench, motion_in_words
from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.contact_scene import beyond
from contact_dynamics.diagrams.marks import Arrows, Axis, Diagram, Labels, Lines, Points, near_one_another
from contact_dynamics.diagrams.mode_map import LIVE_RESOLUTION, chart_for
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import FLAT
from contact_dynamics.diagrams.words import margin_in_words
from contact_dynamics.diagrams.wrench_chart import DirectionChart, ForceDualChart
from contact_dynamics.plane.types import PlanarContact, PlanarWrench

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import SpatialMode, SpatialWrenchSet
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.diagrams.wrench_chart import WrenchChart
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray


CONE_LENGTH: Final = 0.2  # length of a friction cone's edges, relative to the body's size
ARROW_LENGTH: Final = 0.4  # length of the longest arrow of a kind, relative to the body's size
LABEL_OFFSET: Final = 0.11  # distance of a label from its contact, relative to the body's size
_COVERED: Final = 0.2  # labels nearer than this would cover each other, relative to the body's size
_ALIGNED: Final = 0.95  # smallest length of the mean of unit normals of one surface
_SHOWN: Final = 1e-6  # arrows shorter than this are left out, relative to the longest
_AROUND: Final = 0.24  # room around body and contacts, relative to the body's size

_WALL: Final = Paint(palette.NORMAL, paper.AXIS)
_BODY: Final = Paint(palette.MEASURED, paper.GREY)
_CONE: Final = Paint(palette.FRICTION_CONE, paper.PURPLE)
_FORCE: Final = Paint(palette.IMPACT, paper.RED)
_ACCELERATION: Final = Paint(palette.PREDICTED, paper.ORANGE)
_LETTERS: Final = (
    ("fixed", "f", Paint(palette.FIXED, paper.BLUE), "contact that stays fixed (f)"),
    ("slides", "lr", Paint(palette.SLIDE, paper.YELLOW), "contact that slides left (l), right (r)"),
    ("separates", "s", Paint(palette.SEPARATE, paper.SKY), "contact that separates (s)"),
    ("undecided", "?", Paint(palette.UNDECIDED, paper.BLACK), "contact"),
)


def planar_scene_of(
    outline: FloatArray,
    contacts: Sequence[PlanarContact],
    *,
    walls: Sequence[FloatArray] = (),
    mode: PlanarMode | None = None,
    size: float | None = None,
    title: str = "",
) -> Diagram:
    """Return the diagram of a body and its contacts, numbered from 1.

    The outline, (k, 2), m, whose last point is its first, and the walls, (k, 2) each, m, are strips. The
    letters, contact forces and accelerations are those of the mode, if any. Arrows and cones suit a body of
    that size, m, by default that of the outline.
    """
    if size is None:
        size = float(np.linalg.norm(np.ptp(outline, axis=0)))
    points = np.array([contact.r for contact in contacts]).reshape(-1, 2)
    normals = np.array([contact.normal for contact in contacts]).reshape(-1, 2)
    letters = mode.mode if mode else "?" * len(contacts)
    cones = [cone_edges(contact, length=CONE_LENGTH * size) for contact in contacts]
    arrows: list[Arrows] = []
    if mode is not None:
        arrows += _arrows("forces", _FORCE, mode.contact_forces, contacts, unit="N", size=size)
        arrows += _arrows(
            "accelerations", _ACCELERATION, mode.contact_accelerations, contacts, unit="m/s²", size=size
        )
    marks: list[Mark] = [
        Lines("walls", _WALL, walls, width=5.0, legend="surface", is_obvious=True),
        Lines("body", _BODY, [outline], width=2.2, legend="body", is_obvious=True),
        Lines("cones", _CONE, cones, width=1.5, legend="friction cone"),
        Points(
            "centre_of_mass", _BODY, np.zeros((1, 2)), marker="+", legend="centre of mass", is_obvious=True
        ),
    ]
    places = points - LABEL_OFFSET * size * normals
    groups = near_one_another(places, within=_COVERED * size)
    for word, group, paint, meaning in _LETTERS:
        chosen = [i for i, letter in enumerate(letters) if letter in group]
        named = [same for same in groups if letters[same[0]] in group]
        if chosen:
            marks.append(Points(f"contacts/{word}", paint, points[chosen], size=6.5, legend=meaning))
            middles = [_place_of(same, points, normals, size) for same in named]
            texts = [_text_of(same, letters if mode else "") for same in named]
            label = Paint(paint.dark, paper.BLACK)
            marks.append(Labels(f"letters/{word}", label, np.reshape(middles, (-1, 2)), texts))
    marks += arrows
    tips = [each.origins + each.vectors for each in arrows]
    everything = np.vstack([outline, points, np.zeros((1, 2)), *tips])
    low, high = everything.min(axis=0) - _AROUND * size, everything.max(axis=0) + _AROUND * size
    names = ("right of the centre of mass, m", "above the centre of mass, m")
    axes = tuple(Axis(*each) for each in zip(names, low.tolist(), high.tolist(), strict=True))
    return Diagram(marks=marks, axes=axes, title=title)


def cone_edges(contact: PlanarContact, *, length: float) -> FloatArray:
    """Return a friction cone as a strip, (3, 2), m, with edges of that length, m."""
    angle = math.atan(contact.holding_friction)
    normal, tangent = np.array(contact.normal), np.array(contact.tangent)
    upward, sideways = length * math.cos(angle) * normal, length * math.sin(angle) * tangent
    strip: FloatArray = np.array(contact.r) + np.array([upward + sideways, np.zeros(2), upward - sideways])
    return strip


def silhouette(shape: Shape, axes_B: FloatArray) -> FloatArray:
    """Return the outline of a shape's hull on two axes, (2, 3), unit, as a closed strip, (k, 2), m."""
    from scipy.spatial import ConvexHull

    corners = np.vstack([shape.triangles_B.reshape(-1, 3), shape.edges_B.reshape(-1, 3)]) @ axes_B.T
    if len(corners) == 0 or np.linalg.matrix_rank(corners - corners[0], tol=FLAT * shape.size) < 2:
        return corners[:2]  # a rod is a line, and so is a disc seen from the side
    hull = ConvexHull(corners).vertices
    strip: FloatArray = corners[[*hull, hull[0]]]
    return strip


def _arrows(
    name: str,
    paint: Paint,
    pairs: Sequence[tuple[float, float]],
    contacts: Sequence[PlanarContact],
    *,
    unit: str,
    size: float,
) -> list[Arrows]:
    """Return arrows of vectors along each contact's tangent and normal, without those too short to see."""
    rows = np.array(pairs).reshape(-1, 2)
    points = np.array([contact.r for contact in contacts]).reshape(-1, 2)
    normals = np.array([contact.normal for contact in contacts]).reshape(-1, 2)
    tangents = np.array([contact.tangent for contact in contacts]).reshape(-1, 2)
    vectors = rows[:, :1] * tangents + rows[:, 1:] * normals
    lengths = np.linalg.norm(vectors, axis=1)
    longest = float(lengths.max(initial=0.0))
    chosen = np.flatnonzero(lengths > _SHOWN * longest)
    if len(chosen) == 0:
        return []
    labels = [f"{length:.3g} {unit}" for length in lengths[chosen].tolist()]
    numbered = "\n".join(f"  {i + 1}: {label}" for i, label in zip(chosen.tolist(), labels, strict=True))
    return [
        Arrows(
            name,
            paint,
            points[chosen],
            vectors[chosen] * (ARROW_LENGTH * size / longest),
            labels=labels,
            legend=f"{name.removesuffix('s')} at contact\n{numbered}",
        )
    ]


def _text_of(contacts: list[int], letters: str) -> str:
    """Return the numbers of contacts from 1, those with the same letter together with it."""
    by_letter: dict[str, list[str]] = {}
    for i in contacts:
        by_letter.setdefault(letters[i] if letters else "", []).append(str(i + 1))
    return "; ".join(f"{', '.join(numbers)} {letter}".rstrip() for letter, numbers in by_letter.items())


def _place_of(contacts: list[int], points: FloatArray, normals: FloatArray, size: float) -> FloatArray:
    """Return the place of a label, (2,), m: behind its contact, or in the corner between two surfaces."""
    outward = -normals[contacts].sum(axis=0)
    aligned = float(np.linalg.norm(outward)) / len(contacts)
    if aligned > _ALIGNED or aligned < 1.0 - _ALIGNED:  # one surface, or two that face each other
        return np.asarray(points[contacts[0]] - LABEL_OFFSET * size * normals[contacts[0]])
    corner = points[contacts].mean(axis=0)
    return np.asarray(corner + 2.4 * LABEL_OFFSET * size * outward / np.linalg.norm(outward))


NO_SIZE: Final = 0.1  # m. A body without shape is drawn with this size at its only contact.

MAX_SETS: Final = 100
"""A map of more modes than this is not drawn, because its regions are too small to see and take seconds."""

_ABOUT: Final = 0.35  # room around body and contacts in the force dual, relative to the body's size
_FLAT: Final = 0.1  # half of the length of a contact's flat, relative to the body's size


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModesSideBySide:
    """The consistent modes of a planar body. There is one picture without a mode if none is consistent."""

    contacts: tuple[PlanarContact, ...]  # the contacts
    modes: tuple[PlanarMode, ...]  # may be empty
    titles: list[str]  # title of each picture
    # Outline of the body, a closed strip, (k, 2), m from the centre of mass, which may be empty.
    outline: FloatArray

    @property
    def extent(self) -> FloatArray:
        """The lower left and the upper right corner of body and contacts, (2, 2), m."""
        points = [np.reshape(contact.r, (1, 2)) for contact in self.contacts]
        everything = np.vstack([self.outline, *points, np.zeros((1, 2))])
        return np.array([everything.min(axis=0), everything.max(axis=0)])

    @property
    def size(self) -> float:
        """The size of body and contacts, m."""
        low, high = self.extent
        return float(np.linalg.norm(high - low)) or NO_SIZE

    @property
    def walls(self) -> list[FloatArray]:
        """The flats of the contacts, a strip (2, 2) each, m."""
        along = _FLAT * self.size * np.array([[-1.0], [1.0]])
        return [np.array(contact.r) + along * np.array(contact.tangent) for contact in self.contacts]

    @property
    def scenes(self) -> list[Diagram]:
        """The picture of each mode, or the one without a mode."""
        return [
            planar_scene_of(
                self.outline, self.contacts, walls=self.walls, mode=mode, size=self.size, title=title
            )
            for mode, title in zip(self.modes or (None,), self.titles, strict=True)
        ]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AnswersMap:
    """What the map of modes of a planar answer shows."""

    sets: tuple[PlanarWrenchSet, ...]  # the applied wrenches of each mode
    chart: WrenchChart  # the chart that suits them
    applied: PlanarWrench | None  # the wrench in question, or None if it is not known
    # The least change that takes it out of the first mode, or None if it is not known.
    change: PlanarWrench | None


def modes_side_by_side(
    answer: ContactModeAnswer, plane: PlaneOfMotion, *, outline: FloatArray
) -> ModesSideBySide:
    """Return the consistent modes of an answer, in world axes, seen against the normal of its plane.

    The ``outline`` of the body is a closed strip, (k, 2), m from the centre of mass. It may be empty.
    """
    modes = _seen_modes(answer, plane)
    margins = [margin_in_words(margin) for margin in answer.margins or ()] or [""] * len(modes)
    titles = [
        f"{mode.mode}: {motion_in_words(mode)}\n{margin}".rstrip()
        for mode, margin in zip(modes, margins, strict=True)
    ]
    return ModesSideBySide(
        contacts=_seen_contacts(answer, plane),
        modes=modes,
        titles=titles or ["approaches" if answer.approaching else "no consistent mode"],
        outline=outline,
    )


def map_of_answer(
    answer: ContactModeAnswer,
    plane: PlaneOfMotion,
    *,
    body: MassProperties | None = None,
    resolution: int = LIVE_RESOLUTION,
) -> AnswersMap | None:
    """Return the map of an answer, or None if it has no wrench sets, or more than `MAX_SETS`.

    The wrench in question follows from the mass properties of the ``body``. The chart has ``resolution``
    points on a side.
    """
    if not answer.wrench_sets or len(answer.wrench_sets) > MAX_SETS:
        return None
    sets = tuple(_seen_wrench_set(wrenches, plane) for wrenches in answer.wrench_sets)
    applied = applied_of(answer, plane, body)
    return AnswersMap(
        sets=sets,
        chart=chart_for(sets, length=length_of(sets), applied=applied, resolution=resolution),
        applied=applied,
        change=_change(answer, plane),
    )


def dual_chart_of(view: ModesSideBySide, shown: AnswersMap, *, resolution: int) -> ForceDualChart | None:
    """Return the chart of force duals for the modes of an answer, as wide as each of their pictures.

    It is None where there is no such construction: without a consistent mode, or for a moving body. Each of
    its squares has ``resolution`` points on a side.
    """
    if not view.modes or not isinstance(shown.chart, DirectionChart):
        return None
    low, high = view.extent
    middle = 0.5 * (low + high)
    return ForceDualChart(
        length=shown.chart.length,
        half_side=0.5 * float(np.max(high - low)) + _ABOUT * view.size,
        centre=(float(middle[0]), float(middle[1])),
        resolution=resolution,
    )


def applied_of(
    answer: ContactModeAnswer, plane: PlaneOfMotion, body: MassProperties | None
) -> PlanarWrench | None:
    """Return the wrench in question, or None if it is not known: without modes or mass properties."""
    if body is None or not answer.modes:
        return None
    return _seen_wrench(applied_wrench(body, answer.state, answer.contacts, answer.modes[0]), plane)


def _change(answer: ContactModeAnswer, plane: PlaneOfMotion) -> PlanarWrench | None:
    """Return the least change that takes the wrench out of the first mode, or None if it is not known."""
    if not answer.margins or not math.isfinite(answer.margins[0].margin):
        return None
    return _seen_wrench(answer.margins[0].change_W, plane)


def _seen_contacts(answer: ContactModeAnswer, plane: PlaneOfMotion) -> tuple[PlanarContact, ...]:
    """Return the contacts in the plane, all as points on flats."""
    contacts = answer.contacts
    arms = (contacts.p_WC_W - answer.state.p_WB_W) @ plane.axes_W.T
    normals = contacts.normals_W @ plane.axes_W.T
    return tuple(
        PlanarContact(
            r=_pair(arm),
            normal=_pair(normal / np.linalg.norm(normal)),
            friction=one.friction,
            static_friction=one.static_friction,
        )
        for arm, normal, one in zip(arms, normals, contacts, strict=True)
    )


def _seen_modes(answer: ContactModeAnswer, plane: PlaneOfMotion) -> tuple[PlanarMode, ...]:
    """Return the consistent modes in the plane. Accelerations within the answer's tolerance are zero."""
    bases = np.array([(contact.tangent, contact.normal) for contact in _seen_contacts(answer, plane)])
    bases_W = bases.reshape(-1, 2, 2) @ plane.axes_W
    return tuple(_seen_mode(mode, plane, bases_W, answer.acceleration_tolerance) for mode in answer.modes)


def _seen_wrench_set(wrenches: SpatialWrenchSet, plane: PlaneOfMotion) -> PlanarWrenchSet:
    """Return the applied wrenches of a mode within the plane."""
    return PlanarWrenchSet(
        mode=wrenches.mode,
        vertices=tuple(_seen_wrench(row, plane) for row in wrenches.vertices),
        generators=tuple(_seen_wrench(row, plane) for row in wrenches.generators),
        half_spaces=tuple(
            WrenchHalfSpace(
                a=(*_pair(plane.axes_W @ row[:3]), float(plane.normal_W @ row[3:6])), b=float(row[6])
            )
            for row in wrenches.half_spaces
        ),
    )


def _seen_wrench(wrench_W: FloatArray, plane: PlaneOfMotion) -> PlanarWrench:
    """Return a wrench in the plane from force and torque, (6,), N and N m, world axes."""
    return PlanarWrench(f=_pair(plane.axes_W @ wrench_W[:3]), moment=float(plane.normal_W @ wrench_W[3:]))


def _seen_mode(mode: SpatialMode, plane: PlaneOfMotion, bases_W: FloatArray, tolerance: float) -> PlanarMode:
    """Return a mode in the plane. ``bases_W``, (n, 2, 3), has the tangent and the normal of each contact."""
    forces, accelerations = (
        tuple(_pair(pair) for pair in np.einsum("nij,nj->ni", bases_W, vectors_W))
        for vectors_W in (mode.contact_forces_W, beyond(mode.contact_accelerations_W, tolerance))
    )
    return PlanarMode(
        mode=mode.mode,
        acceleration=_pair(plane.axes_W @ mode.acceleration_W),
        angular_acceleration=float(plane.normal_W @ mode.angular_acceleration_W),
        contact_forces=forces,
        contact_accelerations=accelerations,
        forces_unique=mode.forces_unique,
        motion_unique=mode.motion_unique,
    )


def _pair(vector: FloatArray) -> Vector2:
    x, y = vector.tolist()
    return (x, y)
