# SPDX-License-Identifier: Apache-2.0
"""Problems whose surfaces move, as they are seen from the surfaces.

Where all surfaces that a body touches move as one rigid body, such as a tray, a cart or a turntable, they
stand still in their own frame. There the body has its velocity relative to the frame, and the applied wrench
has inertial parts. Let the frame turn with W and A = dW/dt, and let its point at the centre of mass have the
velocity v_S and the acceleration a_S. The body has mass m and inertia I, and v and w relative to the frame:

    f' = f - m (a_S + 2 W x v),
    torque' = torque - (W + w) x I (W + w) + w x I w - I (A + W x w).

Contact forces are the same in both frames. To the accelerations found in the frame, those parts are added
again. So every call that takes surfaces at rest takes these, exactly.

In space, other surfaces that move keep a velocity and an acceleration at each contact (`spatial.problem`). In
the plane, a body that does not turn may touch surfaces with different velocities, such as two belts, since
only the direction of sliding differs.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes.planar.problem import AT_REST, PlanarContactProblem
from contact_dynamics.contact_modes.planar.wrench_sets import WrenchHalfSpace
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.numerics.vectors import point_jacobians
from contact_dynamics.plane.types import PlanarVelocity, PlanarWrench
from contact_dynamics.tolerances import ROW_TOLERANCE, SURFACES_AS_ONE
from contact_dynamics.validation import check_at_rest, check_magnitude

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet
    from contact_dynamics.contact_modes.result import PlanarModeAnswer, SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
    from contact_dynamics.plane.types import PlanarContact, Vector2
    from contact_dynamics.validation import FloatArray


_SEEN: Final = "state, contacts: velocities and inertial wrench relative to surfaces that move"


class SpatialFrame(NamedTuple):
    """A problem as it is seen from the surfaces, and the way back."""

    problem: SpatialContactProblem
    acceleration_W: FloatArray  # (3,), m/s^2, to be added to those of the centre of mass
    angular_acceleration_W: FloatArray  # (3,), rad/s^2, to be added
    wrench_W: FloatArray  # (6,), N and N m, to be added to wrenches in the frame, which gives applied ones

    def answer_in_world(self, answer: SpatialModeAnswer, problem: SpatialContactProblem) -> SpatialModeAnswer:
        """Return the answer to a problem from that of its frame."""
        modes = tuple(
            replace(
                mode,
                acceleration_W=mode.acceleration_W + self.acceleration_W,
                angular_acceleration_W=mode.angular_acceleration_W + self.angular_acceleration_W,
            )
            for mode in answer.modes
        )
        return replace(answer, modes=modes, problem=problem)

    def sets_in_world(self, sets: Sequence[SpatialWrenchSet]) -> tuple[SpatialWrenchSet, ...]:
        """Return the applied wrenches of modes from those of the frame."""
        return tuple(
            replace(
                one,
                vertices=one.vertices + self.wrench_W,
                half_spaces=np.column_stack(
                    [one.half_spaces[:, :6], one.half_spaces[:, 6] + one.half_spaces[:, :6] @ self.wrench_W]
                ),
            )
            for one in sets
        )


def spatial_frame(problem: SpatialContactProblem, *, resting: bool = False) -> SpatialFrame | None:
    """Return a problem as it is seen from its surfaces, or None if these are at rest, or are not one frame.

    If ``resting``, the body is taken to be at rest on all surfaces, whatever its velocity.
    """
    state, contacts = problem.state, problem.contacts
    if not contacts.surfaces_move:
        return None
    v, w, a = _motions(contacts)
    approach = np.sum(contacts.normals_W * (state.velocity_of_point(contacts.p_WC_W) - v), axis=1)
    touching = np.flatnonzero(resting | (approach <= problem.velocity_tolerance))
    if len(touching) == 0 or (not resting and approach.min() < -problem.velocity_tolerance):
        return None
    r = contacts.p_WC_W - state.p_WB_W
    at, W = r[touching[0]], w[touching[0]]
    # Without the centripetal terms, accelerations of a rigid body are a_S + A x r.
    affine = a - np.cross(W, np.cross(W, r))
    jacobians = point_jacobians(r[touching] - at)[:, :, 3:].reshape(-1, 3)
    differences = (affine[touching] - affine[touching[0]]).ravel()
    A: FloatArray = np.linalg.lstsq(jacobians, differences, rcond=ROW_TOLERANCE)[0]
    v_S, a_S = v[touching[0]] - np.cross(W, at), affine[touching[0]] - np.cross(A, at)
    of_frame = v_S + np.cross(W, r), a_S + np.cross(A, r) + np.cross(W, np.cross(W, r))
    reach = float(np.abs(r).max())
    for found, expected, floor in (
        (v, of_frame[0], problem.velocity_tolerance),
        (reach * w, np.broadcast_to(reach * W, w.shape), problem.velocity_tolerance),
        (a, of_frame[1], 0.0),
    ):
        off = np.abs(found - expected)[touching].max()
        if off > max(floor, SURFACES_AS_ONE * float(np.abs(found[touching]).max())):
            return None
    others = np.ones(len(contacts), dtype=bool)
    others[touching] = False
    left = v - of_frame[0]
    still = replace(
        contacts,
        surface_velocities_W=np.where(others[:, None], left, 0.0),
        surface_angular_velocities_W=np.where(others[:, None], w - W, 0.0),
        surface_accelerations_W=np.where(others[:, None], a - of_frame[1] - 2.0 * np.cross(W, left), 0.0),
    )
    v_rel, w_rel = (np.zeros(3), np.zeros(3)) if resting else (state.v_WB_W - v_S, state.w_WB_W - W)
    body, turning = problem.body, W + w_rel
    inertia = body.inertia_in_world(state.R_WB)
    acceleration, angular = a_S + 2.0 * np.cross(W, v_rel), A + np.cross(W, w_rel)
    gyroscopic = np.cross(turning, inertia @ turning) - np.cross(w_rel, inertia @ w_rel)
    shift = np.concatenate([body.mass * acceleration, inertia @ angular + gyroscopic])
    check_magnitude(_SEEN, np.concatenate([v_rel, w_rel, shift]))
    rho = body.mean_radius_of_gyration
    metric = np.array([1.0, 1.0, 1.0, rho, rho, rho])
    wrench = problem.wrench_W - shift
    terms = np.linalg.norm(problem.wrench_W / metric) + np.linalg.norm(shift / metric)
    if np.linalg.norm(wrench / metric) <= SURFACES_AS_ONE * terms:  # as in free fall with the surfaces
        wrench = np.zeros(6)
    seen = replace(
        problem,
        state=state.with_velocities(v_rel, w_rel),
        contacts=still,
        force_W=wrench[:3],
        torque_W=wrench[3:],
    )
    return SpatialFrame(seen, acceleration, angular, shift)


def _motions(contacts: ContactSet) -> list[FloatArray]:
    """Return velocities, angular velocities and accelerations of surfaces, (n, 3) each."""
    fields = (getattr(contacts, name) for name in contacts.SURFACE_MOTION)
    return [np.zeros((len(contacts), 3)) if values is None else values for values in fields]


def seen_in_space(
    problem: SpatialContactProblem, *, as_one: str = "", resting: bool = False
) -> SpatialContactProblem:
    """Return a problem as it is seen from its surfaces, or as it is if they are not one frame.

    Raise `NotSupportedError` if they do not move as one rigid body, and the call ``as_one`` needs that.
    """
    frame = spatial_frame(problem, resting=resting)
    seen = problem if frame is None else frame.problem
    if as_one:
        check_as_one(seen, as_one)
    return seen


def check_as_one(problem: SpatialContactProblem, call: str) -> None:
    """Raise `NotSupportedError` where surfaces still move in a problem that is seen from its surfaces."""
    check_at_rest("contacts", problem.contacts, f"{call}, or surfaces that move as one rigid body")


class PlanarFrame(NamedTuple):
    """A planar problem as it is seen from the surfaces, and the way back."""

    problem: PlanarContactProblem
    acceleration: Vector2  # m/s^2, to be added to those of the centre of mass
    angular_acceleration: float  # rad/s^2, to be added

    def answer_in_world(self, answer: PlanarModeAnswer, problem: PlanarContactProblem) -> PlanarModeAnswer:
        """Return the answer to a problem from that of its frame."""
        x, y = self.acceleration
        modes = tuple(
            replace(
                mode,
                acceleration=(mode.acceleration[0] + x, mode.acceleration[1] + y),
                angular_acceleration=mode.angular_acceleration + self.angular_acceleration,
            )
            for mode in answer.modes
        )
        return replace(answer, modes=modes, problem=problem)

    def sets_in_world(self, sets: Sequence[PlanarWrenchSet]) -> tuple[PlanarWrenchSet, ...]:
        """Return the applied wrenches of modes from those of the frame."""
        body = self.problem.body
        f_x, f_y = (body.mass * part for part in self.acceleration)
        moment = body.inertia * self.angular_acceleration
        return tuple(
            replace(
                one,
                vertices=tuple(
                    PlanarWrench(f=(w.f[0] + f_x, w.f[1] + f_y), moment=w.moment + moment)
                    for w in one.vertices
                ),
                half_spaces=tuple(
                    WrenchHalfSpace(a, b + a[0] * f_x + a[1] * f_y + a[2] * moment)
                    for a, b in one.half_spaces
                ),
            )
            for one in sets
        )


def planar_frame(problem: PlanarContactProblem, *, resting: bool = False) -> PlanarFrame | None:
    """Return a problem as it is seen from the surfaces, or None if all are at rest.

    Raise `NotSupportedError` if surfaces do not move as one rigid body, and not as belts with equal
    accelerations under a body that does not turn.
    """
    for contact in problem.contacts:
        if contact.surfaces_move:
            break
    else:
        return None
    contacts = problem.contacts
    if not resting and any(v_n < 0.0 for _, v_n in problem.contact_velocities()):
        return PlanarFrame(problem, (0.0, 0.0), 0.0)  # an impact, of which accelerations say nothing
    first = contacts[0]
    W = first.surface_angular_velocity
    a_S, A = _rigid(contacts, W)
    v_S = _minus(first.surface_velocity, _turned(W, first.r))
    reach = max(math.hypot(*contact.r) for contact in contacts)
    fastest = max(math.hypot(*contact.surface_velocity) for contact in contacts) + abs(W) * reach
    slack = max(problem.velocity_tolerance, SURFACES_AS_ONE * fastest)
    largest = max(math.hypot(*contact.surface_acceleration) for contact in contacts) + W * W * reach
    turns = any(abs(contact.surface_angular_velocity - W) * reach > slack for contact in contacts)
    one_motion = not turns
    for contact in contacts:
        affine = _minus(contact.surface_acceleration, (-W * W * contact.r[0], -W * W * contact.r[1]))
        off = _minus(_minus(affine, a_S), _turned(A, contact.r))
        if math.hypot(*off) > SURFACES_AS_ONE * largest:
            raise _apart()
        off = _minus(_minus(contact.surface_velocity, v_S), _turned(W, contact.r))
        one_motion &= math.hypot(*off) <= slack
    velocity, mass, inertia = problem.velocity, problem.body.mass, problem.body.inertia
    acceleration = a_S
    if one_motion:
        v_rel, w_rel = ((0.0, 0.0), 0.0) if resting else (_minus(velocity.v, v_S), velocity.w - W)
        coriolis = _turned(2.0 * W, v_rel)
        acceleration = (a_S[0] + coriolis[0], a_S[1] + coriolis[1])
        seen, still = PlanarVelocity(v=v_rel, w=w_rel), [_at_rest(contact) for contact in contacts]
    elif resting or turns or W != 0.0 or not _only_slides(problem):
        raise _apart()
    else:  # from a frame that moves with the centre of mass, without turning
        seen = AT_REST
        still = [
            replace(_at_rest(contact), surface_velocity=_minus(contact.surface_velocity, velocity.v))
            for contact in contacts
        ]
    (f_x, f_y), moment = problem.wrench.f, problem.wrench.moment
    x, y, turning = mass * acceleration[0], mass * acceleration[1], inertia * A
    check_magnitude(_SEEN, np.array([x, y, turning]))
    wrench = PlanarWrench(f=(f_x - x, f_y - y), moment=moment - turning)
    rho = problem.body.radius_of_gyration
    terms = math.hypot(f_x, f_y, moment / rho) + math.hypot(x, y, turning / rho)
    if math.hypot(*wrench.f, wrench.moment / rho) <= SURFACES_AS_ONE * terms:  # as in free fall with surfaces
        wrench = PlanarWrench(f=(0.0, 0.0))
    framed = replace(problem, velocity=seen, contacts=still, wrench=wrench)
    return PlanarFrame(framed, acceleration, A)


def seen_in_plane(problem: PlanarContactProblem, *, resting: bool = False) -> PlanarContactProblem:
    """Return a planar problem as it is seen from its surfaces; see `planar_frame`."""
    frame = planar_frame(problem, resting=resting)
    return problem if frame is None else frame.problem


def _rigid(contacts: Sequence[PlanarContact], W: float) -> tuple[Vector2, float]:
    """Return accelerations of the centre of mass, m/s^2, and rad/s^2, that two far contacts determine."""
    first = contacts[0]
    far = max(contacts, key=lambda contact: math.dist(contact.r, first.r))
    (x, y), (a_x, a_y) = _minus(far.r, first.r), _minus(far.surface_acceleration, first.surface_acceleration)
    square = x * x + y * y
    A = (x * (a_y + W * W * y) - y * (a_x + W * W * x)) / square if square > 0.0 else 0.0
    a_x, a_y = _minus(first.surface_acceleration, _turned(A, first.r))
    return (a_x + W * W * first.r[0], a_y + W * W * first.r[1]), A


def _only_slides(problem: PlanarContactProblem) -> bool:
    """Return whether velocities matter by the directions of sliding alone: no turning, and no curved path."""
    rho = problem.body.radius_of_gyration
    reach = max(contact.reach(rho) for contact in problem.contacts)
    flat = all(contact.surface_curvature == 0.0 for contact in problem.contacts)
    return flat and abs(problem.velocity.w) * reach <= problem.velocity_tolerance


def _at_rest(contact: PlanarContact) -> PlanarContact:
    return replace(
        contact, surface_velocity=(0.0, 0.0), surface_angular_velocity=0.0, surface_acceleration=(0.0, 0.0)
    )


def _turned(rate: float, r: Vector2) -> Vector2:
    return (-rate * r[1], rate * r[0])


def _minus(one: Vector2, other: Vector2) -> Vector2:
    return (one[0] - other[0], one[1] - other[1])


def _apart() -> NotSupportedError:
    return NotSupportedError(
        "contacts must have surfaces that move as one rigid body in a planar problem, or as belts with equal "
        "accelerations under a body that does not turn, got others: state a SpatialContactProblem"
    )
