"""Answers about contact modes in a plane of motion to the service's response."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics_interfaces.msg import ContactMode
from msg_adapters.contacts import flat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.result import ConsistentMode, ContactModeAnswer
    from contact_dynamics.planar import Vector2
    from contact_dynamics.plane_of_motion import PlanarProblem
    from contact_dynamics.validation import FloatArray


def write_planar_answer(response: Any, answer: ContactModeAnswer, problem: PlanarProblem) -> None:
    """Write an answer in the plane into a `PredictContactMode` response, in world axes."""
    response.verdict = int(answer.verdict)
    response.modes = [_mode_to_msg(mode, problem) for mode in answer.modes]
    response.approaching_contacts = list(answer.approaching)
    response.contact_velocities = flat(_lift(answer.contact_velocities, problem))
    response.refused_modes = [refused.mode for refused in answer.refused]
    response.refusals = [int(refused.refusal) for refused in answer.refused]
    response.refused_contacts = [refused.contact for refused in answer.refused]
    response.refusal_amounts = flat(np.array([refused.amount for refused in answer.refused]))
    response.kinematic_modes = list(answer.kinematic_modes)
    response.stable_disturbance = float("nan")
    response.velocity_tolerance = answer.velocity_tolerance
    response.acceleration_tolerance = answer.acceleration_tolerance


def _mode_to_msg(mode: ConsistentMode, problem: PlanarProblem) -> ContactMode:
    plane = problem.plane
    return ContactMode(
        mode=mode.mode,
        linear_acceleration=plane.lift(mode.acceleration),
        angular_acceleration=mode.angular_acceleration * plane.normal_W,
        contact_forces=flat(_lift(mode.contact_forces, problem)),
        forces_unique=mode.forces_unique,
        motion_unique=mode.motion_unique,
        contact_accelerations=flat(_lift(mode.contact_accelerations, problem)),
        margin=float("nan"),
        margin_length=problem.body.radius_of_gyration,
    )


def _lift(vectors_C: Sequence[Vector2], problem: PlanarProblem) -> FloatArray:
    """Return vectors in contact axes (t, n), one for each contact, in world axes, (n, 3)."""
    axes_W = problem.plane.axes_W
    if not vectors_C:
        return np.zeros((0, 3))
    bases = np.array([(contact.tangent, contact.normal) for contact in problem.contacts])
    lifted: FloatArray = np.einsum("ni,nij->nj", np.array(vectors_C), bases) @ axes_W
    return lifted
