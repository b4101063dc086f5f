# SPDX-License-Identifier: Apache-2.0
"""Rotations in batches, beside SciPy's, near no turn and near half a turn too."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.rotations.many import (
    cross_matrices,
    crosses,
    make_continuous,
    matrices_of,
    products,
    quaternions_of,
    rotated,
    rotation_vectors,
    turned,
)

COUNT = 200
DRAWN = Rotation.random(COUNT, random_state=1)
BEFORE = Rotation.random(COUNT, random_state=2)
ANGLES = [0.0, 1e-300, 1e-160, 1e-12, 1e-7, 1e-3, 1.0, 3.0, math.pi - 1e-6, math.pi - 1e-12]

axes = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda axis: np.linalg.norm(axis) > 1e-3)


def test_matrices_are_those_of_scipy() -> None:
    np.testing.assert_allclose(matrices_of(DRAWN.as_quat()), DRAWN.as_matrix(), rtol=0.0, atol=2e-15)
    np.testing.assert_array_equal(matrices_of(-DRAWN.as_quat()), matrices_of(DRAWN.as_quat()))


def test_cross_matrices_multiply_as_cross_products() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(2, COUNT, 3))
    np.testing.assert_allclose(
        np.einsum("nij,nj->ni", cross_matrices(a), b), np.cross(a, b), rtol=0.0, atol=1e-15
    )
    np.testing.assert_array_equal(cross_matrices(a), -cross_matrices(a).transpose(0, 2, 1))


def test_rotation_vectors_are_those_of_scipy() -> None:
    """In world axes, after the attitude: Exp(theta) R_from = R."""
    found = rotation_vectors(DRAWN.as_quat(), BEFORE.as_quat())
    np.testing.assert_allclose(found, (DRAWN * BEFORE.inv()).as_rotvec(), rtol=0.0, atol=1e-13)
    np.testing.assert_array_equal(rotation_vectors(-DRAWN.as_quat(), BEFORE.as_quat()), found)


def test_products_turned_vectors_and_quaternions_of_vectors_are_those_of_scipy() -> None:
    p, q = DRAWN.as_quat(), BEFORE.as_quat()
    each, all_by_one = products(p, q), products(p, q[0])
    np.testing.assert_allclose(matrices_of(each), (DRAWN * BEFORE).as_matrix(), rtol=0.0, atol=3e-15)
    np.testing.assert_allclose(all_by_one, products(p, np.tile(q[0], (COUNT, 1))), rtol=0.0, atol=1e-15)
    vector = np.array([0.3, -2.0, 1.1])
    np.testing.assert_allclose(rotated(p, vector), DRAWN.apply(vector), rtol=0.0, atol=1e-14)
    found = quaternions_of(DRAWN.as_rotvec())
    np.testing.assert_allclose(matrices_of(found), DRAWN.as_matrix(), rtol=0.0, atol=3e-15)


@given(axis=axes, angle=st.sampled_from(ANGLES))
def test_turning_and_asking_by_how_much_are_inverse(axis: tuple, angle: float) -> None:
    """The error is last bits of the angle, however small, and near half a turn last bits of the attitude."""
    theta = np.tile(angle * np.array(axis) / np.linalg.norm(axis), (COUNT, 1))
    after = turned(BEFORE.as_quat(), theta)
    np.testing.assert_allclose(np.linalg.norm(after, axis=1), 1.0, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(
        rotation_vectors(after, BEFORE.as_quat()), theta, rtol=0.0, atol=2e-15 * (1.0 + angle)
    )


@pytest.mark.parametrize("angle", [a for a in ANGLES if a < 1e-2])
def test_small_turns_of_no_turn_keep_all_their_digits(angle: float) -> None:
    upright = np.array([[0.0, 0.0, 0.0, 1.0]])
    theta = angle * np.array([[0.48, -0.6, 0.64]])
    np.testing.assert_allclose(rotation_vectors(turned(upright, theta), upright), theta, rtol=1e-15)


def test_a_whole_turn_is_none_and_more_than_half_is_the_rest_the_other_way() -> None:
    upright = np.array([[0.0, 0.0, 0.0, 1.0]])
    for angle, left in ((2.0 * math.pi, 0.0), (1.5 * math.pi, -0.5 * math.pi), (-4.0, 2.0 * math.pi - 4.0)):
        there = turned(upright, np.array([[0.0, 0.0, angle]]))
        found = rotation_vectors(there, upright)[0]
        np.testing.assert_allclose(found, [0.0, 0.0, left], rtol=0.0, atol=1e-15)


def test_signs_follow_the_row_before_and_the_first() -> None:
    q = Rotation.from_rotvec(np.linspace(0.0, 20.0, 101)[:, None] * [0.0, 0.6, 0.8]).as_quat()
    signs = np.random.default_rng(4).choice([-1.0, 1.0], size=101)
    for first in (q[0], -q[0]):
        mixed = q * signs[:, None]
        make_continuous(mixed, first)
        assert mixed[0] @ first > 0.0
        assert (np.einsum("ij,ij->i", mixed[1:], mixed[:-1]) > 0.9).all()
        np.testing.assert_array_equal(np.abs(mixed), np.abs(q))
    make_continuous(np.zeros((0, 4)), q[0])


def test_none_at_all() -> None:
    none = np.zeros((0, 4))
    assert matrices_of(none).shape == (0, 3, 3)
    assert rotation_vectors(none, none).shape == (0, 3)
    assert turned(none, np.zeros((0, 3))).shape == (0, 4)


def test_crosses_are_those_of_numpy_bit_for_bit() -> None:
    chance = np.random.default_rng(3)
    a, b = chance.standard_normal((2, 20, 3))
    for one, other in ((a, b), (a, b[0]), (a[0], b), (a[:0], b[:0])):
        np.testing.assert_array_equal(crosses(one, other), np.cross(one, other))
