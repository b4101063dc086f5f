# SPDX-License-Identifier: Apache-2.0
"""Distributions of mass: sums over particles, parallel axes, composition, placing, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.rigid_body import MassProperties, inertia
from contact_dynamics.rigid_body.inertia import MassDistribution
from contact_dynamics.shapes.convex import sphere
from contact_dynamics.world import MAX_VERTICES, Body, box_vertices
from oracles.inertia_particles import sums

vectors = st.tuples(*[st.floats(-5.0, 5.0)] * 3).map(np.array)
quaternions = st.integers(0, 2**32 - 1).map(lambda seed: Rotation.random(random_state=seed).as_quat())
masses = st.floats(0.1, 10.0)
clouds = st.lists(st.tuples(masses, st.tuples(*[st.floats(-5.0, 5.0)] * 3)), min_size=1, max_size=7)
SCALE = 7 * 10.0 * 75.0  # kg m^2: the largest inertia that such a cloud has


def of_cloud(cloud: list) -> MassDistribution:
    return inertia.particles([m for m, _ in cloud], [x for _, x in cloud])


def assert_equal(one: MassDistribution, other: MassDistribution, *, scale: float = SCALE) -> None:
    """To the rounding of sums of some ten terms of that size, kg m^2."""
    assert one.mass == pytest.approx(other.mass, rel=1e-14)
    np.testing.assert_allclose(one.p_FB_F, other.p_FB_F, atol=1e-14 * 50.0)
    np.testing.assert_allclose(one.I_B, other.I_B, atol=1e-14 * scale)


@given(cloud=clouds)
def test_particles_are_lecture_24s_sums(cloud: list) -> None:
    distribution = of_cloud(cloud)
    mass, center, about_center = sums(cloud)
    assert distribution.mass == pytest.approx(mass, rel=1e-15)
    np.testing.assert_allclose(distribution.p_FB_F, center, atol=1e-14)
    np.testing.assert_allclose(distribution.I_B, about_center, atol=1e-14 * SCALE)


@given(cloud=clouds, far=st.tuples(*[st.integers(-(2**30), 2**30)] * 3))
def test_a_far_frame_costs_no_digits(cloud: list, far: tuple[int, int, int]) -> None:
    """1e9 m away, with places on a grid so that moving them is exact: the inertia is the same."""
    near = [(m, tuple(round(c * 2**20) / 2**20 for c in x)) for m, x in cloud]
    moved = [(m, tuple(c + f for c, f in zip(x, far, strict=True))) for m, x in near]
    np.testing.assert_allclose(of_cloud(moved).I_B, of_cloud(near).I_B, atol=1e-14 * SCALE)


@given(cloud=clouds)
def test_particles_combined_one_by_one_are_the_cloud(cloud: list) -> None:
    points = [MassDistribution(mass=m, p_FB_F=np.array(x), I_B=np.zeros((3, 3))) for m, x in cloud]
    assert_equal(inertia.combined(points), of_cloud(cloud))


@given(cloud=clouds, other=clouds)
def test_what_is_put_on_can_be_taken_off(cloud: list, other: list) -> None:
    whole, part = of_cloud(cloud), of_cloud(other)
    rest = inertia.without(inertia.combined([whole, part]), part)
    # Masses of up to 70 kg differ by as little as 0.1 kg, so that the centre keeps 1e-13 m of its 1e-16
    assert rest.mass == pytest.approx(whole.mass, rel=1e-12)
    np.testing.assert_allclose(rest.p_FB_F, whole.p_FB_F, atol=1e-11)
    np.testing.assert_allclose(rest.I_B, whole.I_B, atol=1e-9)


@given(cloud=clouds, point=vectors)
def test_parallel_axes_both_ways(cloud: list, point: np.ndarray) -> None:
    """The inertia about any point equals the sums taken there, and the theorem leads back to the centre."""
    distribution = of_cloud(cloud)
    about = distribution.inertia_about(point)
    direct = sum(
        m * ((x - point) @ (x - point) * np.eye(3) - np.outer(x - point, x - point))
        for m, x in ((m, np.array(x)) for m, x in cloud)
    )
    np.testing.assert_allclose(about, direct, atol=4e-14 * SCALE)
    back = MassDistribution.from_inertia_about(
        point, about, mass=distribution.mass, p_FB_F=distribution.p_FB_F
    )
    assert_equal(back, distribution, scale=4 * SCALE)


@given(cloud=clouds, q=quaternions, p=vectors)
def test_placing_a_distribution_is_placing_its_particles(cloud: list, q: np.ndarray, p: np.ndarray) -> None:
    turned = [(m, tuple(Rotation.from_quat(q).apply(x) + p)) for m, x in cloud]
    placed = of_cloud(cloud).placed(p_GF_G=p, q_GF=q)
    assert_equal(placed, of_cloud(turned))
    np.testing.assert_allclose(
        np.linalg.eigvalsh(placed.I_B), np.linalg.eigvalsh(of_cloud(cloud).I_B), atol=1e-14 * SCALE
    )
    there = Rotation.from_quat(q).inv()
    assert_equal(placed.placed(p_GF_G=-there.apply(p), q_GF=there.as_quat()), of_cloud(cloud))


@given(cloud=clouds, normal=vectors.filter(lambda n: np.linalg.norm(n) > 0.1))
def test_a_mirror_image_is_that_of_its_particles(cloud: list, normal: np.ndarray) -> None:
    unit = normal / np.linalg.norm(normal)
    image = [(m, tuple(np.array(x) - 2.0 * (unit @ x) * unit)) for m, x in cloud]
    mirrored = of_cloud(cloud).mirrored(unit)
    assert_equal(mirrored, of_cloud(image))
    assert_equal(mirrored.mirrored(unit), of_cloud(cloud))


@given(cloud=clouds, axis=vectors.filter(lambda n: np.linalg.norm(n) > 0.1), point=vectors)
def test_the_radius_of_gyration_about_any_line(cloud: list, axis: np.ndarray, point: np.ndarray) -> None:
    """M k^2 = sum m d^2, d the distances to the line (lecture 25, eq. 13)."""
    unit = axis / np.linalg.norm(axis)
    distances = [float(np.linalg.norm(np.cross(unit, np.array(x) - point))) for _, x in cloud]
    expected = math.fsum(m * d * d for (m, _), d in zip(cloud, distances, strict=True))
    distribution = of_cloud(cloud)
    assert distribution.angular_inertia_about(unit, p_FQ_F=point) == pytest.approx(
        expected, abs=4e-14 * SCALE
    )
    k = distribution.radius_of_gyration(unit, p_FQ_F=point)
    assert distribution.mass * k * k == pytest.approx(expected, abs=4e-14 * SCALE)
    through_center = distribution.angular_inertia_about(unit)
    assert through_center == pytest.approx(
        distribution.angular_inertia_about(unit, p_FQ_F=distribution.p_FB_F), abs=1e-14 * SCALE
    )


def test_a_rod_about_its_own_axis_has_no_radius_of_gyration() -> None:
    q = Rotation.from_rotvec([0.3, -0.5, 0.2])
    rod = inertia.rod(length=2.0, mass=1.0).placed(q_GF=q.as_quat())
    assert rod.radius_of_gyration(q.apply([0.0, 0.0, 1.0])) < 1e-7  # the root of rounding


def test_another_mass_of_the_same_shape() -> None:
    cone = inertia.cone(radius=0.5, height=1.0, density=2.0)
    assert_equal(cone.with_mass(3.0), inertia.cone(radius=0.5, height=1.0, mass=3.0), scale=1.0)


def test_a_hammer_becomes_a_body_of_the_world() -> None:
    head = inertia.box(size=(0.1, 0.03, 0.03), density=7800.0)
    handle = inertia.cylinder(radius=0.01, length=0.3, density=700.0).placed(p_GF_G=(0.0, 0.0, -0.15))
    hammer = inertia.combined([head, handle])
    corners = box_vertices((0.1, 0.03, 0.03))
    body = Body.of("hammer", hammer, vertices_F=corners)
    np.testing.assert_array_equal(body.p_FB_F, hammer.p_FB_F)
    np.testing.assert_allclose(body.vertices_B + body.p_FB_F, corners, atol=1e-17)
    assert -0.15 < body.p_FB_F[2] < 0.0
    assert_equal(MassDistribution.of(body.mass_properties, body.p_FB_F), hammer, scale=1e-2)
    assert len(Body.of("bare", hammer).vertices_B) == 0
    ball = Body.of("ball", hammer, shape_F=sphere(radius=0.1))
    np.testing.assert_allclose(ball.shape.vertices + ball.p_FB_F, np.zeros((1, 3)), atol=1e-17)
    assert ball.shape.rounding == 0.1
    with pytest.raises(InvalidFieldError, match="vertices_F"):
        Body.of("both", hammer, vertices_F=corners, shape_F=sphere(radius=0.1))


def test_what_is_kept_cannot_change() -> None:
    ball = inertia.sphere(radius=1.0, mass=1.0)
    for array in (ball.I_B, ball.p_FB_F):
        with pytest.raises(ValueError, match=r"read-only"):
            array[0] = 2.0


def test_a_line_or_a_point_is_no_body_for_dynamics() -> None:
    rod = inertia.rod(length=1.0, mass=1.0)
    with pytest.raises(InvalidFieldError, match=r"I_B must be .*positive definite"):
        _ = rod.mass_properties
    crossed = inertia.combined([rod, rod.placed(q_GF=(math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))])
    assert isinstance(crossed.mass_properties, MassProperties)


def test_other_misuse_is_refused_by_name() -> None:
    ball = inertia.sphere(radius=1.0, mass=1.0)
    with pytest.raises(InvalidFieldError, match=r"parts must be .*, got none"):
        inertia.combined([])
    with pytest.raises(InvalidFieldError, match=r"part must be less than the whole's 1 kg.*, got mass 1 kg"):
        inertia.without(ball, ball)
    with pytest.raises(InvalidFieldError, match=r"part must be .*within the whole"):
        inertia.without(ball, inertia.sphere(radius=3.0, mass=0.5))
    with pytest.raises(InvalidFieldError, match=r"I_Q must be .*, got .*principal moments"):
        MassDistribution.from_inertia_about((0.0, 0.0, 2.0), np.eye(3), mass=1.0, p_FB_F=(0.0, 0.0, 0.0))
    with pytest.raises(InvalidFieldError, match=r"normal_F must be .*unit"):
        ball.mirrored((0.0, 0.0, 0.0))
    with pytest.raises(InvalidFieldError, match=r"axis_F must be .*unit"):
        ball.radius_of_gyration((0.0, 0.0, 2.0))
    with pytest.raises(TooLargeError, match=r"vertices"):
        Body.of("ball", ball, vertices_F=np.zeros((MAX_VERTICES + 1, 3)))
    with pytest.raises(InvalidFieldError, match=r"masses must be .*at least one"):
        inertia.particles([0.0], np.zeros((1, 3)))
    with pytest.raises(InvalidFieldError, match=r"p_FP_F must be of shape .*, got shape \(2, 3\)"):
        inertia.particles([1.0], np.zeros((2, 3)))
    with pytest.raises(InvalidFieldError, match=r"masses must be .*at least one"):
        inertia.particles([], np.zeros((0, 3)))
