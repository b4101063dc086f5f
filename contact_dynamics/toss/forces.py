"""The accelerations of a body whose contact mode is known, and the contact forces that cause them.

Each held contact sticks or slides. A contact that sticks has no acceleration, which is three equations for
the three parts of its force. A contact that slides has no normal acceleration, which is one equation for its
normal force. Its friction is mu times that, against the sliding (lecture 26). If the forces are not the only
ones with the mode, as under four corners, the least ones are taken. Where those pull, or friction does not
allow them, others with the same motion are sought, as where a body is wedged.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial.round_cones import summed_by_round_cones
from contact_dynamics.numerics.vectors import (
    Vector3,
    cross,
    dot,
    norm,
    normalised,
    opposite,
    scaled,
    without,
)
from contact_dynamics.tolerances import FORCE_ROUNDING, SAME_FORCES
from contact_dynamics.toss.flush import flush_sliding, is_flush
from contact_dynamics.toss.solid import (
    arm_of,
    pose_of,
    responses,
    sliding_direction,
    times,
    transposed_times,
    velocity_of,
)

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Held, Numbers, Pose, Solid, Touch


class Pushed(NamedTuple):
    """A body under contact forces.

    Attributes:
        rates: The rates of the 13 numbers of the state.
        forces: N, world axes, the force on the body at each held contact.
    """

    rates: Numbers
    forces: list[Vector3]


class Free(NamedTuple):
    """The accelerations of a body that nothing touches.

    Attributes:
        pose: Pose and velocities.
        a: m/s^2, of the centre of mass.
        alpha: rad/s^2.
    """

    pose: Pose
    a: Vector3
    alpha: Vector3

    def at(self, solid: Solid, touch: Touch, arm: Vector3) -> Vector3:
        """Return the acceleration, m/s^2, of the body's point at an arm; a ball's point rolls meanwhile."""
        r, (n_x, n_y, n_z) = solid.rounding, solid.flats[touch[0]].normal
        (a_x, a_y, a_z), (t_x, t_y, t_z), (w_x, w_y, w_z) = self.a, self.alpha, self.pose.w
        x, y, z = arm
        # alpha x arm and w x (w x corner), with u = w x corner, by component.
        p, q, s = x + r * n_x, y + r * n_y, z + r * n_z
        u_x, u_y, u_z = w_y * s - w_z * q, w_z * p - w_x * s, w_x * q - w_y * p
        return (
            a_x + (t_y * z - t_z * y) + (w_y * u_z - w_z * u_y),
            a_y + (t_z * x - t_x * z) + (w_z * u_x - w_x * u_z),
            a_z + (t_x * y - t_y * x) + (w_x * u_y - w_y * u_x),
        )


def free_accelerations(solid: Solid, y: Numbers) -> Free:
    """Return the accelerations in free flight (Euler's equations; lecture 25)."""
    pose = pose_of(solid, y)
    w_B = transposed_times(pose.rows, pose.w)
    torque_B = cross(times(solid.inertia, w_B), w_B)
    return Free(pose, solid.gravity, times(pose.rows, times(solid.inverse, torque_B)))


def pushed_by_contacts(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> Pushed:
    """Return the rates of the state and the forces at the held contacts."""
    if is_flush(mode):
        sliding = flush_sliding(solid, y, mode)
        if sliding is not None:
            return Pushed(rates_of(y, sliding[0], sliding[1]), sliding[2])
    free = free_accelerations(solid, y)
    pose = free.pose
    # Each equation has a direction with its moment about the centre of mass, and each unknown has a force
    # with the angular acceleration that it causes.
    equations: list[tuple[Vector3, Vector3]] = []
    unknowns: list[tuple[Vector3, Vector3]] = []
    of: list[int] = []
    wanted: list[float] = []
    for i, (touch, slides, towards, begins) in enumerate(mode):
        flat = solid.flats[touch[0]]
        n = flat.normal
        arm = arm_of(solid, pose, touch)
        acceleration = free.at(solid, touch, arm)
        if slides:
            d = towards if begins else sliding_direction(velocity_of(pose, arm), n, towards)
            mu = flat.friction
            force = (n[0] - mu * d[0], n[1] - mu * d[1], n[2] - mu * d[2])
            of.append(i)
            unknowns.append((force, times(pose.inverse, cross(arm, force))))
            equations.append((n, cross(arm, n)))
            wanted.append(-dot(n, acceleration))
        else:
            for axis in (*flat.tangents, n):
                moment = cross(arm, axis)
                of.append(i)
                unknowns.append((axis, times(pose.inverse, moment)))
                equations.append((axis, moment))
                wanted.append(-dot(axis, acceleration))
    per_mass = 1.0 / solid.mass
    sizes, unique = _solved(responses(per_mass, equations, unknowns), wanted)
    a_x, a_y, a_z = free.a
    t_x, t_y, t_z = free.alpha
    forces = [(0.0, 0.0, 0.0)] * len(mode)
    for size, i, ((x, yy, z), (u, v, w)) in zip(sizes, of, unknowns, strict=True):
        f = forces[i]
        forces[i] = (f[0] + size * x, f[1] + size * yy, f[2] + size * z)
        share = size * per_mass
        a_x, a_y, a_z = a_x + share * x, a_y + share * yy, a_z + share * z
        t_x, t_y, t_z = t_x + size * u, t_y + size * v, t_z + size * w
    if len(mode) == 2 and not (mode[0].slides or mode[1].slides):
        shared = _shared_along_edge if mode[0].touch[0] == mode[1].touch[0] else _squeezed
        forces = shared(solid, pose, mode, forces)
    if not unique and least_left(solid, mode, forces) < 0.0:
        forces = _within_cones(solid, pose, mode, forces) or forces
    return Pushed(rates_of(y, (a_x, a_y, a_z), (t_x, t_y, t_z)), forces)


def least_left(solid: Solid, mode: tuple[Held, ...], forces: list[Vector3]) -> float:
    """Return the least force, N, that is left until a contact no longer presses, or no longer sticks.

    It is less than zero where one does not, and rounding has been given to it.
    """
    least = math.inf
    for one, force in zip(mode, forces, strict=True):
        flat = solid.flats[one.touch[0]]
        pressing = dot(force, flat.normal)
        least = min(least, pressing)
        if not one.slides:
            across = math.sqrt(max(dot(force, force) - pressing * pressing, 0.0))
            least = min(least, flat.friction * pressing - across)
    return least + force_rounding(solid)


def force_rounding(solid: Solid) -> float:
    """Return the force, N, by which a contact may pull and still stay."""
    return FORCE_ROUNDING * solid.mass * (1.0 + norm(solid.gravity))


def _within_cones(
    solid: Solid, pose: Pose, mode: tuple[Held, ...], forces: list[Vector3]
) -> list[Vector3] | None:
    """Return forces with the same motion that press, and that friction allows, or None if there are none."""
    axes, frictions, effects = [], [], []
    for one in mode:
        flat, arm = solid.flats[one.touch[0]], arm_of(solid, pose, one.touch)
        n, mu = flat.normal, flat.friction
        d = one.towards if one.begins else sliding_direction(velocity_of(pose, arm), n, one.towards)
        axes.append((n[0] - mu * d[0], n[1] - mu * d[1], n[2] - mu * d[2]) if one.slides else n)
        frictions.append(0.0 if one.slides else mu)
        x, y, z = (each / solid.reach for each in arm)
        effects.append([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -z, y], [z, 0, -x], [-y, x, 0]])
    each = np.array(effects, dtype=float).transpose(1, 0, 2).reshape(6, -1)
    target = each @ np.array(forces).ravel()
    held = summed_by_round_cones(each, target, np.array(axes), np.array(frictions)).forces
    return None if held is None else [(x, y, z) for x, y, z in held.tolist()]


def _shared_along_edge(
    solid: Solid, pose: Pose, mode: tuple[Held, ...], forces: list[Vector3]
) -> list[Vector3]:
    """Return forces with the same motion, where two contacts that stick share what acts along their edge.

    How much of it each of the two takes is open. Each takes what its friction can still hold, so that the
    edge sticks as long as any sharing lets it.
    """
    flat = solid.flats[mode[0].touch[0]]
    first, second = (arm_of(solid, pose, one.touch) for one in mode)
    edge = normalised((second[0] - first[0], second[1] - first[1], second[2] - first[2]))
    along = [dot(force, edge) for force in forces]
    left = []
    for force, part in zip(forces, along, strict=True):
        pressing = dot(force, flat.normal)
        across = dot(force, force) - pressing * pressing - part * part
        left.append(math.sqrt(max((flat.friction * pressing) ** 2 - across, 0.0)) if pressing > 0.0 else 0.0)
    total, room = along[0] + along[1], left[0] + left[1]
    if room == 0.0:
        return forces
    shared = []
    for force, part, space in zip(forces, along, left, strict=True):
        more = total * space / room - part
        shared.append((force[0] + more * edge[0], force[1] + more * edge[1], force[2] + more * edge[2]))
    return shared


def _squeezed(solid: Solid, pose: Pose, mode: tuple[Held, ...], forces: list[Vector3]) -> list[Vector3]:
    """Return forces with the same motion, where two contacts that stick squeeze the body between flats.

    By how much they do so is open. It is the least by which friction holds both, or zero if none does. It is
    along the line between the two contacts. A corner in a groove, which touches both flats itself, is pressed
    against both by what is along the difference of their normals.
    """
    (x, y, z), (a, b, c) = (arm_of(solid, pose, one.touch) for one in mode)
    between = (x - a, y - b, z - c)
    if between == (0.0, 0.0, 0.0):
        (x, y, z), (a, b, c) = (solid.flats[one.touch[0]].normal for one in mode)
        between = (x - a, y - b, z - c)
    if between == (0.0, 0.0, 0.0):  # the flats are the same
        return forces
    line = normalised(between)
    least, most = -math.inf, math.inf
    for one, force, u in zip(mode, forces, (line, opposite(line)), strict=True):
        flat = solid.flats[one.touch[0]]
        low, high = _within_cone(force, u, flat.normal, flat.friction)
        least, most = max(least, low), min(most, high)
    if least > most:
        return forces
    (f_x, f_y, f_z), (g_x, g_y, g_z) = forces
    more = min(max(0.0, least), most)
    x, y, z = scaled(line, more)
    return [(f_x + x, f_y + y, f_z + z), (g_x - x, g_y - y, g_z - z)]


def _within_cone(force: Vector3, u: Vector3, n: Vector3, friction: float) -> tuple[float, float]:
    """Return between which multiples of a unit vector ``u`` a force, N, is in a friction cone with them."""
    p, q = dot(force, n), dot(u, n)
    across, sideways = without(force, n), without(u, n)
    mu2 = friction * friction
    a = mu2 * q * q - dot(sideways, sideways)
    b = mu2 * p * q - dot(across, sideways)
    c = mu2 * p * p - dot(across, across)
    root = math.sqrt(max(b * b - a * c, 0.0))
    if a > 0.0:  # the line goes on into the cone for ever
        return ((root - b) / a, math.inf) if q > 0.0 else (-math.inf, (-root - b) / a)
    if a == 0.0 or b * b < a * c or p - q * b / a < 0.0:
        return (math.inf, -math.inf)
    return ((root - b) / a, (-root - b) / a)


def rates_of(y: Numbers, a: Vector3, alpha: Vector3) -> Numbers:
    """Return the rates of the 13 numbers from the accelerations, m/s^2 and rad/s^2."""
    q_x, q_y, q_z, q_w = y[3], y[4], y[5], y[6]
    w_x, w_y, w_z = y[10], y[11], y[12]
    return [
        y[7],
        y[8],
        y[9],
        0.5 * (w_x * q_w + w_y * q_z - w_z * q_y),
        0.5 * (w_y * q_w + w_z * q_x - w_x * q_z),
        0.5 * (w_z * q_w + w_x * q_y - w_y * q_x),
        -0.5 * (w_x * q_x + w_y * q_y + w_z * q_z),
        *a,
        *alpha,
    ]


def least_solution(matrix: list[list[float]], wanted: list[float]) -> list[float]:
    """Return the unknowns of the equations, the least ones if there are many."""
    return _solved(matrix, wanted)[0]


def _solved(matrix: list[list[float]], wanted: list[float]) -> tuple[list[float], bool]:
    """Return the unknowns of the equations, the least ones if there are many, and whether there are not."""
    n = len(wanted)
    if n == 0:
        return [], True
    if n == 1:
        ((a,),) = matrix
        return [wanted[0] / a if a != 0.0 else math.inf], True
    if n == 2:
        (a, b), (c, d) = matrix
        det = a * d - b * c
        if abs(det) > SAME_FORCES * (abs(a) + abs(b)) * (abs(c) + abs(d)):
            x, y = wanted
            return [(d * x - b * y) / det, (a * y - c * x) / det], True
    if n == 3:
        (a, b, c), (d, e, f), (g, h, i) = matrix
        x, y, z = wanted
        A, B, C = e * i - f * h, f * g - d * i, d * h - e * g
        det = a * A + b * B + c * C
        if abs(det) > SAME_FORCES * (abs(a) + abs(b) + abs(c)) ** 3:
            D, E, F = c * h - b * i, a * i - c * g, b * g - a * h
            G, H, K = b * f - c * e, c * d - a * f, a * e - b * d
            return [
                (A * x + D * y + G * z) / det,
                (B * x + E * y + H * z) / det,
                (C * x + F * y + K * z) / det,
            ], True
    sizes, _, rank, _ = np.linalg.lstsq(np.array(matrix), np.array(wanted), rcond=SAME_FORCES)
    return sizes.tolist(), int(rank) == n
