# SPDX-License-Identifier: Apache-2.0
"""Turns planar contact modes into modes in world axes, so that planar and spatial answers have one form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes import SpatialMode, SpatialModeMargin, SpatialWrenchSet
from contact_dynamics.plane.lifting import equal_shares

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import PlanarMode, PlanarModeMargin, PlanarWrenchSet
    from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion
    from contact_dynamics.plane.types import PlanarWrench, Vector2
    from contact_dynamics.validation import FloatArray


def lifted_mode(mode: PlanarMode, problem: PlanarProblem, partners: tuple[int, ...]) -> SpatialMode:
    """Return a mode in world axes. Contacts share their forces with ``partners``, their mirror images."""
    plane = problem.plane
    return SpatialMode(
        mode=mode.mode,
        acceleration_W=plane.lift(mode.acceleration),
        angular_acceleration_W=mode.angular_acceleration * plane.normal_W,
        contact_forces_W=equal_shares(lifted_vectors(mode.contact_forces, problem), partners),
        contact_accelerations_W=lifted_vectors(mode.contact_accelerations, problem),
        tangential_directions_W=np.zeros((0, 3)),  # the letters say it
        misdirection=0.0,
        forces_unique=mode.forces_unique,
        motion_unique=mode.motion_unique,
    )


def lifted_margin(margin: PlanarModeMargin, plane: PlaneOfMotion) -> SpatialModeMargin:
    """Return the margin of a mode in world axes."""
    return SpatialModeMargin(
        mode=margin.mode,
        margin=margin.margin,
        length=margin.length,
        change_W=_wrench_row(margin.change, plane),
        verdict_beyond=margin.verdict_beyond,
        modes_beyond=margin.modes_beyond,
    )


def lifted_wrench_set(wrenches: PlanarWrenchSet, plane: PlaneOfMotion) -> SpatialWrenchSet:
    """Return the applied wrenches of a mode in world axes. Wrenches out of the plane have no bounds."""
    return SpatialWrenchSet(
        mode=wrenches.mode,
        sliding_from_W=np.zeros((0, 3)),  # the letters say it
        sliding_to_W=np.zeros((0, 3)),
        vertices=_wrench_rows(wrenches.vertices, plane),
        generators=_wrench_rows(wrenches.generators, plane),
        half_spaces=np.array(
            [
                [*plane.lift((side.a[0], side.a[1])), *(side.a[2] * plane.normal_W), side.b]
                for side in wrenches.half_spaces
            ]
        ).reshape(-1, 7),
    )


def lifted_vectors(vectors_C: Sequence[Vector2], problem: PlanarProblem) -> FloatArray:
    """Return vectors in contact axes (t, n), one for each contact, in world axes, (n, 3)."""
    axes_W = problem.plane.axes_W
    if not vectors_C:
        return np.zeros((0, 3))
    bases = np.array([(contact.tangent, contact.normal) for contact in problem.contacts])
    lifted: FloatArray = np.einsum("ni,nij->nj", np.array(vectors_C), bases) @ axes_W
    return lifted


def _wrench_rows(wrenches: Sequence[PlanarWrench], plane: PlaneOfMotion) -> FloatArray:
    return np.array([_wrench_row(wrench, plane) for wrench in wrenches]).reshape(-1, 6)


def _wrench_row(wrench: PlanarWrench, plane: PlaneOfMotion) -> FloatArray:
    return np.concatenate([plane.lift(wrench.f), wrench.moment * plane.normal_W])
