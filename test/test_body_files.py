# SPDX-License-Identifier: Apache-2.0
"""Bodies from files: URDF, SDF and meshes."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Surface, World, next_landing, shapes
from contact_dynamics.errors import ConcaveShapeWarning, ImplausibleBodyWarning, InvalidFieldError

SIZE = (0.15, 0.09, 0.05)
UNIFORM = Body.box(SIZE, 0.4)
MOMENTS = dict(zip(("ixx", "iyy", "izz"), np.diag(UNIFORM.mass_properties.I_B).tolist(), strict=True))
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.4, restitution=0.3)
STATE = BodyState(p_WB_W=[0, 0, 0.5], q_WB=[0.2, 0.1, 0.3, 0.927361850], v_WB_W=[0.3, 0, 0], w_WB_W=[2, 3, 1])


def urdf(
    collisions: str, *, moments: dict[str, float] = MOMENTS, origin: str = '<origin xyz="0 0 0"/>'
) -> str:
    tensor = " ".join(
        f'{key}="{value!r}"' for key, value in {**moments, "ixy": 0, "ixz": 0, "iyz": 0}.items()
    )
    inertial = f'<inertial><mass value="0.4"/>{origin}<inertia {tensor}/></inertial>'
    return f'<robot name="r"><link name="base"/><link name="brick">{inertial}{collisions}</link></robot>'


def collision(geometry: str, origin: str = "") -> str:
    return f"<collision>{origin}<geometry>{geometry}</geometry></collision>"


BOX = collision('<box size="0.15 0.09 0.05"/>')


def lands(body: Body) -> float:
    found = next_landing(body, STATE, World(surfaces=(FLOOR,)))
    assert found is not None
    return found.seconds


@pytest.mark.parametrize("rpy", [(0.0, 0.0, 0.0), (0.3, -0.4, 1.1)])
def test_a_link_is_the_body_that_its_elements_describe(
    rpy: tuple[float, float, float], tmp_path: Path
) -> None:
    """The link's frame is turned against the box's by roll, pitch and yaw about fixed axes."""
    r, p, y = rpy
    turn = (
        np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
        @ np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
        @ np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    )
    origin = f'<origin xyz="0.1 0.2 0.3" rpy="{r} {p} {y}"/>'
    file = tmp_path / "brick.urdf"
    file.write_text(urdf(collision('<box size="0.15 0.09 0.05"/>', origin), origin=origin), encoding="utf-8")
    for body in (Body.from_urdf(file), Body.from_urdf(str(file), "brick"), Body.from_urdf(file.read_text())):
        assert body.name == "brick"
        assert body.p_FB_F == pytest.approx([0.1, 0.2, 0.3], abs=1e-15)
        I_B = turn @ UNIFORM.mass_properties.I_B @ turn.T
        moments = body.mass_properties.I_B
        assert moments == pytest.approx(I_B, abs=1e-17)  # 14 digits of the largest moment
        corners = UNIFORM.vertices_B @ turn.T
        assert body.vertices_B == pytest.approx(corners, abs=1e-15)


def test_sdf_has_the_same_elements_with_texts() -> None:
    moments = "".join(f"<{key}>{value!r}</{key}>" for key, value in MOMENTS.items())
    none = "<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz>"
    sdf = (
        '<sdf version="1.9"><world name="w"><model name="m"><link name="brick"><pose>0 0 1 0 0 0</pose>'
        f"<inertial><mass>0.4</mass><inertia>{moments}{none}</inertia></inertial>"
        "<collision name='c'><geometry><box><size>0.15 0.09 0.05</size></box></geometry></collision>"
        "</link></model></world></sdf>"
    )
    assert lands(Body.from_sdf(sdf, name="renamed")) == lands(Body.from_urdf(urdf(BOX))) == lands(UNIFORM)
    assert Body.from_sdf(sdf, name="renamed").name == "renamed"


def test_rotations_may_be_quaternions_or_degrees() -> None:
    """URDF 1.2 has quaternions, and SDF 1.9 quaternions and degrees: here a quarter turn about z."""
    half, quarter = np.sqrt(0.5), 0.5 * np.pi
    for turn in (
        f'<origin rpy="0 0 {quarter}"/>',
        f'<origin quat_xyzw="0 0 {half} {half}"/>',
        f"<pose>0 0 0 0 0 {quarter}</pose>",
        '<pose degrees="true">0 0 0 0 0 90</pose>',
        f'<pose rotation_format="quat_xyzw">0 0 0 0 0 {half} {half}</pose>',
    ):
        text = urdf(collision('<box size="0.15 0.09 0.05"/>', turn), origin=turn)
        body = Body.from_urdf(text)
        moments = np.diag(body.mass_properties.I_B)[[1, 0, 2]]
        assert moments == pytest.approx(list(MOMENTS.values()), rel=1e-12)
        assert body.vertices_B.max(axis=0) == pytest.approx([0.045, 0.075, 0.025], rel=1e-12)


@pytest.mark.parametrize(
    ("geometry", "shape"),
    [
        ('<cylinder radius="0.03" length="0.1"/>', shapes.cylinder(0.03, 0.1)),
        ('<capsule radius="0.03" length="0.1"/>', shapes.capsule(0.03, 0.1)),
        ('<sphere radius="0.05"/>', shapes.sphere(0.05)),
    ],
)
def test_round_shapes(geometry: str, shape: shapes.ConvexShape) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleBodyWarning)
        found = Body.from_urdf(urdf(collision(geometry))).shape
    assert (found.rims, found.rounding) == (shape.rims, shape.rounding)
    assert np.array_equal(found.vertices, shape.vertices)


def test_meshes_are_read_beside_the_description(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    (tmp_path / "parts" / "meshes").mkdir(parents=True)
    file = tmp_path / "parts" / "meshes" / "brick.stl"
    trimesh.creation.box(extents=[1e3 * side for side in SIZE]).export(file)  # mm
    for name in ("meshes/brick.stl", "package://parts/meshes/brick.stl", f"file://{file}"):
        description = tmp_path / "parts" / "brick.urdf"
        description.write_text(
            urdf(collision(f'<mesh filename="{name}" scale="0.001 0.001 0.001"/>')), encoding="utf-8"
        )
        # STL has single precision
        assert lands(Body.from_urdf(description)) == pytest.approx(lands(UNIFORM), rel=1e-7)
    whole = Body.from_mesh(file, mass=0.4, scale=1e-3)
    moments = whole.mass_properties.I_B
    assert moments == pytest.approx(UNIFORM.mass_properties.I_B, rel=1e-6, abs=1e-9)
    description.write_text(urdf(collision('<mesh filename="brick.stl"/>')), encoding="utf-8")
    with pytest.raises(
        InvalidFieldError, match=r"file must be a mesh: STL, OBJ, PLY, glTF, got .*brick\.stl"
    ):
        Body.from_urdf(description)
    with pytest.warns(ImplausibleBodyWarning, match=r"mesh .*brick\.stl: .* density of 5\.93e-07 kg/m\^3"):
        Body.from_mesh(file, mass=0.4)
    with pytest.raises(InvalidFieldError, match="triangles must be None"):
        Body.from_mesh(file, [[0, 1, 2]], mass=1.0)


def test_what_no_mass_inside_the_shape_has_is_a_warning() -> None:
    with pytest.warns(
        ImplausibleBodyWarning, match="the inertia is larger than any mass inside the shape has"
    ):
        Body.from_urdf(urdf(BOX, moments=dict.fromkeys(MOMENTS, 1.0)))
    with pytest.warns(ImplausibleBodyWarning, match="the centre of mass is outside of the shape"):
        Body.from_urdf(urdf(BOX, origin='<origin xyz="0 0 0.03"/>'))
    with pytest.warns(ImplausibleBodyWarning, match=r"density of 5\.93e-07 kg/m\^3. Are lengths in metres"):
        Body.from_urdf(urdf(collision('<box size="150 90 50"/>')))


def test_several_collision_shapes_are_the_parts_of_a_union() -> None:
    halves = [
        collision('<box size="0.075 0.09 0.05"/>', f'<origin xyz="{x} 0 0"/>') for x in (-0.0375, 0.0375)
    ]
    body = Body.from_urdf(urdf("".join(halves)))
    assert lands(body) == pytest.approx(lands(UNIFORM), rel=1e-12)
    assert [part.vertices[:, 0].min() for part in body.shape.parts] == [-0.075, 0.0]
    notched = Body.from_urdf(urdf(BOX + collision('<cylinder radius="0.01" length="0.05"/>')))
    assert [len(part.rims) for part in notched.shape.parts] == [0, 2]
    caster = Body.from_urdf(urdf(BOX + collision('<sphere radius="0.02"/>', '<origin xyz="0 0 -0.02"/>')))
    assert [part.rounding for part in caster.shape.parts] == [0.0, 0.02]
    dropped = next_landing(
        caster, BodyState(p_WB_W=[0, 0, 0.14], q_WB=[0, 0, 0, 1]), World(surfaces=(FLOOR,))
    )
    assert dropped is not None
    assert dropped.seconds == pytest.approx(np.sqrt(2 * 0.1 / 9.80665), rel=1e-12)


def box_mesh(
    size: tuple[float, ...], place: tuple[float, ...], first: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """The vertices and triangles of a box, the latter counted from a first vertex."""
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.box(extents=size)
    return np.array(mesh.vertices) + place, np.array(mesh.faces) + first


def test_the_connected_parts_of_a_mesh_are_convex_parts(tmp_path: Path) -> None:
    """Two boxes side by side, in arrays, in a file, and in a link of a file."""
    trimesh = pytest.importorskip("trimesh")
    one, other = box_mesh((0.1, 0.1, 0.1), (0, 0, 0)), box_mesh((0.1, 0.1, 0.3), (0.3, 0, 0.1), 8)
    vertices, triangles = (np.concatenate(both) for both in zip(one, other, strict=True))
    file = tmp_path / "two.stl"
    trimesh.Trimesh(vertices, triangles).export(file)
    link = urdf(collision(f'<mesh filename="{file}"/>'))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleBodyWarning)
        bodies = [
            Body.from_mesh(vertices, triangles, 0.4),
            Body.from_mesh(file, mass=0.4),
            Body.from_urdf(link),
        ]
    for body in bodies:
        lowest = sorted((part.vertices.min(axis=0) + body.p_FB_F).tolist() for part in body.shape.parts)
        np.testing.assert_allclose(lowest, [[-0.05] * 3, [0.25, -0.05, -0.05]], atol=1e-8)  # single precision
    volumes, centers = np.array([0.001, 0.003]), np.array([[0, 0, 0], [0.3, 0, 0.1]])
    np.testing.assert_allclose(bodies[0].p_FB_F, volumes @ centers / 0.004, atol=1e-15)


def test_a_cavity_of_a_mesh_changes_its_mass_and_not_its_contacts() -> None:
    outer, cavity = box_mesh(SIZE, (0, 0, 0)), box_mesh((0.1, 0.05, 0.02), (0, 0, 0), 8)
    hollow = Body.from_mesh(
        np.concatenate([outer[0], cavity[0]]), np.concatenate([outer[1], cavity[1][:, ::-1]]), density=1000
    )
    assert hollow.mass_properties.mass == pytest.approx(1000 * (np.prod(SIZE) - 0.1 * 0.05 * 0.02), rel=1e-12)
    assert sorted(hollow.vertices_B.tolist()) == sorted(UNIFORM.vertices_B.tolist())


def test_a_flat_part_of_a_mesh_has_no_mass_and_touches() -> None:
    """A triangle with two sides stands out below a box."""
    vertices, triangles = box_mesh(SIZE, (0, 0, 0))
    fin = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.0, -0.1]]
    both = np.concatenate([triangles, [[8, 9, 10], [8, 10, 9]]])
    finned = Body.from_mesh(np.concatenate([vertices, fin]), both, 0.4)
    np.testing.assert_allclose(finned.mass_properties.I_B, UNIFORM.mass_properties.I_B, atol=1e-17)
    assert [len(part.vertices) for part in finned.shape.parts] == [8, 3]
    assert finned.vertices_B[:, 2].min() == -0.1


def test_a_part_of_a_mesh_that_is_not_convex_is_a_warning() -> None:
    """A box with a dent, beside a box; and more parts than a body may have, of which the hull is taken."""
    dented, box = box_mesh((0.2, 0.2, 0.2), (0, 0, 0)), box_mesh((0.1, 0.1, 0.1), (1, 0, 0), 9)
    top = [row for row in dented[1].tolist() if (dented[0][row][:, 2] > 0).all()]
    rest = [row for row in dented[1].tolist() if row not in top]
    ring = [1, 5, 7, 3] if 1 in np.ravel(top) else sorted({*np.ravel(top).tolist()})
    fan = [[a, b, 8] for a, b in zip(ring, ring[1:] + ring[:1], strict=True)]
    vertices = np.concatenate([dented[0], [[0, 0, 0.05]], box[0]])
    corners = vertices[fan]
    upward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0
    fan = [row if up else row[::-1] for row, up in zip(fan, upward.tolist(), strict=True)]
    triangles = np.concatenate([rest, fan, box[1]])
    with pytest.warns(
        ConcaveShapeWarning, match=r"body 'mesh 0': 1 of 9 corners .* convex parts \(shapes.union"
    ):
        body = Body.from_mesh(vertices, triangles, 1.0)
    assert len(body.shape.parts) == 2
    many = [box_mesh((0.1, 0.1, 0.1), (0.2 * i, 0, 0), 8 * i) for i in range(101)]
    vertices, triangles = (np.concatenate(each) for each in zip(*many, strict=True))
    with pytest.warns(ConcaveShapeWarning, match="mesh 'mesh' has 101 parts, more than 100"):
        assert Body.from_mesh(vertices, triangles, 1.0).shape.parts == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (urdf(collision('<box size="0.15 0.05"/>')), "box size must be 3 numbers, got '0.15 0.05'"),
        (urdf(BOX).replace('value="0.4"', 'value="x"'), "mass of link 'brick' must be one number, got 'x'"),
        (urdf(BOX).replace('ixy="0" ', ""), "ixy of link 'brick' must be one number, got nothing"),
        (urdf(BOX).replace('value="0.4"', 'value="-1"'), "mass must be .*> 0"),
        (urdf(BOX, moments={**MOMENTS, "izz": 1.0}), "I1 \\+ I2 >= I3"),
        (urdf(collision('<torus size="1"/>')), "geometry must be a box, .*, got <torus>"),
        (
            urdf(collision("<mesh><uri>no.stl</uri><submesh><name>lid</name></submesh></mesh>")),
            "mesh must be a file of its own for each part, got <submesh>",
        ),
        (urdf(collision('<mesh filename="no.stl"/>')), "file must be a mesh: STL, .*no.stl"),
        (urdf(collision('<mesh filename="package://no/a.stl"/>')), "mesh must be a file beside"),
        (
            urdf(collision('<box size="1 1 1"/>', '<origin quat_xyzw="0 0 0 2"/>')),
            "quat_xyzw must be a unit vector",
        ),
        (
            urdf(collision('<box size="1 1 1"/>', '<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>')),
            "origin must be one of them, got rpy and quat_xyzw",
        ),
        ("<robot/>", "source must be a description in which a link has <inertial>, got no <link>"),
        (
            '<robot><link name="base"/><link name="arm"/></robot>',
            "source must be .* a link has <inertial>, got links without it: 'base', 'arm'",
        ),
        (
            urdf(BOX).replace("brick", "a") + "x",
            "source must be a URDF or an SDF file, got XML with an error",
        ),
        ("no_file.urdf", "source must be a file that can be read, got no_file.urdf"),
        ("<html/>", r"source must be <robot> \(URDF\) or <sdf>, got <html>"),
    ],
)
def test_errors_name_the_element(text: str, message: str) -> None:
    pytest.importorskip("trimesh")
    with pytest.raises(InvalidFieldError, match=message):
        Body.from_urdf(text)


def test_the_link_is_named_where_there_are_several() -> None:
    two = urdf(BOX).replace("</robot>", '<link name="other"><inertial/></link></robot>')
    with pytest.raises(InvalidFieldError, match="'brick', 'other'"):
        Body.from_urdf(two)
    with pytest.raises(InvalidFieldError, match="'base', which has no <inertial>"):
        Body.from_urdf(two, "base")
    with pytest.raises(InvalidFieldError, match="no <inertia>"):
        Body.from_urdf(two, "other")
    assert Body.from_urdf(two, "brick").name == "brick"


def test_a_name_of_several_links_is_an_error() -> None:
    """As in a world of several models that all name their link so."""
    two = urdf(BOX).replace("</robot>", "") + urdf(BOX).partition(">")[2].replace('"0.4"', '"0.7"')
    for name, found in (("brick", "'brick', which 2 of them have"), (None, "none")):
        with pytest.raises(InvalidFieldError, match=f"'brick', 'brick', got {found}"):
            Body.from_urdf(two, name)
