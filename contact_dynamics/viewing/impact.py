"""A predicted impact in the scene: contact, normal, friction cone, impulse, velocities before and after."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.viewing import palette
from contact_dynamics.viewing.entities import impact_entity
from contact_dynamics.viewing.scene import tangents
from contact_dynamics.viewing.trajectory import outline

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.contact import ContactSet
    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.shape import Shape

ARROW_LENGTH: Final = 1.1
"""Length of the longest arrow of a kind, relative to the body's size; labels say how much it stands for."""

RECENT: Final = ("body", "impulse")
"""What stays in view beside what comes after it."""

CONE_HEIGHT: Final = 0.35
"""Relative to the size of the body."""

_CONE_FACETS: Final = 32
_ARROW_WIDTH: Final = 0.016  # relative to the size of the body
_POINT_SIZE: Final = 0.02  # likewise
_OUTLINE_WIDTH: Final = -1.2  # negative: points of the screen


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImpactPicture:
    """What an impact's picture is made of; impulses act on the body."""

    state: BodyState  # just before
    v_after_W: FloatArray  # (3,), m/s, of the centre of mass just after, world axes
    contacts: ContactSet  # n contacts
    impulses_W: FloatArray  # (n, 3), N s, world axes
    path_W: FloatArray  # (k, 3), N s, vertices of the accumulated impulse, world axes
    path_events: tuple[int, ...]  # (k,), what each vertex is, as `contact_dynamics.impact.PathEvent`
    path_contacts: tuple[int, ...]  # (k,), contact that each vertex belongs to
    plane_normal_W: FloatArray | None  # (3,), unit, plane of motion, world axes; none in space

    @property
    def main_contact(self) -> int:
        """Return the contact with the largest impulse."""
        return int(np.linalg.norm(self.impulses_W, axis=1).argmax())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Arrows:
    """Arrows of one unit, drawn to a scale of their own."""

    origins: FloatArray  # (n, 3), m, world
    vectors: FloatArray  # (n, 3), in the unit, world axes
    unit: str
    colors: tuple[palette.Color, ...]  # (n,)

    def drawn(self, size: float) -> rr.Arrows3D:
        """Return the arrows, the longest of which suits a body of that size, m."""
        return rr.Arrows3D(
            origins=self.origins,
            vectors=self.tips(size) - self.origins,
            colors=self._colors(),
            radii=_ARROW_WIDTH * size,
        )

    def labels(self, places: FloatArray) -> rr.Points3D:
        """Return how much each stands for, at places, (n, 3), m, world."""
        lengths = np.linalg.norm(self.vectors, axis=1)
        return rr.Points3D(
            places,
            colors=self._colors(),
            radii=0.0,
            labels=[f"{length:.3g} {self.unit}" for length in lengths.tolist()],
            show_labels=True,
        )

    def tips(self, size: float) -> FloatArray:
        """Return where the arrows end, (n, 3), m, world, for a body of that size, m."""
        longest = float(np.linalg.norm(self.vectors, axis=1).max(initial=0.0))
        scale = ARROW_LENGTH * size / longest if longest > 0.0 else 0.0
        return self.origins + self.vectors * scale

    def _colors(self) -> NDArray[np.uint8]:
        return np.array(self.colors, dtype=np.uint8).reshape(-1, 4)


def draw_impact(recording: rr.RecordingStream, body_name: str, shape: Shape, picture: ImpactPicture) -> None:
    """Draw an impact in the scene, at the recording's current time."""
    path, size = impact_entity(body_name), shape.size
    struck = np.linalg.norm(picture.impulses_W, axis=1) > 0.0
    points, normals = picture.contacts.p_WC_W[struck], picture.contacts.normals_W[struck]
    impulses = _Arrows(
        origins=points,
        vectors=picture.impulses_W[struck],
        unit="N s",
        colors=(palette.IMPACT,) * len(points),
    )
    velocities = _Arrows(
        origins=np.tile(picture.state.p_WB_W, (2, 1)),
        vectors=np.array([picture.state.v_WB_W, picture.v_after_W]),
        unit="m/s",
        colors=(palette.BEFORE_IMPACT, palette.AFTER_IMPACT),
    )
    recording.log(f"{path}/impulse", impulses.drawn(size))
    recording.log(f"{path}/impulse_label", impulses.labels(impulses.origins))
    recording.log(f"{path}/velocity", velocities.drawn(size))
    recording.log(f"{path}/velocity_label", velocities.labels(velocities.tips(size)))
    height = CONE_HEIGHT * size
    width = 0.5 * _ARROW_WIDTH * size
    arrows = rr.Arrows3D(origins=points, vectors=normals * height, colors=palette.NORMAL, radii=width)
    recording.log(f"{path}/normal", arrows)
    spheres = rr.Points3D(points, radii=_POINT_SIZE * size, colors=palette.IMPACT)
    recording.log(f"{path}/point", spheres)
    cones = friction_cones(points, normals, picture.contacts.frictions[struck], height=height)
    recording.log(f"{path}/cone", rr.Clear(recursive=False) if cones is None else cones)
    edges = list(outline(shape, picture.state.p_WB_W, picture.state.q_WB))
    body = rr.LineStrips3D(edges, colors=palette.translucent(palette.IMPACT, 0.7), radii=_OUTLINE_WIDTH)
    recording.log(f"{path}/body", body)


def friction_cones(
    points_W: FloatArray, normals_W: FloatArray, frictions: FloatArray, *, height: float
) -> rr.Mesh3D | None:
    """Return friction cones at points, as long along their slope as ``height``, m; None without friction."""
    angles = np.linspace(0.0, 2.0 * math.pi, _CONE_FACETS, endpoint=False)
    rim_index = 1 + np.arange(_CONE_FACETS)
    facets = np.stack([np.zeros_like(rim_index), rim_index, np.roll(rim_index, -1)], axis=1)
    vertices: list[FloatArray] = []
    triangles: list[NDArray[np.int64]] = []
    for p_W, normal_W, friction in zip(points_W, normals_W, frictions.tolist(), strict=True):
        if friction == 0.0:
            continue
        u_W, v_W = tangents(normal_W)
        half_angle = math.atan(friction)
        around = np.outer(np.cos(angles), u_W) + np.outer(np.sin(angles), v_W)
        rim = p_W + height * (math.cos(half_angle) * normal_W + math.sin(half_angle) * around)
        triangles.append(facets + len(vertices) * (1 + _CONE_FACETS))
        vertices.append(np.vstack([p_W, rim]))
    if not vertices:
        return None
    return rr.Mesh3D(
        vertex_positions=np.vstack(vertices),
        triangle_indices=np.vstack(triangles),
        albedo_factor=palette.FRICTION_CONE,
    )
