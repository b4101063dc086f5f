# SPDX-License-Identifier: Apache-2.0
"""Turns the world axes of an answer about contact modes back into those of its plane of motion.

Positions are relative to the centre of mass. The answer must have a plane.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes.letters import SLIDES_LEFT, SLIDES_RIGHT
from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet, WrenchHalfSpace
from contact_dynamics.contact_modes.result import PlanarMode
from contact_dynamics.plane.types import PlanarContact, PlanarWrench

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.result import SpatialMode
    from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
    from contact_dynamics.plane.projection import PlaneOfMotion
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.validation import FloatArray


def seen_contacts(answer: ContactModeAnswer, plane: PlaneOfMotion) -> tuple[PlanarContact, ...]:
    """Return the contacts in the plane, all as points on flats."""
    contacts = answer.contacts
    arms = (contacts.p_WC_W - answer.state.p_WB_W) @ plane.axes_W.T
    normals = contacts.normals_W @ plane.axes_W.T
    return tuple(
        PlanarContact(r=_pair(arm), normal=_pair(normal / np.linalg.norm(normal)), friction=friction)
        for arm, normal, friction in zip(arms, normals, contacts.frictions.tolist(), strict=True)
    )


def seen_modes(answer: ContactModeAnswer, plane: PlaneOfMotion) -> tuple[PlanarMode, ...]:
    """Return the consistent modes in the plane. Accelerations within the answer's tolerance are zero."""
    bases = np.array([(contact.tangent, contact.normal) for contact in seen_contacts(answer, plane)])
    bases_W = bases.reshape(-1, 2, 2) @ plane.axes_W
    return tuple(_seen_mode(mode, plane, bases_W, answer.acceleration_tolerance) for mode in answer.modes)


def seen_wrench_set(wrenches: SpatialWrenchSet, plane: PlaneOfMotion) -> PlanarWrenchSet:
    """Return the applied wrenches of a mode within the plane."""
    return PlanarWrenchSet(
        mode=wrenches.mode,
        vertices=tuple(seen_wrench(row, plane) for row in wrenches.vertices),
        generators=tuple(seen_wrench(row, plane) for row in wrenches.generators),
        half_spaces=tuple(
            WrenchHalfSpace(
                a=(*_pair(plane.axes_W @ row[:3]), float(plane.normal_W @ row[3:6])), b=float(row[6])
            )
            for row in wrenches.half_spaces
        ),
    )


def seen_wrench(wrench_W: FloatArray, plane: PlaneOfMotion) -> PlanarWrench:
    """Return a wrench in the plane from force and torque, (6,), N and N m, world axes."""
    return PlanarWrench(f=_pair(plane.axes_W @ wrench_W[:3]), moment=float(plane.normal_W @ wrench_W[3:]))


def sliding_directions(answer: ContactModeAnswer, mode: SpatialMode) -> FloatArray:
    """Return the unit direction in which each contact slides in a mode, (n, 3), world axes, or zero.

    In space the mode has the directions. In a plane its letters give them: l is against the tangent, r along
    it.
    """
    if answer.plane is None:
        return mode.tangential_directions_W
    ways = np.array([{SLIDES_LEFT: -1.0, SLIDES_RIGHT: 1.0}.get(letter, 0.0) for letter in mode.mode])
    tangents = np.array([contact.tangent for contact in seen_contacts(answer, answer.plane)]).reshape(-1, 2)
    directions: FloatArray = ways[:, None] * tangents @ answer.plane.axes_W
    return directions


def beyond(vectors: FloatArray, tolerance: float) -> FloatArray:
    """Return vectors, (n, k), in which those no longer than a tolerance are set to zero."""
    return np.where(np.linalg.norm(vectors, axis=1, keepdims=True) > tolerance, vectors, 0.0)


def _seen_mode(mode: SpatialMode, plane: PlaneOfMotion, bases_W: FloatArray, tolerance: float) -> PlanarMode:
    """Return a mode in the plane. ``bases_W``, (n, 2, 3), has the tangent and the normal of each contact."""
    forces, accelerations = (
        tuple(_pair(pair) for pair in np.einsum("nij,nj->ni", bases_W, vectors_W))
        for vectors_W in (mode.contact_forces_W, beyond(mode.contact_accelerations_W, tolerance))
    )
    return PlanarMode(
        mode=mode.mode,
        acceleration=_pair(plane.axes_W @ mode.acceleration_W),
        angular_acceleration=float(plane.normal_W @ mode.angular_acceleration_W),
        contact_forces=forces,
        contact_accelerations=accelerations,
        forces_unique=mode.forces_unique,
        motion_unique=mode.motion_unique,
    )


def _pair(vector: FloatArray) -> Vector2:
    x, y = vector.tolist()
    return (x, y)
