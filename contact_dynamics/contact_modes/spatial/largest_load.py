# SPDX-License-Identifier: Apache-2.0
"""How much contacts hold: the largest load, acceleration, tilt and spin, the least friction, and closure.

All of it is that of Coulomb's round cones, whose sum is a convex cone of wrenches (`wrenches.RoundSum`). A
wrench outside of it is separated from it by a plane. Where the plane meets the path of the wrenches, the next
wrench is tried, which is nearer to the last one that the contacts hold, until they do. A limit of a normal
force is one more row beside those of the wrench: the normal force and what is left to its limit, which is
one more ray, add up to the limit. So the sum stays a convex cone.

A tray or turntable that accelerates, tilts or spins is at rest in its own frame, in which gravity is less its
acceleration. So a tilt turns gravity, and a spin adds a centrifugal force and a gyroscopic torque.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.pairs import pair_jacobians
from contact_dynamics.contact_modes.letters import STICKS, mode_in_words
from contact_dynamics.contact_modes.result import BodiesMode, ModeVerdict, does_turn
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.problem import load_at
from contact_dynamics.contact_modes.spatial.response import (
    BodiesContactProblem,
    bodies_contact_modes,
    for_each,
)
from contact_dynamics.contact_modes.spatial.wrenches import RoundSum
from contact_dynamics.contact_modes.surface_frame import seen_in_space
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.vectors import point_jacobians, tangents
from contact_dynamics.records import Record
from contact_dynamics.tolerances import (
    ANY_LOAD,
    LARGEST_NUMBER,
    NEAREST_REACHED,
    NEXT_TO_A_LIMIT,
    NO_LOAD,
    ONLY_REST_WITHIN,
    SAME_FACTOR,
    STRAIGHT_ARC,
    SUM_ROUNDING,
)
from contact_dynamics.validation import check_array, check_at_rest, check_magnitude, check_vector3

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes.result import BodiesModeAnswer, SpatialMode, SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.validation import FloatArray

_TURN: Final = 2.0 * math.pi

_UNITS: Final = {
    "times the load": "under any multiple of the load",
    "m/s^2": "at any acceleration",
    "rad": "at any tilt",
    "rad/s": "at any spin",
}


def _moving(modes: tuple[str, ...]) -> str:
    """Return words for modes of a body that does not stay at rest: if every contact sticks, it turns."""
    return " or ".join(mode_in_words(mode, turns=True) for mode in modes) or "no mode is consistent"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class LargestLoad(Record):
    """Largest load on a body at rest, as factors of a given load, or largest motion of its support.

    A circular rim that lies flush is represented by eight contacts. The tipping moment that a cup bears, and
    the tangent of the tilt at which it tips, are therefore those of an octagon: 92 % to 100 % of the true
    ones, depending on the direction.

    Attributes:
        factor: Factor up to which rest is consistent, with static friction, >= 0. It is infinite if rest is
            consistent under any factor.
        only_rest: Factor up to which rest is the only consistent mode, <= ``factor``, so that neither static
            nor kinetic friction allows another one. If it is less than
            ``factor``, it was found by bisection, to 1 %, and modes that are consistent only in an interval
            below it are not searched for. It is 0 if rest is not the only consistent mode without the load,
            or if that is undecided, as often for several bodies.
        verdict_beyond: Verdict just beyond ``factor``, or None if it is infinite. It is UNDECIDED if a
            contact is ``overloaded`` there: the motion depends on how this contact yields.
        modes_beyond: Modes that are consistent just beyond it; none if a contact is overloaded.
        unit: Unit of the factors: "times the load", "m/s^2", "rad" or "rad/s".
        overloaded: Indices of the contacts whose normal forces are at their limits at ``factor``, if rest
            would be consistent beyond it without these limits.
    """

    factor: float
    only_rest: float
    verdict_beyond: ModeVerdict | None
    modes_beyond: tuple[str, ...]
    unit: str = "times the load"
    overloaded: tuple[int, ...] = ()

    def in_short(self) -> str:
        """Return the largest load, and the modes that follow."""
        if math.isinf(self.factor):
            # Without the load another mode may be consistent already, as it is between two fingers.
            surely = f"it stays fixed up to {self.only_rest:.3g}, and may" if self.only_rest else "it may"
            surely = "it stays" if math.isinf(self.only_rest) else f"{surely} stay"
            return f"LargestLoad: {surely} fixed {_UNITS[self.unit]}"
        then = f"then {_moving(self.modes_beyond)}"
        if self.verdict_beyond == ModeVerdict.UNDECIDED and not self.modes_beyond:
            then = "then it is undecided what follows"
        if self.overloaded:
            which = ", ".join(str(contact) for contact in self.overloaded)
            then = f"limited by the maximum normal force of contact{'s' * (len(which) > 1)} {which}"
        fixed = f"it stays fixed up to {self.factor:.3g} {self.unit}"
        if self.only_rest < self.factor:  # beyond it another mode is consistent too
            surely = f"it stays fixed up to {self.only_rest:.3g}, and" if self.only_rest else "it"
            fixed = f"{surely} may stay fixed up to {self.factor:.3g} {self.unit}"
        return f"LargestLoad: {fixed}, {then}"


def largest_load(
    problem: SpatialContactProblem | BodiesContactProblem,
    *,
    force_W: ArrayLike | None = None,
    torque_W: ArrayLike = (0.0, 0.0, 0.0),
    at_W: ArrayLike | None = None,
    max_normal_forces: ArrayLike | None = None,
) -> LargestLoad:
    """Return the largest factor of a load, in addition to the problem's own wrench, before a body moves.

    With a load of 1 N, the factors are in newtons. Friction cones are round, and ``factor`` is exact to about
    1e-10. Where a circular rim lies flush, it is less by up to 8 % (`LargestLoad`).

    Args:
        problem: The contact problem with the wrench without the load, such as the weight alone, under which
            rest is consistent. On surfaces that move this is rest relative to them. If it has several bodies,
            its surfaces must be at rest.
        force_W: (3,), N, force of the load, world axes, or None for no force. For k bodies, (k, 3), here and
            below, or one vector for all.
        torque_W: (3,), N m, torque of the load about the centre of mass, in addition to that of the force,
            world axes.
        at_W: (3,), m, point at which the force acts, world axes, or None for the centre of mass.
        max_normal_forces: (n,) or one for all contacts, N, >= 0: the largest normal force of each contact,
            such as the force of a gripper. A limit may be infinite. By default, there are no limits.

    Raises:
        InvalidFieldError: rest is not consistent without the load, or not within ``max_normal_forces``; the
            load is below 1e-60 or not finite; or ``at_W`` is given without a force.
        NotSupportedError: surfaces do not move as one rigid body, or those of several bodies move.

    Examples:
        >>> import contact_dynamics as cd
        >>> crate = cd.Body.box((0.4, 0.3, 0.6), mass=20.0)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=0.0
        ... )
        >>> at_rest = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1])
        >>> problem = cd.SpatialContactProblem.of(crate, at_rest, cd.World(surfaces=(floor,)))
        >>> load = cd.largest_load(problem, force_W=[1, 0, 0], at_W=[-0.2, 0, 0.5])
        >>> print(f"{load.factor:.1f} N, then {load.modes_beyond}")
        78.5 N, then ('ssff',)
    """
    if isinstance(problem, BodiesContactProblem):
        places = np.array([one.p_WB_W for one in problem.states])
        checked: Callable[[str, ArrayLike], FloatArray] = partial(for_each, n=len(problem.bodies))
    else:
        places, checked = problem.state.p_WB_W, check_vector3
    load = np.hstack(load_at(checked, places, force_W=force_W, torque_W=torque_W, at_W=at_W)).ravel()
    size = float(np.abs(load).max())
    if not size * LARGEST_NUMBER >= 1.0:
        least = f"at least {1.0 / LARGEST_NUMBER:g} N in its largest component, or torque_W (N m)"
        raise InvalidFieldError("force_W", f"{size:g}", least)
    return _largest(problem, load, "largest_load", max_normal_forces)


def _largest(
    problem: SpatialContactProblem | BodiesContactProblem,
    load: FloatArray,
    call: str,
    max_normal_forces: ArrayLike | None,
    unit: str = "times the load",
) -> LargestLoad:
    """Return the largest factor of a load, (6 k,), of k bodies, which may be zero."""
    if isinstance(problem, BodiesContactProblem):
        check_at_rest("problem.contacts", problem.contacts, f"{call} of several bodies")
    else:
        problem = seen_in_space(problem, as_one=call)
    held = _Held.of(problem, max_normal_forces)
    start, added = held.limited(problem.wrench_W), held.free(load)

    def wrench(factor: float) -> FloatArray:
        return added if math.isinf(factor) else start + factor * added

    def nearer(plane: FloatArray, factor: float) -> float:  # noqa: ARG001  a line meets a plane once
        return -float(plane @ start) / float(plane @ added)

    size = float(np.linalg.norm(load))
    far = ANY_LOAD * max(1.0, float(np.linalg.norm(problem.wrench_W)) / size) if size else 1.0
    _check_rests(problem, held)
    return _followed(problem, held, wrench, _last_held(held, wrench, nearer, math.inf), far=far, unit=unit)


def largest_acceleration(
    problem: SpatialContactProblem | BodiesContactProblem,
    direction_W: ArrayLike,
    *,
    max_normal_forces: ArrayLike | None = None,
) -> LargestLoad:
    """Return the largest acceleration of a support, such as a tray or a truck, before a body moves on it.

    Args:
        problem: The contact problem of the support at rest. All contacts belong to the support, or are
            between bodies. If the support of one body moves, the result is in addition to its present
            acceleration.
        direction_W: (3,), direction of the acceleration, world axes. Its length is ignored. A truck that
            drives forward and brakes accelerates backward.
        max_normal_forces: (n,) or one for all contacts, N, as in `largest_load`.

    Returns:
        The largest acceleration, m/s^2.

    Raises:
        InvalidFieldError: rest is not consistent without the motion, or the direction is zero or not finite.
    """
    direction = _direction("direction_W", direction_W)
    bodies = problem.bodies if isinstance(problem, BodiesContactProblem) else (problem.body,)
    load = np.concatenate([_of_force(-body.mass * direction) for body in bodies])
    return _largest(problem, load, "largest_acceleration", max_normal_forces, "m/s^2")


def largest_spin(
    problem: SpatialContactProblem,
    axis_W: ArrayLike,
    *,
    at_W: ArrayLike = (0.0, 0.0, 0.0),
    max_normal_forces: ArrayLike | None = None,
) -> LargestLoad:
    """Return the largest steady spin of a support, such as a turntable, before the body moves on it.

    Args:
        problem: The contact problem of the support at rest. All contacts belong to the support.
        axis_W: (3,), direction of the axis, world axes. Its length is ignored.
        at_W: (3,), m, point on the axis, world axes.
        max_normal_forces: (n,) or one for all contacts, N, as in `largest_load`.

    Returns:
        The largest angular velocity, rad/s. It is infinite about a principal axis through the centre of mass,
        because such a spin does not load the body.

    Raises:
        InvalidFieldError: rest is not consistent without the motion, or the axis is zero or not finite.
    """
    check_at_rest("problem.contacts", problem.contacts, "largest_spin")
    axis = _direction("axis_W", axis_W)
    at, centre = check_vector3("at_W", at_W), problem.state.p_WB_W
    outward = centre - at - ((centre - at) @ axis) * axis
    momentum = problem.body.inertia_in_world(problem.state.R_WB) @ axis
    turning = -np.cross(axis, momentum)
    # Rounding would otherwise load a body that spins about its own principal axis.
    outward = outward * (np.abs(outward).max() > SUM_ROUNDING * max(np.abs(at).max(), np.abs(centre).max()))
    turning = turning * (np.abs(turning).max() > SUM_ROUNDING * np.abs(momentum).max())
    load = np.concatenate([problem.body.mass * outward, turning])
    size = float(np.linalg.norm(load)) or 1.0  # at 1 rad/s
    found = _largest(problem, load / size, "largest_spin", max_normal_forces, "rad/s")
    factor, only_rest = math.sqrt(found.factor / size), math.sqrt(found.only_rest / size)
    return replace(found, factor=factor, only_rest=only_rest)


def largest_tilt(
    problem: SpatialContactProblem,
    axis_W: ArrayLike,
    *,
    gravity_W: ArrayLike | None = None,
    max_normal_forces: ArrayLike | None = None,
) -> LargestLoad:
    """Return the largest tilt of a support, such as a tray, before the body moves on it.

    Args:
        problem: The contact problem of the support before the tilt. All contacts belong to the support. The
            force includes the weight; other forces, and the torque, turn with the support.
        axis_W: (3,), axis of the tilt by the right-hand rule, world axes. Its length is ignored.
        gravity_W: (3,), m/s^2, world axes, or None if the force of the problem is the weight alone.
        max_normal_forces: (n,) or one for all contacts, N, as in `largest_load`.

    Returns:
        The largest angle of a slow tilt, rad. Rest is consistent at all angles below it. It is infinite if
        rest is consistent throughout a full turn.

    Raises:
        InvalidFieldError: rest is not consistent without the motion, the axis is zero or not finite, or
            gravity is along it.
    """
    check_at_rest("problem.contacts", problem.contacts, "largest_tilt")
    axis, weight = _direction("axis_W", axis_W), problem.force_W
    if gravity_W is not None:
        weight = problem.body.mass * check_vector3("gravity_W", gravity_W)
    down, side = weight - (axis @ weight) * axis, -np.cross(axis, weight)
    if np.linalg.norm(down) <= SAME_FACTOR * np.linalg.norm(weight):
        raise InvalidFieldError("axis_W, gravity_W", axis.tolist(), "an axis at an angle to gravity")
    held = _Held.of(problem, max_normal_forces)
    still = held.limited(problem.wrench_W - _of_force(down))
    turning = np.array([held.free(_of_force(down)), held.free(_of_force(side))])

    def wrench(angle: float) -> FloatArray:
        found: FloatArray = still + np.array([math.cos(angle), math.sin(angle)]) @ turning
        return found

    def nearer(plane: FloatArray, angle: float) -> float:
        """Return the smaller angle at which c + a cos + b sin, of the plane, falls through zero."""
        a, b = (turning @ plane).tolist()
        size = math.hypot(a, b)
        if size == 0.0:
            return 0.0
        ahead = math.acos(max(-1.0, min(1.0, -float(still @ plane) / size)))
        further = (math.atan2(b, a) + ahead - angle) % _TURN
        # Near the limit, rounding may turn the plane so that this is a little further.
        return angle if further <= STRAIGHT_ARC else max(0.0, angle - _TURN + further)

    _check_rests(problem, held)
    angle = _last_held(held, wrench, nearer, _TURN)
    while (between := _not_held(held, wrench, 0.0, angle)) > 0.0:
        angle = _last_held(held, wrench, nearer, between)
    angle = math.inf if angle == _TURN else angle
    return _followed(problem, held, wrench, angle, far=math.pi, unit="rad")


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class LeastFriction(Record):
    """Smallest friction with which a body can stay at rest.

    Attributes:
        factor: Smallest factor of the given coefficients with which rest is consistent. It is 0 if the body
            rests without friction, and infinite if no friction holds it. Below 1e-9, only rounding error
            prevents an even smaller one.
        frictions: (n,), these smallest coefficients, of static friction if that is larger.
        verdict_below: Verdict with coefficients that are smaller by 1e-6 of them, or None if the factor is
            0. It is UNDECIDED if rest then requires larger normal forces than those allowed.
        modes_below: Consistent modes with these coefficients; none if larger normal forces are required.
    """

    factor: float
    frictions: tuple[float, ...]
    verdict_below: ModeVerdict | None
    modes_below: tuple[str, ...]

    def in_short(self) -> str:
        """Return the coefficients, and the modes that follow with less friction."""
        if math.isinf(self.factor):
            return "LeastFriction: no friction holds it"
        if self.factor == 0.0:
            return "LeastFriction: it stays fixed without friction"
        if self.factor < SAME_FACTOR:
            return "LeastFriction: it may stay fixed with any friction above 0, with large contact forces"
        low, high = min(self.frictions), max(self.frictions)
        needed = f"{high:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
        then = f"with less, {_moving(self.modes_below)}"
        if self.verdict_below == ModeVerdict.UNDECIDED and not self.modes_below:
            then = "with less, not within the largest normal forces"
        return f"LeastFriction: it may stay fixed with a friction of {needed}; {then}"


def least_friction(
    problem: SpatialContactProblem, *, max_normal_forces: ArrayLike | None = None
) -> LeastFriction:
    """Return the smallest friction with which a body can stay at rest under the problem's wrench.

    All coefficients of friction, static ones included, are scaled by the same factor, and the body is treated
    as at rest. With this friction or more, rest is consistent, with contact forces of any size, or within
    ``max_normal_forces``: fingers that press on a body from opposite sides have to press hard enough.
    `contact_modes` determines whether rest is the only consistent mode. The factor is exact to about 1e-7, or
    too large by up to 1e-4 of it if contact forces have to exceed the applied wrench many times.

    Args:
        problem: The contact problem, with coefficients of friction > 0 at contacts with friction.
        max_normal_forces: (n,) or one for all contacts, N, as in `largest_load`.

    Raises:
        InvalidFieldError: no contact has friction, and the body does not rest without it.
        NotSupportedError: surfaces do not move as one rigid body.
    """
    problem = seen_in_space(problem, as_one="least_friction", resting=True)
    state = replace(problem.state, v_WB_W=np.zeros(3), w_WB_W=np.zeros(3))
    below = None

    def scaled(factor: float) -> SpatialContactProblem:
        contacts, static = problem.contacts, problem.contacts.static_frictions
        static = None if static is None else factor * static
        contacts = replace(contacts, frictions=factor * contacts.frictions, static_frictions=static)
        return replace(problem, state=state, contacts=contacts)

    def slips(factor: float) -> bool:
        held = _Held.of(scaled(factor), max_normal_forces)
        return bool(held.against(held.limited(problem.wrench_W)).any())

    low, factor = 0.0, 1.0 if slips(0.0) else 0.0
    if factor > 0.0 and not problem.contacts.holding_frictions.any():
        raise InvalidFieldError("problem.contacts.frictions", "zeros", "> 0 where there is friction")
    while factor * SAME_FACTOR < 1.0 and slips(factor):
        low, factor = factor, 2.0 * factor
    if factor * SAME_FACTOR >= 1.0:
        factor = math.inf
    while math.isfinite(factor) and factor - low > SAME_FACTOR * factor:
        middle = 0.5 * (low + factor)
        low, factor = (middle, factor) if slips(middle) else (low, middle)
    if math.isinf(factor):
        below = spatial_contact_modes(scaled(1.0))
    elif factor > 0.0:
        below = spatial_contact_modes(scaled(factor * (1.0 - NEXT_TO_A_LIMIT)))
    rest = STICKS * len(problem.contacts)
    modes = () if below is None else tuple(mode.mode for mode in below.modes)
    verdict = None if below is None else below.verdict
    if max_normal_forces is not None and rest in modes:
        verdict, modes = ModeVerdict.UNDECIDED, ()
    return LeastFriction(
        factor=factor,
        frictions=tuple(
            (factor * friction if friction else 0.0)
            for friction in problem.contacts.holding_frictions.tolist()
        ),
        verdict_below=verdict,
        modes_below=modes,
    )


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Closure(Record):
    """Form closure and force closure: whether contacts hold a body against every wrench.

    Attributes:
        form: Whether they do without friction, so that the body cannot move: first-order form closure.
        force: Whether they do with (static) friction, if the contacts are pressed together strongly enough:
            force closure.
    """

    form: bool
    force: bool

    def in_short(self) -> str:
        """Return the kinds of closure that the contacts have."""
        found = [name for name, there in (("form", self.form), ("force", self.force)) if there]
        return f"Closure: {' and '.join(found) if found else 'neither form nor force'} closure"


def closure(contacts: ContactSet) -> Closure:
    """Return whether contacts have form closure and force closure (lecture 26).

    Contacts have closure if their contact forces, of any size, can produce every wrench in R^6. Closure does
    not imply that fingers press strongly enough.
    """
    if len(contacts) == 0:
        return Closure(form=False, force=False)
    points = check_magnitude("contacts.p_WC_W", contacts.p_WC_W)
    arms = points - points.mean(axis=0)
    length = float(np.linalg.norm(arms, axis=1).max()) or 1.0

    def closes(share: float) -> bool:
        held = _Held(contacts, point_jacobians(arms), np.repeat([1.0, length], 3), share)
        return not any(held.against(wrench).any() for wrench in (*held.units, *-held.units))

    force = closes(1.0)
    return Closure(form=force and closes(0.0), force=force)


class _Held:
    """The wrenches, force, N, and torque, N m, of one body or each of several that contacts can balance.

    Behind the numbers of the wrenches stands the limit, N, of each normal force that has one, negative.
    """

    def __init__(
        self,
        contacts: ContactSet,
        jacobians: FloatArray,
        lengths: FloatArray,
        share: float = 1.0,
        limits: ArrayLike | None = None,
    ) -> None:
        """Take Jacobians (n, 3, d), units (d,) of the wrenches, a factor of friction, and limits, N."""
        n = len(contacts)
        most = np.full(n, np.inf) if limits is None else _checked_limits(limits, n)
        self._which = np.flatnonzero(np.isfinite(most) & (most > 0.0))
        self._limits, self._without = most[self._which], np.flatnonzero(most == 0.0)
        self._size = len(lengths)
        self._scale = np.concatenate([lengths, self._limits])
        self.units = np.diag(self._scale)
        normals, rows, acts = contacts.normals_W, np.eye(n)[:, self._which], most > 0.0
        along = np.array([tangents((x, y, z)) for x, y, z in normals.tolist()]).reshape(-1, 2, 3)
        lean = share * np.minimum(contacts.holding_frictions, LARGEST_NUMBER)[:, None, None] * along
        leans = [lean @ jacobians, np.zeros((n, 2, len(self._which)))]
        self._sum = RoundSum(
            rays=np.eye(len(self._scale))[self._size :],
            axes=(np.hstack([np.einsum("ni,nid->nd", normals, jacobians), rows]) / self._scale)[acts],
            leans=(np.concatenate(leans, axis=2) / self._scale)[acts],
        )

    @classmethod
    def of(
        cls, problem: SpatialContactProblem | BodiesContactProblem, limits: ArrayLike | None = None
    ) -> _Held:
        """Return those of a problem with limits of its normal forces, (n,) or one, N."""
        contacts = problem.contacts
        if isinstance(problem, BodiesContactProblem):
            jacobians, bodies = pair_jacobians(problem.states, contacts.p_WC_W, problem.pairs), problem.bodies
        else:
            jacobians, bodies = point_jacobians(contacts.p_WC_W - problem.state.p_WB_W), (problem.body,)
        lengths = np.repeat([(1.0, body.mean_radius_of_gyration) for body in bodies], 3)
        return cls(contacts, jacobians, lengths, limits=limits)

    def limited(self, wrench_W: FloatArray) -> FloatArray:
        """Return a wrench with the limits behind it."""
        return np.concatenate([wrench_W, -self._limits])

    def free(self, wrench_W: FloatArray) -> FloatArray:
        """Return a change of a wrench, which leaves the limits as they are."""
        return np.concatenate([wrench_W, 0.0 * self._limits])

    def at_limits(self, plane: FloatArray) -> tuple[int, ...]:
        """Return the contacts whose limits keep a load from growing to the other side of a plane."""
        shares = -plane[self._size :] * self._limits
        at_limits = self._which[shares > NEXT_TO_A_LIMIT * shares.sum()]
        return tuple(np.union1d(at_limits, self._without).tolist())

    def against(self, wrench_W: FloatArray) -> FloatArray:
        """Return a plane that separates a wrench from what can be balanced, or zeros if it can be."""
        # In these units each limit is as large as the wrench, so neither hides the other's error.
        units = np.ones(len(self._scale))
        units[self._size :] = np.linalg.norm((wrench_W / self._scale)[: self._size])
        target = -wrench_W / self._scale * units
        found = RoundSum(self._sum.rays, self._sum.axes * units, self._sum.leans * units).rest(target)
        apart = NEAREST_REACHED * np.linalg.norm(target) * np.linalg.norm(found)
        plane: FloatArray = found / self._scale * units
        return plane if found @ target > apart else 0.0 * plane


def _last_held(
    held: _Held,
    wrench: Callable[[float], FloatArray],
    nearer: Callable[[FloatArray, float], float],
    start: float,
) -> float:
    """Return the largest factor up to ``start`` at which a wrench is held; below it, others may not be.

    The largest smaller factor at which the wrench is in a plane is ``nearer``.
    """
    factor = start
    plane = held.against(wrench(factor))
    while plane.any():
        before = nearer(plane, factor)
        if not before < factor * (1.0 - SAME_FACTOR):
            break
        factor = before
        plane = held.against(wrench(factor))
    return max(factor, 0.0)


def _not_held(held: _Held, wrench: Callable[[float], FloatArray], first: float, last: float) -> float:
    """Return an angle between two at which a wrench that turns is not held, or 0 if there is none.

    Both are held. The wrenches between them are in the triangle with the point where the tangents of their
    arc meet, and what is held is convex.
    """
    if last - first <= STRAIGHT_ARC:
        return 0.0
    middle = 0.5 * (first + last)
    half = wrench(middle)
    if last - first <= 0.5 * math.pi:
        chord = 0.5 * (wrench(first) + wrench(last))
        corner = chord + (half - chord) * (1.0 + 1.0 / math.cos(middle - first))
        if not held.against(corner).any():
            return 0.0
    if held.against(half).any():
        return middle
    return _not_held(held, wrench, first, middle) or _not_held(held, wrench, middle, last)


def _modes_under(
    problem: SpatialContactProblem | BodiesContactProblem, wrench_W: FloatArray
) -> SpatialModeAnswer | BodiesModeAnswer:
    """Return the modes under other wrenches of the bodies than the problem's own."""
    wrenches = wrench_W.reshape(-1, 2, 3)
    if isinstance(problem, BodiesContactProblem):
        return bodies_contact_modes(replace(problem, forces_W=wrenches[:, 0], torques_W=wrenches[:, 1]))
    return spatial_contact_modes(replace(problem, force_W=wrenches[0, 0], torque_W=wrenches[0, 1]))


