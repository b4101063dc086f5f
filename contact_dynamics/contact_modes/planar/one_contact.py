"""Modes of one planar contact by the lecture's case analysis, in closed form (Mason, lecture 26).

Model: a rigid body touches the fixed world in one point with Coulomb friction. In contact axes
the contact's acceleration is affine in the contact force,

    a_t = w_t + a f_t + b f_n,        a_n = w_n + b f_t + c f_n,

with w the acceleration without contact force, terms of velocities included. Each letter adds its two
equations; what contradicts the letter's inequalities is discarded. Plain floats throughout: this is the path
of one answer in microseconds.

Does not cover: several contacts (`answer`), moving surfaces.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact_dynamics.contact_modes.letters import SEPARATES, SLIDES_LEFT, SLIDES_RIGHT, STICKS
from contact_dynamics.contact_modes.planar.result import PlanarMode
from contact_dynamics.contact_modes.result import Refusal, RefusedMode
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench, Vector2
from contact_dynamics.tolerances import LARGEST_NUMBER, ROW_TOLERANCE, SUM_ROUNDING


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

    r_t: float  # m, of the contact from the centre of mass
    r_n: float  # m
    per_mass: float  # 1/kg
    per_inertia: float  # 1/(kg m^2)
    det: float  # 1/kg^2, of the accelerations per force, > 0
    w_t: float  # m/s^2, without contact force
    w_n: float  # m/s^2, without contact force
    terms: float  # m/s^2, the sizes w_t and w_n are sums of
    friction: float
    load: float  # N/kg^(1/2), size of (f, moment / rho), and of what centripetal terms need, per root mass
    accuracy: float  # dimensionless, the relative tolerance

    def along(self, t: float, n: float) -> float:
        """Return the square of the row of t a_t + n a_n, 1/kg: how a change of the wrench shows in it."""
        arm = n * self.r_t - t * self.r_n
        return (t * t + n * n) * self.per_mass + arm * arm * self.per_inertia

    def tolerance(self, square: float, terms: float = 0.0) -> float:
        """Return what counts as zero for a linear function of the wrench.

        A change of the wrench by ``accuracy`` of its size turns the sign of such a value, or rounding does,
        where it is a sum of ``terms``.

        Args:
            square: The square of the function's row, as `along` has it for accelerations.
            terms: The sizes that the value is a sum of, in its unit.
        """
        return self.accuracy * math.sqrt(square) * self.load + SUM_ROUNDING * terms


def single_contact_modes(
    body: PlanarBody,
    contact: PlanarContact,
    wrench: PlanarWrench,
    *,
    v_t: float,
    w: float,
    accuracy: float,
) -> tuple[list[PlanarMode], list[RefusedMode], float]:
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
    trials: list[tuple[str, _Solution | _Failure]] = [(SEPARATES, _separating(axes))]
    if v_t <= 0.0:
        trials.append((SLIDES_LEFT, _sliding(axes, direction=-1.0, at_rest=v_t == 0.0)))
    if v_t >= 0.0:
        trials.append((SLIDES_RIGHT, _sliding(axes, direction=1.0, at_rest=v_t == 0.0)))
    if v_t == 0.0:
        trials.append((STICKS, _fixed(axes)))
    consistent: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    for letter, outcome in trials:
        if isinstance(outcome, _Failure):
            refused.append(
                RefusedMode(mode=letter, refusal=outcome.refusal, contact=0, amount=outcome.amount)
            )
        else:
            consistent.append(_mode(letter, outcome, body, contact, wrench))
    return consistent, refused, axes.tolerance(axes.per_mass)


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
    force = (f_x * f_x + f_y * f_y) * per_mass + wrench.moment * alpha
    centripetal = w * w * (abs(r_t) + abs(r_n)) + abs(rolling)
    axes = _ContactAxes(
        r_t=r_t,
        r_n=r_n,
        per_mass=per_mass,
        per_inertia=per_inertia,
        det=per_mass * (per_mass + (r_t * r_t + r_n * r_n) * per_inertia),
        w_t=w_t,
        w_n=w_n,
        terms=(abs(f_x) + abs(f_y)) * per_mass + (abs(r_t) + abs(r_n)) * abs(alpha) + centripetal,
        friction=min(contact.friction, LARGEST_NUMBER),
        load=math.sqrt(force) + centripetal / math.sqrt(per_mass),
        accuracy=accuracy,
    )
    if abs(w_n) <= axes.tolerance(axes.along(0.0, 1.0), axes.terms):
        axes = axes._replace(w_n=0.0)
    return axes


def _separating(axes: _ContactAxes) -> _Solution | _Failure:
    if axes.w_n > 0.0:
        return _Solution(0.0, 0.0, axes.w_t, axes.w_n, unique=True)
    return _Failure(Refusal.PENETRATES if axes.w_n < 0.0 else Refusal.WRONG_MOTION, axes.w_n)


def _sliding(axes: _ContactAxes, *, direction: float, at_rest: bool) -> _Solution | _Failure:
    """Try to slide in ``direction`` (left -1, right +1): a_n = 0 and f_t = -direction mu f_n."""
    slope = -direction * axes.friction
    arm = axes.r_t - slope * axes.r_n
    factor = axes.per_mass + axes.r_t * arm * axes.per_inertia  # c + slope b, lecture 26, eq. 2
    gain = slope * axes.per_mass - axes.r_n * arm * axes.per_inertia  # b + slope a
    unique = abs(factor) > ROW_TOLERANCE * math.sqrt(axes.along(0.0, 1.0) * axes.along(slope, 1.0))
    if axes.w_n == 0.0:
        # Where the factor is zero too, any f_n keeps a_n at 0; friction then pushes against the sliding, so
        # that the contact slides with some force only if it does with none.
        f_n = part = 0.0
    elif not unique or (factor < 0.0 and axes.w_n < 0.0):
        return _Failure(Refusal.NO_SOLUTION, factor)
    else:
        f_n = -axes.w_n / factor
        part = -gain / factor
        if f_n < 0.0:
            return _Failure(Refusal.PULLS, f_n)
    a_t = axes.w_t + gain * f_n
    if at_rest:
        terms = axes.terms * (1.0 + abs(part))
        if direction * a_t <= axes.tolerance(axes.along(1.0, part), terms):
            return _Failure(Refusal.WRONG_MOTION, a_t)
    return _Solution(slope * f_n, f_n, a_t, 0.0, unique)


def _fixed(axes: _ContactAxes) -> _Solution | _Failure:
    a, c = axes.along(1.0, 0.0), axes.along(0.0, 1.0)
    b = -axes.r_t * axes.r_n * axes.per_inertia
    f_n = (b * axes.w_t - a * axes.w_n) / axes.det
    f_t = (b * axes.w_n - c * axes.w_t) / axes.det
    terms_n, terms_t = (abs(b) + a) * axes.terms / axes.det, (abs(b) + c) * axes.terms / axes.det
    if f_n < -axes.tolerance(a / axes.det, terms_n):
        return _Failure(Refusal.PULLS, f_n)
    excess = abs(f_t) - axes.friction * f_n
    square = axes.along(math.copysign(axes.friction, f_t), 1.0) / axes.det
    if excess > axes.tolerance(square, terms_t + axes.friction * terms_n):
        return _Failure(Refusal.OUTSIDE_CONE, excess)
    f_n = max(f_n, 0.0)
    edge = axes.friction * f_n  # rounding at the cone's apex and edges is taken out
    return _Solution(max(-edge, min(edge, f_t)), f_n, 0.0, 0.0, unique=True)


def _mode(
    letter: str, solution: _Solution, body: PlanarBody, contact: PlanarContact, wrench: PlanarWrench
) -> PlanarMode:
    f_t, f_n, a_t, a_n, unique = solution
    n_x, n_y = contact.normal
    r_x, r_y = contact.r
    f_x = f_t * n_y + f_n * n_x
    f_y = f_n * n_y - f_t * n_x
    acceleration: Vector2 = ((wrench.f[0] + f_x) / body.mass, (wrench.f[1] + f_y) / body.mass)
    return PlanarMode(
        mode=letter,
        acceleration=acceleration,
        angular_acceleration=(wrench.moment + r_x * f_y - r_y * f_x) / body.inertia,
        contact_forces=((f_t, f_n),),
        contact_accelerations=((a_t, a_n),),
        forces_unique=unique,
        motion_unique=unique,
    )
