# SPDX-License-Identifier: Apache-2.0
"""What the shapes at a contact add to its acceleration: the velocity-product terms of each contact kind.

If a point of the body touches a flat of the world, the same material point stays in contact. The gap's second
derivative is then the acceleration of that point, a_n = n . (a + alpha x r + w x (w x r)). If the body or the
world is curved there, the point of contact moves over both. Let K_B and K_S be the curvatures of body and
surface at the contact (2 x 2, symmetric, in the tangent plane, positive where convex), v the velocity of the
body's material point there (tangent, as the contact persists), w the angular velocity and m = n x w. A
material point at xi from the contact has, after a short time t, this height over the surface:

    gap(xi) = xi' K_B xi / 2 + t m . xi + t^2 a_n / 2 + (xi + t v)' K_S (xi + t v) / 2.

The gap of the bodies is the least of these. With xi = t eta,

    gap'' = a_n + min over eta of  eta' K_B eta + 2 m . eta + (eta + v)' K_S (eta + v),
    (K_B + K_S) eta = -(m + K_S v),

where eta is the velocity of the point of contact over the body, and eta + v that over the surface. These are
Montana's equations of contact (The kinematics of contact and grasp, Int. J. of Robotics Research 7(3), 1988).
An infinite curvature is a corner or an edge. On the body it keeps eta at zero in its direction, on the
surface eta + v. The known kinds follow:

    point on flat      K_B infinite, K_S = 0      eta = 0       nothing
    flat on point      K_B = 0, K_S infinite      eta = -v      -2 n . (w x v), Coriolis
    curved on flat     K_S = 0                    K_B eta = -m  -m' K_B^-1 m, a rolling disc's -w^2 R
    edge on edge       each 0 along itself        along both    2 m . eta

The sliding velocity of a contact at rest (v = 0) changes by the acceleration of the material point plus
w x eta, because another point becomes the point of contact. The tangential part of this term is w_n n x eta.

Where a surface moves, v, w and the acceleration are those relative to it, in its own frame (`velocities`).
Not covered: pairs that touch along a line or a face (give its extreme points), and a corner on a corner,
which has no normal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.vectors import tangent_rows
from contact_dynamics.records import Record
from contact_dynamics.tolerances import ROW_TOLERANCE, UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import FloatArray, check_array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


Pair: TypeAlias = "tuple[float, float]"


def _with_infinity(field: str, value: ArrayLike, n: int) -> FloatArray:
    """Return ``value`` as read-only curvatures, (n,), each of which is a number or infinity."""
    try:
        values = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        values = np.full(n, math.nan)
    wrong = values.shape != (n,) or np.isnan(values).any() or np.isneginf(values).any()
    if wrong or np.iscomplexobj(value):
        raise InvalidFieldError(field, value, f"{n} numbers, or infinity")
    values.flags.writeable = False
    return values


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Curvatures(Record):
    """Principal curvatures of the body or of the surface at n contacts, positive where convex.

    Attributes:
        along: (n,), 1/m, curvature along the direction. It is infinite at a corner or across the edge of a
            blade.
        across: (n,), 1/m, curvature along the tangent orthogonal to the direction.
        directions_W: (n, 3), unit tangents, world axes, or zero if both curvatures are equal.

    Raises:
        InvalidFieldError: arrays have different lengths, or a number is NaN or minus infinity.
    """

    along: FloatArray
    across: FloatArray
    directions_W: FloatArray

    if TYPE_CHECKING:

        def __init__(self, *, along: ArrayLike, across: ArrayLike, directions_W: ArrayLike) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check all arrays."""
        rows = check_array("directions_W", self.directions_W, (None, 3))
        for name in ("along", "across"):
            values = _with_infinity(name, getattr(self, name), len(rows))
            object.__setattr__(self, name, values)
        object.__setattr__(self, "directions_W", rows)

    def __len__(self) -> int:
        """Return the number of contacts."""
        return len(self.along)

    def subset(self, indices: Sequence[int]) -> Curvatures:
        """Return the curvatures of the given contacts, in their order."""
        chosen = list(indices)
        return Curvatures(
            along=self.along[chosen], across=self.across[chosen], directions_W=self.directions_W[chosen]
        )

    def in_direction(self, i: int, t_W: FloatArray) -> float | None:
        """Return the curvature of contact ``i`` along a unit tangent, 1/m, or None if it is not principal.

        A direction within `UNIT_LENGTH_TOLERANCE` rad of a principal one counts as principal.
        """
        along, across = float(self.along[i]), float(self.across[i])
        if along == across:
            return along
        cosine = abs(float(self.directions_W[i] @ t_W))
        if 1.0 - cosine <= 0.5 * UNIT_LENGTH_TOLERANCE**2:
            return along
        return across if cosine <= UNIT_LENGTH_TOLERANCE else None


