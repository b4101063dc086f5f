"""Lecture 26's construction for one mode: acceleration centres and force duals, and what they span.

The applied wrenches that can bring a mode about are pos({a} + {-c_i}): a its accelerations, c_i the edges of
the friction cones that its letters allow. Each is a point of the oriented plane, anticlockwise on the left,
clockwise on the right. The mode's wrenches are the convex hull, which may pass through infinity from one to
the other. The body's outline is drawn below, so that a point is the centre that a motion would have.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.plane.force_dual import friction_cone
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import FORCE_DUAL
from contact_dynamics.viewing.mode_map import NO_MODE, borders_of, draw_frame, mode_regions
from contact_dynamics.viewing.wrench_chart import ANTICLOCKWISE, CLOCKWISE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.plane.types import PlanarContact, PlanarWrench
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.wrench_chart import ForceDualChart

_PARALLEL: Final = 1e-9
"""1 - cos of the angle below which a generator is a friction cone's edge."""

_POINT_SIZE: Final = -4.5  # a negative size is in points of the screen
_OUTLINE_WIDTH: Final = -1.2
_FILL: Final = 0.55  # share of the mode's colour in its region


def draw_force_dual(
    recording: rr.RecordingStream,
    one: PlanarWrenchSet,
    contacts: Sequence[PlanarContact],
    chart: ForceDualChart,
    *,
    outlines: Sequence[FloatArray] = (),
    color: palette.Color = palette.SLIDE,
    entity: str = FORCE_DUAL,
) -> None:
    """Draw the construction for one mode of a body at rest, at the recording's current time.

    Args:
        recording: to draw into.
        one: the mode's applied wrenches, of `contact_modes.wrench_sets`.
        contacts: all contacts, in the order of the mode's letters.
        chart: how much of the plane to show.
        outlines: strips, (k, 2) each, m from the centre of mass, drawn below: the body, walls.
        color: the colour of the mode's wrenches, as `color_of_modes` has it in the map.
        entity: where the picture is put.
    """
    regions = mode_regions([one], chart)
    fill = [_FILL * a + (1.0 - _FILL) * b for a, b in zip(color, palette.BACKGROUND, strict=True)]
    inside = (regions.classes > NO_MODE).astype(int)
    pixels = np.array([palette.BACKGROUND, fill]).astype(np.uint8)[inside, :3]
    recording.log(f"{entity}/wrenches", rr.Image(pixels, color_model="RGB", draw_order=-20.0))
    below = [chart.place_points(strip, part) for strip in outlines for part in (ANTICLOCKWISE, CLOCKWISE)]
    strips = rr.LineStrips2D(below, colors=palette.translucent(palette.MEASURED, 0.6), radii=_OUTLINE_WIDTH)
    recording.log(f"{entity}/body", strips)
    borders = rr.LineStrips2D(borders_of(one, chart), colors=color, radii=_OUTLINE_WIDTH)
    recording.log(f"{entity}/borders", borders)
    forces, motions = split_generators(one, contacts)
    for name, wrenches, point_color, labels in (
        (
            "contact_forces",
            [wrench for _, wrench in forces],
            palette.FRICTION_CONE,
            [f"-c{number}" for number, _ in forces],
        ),
        ("acceleration_centres", motions, palette.PREDICTED, ["a"] * len(motions)),
    ):
        rows = np.array([(*wrench.f, wrench.moment) for wrench in wrenches]).reshape(-1, 3)
        places, part = chart.place(rows)
        shown = np.flatnonzero(part >= 0).tolist()
        points = rr.Points2D(
            places[shown],
            colors=palette.translucent(point_color, 1.0),
            radii=_POINT_SIZE,
            labels=[labels[i] for i in shown],
            show_labels=True,
        )
        recording.log(f"{entity}/{name}", points)
    draw_frame(recording, chart, entity)


def split_generators(
    one: PlanarWrenchSet, contacts: Sequence[PlanarContact]
) -> tuple[list[tuple[int, PlanarWrench]], list[PlanarWrench]]:
    """Return a mode's negated cone edges, each with its contact's number from 1, and its accelerations."""
    edges = [
        (number, edge)
        for number, (contact, letter) in enumerate(zip(contacts, one.mode, strict=True), start=1)
        if letter != "s"
        for edge in friction_cone(contact)
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
