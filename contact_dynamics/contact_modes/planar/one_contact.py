# SPDX-License-Identifier: Apache-2.0
"""This file finds the modes of one planar contact in closed form, case by case (Mason, lecture 26).

The model is a rigid body that touches the fixed world in one point with Coulomb friction. In contact axes the
contact's acceleration is affine in the contact force,

    a_t = w_t + a f_t + b f_n,        a_n = w_n + b f_t + c f_n,

where w is the acceleration without a contact force, with the terms of velocities. Each letter adds two
equations, and their solution is kept if it contradicts no inequality of the letter. All numbers are plain
floats, so that an answer takes microseconds.

Several contacts (`answer`) and moving surfaces are not covered.
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
    """Force and acceleration of the contact that solve the equations of a letter.

    Attributes:
        f_t: N, the tangential force.
        f_n: N, the normal force.
        a_t: m/s^2, the tangential acceleration.
        a_n: m/s^2, the normal acceleration.
        unique: Whether force and motion are the only ones with this letter.
    """

    f_t: float
    f_n: float
    a_t: float
    a_n: float
    unique: bool


class _Failure(NamedTuple):
    """The reason against a letter, with the amount in the unit that the refusal states."""

    refusal: Refusal
    amount: float


class _ContactAxes(NamedTuple):
    """The problem in contact axes.

    Attributes:
        r_t: m, the tangential part of the contact's position from the centre of mass.
        r_n: m, the normal part of that position.
        per_mass: 1/kg, the inverse mass.
        per_inertia: 1/(kg m^2), the inverse inertia.
        det: 1/kg^2, the determinant a c - b^2, which is positive.
        w_t: m/s^2, the tangential acceleration without a contact force.
        w_n: m/s^2, the normal acceleration without a contact force.
        alpha: rad/s^2, the angular acceleration without a contact force.
        u_t: m/s^2, the part of w_t that does not come from it.
        u_n: m/s^2, the part of w_n that does not come from it.
        terms: m/s^2, the sum of the absolute terms of w_t and w_n, which bounds their rounding.
        friction: The coefficient of friction.
        load: N/kg^(1/2), the size of (f, moment / rho) and of the forces that the centripetal terms need,
            divided by the root of the mass.
        accuracy: The relative tolerance.
    """

    r_t: float
    r_n: float
    per_mass: float
    per_inertia: float
    det: float
    w_t: float
    w_n: float
    alpha: float
    u_t: float
    u_n: float
    terms: float
    friction: float
    load: float
    accuracy: float

    def along(self, t: float, n: float) -> float:
        """Return the square of the row of t a_t + n a_n, 1/kg.

        The row says by how much a change of the wrench changes that sum.
        """
        arm = n * self.r_t - t * self.r_n
        return (t * t + n * n) * self.per_mass + arm * arm * self.per_inertia

    def tolerance(self, square: float, terms: float = 0.0) -> float:
        """Return the value up to which a linear function of the wrench counts as zero.

        A change of the wrench by the share ``accuracy`` can turn the sign of such a value, or the rounding of
        its terms can.

        Args:
            square: The square of the function's row, which `along` returns for accelerations.
            terms: The sum of the absolute terms of the function, in its unit.
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
    """Return consistent modes, refused modes and the tolerance of accelerations, m/s^2.

    The contact's normal velocity must be zero.

    Args:
        body: The mass and the angular inertia.
        contact: The contact.
        wrench: The wrench on the body besides that of the contact force.
        v_t: m/s, the tangential velocity of the contact. An exact 0 means that it is at rest.
        w: rad/s, the angular velocity of the body.
        accuracy: The relative size up to which a number counts as zero.
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
    rolling = contact.gap_acceleration(v_t, w)
    u_t = (f_x * n_y - f_y * n_x) * per_mass - w * w * r_t
    u_n = (f_x * n_x + f_y * n_y) * per_mass - w * w * r_n + rolling
    force = (f_x * f_x + f_y * f_y) * per_mass + wrench.moment * alpha
    centripetal = w * w * (abs(r_t) + abs(r_n)) + abs(rolling)
    det = per_mass * (per_mass + (r_t * r_t + r_n * r_n) * per_inertia)
    w_t = u_t - r_n * alpha
    w_n = u_n + r_t * alpha
    terms = (abs(f_x) + abs(f_y)) * per_mass + (abs(r_t) + abs(r_n)) * abs(alpha) + centripetal
    friction = min(contact.friction, LARGEST_NUMBER)
    load = math.sqrt(force) + centripetal / math.sqrt(per_mass)
    # By position, which is faster than by name, and the names are the same.
    axes = _ContactAxes(
        r_t, r_n, per_mass, per_inertia, det, w_t, w_n, alpha, u_t, u_n, terms, friction, load, accuracy
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
    sizes = axes.per_mass + (axes.r_t * axes.r_t + abs(slope * axes.r_t * axes.r_n)) * axes.per_inertia
    unique = abs(factor) > ROW_TOLERANCE * sizes
    if axes.w_n == 0.0:
        # If the factor is zero too, any f_n keeps a_n at 0. Friction then pushes against the sliding, so the
        # contact slides with some force only if it slides without any.
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
    # In (b w_t - a w_n) and (b w_n - c w_t) the terms of the angular acceleration cancel except for one each.
    # The others are left out, because their rounding is large if the contact is far from the centre of mass.
    u_t, u_n, alpha = axes.u_t, axes.u_n, axes.alpha
    f_n = (b * u_t - a * u_n - axes.per_mass * axes.r_t * alpha) / axes.det
    f_t = (b * u_n - c * u_t + axes.per_mass * axes.r_n * alpha) / axes.det
    terms_n, terms_t = (abs(b) + a) * axes.terms / axes.det, (abs(b) + c) * axes.terms / axes.det
    if f_n < -axes.tolerance(a / axes.det, terms_n):
        return _Failure(Refusal.PULLS, f_n)
    excess = abs(f_t) - axes.friction * f_n
    square = axes.along(math.copysign(axes.friction, f_t), 1.0) / axes.det
    if excess > axes.tolerance(square, terms_t + axes.friction * terms_n):
        return _Failure(Refusal.OUTSIDE_CONE, excess)
    f_n = max(f_n, 0.0)
    edge = axes.friction * f_n  # the force is moved by its rounding, so that it does not leave the cone
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
