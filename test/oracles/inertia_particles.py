# SPDX-License-Identifier: Apache-2.0
"""Mass properties as lecture 24 defines them: sums over particles, in plain loops.

A shape becomes the nodes of a quadrature that integrates polynomials of degree 2 (times the profile)
exactly, so that the sums are the integrals to rounding. Shares nothing with the package.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

Particle = tuple[float, tuple[float, float, float]]


def sums(particles: list[Particle]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre of mass X = sum m x / M, and I = sum m (|x|^2 1 - x x^T) about X (lecture 24)."""
    total = math.fsum(m for m, _ in particles)
    center = [math.fsum(m * x[i] for m, x in particles) / total for i in range(3)]
    inertia = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            terms = []
            for m, x in particles:
                r = [x[k] - center[k] for k in range(3)]
                terms.append(m * ((i == j) * (r[0] ** 2 + r[1] ** 2 + r[2] ** 2) - r[i] * r[j]))
            inertia[i, j] = math.fsum(terms)
    return total, np.array(center), inertia


def gauss(low: float, high: float, count: int = 8) -> list[tuple[float, float]]:
    """Nodes and weights of Gauss and Legendre on [low, high]."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    half = 0.5 * (high - low)
    return [(low + half * (1.0 + float(x)), half * float(w)) for x, w in zip(nodes, weights, strict=True)]


def turns(count: int = 5) -> list[tuple[float, float]]:
    """Angles all round and their weights: exact for trigonometric polynomials of degree below ``count``."""
    return [(2.0 * math.pi * (i + 0.25) / count, 2.0 * math.pi / count) for i in range(count)]


def cuboid(x: float, y: float, z: float) -> list[Particle]:
    """A box of full sides, density 1."""
    return [
        (u * v * w, (a, b, c))
        for a, u in gauss(-x / 2, x / 2)
        for b, v in gauss(-y / 2, y / 2)
        for c, w in gauss(-z / 2, z / 2)
    ]


def revolved(
    low: float, high: float, outer: Callable[[float], float], inner: Callable[[float], float] = lambda _: 0.0
) -> list[Particle]:
    """The solid between two profiles turned about z, both squared radii polynomial in z; density 1."""
    cloud = []
    for z, w in gauss(low, high):
        for squared, v in gauss(inner(z), outer(z)):  # r dr = d(r^2) / 2
            r = math.sqrt(squared)
            cloud += [(0.5 * u * v * w, (r * math.cos(t), r * math.sin(t), z)) for t, u in turns()]
    return cloud


def torus(ring_radius: float, tube_radius: float) -> list[Particle]:
    """A torus round z, density 1."""
    cloud = []
    for s, w in gauss(0.0, tube_radius):
        for p, v in turns(9):
            r = ring_radius + s * math.cos(p)
            cloud += [
                (s * r * u * v * w, (r * math.cos(t), r * math.sin(t), s * math.sin(p))) for t, u in turns()
            ]
    return cloud


def shell(low: float, high: float, squared_radius: Callable[[float], float], band: float) -> list[Particle]:
    """A surface about z whose area is ``band`` * dz * dt: a cylinder's or a sphere's; 1 kg/m^2."""
    cloud = []
    for z, w in gauss(low, high):
        r = math.sqrt(squared_radius(z))
        cloud += [(band * u * w, (r * math.cos(t), r * math.sin(t), z)) for t, u in turns()]
    return cloud
