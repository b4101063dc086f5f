from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.validation import FloatArray
from contact_dynamics.viewing.shape import NO_SIZE, Shape, convex_shape
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
