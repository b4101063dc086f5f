"""The wrenches of the edges of friction cones, for the contacts that stay in a mode.

A few edges are computed in plain floats and many in arrays, whichever is faster.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.planar.cone import MANY, decimal_vector
from contact_dynamics.contact_modes.planar.enumeration import FIXED, RIGHT, Letters
from contact_dynamics.contact_modes.planar.problem import Lift, lifted
from contact_dynamics.numerics.vectors import Vector3, dot, norm
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.planar.problem import ContactRow
    from contact_dynamics.validation import FloatArray


class Edges(NamedTuple):
    """The edges of friction cones. The contact forces of a mode are their positive combinations.

    Attributes:
        positions: The position of each edge's contact in the rows of the case.
        slopes: The ratio f_t / f_n of each edge.
        wrenches: The wrench of a force along each edge whose normal part is 1.
    """

    positions: list[int]
    slopes: list[float]
    wrenches: list[Vector3]


class Reactions(NamedTuple):
    """The negated wrenches of edges, in the coordinates of the cone of applied wrenches.

    If the case has a line of symmetry, only the part of a wrench across that line counts.

    Attributes:
        edges: The indices of the edges whose wrenches have such a part.
        lengths: The size of that part for each of them, for a normal force of 1.
        units: The negated part of each of them, as a unit vector.
    """

    edges: list[int]
    lengths: list[float]
    units: list[Vector3]


def friction_edges(rows: Sequence[ContactRow], letters: Letters) -> Edges:
    """Return the edges of the forces that the letters of a mode allow."""
    positions: list[int] = []
    slopes: list[float] = []
    for position, letter in letters:
        friction = rows[position].friction
        if letter != RIGHT:
            positions.append(position)
            slopes.append(friction)
        if letter == RIGHT or (letter == FIXED and friction > 0.0):
            positions.append(position)
            slopes.append(-friction)
    if len(positions) > MANY:
        both = np.array([rows[position].N + rows[position].T for position in positions])
        return Edges(positions, slopes, _rows(both[:, :3] + np.array(slopes)[:, None] * both[:, 3:]))
    wrenches = []
    for position, slope in zip(positions, slopes, strict=True):
        N, T = rows[position].N, rows[position].T
        wrenches.append((N[0] + slope * T[0], N[1] + slope * T[1], N[2] + slope * T[2]))
    return Edges(positions, slopes, wrenches)


def reactions(lift: Lift | None, wrenches: Sequence[Vector3]) -> Reactions:
    """Return the reactions to some wrenches. Wrenches along the line of symmetry have none."""
    if len(wrenches) > MANY:
        return _many_reactions(lift, wrenches)
    edges, lengths, units = [], [], []
    for edge, wrench in enumerate(wrenches):
        x, y, z = lifted(lift, wrench, 0.0)
        length = math.sqrt(x * x + y * y + z * z)
        if lift is None or length > ROW_TOLERANCE * norm(wrench):
            edges.append(edge)
            lengths.append(length)
            units.append((-x / length, -y / length, -z / length))
    return Reactions(edges, lengths, units)


def sharp_reactions(
    lift: Lift | None, rows: Sequence[ContactRow], edges: Edges, acting: Sequence[int]
) -> list[Vector3]:
    """Return the reactions to the ``edges`` whose indices are ``acting``, as decimals of any length."""
    sharp = []
    for edge in acting:
        row = rows[edges.positions[edge]]
        reaction = sharp_reaction(row.N, row.T, edges.slopes[edge])
        if lift is not None:
            one, two = (decimal_vector(axis) for axis in lift.across)
            reaction = (dot(reaction, one), dot(reaction, two), 0 * reaction[2])
        sharp.append(reaction)
    return sharp


def sharp_reaction(N: Vector3, T: Vector3, slope: float) -> Vector3:
    """Return the reaction to N + slope T in decimals.

    If friction is large, floats would lose N in the sum.
    """
    (n_x, n_y, n_z), (t_x, t_y, t_z) = decimal_vector(N), decimal_vector(T)
    factor, _, _ = decimal_vector((slope, 0.0, 0.0))
    return (-n_x - factor * t_x, -n_y - factor * t_y, -n_z - factor * t_z)


def _many_reactions(lift: Lift | None, wrenches: Sequence[Vector3]) -> Reactions:
    rows = np.array(wrenches)
    across = rows if lift is None else np.column_stack([rows @ np.array(lift.across).T, np.zeros(len(rows))])
    lengths = _lengths(across)
    seen = np.flatnonzero(lengths > ROW_TOLERANCE * _lengths(rows))
    return Reactions(seen.tolist(), lengths[seen].tolist(), _rows(across[seen] / -lengths[seen, None]))


def _lengths(rows: FloatArray) -> FloatArray:
    lengths: FloatArray = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    return lengths


def _rows(array: FloatArray) -> list[Vector3]:
    return [(x, y, z) for x, y, z in array.tolist()]
