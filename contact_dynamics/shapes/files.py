# SPDX-License-Identifier: Apache-2.0
"""Bodies from files: a link of a URDF or an SDF file, and meshes.

Both formats have the same elements. Where URDF has an attribute, SDF has an element with that text.

Not covered: xacro (run it first), SDF's ``relative_to``, and friction and restitution, which belong to
surfaces here.
"""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple
from xml.etree import ElementTree as ET

import numpy as np
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import (
    ConcaveShapeWarning,
    ImplausibleBodyWarning,
    InvalidFieldError,
    frames_to_caller,
)
from contact_dynamics.rigid_body.inertia import MassDistribution
from contact_dynamics.rigid_body.inertia.triangle_mesh import connected_parts
from contact_dynamics.shapes import convex
from contact_dynamics.shapes.concavity import few_parts, warn_if_concave
from contact_dynamics.shapes.convex import MAX_VERTICES, ConvexShape
from contact_dynamics.tolerances import DENSEST, THINNEST
from contact_dynamics.validation import check_unit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from xml.etree.ElementTree import Element

    from contact_dynamics.validation import FloatArray

_MAKERS: Final[dict[str, Callable[..., ConvexShape]]] = {
    "box": convex.box,
    "sphere": convex.sphere,
    "cylinder": convex.cylinder,
    "capsule": convex.capsule,
}
_MOMENTS: Final = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))


class Primitive(NamedTuple):
    """A collision shape of a link."""

    kind: str  # "box", "sphere", "cylinder", "capsule" or "vertices"
    numbers: FloatArray  # what makes it: side lengths, a radius, a radius and a length, or corners (n, 3), m
    position: FloatArray  # (3,), m, where it is in the link's frame
    orientation: FloatArray  # its unit quaternion there, x, y, z, w

    def shape(self) -> ConvexShape:
        """Return it as a shape in the link's frame."""
        shape = (
            convex.polyhedron(self.numbers) if self.kind == "vertices" else _MAKERS[self.kind](*self.numbers)
        )
        return shape.moved(self.position, self.orientation)


class Link(NamedTuple):
    """A link: its name, its mass and shape in its frame, and the collision shapes that make the latter."""

    name: str
    mass: MassDistribution
    shape: ConvexShape
    primitives: list[Primitive]


def read_link(source: str | Path, link: str | None) -> Link:
    """Return a link of a file or of its text; see `Body.from_urdf`."""
    root, folder = _read(source)
    element = _link(root, link)
    name = element.get("name", "")
    mass = _mass(element, f"link {name!r}")
    primitives = [
        primitive
        for collision in element.findall("collision")
        for primitive in _primitives(collision, folder)
    ]
    shape = convex.union([each.shape() for each in primitives])
    warn_if_implausible(f"link {name!r}", mass, shape)
    return Link(name, mass, shape, primitives)


def read_mesh(file: str | Path, scale: Sequence[float] = (1.0, 1.0, 1.0)) -> tuple[FloatArray, FloatArray]:
    """Return the vertices, (n, 3), m, and the triangles, (m, 3), of a mesh in a file."""
    try:
        import trimesh
    except ImportError:
        allowed = "arrays of vertices and triangles, unless trimesh is installed"
        raise InvalidFieldError("file", file, allowed, "pip install trimesh") from None
    try:
        found: Any = trimesh.load(file, force="mesh")
    except (ValueError, OSError, KeyError, NotImplementedError, IndexError) as error:
        raise InvalidFieldError("file", f"{file} ({error})", "a mesh: STL, OBJ, PLY, glTF") from None
    vertices, triangles = np.array(found.vertices, dtype=float), np.array(found.faces)
    if vertices.ndim != 2 or len(vertices) == 0:
        raise InvalidFieldError("file", f"{file} without triangles", "a mesh: STL, OBJ, PLY, glTF")
    factors = np.array(scale, float)
    return vertices * factors, triangles if factors.prod() > 0.0 else triangles[:, ::-1]