def _followed(
    problem: SpatialContactProblem | BodiesContactProblem,
    held: _Held,
    wrench: Callable[[float], FloatArray],
    factor: float,
    *,
    far: float,
    unit: str = "times the load",
) -> LargestLoad:
    """Return up to which factor rest is the only consistent mode, and what follows beyond the largest one."""
    rest = STICKS * len(problem.contacts)

    def answer(factor: float) -> SpatialModeAnswer | BodiesModeAnswer:
        return _modes_under(problem, wrench(factor)[: len(problem.wrench_W)])

    def rests_alone(factor: float) -> bool:
        found = answer(factor)
        return found.verdict == ModeVerdict.UNIQUE and found.modes[0].mode == rest

    if math.isinf(factor):
        alone = math.inf if rests_alone(far) else _last(rests_alone, far)
        return LargestLoad(factor=factor, only_rest=alone, verdict_beyond=None, modes_beyond=(), unit=unit)
    beyond, inside = factor * (1.0 + NEXT_TO_A_LIMIT), factor * (1.0 - NEXT_TO_A_LIMIT)
    after, plane = answer(beyond), held.against(wrench(beyond))
    overloaded = held.at_limits(plane) if rest in {mode.mode for mode in after.modes} else ()
    return LargestLoad(
        factor=factor,
        only_rest=factor if rests_alone(inside) else _last(rests_alone, inside),
        verdict_beyond=ModeVerdict.UNDECIDED if overloaded else after.verdict,
        modes_beyond=() if overloaded else tuple(mode.mode for mode in after.modes),
        unit=unit,
        overloaded=overloaded,
    )


