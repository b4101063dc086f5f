# SPDX-License-Identifier: Apache-2.0
"""Maps a vector of parameters to a body and surfaces.

All lengths are in body axes B at the *configured* centre of mass, so that poses need no conversion while the
centre moves. Moments of inertia are about the true centre of mass. They change as E I E, with E diagonal, so
that every vector describes an inertia that is positive.

A rounded corner keeps its outer faces: the corner of the inner polyhedron, over which the ball rolls, is
where the planes of its faces meet when each is moved inwards by the radius.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.calibration.free import STANDARD, Free
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import matrices_of, quaternions_of
from contact_dynamics.tolerances import SAME_FACE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, Surface

PLAUSIBLE_SHARE: Final = 0.2
"""Share of the shape's half size that an offset may plausibly have: the standard unit of lengths."""

PLAUSIBLE_COEFFICIENT: Final = 0.5  # the standard unit of friction and restitution
PLAUSIBLE_LOGARITHM: Final = 0.3  # the standard unit of factors: a third more or less
PLAUSIBLE_ANGLE: Final = 0.2  # rad. The standard unit of turns and tilts.
LARGEST_RATIO: Final = 1.0  # logarithm, largest change of a ratio of moments

RATIO_STEP: Final = 0.05
"""Logarithm. Step of the numerical derivative by a ratio of moments, over which residuals are nearly
straight. An estimate that is farther away is repeated there."""

RATIO_GROWTH: Final = 0.02  # logarithm, step by which the range of the ratios grows

ROUND: Final = 0.5
"""Share of the ball that fits into the shape. Corners that are rounder belong to a body that is described as
round: an estimate beyond it is a sign of poor data, such as too few frames a second."""

AXES: Final = ("x", "y", "z")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Parameter(Record):
    """One number that may be free."""

    name: str  # as reports have it, such as ``friction.floor``
    group: Free  # its group in `Free`
    configured: float  # its configured value, in ``unit``; factors are logarithms
    step: float  # the standard unit: the size of what is plausible
    lower: float = -math.inf  # least value
    upper: float = math.inf  # largest value
    unit: str = ""  # m, rad, or empty
    is_factor: bool = False  # whether the number is the logarithm of a factor


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Described(Record):
    """Body and surfaces described by a vector of parameters. Row s belongs to surface s."""

    center: FloatArray  # (3,), m, the true centre of mass, in B
    I_B: FloatArray  # (3, 3), kg m^2, about it
    corners: FloatArray  # (k, 3), m, of the inner polyhedron, in B
    rounding: float  # m, radius of the ball that rolls over it
    frictions: FloatArray  # (s,)
    restitutions: FloatArray  # (s,)
    points: FloatArray  # (s, 3), m, of the surfaces, world
    normals: FloatArray  # (s, 3), unit


