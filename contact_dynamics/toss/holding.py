"""Keeps held contacts where they are: takes away what rounding or a slow rebound has left of their motion.

Velocities and positions are changed by the least amount that meets the contacts' equations, where the amount
is measured by kinetic energy. So velocities lose energy by it, if anything.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.numerics.vectors import Vector3, cross, dot, norm, without
from contact_dynamics.numerics.vectors import normalised as normalised_vector
from contact_dynamics.rotations.one import normalised, product
from contact_dynamics.tolerances import HELD_DRIFT, SLIDING_STOPPED
from contact_dynamics.toss.forces import least_solution
from contact_dynamics.toss.solid import arm_of, pose_of, responses, times, velocity_of

if TYPE_CHECKING:
    from contact_dynamics.toss.held import Held
    from contact_dynamics.toss.solid import Matrix3, Numbers, Solid, Touch


def held_in_place(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> Numbers:
    """Return a state with a unit quaternion whose held contacts touch, do not leave, and stick or slide."""
    q = normalised(y[3:7])
    y = [*y[:3], *q, *y[7:]]
    pose = pose_of(solid, y)
    arms = [arm_of(solid, pose, one.touch) for one in mode]
    flats = [solid.flats[one.touch[0]] for one in mode]
    heights = [
        dot(pose.position, flat.normal) + dot(arm, flat.normal) - flat.level
        for flat, arm in zip(flats, arms, strict=True)
    ]
    if max(map(abs, heights), default=0.0) > HELD_DRIFT:
        rows = [(flat.normal, cross(arm, flat.normal)) for flat, arm in zip(flats, arms, strict=True)]
        shift, turn = _least_change(solid, pose.inverse, rows, heights)
        for k in range(3):
            y[k] -= shift[k]
        y[3:7] = product(normalised((-0.5 * turn[0], -0.5 * turn[1], -0.5 * turn[2], 1.0)), q)
        pose = pose_of(solid, y)
        arms = [arm_of(solid, pose, one.touch) for one in mode]
    rows, speeds = [], []
    for one, arm, flat in zip(mode, arms, flats, strict=True):
        velocity = velocity_of(pose, arm)
        for axis in (flat.normal,) if one.slides else (flat.normal, *flat.tangents):
            rows.append((axis, cross(arm, axis)))
            speeds.append(dot(velocity, axis))
    if max(map(abs, speeds), default=0.0) > HELD_DRIFT:
        v, w = _least_change(solid, pose.inverse, rows, speeds)
        for k in range(3):
            y[7 + k] -= v[k]
            y[10 + k] -= w[k]
    return y


def without_rebounds(solid: Solid, y: Numbers, touching: list[Touch]) -> Numbers:
    """Return a state whose contacts lose what is left of their rebounds, and the friction that came with it.

    The impulses are those of the strikes, the other way round: along the normal less friction where a contact
    slides, and such that it goes on to stick where it sticks. So the contact has had the impulse of a strike
    without restitution, and friction from then on is that of a contact that stays.
    """
    pose = pose_of(solid, y)
    rows, forces, speeds = [], [], []
    for touch in touching:
        flat, arm = solid.flats[touch[0]], arm_of(solid, pose, touch)
        n, velocity = flat.normal, velocity_of(pose, arm)
        sliding = without(velocity, n)
        if norm(sliding) > SLIDING_STOPPED:
            d, mu = normalised_vector(sliding), flat.friction
            force = (n[0] - mu * d[0], n[1] - mu * d[1], n[2] - mu * d[2])
            axes = [(n, force)]
        else:
            axes = [(axis, axis) for axis in (n, *flat.tangents)]
        for axis, force in axes:
            rows.append((axis, cross(arm, axis)))
            forces.append((force, cross(arm, force)))
            speeds.append(dot(velocity, axis))
    v, w = _least_change(solid, pose.inverse, rows, speeds, forces)
    return [*y[:7], *(a - b for a, b in zip(y[7:], (*v, *w), strict=True))]


def _least_change(
    solid: Solid,
    inverse: Matrix3,
    rows: list[tuple[Vector3, Vector3]],
    amounts: list[float],
    forces: list[tuple[Vector3, Vector3]] | None = None,
) -> tuple[Vector3, Vector3]:
    """Return the linear and angular motion of least energy whose rows have these amounts.

    It is brought about by impulses along the rows, or along ``forces``, as many, each with its moment.
    """
    per_mass = 1.0 / solid.mass
    forces = rows if forces is None else forces
    pushes = [(force, times(inverse, moment)) for force, moment in forces]
    shares = least_solution(responses(per_mass, rows, pushes), amounts)
    v_x = v_y = v_z = w_x = w_y = w_z = 0.0
    for share, ((x, y, z), (t_x, t_y, t_z)) in zip(shares, pushes, strict=True):
        part = share * per_mass
        v_x, v_y, v_z = v_x + part * x, v_y + part * y, v_z + part * z
        w_x, w_y, w_z = w_x + share * t_x, w_y + share * t_y, w_z + share * t_z
    return (v_x, v_y, v_z), (w_x, w_y, w_z)
