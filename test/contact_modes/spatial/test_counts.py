# SPDX-License-Identifier: Apache-2.0
"""Counts of contacting and separating modes: published ones, and those of polytopes that are known.

Huang, Cheng and Mason, Efficient Contact Mode Enumeration in 3D (WAFR 2020), count the modes of a box with
walls (its four corners on each), of a peg in a hole and of a box upon a box. The sets here are theirs, as
their published program draws them, and that program finds the same six counts for the box. Of the counts in
their table 184 is known to us, for the box upon a box at two walls (16 contacts, 9 dimensions); the others
follow from the face counts of polytopes.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet
from contact_dynamics.contact_modes import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.kinematic import cone_faces

X, Y, Z = np.eye(3)
WALLS = [(Z, X, Y), (Y, Z, X), (X, Y, Z), (-X, Z, Y), (-Y, X, Z), (-Z, Y, X)]
AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])


def contact_set(points: list[np.ndarray], normals: list[np.ndarray]) -> ContactSet:
    n = len(points)
    return ContactSet(p_WC_W=np.array(points), normals_W=np.array(normals), frictions=np.ones(n))


def box_at(walls: int) -> ContactSet:
    """Return the corners of a unit cube on its first so many walls: floor, two walls, the opposite three."""
    points, normals = [], []
    for normal, one, two in WALLS[:walls]:
        for i in (1.0, -1.0):
            for j in (1.0, -1.0):
                points.append(-0.5 * (normal + i * one + j * two))
                normals.append(normal)
    return contact_set(points, normals)


@pytest.mark.parametrize(("walls", "count"), [(1, 10), (2, 46), (3, 136), (4, 10), (5, 2), (6, 1)])
def test_a_box_at_walls(walls: int, count: int) -> None:
    # One wall: the cone over a square, 1 + 4 + 4 + 1 faces. Two and three: 46 is a quarter of the published
    # 184 (below), 136 is what a linear program for each of the 2^12 strings finds. Between opposite walls the
    # box keeps three coordinates, and two conditions each from the floor and the third wall: a square again.
    # Four walls around it let it rise, or not; six hold it.
    modes = spatial_kinematic_modes(AT_REST, box_at(walls))
    assert len(modes) == count
    assert "c" * (4 * walls) in modes


def test_a_box_upon_a_box_at_two_walls() -> None:
    # Nine coordinates: the lower box turns about z and moves along x and y, the upper one has all six. The
    # lower box's feet on the floor never leave, and add no row.
    rows = []
    for i in (1.0, -1.0):
        for j in (1.0, -1.0):
            at_wall = -0.5 * (Y + i * Z + j * X)
            lower, upper, between = np.zeros(9), np.zeros(9), np.zeros(9)
            lower[[0, 2]] = at_wall[0], 1.0
            upper[3:] = [*Y, *np.cross(at_wall, Y)]
            foot = -0.4 * (Z + i * X + j * Y)
            between[3:] = [*Z, *np.cross(foot, Z)]
            rows += [lower, upper, between]
    stacked = np.array(rows)
    faces = cone_faces(stacked / np.linalg.norm(stacked, axis=1)[:, None])
    assert len(faces) == 184
    # The boxes' conditions share no coordinate: 4 for a side that turns and leaves, 46 for the upper box.
    assert len(faces) == 4 * len(spatial_kinematic_modes(AT_REST, box_at(2)))


@pytest.mark.parametrize("around", [3, 4, 8])
def test_a_peg_fills_its_hole(around: int) -> None:
    # Two rings of contacts, normals inward: it turns and slides along its axis, and no contact can leave.
    points, normals = [], []
    for height in (6.0, -6.0):
        for k in range(around):
            angle = 2.0 * math.pi * k / around
            outward = np.array([math.cos(angle), math.sin(angle), 0.0])
            points.append(3.0 * outward + height * Z)
            normals.append(-outward)
    assert spatial_kinematic_modes(AT_REST, contact_set(points, normals)) == ("c" * (2 * around),)


@pytest.mark.parametrize("n", [7, 8, 9])
def test_a_cyclic_polytope_has_the_most_modes(n: int) -> None:
    # Rows on the moment curve are the facets of the dual of a cyclic polytope, neighbourly, whose faces are
    # the most that n contacts can have (McMullen, 1970): f_k of the cyclic 5-polytope, dual simplicial.
    angles = np.linspace(0.2, 1.0, n)
    curve = np.column_stack([angles**k for k in range(6)])
    faces = cone_faces(curve / np.linalg.norm(curve, axis=1)[:, None])
    # Cyclic polytope C(n, 5): f_0 = n, f_1 = n (n - 1) / 2; Dehn and Sommerville give f_2, f_3, f_4.
    f_0, f_1 = n, n * (n - 1) // 2
    f_2 = 4 * f_1 - 10 * f_0 + 20
    f_3 = 5 * f_1 - 15 * f_0 + 30
    f_4 = 2 * f_1 - 6 * f_0 + 12
    assert len(faces) == 1 + f_0 + f_1 + f_2 + f_3 + f_4 + 1
