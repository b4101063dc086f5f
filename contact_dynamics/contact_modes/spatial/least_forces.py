"""The contact forces that the answer shows for a mode in space, and whether they oppose the sliding.

Many forces may bring about the same motion, as under four feet. The answer shows those of least sum of
squares if every contact's friction pyramid allows them. Otherwise it shows those with the fewest edges that
the search found.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.numerics.linear_spaces import row_space
from contact_dynamics.numerics.vectors import cross_of_two
from contact_dynamics.tolerances import ON_PYRAMIDS_SIDE, ROW_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray


def least_forces(of_forces: FloatArray, forces: FloatArray, edges: Sequence[FloatArray]) -> FloatArray:
    """Return forces, (n, 3), that cause the same motion, of least sum of squares if the edges allow that.

    Args:
        of_forces: (6, 3 n), the motion that unit forces cause.
        forces: (n, 3), forces that the edges allow.
        edges: The edges, (k, 3), that may act at each contact, in their order around its normal.
    """
    blocks = [row_space(of_contact) for of_contact in edges]
    basis = np.zeros((forces.size, sum(len(block) for block in blocks)))
    at = 0
    for i, block in enumerate(blocks):
        basis[3 * i : 3 * i + 3, at : at + len(block)] = block.T
        at += len(block)
    causes = of_forces @ basis
    found = basis @ np.linalg.lstsq(causes, of_forces @ forces.ravel(), rcond=ROW_TOLERANCE)[0]
    least: FloatArray = found.reshape(-1, 3)
    slack = ON_PYRAMIDS_SIDE * float(np.abs(forces).max(initial=0.0))
    allowed = all(_holds(of_contact, force, slack) for of_contact, force in zip(edges, least, strict=True))
    return least if allowed else forces


def misdirection(forces: FloatArray, directions: FloatArray, normals: FloatArray) -> float:
    """Return the largest angle, rad, between friction and the way against sliding.

    Args:
        forces: (n, 3), N.
        directions: (n, 3), unit, the directions in which contacts slide; zero where they do not slide.
        normals: (n, 3), unit.
    """
    largest = 0.0
    slack = ON_PYRAMIDS_SIDE * float(np.abs(forces).max(initial=0.0))
    for force, way, normal in zip(forces, directions, normals, strict=True):
        friction = force - (force @ normal) * normal
        if np.any(way) and float(np.linalg.norm(friction)) > slack:
            across = float(np.linalg.norm(cross_of_two(friction, way)))
            largest = max(largest, math.atan2(across, -float(friction @ way)))
    return largest


def _holds(edges: FloatArray, force: FloatArray, slack: float) -> bool:
    """Return whether a force in the space of the edges is a positive sum of them."""
    if len(edges) <= 2:
        return len(edges) == 0 or bool(np.linalg.lstsq(edges.T, force, rcond=None)[0].min() >= -slack)
    inward = np.cross(edges, np.roll(edges, -1, axis=0))
    return bool((inward @ force).min() >= -slack)
