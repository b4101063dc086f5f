"""Pushes at several contacts that keep a body out of the world, with round friction cones.

The same problem appears twice. Contact forces change accelerations, and impulses without restitution change
velocities. With the motion b of the contacts without any push, and the response D, the pushes f obey

    m = b + D f,    0 <= f_n,  m_n >= 0, one of the two zero,    |f_t| <= mu f_n,

and f_t is against m_t with mu f_n where m_t is not zero. A contact that slides already has friction in a
known direction. The method is block Gauss-Seidel: the problem of one contact is solved exactly, in turn,
until no push changes (Moreau 1988). It does not find all solutions; `contact_modes` does. Where contacts jam,
pushes of contacts against each other take ten thousands of sweeps, and their limit is sought (Anderson 1965).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.numerics.vectors import Vector3, cross, norm
from contact_dynamics.tolerances import CONE_SWEEPS_CONVERGED, FORCE_ROUNDING, SWEEPS_CHANGE_ALIKE
from contact_dynamics.toss.solid import as_rows, responses, times

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.toss.solid import Matrix3

MAX_SWEEPS: Final = 400
"""Sweeps over all contacts after which the problem counts as not solved. Four corners need some fifty."""

PLAIN_SWEEPS: Final = 100
"""Sweeps after which their limit is sought. Where contacts jam, ten thousand sweeps would be needed."""

_MAX_FURTHER_SWEEPS: Final = 1000
"""Sweeps after which the problem counts as not solved where their limit is sought."""

FURTHER_SWEEPS: Final = 10
"""Sweeps from which their limit is sought, again and again."""

_MAX_TURNS: Final = 60
"""Steps towards the direction in which one contact slides."""

_DIRECTIONS: Final = 48
"""Directions that are tried where these steps do not find it."""


class Site(NamedTuple):
    """A contact in one such problem, in contact axes: two tangents and the normal.

    Attributes:
        arm: m, world axes, from the centre of mass.
        axes: The two tangents and the normal, unit, world axes.
        friction: Coulomb's mu.
        motion: The contact's velocity or acceleration without any push, contact axes.
        sliding: The unit direction in which it slides already, by the two tangents, or None.
    """

    arm: Vector3
    axes: Matrix3
    friction: float
    motion: Vector3
    sliding: tuple[float, float] | None


def cone_forces(
    per_mass: float, inverse: Matrix3, sites: list[Site], *, enough: float = 0.0
) -> tuple[list[Vector3], list[Vector3]] | None:
    """Return the pushes and the contacts' motions with them, in contact axes, or None if none were found.

    Args:
        per_mass: 1/kg.
        inverse: (3, 3), 1/(kg m^2), the inverse inertia in world axes.
        sites: The contacts.
        enough: Relative to the largest motion. If it is not 0, the limit of many sweeps is sought, as where
            contacts jam. A sweep that changes less is the last then, where pushes of contacts against each
            other creep on. The limit need not be one that sweeps would come to by themselves.
    """
    n = len(sites)
    rows = [[(axis, cross(site.arm, axis)) for axis in site.axes] for site in sites]
    turning = [[(axis, times(inverse, moment)) for axis, moment in row] for row in rows]
    response = [[as_rows(responses(per_mass, row, turned)) for turned in turning] for row in rows]
    pushes: list[Vector3] = [(0.0, 0.0, 0.0)] * n
    motions: list[Vector3] = [site.motion for site in sites]
    scale = max(map(norm, motions), default=0.0)
    if scale == 0.0:
        return pushes, motions
    seen: list[list[Vector3]] = []
    for sweep in range(_MAX_FURTHER_SWEEPS if enough > 0.0 else MAX_SWEEPS):
        change = _sweep(response, sites, pushes, motions)
        if change <= CONE_SWEEPS_CONVERGED * scale:
            return (pushes, motions) if _lowest(motions) >= -FORCE_ROUNDING * scale else None
        if sweep < PLAIN_SWEEPS or enough == 0.0:
            continue
        seen.append(list(pushes))
        if len(seen) > FURTHER_SWEEPS:
            if max(change, -_lowest(motions)) <= enough * scale:
                return pushes, motions
            pushes = _limit(seen)
            motions = _moved(response, pushes, sites)
            seen = [pushes]
    return None


def _sweep(
    response: list[list[Matrix3]], sites: list[Site], pushes: list[Vector3], motions: list[Vector3]
) -> float:
    """Solve the problem of each contact in turn, and return the largest change of a contact's own motion."""
    change = 0.0
    for i, site in enumerate(sites):
        own = response[i][i]
        back = times(own, pushes[i])
        m = motions[i]
        alone = (m[0] - back[0], m[1] - back[1], m[2] - back[2])
        push = _one(own, alone, site)
        old = pushes[i]
        step = (push[0] - old[0], push[1] - old[1], push[2] - old[2])
        if step == (0.0, 0.0, 0.0):
            continue
        pushes[i] = push
        for j in range(len(sites)):
            x, y, z = times(response[j][i], step)
            u, v, w = motions[j]
            motions[j] = (u + x, v + y, w + z)
            if j == i:
                change = max(change, abs(x), abs(y), abs(z))
    return change


def _lowest(motions: list[Vector3]) -> float:
    return min(motion[2] for motion in motions)


