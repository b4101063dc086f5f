# SPDX-License-Identifier: Apache-2.0
"""Every mode of a planar body that is consistent with mechanics (Mason, lecture 26).

The model is a rigid body in the plane that touches the world with Coulomb friction, under an applied
wrench. A contact that sticks has static friction; one that slides or begins to slide has friction. A contact
is a point of the body on a flat of the world, unless its curvatures say otherwise (`PlanarContact`). A mode
says which contact equations hold. It is kept if the accelerations that follow contradict none of its letters.
The lecture's table decides, and is as strict: a normal force may be zero, and a contact with the letter `s`
needs v_n > 0 or a_n > 0.

A contact's velocity within `velocity_tolerance` counts as zero. An angular velocity counts as zero if it
moves no contact relative to the centre of mass by more than that.

The modes of one contact have a closed form, which takes microseconds in plain floats. In contact axes, the
contact's acceleration is affine in the contact force,

    a_t = w_t + a f_t + b f_n,        a_n = w_n + b f_t + c f_n,

where w is the acceleration without a contact force, with the terms of velocities. Each letter adds two
equations, and their solution is kept if it contradicts no inequality of the letter.

Elastic contacts are not covered. Problems whose surfaces move are seen from these (`surface_frame`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact_modes.letters import SEPARATES, SLIDES_LEFT, SLIDES_RIGHT, STICKS
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import Judged, judge_all
from contact_dynamics.contact_modes.planar.problem import (
    accuracy_of,
    beyond_grip,
    coincident,
    contact_accelerations,
    never_slipping,
    planar_case,
)
from contact_dynamics.contact_modes.result import (
    SOME_MODE,
    ModeVerdict,
    PlanarMode,
    PlanarModeAnswer,
    Refusal,
    RefusedMode,
    verdict_on,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench, Vector2
from contact_dynamics.tolerances import (
    LARGEST_GRIP,
    LARGEST_NUMBER,
    LARGEST_PLANAR_ARM,
    ROW_TOLERANCE,
    SUM_ROUNDING,
)

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.planar.enumeration import Cell
    from contact_dynamics.contact_modes.planar.problem import PlanarCase, PlanarContactProblem

_TOO_FAR: Final = (
    f"a contact is more than {LARGEST_PLANAR_ARM:g} radii of gyration away, where rounding decides"
)


def planar_contact_modes(problem: PlanarContactProblem) -> PlanarModeAnswer:
    """Return the verdict on a contact set, all consistent modes, and why the others are refused.

    Without contacts the only mode is the empty string, and the body moves freely.
    """
    body, contacts, wrench = problem.body, problem.contacts, problem.wrench
    accuracy = accuracy_of(problem)
    velocities = problem.contact_velocities()
    approaching = tuple([i for i, (_, v_n) in enumerate(velocities) if v_n < 0.0])
    modes: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    undecided = ""
    undecided_modes: list[str] = []
    a_tolerance = 0.0
    if not approaching:
        if all(v_n > 0.0 for _, v_n in velocities):
            modes.append(_free_motion(problem))
        elif len(contacts) == 1:
            modes, refused, a_tolerance = single_contact_modes(
                body,
                contacts[0],
                wrench,
                v_t=velocities[0][0],
                w=_spin(problem),
                accuracy=accuracy,
            )
        else:
            same = coincident(contacts, velocities, body.radius_of_gyration)
            case = planar_case(
                problem,
                contacts if same is None else [contacts[i] for i in same.firsts],
                velocities if same is None else [velocities[i] for i in same.firsts],
            )
            (modes, refused, undecided_modes), undecided = _judged(case, accuracy)
            if same is not None:
                modes = [same.consistent(mode, accuracy * case.load) for mode in modes]
                refused = [same.refused(mode) for mode in refused]
                undecided_modes = [same.letters_of_all(mode) for mode in undecided_modes]
            a_tolerance = accuracy * case.load / body.mass
    found = tuple(modes)
    verdict = ModeVerdict.UNDECIDED if undecided else verdict_on(found)
    return PlanarModeAnswer(
        verdict=ModeVerdict.IMPACT if approaching else verdict,
        modes=found,
        refused=tuple(refused),
        approaching=approaching,
        contact_velocities=velocities,
        velocity_tolerance=problem.velocity_tolerance,
        acceleration_tolerance=a_tolerance,
        undecided=undecided,
        undecided_modes=tuple(undecided_modes),
        problem=problem,
    )


def _judged(case: PlanarCase, accuracy: float) -> tuple[Judged, str]:
    """Return what mechanics says about all modes of a case, and what is undecided and why."""
    cells = kinematic_cells(case)
    if any(row.size_n > LARGEST_PLANAR_ARM or row.size_t > LARGEST_PLANAR_ARM for row in case.rows):
        return Judged([], [], sorted(cells)), _TOO_FAR
    judged = judge_all(case, cells, accuracy)
    if any(contact.holding_friction > 1.0 and beyond_grip(contact, case.rho) for contact in case.contacts):
        return _whatever_the_grip(case, cells, accuracy, judged)
    if not judged.consistent and case.lift is None and all(row.slides == 0.0 for row in case.rows):
        return Judged([], [], sorted(cells)), SOME_MODE
    if judged.undecided:
        return judged, f"rounding decides whether forces bring about {', '.join(judged.undecided)}"
    return judged, ""


def _whatever_the_grip(
    case: PlanarCase, cells: dict[str, Cell], accuracy: float, judged: Judged
) -> tuple[Judged, str]:
    """Leave those modes undecided that are consistent only with less or only with infinite friction."""
    holding = {mode.mode for mode in judge_all(never_slipping(case), cells, accuracy).consistent}
    doubtful = {mode.mode for mode in judged.consistent}.symmetric_difference(holding).union(judged.undecided)
    if not doubtful:
        return judged, ""
    certain = Judged(
        [mode for mode in judged.consistent if mode.mode not in doubtful],
        [mode for mode in judged.refused if mode.mode not in doubtful],
        sorted(doubtful),
    )
    reason = (
        f"friction beyond {LARGEST_GRIP:g} over the arm in radii of gyration is not told apart, and it "
        f"decides about {', '.join(certain.undecided)}"
    )
    return certain, reason


def _spin(problem: PlanarContactProblem) -> float:
    w = problem.velocity.w
    if w == 0.0:
        return 0.0
    rho = problem.body.radius_of_gyration
    if all(abs(w) * contact.reach(rho) <= problem.velocity_tolerance for contact in problem.contacts):
        return 0.0
    return w


def _free_motion(problem: PlanarContactProblem) -> PlanarMode:
    body, contacts, wrench, w = problem.body, problem.contacts, problem.wrench, _spin(problem)
    a_x = wrench.f[0] / body.mass
    a_y = wrench.f[1] / body.mass
    alpha = wrench.moment / body.inertia
    return PlanarMode(
        mode=SEPARATES * len(contacts),
        acceleration=(a_x, a_y),
        angular_acceleration=alpha,
        contact_forces=((0.0, 0.0),) * len(contacts),
        contact_accelerations=tuple(contact_accelerations(contacts, (a_x, a_y), alpha, w)),
        forces_unique=True,
        motion_unique=True,
    )


class _Solution(NamedTuple):
    """Force and acceleration of the contact that solve the equations of a letter."""

    f_t: float  # N, the tangential force
    f_n: float  # N, the normal force
    a_t: float  # m/s^2, the tangential acceleration
    a_n: float  # m/s^2, the normal acceleration
    unique: bool  # whether force and motion are the only ones with this letter


class _Failure(NamedTuple):
    """The reason against a letter, with the amount in the unit that the refusal states."""

    refusal: Refusal
    amount: float


class _ContactAxes(NamedTuple):
    """The problem in contact axes."""

    r_t: float  # m, tangential part of the contact's position from the centre of mass
    r_n: float  # m, its normal part
    per_mass: float  # 1/kg, the inverse mass
    per_inertia: float  # 1/(kg m^2), the inverse inertia
    det: float  # 1/kg^2, the determinant a c - b^2, which is positive
    w_t: float  # m/s^2, the tangential acceleration without a contact force
    w_n: float  # m/s^2, the normal acceleration without a contact force
    alpha: float  # rad/s^2, the angular acceleration without a contact force
    u_t: float  # m/s^2, the part of w_t that does not come from it
    u_n: float  # m/s^2, the part of w_n that does not come from it
    terms: float  # m/s^2, the sum of the absolute terms of w_t and w_n, which bounds their rounding
    friction: float
    holding: float  # the coefficient of friction of a contact that sticks
    load: float  # N/kg^(1/2), size of (f, moment / rho) and centripetal forces, over the root of the mass
    accuracy: float  # the relative tolerance

    def along(self, t: float, n: float) -> float:
        """Return the square of the row of t a_t + n a_n, 1/kg.

        The row says by how much a change of the wrench changes that sum.
        """
        arm = n * self.r_t - t * self.r_n
        return (t * t + n * n) * self.per_mass + arm * arm * self.per_inertia

    def tolerance(self, square: float, terms: float = 0.0) -> float:
        """Return the value up to which a linear function of the wrench counts as zero.

        A change of the wrench by the share ``accuracy`` can turn the sign of such a value, or the rounding of
        its terms can. ``square`` is that of the function's row (`along`), and ``terms`` the sum of its
        absolute terms, in its unit.
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

    The contact's normal velocity must be zero. Its tangential velocity ``v_t``, m/s, is an exact 0 at rest.
    The body turns with ``w``, rad/s. A number up to the relative size ``accuracy`` counts as zero.
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
    mu = holding = min(contact.friction, LARGEST_NUMBER)
    if contact.static_friction is not None:
        holding = min(contact.static_friction, LARGEST_NUMBER)
    load = math.sqrt(force) + centripetal / math.sqrt(per_mass)
    # By position, which is faster than by name, and the names are the same.
    axes = _ContactAxes(
        r_t, r_n, per_mass, per_inertia, det, w_t, w_n, alpha, u_t, u_n, terms, mu, holding, load, accuracy
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
    excess = abs(f_t) - axes.holding * f_n
    square = axes.along(math.copysign(axes.holding, f_t), 1.0) / axes.det
    if excess > axes.tolerance(square, terms_t + axes.holding * terms_n):
        return _Failure(Refusal.OUTSIDE_CONE, excess)
    f_n = max(f_n, 0.0)
    edge = axes.holding * f_n  # rounding error must not move the force out of the cone
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
