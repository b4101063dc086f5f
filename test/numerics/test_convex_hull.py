# SPDX-License-Identifier: Apache-2.0
"""Convex hulls in rotations in which Qhull alone gives up."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from contact_dynamics.errors import UndecidedError
from contact_dynamics.numerics.convex_hull import hull_of
from contact_dynamics.numerics.nonnegative_least_squares import nearest_combination


def cube(d: int) -> np.ndarray:
    """Its corners, each twice, a hair apart: sides that are nearly one."""
    corners = np.array(list(itertools.product((-1.0, 1.0), repeat=d)))
    return np.vstack([corners, corners * (1.0 - 1e-9 * np.random.default_rng(d).uniform(size=corners.shape))])


@pytest.mark.parametrize("d", [2, 3, 4, 5])
def test_a_cube_has_its_sides_in_every_rotation(d: int) -> None:
    chance = np.random.default_rng(0)
    for _ in range(100):
        rotation = np.linalg.qr(chance.normal(size=(d, d)))[0]
        shift = chance.normal(size=d)
        hull = hull_of("points", cube(d) @ rotation.T + shift)
        normals = hull.equations[:, :-1] @ rotation
        assert np.abs(normals).max(axis=1) == pytest.approx(1.0, abs=1e-6)
        assert hull.equations[:, -1] == pytest.approx(-1.0 - hull.equations[:, :-1] @ shift, abs=1e-6)
        sides = {tuple(normal) for normal in np.round(normals).astype(int).tolist()}
        assert sides == {tuple(sign * side) for side in np.eye(d, dtype=int) for sign in (-1, 1)}


def test_corners_in_the_plane_are_in_counterclockwise_order() -> None:
    points = cube(2)
    corners = points[hull_of("points", points).vertices]
    x, y = corners.T
    assert 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) == pytest.approx(4.0)


def test_points_in_a_plane_are_refused_by_name() -> None:
    flat = np.column_stack([np.random.default_rng(1).normal(size=(9, 2)), np.zeros(9)])
    with pytest.raises(
        UndecidedError, match=r"^corners must be .*, got a convex hull that hangs on rounding"
    ):
        hull_of("corners", flat)


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
