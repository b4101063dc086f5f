# SPDX-License-Identifier: Apache-2.0
"""Tosses with known answers: exact flights by `rigid_flight` between jumps of velocity, rest, and noise."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from oracles.rigid_flight import about, fly, matrix, multiply

MOMENTS = np.array([0.000353333, 0.000833333, 0.00102])
RATE = 240.0


class Leg(NamedTuple):
    """A flight: how long, and what the velocities are at its beginning."""

    duration: float  # s
    v: tuple[float, float, float]  # m/s
    w: tuple[float, float, float]  # rad/s, world axes


class KnownState(NamedTuple):
    p: np.ndarray
    q: np.ndarray
    v: np.ndarray
    w: np.ndarray


class KnownToss(NamedTuple):
    times: np.ndarray
    p: np.ndarray  # (n, 3), m, measured
    q: np.ndarray  # (n, 4), x, y, z, w, measured
    strikes: list[tuple[float, KnownState, KnownState]]  # when, the state before, the state after
    rest: tuple[float, np.ndarray, np.ndarray]  # since when, position, orientation


def toss(
    legs: Sequence[Leg], *, at_rest: float = 0.0, p_noise: float = 0.0, q_noise: float = 0.0, seed: int = 0
) -> KnownToss:
    """The legs one after the other from 1 m up, sampled at `RATE`, then ``at_rest`` s without motion."""
    exact = exact_toss(tuple(legs), at_rest)
    random = np.random.default_rng(seed)
    n = len(exact.times)
    p = exact.p + p_noise * random.standard_normal((n, 3))
    turns = q_noise * random.standard_normal((n, 3))
    q = np.array([_shaken(row, turn) for row, turn in zip(exact.q, turns, strict=True)])
    return exact._replace(p=p, q=q)


@cache
def exact_toss(legs: tuple[Leg, ...], at_rest: float) -> KnownToss:
    """The same without noise."""
    p, q = np.array([0.1, -0.2, 1.0]), about([0.6, 0.0, 0.8], 1.1)
    begin = 0.0
    strikes = []
    previous = None
    rows_p, rows_q = [], []
    end_of_all = sum(leg.duration for leg in legs)
    times = np.arange(int((end_of_all + at_rest) * RATE) + 1) / RATE
    for leg in legs:
        if previous is not None:
            strikes.append((begin, previous, KnownState(p, q, np.array(leg.v), np.array(leg.w))))
        inside = times[(times >= begin) & (times < begin + leg.duration)] - begin
        motion = fly([*inside, leg.duration], p, q, leg.v, leg.w, moments=MOMENTS)
        rows_p.append(motion.p[:-1])
        rows_q.append(motion.q[:-1])
        p, q = motion.p[-1], motion.q[-1]
        previous = KnownState(p, q, motion.v[-1], motion.w[-1])
        begin += leg.duration
    still = len(times) - sum(len(rows) for rows in rows_p)
    rows_p.append(np.tile(p, (still, 1)))
    rows_q.append(np.tile(q, (still, 1)))
    return KnownToss(times, np.concatenate(rows_p), np.concatenate(rows_q), strikes, (end_of_all, p, q))


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The small rotation from a to b, (3,), rad, world axes: the antisymmetric part of B A^T."""
    turn = matrix(b) @ matrix(a).T
    return 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])


def _shaken(q_xyzw: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The orientation turned by a small rotation vector in world axes."""
    small = np.array([1.0, *(0.5 * turn)])
    product = multiply(small / np.linalg.norm(small), np.array([q_xyzw[3], *q_xyzw[:3]]))
    return np.array([*product[1:], product[0]])
