"""Modes of one planar contact by the lecture's case analysis, in closed form (Mason, lecture 26).

Model: a rigid body touches the fixed world in one point with Coulomb friction. In contact axes
the contact's acceleration is affine in the contact force,

    a_t = w_t + a f_t + b f_n,        a_n = w_n + b f_t + c f_n,

with w the acceleration without contact force, terms of velocities included. Each letter adds its two
equations; what contradicts the letter's inequalities is discarded. Plain floats throughout: this is the path
of one answer in microseconds.

Does not cover: several contacts (`planar`), moving surfaces.
"""

from __future__ import annotations

from typing import NamedTuple

from contact_dynamics.contact_modes.result import ConsistentMode, Refusal, RefusedMode
from contact_dynamics.planar import PlanarBody, PlanarContact, PlanarWrench, Vector2


class _Solution(NamedTuple):
    f_t: float  # N
    f_n: float  # N
    a_t: float  # m/s^2
    a_n: float  # m/s^2
    unique: bool  # whether force and motion are the only ones with this letter


class _Failure(NamedTuple):
    refusal: Refusal
    amount: float  # in the refusal's unit


class _ContactAxes(NamedTuple):
    """The problem in contact axes."""

    a: float  # 1/kg, tangential acceleration per tangential force, > 0
    b: float  # 1/kg, either per the other
    c: float  # 1/kg, normal acceleration per normal force, > 0
    det: float  # 1/kg^2, a c - b^2 > 0
    w_t: float  # m/s^2, without contact force
    w_n: float  # m/s^2, without contact force
    friction: float
    accuracy: float  # dimensionless, the relative tolerance
    tolerance: float  # m/s^2


def single_contact_modes(
    body: PlanarBody,
    contact: PlanarContact,
    wrench: PlanarWrench,
    *,
    v_t: float,
    w: float,
    accuracy: float,
) -> tuple[list[ConsistentMode], list[RefusedMode], float]:
    """Return consistent modes, refused modes and the tolerance on accelerations, m/s^2, at v_n = 0.

    Args:
        body: Mass and angular inertia.
        contact: The contact.
        wrench: Applied to the body besides the contact force.
        v_t: m/s, tangential velocity of the contact; an exact 0 means at rest.
        w: rad/s, angular velocity of the body.
        accuracy: Relative size of what counts as zero.
    """
    axes = _contact_axes(body, contact, wrench, v_t=v_t, w=w, accuracy=accuracy)
    trials: list[tuple[str, _Solution | _Failure]] = [("s", _separating(axes))]
    if v_t <= 0.0:
        trials.append(("l", _sliding(axes, direction=-1.0, at_rest=v_t == 0.0)))
    if v_t >= 0.0:
        trials.append(("r", _sliding(axes, direction=1.0, at_rest=v_t == 0.0)))
    if v_t == 0.0:
        trials.append(("f", _fixed(axes)))
    consistent: list[ConsistentMode] = []
    refused: list[RefusedMode] = []
    for letter, outcome in trials:
        if isinstance(outcome, _Failure):
            refused.append(
                RefusedMode(mode=letter, refusal=outcome.refusal, contact=0, amount=outcome.amount)
            )
        else:
            consistent.append(_mode(letter, outcome, body, contact, wrench))
    return consistent, refused, axes.tolerance


def _contact_axes(
    body: PlanarBody, contact: PlanarContact, wrench: PlanarWrench, *, v_t: float, w: float, accuracy: float
) -> _ContactAxes:
    n_x, n_y = contact.normal
    r_x, r_y = contact.r
    f_x, f_y = wrench.f
    r_t = r_x * n_y - r_y * n_x
    r_n = r_x * n_x + r_y * n_y
    per_mass = 1.0 / body.mass
    per_inertia = 1.0 / body.inertia
    alpha = wrench.moment * per_inertia
    w_t = (f_x * n_y - f_y * n_x) * per_mass - r_n * alpha - w * w * r_t
    rolling = contact.gap_acceleration(v_t, w)
    w_n = (f_x * n_x + f_y * n_y) * per_mass + r_t * alpha - w * w * r_n + rolling
    scale = (abs(f_x) + abs(f_y)) * per_mass + (abs(r_t) + abs(r_n)) * (abs(alpha) + w * w) + abs(rolling)
    tolerance = accuracy * scale
    return _ContactAxes(
        a=per_mass + r_n * r_n * per_inertia,
        b=-r_t * r_n * per_inertia,
        c=per_mass + r_t * r_t * per_inertia,
        det=per_mass * (per_mass + (r_t * r_t + r_n * r_n) * per_inertia),
        w_t=0.0 if abs(w_t) <= tolerance else w_t,
        w_n=0.0 if abs(w_n) <= tolerance else w_n,
        friction=contact.friction,
        accuracy=accuracy,
        tolerance=tolerance,
    )