def _read(source: str | Path) -> tuple[Element, Path]:
    """Return the root of a description, and the folder to which its files are relative."""
    text, folder = source, Path()
    if isinstance(source, Path) or not source.lstrip().startswith("<"):
        try:
            text, folder = Path(source).read_text(encoding="utf-8"), Path(source).resolve().parent
        except (OSError, UnicodeDecodeError) as error:
            raise InvalidFieldError("source", f"{source} ({error})", "a file that can be read") from None
    try:
        root = ET.fromstring(str(text))  # noqa: S314 (whoever names the file trusts it like a program)
    except ET.ParseError as error:
        raise InvalidFieldError("source", f"XML with an error ({error})", "a URDF or an SDF file") from None
    if root.tag not in {"robot", "sdf", "link", "model"}:
        raise InvalidFieldError("source", f"<{root.tag}>", "<robot> (URDF) or <sdf>")
    return root, folder


def _link(root: Element, name: str | None) -> Element:
    links = [(link.get("name", ""), link) for link in root.iter("link")]
    heavy = [(key, link) for key, link in links if link.find("inertial") is not None]
    if not heavy:
        found = f"links without it: {', '.join(repr(key) for key, _ in links)}" if links else "no <link>"
        raise InvalidFieldError("source", found, "a description in which a link has <inertial>")
    chosen = [link for key, link in heavy if name in {key, None}]
    if len(chosen) == 1:
        return chosen[0]
    found = "none" if name is None else repr(name)
    if name is not None and chosen:
        found += f", which {len(chosen)} of them have"
    elif name in dict(links):
        found += ", which has no <inertial>"
    raise InvalidFieldError(
        "link", found, f"one of those with a mass: {', '.join(repr(key) for key, _ in heavy)}"
    )


def _mass(link: Element, what: str) -> MassDistribution:
    """Return the mass of a link, in its frame."""
    inertial = link.find("inertial")
    inertia = None if inertial is None else inertial.find("inertia")
    if inertial is None or inertia is None:
        raise InvalidFieldError(what, "no <inertia>", "mass and inertia")
    I_B = [[_parsed(_text(inertia, key), f"{key} of {what}", 1)[0] for key in row] for row in _MOMENTS]
    p, q = _pose(inertial)
    mass = inertial.find("mass")
    value = None if mass is None else mass.get("value", mass.text)
    kg = _parsed(value, f"mass of {what}", 1)[0]
    of_mass = MassDistribution(mass=kg, p_FB_F=np.zeros(3), I_B=np.array(I_B))
    return of_mass.placed(p_GF_G=p, q_GF=q)


def _primitives(collision: Element, folder: Path) -> list[Primitive]:
    """Return a collision shape, or the connected parts of a mesh."""
    geometry = collision.find("geometry")
    solid = next(iter(geometry), None) if geometry is not None else None
    if solid is None:
        raise InvalidFieldError("collision", "no <geometry>", "a box, cylinder, sphere, capsule or mesh")
    kind = solid.tag
    if kind == "box":
        numbers = np.array(_numbers(solid, "size", 3))
    elif kind in _MAKERS:
        lengths = ("radius",) if kind == "sphere" else ("radius", "length")
        numbers = np.array([_numbers(solid, length, 1)[0] for length in lengths])
    elif kind == "mesh":
        if solid.find("submesh") is not None:
            raise InvalidFieldError("mesh", "<submesh>", "a file of its own for each part")
        file = _file(_text(solid, "filename") or _text(solid, "uri") or "", folder)
        scale = _parsed(_text(solid, "scale") or "1 1 1", "scale", 3)
        what = f"mesh {file.name}"
        parts = few_parts(what, connected_parts(*read_mesh(file, scale)))
        corners = [_corners(what, vertices) for vertices, _ in parts]
        return [Primitive("vertices", each, *_pose(collision)) for each in corners]
    else:
        raise InvalidFieldError("geometry", f"<{kind}>", "a box, cylinder, sphere, capsule or mesh")
    return [Primitive(kind, numbers, *_pose(collision))]


def _corners(what: str, vertices: FloatArray) -> FloatArray:
    """Return the vertices of a mesh, or of its hull if there are too many. Warn if it is concave."""
    if len(vertices) <= MAX_VERTICES:
        warn_if_concave(what, vertices)
        return vertices
    from scipy.spatial import ConvexHull

    corners: FloatArray = vertices[ConvexHull(vertices).vertices]
    message = f"{what} has {len(vertices)} vertices. Its convex hull is taken"
    warnings.warn(message, ConcaveShapeWarning, stacklevel=frames_to_caller())
    return corners


