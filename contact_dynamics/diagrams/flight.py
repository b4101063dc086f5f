# SPDX-License-Identifier: Apache-2.0
"""Where a body was predicted to be: the path of its centre of mass, outlines on it, its last pose.

The path is drawn until a surface is in the body's way. If the prediction has covariances, there is an
ellipsoid at each outline. It extends two deviations to each side, and so contains the centre of mass in three
of four cases. A white one is not to be relied on.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Ellipsoids, Lines
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import NO_FACES, outline, solid
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.motion.covariance import CarriedCovariance
    from contact_dynamics.shapes.obstacle import Obstacle


MAX_PATH_POINTS: Final = 2000
"""If there are more samples than this, they are thinned out evenly. It is the width of a screen."""

MAX_OUTLINES: Final = 6
"""Number of outlines of the body along the path, evenly in time, besides the one at its end. A short path has
one for each length of the body."""

NEARBY: Final = 0.25
"""Relative to the size of the body: an end that is nearer to the start is not drawn, since it would only hide
the body."""

DEVIATIONS: Final = 2.0
"""Half axes of the ellipsoids of uncertainty, in standard deviations: 74 % of a normal distribution."""

_PATH_WIDTH: Final = 2.5
EARLIER: Final = {"opacity": 0.4, "width": 1.25}  # how the paths of earlier predictions look
_PAINT: Final = Paint(palette.PREDICTED, paper.ORANGE)
_DOUBTFUL: Final = Paint(palette.UNDECIDED, paper.GREY)


def flight_marks(
    shape: Shape, trajectory: Trajectory, *, covariance: CarriedCovariance | None = None
) -> list[Mark]:
    """Return the marks of a trajectory with samples.

    ``covariance`` is the covariance of the state at the trajectory's samples, or None if it is not known.
    """
    last = len(trajectory) - 1
    travelled = float(np.linalg.norm(np.diff(trajectory.p_WB_W, axis=0), axis=1).sum())
    count = min(MAX_OUTLINES, int(travelled / shape.size))
    times = np.linspace(trajectory.seconds[0], trajectory.seconds[-1], count + 2)[1:-1]
    chosen = np.abs(trajectory.seconds[:, None] - times).argmin(axis=0).tolist()
    outlines = [edge for i in chosen for edge in outline(shape, trajectory.p_WB_W[i], trajectory.q_WB[i])]
    pose = trajectory.p_WB_W[last], trajectory.q_WB[last]
    moves_away = travelled > NEARBY * shape.size
    end = outline(shape, *pose) if moves_away else ()
    return [
        path_mark("path", trajectory, opacity=1.0, width=_PATH_WIDTH),
        Lines("outlines", _PAINT, outlines, opacity=0.45, width=1.0),
        Lines("end", _PAINT, list(end), width=1.9),
        *_ellipsoids(trajectory, covariance, [*chosen, last]),
        solid(shape if moves_away else NO_FACES, "newest_end/faces", _PAINT, *pose, opacity=0.25),
    ]


def path_mark(name: str, trajectory: Trajectory, *, opacity: float, width: float) -> Lines:
    """Return the path of a trajectory, thinned out."""
    last = len(trajectory) - 1
    samples = np.unique(np.linspace(0, last, min(last + 1, MAX_PATH_POINTS)).round().astype(int))
    strips = [trajectory.p_WB_W[samples]]
    return Lines(name, _PAINT, strips, opacity=opacity, width=width)


def _ellipsoids(
    trajectory: Trajectory, carried: CarriedCovariance | None, samples: list[int]
) -> list[Ellipsoids]:
    """Return ellipsoids that are to be relied on, and others."""
    known: list[int] = []
    positions_W = np.zeros((len(trajectory), 3, 3))
    if carried is not None:
        positions_W = carried.covariances[:, :3, :3]
        known = [i for i in samples if np.isfinite(positions_W[i]).all()]
    return [
        Ellipsoids(name, paint, trajectory.p_WB_W[chosen], positions_W[chosen], deviations=DEVIATIONS)
        for name, paint, chosen in (
            (
                "uncertainty/relied_on",
                _PAINT,
                [i for i in known if carried is not None and carried.trusted[i]],
            ),
            ("uncertainty/other", _DOUBTFUL, [i for i in known if carried is None or not carried.trusted[i]]),
        )
    ]


DEEP: Final = 0.1
"""Relative to the body's size: how deep in a surface it is drawn. Measured poses are in it by their noise."""


def outside(
    trajectory: Trajectory, shape: Shape, surfaces: Sequence[Surface | Obstacle]
) -> tuple[Trajectory, str]:
    """Return the part of a trajectory until the body is deep in a flat, and its name, or "" for all of it."""
    corners_B = shape.edges_B.reshape(-1, 3)
    R_WB = matrices_of(trajectory.q_WB)
    count, name = len(trajectory), ""
    for surface in surfaces:
        if not isinstance(surface, Surface) or count == 0:
            continue
        lowest = np.array(-0.5 * shape.size)  # a body without corners is drawn as a ball
        if len(corners_B) > 0:
            lowest = (surface.normal_W @ R_WB @ corners_B.T).min(axis=1)
        gaps = surface.gaps(trajectory.p_WB_W) + lowest
        deep = np.flatnonzero(gaps < min(float(gaps[0]), 0.0) - DEEP * shape.size)
        if len(deep) > 0 and deep[0] < count:
            count, name = int(deep[0]), surface.name
    if not name:
        return trajectory, ""
    first = {each.name: getattr(trajectory, each.name)[:count] for each in fields(trajectory)}
    return replace(trajectory, **first), name
