# SPDX-License-Identifier: Apache-2.0
"""Linear equations by collocation, beside matrix exponentials and a variable coefficient that is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from contact_dynamics.numerics.gauss_collocation import Collocation

GAUSS = Collocation(12)
NODES, POINTS, WEIGHTS = GAUSS.count, GAUSS.points, GAUSS.weights


@pytest.mark.parametrize("m", [1, 3, 12])
@pytest.mark.parametrize("end", [2.0, -2.0])
def test_a_constant_coefficient_is_an_exponential(m: int, end: float) -> None:
    K = np.random.default_rng(m).normal(size=(m, m)) / m
    edges = np.linspace(0.0, end, 9) ** 3 / end**2  # pieces of any length
    times = np.array([0.0, 1e-9, 0.3, 1.0]) * end
    at_edges, at_times = GAUSS.solutions(np.broadcast_to(K, (8, NODES, m, m)), edges, times)
    for found, t in zip([*at_edges, *at_times], [*edges, *times], strict=True):
        np.testing.assert_allclose(found, expm(K * t), rtol=0.0, atol=1e-13)


def test_a_coefficient_that_varies() -> None:
    """The equation y' = cos(t) y has the solution y = exp(sin t). It begins at t = 1."""
    edges = np.linspace(1.0, 7.0, 16)
    times = np.linspace(1.0, 7.0, 101)
    at_edges, at_times = GAUSS.solutions(np.cos(GAUSS.nodes_of(edges))[:, :, None, None], edges, times)
    for t, found in ((edges, at_edges), (times, at_times)):
        np.testing.assert_allclose(found[:, 0, 0], np.exp(np.sin(t) - math.sin(1.0)), rtol=1e-12)


def test_what_fades_fast_fades() -> None:
    """Explicit methods would blow up: a piece is a hundred time constants long."""
    edges = np.array([0.0, 1.0, 2.0])
    found = GAUSS.solutions(np.full((2, NODES, 1, 1), -100.0), edges, np.array([2.0]))[1]
    assert abs(found[0, 0, 0]) < 0.1


def test_forcing() -> None:
    """D' = K D + f for constants: D = (e^K - 1) K^-1 f."""
    K, f = np.array([[0.3, -1.0], [0.5, 0.2]]), np.array([[1.0], [2.0]])
    rates = GAUSS.slopes(np.broadcast_to(K, (3, NODES, 2, 2)), np.broadcast_to(f, (3, NODES, 2, 1)))
    found = np.einsum("k,nkij->nij", WEIGHTS, rates)
    expected = (expm(K) - np.eye(2)) @ np.linalg.solve(K, f)
    np.testing.assert_allclose(found, np.tile(expected, (3, 1, 1)), rtol=1e-14)


def test_weights_integrate_polynomials() -> None:
    for power in range(2 * NODES):
        assert float(WEIGHTS @ POINTS**power) == pytest.approx(1.0 / (power + 1), rel=1e-13)
    for power in range(NODES):
        s = np.array([0.0, 0.2, 1.0])
        np.testing.assert_allclose(
            GAUSS.integrals(s) @ POINTS**power, s ** (power + 1) / (power + 1), atol=1e-14
        )


def test_more_pieces_than_are_solved_for_at_a_time() -> None:
    edges = np.linspace(0.0, 10.0, 200)
    found = GAUSS.solutions(np.full((199, NODES, 1, 1), -0.5), edges, np.array([10.0]))[1]
    assert found[0, 0, 0] == pytest.approx(math.exp(-5.0), rel=1e-13)
