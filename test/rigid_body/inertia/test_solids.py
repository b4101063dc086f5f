# SPDX-License-Identifier: Apache-2.0
"""Shapes in closed form beside lecture 24's sums over the particles of a quadrature, and textbook values."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.inertia import MassDistribution
from oracles.inertia_particles import Particle, cuboid, gauss, revolved, shell, sums, torus, turns

R, r, h = 0.7, 0.4, 1.9  # m

CAPSULE = [
    *revolved(-h / 2, h / 2, lambda _: R * R),
    *revolved(h / 2, h / 2 + R, lambda z: R * R - (z - h / 2) ** 2),
    *revolved(-h / 2 - R, -h / 2, lambda z: R * R - (z + h / 2) ** 2),
]
HOLLOW = [
    *revolved(-R, -r, lambda z: R * R - z * z),
    *revolved(-r, r, lambda z: R * R - z * z, lambda z: r * r - z * z),
    *revolved(r, R, lambda z: R * R - z * z),
]
ELLIPSOID = [
    (m * 2.0 * 0.5, (2.0 * x, 0.5 * y, z)) for m, (x, y, z) in revolved(-R, R, lambda z: R * R - z * z)
]
SHAPES: dict[str, tuple[Callable[..., MassDistribution], dict[str, object], list[Particle]]] = {
    "box": (inertia.box, {"size": (0.3, 0.5, 1.1)}, cuboid(0.3, 0.5, 1.1)),
    "sphere": (inertia.sphere, {"radius": R}, revolved(-R, R, lambda z: R * R - z * z)),
    "hollow sphere": (inertia.hollow_sphere, {"outer_radius": R, "inner_radius": r}, HOLLOW),
    "ellipsoid": (inertia.ellipsoid, {"semi_axes": (2 * R, R / 2, R)}, ELLIPSOID),
    "hemisphere": (inertia.hemisphere, {"radius": R}, revolved(0.0, R, lambda z: R * R - z * z)),
    "cylinder": (inertia.cylinder, {"radius": R, "length": h}, revolved(-h / 2, h / 2, lambda _: R * R)),
    "tube": (
        inertia.tube,
        {"outer_radius": R, "inner_radius": r, "length": h},
        revolved(-h / 2, h / 2, lambda _: R * R, lambda _: r * r),
    ),
    "capsule": (inertia.capsule, {"radius": R, "length": h}, CAPSULE),
    "cone": (inertia.cone, {"radius": R, "height": h}, revolved(0.0, h, lambda z: (R * (1.0 - z / h)) ** 2)),
    "frustum": (
        inertia.cone,
        {"radius": R, "height": h, "top_radius": r},
        revolved(0.0, h, lambda z: (R + (r - R) * z / h) ** 2),
    ),
    "torus": (inertia.torus, {"ring_radius": R, "tube_radius": r}, torus(R, r)),
    "rod": (inertia.rod, {"length": h}, [(w, (0.0, 0.0, z)) for z, w in gauss(-h / 2, h / 2)]),
    "ring": (
        inertia.ring,
        {"radius": R},
        [(R * w, (R * math.cos(t), R * math.sin(t), 0.0)) for t, w in turns()],
    ),
    "plate": (
        inertia.plate,
        {"size": (R, h)},
        [(v * w, (x, y, 0.0)) for x, v in gauss(-R / 2, R / 2) for y, w in gauss(-h / 2, h / 2)],
    ),
    "disc": (
        inertia.disc,
        {"radius": R},
        [(m, (x, y, 0.0)) for m, (x, y, _) in revolved(0.0, 1.0, lambda _: R * R)],
    ),
    "spherical shell": (inertia.spherical_shell, {"radius": R}, shell(-R, R, lambda z: R * R - z * z, R)),
    "cylindrical shell": (
        inertia.cylindrical_shell,
        {"radius": R, "length": h},
        shell(-h / 2, h / 2, lambda _: R * R, R),
    ),
}
LENGTHS = {"rod": 1, "ring": 1, "plate": 2, "disc": 2, "spherical shell": 2, "cylindrical shell": 2}


@pytest.mark.parametrize("name", SHAPES)
def test_each_shape_is_the_sum_over_its_particles(name: str) -> None:
    make, sizes, cloud = SHAPES[name]
    shape = make(**sizes, density=1.0)
    mass, center, about_center = sums(cloud)
    assert shape.mass == pytest.approx(mass, rel=1e-13)
    np.testing.assert_allclose(shape.p_FB_F, center, atol=1e-14)
    np.testing.assert_allclose(shape.I_B, about_center, atol=1e-13 * about_center.max())


@pytest.mark.parametrize("name", SHAPES)
def test_a_given_mass_and_the_density_that_makes_it_agree(name: str) -> None:
    make, sizes, _ = SHAPES[name]
    by_density = make(**sizes, density=7.8)
    by_mass = make(**sizes, mass=by_density.mass)
    np.testing.assert_allclose(by_mass.I_B, by_density.I_B, rtol=1e-15)
    np.testing.assert_array_equal(by_mass.p_FB_F, by_density.p_FB_F)


@pytest.mark.parametrize("name", SHAPES)
@settings(max_examples=20)
@given(factor=st.floats(1e-3, 1e3))
def test_solids_scale_with_the_cube_and_the_fifth_power(name: str, factor: float) -> None:
    """Sheets scale with the square and the fourth power, wires with the first and the third."""
    make, sizes, _ = SHAPES[name]
    one = make(**sizes, density=2.0)
    larger = make(**{key: factor * np.asarray(value) for key, value in sizes.items()}, density=2.0)
    power = LENGTHS.get(name, 3)
    assert larger.mass == pytest.approx(factor**power * one.mass, rel=1e-13)
    np.testing.assert_allclose(larger.p_FB_F, factor * one.p_FB_F, rtol=1e-13)
    np.testing.assert_allclose(larger.I_B, factor ** (power + 2) * one.I_B, rtol=1e-13)


def test_textbook_values() -> None:
    """Fractions of m r^2 and m l^2, as printed in every table."""
    m = 3.0
    ball = inertia.sphere(radius=2.0, mass=m)
    np.testing.assert_allclose(ball.I_B, 0.4 * m * 4.0 * np.eye(3), rtol=1e-15)
    rolling = inertia.cylinder(radius=2.0, length=6.0, mass=m)
    np.testing.assert_allclose(np.diag(rolling.I_B), [m * (3 * 4 + 36) / 12] * 2 + [m * 4 / 2], rtol=1e-15)
    cone = inertia.cone(radius=2.0, height=4.0, mass=m)
    np.testing.assert_allclose(cone.p_FB_F, [0.0, 0.0, 1.0], atol=1e-15)
    assert cone.I_B[2, 2] == pytest.approx(0.3 * m * 4.0, rel=1e-15)
    np.testing.assert_allclose(
        np.diag(inertia.spherical_shell(radius=2.0, mass=m).I_B), 2 / 3 * m * 4.0, rtol=1e-15
    )
    np.testing.assert_allclose(
        np.diag(inertia.rod(length=6.0, mass=m).I_B), [m * 3.0, m * 3.0, 0.0], rtol=1e-15
    )


def test_a_thin_wall_keeps_its_digits() -> None:
    """A wall of 1e-12 of the radius is a shell, to the first order of that."""
    hollow = inertia.hollow_sphere(outer_radius=1.0, inner_radius=1.0 - 1e-12, mass=1.0)
    np.testing.assert_allclose(hollow.I_B, inertia.spherical_shell(radius=1.0, mass=1.0).I_B, atol=2e-12)
    np.testing.assert_allclose(
        inertia.capsule(radius=0.5, length=0.0, mass=1.0).I_B,
        inertia.sphere(radius=0.5, mass=1.0).I_B,
        rtol=1e-15,
        atol=1e-17,
    )


@pytest.mark.parametrize(
    ("make", "arguments", "words"),
    [
        (inertia.box, {"size": (1.0, 1.0, 1.0)}, "mass or density must be given, and not both, got neither"),
        (inertia.box, {"size": (1.0, 1.0, 1.0), "mass": 1.0, "density": 1.0}, "mass or density .*, got both"),
        (
            inertia.tube,
            {"outer_radius": 1.0, "inner_radius": 1.0, "length": 1.0, "mass": 1.0},
            "inner_radius",
        ),
        (inertia.torus, {"ring_radius": 1.0, "tube_radius": 1.1, "mass": 1.0}, "at most the ring_radius, 1"),
    ],
)
def test_sizes_that_no_shape_has_are_refused(
    make: Callable[..., MassDistribution], arguments: dict[str, object], words: str
) -> None:
    with pytest.raises(InvalidFieldError, match=words):
        make(**arguments)
