# SPDX-License-Identifier: Apache-2.0
"""Checks accelerations and forces of an answer against Newton's law and lecture 26's table, from scratch."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import linprog

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes import (
    ModeVerdict,
    PlanarContactProblem,
    PlanarMode,
    PlanarModeAnswer,
    SpatialContactProblem,
    SpatialMode,
    contact_modes,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from oracles.modes_on_planes import INERTIA, MASS, Made


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


def problem_of_made(case: Made, **others: Any) -> SpatialContactProblem:
    """Return the problem of a mode that was made by construction."""
    return spatial_problem(
        MassProperties(mass=MASS, I_B=INERTIA),
        BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=case.v, w_WB_W=case.w),
        ContactSet(p_WC_W=case.points, normals_W=case.normals, frictions=case.frictions),
        case.wrench[:3],
        case.wrench[3:],
        **others,
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
    edge = (contact.holding_friction if letter == "f" else contact.friction) * f_n
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


SMALL = 1e-8  # relative to the forces, and to the accelerations that they would cause alone


def check_laws(problem: SpatialContactProblem, mode: SpatialMode, flush_within: float) -> None:
    """Check a mode of a body in world axes against the equations, from scratch.

    Modes of contacts that are taken as flush miss those of the given contacts by as much as these differ.
    """
    small = max(SMALL, flush_within)
    body, contacts, state = problem.body, problem.contacts, problem.state
    forces, arms, w = mode.contact_forces_W, contacts.p_WC_W - state.p_WB_W, state.w_WB_W
    size = float(np.abs(forces).max(initial=0.0)) + float(np.abs(problem.wrench_W).max())
    reach = float(np.linalg.norm(arms, axis=1).max())
    fast = size * (1.0 / body.mass + (reach + reach**2) / float(np.diag(body.I_B).min()))
    force = problem.force_W + forces.sum(axis=0)
    torque = problem.torque_W + np.cross(arms, forces).sum(axis=0) - np.cross(w, body.I_B @ w)
    assert np.abs(body.mass * mode.acceleration_W - force).max() <= small * size
    assert np.abs(body.I_B @ mode.angular_acceleration_W - torque).max() <= small * size * (1.0 + reach)
    accelerations = mode.acceleration_W + np.cross(mode.angular_acceleration_W, arms)
    accelerations += np.cross(w, np.cross(w, arms))
    velocities = state.velocity_of_point(contacts.p_WC_W)
    for i, letter in enumerate(mode.mode):
        normal, friction = contacts.normals_W[i], float(contacts.frictions[i])
        pressing, rising = float(forces[i] @ normal), float(accelerations[i] @ normal)
        across = forces[i] - pressing * normal
        speed = velocities[i] - float(velocities[i] @ normal) * normal
        way = speed if np.linalg.norm(speed) > 1e-9 else accelerations[i] - rising * normal
        if letter == "s":
            assert np.abs(forces[i]).max() == 0.0
            assert rising > 0.0 or velocities[i] @ normal > 0.0
            continue
        assert pressing >= -small * size
        assert abs(rising) <= small * fast
        assert np.linalg.norm(across) <= friction * pressing + small * size
        if letter == "f":
            assert np.linalg.norm(way) <= small * fast
        else:
            straight = -friction * pressing * way / np.linalg.norm(way)
            assert np.abs(across - straight).max() <= small * size * max(1.0, friction)


def pyramid_wrenches(
    contacts: ContactSet, edges: int, share: float = 1.0, about: ArrayLike = (0.0, 0.0, 0.0)
) -> np.ndarray:
    """Return the wrenches, (k, 6), of the edges of pyramids inside cones with a share of the friction."""
    rows = []
    for one in contacts:
        forces = linearised_cone(one.normal_W, share * one.friction, edges)
        rows.append(np.hstack([forces, np.cross(one.p_WC_W - about, forces)]))
    return np.vstack(rows)


def balance(wrenches: np.ndarray, load: np.ndarray) -> bool:
    """Return whether positive combinations of wrenches, (k, 6), balance a load: a linear program."""
    found = linprog(np.zeros(len(wrenches)), A_eq=wrenches.T, b_eq=-load, method="highs")
    return bool(found.status == 0)


def check_proofs(drawn: Iterable[tuple[Any, Callable[[], Any]]], samples: int) -> int:
    """Check answers that are certain against samples of the same box, and return how many there were."""
    proven = 0
    for problem, sample in drawn:
        answer = contact_modes(problem)
        assert answer.within is not None
        assert answer.within.verdicts[0] == answer.verdict
        if not answer.within.certain:
            assert answer.within.samples > 0
            continue
        proven += 1
        assert answer.within.verdicts == (answer.verdict,)
        for _ in range(samples):
            other = contact_modes(sample())
            assert other.verdict == answer.verdict, problem
            if answer.verdict == ModeVerdict.UNIQUE:
                assert other.modes[0].mode == answer.modes[0].mode, problem
    return proven