def _file(name: str, folder: Path) -> Path:
    """Return the path of a mesh that is named by ``package://``, ``model://``, ``file://`` or relatively."""
    scheme, separator, path = name.partition("://")
    if not separator:
        return folder / name
    if scheme == "file":
        return Path(path)
    prefixes = [
        Path(one) / "share" for one in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if one
    ]
    tried = [place / path for place in (folder, *folder.parents, *prefixes)]
    for each in tried:
        if each.exists():
            return each
    raise InvalidFieldError(
        "mesh", name, "a file beside the description, above it, or in a sourced workspace"
    )


def _pose(element: Element) -> tuple[FloatArray, FloatArray]:
    """Return the position, (3,), m, and the unit quaternion x, y, z, w of an element in its link."""
    pose, origin = element.find("pose"), element.find("origin")
    position, turn, quaternion, degrees = "0 0 0", "0 0 0", None, False
    if pose is not None:
        if pose.get("relative_to"):
            raise InvalidFieldError("pose", f"relative_to={pose.get('relative_to')!r}", "none")
        parts = (pose.text or "").split()
        position, turn = " ".join(parts[:3]), " ".join(parts[3:])
        quaternion = turn if pose.get("rotation_format") == "quat_xyzw" else None
        degrees = pose.get("degrees") in {"true", "1"}
    elif origin is not None:
        position, turn = origin.get("xyz", position), origin.get("rpy", turn)
        quaternion = origin.get("quat_xyzw")
        if quaternion is not None and origin.get("rpy") is not None:
            raise InvalidFieldError("origin", "rpy and quat_xyzw", "one of them")
    p = np.array(_parsed(position, "position of a pose", 3))
    if quaternion is None:
        angles = _parsed(turn, "roll, pitch and yaw of a pose", 3)
        return p, Rotation.from_euler("xyz", angles, degrees=degrees).as_quat()
    return p, check_unit("quat_xyzw", _parsed(quaternion, "quat_xyzw", 4), 4)


def _text(element: Element, key: str) -> str | None:
    """Return an attribute, or the text of an element of that name."""
    return element.get(key, element.findtext(key))


def _numbers(element: Element, key: str, count: int) -> list[float]:
    return _parsed(_text(element, key), f"{element.tag} {key}", count)


def _parsed(text: str | None, what: str, count: int) -> list[float]:
    try:
        numbers = [float(part) for part in (text or "").split()]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        allowed = "one number" if count == 1 else f"{count} numbers"
        raise InvalidFieldError(what, "nothing" if text is None else repr(text), allowed)
    return numbers


def warn_if_implausible(what: str, mass: MassDistribution, shape: ConvexShape) -> None:
    """Warn if the mass cannot lie inside the shape: lengths are in mm, or numbers are placeholders."""
    if shape.is_empty:
        return
    low, high = _extent(shape)
    reach = float(np.linalg.norm(np.maximum(high - mass.p_FB_F, mass.p_FB_F - low)))
    volume = float(np.prod(high - low))
    found = []
    if not np.all((low <= mass.p_FB_F) & (mass.p_FB_F <= high)):
        found.append("the centre of mass is outside of the shape")
    elif 0.5 * float(np.trace(mass.I_B)) > mass.mass * reach**2:
        found.append("the inertia is larger than any mass inside the shape has")
    if volume > 0.0 and not THINNEST * volume <= mass.mass <= DENSEST * volume:
        found.append(f"the mass in its bounding box has a density of {mass.mass / volume:.3g} kg/m^3")
    if found:
        message = f"{what}: {' and '.join(found)}. Are lengths in metres, and masses in kg?"
        warnings.warn(message, ImplausibleBodyWarning, stacklevel=frames_to_caller())


def _extent(shape: ConvexShape) -> tuple[FloatArray, FloatArray]:
    """Return the corners, (3,), m, of a shape's bounding box."""
    centers: list[FloatArray] = []
    sizes: list[FloatArray] = []
    for part in shape.convex_parts:
        centers += [part.vertices, *(np.array([rim.center]) for rim in part.rims)]
        sizes.append(np.full_like(part.vertices, part.rounding))
        for rim in part.rims:
            across = rim.radius * np.sqrt(np.maximum(1.0 - np.square([rim.axis]), 0.0))
            sizes.append(across + part.rounding)
    center, size = np.concatenate(centers), np.concatenate(sizes)
    return (center - size).min(axis=0), (center + size).max(axis=0)