def _separating(axes: _ContactAxes) -> _Solution | _Failure:
    if axes.w_n > 0.0:
        return _Solution(0.0, 0.0, axes.w_t, axes.w_n, unique=True)
    return _Failure(Refusal.PENETRATES if axes.w_n < 0.0 else Refusal.WRONG_MOTION, axes.w_n)


def _sliding(axes: _ContactAxes, *, direction: float, at_rest: bool) -> _Solution | _Failure:
    """Try to slide in ``direction`` (left -1, right +1): a_n = 0 and f_t = -direction mu f_n."""
    slope = -direction * axes.friction
    factor = axes.c + slope * axes.b  # lecture 26, eq. 2
    unique = abs(factor) > axes.accuracy * (axes.c + abs(slope * axes.b))
    if axes.w_n == 0.0:
        # Where the factor is zero too, any f_n keeps a_n at 0; friction then pushes against the sliding, so
        # that the contact slides with some force only if it does with none.
        f_n = 0.0
    elif not unique or (factor < 0.0 and axes.w_n < 0.0):
        return _Failure(Refusal.NO_SOLUTION, factor)
    else:
        f_n = -axes.w_n / factor
        if f_n < 0.0:
            return _Failure(Refusal.PULLS, f_n)
    gain = axes.b + slope * axes.a
    a_t = axes.w_t + gain * f_n
    if at_rest and direction * a_t <= axes.tolerance + axes.accuracy * abs(gain * f_n):
        return _Failure(Refusal.WRONG_MOTION, a_t)
    return _Solution(slope * f_n, f_n, a_t, 0.0, unique)


def _fixed(axes: _ContactAxes) -> _Solution | _Failure:
    f_n = (axes.b * axes.w_t - axes.a * axes.w_n) / axes.det
    f_t = (axes.b * axes.w_n - axes.c * axes.w_t) / axes.det
    tolerance = axes.tolerance * (axes.a + axes.c) / axes.det
    if f_n < -tolerance:
        return _Failure(Refusal.PULLS, f_n)
    excess = abs(f_t) - axes.friction * f_n
    if excess > tolerance * (1.0 + axes.friction):
        return _Failure(Refusal.OUTSIDE_CONE, excess)
    f_n = max(f_n, 0.0)
    edge = axes.friction * f_n  # rounding at the cone's apex and edges is taken out
    return _Solution(max(-edge, min(edge, f_t)), f_n, 0.0, 0.0, unique=True)


def _mode(
    letter: str, solution: _Solution, body: PlanarBody, contact: PlanarContact, wrench: PlanarWrench
) -> ConsistentMode:
    f_t, f_n, a_t, a_n, unique = solution
    n_x, n_y = contact.normal
    r_x, r_y = contact.r
    f_x = f_t * n_y + f_n * n_x
    f_y = f_n * n_y - f_t * n_x
    acceleration: Vector2 = ((wrench.f[0] + f_x) / body.mass, (wrench.f[1] + f_y) / body.mass)
    return ConsistentMode(
        mode=letter,
        acceleration=acceleration,
        angular_acceleration=(wrench.moment + r_x * f_y - r_y * f_x) / body.inertia,
        contact_forces=((f_t, f_n),),
        contact_accelerations=((a_t, a_n),),
        forces_unique=unique,
        motion_unique=unique,
    )
