"""The applied wrenches in space that can bring letters about: what motions need, less what contacts give.

They are the positive sums of generators. Centripetal terms add a seventh coordinate, in which a wrench has
the height one. A wrench is (force, torque / length) / mass, in the units of a case's accelerations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes.spatial_cone import cone_of, null_space
from contact_dynamics.tolerances import ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.spatial_case import SpatialCase
    from contact_dynamics.contact_modes.spatial_search import Search
    from contact_dynamics.validation import FloatArray


def wrench_generators(
    case: SpatialCase, search: Search, letters: str, acting: Sequence[FloatArray], metric: FloatArray
) -> FloatArray:
    """Return generators, (k, 7), of the wrenches that letters allow.

    Args:
        case: The body with its contacts.
        search: Of that case.
        letters: For each touching contact s (separates), f (sticks) or c (stays).
        acting: The force edges, (j, 3), of each touching contact.
        metric: (6,), m, by which a wrench is divided: ones, then the length that torques are divided by.
    """
    motion = case.motion
    zero, positive = [np.zeros((0, 7))], [np.zeros((0, 7))]
    for contact, letter in zip(search.touching, letters, strict=True):
        rows = contact.point if letter == "f" else (contact.normal @ contact.point)[None, :]
        (positive if letter == "s" else zero).append(rows)
    free = null_space(_unit(np.vstack(zero)))  # (7, k)
    inside = cone_of(_unit(np.vstack([*positive, np.eye(1, 7, 6)]) @ free))
    motions = np.vstack([inside.rays, inside.lines, -inside.lines]) @ free.T
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = np.eye(3) * motion.mass
    inertia[3:, 3:] = motion.inertia
    needs = motions[:, :6] / motion.lengths @ inertia / metric / motion.mass
    given = [np.zeros((0, 6))]
    for i, edges in zip(case.touching.tolist(), acting, strict=True):
        given.append(-(edges @ motion.points[3 * i : 3 * i + 3]) / metric)
    forces = np.vstack(given)
    return np.vstack(
        [np.column_stack([needs, motions[:, 6]]), np.column_stack([forces, np.zeros(len(forces))])]
    )


def _unit(rows: FloatArray) -> FloatArray:
    sizes = np.linalg.norm(rows, axis=1)
    found: FloatArray = rows[sizes > ROW_TOLERANCE] / sizes[sizes > ROW_TOLERANCE, None]
    return found
