# SPDX-License-Identifier: Apache-2.0
"""Linear inequalities without solution: multipliers contradict themselves, and SciPy finds no solution."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from contact_dynamics.numerics.infeasible import contradiction


def drawn(chance: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return about as many inequalities as have a solution in half of all draws, some of them homogeneous."""
    m, n = int(chance.integers(2, 12)), int(chance.integers(1, 12))
    limits = chance.normal(size=m) - 0.3
    limits[chance.random(m) < 0.4] = 0.0
    return chance.normal(size=(m, n)), limits


def check(seed: int) -> bool:
    rows, limits = drawn(np.random.default_rng(seed))
    solvable = linprog(np.zeros(rows.shape[1]), A_ub=rows, b_ub=limits).status == 0
    multipliers = contradiction(rows, limits)
    assert (multipliers is None) == solvable, seed
    if multipliers is not None:
        size = multipliers.sum()
        assert np.all(multipliers >= 0.0)
        # A few steps round by less than 1e-12 of terms of the size of the multipliers.
        assert np.all(multipliers @ rows >= -1e-10 * size), seed
        assert multipliers @ limits < 0.0, seed
    return solvable


def test_multipliers_contradict_themselves_where_there_is_no_solution() -> None:
    solvable = [check(seed) for seed in range(100)]
    assert 20 < sum(solvable) < 80


@pytest.mark.slow
def test_multipliers_contradict_themselves_in_many_draws() -> None:
    for seed in range(1000, 6000):
        check(seed)


def test_a_single_inequality() -> None:
    assert contradiction(np.array([[1.0]]), np.array([-1.0])) is not None
    assert contradiction(np.array([[-1.0]]), np.array([-1.0])) is None
    assert contradiction(np.zeros((1, 0)), np.array([0.0])) is None
