# SPDX-License-Identifier: Apache-2.0
"""Mass properties of a closed triangle mesh in rational numbers, by the divergence theorem over its faces.

The integral of a monomial over the inside is that of its antiderivative in x, times n_x, over the surface;
over a triangle, products of barycentric coordinates integrate to 2 A a! b! c! / (a + b + c + 2)!. No
tetrahedra, no rounding; shares nothing with the package.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import factorial

Vector = tuple[int, int, int]


def mesh_moments(
    vertices: list[tuple[int, int, int]], triangles: list[tuple[int, int, int]]
) -> tuple[Fraction, list[Fraction], list[list[Fraction]]]:
    """Volume, centre, and integral of |x|^2 1 - x x^T about the centre (lecture 25, eq. 4 with density 1)."""
    faces = [[vertices[i] for i in triangle] for triangle in triangles]
    volume = integral(faces, (0, 0, 0))
    center = [integral(faces, tuple(int(i == k) for i in range(3))) / volume for k in range(3)]
    second = [
        [
            integral(faces, tuple(int(k == i) + int(k == j) for k in range(3)))
            - volume * center[i] * center[j]
            for j in range(3)
        ]
        for i in range(3)
    ]
    trace = second[0][0] + second[1][1] + second[2][2]
    inertia = [[(i == j) * trace - second[i][j] for j in range(3)] for i in range(3)]
    return volume, center, inertia


def integral(faces: list[list[Vector]], powers: tuple[int, int, int]) -> Fraction:
    """The integral of x^a y^b z^c over the inside."""
    a, b, c = powers
    total = Fraction(0)
    for p, q, r in faces:
        u, v = [q[k] - p[k] for k in range(3)], [r[k] - p[k] for k in range(3)]
        twice_area_x = u[1] * v[2] - u[2] * v[1]  # n_x dA is this much, over the unit triangle
        total += twice_area_x * mean([p, q, r], (a + 1, b, c)) / (a + 1)
    return total


def mean(triangle: list[Vector], powers: tuple[int, int, int]) -> Fraction:
    """The integral of x^a y^b z^c over a triangle, over twice its area: each factor picks a corner."""
    axes = [axis for axis, power in enumerate(powers) for _ in range(power)]
    total = 0
    for choice in product(range(3), repeat=len(axes)):
        term = 1
        for axis, corner in zip(axes, choice, strict=True):
            term *= triangle[corner][axis]
        for corner in range(3):
            term *= factorial(choice.count(corner))
        total += term
    return Fraction(total, factorial(len(axes) + 2))
