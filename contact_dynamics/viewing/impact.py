"""A predicted impact in space: contact point, normal, friction cone, impulse, and velocities before and after."""

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
    from contact_dynamics.contact import ContactSet
    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.shape import Shape

ARROW_LENGTH: Final = 0.9
"""Length of the longest arrow of a kind, relative to the size of the body; the labels say how much it stands for."""

CONE_HEIGHT: Final = 0.35
"""Relative to the size of the body."""

_CONE_FACETS: Final = 32
_ARROW_WIDTH: Final = 0.012  # relative to the size of the body
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


def draw_impact(recording: rr.RecordingStream, body_name: str, shape: Shape, picture: ImpactPicture) -> None:
    """Draw an impact in the scene, at the recording's current time."""
    path = impact_entity(body_name)
    struck = np.linalg.norm(picture.impulses_W, axis=1) > 0.0
    points = picture.contacts.p_WC_W[struck]
    normals = picture.contacts.normals_W[struck]
    _draw_arrows(recording, f"{path}/impulse", points, picture.impulses_W[struck], "N s", palette.IMPACT, size=shape.size)
    velocities = np.array([picture.state.v_WB_W, picture.v_after_W])
    _draw_arrows(
        recording,
        f"{path}/velocity",
        np.tile(picture.state.p_WB_W, (2, 1)),
        velocities,
        "m/s",
        np.array([palette.BEFORE_IMPACT, palette.IMPACT], dtype=np.uint8),
        size=shape.size,
    )
    recording.log(
        f"{path}/normal",
        rr.Arrows3D(
            origins=points,
            vectors=normals * (CONE_HEIGHT * shape.size),
            colors=palette.NORMAL,
            radii=0.5 * _ARROW_WIDTH * shape.size,
        ),
    )
    recording.log(
        f"{path}/point", rr.Points3D(points, radii=_POINT_SIZE * shape.size, colors=palette.IMPACT)
    )
    draw_cones(recording, f"{path}/cone", points, normals, picture.contacts.frictions[struck], height=CONE_HEIGHT * shape.size)
    edges = outline(shape, picture.state.p_WB_W, picture.state.q_WB)
    recording.log(
        f"{path}/body",
        rr.LineStrips3D(edges, colors=palette.translucent(palette.IMPACT, 0.7), radii=_OUTLINE_WIDTH),
    )


def draw_cones(
    recording: rr.RecordingStream,
    path: str,
    points_W: FloatArray,
    normals_W: FloatArray,
    frictions: FloatArray,
    *,
    height: float,
) -> None:
    """Draw friction cones, each as long along its slope as ``height``, m, so that great friction stays in the picture."""
    angles = np.linspace(0.0, 2.0 * math.pi, _CONE_FACETS, endpoint=False)
    vertices: list[FloatArray] = []
    triangles: list[tuple[int, int, int]] = []
    for p_W, normal_W, friction in zip(points_W, normals_W, frictions.tolist(), strict=True):
        if friction == 0.0:
            continue
        u_W, v_W = tangents(normal_W)
        half_angle = math.atan(friction)
        around = np.outer(np.cos(angles), u_W) + np.outer(np.sin(angles), v_W)
        rim = p_W + height * (math.cos(half_angle) * normal_W + math.sin(half_angle) * around)
        first = sum(len(part) for part in vertices)
        vertices.append(np.vstack([p_W, rim]))
        triangles += [
            (first, first + 1 + i, first + 1 + (i + 1) % _CONE_FACETS) for i in range(_CONE_FACETS)
        ]
    if not triangles:
        recording.log(path, rr.Clear(recursive=False))
        return
    recording.log(
        path,
        rr.Mesh3D(
            vertex_positions=np.vstack(vertices), triangle_indices=triangles, albedo_factor=palette.FRICTION_CONE
        ),
    )


def _draw_arrows(
    recording: rr.RecordingStream,
    path: str,
    origins: FloatArray,
    vectors: FloatArray,
    unit: str,
    colors: palette.Color | FloatArray,
    *,
    size: float,
) -> None:
    lengths = np.linalg.norm(vectors, axis=1)
    longest = float(lengths.max(initial=0.0))
    scale = ARROW_LENGTH * size / longest if longest > 0.0 else 0.0
    recording.log(
        path,
        rr.Arrows3D(
            origins=origins,
            vectors=vectors * scale,
            colors=colors,
            radii=_ARROW_WIDTH * size,
            labels=[f"{length:.3g} {unit}" for length in lengths.tolist()],
            show_labels=True,
        ),
    )
