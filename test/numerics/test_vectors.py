# SPDX-License-Identifier: Apache-2.0
"""Tangents of planes: each choice is at right angles, of unit length, right-handed, and the one it says."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.numerics.vectors import (
    across,
    along_least,
    near_x,
    normalised,
    point_jacobians,
    tangent_rows,
    tangents,
    tangents_by_sign,
    tangents_towards,
)
from contact_dynamics.tolerances import ROW_TOLERANCE

ROUNDING = 1e-15

# Normals near the coordinate axes too, where the choice of a first tangent changes.
parts = st.one_of(st.sampled_from([0.0, 1.0, -1.0, 1e-9, -1e-9, 1e-160]), st.floats(-1.0, 1.0))
normals = st.tuples(parts, parts, parts).map(np.array).filter(lambda n: np.linalg.norm(n) > 1e-3)
normals = normals.map(lambda n: n / np.linalg.norm(n))


def assert_frame(first: np.ndarray, second: np.ndarray, normal: np.ndarray) -> None:
    found = np.array([first, second, normal])
    assert found @ found.T == pytest.approx(np.eye(3), abs=3.0 * ROUNDING)
    assert np.cross(first, second) == pytest.approx(normal, abs=3.0 * ROUNDING)


@given(normal=normals)
def test_every_choice_makes_a_right_handed_frame(normal: np.ndarray) -> None:
    plain = tuple(normal.tolist())
    for first, second in (
        tangents(plain),
        tangent_rows(normal),
        tangents_towards(normal),
        tangents_by_sign(plain),
    ):
        assert_frame(np.array(first), np.array(second), normal)
    for tangent in (along_least(normal), near_x(normal) / np.linalg.norm(near_x(normal))):
        assert_frame(tangent, np.cross(normal, tangent), normal)


@given(normal=normals)
def test_an_array_gives_what_floats_give_and_pyramids_begin_opposite(normal: np.ndarray) -> None:
    rows = tangent_rows(normal)
    assert rows.tolist() == [list(tangent) for tangent in tangents(tuple(normal.tolist()))]
    assert np.array(tangents_towards(normal)).tolist() == (-rows).tolist()


@given(normal=normals, towards=normals)
def test_the_first_tangent_leans_towards_a_direction_that_is_not_the_normal(
    normal: np.ndarray, towards: np.ndarray
) -> None:
    first, second = tangents_towards(normal, towards)
    part = across(towards, normal)
    size = float(np.linalg.norm(part))
    if size > ROW_TOLERANCE:
        assert first @ normal == pytest.approx(0.0, abs=ROUNDING / size)
        assert first @ towards == pytest.approx(size, abs=ROUNDING / size)
        assert second == pytest.approx(np.cross(normal, first), abs=ROUNDING)
    else:
        assert_frame(first, second, normal)


def test_one_tangent_is_as_near_to_x_as_can_be() -> None:
    assert near_x(np.array([0.0, 0.0, 1.0])).tolist() == [1.0, 0.0, 0.0]
    assert near_x(np.array([0.6, 0.0, 0.8])) == pytest.approx([0.64, 0.0, -0.48], abs=ROUNDING)
    assert near_x(np.array([-1.0, 0.0, 0.0])).tolist() == [0.0, 1.0, 0.0]


def test_point_jacobians_give_the_velocities_of_points() -> None:
    rng = np.random.default_rng(6)
    arms, v, w = rng.normal(size=(5, 3)), rng.normal(size=3), rng.normal(size=3)
    found = point_jacobians(arms)
    assert found.shape == (5, 3, 6)
    assert found @ np.concatenate([v, w]) == pytest.approx(v + np.cross(w, arms), abs=4.0 * ROUNDING)
    assert point_jacobians(np.zeros((0, 3))).shape == (0, 3, 6)


@pytest.mark.parametrize("exponent", [0, -100, -139, -141, -150, -155, -162, -170, -300, -307, -320])
def test_a_vector_of_any_length_has_a_unit_vector(exponent: int) -> None:
    """Its squares may underflow. Below 1e-308 numbers have fewer digits, so their directions do too."""
    length = float(f"1e{exponent}")
    found = normalised((0.6 * length, 0.0, -0.8 * length))
    assert found == pytest.approx((0.6, 0.0, -0.8), rel=4e-16 if exponent > -307 else 1e-3)
