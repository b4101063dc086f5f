# SPDX-License-Identifier: Apache-2.0
"""Lecture 26's construction shows acceleration centres and force duals of one mode, and what they span.

The applied wrenches that can bring a mode about are pos({a} + {-c_i}): a its accelerations, c_i the edges of
the friction cones that its letters allow. Each is a point of the oriented plane, anticlockwise on the left,
clockwise on the right. The mode's wrenches are the convex hull, which may pass through infinity from one to
the other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Diagram, Labels, Lines, Points, Regions, near_one_another
from contact_dynamics.diagrams.mode_map import NO_MODE, borders_of, chart_frame, mode_regions
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.wrench_chart import ANTICLOCKWISE, CLOCKWISE, HIDDEN
from contact_dynamics.plane.types import friction_cone

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarMode, PlanarWrenchSet
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.wrench_chart import ForceDualChart
    from contact_dynamics.plane.types import PlanarContact, PlanarWrench
    from contact_dynamics.validation import FloatArray

_PARALLEL: Final = 1e-9  # 1 - cos of the angle below which a generator is a friction cone's edge
_NEAR: Final = 0.02  # points nearer than this share a label, relative to a part's side
_NAME: Final = np.array([0.03, 0.03])  # where a label is, beside its point, relative to a part's side
_FILL: Final = 0.55  # share of the mode's colour in its region
_REGION: Final = "#d9e8f5"  # the blue of a mode's wrenches, light enough for points and lines on it

_BODY: Final = Paint(palette.MEASURED, paper.GREY)
_CONE: Final = Paint(palette.FRICTION_CONE, paper.PURPLE)
_CENTRE: Final = Paint(palette.PREDICTED, paper.ORANGE)
_APPLIED: Final = Paint(palette.IMPACT, paper.MARK)


def force_dual(
    one: PlanarWrenchSet,
    contacts: Sequence[PlanarContact],
    chart: ForceDualChart,
    *,
    outlines: Sequence[FloatArray] = (),
    color: palette.Color = palette.SLIDE,
    applied: PlanarWrench | None = None,
    mode: PlanarMode | None = None,
) -> Diagram:
    """Return the construction for one mode of a body at rest.

    Args:
        one: The mode's applied wrenches, of `contact_modes.wrench_sets`.
        contacts: All contacts, in the order of the mode's letters.
        chart: How much of the plane to show.
        outlines: Strips, (k, 2) each, m from the centre of mass: the body, walls.
        color: The colour of the mode in the viewer, as in `mode_map.paint_of_modes`.
        applied: A wrench to mark.
        mode: The mode, whose acceleration is marked by its centre.
    """
    inside = (mode_regions([one], chart).classes > NO_MODE).astype(np.int64)
    fill = [round(_FILL * a + (1.0 - _FILL) * b) for a, b in zip(color, palette.BACKGROUND, strict=True)]
    region = Paint((fill[0], fill[1], fill[2], 255), _REGION)
    both = [chart.place_points(strip, part) for strip in outlines for part in (ANTICLOCKWISE, CLOCKWISE)]
    marks: list[Mark] = [
        Regions(
            "wrenches",
            region,
            inside,
            paints=[Paint(palette.BACKGROUND, paper.SEVERAL), region],
            legends=["", f"wrenches that can bring about {one.mode}"],
        ),
        Lines("outlines", _BODY, both, legend="the body, drawn in both halves"),
        Lines("borders", Paint(color, paper.BLUE), borders_of(one, chart)),
    ]
    forces, motions = split_generators(one, contacts)
    for name, paint, wrenches, labels, legend in (
        (
            "contact_forces",
            _CONE,
            [wrench for _, wrench in forces],
            [f"-c{number}" for number, _ in forces],
            "-c: edge of contact's cone, negated",
        ),
        ("acceleration_centres", _CENTRE, motions, ["a"] * len(motions), "a: centre of an acceleration"),
    ):
        rows = np.array([(*wrench.f, wrench.moment) for wrench in wrenches]).reshape(-1, 3)
        places, part = chart.place(rows)
        shown = np.flatnonzero(part != HIDDEN).tolist()
        marks.append(Points(name, paint, places[shown], legend=legend if shown else ""))
        marks.append(_names(f"{name}_names", paint, places[shown], [labels[i] for i in shown], chart))
    frame, axes = chart_frame(chart)
    return Diagram(
        marks=[*marks, *frame, *answer_marks(chart, applied=applied, mode=mode)],
        axes=axes,
        title=f"{one.mode}: acceleration centres and force duals",
    )


def answer_marks(
    chart: ForceDualChart, *, applied: PlanarWrench | None, mode: PlanarMode | None
) -> list[Mark]:
    """Return the marks of a wrench, at its force dual, and of the centre of a mode's acceleration."""
    told: list[tuple[str, Paint, tuple[float, ...]]] = []
    if mode is not None:
        turn = mode.angular_acceleration * chart.length**2
        told.append(("acceleration centre", _CENTRE, (*mode.acceleration, turn)))
    if applied is not None:
        told.append(("applied wrench", _APPLIED, (*applied.f, applied.moment)))
    marks: list[Mark] = []
    for name, paint, wrench in told:
        places, part = chart.place(np.array([wrench]))
        marks.append(
            Points(
                f"answer/{name.replace(' ', '_')}",
                paint,
                places[part != HIDDEN],
                size=11.0,
                legend=name,
                is_noted=True,
            )
        )
    return marks


def _names(name: str, paint: Paint, places: FloatArray, labels: list[str], chart: ForceDualChart) -> Labels:
    """Return the labels above points. Points at one place share a label."""
    groups = near_one_another(places, within=_NEAR * chart.resolution)
    return Labels(
        name,
        Paint(paint.dark, paper.BLACK),
        np.reshape([places[group[0]] + _NAME * chart.resolution for group in groups], (-1, 2)),
        [", ".join(dict.fromkeys(labels[i] for i in group)) for group in groups],
    )


def split_generators(
    one: PlanarWrenchSet, contacts: Sequence[PlanarContact]
) -> tuple[list[tuple[int, PlanarWrench]], list[PlanarWrench]]:
    """Return a mode's negated cone edges, each with its contact's number from 1, and its accelerations."""
    edges = [
        (number, edge)
        for number, (contact, letter) in enumerate(zip(contacts, one.mode, strict=True), start=1)
        if letter != "s"
        for edge in friction_cone(contact, sticks=letter == "f")
    ]
    forces: list[tuple[int, PlanarWrench]] = []
    motions: list[PlanarWrench] = []
    for generator in one.generators:
        number = next((number for number, edge in edges if _opposes(edge, generator)), None)
        if number is None:
            motions.append(generator)
        else:
            forces.append((number, generator))
    return forces, motions


def _opposes(edge: PlanarWrench, generator: PlanarWrench) -> bool:
    a = np.array([*edge.f, edge.moment])
    b = np.array([*generator.f, generator.moment])
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return bool(a @ b < -(1.0 - _PARALLEL) * size)
