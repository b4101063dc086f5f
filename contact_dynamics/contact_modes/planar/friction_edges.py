# SPDX-License-Identifier: Apache-2.0
"""This file gives the wrenches of the edges of friction cones, for the contacts that stay in a mode.

A few edges are computed in plain floats and many in arrays, whichever is faster.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.planar.enumeration import FIXED, RIGHT, Letters
from contact_dynamics.contact_modes.planar.exact_vectors import decimal_vector
from contact_dynamics.contact_modes.planar.extreme_rays import MANY
from contact_dynamics.contact_modes.planar.problem import Lift, lifted
from contact_dynamics.numerics.vectors import Vector3, array_of, dot, norm
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.planar.problem import ContactRow
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.validation import FloatArray

_SMOOTH: Final = ((0.0, 1.0),)
"""The only edge of a contact without friction is its normal."""


class Edges(NamedTuple):
    """The edges of friction cones. The contact forces of a mode are their positive combinations.

    Attributes:
        positions: The position of each edge's contact in the rows of the case.
        forces: One force (f_t, f_n) along each edge. Its normal part is 1, or 0 where friction is infinite.
        wrenches: The wrench of that force.
    """

    positions: list[int]
    forces: list[Vector2]
    wrenches: list[Vector3]


class Reactions(NamedTuple):
    """The negated wrenches of edges, in the coordinates of the cone of applied wrenches.

    If the case has a line of symmetry, only the part of a wrench across that line counts.

    Attributes:
        edges: The indices of the edges whose wrenches have such a part.
        lengths: The size of that part for each of them.
        units: The negated part of each of them, as a unit vector.
    """

    edges: list[int]
    lengths: list[float]
    units: list[Vector3]


def friction_edges(rows: Sequence[ContactRow], letters: Letters) -> Edges:
    """Return the edges of the forces that the letters of a mode allow."""
    positions: list[int] = []
    forces: list[Vector2] = []
    known: dict[tuple[float, int], tuple[Vector2, ...]] = {}  # contacts often have the same friction
    for position, letter in letters:
        kind = (rows[position].friction, letter)
        alike = known.get(kind)
        if alike is None:
            alike = known[kind] = edge_forces(*kind)
        forces += alike
        positions += (position,) * len(alike)
    if len(positions) > MANY:
        normals = array_of([rows[position].N for position in positions])
        tangents = array_of([rows[position].T for position in positions])
        f_t, f_n = np.array([*zip(*forces, strict=True)])[:, :, None]
        return Edges(positions, forces, _rows(f_n * normals + f_t * tangents))
    wrenches = []
    for position, (f_t, f_n) in zip(positions, forces, strict=True):
        N, T = rows[position].N, rows[position].T
        wrenches.append((f_n * N[0] + f_t * T[0], f_n * N[1] + f_t * T[1], f_n * N[2] + f_t * T[2]))
    return Edges(positions, forces, wrenches)


def edge_forces(friction: float, letter: int) -> tuple[Vector2, ...]:
    """Return a force (f_t, f_n) along each edge of the forces that a letter allows.

    If friction is infinite, the tangential force may have any size, also without a normal force.
    """
    if friction == 0.0:
        return _SMOOTH
    left, right = (-friction, 1.0), (friction, 1.0)
    if friction == math.inf:
        left, right = (-1.0, 0.0), (1.0, 0.0)
    if letter == FIXED:
        return (right, left, (0.0, 1.0)) if friction == math.inf else (right, left)
    return (left,) if letter == RIGHT else (right,)


def reactions(lift: Lift | None, wrenches: Sequence[Vector3]) -> Reactions:
    """Return the reactions to some wrenches. Wrenches along the line of symmetry have none."""
    if len(wrenches) > MANY:
        return _many_reactions(lift, wrenches)
    edges, lengths, units = [], [], []
    for edge, wrench in enumerate(wrenches):
        x, y, z = wrench if lift is None else lifted(lift, wrench, 0.0)
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
        reaction = sharp_reaction(row.N, row.T, edges.forces[edge])
        if lift is not None:
            one, two = (decimal_vector(axis) for axis in lift.across)
            reaction = (dot(reaction, one), dot(reaction, two), 0 * reaction[2])
        sharp.append(reaction)
    return sharp


def sharp_reaction(N: Vector3, T: Vector3, force: Vector2) -> Vector3:
    """Return the reaction to a force (f_t, f_n) in decimals.

    If friction is large, floats would lose the normal part in the sum.
    """
    (n_x, n_y, n_z), (t_x, t_y, t_z) = decimal_vector(N), decimal_vector(T)
    f_t, f_n, _ = decimal_vector((*force, 0.0))
    return (-f_n * n_x - f_t * t_x, -f_n * n_y - f_t * t_y, -f_n * n_z - f_t * t_z)


def _many_reactions(lift: Lift | None, wrenches: Sequence[Vector3]) -> Reactions:
    rows = array_of(wrenches)
    across = rows if lift is None else np.column_stack([rows @ np.array(lift.across).T, np.zeros(len(rows))])
    lengths = _lengths(across)
    seen = np.flatnonzero(lengths > ROW_TOLERANCE * _lengths(rows))
    return Reactions(seen.tolist(), lengths[seen].tolist(), _rows(across[seen] / -lengths[seen, None]))


def _lengths(rows: FloatArray) -> FloatArray:
    lengths: FloatArray = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    return lengths


def _rows(array: FloatArray) -> list[Vector3]:
    return [(x, y, z) for x, y, z in array.tolist()]
