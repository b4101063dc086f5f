# SPDX-License-Identifier: Apache-2.0
"""Problems of one contact in space, drawn at random."""

from __future__ import annotations

import numpy as np

from contact_dynamics import BodyState, Contact, MassProperties, RestitutionLaw, spatial_impact
from contact_dynamics.impact import SpatialImpact

UP = np.array([0.0, 0.0, 1.0])
IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0.0 else -q


def random_body(rng: np.random.Generator, *, slender: float = 3.0) -> MassProperties:
    second_moments = rng.uniform(0.0, slender, size=3) ** 2 + 0.01
    axes = random_rotation(rng)
    inertia = axes @ np.diag(second_moments.sum() - second_moments) @ axes.T
    return MassProperties(mass=float(rng.uniform(0.3, 3.0)), I_B=0.5 * (inertia + inertia.T))


def random_problem(seed: int) -> dict[str, object]:
    """Draw a body with an approaching contact; speeds, arm and friction each in its own scale."""
    rng = np.random.default_rng(seed)
    body = random_body(rng)
    quaternion = rng.normal(size=4)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    arm = rng.normal(size=3) * 10.0 ** rng.uniform(-1.0, 0.5)
    w = rng.normal(size=3) * 10.0 ** rng.uniform(-1.0, 0.5)
    tangential = np.cross(normal, rng.normal(size=3)) * 10.0 ** rng.uniform(-2.0, 0.5)
    contact_velocity = tangential - normal * 10.0 ** rng.uniform(-1.0, 0.5)
    position = rng.normal(size=3)
    return {
        "body": body,
        "state": BodyState(
            p_WB_W=position,
            q_WB=quaternion / np.linalg.norm(quaternion),
            v_WB_W=contact_velocity - np.cross(w, arm),
            w_WB_W=w,
        ),
        "p_WC_W": position + arm,
        "n_W": normal,
        "friction": float(10.0 ** rng.uniform(-1.5, 0.7)),
        "restitution": float(rng.choice([0.0, 1.0, rng.uniform()])),
    }


def solve(problem: dict[str, object], law: RestitutionLaw = RestitutionLaw.POISSON) -> SpatialImpact:
    names = {"p_WC_W": "p_WC_W", "n_W": "normal_W", "friction": "friction", "restitution": "restitution"}
    contact = Contact(**{names[name]: problem[name] for name in names})
    rest = {name: value for name, value in problem.items() if name not in {"body", "state", *names}}
    return spatial_impact(problem["body"], problem["state"], contact, restitution_law=law, **rest)  # type: ignore[arg-type]
