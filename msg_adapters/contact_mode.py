"""Answers about contact modes, in the plane and in space, to the service's response, in world axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.plane.lifting import equal_shares
from contact_dynamics_interfaces.msg import ContactMode, ModeWrenches
from msg_adapters.contacts import flat

if TYPE_CHECKING:
    from array import array
    from collections.abc import Sequence

    from contact_dynamics.contact_modes import (
        BodyStatics,
        PlanarMode,
        PlanarModeAnswer,
        PlanarModeMargin,
        PlanarWrenchSet,
        RefusedMode,
        SpatialMode,
        SpatialModeAnswer,
        SpatialModeMargin,
        SpatialWrenchSet,
    )
    from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion
    from contact_dynamics.plane.types import PlanarWrench, Vector2
    from contact_dynamics.validation import FloatArray
    from contact_dynamics_interfaces.srv import PredictContactMode


def write_planar_answer(
    response: PredictContactMode.Response,
    answer: PlanarModeAnswer,
    problem: PlanarProblem,
    partners: tuple[int, ...],
) -> None:
    """Write an answer in the plane into a `PredictContactMode` response, in world axes.

    ``partners`` are the mirror images of the contacts in the plane, with which they share their forces.
    """
    response.verdict = int(answer.verdict)
    response.modes = planar_modes_to_msgs(answer.modes, problem, partners)
    response.approaching_contacts = list(answer.approaching)
    response.contact_velocities = flat(_lift(answer.contact_velocities, problem))
    write_refused(response, answer.refused)
    response.kinematic_modes = list(answer.kinematic_modes)
    response.stable_disturbance = float("nan")
    response.velocity_tolerance = answer.velocity_tolerance
    response.acceleration_tolerance = answer.acceleration_tolerance


def write_spatial_answer(
    response: PredictContactMode.Response,
    answer: SpatialModeAnswer,
    *,
    kinematic_modes: Sequence[str],
    contact_velocities_W: FloatArray,
) -> None:
    """Write an answer in space into a `PredictContactMode` response."""
    response.verdict = int(answer.verdict)
    response.message = answer.undecided
    response.modes = spatial_modes_to_msgs(answer.modes)
    response.approaching_contacts = list(answer.approaching)
    response.contact_velocities = flat(contact_velocities_W)
    response.kinematic_modes = list(kinematic_modes)
    response.stable_disturbance = float("nan")
    response.velocity_tolerance = answer.velocity_tolerance
    response.acceleration_tolerance = float("nan")
    response.friction_facets = answer.friction_facets


def write_refused(response: PredictContactMode.Response, modes: Sequence[RefusedMode]) -> None:
    """Write into a response which modes mechanics refuses, and why."""
    response.refused_modes = [refused.mode for refused in modes]
    response.refusals = [int(refused.refusal) for refused in modes]
    response.refused_contacts = [refused.contact for refused in modes]
    response.refusal_amounts = flat(np.array([refused.amount for refused in modes]))


def spatial_modes_to_msgs(modes: Sequence[SpatialMode]) -> list[ContactMode]:
    """Return modes in space as messages."""
    return [
        ContactMode(
            mode=mode.mode,
            linear_acceleration=mode.acceleration_W,
            angular_acceleration=mode.angular_acceleration_W,
            contact_forces=flat(mode.contact_forces_W),
            forces_unique=mode.forces_unique,
            motion_unique=mode.motion_unique,
            contact_accelerations=flat(mode.contact_accelerations_W),
            tangential_directions=flat(mode.tangential_directions_W),
            misdirection=mode.misdirection,
            margin=float("nan"),
        )
        for mode in modes
    ]


def planar_modes_to_msgs(
    modes: Sequence[PlanarMode], problem: PlanarProblem, partners: tuple[int, ...]
) -> list[ContactMode]:
    """Return modes in the plane as messages; contacts share their forces with their mirror images."""
    return [_mode_to_msg(mode, problem, partners) for mode in modes]


def write_planar_margins(
    response: PredictContactMode.Response, margins: Sequence[PlanarModeMargin], plane: PlaneOfMotion
) -> None:
    """Write the margins of the consistent modes into a response that holds those modes, in the same order."""
    for msg, margin in zip(response.modes, margins, strict=True):
        msg.margin = margin.margin
        msg.margin_length = margin.length
        msg.margin_wrench = _wrench_row(margin.change, plane)
        msg.margin_verdict = int(margin.verdict_beyond)
        msg.margin_modes = list(margin.modes_beyond)


def write_statics(response: PredictContactMode.Response, statics: BodyStatics) -> None:
    """Write the answers to the static questions into a response."""
    response.equilibrium = int(statics.equilibrium)
    response.jammed = int(statics.jammed)
    response.wedged = response.POSSIBLE if statics.wedged else response.NO
    response.stable_disturbance = statics.stable_disturbance


def write_spatial_margins(
    response: PredictContactMode.Response, margins: Sequence[SpatialModeMargin]
) -> None:
    """Write the margins of the consistent modes into a response that holds those modes, in the same order."""
    for msg, margin in zip(response.modes, margins, strict=True):
        msg.margin = margin.margin
        msg.margin_length = margin.length
        msg.margin_wrench = margin.change_W
        msg.margin_verdict = int(margin.verdict_beyond)
        msg.margin_modes = list(margin.modes_beyond)


def wrench_set_to_msg(wrenches: PlanarWrenchSet, plane: PlaneOfMotion) -> ModeWrenches:
    """Return the applied wrenches of one mode."""
    return ModeWrenches(
        mode=wrenches.mode,
        vertices=_wrench_rows(wrenches.vertices, plane),
        generators=_wrench_rows(wrenches.generators, plane),
        half_spaces=flat(
            np.array(
                [
                    [*plane.lift((side.a[0], side.a[1])), *(side.a[2] * plane.normal_W), side.b]
                    for side in wrenches.half_spaces
                ]
            )
        ),
    )


def spatial_wrench_set_to_msg(wrenches: SpatialWrenchSet) -> ModeWrenches:
    """Return the applied wrenches of one mode in space, with one way of sliding."""
    return ModeWrenches(
        mode=wrenches.mode,
        vertices=flat(wrenches.vertices),
        generators=flat(wrenches.generators),
        half_spaces=flat(wrenches.half_spaces),
        sliding_from=flat(wrenches.sliding_from_W),
        sliding_to=flat(wrenches.sliding_to_W),
    )


def _wrench_rows(wrenches: Sequence[PlanarWrench], plane: PlaneOfMotion) -> array[float]:
    return flat(np.array([_wrench_row(wrench, plane) for wrench in wrenches]))


def _wrench_row(wrench: PlanarWrench, plane: PlaneOfMotion) -> FloatArray:
    return np.concatenate([plane.lift(wrench.f), wrench.moment * plane.normal_W])


def _mode_to_msg(mode: PlanarMode, problem: PlanarProblem, partners: tuple[int, ...]) -> ContactMode:
    plane = problem.plane
    return ContactMode(
        mode=mode.mode,
        linear_acceleration=plane.lift(mode.acceleration),
        angular_acceleration=mode.angular_acceleration * plane.normal_W,
        contact_forces=flat(equal_shares(_lift(mode.contact_forces, problem), partners)),
        forces_unique=mode.forces_unique,
        motion_unique=mode.motion_unique,
        contact_accelerations=flat(_lift(mode.contact_accelerations, problem)),
        margin=float("nan"),
    )


def _lift(vectors_C: Sequence[Vector2], problem: PlanarProblem) -> FloatArray:
    """Return vectors in contact axes (t, n), one for each contact, in world axes, (n, 3)."""
    axes_W = problem.plane.axes_W
    if not vectors_C:
        return np.zeros((0, 3))
    bases = np.array([(contact.tangent, contact.normal) for contact in problem.contacts])
    lifted: FloatArray = np.einsum("ni,nij->nj", np.array(vectors_C), bases) @ axes_W
    return lifted
