"""Linear differential equations y' = K(t) y to rounding, by Gauss collocation over short pieces.

A polynomial of degree `NODES` - 1 stands for y' in each piece and obeys the equation at Gauss's points
(Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.7). Pieces are the caller's: short
beside what K does. The method is stable where solutions decay however fast.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

NODES: Final = 12
"""Gauss's points in a piece."""

_ON_BOTH_SIDES, _DOUBLE_WEIGHTS = np.polynomial.legendre.leggauss(NODES)
POINTS: Final = 0.5 * (1.0 + _ON_BOTH_SIDES)
WEIGHTS: Final = 0.5 * _DOUBLE_WEIGHTS

_TO_LEGENDRE: Final = (
    np.polynomial.legendre.legvander(_ON_BOTH_SIDES, NODES - 1)
    * WEIGHTS[:, None]
    * (2 * np.arange(NODES) + 1)
).T
"""(NODES, NODES): from values at the points to coefficients of Legendre's polynomials."""

CHUNK: Final = 64
"""Pieces solved for at a time: their matrices, (12 m, 12 m), are 10 MB for m = 12."""


def nodes_of(edges: FloatArray) -> FloatArray:
    """Return Gauss's points of the pieces between edges (n + 1,): times (n, NODES)."""
    return edges[:-1, None] + np.diff(edges)[:, None] * POINTS


def solutions(K: FloatArray, edges: FloatArray, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Y of Y' = K Y, Y = 1 at the first edge: at all edges (n + 1, m, m), and at times (k, m, m).

    ``K`` are the coefficients at `nodes_of` the edges, (n, NODES, m, m); the edges ascend or descend, and the
    times lie between them.
    """
    lengths = np.diff(edges)
    scaled = lengths[:, None, None, None] * K
    rates = slopes(scaled, scaled)
    steps = np.einsum("k,nkij->nij", WEIGHTS, rates)
    at_edges = np.empty((len(edges), *K.shape[2:]))
    at_edges[0] = np.eye(K.shape[-1])
    for i, step in enumerate(steps):
        at_edges[i + 1] = at_edges[i] + step @ at_edges[i]
    which = np.searchsorted(np.abs(edges - edges[0]), np.abs(times - edges[0]), side="right") - 1
    which = np.minimum(which, len(lengths) - 1)
    shares = integrals((times - edges[which]) / lengths[which])
    first = at_edges[which]
    return at_edges, first + np.einsum("nk,nkij->nij", shares, rates[which]) @ first


def slopes(K: FloatArray, forcing: FloatArray) -> FloatArray:
    """Return D' at the points, (n, NODES, m, k), of D' = K D + forcing on [0, 1], with D = 0 at 0."""
    n, m, k = len(K), K.shape[-1], forcing.shape[-1]
    found = np.empty((n, NODES, m, k))
    for start in range(0, n, CHUNK):
        part = slice(start, start + CHUNK)
        # (1 - a_kj K_k) acting on the D'_j of all points
        matrix = -np.einsum("kj,nkab->nkajb", _UP_TO_POINTS, K[part]).reshape(-1, NODES * m, NODES * m)
        matrix += np.eye(NODES * m)
        right = forcing[part].reshape(-1, NODES * m, k)
        found[part] = np.linalg.solve(matrix, right).reshape(-1, NODES, m, k)
    return found


def integrals(s: FloatArray) -> FloatArray:
    """Return the integrals from 0 to s, (n,), of the points' Lagrange polynomials on [0, 1], (n, NODES)."""
    # of Legendre's P_k: (P_k+1 - P_k-1) / (2 k + 1), zero at -1
    P = np.polynomial.legendre.legvander(2.0 * s - 1.0, NODES)
    k = np.arange(1, NODES)
    of_P = np.column_stack([2.0 * s, (P[:, 2:] - P[:, :-2]) / (2 * k + 1)])
    found: FloatArray = 0.5 * of_P @ _TO_LEGENDRE
    return found


_UP_TO_POINTS: Final = integrals(POINTS)
