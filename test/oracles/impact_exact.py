# SPDX-License-Identifier: Apache-2.0
"""Routh's planar impact in exact rational arithmetic, by walking the path vertex by vertex.

Slow and obvious on purpose: at each vertex it tries the three contact modes, keeps the one whose force lies
in the friction cone and whose motion agrees with its sliding direction, goes straight on until something
changes, and asks there again.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

ZERO = Fraction(0)


@dataclass
class Problem:
    mass: Fraction
    inertia: Fraction
    r: tuple[Fraction, Fraction]
    v: tuple[Fraction, Fraction]
    w: Fraction
    mu: Fraction
    e: Fraction


@dataclass
class Walk:
    vertices: list[tuple[Fraction, Fraction]]
    sliding: list[int]  # the sign of the sliding velocity along each piece
    compression: tuple[Fraction, Fraction]
    v: tuple[Fraction, Fraction]
    w: Fraction


def _contact_velocity(problem: Problem, impulse: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
    """Momentum balance, lecture 27 eqs. 3 and 4, then velocity of the point."""
    i_t, i_n = impulse
    r_t, r_n = problem.r
    v_t = problem.v[0] + i_t / problem.mass
    v_n = problem.v[1] + i_n / problem.mass
    w = problem.w + (r_t * i_n - r_n * i_t) / problem.inertia
    return (v_t - w * r_n, v_n + w * r_t)


def _rates(problem: Problem, slope: Fraction) -> tuple[Fraction, Fraction]:
    """How fast the contact's velocity changes along a direction (slope, 1) of the impulse."""
    at_rest = Problem(problem.mass, problem.inertia, problem.r, (ZERO, ZERO), ZERO, problem.mu, problem.e)
    return _contact_velocity(at_rest, (slope, Fraction(1)))


def _slope(problem: Problem, v_t: Fraction) -> tuple[Fraction, int]:
    """The path's direction at a point with this sliding velocity, and the sign of sliding along it."""
    if v_t != 0:
        sign = 1 if v_t > 0 else -1
        return -sign * problem.mu, sign
    # The tangential force that would hold the contact: rates are affine in the slope.
    free, one = _rates(problem, ZERO)[0], _rates(problem, Fraction(1))[0]
    hold = -free / (one - free)
    if abs(hold) <= problem.mu:
        return hold, 0
    for sign in (1, -1):
        if sign * _rates(problem, -sign * problem.mu)[0] > 0:
            return -sign * problem.mu, sign
    raise AssertionError("no admissible direction")


def walk(problem: Problem, law: str) -> Walk:
    """Follow the path to its end. ``law`` is "poisson" or "newton"."""
    impulse = (ZERO, ZERO)
    start = _contact_velocity(problem, impulse)
    compression: tuple[Fraction, Fraction] | None = None
    end_impulse: Fraction | None = None
    vertices, signs = [impulse], []
    for _ in range(10):
        v_t, v_n = _contact_velocity(problem, impulse)
        slope, sign = _slope(problem, v_t)
        rate_t, rate_n = _rates(problem, slope)
        if compression is None and v_n >= 0 and rate_n >= 0:
            compression = impulse
            end_impulse = (1 + problem.e) * impulse[1]
        stops = []
        if sign * rate_t < 0:
            stops.append(-v_t / rate_t)
        if compression is None:
            if rate_n > 0:
                stops.append(-v_n / rate_n)
        elif law == "poisson":
            stops.append(end_impulse - impulse[1])
        else:
            stops.append((-problem.e * start[1] - v_n) / rate_n if rate_n > 0 else ZERO)
        step = min(stops)
        if step == 0 and compression is not None:
            at_end = impulse[1] == end_impulse if law == "poisson" else v_n == -problem.e * start[1]
            if at_end:
                break
        impulse = (impulse[0] + slope * step, impulse[1] + step)
        if step > 0:
            vertices.append(impulse)
            signs.append(sign)
    else:
        raise AssertionError("the path does not end")
    r_t, r_n = problem.r
    i_t, i_n = impulse
    return Walk(
        vertices,
        signs,
        compression,
        (problem.v[0] + i_t / problem.mass, problem.v[1] + i_n / problem.mass),
        problem.w + (r_t * i_n - r_n * i_t) / problem.inertia,
    )
