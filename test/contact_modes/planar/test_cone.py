# SPDX-License-Identifier: Apache-2.0
"""Extreme rays of cones beside all cross products of their rows, in whole numbers."""

from __future__ import annotations

import itertools
import math
import random

import numpy as np
import pytest

from contact_dynamics.contact_modes.planar.cone import PolyhedralCone
from contact_dynamics.numerics.linear_spaces import orthonormal
from contact_dynamics.numerics.nonnegative_least_squares import least_force
from sweeps import seeds

Whole = tuple[int, int, int]


def whole_cross(a: Whole, b: Whole) -> Whole:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def inside(rows: list[Whole], point: Whole) -> bool:
    return all(sum(a * b for a, b in zip(row, point, strict=True)) >= 0 for row in rows)


def unit(vector: Whole) -> tuple[float, float, float]:
    length = math.sqrt(sum(x * x for x in vector))
    return (vector[0] / length, vector[1] / length, vector[2] / length)


def build(rows: list[Whole], *, exact: bool = False) -> PolyhedralCone:
    return PolyhedralCone([unit(row) for row in rows], exact=exact)


def rank(vectors: list) -> int:
    return int(np.linalg.matrix_rank(np.array(vectors, dtype=float), tol=1e-9)) if vectors else 0


@seeds(range(300))
def test_rays_of_drawn_cones(seed: int) -> None:
    chance = random.Random(seed)
    size = chance.choice([1, 1, 2, 5])
    rows: list[Whole] = []
    while len(rows) < chance.randint(1, 9):
        row = (chance.randint(-size, size), chance.randint(-size, size), chance.randint(-size, size))
        if any(row):
            rows.append(row)
    check(rows)


@pytest.mark.parametrize("exact", [False, True])
@seeds(range(24), slow=range(24, 60))
def test_rays_of_cones_of_many_rows(seed: int, *, exact: bool) -> None:
    chance = random.Random(seed)
    size, height = chance.choice([(2, 2), (3, 4), (9, 9), (9, 40)])
    kinds = {
        "upwards": lambda: (chance.randint(-size, size), chance.randint(-size, size), height),
        "feet": lambda: (0, 1, chance.randint(-size, size)),
        "inclined": lambda: (chance.randint(-size, size), 1, chance.randint(-size, size)),
        "any": lambda: (chance.randint(-1, 1), chance.randint(-1, 1), 1),
    }
    several = chance.sample(list(kinds.values()), chance.choice([1, 1, 2]))
    rows = [chance.choice(several)() for _ in range(chance.randint(25, 45))]
    if chance.random() < 0.2:
        rows[chance.randrange(len(rows))] = (0, 0, -1)
    check(rows, exact=exact)


def check(rows: list[Whole], *, exact: bool = False) -> None:
    cone = build(rows, exact=exact)
    assert len(cone.lineality) == 3 - rank(rows)
    # Every candidate point of the cone is a combination of its lines and rays, and these are in it.
    for ray, tight in zip(cone.rays, cone.tight, strict=True):
        heights = [sum(a * b for a, b in zip(unit(row), ray, strict=True)) for row in rows]
        assert min(heights) >= -1e-12
        assert tight == sum(1 << i for i, height in enumerate(heights) if abs(height) < 1e-9)
    if not cone.lineality:
        extreme = set()
        for a, b in itertools.combinations(rows, 2):
            for sign in (1, -1):
                x, y, z = whole_cross(a, b)
                if (x or y or z) and inside(rows, (sign * x, sign * y, sign * z)):
                    extreme.add(tuple(round(c, 9) + 0.0 for c in unit((sign * x, sign * y, sign * z))))
        assert {tuple(round(c, 9) + 0.0 for c in ray) for ray in cone.rays} == extreme
        assert len(cone.rays) == len(extreme)


@pytest.mark.parametrize(
    ("rows", "shape"),  # lines, rays, whether it has an interior
    [
        ([], (3, 0, True)),
        ([(0, 0, 1)], (2, 1, True)),
        ([(0, 0, 1), (0, 0, 2)], (2, 1, True)),
        ([(0, 0, 1), (0, 0, -1)], (2, 0, False)),
        ([(0, 0, 1), (0, 1, 0)], (1, 2, True)),
        ([(0, 0, 1), (0, 1, 0), (0, 1, 1)], (1, 2, True)),
        ([(0, 0, 1), (0, 0, -1), (0, 1, 0)], (1, 1, False)),
        ([(0, 1, 0), (0, 0, 1), (0, -1, -1)], (1, 0, False)),
        ([(1, 0, 0), (0, 1, 0), (0, 0, 1)], (0, 3, True)),
        ([(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)], (0, 2, False)),
        ([(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, -1, -1)], (0, 1, False)),
        ([(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, -1, -1)], (0, 0, False)),
    ],
)
def test_every_kind_of_degenerate_cone(rows: list[Whole], shape: tuple[int, int, bool]) -> None:
    for order in itertools.permutations(rows):
        cone = build(list(order))
        assert (len(cone.lineality), len(cone.rays), cone.has_interior) == shape


def test_forces_balance_and_do_not_pull() -> None:
    for seed in range(300):
        chance = np.random.default_rng(seed)
        spread = 10.0 ** chance.uniform(-3.0, 0.5)
        columns = chance.normal(size=3) + spread * chance.normal(size=(chance.integers(1, 9), 3))
        columns /= np.linalg.norm(columns, axis=1)[:, None]
        target = 10.0 ** chance.uniform(-3.0, 0.0, size=len(columns)) @ columns
        absent = [
            tuple(line)
            for line in np.linalg.svd(columns)[2][np.linalg.matrix_rank(columns, tol=1e-9) :].tolist()
        ]
        x = np.array(least_force([tuple(c) for c in columns.tolist()], tuple(target.tolist()), absent))
        assert x.min() >= 0.0
        assert np.linalg.norm(x @ columns - target) <= 1e-9 * (np.linalg.norm(target) + x.sum())


def test_evenly_spread_where_all_forces_push() -> None:
    feet = [unit((x, 0, 4)) for x in (-1, 0, 1)]
    x = least_force(feet, (0.0, 0.0, 1.0), [(0.0, 1.0, 0.0)])
    assert x == pytest.approx(x[::-1])
    assert min(x) > 0.2


def test_orthonormal_bases_have_the_rank() -> None:
    assert len(orthonormal([])) == 0
    assert len(orthonormal([(1.0, 0.0, 0.0), (1.0, 0.0, 0.0)])) == 1
    basis = np.array(orthonormal([(1.0, 0.0, 0.0, 0.0), (0.6, 0.8, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)]))
    np.testing.assert_allclose(basis @ basis.T, np.eye(3), atol=1e-15)
