# SPDX-License-Identifier: Apache-2.0
"""Chooses the plane of motion of a question, and converts modes and impacts in it to world axes.

Planar and spatial answers therefore have one form. Positions in the plane are relative to the centre of mass.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes import SpatialMode, SpatialModeMargin, SpatialWrenchSet
from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet
from contact_dynamics.contact_modes.result import PlanarMode
from contact_dynamics.impact import SpatialImpact
from contact_dynamics.impact.energy import created
from contact_dynamics.plane.lifting import equal_shares, planar_velocity, with_planar_velocity
from contact_dynamics.plane.plane_search import project_onto_best_plane
from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion, project_onto_plane
from contact_dynamics.plane.types import PlanarWrench
from contact_dynamics.rigid_body.body import kinetic_energy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes import PlanarModeMargin
    from contact_dynamics.impact import PlanarImpact, ResolvedImpact
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


def planar_problem_of(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    plane: PlaneOfMotion | None,
    force_W: FloatArray,
    torque_W: FloatArray,
    speed_tolerance: float,
) -> PlanarProblem:
    """Return a problem in a plane of motion. If ``plane`` is None, it is the best fitting plane.

    Raise `OutOfPlaneError` as `project_onto_plane` and `best_plane` do.
    """
    if plane is None:
        return project_onto_best_plane(
            body, state, contacts, force_W=force_W, torque_W=torque_W, speed_tolerance=speed_tolerance
        )
    return project_onto_plane(
        body,
        state,
        contacts,
        plane=plane,
        force_W=force_W,
        torque_W=torque_W,
        speed_tolerance=speed_tolerance,
    )


def lifted_mode(mode: PlanarMode, problem: PlanarProblem, partners: tuple[int, ...]) -> SpatialMode:
    """Return a mode in world axes. Contacts share their forces with ``partners``, their mirror images."""
    plane = problem.plane
    return SpatialMode(
        mode=mode.mode,
        acceleration_W=plane.lift(mode.acceleration),
        angular_acceleration_W=mode.angular_acceleration * plane.normal_W,
        contact_forces_W=equal_shares(lifted_vectors(mode.contact_forces, problem), partners),
        contact_accelerations_W=lifted_vectors(mode.contact_accelerations, problem),
        tangential_directions_W=np.zeros((0, 3)),  # the letters contain them
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
    """Return the applied wrenches of a mode in world axes. Those out of the plane are unlimited."""
    return SpatialWrenchSet(
        mode=wrenches.mode,
        sliding_from_W=np.zeros((0, 3)),  # the letters contain them
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


def lifted_impact(impact: PlanarImpact, problem: PlanarProblem, state: BodyState) -> SpatialImpact:
    """Return an impact at the one contact of a plane of motion, in world axes.

    Motion out of the plane remains as in ``state``, just before the impact.
    """
    (contact,) = problem.contacts
    axes = np.array((contact.tangent, contact.normal)) @ problem.plane.axes_W
    a, b, c, _ = impact.inverse_inertia
    events, vertices = zip(*impact.path, strict=True)
    ends = impact.impulse_C, impact.compression_C, impact.velocity_before_C, impact.velocity_after_C
    vectors_W = np.array((*ends, *vertices)) @ axes
    return SpatialImpact(
        restitution_law=impact.restitution_law,
        outcome=impact.outcome,
        jams=impact.jams,
        impulse_W=vectors_W[0],
        compression_W=vectors_W[1],
        path_W=vectors_W[4:],
        path_events=events,
        velocity_before_W=vectors_W[2],
        velocity_after_W=vectors_W[3],
        inverse_inertia_W=axes.T @ np.array(((a, b), (b, c))) @ axes,
        state=with_planar_velocity(problem, state, impact.velocity),
    )


def several_in_plane(
    impact: ResolvedImpact, problem: PlanarProblem, body: MassProperties, state: BodyState
) -> ResolvedImpact:
    """Return the impact of the body that `planar_in_space` replaced, with unchanged motion out of the plane.

    ``body`` and ``state`` are the real ones just before the impact.
    """
    after = with_planar_velocity(problem, state, planar_velocity(problem.plane, impact.state))
    first, last = kinetic_energy(body, state), kinetic_energy(body, after)
    return replace(
        impact,
        states=(after,),
        kinetic_energy_before=first,
        kinetic_energy_after=last,
        creates_energy=created(last - first, first),
    )