class Model:
    """The parameters of one body on some surfaces."""

    def __init__(self, body: Body, surfaces: Sequence[Surface]) -> None:
        """Name the parameters, or raise `NotSupportedError` if the shape is empty or has rims or parts."""
        shape = body.shape
        if shape.is_empty or shape.rims or shape.parts:
            found = "rims of a round shape" if shape.rims else "several parts" if shape.parts else "no shape"
            raise NotSupportedError(
                f"body {body.name!r} must have corners (a box or vertices, rounded or not, or a sphere) "
                f"for a calibration, got {found}"
            )
        self.body = body
        self.surfaces = tuple(surfaces)
        self.vertices = body.shape.vertices
        self.middle = self.vertices.mean(axis=0)
        self.half_size = (
            float(np.linalg.norm(self.vertices - self.middle, axis=1).max()) + body.shape.rounding
        )
        self.parameters = tuple(self._named())
        self.configured = np.array([parameter.configured for parameter in self.parameters])
        self.steps = np.array([parameter.step for parameter in self.parameters])
        self._at = {parameter.name: i for i, parameter in enumerate(self.parameters)}

    def _named(self) -> list[Parameter]:
        length = PLAUSIBLE_SHARE * self.half_size
        found = _along_axes("center_of_mass", Free.CENTER_OF_MASS, step=length, unit="m")
        found.append(_factor("inertia", Free.INERTIA))
        bounds = _bounds_of_ratios(self.body.mass_properties.I_B)
        found += [
            _factor(f"inertia_ratio.{axis}", Free.INERTIA_RATIOS, lower=lower, upper=upper)
            for axis, (lower, upper) in zip(AXES[1:], bounds.tolist(), strict=True)
        ]
        found.append(
            Parameter(
                name="rounding",
                group=Free.ROUNDING,
                configured=self.body.shape.rounding,
                step=length,
                lower=0.0,
                upper=self._largest_rounding(),
                unit="m",
            )
        )
        found.append(_factor("size", Free.SIZE))
        found += _along_axes("shape_position", Free.SHAPE_POSITION, step=length, unit="m")
        found += _along_axes("shape_orientation", Free.SHAPE_ORIENTATION, step=PLAUSIBLE_ANGLE, unit="rad")
        for surface in self.surfaces:
            found += _of_surface(surface, length)
        return found

    @property
    def standard(self) -> tuple[Free, ...]:
        """The groups of `STANDARD`, without the rounding of a shape that has no faces."""
        return tuple(each for each in STANDARD if each is not Free.ROUNDING or self._planes.size)

    def chosen(self, free: Sequence[Free]) -> FloatArray:
        """Return the numbers, (f,), of the parameters of some groups."""
        return np.array([i for i, p in enumerate(self.parameters) if p.group in free], dtype=int)

    @cached_property
    def _planes(self) -> FloatArray:
        """The planes of the faces, (f, 4), normals outwards and offsets; none for a flat shape or a ball."""
        if len(self.vertices) < 4 or np.linalg.matrix_rank(self.vertices - self.middle) < 3:
            return np.zeros((0, 4))
        return np.unique(np.round(hull_of("vertices", self.vertices).equations, 9), axis=0)

    @cached_property
    def _inwards(self) -> FloatArray:
        """For each corner, (k, 3), where it goes for each metre of rounding."""
        moves = np.zeros_like(self.vertices)
        for corner, move in zip(self.vertices, moves, strict=True):
            at = np.abs(self._planes[:, :3] @ corner + self._planes[:, 3]) < SAME_FACE * self.half_size
            if at.any():
                move[:] = np.linalg.lstsq(self._planes[at, :3], -np.ones(int(at.sum())), rcond=None)[0]
        return moves

    def _largest_rounding(self) -> float:
        """Return the upper limit of the radius, m: `ROUND` times that of the inscribed ball."""
        if not self._planes.size:
            return 0.9 * self.half_size
        inside = self.body.shape.rounding - float(
            (self._planes[:, :3] @ self.middle + self._planes[:, 3]).max()
        )
        return max(ROUND * inside, min(inside, 2.0 * self.body.shape.rounding))

    def near_ratios(self, values: FloatArray) -> FloatArray:
        """Return logarithms of both ratios of moments below and above those of ``values``, (2, 2)."""
        both = self.parameters[4:6]
        near = values[4:6, None] + [-RATIO_STEP, RATIO_STEP]
        return np.clip(near, [[each.lower] for each in both], [[each.upper] for each in both])

    def describe(self, values: FloatArray) -> Described:
        """Return body and surfaces for a vector of all parameters, (p,)."""
        ratios = np.array([0.0, *values[4:6]])
        E = np.diag(np.exp(0.5 * (values[3] + ratios)))
        rounding = float(values[6])
        grown = rounding - self.body.shape.rounding
        corners = self.middle + math.exp(values[7]) * (self.vertices - self.middle) + grown * self._inwards
        turn = matrices_of(quaternions_of(values[None, 11:14]))[0]
        corners = self.middle + (corners - self.middle) @ turn.T + values[8:11]
        per_surface = values[14:].reshape(-1, 5)
        normals, points = [], []
        for surface, (_, _, height, tilt_u, tilt_v) in zip(self.surfaces, per_surface, strict=True):
            u, v = tangents_near_x(surface.normal_W)
            normal = surface.normal_W + tilt_u * u + tilt_v * v
            normals.append(normal / np.linalg.norm(normal))
            points.append(surface.p_WS_W + height * surface.normal_W)
        return Described(
            center=values[:3],
            I_B=E @ self.body.mass_properties.I_B @ E,
            corners=corners,
            rounding=rounding,
            frictions=per_surface[:, 0],
            restitutions=per_surface[:, 1],
            points=np.array(points).reshape(-1, 3),
            normals=np.array(normals).reshape(-1, 3),
        )


def _along_axes(name: str, group: Free, *, step: float, unit: str) -> list[Parameter]:
    return [
        Parameter(name=f"{name}.{axis}", group=group, configured=0.0, step=step, unit=unit) for axis in AXES
    ]


def _factor(name: str, group: Free, *, lower: float = -math.inf, upper: float = math.inf) -> Parameter:
    return Parameter(
        name=name,
        group=group,
        configured=0.0,
        step=PLAUSIBLE_LOGARITHM,
        lower=lower,
        upper=upper,
        is_factor=True,
    )


def _bounds_of_ratios(I_B: FloatArray) -> FloatArray:
    """Return the smallest and largest physical logarithms of both ratios of moments, (2, 2).

    No moment may exceed the sum of the other two. Each side of the range grows as far as all its corners are
    moments of a body, so that a body that is nearly flat can become thicker, but not flatter.
    """
    bounds, grows = np.zeros((2, 2)), np.array([[-1.0, 1.0], [-1.0, 1.0]])
    while grows.any():
        for side in np.argwhere(grows):
            wider = bounds.copy()
            wider[tuple(side)] += RATIO_GROWTH * grows[tuple(side)]
            changes = [np.diag(np.exp(0.5 * np.array([0.0, *pair]))) for pair in product(*wider)]
            moments = np.linalg.eigvalsh([E @ I_B @ E for E in changes])
            if (moments[:, 0] + moments[:, 1] > moments[:, 2]).all() and np.abs(wider).max() < LARGEST_RATIO:
                bounds = wider
            else:
                grows[tuple(side)] = 0.0
    return bounds


def _of_surface(surface: Surface, length: float) -> list[Parameter]:
    """Return the five parameters of a surface in the order in which `Model.describe` reads them."""
    return [
        Parameter(
            name=f"friction.{surface.name}",
            group=Free.FRICTION,
            configured=surface.friction,
            step=PLAUSIBLE_COEFFICIENT,
            lower=0.0,
        ),
        Parameter(
            name=f"restitution.{surface.name}",
            group=Free.RESTITUTION,
            configured=surface.restitution,
            step=PLAUSIBLE_COEFFICIENT,
            lower=0.0,
            upper=1.0,
        ),
        Parameter(
            name=f"surface_height.{surface.name}",
            group=Free.SURFACE_HEIGHT,
            configured=0.0,
            step=length,
            unit="m",
        ),
        *(
            Parameter(
                name=f"surface_tilt.{surface.name}.{axis}",
                group=Free.SURFACE_TILT,
                configured=0.0,
                step=PLAUSIBLE_ANGLE,
                unit="rad",
            )
            for axis in ("u", "v")
        ),
    ]
