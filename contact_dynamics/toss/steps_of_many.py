"""Steps of many samples whose contacts all slide: those of `phase_step`, with arrays for numbers.

One or two contacts have normal forces that follow from as many equations. Three and more are flush on one
flat, and have the formulas of `flush`. A sample whose equations are close to dependent, or whose sliding has
no direction, does its step alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from contact_dynamics.numerics.vectors import cross, dot
from contact_dynamics.rotations.one import rows_of
from contact_dynamics.tolerances import SAME_FORCES, SLIDING_DIRECTION_SPEED
from contact_dynamics.toss.flush import DIRECTION_SURE
from contact_dynamics.toss.forces import Pushed, free_accelerations, rates_of
from contact_dynamics.toss.phase_step import ERRORS, STAGES
from contact_dynamics.toss.solid import arm_of, times, transposed_times, velocity_of
from contact_dynamics.toss.solids_of_many import CONTACT, columns, solids_together, states_together

if TYPE_CHECKING:
    from contact_dynamics.toss.phase_step import AskedStep
    from contact_dynamics.toss.solid import Solid
    from contact_dynamics.validation import FloatArray


class _Pushed(NamedTuple):
    """What contacts do to n samples.

    Attributes:
        rates: (13, n).
        forces: (3, k, n), N, at each of k contacts.
        sure: (n,), whether the equations are independent and sliding has a direction.
    """

    rates: FloatArray
    forces: FloatArray
    sure: Any


def step_together(asked: list[AskedStep]) -> None:
    """Do steps of one kind."""
    solid = solids_together(
        [one.solid for one in asked], [tuple(held.touch for held in one.mode) for one in asked]
    )
    towards = columns([[one.mode[k].towards for one in asked] for k in range(len(asked[0].mode))])
    pushed = _flush if len(asked[0].mode) > 2 else _sliding
    begin = np.array(states_together([one.y for one in asked]))
    spans = np.array([one.span for one in asked])
    stages = np.empty((7, 13, len(asked)))
    stages[0] = np.array([one.pushed.rates for one in asked]).T
    sure = np.ones(len(asked), dtype=bool)
    trial = begin
    with np.errstate(all="ignore"):  # samples that are not sure do their steps alone
        for k, row in enumerate(STAGES, start=1):
            trial = begin + spans * np.tensordot(row, stages[:k], 1)
            last = pushed(solid, trial, towards)
            stages[k] = last.rates
            sure &= last.sure
        scales = np.array([one.scales for one in asked]).T
        sizes = np.abs(np.tensordot(ERRORS, stages, 1) * scales).max(axis=0) * spans
    trials, rates, sizes_listed = trial.T.tolist(), last.rates.T.tolist(), sizes.tolist()
    forces = last.forces.transpose(2, 1, 0).tolist()
    for i, one in enumerate(asked):
        if not sure[i]:
            one.work()
            continue
        one.trial, one.stages, one.size = trials[i], stages[:, :, i], sizes_listed[i] / one.error
        one.after = Pushed(rates[i], [(x, y, z) for x, y, z in forces[i]])


def _sliding(solid: Solid, y: FloatArray, towards: Any) -> _Pushed:
    """Return what one or two sliding contacts do (`forces.pushed_by_contacts`)."""
    flat, per_mass = solid.flats[0], 1.0 / solid.mass
    free = free_accelerations(solid, list(y))
    n: Any = flat.normal
    arm = arm_of(solid, free.pose, CONTACT)
    velocity = velocity_of(free.pose, arm)
    v_n, e = dot(velocity, n), SLIDING_DIRECTION_SPEED
    d: Any = tuple(v - v_n * a + e * b for v, a, b in zip(velocity, n, towards, strict=True))
    speed = np.sqrt(dot(d, d))
    sure = (speed > 0.0).all(axis=0)
    mu = flat.friction / speed
    force: Any = tuple(a - mu * b for a, b in zip(n, d, strict=True))
    moment: Any = cross(arm, n)
    turning: Any = times(free.pose.inverse, cross(arm, force))
    wanted = -dot(n, free.at(solid, CONTACT, arm))

    def response(i: int, j: int) -> FloatArray:
        along = sum(n[c][i] * force[c][j] for c in range(3))
        around = sum(moment[c][i] * turning[c][j] for c in range(3))
        both: FloatArray = per_mass * along + around
        return both

    if len(wanted) == 1:
        a = response(0, 0)
        sure &= a != 0.0
        sizes = wanted / a
    else:
        a, b, c, g = response(0, 0), response(0, 1), response(1, 0), response(1, 1)
        det = a * g - b * c
        sure &= abs(det) > SAME_FORCES * (abs(a) + abs(b)) * (abs(c) + abs(g))
        sizes = np.array([g * wanted[0] - b * wanted[1], a * wanted[1] - c * wanted[0]]) / det
    forces = np.array([sizes * f for f in force])
    linear: Any = tuple(a + per_mass * f.sum(axis=0) for a, f in zip(free.a, forces, strict=True))
    angular: Any = tuple(a + (sizes * t).sum(axis=0) for a, t in zip(free.alpha, turning, strict=True))
    return _Pushed(np.array(rates_of(list(y), linear, angular)), forces, sure)


def _flush(solid: Solid, y: FloatArray, towards: Any) -> _Pushed:
    """Return what three and more contacts that slide flush on one flat do (`flush.flush_sliding`)."""
    flat: Any = solid.flats[0]
    n: Any = tuple(x[0] for x in flat.normal)
    t1: Any = tuple(x[0] for x in flat.tangents[0])
    t2: Any = tuple(x[0] for x in flat.tangents[1])
    mu, e = flat.friction[0], SLIDING_DIRECTION_SPEED
    rows: Any = rows_of(*(y[3:7] / np.sqrt((y[3:7] * y[3:7]).sum(axis=0))))
    first, second, up = transposed_times(rows, t1), transposed_times(rows, t2), transposed_times(rows, n)
    j = times(solid.inertia, up)
    j1, j2, jn = dot(j, first), dot(j, second), dot(j, up)
    v: Any = (y[7], y[8], y[9])
    spin = dot((y[10], y[11], y[12]), n)
    high = dot(n, (y[0], y[1], y[2])) - flat.level[0]
    corner: Any = solid.corners[0]
    s, t = dot(corner, first), dot(corner, second)
    along, across = dot(t1, v) - spin * t, dot(t2, v) + spin * s
    slow = abs(along) + abs(across) < DIRECTION_SURE
    along = np.where(slow, along + e * dot(towards, t1), along)
    across = np.where(slow, across + e * dot(towards, t2), across)
    speed = np.sqrt(along * along + across * across)
    along, across = along / speed, across / speed
    twist = mu * (s * across - t * along)
    two, three = t - mu * high * across + j1 / jn * twist, -s + mu * high * along + j2 / jn * twist
    # The least normal forces that balance, by the multipliers of three equations.
    s11, s12, s13 = float(len(s)), two.sum(axis=0), three.sum(axis=0)
    s22, s23, s33 = (two * two).sum(axis=0), (two * three).sum(axis=0), (three * three).sum(axis=0)
    A, B, C = s22 * s33 - s23 * s23, s13 * s23 - s12 * s33, s12 * s23 - s13 * s22
    det = s11 * A + s12 * B + s13 * C
    D, E, F = s11 * s33 - s13 * s13, s12 * s13 - s11 * s23, s11 * s22 - s12 * s12
    g1, g2, gn = dot(t1, solid.gravity), dot(t2, solid.gravity), dot(n, solid.gravity)
    x, yy, z = -solid.mass * gn, -spin * spin * j2, spin * spin * j1
    f = (A * x + B * yy + C * z + (B * x + D * yy + E * z) * two + (C * x + E * yy + F * z) * three) / det
    turn = -(f * twist).sum(axis=0) / jn
    f1, f2 = -mu * f * along, -mu * f * across
    a1, a2 = g1 + f1.sum(axis=0) / solid.mass, g2 + f2.sum(axis=0) / solid.mass
    linear: Any = tuple(a1 * p + a2 * q for p, q in zip(t1, t2, strict=True))
    angular: Any = tuple(turn * p for p in n)
    return _Pushed(
        np.array(rates_of(list(y), linear, angular)),
        np.array([f * r + f1 * p + f2 * q for p, q, r in zip(t1, t2, n, strict=True)]),
        (det > SAME_FORCES * s11 * s22 * s33) & (speed > 0.0).all(axis=0),
    )
