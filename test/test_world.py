# SPDX-License-Identifier: Apache-2.0
"""The world and the contacts that geometry finds in it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.contact import ContactSet
from contact_dynamics.contact.contact import MAX_CONTACTS
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.errors import InvalidFieldError, TooLargeError, UnknownBodyError
from contact_dynamics.rigid_body import BodyState, MassProperties, inertia
from contact_dynamics.shapes import ConvexShape, Obstacle, box, capsule, cylinder, sphere
from contact_dynamics.world import MAX_VERTICES, Body, Surface, World, box_vertices

STUFF = MassProperties(mass=1.0, I_B=np.eye(3))
BOX = Body(name="box", mass_properties=STUFF, vertices_B=box_vertices((2.0, 4.0, 6.0)))


def test_a_uniform_body_has_the_mass_properties_of_its_shape() -> None:
    size = (0.15, 0.09, 0.05)
    for made, mass, shape in (
        (Body.box(size, mass=0.4), inertia.box(size, mass=0.4), box(size)),
        (Body.sphere(0.1, 0.4), inertia.sphere(0.1, mass=0.4), sphere(0.1)),
        (Body.cylinder(0.1, 0.3, 0.4), inertia.cylinder(0.1, 0.3, mass=0.4), cylinder(0.1, 0.3)),
        (Body.capsule(0.1, 0.3, 0.4), inertia.capsule(0.1, 0.3, mass=0.4), capsule(0.1, 0.3)),
    ):
        assert made.mass_properties.to_dict() == mass.mass_properties.to_dict()
        assert made.shape.to_dict() == shape.to_dict()
        assert not made.p_FB_F.any()
    assert Body.box(size, density=1000.0).mass_properties.mass == pytest.approx(0.675)
    with pytest.raises(InvalidFieldError, match="mass or density must be given, and not both, got neither"):
        Body.box(size)


def test_a_mesh_is_a_body_with_its_frame_where_the_mesh_has_it() -> None:
    """A box whose frame is at a corner, as meshes often are."""
    size = np.array([0.2, 0.1, 0.4])
    corners = box_vertices(size) + size / 2.0
    triangles = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    triangles += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    made = Body.from_mesh(corners, triangles, mass=3.0, name="crate")
    np.testing.assert_allclose(made.p_FB_F, size / 2.0)
    np.testing.assert_allclose(made.mass_properties.I_B, Body.box(size, 3.0).mass_properties.I_B, atol=1e-15)
    np.testing.assert_allclose(sorted(made.vertices_B.tolist()), sorted(box_vertices(size).tolist()))


def surface(name: str, point: tuple[float, float, float], normal: tuple[float, float, float]) -> Surface:
    return Surface(
        name=name, p_WS_W=np.array(point), normal_W=np.array(normal), friction=0.5, restitution=0.25
    )


FLOOR = surface("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
WALL = surface("wall", (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))


def at(p: tuple[float, float, float], q: np.ndarray | None = None) -> BodyState:
    upright = np.array([0.0, 0.0, 0.0, 1.0]) if q is None else q
    return BodyState(p_WB_W=np.array(p), q_WB=upright)


def test_a_face_flush_on_the_floor_touches_with_its_four_corners() -> None:
    contacts = find_contacts(BOX, at((5.0, 0.0, 3.0)), World(surfaces=(FLOOR,)))
    assert len(contacts) == 4
    assert {tuple(point) for point in contacts.p_WC_W.tolist()} == {
        (x, y, 0.0) for x in (4.0, 6.0) for y in (-2.0, 2.0)
    }
    assert contacts.surfaces == ("floor",) * 4
    assert contacts.frictions.tolist() == [0.5] * 4
    assert contacts.restitutions.tolist() == [0.25] * 4
    np.testing.assert_array_equal(contacts.normals_W, [[0.0, 0.0, 1.0]] * 4)


def test_edges_corners_and_two_surfaces_at_once() -> None:
    on_an_edge = Rotation.from_euler("x", math.atan2(4.0, 6.0)).as_quat()
    assert len(find_contacts(BOX, at((0.0, 0.0, math.sqrt(13.0)), on_an_edge), World(surfaces=(FLOOR,)))) == 2
    in_the_corner = find_contacts(BOX, at((0.0, 0.0, 3.0)), World(surfaces=(FLOOR, WALL)))
    assert in_the_corner.surfaces == ("floor",) * 4 + ("wall",) * 4
    assert len(find_contacts(BOX, at((0.0, 0.0, 30.0)), World(surfaces=(FLOOR,)))) == 0
    assert len(find_contacts(BOX, at((0.0, 0.0, 3.0)), World(surfaces=()))) == 0


def contacts(**changes: object) -> ContactSet:
    good = {
        "p_WC_W": np.zeros((2, 3)),
        "normals_W": np.array([[0.0, 0.0, 1.0]] * 2),
        "frictions": np.array([0.5, 0.0]),
        "restitutions": np.array([0.0, 1.0]),
    }
    return ContactSet(**{**good, **changes})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"normals_W": np.array([[0.0, 0.0, 1.0]])}, r"^normals_W must be .*, got shape \(1, 3\)"),
        ({"surfaces": ("floor",)}, "^surfaces must be .*, got 1 names"),
    ],
)
def test_contacts_that_make_no_sense_are_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(InvalidFieldError, match=words):
        contacts(**changes)


def test_absurd_sizes_are_refused_before_they_are_copied() -> None:
    with pytest.raises(TooLargeError, match=f"at most {MAX_CONTACTS}"):
        contacts(frictions=np.zeros(MAX_CONTACTS + 1))
    with pytest.raises(TooLargeError, match=f"at most {MAX_VERTICES}"):
        Body(name="sponge", mass_properties=STUFF, vertices_B=np.zeros((MAX_VERTICES + 1, 3)))


def test_a_subset_keeps_rows_together() -> None:
    second = contacts(surfaces=("floor", "wall")).subset([1])
    assert (second.surfaces, second.frictions.tolist(), second.restitutions.tolist()) == (
        ("wall",),
        [0.0],
        [1.0],
    )


def test_an_unknown_body_is_refused_with_those_that_are_known() -> None:
    world = World(bodies=(BOX,))
    assert world.body("box") is BOX
    with pytest.raises(UnknownBodyError, match=r"must be one of the known bodies .'box'., got 'cat'"):
        world.body("cat")


def test_bodies_and_surfaces_have_different_names() -> None:
    with pytest.raises(InvalidFieldError, match=r"bodies must be different names, got \['box', 'box'\]"):
        World(bodies=(BOX, BOX))
    with pytest.raises(InvalidFieldError, match=r"surfaces must be different names, got \['wall', 'wall'\]"):
        World(surfaces=(WALL, surface("wall", (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ConvexShape(vertices=[[1e155, 0.0, 0.0]]), r"vertices must be .*, got 1e\+155"),
        (lambda: sphere(radius=1e61), r"radius must be .*, got 1e\+61"),
        (lambda: cylinder(radius=1e61, length=1.0), r"radius must be .*, got 1e\+61"),
        (lambda: cylinder(radius=1.0, length=4e60), r"length must be .*, got 4e\+60"),
        (lambda: box(size=[1.0, 1e61, 1.0]), r"size\[1\] must be .*, got 1e\+61"),
        (lambda: sphere(radius=1.0).moved([0.0, 2e60, 0.0]), r"offset must be .*, got 2e\+60"),
        (lambda: surface("far", (0.0, 0.0, -1e61), (0.0, 0.0, 1.0)), r"p_WS_W must be .*, got 1e\+61"),
        (
            lambda: Body(name="b", mass_properties=STUFF, p_FB_F=[1e61, 0, 0]),
            r"p_FB_F must be .*, got 1e\+61",
        ),
        (lambda: obstacle_of_size(1e61), r"vertices_W must be .*, got 1e\+61"),
    ],
)
def test_lengths_whose_squares_overflow_are_refused_by_name(make: Callable[[], object], words: str) -> None:
    """Searches for a landing square them. With 1e155 m a search met a NaN, which was an internal error."""
    with pytest.raises(InvalidFieldError, match=words):
        make()


def obstacle_of_size(size: float) -> Obstacle:
    corners = [[0.0, 0.0, 0.0], [size, 0.0, 0.0], [0.0, size, 0.0]]
    return Obstacle(name="table", vertices_W=corners, friction=0.5, restitution=0.5)