def alike(n: int, curvature: float) -> Curvatures:
    """Return one curvature, 1/m, in all directions at n contacts: infinity for points, 0 for flats."""
    same = np.full(n, curvature)
    return Curvatures(along=same, across=same, directions_W=np.zeros((n, 3)))


def checked_curvatures(field: str, curvatures: Curvatures | None, normals_W: FloatArray) -> Curvatures | None:
    """Return curvatures with directions made unit and tangent to rounding, or raise `InvalidFieldError`."""
    if curvatures is None:
        return None
    if len(curvatures) != len(normals_W):
        raise InvalidFieldError(field, f"{len(curvatures)} contacts", f"{len(normals_W)}, or none")
    directions = curvatures.directions_W
    out = np.einsum("ij,ij->i", directions, normals_W)
    lengths = np.linalg.norm(directions, axis=1)
    needed = curvatures.along != curvatures.across
    wrong = (np.abs(lengths - 1.0) > UNIT_LENGTH_TOLERANCE) | (np.abs(out) > UNIT_LENGTH_TOLERANCE)
    for i in np.flatnonzero(needed & wrong)[:1]:
        raise InvalidFieldError(
            f"{field}.directions_W[{i}]",
            directions[i].tolist(),
            "a unit vector at right angles to the normal",
        )
    tangents = directions - out[:, None] * normals_W
    sizes = np.linalg.norm(tangents, axis=1, keepdims=True)
    tangents = np.divide(tangents, sizes, out=np.zeros_like(tangents), where=needed[:, None])
    return Curvatures(along=curvatures.along, across=curvatures.across, directions_W=tangents)


def check_pairs(
    normals_W: FloatArray, body_curvatures: Curvatures | None, surface_curvatures: Curvatures | None
) -> None:
    """Raise `InvalidFieldError` for the first contact that is not one at a point with a normal of its own."""
    n = len(normals_W)
    mine, theirs = least_and_most(body_curvatures, n, math.inf), least_and_most(surface_curvatures, n, 0.0)
    # One side is convex in all directions and the other is flat, which is a quick test.
    clear = ((mine[0] > 0.0) & (theirs == 0.0).all(axis=0)) | ((theirs[0] > 0.0) & (mine == 0.0).all(axis=0))
    for i in np.flatnonzero(~clear).tolist():
        frame = tangent_rows(normals_W[i])
        body, surface = (
            side_of(body_curvatures, i, frame, math.inf),
            side_of(surface_curvatures, i, frame, 0.0),
        )
        if rolling(body, surface, (0.0, 0.0), (0.0, 0.0)) is None:
            raise InvalidFieldError(
                f"body_curvatures, surface_curvatures: contact {i}",
                f"{[k for k, _ in body]} of the body, {[k for k, _ in surface]} of the surface, 1/m",
                "a sum > 0 in all directions, and no corner on a corner",
            )


def least_and_most(curvatures: Curvatures | None, n: int, default: float) -> FloatArray:
    """Return the smaller and the larger curvature of each contact, (2, n), 1/m."""
    if curvatures is None:
        return np.full((2, n), default)
    return np.sort([curvatures.along, curvatures.across], axis=0)


