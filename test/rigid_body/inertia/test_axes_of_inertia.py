# SPDX-License-Identifier: Apache-2.0
"""Principal axes: what makes them that, their order and signs, equal moments, and the inertia ellipsoid."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.inertia import PrincipalAxes, inertia_ellipsoid, principal_axes

rotations = st.integers(0, 2**32 - 1).map(lambda seed: Rotation.random(random_state=seed))
spreads = st.tuples(*[st.floats(1e-3, 10.0)] * 3)  # m^2: the means of x^2, y^2, z^2 in principal axes
units = rotations.map(lambda rotation: rotation.apply([0.0, 0.0, 1.0]))


def moments_of(spread: tuple[float, float, float]) -> np.ndarray:
    x, y, z = sorted(spread, reverse=True)
    return np.array([y + z, x + z, x + y])


def turned(moments: np.ndarray, rotation: Rotation) -> np.ndarray:
    R = rotation.as_matrix()
    matrix = R @ np.diag(moments) @ R.T
    return 0.5 * (matrix + matrix.T)


def assert_principal(axes: PrincipalAxes, I_B: np.ndarray) -> None:
    """A right-handed frame that diagonalises the matrix, moments ascending along it."""
    scale = float(np.abs(I_B).max())
    np.testing.assert_allclose(axes.R_BP.T @ axes.R_BP, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes.R_BP) == pytest.approx(1.0, abs=1e-14)
    # 1e-12: moments nearer to each other than that are called equal
    np.testing.assert_allclose(axes.R_BP.T @ I_B @ axes.R_BP, np.diag(axes.moments), atol=2e-12 * scale)
    assert (np.diff(axes.moments) >= 0.0).all()


@given(spread=spreads, rotation=rotations)
def test_a_turned_body_has_the_moments_it_had(spread: tuple[float, float, float], rotation: Rotation) -> None:
    moments = moments_of(spread)
    I_B = turned(moments, rotation)
    axes = principal_axes(I_B)
    assert_principal(axes, I_B)
    np.testing.assert_allclose(axes.moments, moments, atol=4e-15 * moments[2])


@given(spread=spreads, rotation=rotations)
def test_first_and_second_axis_have_their_largest_component_positive(
    spread: tuple[float, float, float], rotation: Rotation
) -> None:
    moments = moments_of(spread)
    axes = principal_axes(turned(moments, rotation))
    if np.diff(moments).min() < 1e-6 * moments[2]:
        return  # equal moments have another rule
    for axis in axes.R_BP.T[:2]:
        if np.sort(np.abs(axis))[1] < np.abs(axis).max() * (1.0 - 1e-6):
            assert axis[np.abs(axis).argmax()] > 0.0


@pytest.mark.parametrize(
    ("moments", "columns"),
    [
        ((1.0, 2.0, 2.5), ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
        ((2.5, 2.0, 1.0), ((0, 0, 1), (0, 1, 0), (-1, 0, 0))),
        ((2.0, 1.0, 2.5), ((0, 1, 0), (1, 0, 0), (0, 0, -1))),
        ((2.0, 2.5, 1.0), ((0, 0, 1), (1, 0, 0), (0, 1, 0))),
        # two equal: body axes in cyclic order
        ((1.0, 1.0, 2.0), ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
        ((1.0, 2.0, 1.0), ((0, 0, 1), (1, 0, 0), (0, 1, 0))),
        ((2.0, 1.0, 1.0), ((0, 1, 0), (0, 0, 1), (1, 0, 0))),
        ((1.0, 2.0, 2.0), ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
        ((2.0, 1.0, 2.0), ((0, 1, 0), (0, 0, 1), (1, 0, 0))),
        ((2.0, 2.0, 1.0), ((0, 0, 1), (1, 0, 0), (0, 1, 0))),
        ((1.0, 1.0, 1.0), ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
        ((0.0, 0.0, 0.0), ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
        ((1.0, 1.0, 0.0), ((0, 0, 1), (1, 0, 0), (0, 1, 0))),
    ],
)
def test_bodies_in_their_principal_axes(
    moments: tuple[float, ...], columns: tuple[tuple[int, ...], ...]
) -> None:
    axes = principal_axes(np.diag(moments))
    np.testing.assert_array_equal(axes.R_BP, np.array(columns).T)
    np.testing.assert_array_equal(axes.moments, sorted(moments))


def test_rounding_of_the_input_does_not_turn_the_axes() -> None:
    """An axis along (1, -1, 0) has two largest components: the first is positive, whatever rounding does."""
    R = np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, math.sqrt(2.0)]]) / math.sqrt(2.0)
    exact = R @ np.diag([1.0, 2.0, 2.5]) @ R.T
    for seed in range(50):
        noise = np.random.default_rng(seed).normal(size=(3, 3)) * 1e-15
        np.testing.assert_allclose(principal_axes(exact + noise + noise.T).R_BP, R, atol=2e-14)


@given(spread=st.tuples(st.floats(1e-3, 10.0), st.floats(1e-3, 10.0)), rotation=rotations)
def test_of_two_equal_moments_the_frame_nearest_to_the_body_is_taken(
    spread: tuple[float, float], rotation: Rotation
) -> None:
    """No other turn in the plane of the equal moments brings the frame nearer to the cyclic body axes."""
    across, along = spread
    moments = np.array([across + along, across + along, 2.0 * across])
    if abs(along - across) < 1e-3 * across:
        return  # nearly a sphere: rounding of the matrix turns its axes
    I_B = turned(moments, rotation)
    axes = principal_axes(I_B)
    assert_principal(axes, I_B)
    assert np.unique(axes.moments).size == 2
    alone = int(np.argmax(np.abs(axes.moments - np.median(axes.moments))))
    axis = rotation.apply([0.0, 0.0, 1.0])
    assert abs(axes.R_BP[:, alone] @ axis) == pytest.approx(1.0, abs=1e-12)
    n = axes.R_BP[:, alone]
    if np.sort(np.abs(n))[1] > np.abs(n).max() * (1.0 - 1e-6):
        return  # two body axes are equally near
    k = int(np.abs(n).argmax())
    assert n[k] > 0.0
    cyclic = np.roll(np.eye(3), alone - k, axis=1)  # column ``alone`` is e_k
    np.testing.assert_array_equal(cyclic[:, alone], np.eye(3)[k])
    nearness = np.trace(cyclic.T @ axes.R_BP)
    for angle in np.linspace(0.0, 2.0 * math.pi, 25):
        other = Rotation.from_rotvec(angle * n).as_matrix() @ axes.R_BP
        assert np.trace(cyclic.T @ other) <= nearness + 1e-14


@given(rotation=rotations)
def test_a_sphere_keeps_the_bodys_axes_however_it_was_turned(rotation: Rotation) -> None:
    axes = principal_axes(turned(np.full(3, 0.4), rotation))
    np.testing.assert_array_equal(axes.R_BP, np.eye(3))
    assert np.unique(axes.moments).size == 1


def test_a_slim_bodys_small_moment_keeps_its_digits() -> None:
    """1e-12 of the others, beside products of inertia, where LAPACK's error is 1e-4 of it."""
    small = 2.0**-40
    # The axes (3, 4, 0)/5, (-4, 3, 0)/5, z; times 25, all entries are exact in doubles
    I_B = np.array(
        [[9 * small + 16, 12 * small - 12, 0.0], [12 * small - 12, 16 * small + 9, 0.0], [0.0, 0.0, 25.0]]
    )
    axes = principal_axes(I_B)
    assert axes.moments[0] == 25 * small
    np.testing.assert_allclose(axes.R_BP[:, 0], [0.6, 0.8, 0.0], atol=1e-16)