def _limit(seen: list[list[Vector3]]) -> list[Vector3]:
    """Return the limit of sweeps from the pushes after each of them (Anderson 1965)."""
    after = np.array(seen).reshape(len(seen), -1)
    changes = np.diff(after, axis=0)
    last, turns = changes[-1], np.diff(changes, axis=0)
    shares = np.linalg.lstsq(turns.T, last, rcond=SWEEPS_CHANGE_ALIKE)[0]
    found = after[-1] - shares @ changes[1:]
    return [(x, y, z) for x, y, z in found.reshape(-1, 3).tolist()]


def _moved(response: list[list[Matrix3]], pushes: list[Vector3], sites: list[Site]) -> list[Vector3]:
    """Return the motions of contacts with these pushes."""
    moved = []
    for row, site in zip(response, sites, strict=True):
        u, v, w = site.motion
        for block, push in zip(row, pushes, strict=True):
            x, y, z = times(block, push)
            u, v, w = u + x, v + y, w + z
        moved.append((u, v, w))
    return moved


def _one(own: Matrix3, m: Vector3, site: Site) -> Vector3:
    """Return the push of one contact that has the motion ``m`` without it."""
    if m[2] >= 0.0:
        return (0.0, 0.0, 0.0)
    mu = site.friction
    (a, b, c), (_, d, e), (_, _, f) = own
    if site.sliding is not None:
        x, y = site.sliding
        rate = f - mu * (c * x + e * y)
        p = -m[2] / rate if rate > 0.0 else 0.0
        return (-mu * p * x, -mu * p * y, p)
    # Does it stick?  The block is symmetric and positive definite.
    A, B, C = d * f - e * e, c * e - b * f, b * e - c * d
    D, E, F = a * f - c * c, b * c - a * e, a * d - b * b
    det = a * A + b * B + c * C
    x = -(A * m[0] + B * m[1] + C * m[2]) / det
    y = -(B * m[0] + D * m[1] + E * m[2]) / det
    z = -(C * m[0] + E * m[1] + F * m[2]) / det
    if z > 0.0 and math.hypot(x, y) <= mu * z:
        return (x, y, z)
    if mu == 0.0:
        return (0.0, 0.0, -m[2] / f)
    return _sliding(own, m, mu, (x, y))


def _sliding(own: Matrix3, m: Vector3, mu: float, hold: tuple[float, float]) -> Vector3:
    """Return the push of one contact that friction does not hold: a direction that its motion keeps.

    The direction d solves: the tangential motion with the push p (n - mu d) is along d. Newton's steps on the
    angle start from the motion against the force that would hold it.
    """
    (a, b, c), (_, d, e), (_, _, f) = own

    def pushed(x: float, y: float) -> tuple[float, float, float]:
        """Return the normal push with friction against a direction, or 0, and the motion with it."""
        rate = f - mu * (c * x + e * y)
        p = -m[2] / rate if rate > 0.0 else 0.0
        return p, m[0] + p * (c - mu * (a * x + b * y)), m[1] + p * (e - mu * (b * x + d * y))

    angle = math.atan2(-hold[1], -hold[0]) if hold != (0.0, 0.0) else math.atan2(m[1], m[0])
    for _ in range(_MAX_TURNS):
        x, y = math.cos(angle), math.sin(angle)
        p, u, v = pushed(x, y)
        if p == 0.0:
            break
        turn = math.atan2(x * v - y * u, x * u + y * v)
        if abs(turn) <= CONE_SWEEPS_CONVERGED:
            return (-mu * p * x, -mu * p * y, p)
        # The derivative of u, v and of p by the angle.
        rate = -m[2] / p
        p_turn = p * mu * (e * x - c * y) / rate
        u_turn = p_turn * (c - mu * (a * x + b * y)) + p * mu * (a * y - b * x)
        v_turn = p_turn * (e - mu * (b * x + d * y)) + p * mu * (b * y - d * x)
        size = u * u + v * v
        slope = (u * v_turn - v * u_turn) / size - 1.0 if size > 0.0 else -1.0
        step = -turn / slope if slope < 0.0 else turn
        angle += max(-1.0, min(1.0, step))
    return _sliding_by_halves(pushed, mu) or (0.0, 0.0, -m[2] / f)


def _sliding_by_halves(
    pushed: Callable[[float, float], tuple[float, float, float]], mu: float
) -> Vector3 | None:
    """Return the push with friction against a direction that the motion keeps, from directions all around."""

    def across(angle: float) -> tuple[float, float, Vector3]:
        x, y = math.cos(angle), math.sin(angle)
        p, u, v = pushed(x, y)
        return x * v - y * u, (x * u + y * v if p > 0.0 else -1.0), (-mu * p * x, -mu * p * y, p)

    found = [across(2.0 * math.pi * k / _DIRECTIONS) for k in range(_DIRECTIONS + 1)]
    for k in range(_DIRECTIONS):
        (left, ahead, push), (right, further, _) = found[k], found[k + 1]
        if left * right > 0.0 or ahead < 0.0 or further < 0.0:
            continue
        low, high = 2.0 * math.pi * k / _DIRECTIONS, 2.0 * math.pi * (k + 1) / _DIRECTIONS
        for _ in range(_MAX_TURNS):
            middle = 0.5 * (low + high)
            value, _, push = across(middle)
            low, high = (middle, high) if value * left > 0.0 else (low, middle)
        return push
    return None
