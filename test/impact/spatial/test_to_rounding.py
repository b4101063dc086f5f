# SPDX-License-Identifier: Apache-2.0
"""Impulse paths in space are right to rounding, beside 40 digits, also for slender bodies.

Doubles hold the contact's inverse inertia to a rounding of its largest number. A long rod responds a million
times more to one impulse than to another, and then this rounding moves the small responses a million times
more. So errors are compared with roundings times the condition number of the inverse inertia. The draws
need at most 4 of them, and 12 are allowed.
"""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from mpmath import mpf

from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.impact.spatial.path import SlidingLaw, trace
from oracles import impact_swerving
from sweeps import seeds

ROUNDINGS = 12

SLENDER = {"ordinary": 1.0, "slender": 1e-6, "needle": 1e-8}
"""Ratio of the least moment of inertia to the others, roughly."""


def drawn(rng: np.random.Generator, ratio: float) -> tuple[SlidingLaw, tuple[float, float], float, float]:
    """Draw a contact of a body with a slender axis: its law, sliding velocity, normal velocity and e."""
    second_moments = rng.uniform(0.05, 3.0, size=3) ** 2
    if ratio < 1.0:
        second_moments[1:] *= ratio * rng.uniform(0.3, 1.0, size=2)
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    inertia = axes @ np.diag(second_moments.sum() - second_moments) @ axes.T
    mass = rng.uniform(0.3, 3.0)
    x, y, z = rng.normal(size=3) * 10.0 ** rng.uniform(-1.0, 0.5)
    arm = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    response = np.eye(3) / mass - arm @ np.linalg.inv(inertia) @ arm
    values, vectors = np.linalg.eigh(response[:2, :2])
    coupling = vectors.T @ response[:2, 2]
    u = rng.normal(size=2) * 10.0 ** rng.uniform(-2.0, 0.5)
    v_n = -(10.0 ** rng.uniform(-1.0, 0.5))
    mu, e = 10.0 ** rng.uniform(-1.5, 0.7), float(rng.choice([0.0, 1.0, rng.uniform()]))
    law = SlidingLaw(*(float(x) for x in (*values, *coupling, response[2, 2], mu)))
    return law, (float(u[0]), float(u[1])), float(v_n), e


def beside_an_invariant_direction(
    rng: np.random.Generator, law: SlidingLaw, speed: float
) -> tuple[float, float]:
    """Return a sliding velocity off an invariant direction by 1e-14 to 1e-2 rad, on a logarithmic scale."""

    def turning(angle: float) -> float:
        return float(law.turning(math.cos(angle), math.sin(angle)))

    angles = np.linspace(-math.pi, math.pi, 4001)
    signs = [turning(a) > 0.0 for a in angles]
    low, high = rng.choice([angles[i : i + 2] for i in range(4000) if signs[i] != signs[i + 1]])
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if (turning(middle) > 0.0) == (turning(low) > 0.0) else (low, middle)
    angle = low + rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-14.0, -2.0)
    return speed * math.cos(angle), speed * math.sin(angle)


def errors(seed: int, kind: str, law: RestitutionLaw, *, beside: bool) -> tuple[float, float]:
    """Return the relative error of the impulse, and the condition number of the inverse inertia."""
    rng = np.random.default_rng(seed)
    sliding, u, v_n, e = drawn(rng, SLENDER[kind])
    if beside:
        u = beside_an_invariant_direction(rng, sliding, math.hypot(*u))
    k1, k2 = sliding.k1, sliding.k2
    response = [[sliding.l1, 0.0, k1], [0.0, sliding.l2, k2], [k1, k2, sliding.kn]]
    exact = impact_swerving.impulse(response, u, v_n, mu=sliding.mu, e=e, law=law.name.lower())
    found = trace(sliding, u, v_n, restitution=e, law=law).impulse
    size = math.sqrt(sum(float(x) ** 2 for x in exact))
    error = max(abs(float(mpf(a) - b)) for a, b in zip(found, exact, strict=True))
    return error / size, float(np.linalg.cond(response))


@pytest.mark.parametrize(
    ("seed", "kind", "beside", "law"),
    [
        (13, "ordinary", False, RestitutionLaw.ENERGETIC),
        (15, "slender", False, RestitutionLaw.ENERGETIC),
        (15, "needle", False, RestitutionLaw.POISSON),
        (3, "ordinary", True, RestitutionLaw.NEWTON),
        (10, "slender", True, RestitutionLaw.POISSON),
    ],
)
def test_the_impulse_is_right_to_rounding(seed: int, kind: str, law: RestitutionLaw, *, beside: bool) -> None:
    error, condition = errors(seed, kind, law, beside=beside)
    assert error <= ROUNDINGS * sys.float_info.epsilon * condition


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("kind", SLENDER)
@pytest.mark.parametrize("beside", [False, True])
@seeds((), slow=range(100, 140))
def test_every_draw_is_right_to_rounding(seed: int, kind: str, law: RestitutionLaw, *, beside: bool) -> None:
    error, condition = errors(seed, kind, law, beside=beside)
    assert error <= ROUNDINGS * sys.float_info.epsilon * condition
