# SPDX-License-Identifier: Apache-2.0
"""Closed meshes beside exact rational integrals, closed forms and convergence, and refusals with reasons."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.inertia import MassDistribution
from contact_dynamics.shapes.convex import polyhedron
from contact_dynamics.world import Body, box_vertices
from oracles.inertia_exact import mesh_moments

OCTAHEDRON = (
    np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]),
    np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]),
)
BOX_TRIANGLES = np.array(
    # of the corners of `box_vertices`: index 4 x + 2 y + z, sides -x, +x, -y, +y, -z, +z
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)
Mesh = tuple[np.ndarray, np.ndarray]


def subdivided(mesh: Mesh) -> Mesh:
    """Each triangle as four, its sides halved: doubled coordinates keep whole numbers whole."""
    vertices, triangles = mesh
    points = [tuple(2 * v) for v in vertices]
    index = {point: i for i, point in enumerate(points)}
    smaller = []
    for a, b, c in triangles:
        ab, bc, ca = (
            index.setdefault(tuple(vertices[i] + vertices[j]), len(index))
            for i, j in ((a, b), (b, c), (c, a))
        )
        smaller += [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    return np.array(list(index)), np.array(smaller)


def box_mesh(size: tuple[float, float, float], center: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Mesh:
    return box_vertices(size) + center, BOX_TRIANGLES


def together(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    return (
        np.vstack([vertices for vertices, _ in meshes]),
        np.vstack([triangles + start for (_, triangles), start in zip(meshes, starts, strict=False)]),
    )


def inside_out(mesh: Mesh) -> Mesh:
    return mesh[0], mesh[1][:, ::-1]


def assert_equal(one: MassDistribution, other: MassDistribution, *, tolerance: float = 1e-14) -> None:
    scale = float(np.abs(other.I_B).max())
    assert one.mass == pytest.approx(other.mass, rel=tolerance)
    np.testing.assert_allclose(one.p_FB_F, other.p_FB_F, atol=tolerance * math.sqrt(scale / other.mass))
    np.testing.assert_allclose(one.I_B, other.I_B, atol=tolerance * scale)


@given(
    radii=st.lists(st.integers(1, 1000), min_size=18, max_size=18),
    far=st.tuples(*[st.integers(-(2**45), 2**45)] * 3),
)
def test_a_mesh_of_whole_numbers_is_integrated_exactly(radii: list[int], far: tuple[int, int, int]) -> None:
    """A star of 32 triangles, spiky, up to 3e13 m away, beside rational integrals over its faces."""
    vertices, triangles = subdivided(OCTAHEDRON)
    star = vertices * np.array(radii)[:, None] + np.array(far)
    volume, center, about_center = mesh_moments(
        [tuple(int(x) for x in v) for v in star], [tuple(int(i) for i in t) for t in triangles]
    )
    solid = inertia.mesh(star, triangles, density=1.0)
    exact = np.array([[float(x) for x in row] for row in about_center])
    assert solid.mass == pytest.approx(float(volume), rel=4e-15)
    # A volume of large spikes is a sum of like terms: some ten roundings
    np.testing.assert_allclose(solid.I_B, exact, atol=4e-15 * exact.max())
    places = [abs(float(c - origin)) for c, origin in zip(center, far, strict=True)]
    error = [abs(float(c - int(f)) - (p - int(f))) for c, f, p in zip(center, far, solid.p_FB_F, strict=True)]
    assert max(error) <= np.spacing(float(np.abs(star).max())) + 4e-15 * max([*places, 1.0])


@given(
    size=st.tuples(*[st.floats(1e-3, 1e3)] * 3),
    seed=st.integers(0, 2**32 - 1),
    p=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
)
def test_a_box(size: tuple[float, float, float], seed: int, p: tuple[float, float, float]) -> None:
    """Anywhere, turned anyhow, from a mesh and from its corners: the closed form, placed alike."""
    rotation = Rotation.random(random_state=seed)
    vertices = rotation.apply(box_vertices(size)) + np.array(p) * max(size)
    expected = inertia.box(size=size, density=2.0).placed(
        p_GF_G=np.array(p) * max(size), q_GF=rotation.as_quat()
    )
    # Turned corners are rounded by 1e-16 of the longest side, which may be 1e6 times the shortest
    tolerance = 1e-14 * max(size) / min(size)
    assert_equal(inertia.mesh(vertices, BOX_TRIANGLES, density=2.0), expected, tolerance=tolerance)
    assert_equal(inertia.convex_hull(vertices, density=2.0), expected, tolerance=tolerance)


def test_side_by_side_parts_add_and_cavities_are_taken_out() -> None:
    outer, hole, core = box_mesh((2.0, 2.0, 2.0)), box_mesh((1.0, 1.2, 1.4)), box_mesh((0.5, 0.5, 0.5))
    beside = box_mesh((1.0, 1.0, 1.0), (1.5, 0.0, 0.0))  # its side lies in a side of the large one
    solids = [
        inertia.box(size=size, density=1.0) for size in ((2.0, 2.0, 2.0), (1.0, 1.2, 1.4), (0.5, 0.5, 0.5))
    ]
    expected = inertia.combined(
        [
            inertia.without(solids[0], solids[1]),
            solids[2],
            inertia.box(size=(1.0, 1.0, 1.0), density=1.0).placed(p_GF_G=(1.5, 0.0, 0.0)),
        ]
    )
    assert_equal(inertia.mesh(*together(outer, inside_out(hole), core, beside), density=1.0), expected)
    assert_equal(inertia.mesh(*together(beside, core, inside_out(hole), outer), density=1.0), expected)


def test_repeated_vertices_and_flat_triangles_do_not_matter() -> None:
    vertices, triangles = box_mesh((1.0, 2.0, 3.0))
    box = inertia.box(size=(1.0, 2.0, 3.0), density=1.0)
    soup = vertices[triangles].reshape(-1, 3)  # as an STL file has it
    assert_equal(inertia.mesh(soup, np.arange(len(soup)).reshape(-1, 3), density=1.0), box)
    named_twice = np.vstack([triangles, [[0, 0, 1], [5, 5, 5]]])
    assert_equal(inertia.mesh(vertices, named_twice, density=1.0), box)
    # A vertex in the middle of the edge 0-1: one of its triangles is split, the other joined by a flat one
    a, b = (
        next(t for t in triangles.tolist() if pair in zip(t, [*t[1:], t[0]], strict=True))
        for pair in ((0, 1), (1, 0))
    )
    (third,) = set(a) - {0, 1}
    rest = [t for t in triangles.tolist() if t != a]
    split = np.array([*rest, [0, 8, third], [8, 1, third], [0, 1, 8]])
    assert b in rest
    with_middle = np.vstack([vertices, 0.5 * (vertices[0] + vertices[1])])
    assert_equal(inertia.mesh(with_middle, split, density=1.0), box)


def test_a_thin_sheet_keeps_the_digits_that_its_corners_have() -> None:
    size = (1.0, 1.0, 1e-6)
    assert_equal(inertia.mesh(*box_mesh(size), density=1.0), inertia.box(size=size, density=1.0))


@pytest.mark.parametrize("dtype", [np.int32, np.uint32, np.int64, np.uint8])
def test_indices_of_any_whole_type(dtype: type) -> None:
    vertices, triangles = OCTAHEDRON
    assert inertia.mesh(vertices, triangles.astype(dtype), density=1.0).mass == pytest.approx(4.0 / 3.0)


BOX = box_mesh((2.0, 2.0, 2.0))
ONE_TURNED = (BOX[0], np.vstack([BOX[1][:-1], BOX[1][-1:, ::-1]]))
FIN = (np.vstack([BOX[0], [[3.0, 3.0, 3.0]]]), np.vstack([BOX[1], [[0, 1, 8]]]))
LESS_ONE = (BOX[0], BOX[1][1:])


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        (LESS_ONE, r"edge \d-\d of triangle \d+ has no second triangle: the mesh is open \(and 2 more\)"),
        (FIN, r"edge 8-0 of triangle 12 has no second triangle"),
        (
            (BOX[0], np.vstack([BOX[1], BOX[1][:1]])),
            r"edge 0-1 of triangles 0, 5, 12 has more than two triangles",
        ),
        (together((BOX[0], BOX[1]), (BOX[0], BOX[1])), r"part \(that of triangle 0\) .* within another"),
        (ONE_TURNED, r"edge \d-\d of triangles \d+, 11 is passed in one direction by both \(and 2 more\)"),
        (inside_out(BOX), r"counter-clockwise.*, got .*an enclosed volume of -8 m\^3: inside out"),
        ((BOX[0] * [1, 1, 0], BOX[1]), r"an enclosed volume of 0 m\^3: flat"),
        ((BOX[0][:3], [[0, 1, 2], [0, 2, 1]]), r"an enclosed volume of 0 m\^3: flat"),
        (
            together(BOX, inside_out(box_mesh((1.0, 1.0, 1.0), (2.0, 0.0, 0.0)))),
            r"part \(that of triangle 12\) of volume -1 m\^3 in no solid: inside out",
        ),
        (
            together(BOX, box_mesh((1.0, 1.0, 1.0))),
            r"part \(that of triangle 12\) of volume 1 m\^3 within another",
        ),
        (
            together(box_mesh((1.0, 1.0, 1.0)), BOX),
            r"part \(that of triangle 0\) of volume 1 m\^3 within another",
        ),
        (
            together(BOX, inside_out(box_mesh((1.5, 1.5, 1.5))), inside_out(box_mesh((1.0, 1.0, 1.0)))),
            r"part \(that of triangle 24\) of volume -1 m\^3 in no solid",
        ),
        ((BOX[0], [[0, 1, 8]]), r"indices in \[0, 7\], of 8 vertices.*, got .*\[0, 1, 8\] in triangle 0"),
        ((BOX[0], [[0, 1, -1]]), r"\[0, 1, -1\] in triangle 0"),
        ((BOX[0], [[0.0, 1.0, 2.0]]), "whole numbers.*, got .*numbers of type float64"),
        ((BOX[0], [[0, 1, 2, 3]]), r"of shape \(n, 3\).*, got .*shape \(1, 4\)"),
        ((BOX[0], [[0, 1, 2], [0, 1]]), "whole numbers"),
        ((BOX[0], [["a", "b", "c"]]), "whole numbers"),
        ((BOX[0], np.zeros((0, 3), dtype=int)), "none with three different vertices"),
        ((BOX[0], [[1, 1, 2]]), "none with three different vertices"),
    ],
)
def test_what_is_no_solid_is_refused_with_the_reason(mesh: tuple[np.ndarray, object], words: str) -> None:
    with pytest.raises(InvalidFieldError, match=f"triangles must be .*{words}"):
        inertia.mesh(*mesh, density=1.0)


def test_a_flat_mesh_in_any_plane_is_flat() -> None:
    """Rounding makes a volume of 1e-17, of either sign, and a larger one far away: not one to divide by."""
    for seed in range(20):
        flat = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0.1, 0.3, 0], [-0.2, 0.1, 0]])
        turned = Rotation.random(random_state=seed).apply(flat)
        for far in (0.0, 100.0, 1e6):
            with pytest.raises(InvalidFieldError, match=r"flat"):
                inertia.mesh(turned + far, OCTAHEDRON[1], mass=1.0)
            with pytest.raises(InvalidFieldError, match=r"not in one plane"):
                inertia.convex_hull(turned + far, mass=1.0)


def test_vertices_that_are_none_are_refused() -> None:
    with pytest.raises(InvalidFieldError, match=r"mass or density must be given, and not both"):
        inertia.mesh(*BOX)
    with pytest.raises(InvalidFieldError, match=r"p_FV_F must be .*, got 0 points"):
        inertia.convex_hull(np.zeros((0, 3)), mass=1.0)
    with pytest.raises(InvalidFieldError, match=r"p_FV_F must be .*not in one plane.*, got 8 points"):
        inertia.convex_hull(BOX[0] * [1, 1, 0], mass=1.0)
    with pytest.raises(InvalidFieldError, match=r"p_FV_F must be .*, got 3 points"):
        inertia.convex_hull(BOX[0][:3], mass=1.0)


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(5, 40))
def test_a_hull_of_points_is_the_mesh_of_its_corners(seed: int, count: int) -> None:
    """Points inside change nothing."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    whole = inertia.convex_hull(points, density=1.0)
    assert_equal(
        inertia.convex_hull(np.vstack([points, 0.5 * points[:2] + 0.5 * points[2:4]]), density=1.0),
        whole,
        tolerance=1e-12,  # of five points the hull may be thin
    )
    first, second, third = np.linalg.eigvalsh(whole.I_B)
    assert first + second > third
    assert Body.of("hull", whole, shape_F=polyhedron(points)).mass_properties.mass == whole.mass


@pytest.mark.parametrize("shape", ["mesh", "hull"])
def test_any_size_that_can_be_cubed(shape: str) -> None:
    def cube(size: float) -> MassDistribution:
        vertices = box_vertices((1.0, 1.0, 1.0)) * size
        if shape == "hull":
            return inertia.convex_hull(vertices, mass=1.0)
        return inertia.mesh(vertices, BOX_TRIANGLES, mass=1.0)

    for size in (1e-60, 1e-9, 1e20, 1e60):
        assert cube(size).I_B[0, 0] == pytest.approx(size**2 / 6.0, rel=1e-14)
    with pytest.raises(InvalidFieldError, match=r"p_FV_F must be .*, got 1e\+61"):
        cube(2e61)
