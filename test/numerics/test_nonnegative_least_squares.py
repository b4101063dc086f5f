# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np

from contact_dynamics.numerics.nonnegative_least_squares import nearest_combination


def test_no_sum_is_nearer() -> None:
    """Some 20 of these are the ones of which SciPy 1.15 alone returns another sum or distance."""
    chance = np.random.default_rng(0)
    for case in range(4000):
        rows, half = chance.integers(3, 8), chance.integers(1, 30)
        columns = chance.normal(size=(rows, 2 * half))
        if case % 2:  # equal ones, and nearly equal ones
            columns[:, half:] = columns[:, :half] + (case % 4 == 1) * 1e-3 * columns[:, half:]
        if case % 3 == 0:
            columns = abs(columns)
        columns /= np.linalg.norm(columns, axis=0)
        target = chance.normal(size=rows)
        found = nearest_combination(columns, target)
        assert found is not None
        x, distance = found
        rest = target - columns @ x
        assert x.min() >= 0.0
        np.testing.assert_allclose(distance, np.linalg.norm(rest), rtol=1e-9, atol=1e-9)
        assert (columns.T @ rest).max() < 1e-8
        assert abs(rest @ columns @ x) < 1e-8