def planar_gap_acceleration(
    body_curvature: float, surface_curvature: float, *, v_t: float, w: float
) -> float:
    """Return what velocities add to a planar contact's a_n, m/s^2: k_S v^2 - (w + k_S v)^2 / (k_B + k_S)."""
    if math.isinf(surface_curvature):
        return v_t * (body_curvature * v_t - 2.0 * w)
    slip = surface_curvature * v_t
    return slip * v_t - (w + slip) ** 2 / (body_curvature + surface_curvature)


class Rolling(NamedTuple):
    """How the point of contact moves over the body, and what its motion adds to the gap."""

    eta: Pair  # Velocity of the point of contact over the body, m/s
    gap: float  # the gap's second derivative less a_n, m/s^2


Side: TypeAlias = "list[tuple[float, Pair]]"
"""Two curvatures, 1/m, with their directions in the tangent plane."""


def side_of(curvatures: Curvatures | None, i: int, frame: FloatArray, default: float) -> Side:
    """Return the curvatures of one side of contact ``i``, in the tangents of ``frame``, (2, 3)."""
    along, across, x, y = default, default, 1.0, 0.0
    if curvatures is not None:
        along, across = float(curvatures.along[i]), float(curvatures.across[i])
        if along != across:
            x, y = (frame @ curvatures.directions_W[i]).tolist()
    return [(along, (x, y)), (across, (-y, x))]


def rolling(body: Side, surface: Side, m: Pair, v: Pair) -> Rolling | None:
    """Return how the contact moves, by the minimum over eta above, or None where it is not one point."""
    held = [(u, 0.0) for k, u in body if math.isinf(k)]
    held += [(u, -_dot(u, v)) for k, u in surface if math.isinf(k)]
    if len(held) > 2:
        return None
    if len(held) == 2:
        (one, c_1), (two, c_2) = held
        apart = one[0] * two[1] - one[1] * two[0]
        if abs(apart) <= ROW_TOLERANCE:
            return None
        eta = ((c_1 * two[1] - c_2 * one[1]) / apart, (one[0] * c_2 - two[0] * c_1) / apart)
    else:
        ways: list[Pair] = [(1.0, 0.0), (0.0, 1.0)]
        eta = (0.0, 0.0)
        if held:
            ((x, y), c) = held[0]
            eta, ways = (c * x, c * y), [(-y, x)]
        over = (eta[0] + v[0], eta[1] + v[1])
        slope = [_dot(m, u) + _form(body, eta, u) + _form(surface, over, u) for u in ways]
        bend = [[_form(body, u, w) + _form(surface, u, w) for w in ways] for u in ways]
        size = sum(abs(k) for k, _ in [*body, *surface] if not math.isinf(k))
        steps = _least(bend, slope, ROW_TOLERANCE * size)
        if steps is None:
            return None
        for step, u in zip(steps, ways, strict=True):
            eta = (eta[0] + step * u[0], eta[1] + step * u[1])
    over = (eta[0] + v[0], eta[1] + v[1])
    return Rolling(eta, _form(body, eta, eta) + 2.0 * _dot(m, eta) + _form(surface, over, over))


def _least(bend: list[list[float]], slope: list[float], smallest: float) -> list[float] | None:
    """Return where a quadratic form of one or two variables is least, or None if it is nearly flat."""
    if len(slope) == 1:
        return [-slope[0] / bend[0][0]] if bend[0][0] > smallest else None
    (a, b), (_, c) = bend
    determinant = a * c - b * b
    if a + c <= 0.0 or determinant <= smallest * (a + c):
        return None
    return [(b * slope[1] - c * slope[0]) / determinant, (b * slope[0] - a * slope[1]) / determinant]


def _form(side: Side, a: Pair, b: Pair) -> float:
    """Return a' K b of the finite curvatures."""
    return sum(k * _dot(u, a) * _dot(u, b) for k, u in side if not math.isinf(k))


def _dot(a: Pair, b: Pair) -> float:
    return a[0] * b[0] + a[1] * b[1]
