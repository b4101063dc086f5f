# SPDX-License-Identifier: Apache-2.0
"""Checks accelerations and forces of an answer against Newton's law and lecture 26's table, from scratch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    PlanarContactProblem,
    PlanarMode,
    PlanarModeAnswer,
    SpatialContactProblem,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.rigid_body.body import BodyState, MassProperties


def planar_problem(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contacts: Sequence[PlanarContact],
    wrench: PlanarWrench,
    **tolerances: float,
) -> PlanarContactProblem:
    """Return the problem of a case that is drawn as a tuple."""
    return PlanarContactProblem(body=body, velocity=velocity, contacts=contacts, wrench=wrench, **tolerances)


def spatial_problem(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    force_W: ArrayLike,
    torque_W: ArrayLike = (0.0, 0.0, 0.0),
    **others: Any,
) -> SpatialContactProblem:
    """Return a problem in space, whose force and torque follow its contacts."""
    return SpatialContactProblem(
        body=body, state=state, contacts=contacts, force_W=force_W, torque_W=torque_W, **others
    )


ROUNDING = 1e-9  # relative to the forces at work: internal forces of narrow cones are large


def check_evidence(
    answer: PlanarModeAnswer,
    body: PlanarBody,
    velocity: PlanarVelocity,
    contacts: Sequence[PlanarContact],
    wrench: PlanarWrench,
) -> None:
    check_forces(answer, body, contacts, wrench)
    for mode in answer.modes:
        for i, one in enumerate(contacts):
            _check_acceleration(mode, i, one, velocity.w)


def check_forces(
    answer: PlanarModeAnswer, body: PlanarBody, contacts: Sequence[PlanarContact], wrench: PlanarWrench
) -> None:
    """Check forces against Newton's law and their letters."""
    for mode in answer.modes:
        _check_newton(mode, body, contacts, wrench)
        for i, one in enumerate(contacts):
            _check_letter(mode, i, one, answer.contact_velocities[i])


def _world(contact: PlanarContact, pair: tuple[float, float]) -> tuple[float, float]:
    (n_x, n_y), (t, n) = contact.normal, pair
    return t * n_y + n * n_x, n * n_y - t * n_x


def _check_newton(
    mode: PlanarMode, body: PlanarBody, contacts: Sequence[PlanarContact], wrench: PlanarWrench
) -> None:
    f_x, f_y = wrench.f
    moment = wrench.moment
    forces, moments = abs(f_x) + abs(f_y), abs(moment)
    for contact, pair in zip(contacts, mode.contact_forces, strict=True):
        c_x, c_y = _world(contact, pair)
        x, y = contact.r
        f_x, f_y, moment = f_x + c_x, f_y + c_y, moment + x * c_y - y * c_x
        forces += abs(c_x) + abs(c_y)
        moments += abs(x * c_y) + abs(y * c_x)
    rho = body.radius_of_gyration
    scale = ROUNDING * (forces + moments / rho)
    assert abs(f_x - body.mass * mode.acceleration[0]) <= scale
    assert abs(f_y - body.mass * mode.acceleration[1]) <= scale
    assert abs(moment - body.inertia * mode.angular_acceleration) <= scale * rho


def _check_letter(mode: PlanarMode, i: int, contact: PlanarContact, velocity: tuple[float, float]) -> None:
    letter = mode.mode[i]
    f_t, f_n = mode.contact_forces[i]
    a_t, a_n = mode.contact_accelerations[i]
    v_t, v_n = velocity
    edge = contact.friction * f_n
    assert f_n >= 0.0
    if letter == "s":
        assert (f_t, f_n) == (0.0, 0.0)
        assert v_n > 0.0 or a_n > 0.0
        return
    assert v_n == 0.0
    assert a_n == 0.0
    if letter == "f":
        assert (v_t, a_t) == (0.0, 0.0)
        assert abs(f_t) <= edge * (1.0 + ROUNDING) + ROUNDING * f_n
        return
    right = 1.0 if letter == "r" else -1.0
    assert right * v_t > 0.0 or (v_t == 0.0 and right * a_t > 0.0)
    assert abs(f_t + right * edge) <= ROUNDING * (edge + f_n)


def _check_acceleration(mode: PlanarMode, i: int, contact: PlanarContact, w: float) -> None:
    x, y = contact.r
    alpha = mode.angular_acceleration
    a_x = mode.acceleration[0] - alpha * y - w * w * x
    a_y = mode.acceleration[1] + alpha * x - w * w * y
    got_x, got_y = _world(contact, mode.contact_accelerations[i])
    scale = abs(mode.acceleration[0]) + abs(mode.acceleration[1])
    scale += (abs(alpha) + w * w) * (abs(x) + abs(y))
    # Accelerations within tolerance are reported as the zeros that they stand for.
    scale += sum(abs(f_t) + f_n for f_t, f_n in mode.contact_forces)
    assert abs(a_x - got_x) <= 1e-8 * scale
    assert abs(a_y - got_y) <= 1e-8 * scale
