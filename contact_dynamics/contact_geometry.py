"""Contacts found from geometry: the vertices of a convex body that touch the world's flats at a pose.

A face or an edge that lies flush gives its vertices, which are its extreme points: they carry every force
that the whole face or edge can. Not covered: smooth shapes, and edges that cross edges.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact import ContactSet
from contact_dynamics.tolerances import DISTANCE_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics.world import Body, Surface


def find_contacts(
    body: Body,
    state: BodyState,
    surfaces: Sequence[Surface],
    *,
    distance_tolerance: float = DISTANCE_TOLERANCE,
) -> ContactSet:
    """Return the contacts of a body's vertices with the surfaces, in the order of surfaces, then vertices.

    A vertex touches where its height above the surface is at most ``distance_tolerance`` (m); one below the
    surface touches, since measured poses penetrate by their noise. The set may be empty.
    """
    points = state.p_WB_W + body.vertices_B @ state.R_WB.T
    touching = [np.flatnonzero(surface.gaps(points) <= distance_tolerance) for surface in surfaces]
    counts = [len(indices) for indices in touching]
    return ContactSet(
        p_WC_W=np.concatenate([np.zeros((0, 3)), *(points[indices] for indices in touching)]),
        normals_W=np.repeat(np.array([s.normal_W for s in surfaces]).reshape(-1, 3), counts, axis=0),
        frictions=np.repeat(np.array([s.friction for s in surfaces]), counts),
        restitutions=np.repeat(np.array([s.restitution for s in surfaces]), counts),
        surfaces=tuple(s.name for s, count in zip(surfaces, counts, strict=True) for _ in range(count)),
    )
