"""Keeps held contacts where they are: takes away what rounding or a slow rebound has left of their motion.

Velocities and positions are changed by the least amount that meets the contacts' equations, where the amount
is measured by kinetic energy. So velocities lose energy by it, if anything.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.numerics.vectors import Vector3, cross, dot, norm, without
from contact_dynamics.numerics.vectors import normalised as normalised_vector
from contact_dynamics.rotations.one import normalised, product
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, HELD_DRIFT, SLIDING_STOPPED, SUNK
from contact_dynamics.toss.forces import least_solution
from contact_dynamics.toss.solid import (
    arm_of,
    height_of,
    heights_and_rates,
    pose_of,
    responses,
    times,
    velocity_of,
)

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Held, Matrix3, Numbers, Solid, Touch

_MAX_SWEEPS: Final = 200
"""Sweeps over corners that are below a flat. Some ten are usual."""


def held_in_place(
    solid: Solid, y: Numbers, mode: tuple[Held, ...], heights: list[float] | None = None
) -> Numbers:
    """Return a state with a unit quaternion whose held contacts do not leave, and stick or slide.

    Contacts are at these heights, m, above their flats then, and without any they touch.
    """
    y = [*y[:3], *normalised(y[3:7]), *y[7:]]
    pose = pose_of(solid, y)
    off = [height_of(solid, pose, one.touch) for one in mode]
    if heights is not None:
        off = [height - target for height, target in zip(off, heights, strict=True)]
    arms = [arm_of(solid, pose, one.touch) for one in mode]
    flats = [solid.flats[one.touch[0]] for one in mode]
    if max(map(abs, off), default=0.0) > HELD_DRIFT:
        rows = [(flat.normal, cross(arm, flat.normal)) for flat, arm in zip(flats, arms, strict=True)]
        y = _moved(y, _least_change(solid, pose.inverse, rows, off))
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


def heights_held(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> list[float]:
    """Return the heights, m, at which contacts of a mode are held: where they are, but not below the flats.

    What touches may be a micrometre high. To bring it down would press others into their flats.
    """
    pose = pose_of(solid, y)
    return [max(height_of(solid, pose, one.touch), 0.0) for one in mode]


def out_of_flats(solid: Solid, y: Numbers) -> Numbers:
    """Return a state with the least change of place and attitude after which no corner is below a flat."""
    listed = heights_and_rates(solid, y)
    if min((height for height, _, _ in listed), default=0.0) >= -SUNK:
        return y
    y = [*y[:3], *normalised(y[3:7]), *y[7:]]
    pose = pose_of(solid, y)
    near = [(height, touch) for height, _, touch in listed if height <= DISTANCE_TOLERANCE]
    rows = []
    for _, touch in near:
        normal = solid.flats[touch[0]].normal
        rows.append((normal, cross(arm_of(solid, pose, touch), normal)))
    pushes = [(normal, times(pose.inverse, moment)) for normal, moment in rows]
    response = responses(1.0 / solid.mass, rows, pushes)
    lift = [0.0] * len(near)
    for _ in range(_MAX_SWEEPS):
        least = 0.0
        for i, (height, _) in enumerate(near):
            now = height + sum(a * b for a, b in zip(response[i], lift, strict=True))
            least = min(least, now if lift[i] == 0.0 else -abs(now))
            lift[i] = max(lift[i] - now / response[i][i], 0.0)
        if least >= -HELD_DRIFT:
            break
    return _moved(y, _summed(1.0 / solid.mass, [-each for each in lift], pushes))


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
    return _summed(per_mass, shares, pushes)


def _summed(
    per_mass: float, shares: list[float], pushes: list[tuple[Vector3, Vector3]]
) -> tuple[Vector3, Vector3]:
    """Return the linear and angular motion by shares of pushes."""
    v_x = v_y = v_z = w_x = w_y = w_z = 0.0
    for share, ((x, y, z), (t_x, t_y, t_z)) in zip(shares, pushes, strict=True):
        part = share * per_mass
        v_x, v_y, v_z = v_x + part * x, v_y + part * y, v_z + part * z
        w_x, w_y, w_z = w_x + share * t_x, w_y + share * t_y, w_z + share * t_z
    return (v_x, v_y, v_z), (w_x, w_y, w_z)


def _moved(y: Numbers, motion: tuple[Vector3, Vector3]) -> Numbers:
    """Return a state that is moved back by a small shift and turn."""
    shift, (x, yy, z) = motion
    q_x, q_y, q_z, q_w = y[3:7]
    turn = normalised((-0.5 * x, -0.5 * yy, -0.5 * z, 1.0))
    return [y[0] - shift[0], y[1] - shift[1], y[2] - shift[2], *product(turn, (q_x, q_y, q_z, q_w)), *y[7:]]
