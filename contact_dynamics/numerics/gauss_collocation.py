# SPDX-License-Identifier: Apache-2.0
"""Gauss collocation solves linear differential equations y' = K(t) y to rounding, over short pieces.

In each piece y' is a polynomial that obeys the equation at Gauss's points (Hairer, Norsett and Wanner,
Solving Ordinary Differential Equations I, II.7). The caller chooses the pieces, so short that K changes and
turns y little in each. The method is stable for solutions that decay at any rate.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

CHUNK: Final = 64
"""Number of pieces that are solved at a time. Their matrices take a few MB."""


class Collocation:
    """Gauss's method with a number of points in each piece.

    More points allow longer pieces. With m unknowns and p points each piece is a system of m p equations.
    From 100 equations on LAPACK starts threads, which on a busy machine wait for each other longer than they
    work.
    """

    def __init__(self, count: int) -> None:
        """Find the points and weights."""
        self.count = count
        on_both_sides, double_weights = np.polynomial.legendre.leggauss(count)
        self.points: FloatArray = 0.5 * (1.0 + on_both_sides)  # (count,), on [0, 1]
        self.weights: FloatArray = 0.5 * double_weights
        legendre = np.polynomial.legendre.legvander(on_both_sides, count - 1)
        # (count, count): from values at the points to coefficients of Legendre's polynomials
        self._to_legendre = (legendre * self.weights[:, None] * (2 * np.arange(count) + 1)).T

    def nodes_of(self, edges: FloatArray) -> FloatArray:
        """Return Gauss's points of the pieces between edges (n + 1,): times (n, count)."""
        nodes: FloatArray = edges[:-1, None] + np.diff(edges)[:, None] * self.points
        return nodes

    def solutions(self, K: FloatArray, edges: FloatArray, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return Y of Y' = K Y, Y = 1 at the first edge: at edges (n + 1, m, m), and at times (k, m, m).

        ``K`` are the coefficients at `nodes_of` the edges, (n, count, m, m). The edges ascend or descend, and
        the times lie between them.
        """
        lengths = np.diff(edges)
        scaled = lengths[:, None, None, None] * K
        rates = self.slopes(scaled, scaled)
        steps = np.einsum("k,nkij->nij", self.weights, rates)
        at_edges = np.empty((len(edges), *K.shape[2:]))
        at_edges[0] = np.eye(K.shape[-1])
        for i, step in enumerate(steps):
            at_edges[i + 1] = at_edges[i] + step @ at_edges[i]
        which = np.searchsorted(np.abs(edges - edges[0]), np.abs(times - edges[0]), side="right") - 1
        which = np.minimum(which, len(lengths) - 1)
        shares = self.integrals((times - edges[which]) / lengths[which])
        first = at_edges[which]
        return at_edges, first + np.einsum("nk,nkij->nij", shares, rates[which]) @ first

    def slopes(self, K: FloatArray, forcing: FloatArray) -> FloatArray:
        """Return D' at the points, (n, count, m, k), of D' = K D + forcing on [0, 1], with D = 0 at 0."""
        n, size, k = len(K), self.count * K.shape[-1], forcing.shape[-1]
        found = np.empty((n, self.count, K.shape[-1], k))
        for start in range(0, n, CHUNK):
            part = slice(start, start + CHUNK)
            # (1 - a_kj K_k) acting on the D'_j of all points
            matrix = -np.einsum("kj,nkab->nkajb", self._up_to_points, K[part]).reshape(-1, size, size)
            matrix += np.eye(size)
            right = forcing[part].reshape(-1, size, k)
            found[part] = np.linalg.solve(matrix, right).reshape(-1, *found.shape[1:])
        return found

    def integrals(self, s: FloatArray) -> FloatArray:
        """Return the integrals from 0 to s, (n,), of the points' Lagrange polynomials, (n, count)."""
        # the integral of Legendre's P_k is (P_k+1 - P_k-1) / (2 k + 1), zero at -1
        P = np.polynomial.legendre.legvander(2.0 * s - 1.0, self.count)
        k = np.arange(1, self.count)
        of_P = np.column_stack([2.0 * s, (P[:, 2:] - P[:, :-2]) / (2 * k + 1)])
        found: FloatArray = 0.5 * of_P @ self._to_legendre
        return found

    @cached_property
    def _up_to_points(self) -> FloatArray:
        return self.integrals(self.points)
