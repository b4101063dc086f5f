# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.rotations.many import matrices_of, rotation_vectors, turned
from oracles.rigid_flight import about, matrix

AXIS = np.array([0.36, -0.48, 0.8])
REFERENCE = about(np.array([0.6, 0.0, 0.8]), 2.0)

# Angles from far below rounding's square root to just short of half a turn, each size as likely as the next.
angles = st.floats(-18.0, 0.49).map(lambda exponent: 10.0**exponent).filter(lambda angle: angle < 3.1)


@given(angles)
def test_the_vector_that_turns_an_orientation_is_found_again(angle: float) -> None:
    theta = angle * AXIS
    after = turned(REFERENCE, theta[None])
    # 1e-15: a few roundings of a unit quaternion; relative 1e-12 only where the vector is long
    assert rotation_vectors(after, REFERENCE)[0] == pytest.approx(theta, rel=1e-12, abs=1e-15)


@given(angles)
def test_a_vector_turns_about_its_axis_in_world_axes(angle: float) -> None:
    after = turned(REFERENCE, angle * AXIS[None])[0]
    assert matrix(after) == pytest.approx(matrix(about(AXIS, angle)) @ matrix(REFERENCE), abs=3e-15)


def test_both_signs_of_a_quaternion_are_the_same_orientation() -> None:
    after = turned(REFERENCE, 0.3 * AXIS[None])
    assert rotation_vectors(-after, REFERENCE) == pytest.approx(rotation_vectors(after, REFERENCE))


def test_matrices_of_many_quaternions_are_those_of_each() -> None:
    q = np.array([about(AXIS, 0.7), about(AXIS, -2.9), REFERENCE])
    assert matrices_of(q) == pytest.approx(np.array([matrix(each) for each in q]), abs=1e-15)
