"""Lecture 26's construction shows acceleration centres and force duals of one mode, and what they span.

The applied wrenches that can bring a mode about are pos({a} + {-c_i}): a its accelerations, c_i the edges of
the friction cones that its letters allow. Each is a point of the oriented plane, anticlockwise on the left,
clockwise on the right. The mode's wrenches are the convex hull, which may pass through infinity from one to
the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.diagrams.mode_map import NO_MODE, borders_of, mode_regions
from contact_dynamics.diagrams.wrench_chart import ANTICLOCKWISE, CLOCKWISE, HIDDEN
from contact_dynamics.plane.force_dual import friction_cone

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.contact_modes import PlanarWrenchSet
    from contact_dynamics.diagrams.wrench_chart import ForceDualChart
    from contact_dynamics.plane.types import PlanarContact, PlanarWrench
    from contact_dynamics.validation import FloatArray

_PARALLEL: Final = 1e-9
"""1 - cos of the angle below which a generator is a friction cone's edge."""


class Dots(NamedTuple):
    """Dots with a label each. Those that the chart does not show are left out.

    Attributes:
        places: (k, 2), points.
        labels: (k,), what each is.
    """

    places: FloatArray
    labels: list[str]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceDual:
    """The construction on a chart. Places are in points of the picture.

    Attributes:
        inside: (h, w), whether the wrench at each point can bring the mode about.
        borders: Strips of places, (k, 2) each, around those points.
        outlines: Strips of places, (k, 2) each, of the body and its walls, on both parts of the chart.
        contact_forces: Force duals of the negated edges of friction cones, "-c" with the contact's number.
        acceleration_centres: Centres of the mode's accelerations, "a".
    """

    inside: NDArray[np.bool_]
    borders: list[FloatArray]
    outlines: list[FloatArray]
    contact_forces: Dots
    acceleration_centres: Dots


def force_dual_of(
    one: PlanarWrenchSet,
    contacts: Sequence[PlanarContact],
    chart: ForceDualChart,
    *,
    outlines: Sequence[FloatArray] = (),
) -> ForceDual:
    """Return the construction for one mode of a body at rest.

    Args:
        one: The mode's applied wrenches, of `contact_modes.wrench_sets`.
        contacts: All contacts, in the order of the mode's letters.
        chart: How much of the plane to show.
        outlines: Strips, (k, 2) each, m from the centre of mass: the body, walls.
    """
    forces, motions = split_generators(one, contacts)
    return ForceDual(
        inside=mode_regions([one], chart).classes > NO_MODE,
        borders=borders_of(one, chart),
        outlines=[
            chart.place_points(strip, part) for strip in outlines for part in (ANTICLOCKWISE, CLOCKWISE)
        ],
        contact_forces=_dots(
            chart, [wrench for _, wrench in forces], [f"-c{number}" for number, _ in forces]
        ),
        acceleration_centres=_dots(chart, motions, ["a"] * len(motions)),
    )


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


def _dots(chart: ForceDualChart, wrenches: Sequence[PlanarWrench], labels: Sequence[str]) -> Dots:
    rows = np.array([(*wrench.f, wrench.moment) for wrench in wrenches]).reshape(-1, 3)
    places, part = chart.place(rows)
    shown = np.flatnonzero(part != HIDDEN).tolist()
    return Dots(places=places[shown], labels=[labels[i] for i in shown])


def _opposes(edge: PlanarWrench, generator: PlanarWrench) -> bool:
    a = np.array([*edge.f, edge.moment])
    b = np.array([*generator.f, generator.moment])
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return bool(a @ b < -(1.0 - _PARALLEL) * size)
