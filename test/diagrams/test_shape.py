# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from contact_dynamics.diagrams.shape import NO_SIZE, Shape, convex_shape, drawn_shape
from contact_dynamics.shapes.convex import NO_SHAPE, box, capsule, cone, cylinder, rounded, sphere, union
from contact_dynamics.validation import FloatArray
from contact_dynamics.world import box_vertices

SIZES = st.floats(1e-3, 10.0)
SEEDS = st.integers(0, 2**32 - 1)


def area_vectors(shape: Shape) -> FloatArray:
    a, b, c = (shape.triangles_B[:, i] for i in range(3))
    return 0.5 * np.cross(b - a, c - a)


@given(sides=st.tuples(SIZES, SIZES, SIZES), seed=SEEDS)
def test_a_turned_box_has_its_edges_area_and_volume(sides: tuple[float, float, float], seed: int) -> None:
    vertices = box_vertices(sides) @ Rotation.random(random_state=seed).as_matrix().T
    shape = convex_shape(vertices)
    lengths = np.sort(np.linalg.norm(shape.edges_B[:, 1] - shape.edges_B[:, 0], axis=1))
    np.testing.assert_allclose(lengths, np.sort(np.repeat(sides, 4)), rtol=1e-9)
    areas = area_vectors(shape)
    x, y, z = sides
    np.testing.assert_allclose(np.linalg.norm(areas, axis=1).sum(), 2 * (x * y + y * z + z * x), rtol=1e-9)
    volume = np.einsum("ij,ij->", areas, shape.triangles_B.mean(axis=1)) / 3.0  # divergence theorem
    np.testing.assert_allclose(volume, x * y * z, rtol=1e-9)


def test_a_union_is_drawn_as_all_its_parts() -> None:
    shape = drawn_shape(union([box(0.3, 0.1, 0.05), box(0.05, 0.1, 0.2).moved([0, 0, 0.125])]))
    volume = np.einsum("ij,ij->", area_vectors(shape), shape.triangles_B.mean(axis=1)) / 3.0
    assert volume == pytest.approx(0.3 * 0.1 * 0.05 + 0.05 * 0.1 * 0.2, rel=1e-12)
    assert len(shape.edges_B) == 24
    assert shape.size == pytest.approx(math.hypot(0.3, 0.1, 0.25), rel=1e-12)
    mixed = drawn_shape(union([box(0.2, 0.2, 0.2), sphere(0.1).moved([0, 0, 0.2])]))
    assert mixed.triangles_B[..., 2].min() == -0.1
    assert mixed.triangles_B[..., 2].max() == pytest.approx(0.3, abs=1e-15)


@given(count=st.integers(4, 60), seed=SEEDS)
def test_the_hull_is_closed_and_holds_every_corner(count: int, seed: int) -> None:
    vertices = np.random.default_rng(seed).normal(size=(count, 3))
    shape = convex_shape(vertices)
    np.testing.assert_allclose(area_vectors(shape).sum(axis=0), np.zeros(3), atol=1e-12 * count)
    heights = np.einsum("pj,fj->fp", vertices, shape.normals_B)
    faces = np.einsum("fj,fj->f", shape.triangles_B[:, 0], shape.normals_B)
    assert (heights <= faces[:, None] + 1e-9).all()
    outward = np.einsum("ij,ij->i", area_vectors(shape), shape.normals_B)
    assert (outward > 0.0).all()


def test_a_flat_body_is_a_polygon_seen_from_both_sides() -> None:
    square = np.array([[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1], [1, 1, 1]], dtype=float)
    shape = convex_shape(square)
    assert len(shape.edges_B) == 4
    np.testing.assert_allclose(np.linalg.norm(area_vectors(shape), axis=1).sum(), 2 * 4.0)
    np.testing.assert_allclose(area_vectors(shape).sum(axis=0), np.zeros(3), atol=1e-15)


def test_a_rod_is_its_longest_line() -> None:
    shape = convex_shape(np.array([[0, 0, 0], [1, 1, 0], [3, 3, 0], [2, 2, 0]], dtype=float))
    assert len(shape.triangles_B) == 0
    assert sorted(shape.edges_B[0].tolist()) == [[0, 0, 0], [3, 3, 0]]


@pytest.mark.parametrize("vertices", [np.zeros((0, 3)), np.ones((1, 3)), np.ones((5, 3))])
def test_a_body_without_extent_has_a_size_to_be_drawn_with(vertices: FloatArray) -> None:
    shape = convex_shape(vertices)
    assert len(shape.edges_B) == len(shape.triangles_B) == 0
    assert shape.size == NO_SIZE


ROUND = {
    "sphere": (sphere(radius=0.5), math.pi / 6.0),
    "capsule": (capsule(radius=0.5, length=1.0), math.pi / 6.0 + math.pi / 4.0),
    "cylinder": (cylinder(radius=0.5, length=2.0), math.pi / 2.0),
    "cone": (cone(radius=0.5, height=3.0), math.pi / 4.0),
    "rounded disc": (
        rounded(cylinder(radius=0.5, length=0.0), radius=0.25),
        math.pi * (2.0 * 0.25 * 0.5**2 + math.pi * 0.5 * 0.25**2 + 4.0 / 3.0 * 0.25**3),  # Steiner
    ),
    "rounded box": (
        rounded(box(size=(1.0, 2.0, 3.0)), radius=0.25),
        6.0 + 22.0 * 0.25 + math.pi * 6.0 * 0.25**2 + 4.0 / 3.0 * math.pi * 0.25**3,  # Steiner
    ),
}


@pytest.mark.parametrize("name", list(ROUND))
def test_round_shapes_fill_their_volume_but_for_the_facets(name: str) -> None:
    body, volume = ROUND[name]
    shape = drawn_shape(body)
    areas = area_vectors(shape)
    np.testing.assert_allclose(areas.sum(axis=0), np.zeros(3), atol=1e-12)
    filled = np.einsum("ij,ij->", areas, shape.triangles_B.mean(axis=1)) / 3.0
    assert 0.98 * volume < filled < volume
    assert (np.einsum("ij,ij->i", areas, shape.normals_B) > 0.0).all()


@pytest.mark.parametrize("name", list(ROUND))
def test_round_shapes_have_lines_on_them_that_show_turns_and_no_facets(name: str) -> None:
    body, _ = ROUND[name]
    edges = drawn_shape(body).edges_B
    assert 0 < len(edges) < 100 + 3 * 48 * max(1, len(body.vertices))
    turned = Rotation.from_euler("z", 1.0).apply(edges.reshape(-1, 3))
    gaps, _ = cKDTree(edges.reshape(-1, 3)).query(turned)
    assert gaps.max() > 0.01  # about its axis it does not look the same


def test_a_disc_is_drawn_from_both_sides_and_nothing_as_nothing() -> None:
    disc = drawn_shape(cylinder(radius=1.0, length=0.0))
    np.testing.assert_allclose(area_vectors(disc).sum(axis=0), np.zeros(3), atol=1e-12)
    assert len(drawn_shape(NO_SHAPE).triangles_B) == 0
    cube = drawn_shape(box(size=(1.0, 1.0, 1.0)))
    assert len(cube.edges_B) == 12
