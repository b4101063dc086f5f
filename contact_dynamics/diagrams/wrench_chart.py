# SPDX-License-Identifier: Apache-2.0
"""Charts of applied planar wrenches give each wrench a place in a flat picture.

If modes depend on a wrench's direction alone (a body at rest), every wrench is a point of a sphere, once its
torque is divided by the radius of gyration. `DirectionChart` shows the whole sphere as two discs, with
anticlockwise torque on the left and clockwise torque on the right. The angle in a disc is the force's
direction, the centre is a pure torque, and the rim is a pure force. Equal areas are equal solid angles.

`ForceDualChart` is lecture 26's picture. It shows the same two halves in the plane of the body. A wrench is
at its force dual, which is the centre about which it would turn the free body. Pure forces are at infinity.

`ForceChart` shows the forces at one torque. It is for moving bodies, whose modes depend on the size of the
wrench too.

Places are in points of the picture, from its upper left corner: to the right, and up, which is negative.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.contact_modes import WrenchHalfSpace
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.validation import FloatArray

ANTICLOCKWISE: Final = 0
CLOCKWISE: Final = 1
HIDDEN: Final = -1  # parts of a chart. What is on none of them is hidden.

_ON_RIM: Final = 1e-9
"""Sine of the angle to the pure forces. A wrench below it is on the rim, which both discs show."""

_CURVE_POINTS: Final = 3000
"""Number of points of a boundary. They are closer together than the points of the screen."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WrenchChart(ABC):
    """A flat picture of wrenches (f_x, f_y, moment), N and N m."""

    parts: ClassVar[int] = 2  # number of parts side by side
    resolution: int = 400  # points on a side of each part

    @abstractmethod
    def wrenches(self) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Return the wrench at each point, (h, w, 3), and which points belong to the chart, (h, w)."""

    @abstractmethod
    def boundary(self, side: WrenchHalfSpace) -> FloatArray:
        """Return wrenches along the boundary of a half-space, (k, 3), in their order."""

    @abstractmethod
    def place(self, wrenches: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
        """Return the places of wrenches, (k, 3), as (k, 2), and the parts that they are on, (k,)."""


def gap(resolution: int) -> int:
    """Return the points between two parts, and around them."""
    return resolution // 8


def picture_size(chart: WrenchChart) -> tuple[int, int]:
    """Return width and height of a chart, in points."""
    between = gap(chart.resolution)
    return chart.parts * (chart.resolution + between) + between, chart.resolution + 2 * between


def part_centre(chart: WrenchChart, part: int) -> Vector2:
    """Return the centre of a part, in points."""
    between = gap(chart.resolution)
    half = 0.5 * chart.resolution
    return (between + half + part * (chart.resolution + between), -between - half)


@dataclass(frozen=True, slots=True, kw_only=True)
class DirectionChart(WrenchChart):
    """Two discs that show all directions of wrenches."""

    length: float  # m, > 0, the radius of gyration, by which torques are divided to compare with forces

    def wrenches(self) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Return the wrench of unit size at each point. Each disc keeps areas (Lambert's projection)."""
        u, v, part = _plane_grid(self)
        square = u * u + v * v
        stretched = np.sqrt(np.maximum(2.0 - square, 0.0))
        turn = np.where(part == ANTICLOCKWISE, 1.0, -1.0) * self.length
        found = np.stack([u * stretched, v * stretched, (1.0 - square) * turn], axis=-1)
        return found, (part != HIDDEN) & (square <= 1.0)

    def boundary(self, side: WrenchHalfSpace) -> FloatArray:
        """Return the great circle of a half-space's boundary."""
        return _great_circle(side, self.length)

    def place(self, wrenches: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
        """Return the places of the directions of wrenches."""
        scaled = wrenches / (1.0, 1.0, self.length)
        x, y, z = (scaled / np.linalg.norm(scaled, axis=1, keepdims=True)).T
        shrunk = np.sqrt(1.0 + np.abs(z))
        part = np.where(z >= -_ON_RIM, ANTICLOCKWISE, CLOCKWISE)
        return _on_parts(self, x / shrunk, y / shrunk, part), part


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceDualChart(WrenchChart):
    """Two squares that show force duals in the plane of the body."""

    length: float  # m, > 0, the radius of gyration
    half_side: float  # m, > 0, of each square
    centre: Vector2 = (0.0, 0.0)  # m, the middle of each square, from the centre of mass

    def wrenches(self) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Return the wrench that would turn the free body about each point with unit angular acceleration."""
        u, v, part = _plane_grid(self)
        x, y = self.centre[0] + self.half_side * u, self.centre[1] + self.half_side * v
        turn = np.where(part == ANTICLOCKWISE, 1.0, -1.0)
        found = np.stack([turn * y, -turn * x, turn * self.length**2], axis=-1)
        return found, part != HIDDEN

    def boundary(self, side: WrenchHalfSpace) -> FloatArray:
        """Return the great circle of a half-space's boundary: a straight line here."""
        return _great_circle(side, self.length)

    def place(self, wrenches: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
        """Return the places of the force duals of wrenches."""
        f_x, f_y, moment = wrenches.T
        safe = np.where(moment == 0.0, 1.0, moment) / self.length**2
        points = np.column_stack([-f_y / safe, f_x / safe])
        shown = (moment != 0.0) & np.all(np.abs(points - self.centre) <= self.half_side, axis=1)
        part = np.where(shown, np.where(moment > 0.0, ANTICLOCKWISE, CLOCKWISE), HIDDEN)
        return self.place_points(points, part), part

    def place_points(self, points: FloatArray, part: NDArray[np.int64] | int) -> FloatArray:
        """Return the places of points of the plane, (k, 2), m from the centre of mass, on a part."""
        u, v = ((points - self.centre) / self.half_side).T
        return _on_parts(self, u, v, part)


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceChart(WrenchChart):
    """A square that shows forces at one torque."""

    parts: ClassVar[int] = 1
    moment: float  # N m
    half_side: float  # N, > 0

    def wrenches(self) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Return the wrench at each point."""
        u, v, part = _plane_grid(self)
        moments = np.full(u.shape, self.moment)
        return np.stack([self.half_side * u, self.half_side * v, moments], axis=-1), part != HIDDEN

    def boundary(self, side: WrenchHalfSpace) -> FloatArray:
        """Return the line of a half-space's boundary."""
        a_x, a_y, a_moment = side.a
        square = a_x * a_x + a_y * a_y
        if square == 0.0:
            return np.zeros((0, 3))
        offset = (side.b - a_moment * self.moment) / square
        reach = 2.0 * math.sqrt(2.0) * self.half_side / math.sqrt(square)
        along = np.linspace(-reach, reach, _CURVE_POINTS)
        moments = np.full(_CURVE_POINTS, self.moment)
        return np.column_stack([offset * a_x - along * a_y, offset * a_y + along * a_x, moments])

    def place(self, wrenches: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
        """Return the places of the forces of wrenches. Their torques do not matter."""
        u, v = wrenches[:, :2].T / self.half_side
        part = np.where((np.abs(u) <= 1.0) & (np.abs(v) <= 1.0), ANTICLOCKWISE, HIDDEN)
        return _on_parts(self, u, v, part), part


def _plane_grid(chart: WrenchChart) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Return coordinates of each point, -1 to 1 on its part, right and up, and the part, all (h, w)."""
    width, height = picture_size(chart)
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    part = np.full(x.shape, HIDDEN)
    u, v = np.zeros(x.shape), np.zeros(x.shape)
    for i in range(chart.parts):
        centre_x, centre_y = part_centre(chart, i)
        there_u = (x - centre_x) / (0.5 * chart.resolution)
        there_v = (-y - centre_y) / (0.5 * chart.resolution)
        inside = (np.abs(there_u) <= 1.0) & (np.abs(there_v) <= 1.0)
        part[inside] = i
        u[inside], v[inside] = there_u[inside], there_v[inside]
    return u, v, part


def _on_parts(chart: WrenchChart, u: FloatArray, v: FloatArray, part: NDArray[np.int64] | int) -> FloatArray:
    centres = np.array([part_centre(chart, i) for i in range(chart.parts)])[np.maximum(part, 0)]
    offset = 0.5 * chart.resolution * np.column_stack([u, v])
    placed: FloatArray = centres + offset
    return placed


def _great_circle(side: WrenchHalfSpace, length: float) -> FloatArray:
    normal = np.array(side.a) * (1.0, 1.0, length)
    _, _, axes = np.linalg.svd(normal.reshape(1, 3))
    angles = np.linspace(0.0, 2.0 * math.pi, _CURVE_POINTS)
    circle: FloatArray = np.outer(np.cos(angles), axes[1]) + np.outer(np.sin(angles), axes[2])
    return circle * (1.0, 1.0, length)