@given(spread=spreads, rotation=rotations, axis=units, level=st.floats(0.1, 10.0))
def test_the_inertia_ellipsoid_is_one_over_the_radius_of_gyration(
    spread: tuple[float, float, float], rotation: Rotation, axis: np.ndarray, level: float
) -> None:
    """r^T I r = a along every axis (eq. 14), r = sqrt(a / m) / k (eq. 17), on its semi-axes (eq. 15)."""
    mass = 2.0
    body = inertia.MassDistribution(
        mass=mass, p_FB_F=np.zeros(3), I_B=mass * turned(moments_of(spread), rotation)
    )
    ellipsoid = inertia_ellipsoid(body.I_B, level=level)
    r = ellipsoid.distance(axis)
    point = r * axis
    assert point @ body.I_B @ point == pytest.approx(level, rel=1e-13)
    assert r == pytest.approx(math.sqrt(level / mass) / body.radius_of_gyration(axis), rel=1e-13)
    in_axes = (ellipsoid.R_BP.T @ point) / ellipsoid.semi_axes
    assert in_axes @ in_axes == pytest.approx(1.0, rel=1e-9)
    assert (np.diff(ellipsoid.semi_axes) <= 0.0).all()


def test_the_ellipsoid_of_a_rod_is_a_cylinder() -> None:
    ellipsoid = inertia_ellipsoid(inertia.rod(length=math.sqrt(12.0), mass=1.0).I_B)
    np.testing.assert_allclose(ellipsoid.semi_axes, [math.inf, 1.0, 1.0])
    assert ellipsoid.distance((0.0, 0.0, 1.0)) == math.inf
    assert ellipsoid.distance((1.0, 0.0, 0.0)) == pytest.approx(1.0, rel=1e-15)


def test_what_has_no_principal_axes_or_no_ellipsoid_is_refused() -> None:
    with pytest.raises(InvalidFieldError, match=r"I_B must be .*symmetric"):
        principal_axes([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    with pytest.raises(InvalidFieldError, match=r"I_B must be .*moments >= 0"):
        inertia_ellipsoid(np.diag([-1.0, 1.0, 1.0]))
    with pytest.raises(InvalidFieldError, match=r"level must be .*, got 0.0"):
        inertia_ellipsoid(np.eye(3), level=0.0)