def _check_rests(problem: SpatialContactProblem | BodiesContactProblem, held: _Held) -> None:
    found = _modes_under(problem, problem.wrench_W)
    plane = held.against(held.limited(problem.wrench_W))
    is_over = plane.any() and bool(held.at_limits(plane))
    # Several bodies may fall together with all contacts fixed.
    falls = isinstance(problem, BodiesContactProblem) and plane.any() and not is_over
    rest = STICKS * len(problem.contacts)
    if falls or not any(mode.mode == rest and not _turns(mode) for mode in found.modes):
        raise InvalidFieldError(
            "problem",
            found.in_short(),
            "one of a body that stays fixed without the additional load or motion",
        )
    if is_over:
        needed = "limits within which normal forces balance the problem's own wrench"
        raise InvalidFieldError("max_normal_forces", "smaller ones", needed)


def _turns(mode: SpatialMode | BodiesMode) -> bool:
    return does_turn(
        mode.angular_accelerations_W if isinstance(mode, BodiesMode) else mode.angular_acceleration_W
    )


def _checked_limits(limits: ArrayLike, n: int) -> FloatArray:
    """Return limits of normal forces, (n,), N, checked: each is >= 0, and may be infinite."""
    name, given = "max_normal_forces", np.full(n, limits) if np.ndim(limits) == 0 else limits
    most = check_array(name, given, (n,), infinite=True)
    check_magnitude(name, np.where(np.isinf(most), 0.0, most))
    if most.min(initial=0.0) < 0.0:
        raise InvalidFieldError(name, most.tolist(), ">= 0")
    return most


def _direction(name: str, vector: ArrayLike) -> FloatArray:
    """Return a vector as a unit vector."""
    checked = check_vector3(name, vector)
    size = float(np.linalg.norm(checked))
    if size == 0.0:
        raise InvalidFieldError(name, checked.tolist(), "a direction")
    return checked / size


def _of_force(force: FloatArray) -> FloatArray:
    return np.concatenate([force, np.zeros(3)])


def _last(holds: Callable[[float], bool], beyond: float) -> float:
    """Return a factor below ``beyond`` up to which something holds, by halving, or 0 if at most there."""
    if not (holds(0.0) and holds(NO_LOAD * beyond)):
        return 0.0
    inside = 0.0
    while beyond - inside > ONLY_REST_WITHIN * beyond:
        middle = 0.5 * (inside + beyond)
        if holds(middle):
            inside = middle
        else:
            beyond = middle
    return inside
