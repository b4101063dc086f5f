# SPDX-License-Identifier: Apache-2.0
"""Batches of planar impacts: the scalar numbers to the last bit, and refusals that name the row."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError, SeparatingContactError
from contact_dynamics.impact import ImpactOutcome, PlanarImpact, RestitutionLaw, planar_impact, planar_impacts
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity


def random_cases(count: int) -> dict[str, np.ndarray]:
    """Draw approaching contacts, among them exact cases: at rest, level, rough, smooth, e = 0 and 1.

    Some normals are unit only within the tolerance.
    """
    rng = np.random.default_rng(7)
    angle = rng.uniform(-math.pi, math.pi, count)
    cases = {
        "masses": rng.uniform(0.5, 2.0, count),
        "inertias": 10.0 ** rng.uniform(-1.0, 1.0, count),
        "v": rng.normal(size=(count, 2)),
        "w": rng.normal(size=count),
        "r": rng.normal(size=(count, 2)),
        "normals": np.column_stack((np.cos(angle), np.sin(angle))),
        "frictions": 10.0 ** rng.uniform(-2.0, 1.0, count),
        "restitutions": rng.uniform(0.0, 1.0, count),
    }
    cases["restitutions"][::7], cases["restitutions"][::11] = 0.0, 1.0
    cases["frictions"][::13], cases["frictions"][::17] = 0.0, 1e300
    contact = cases["v"] + cases["w"][:, None] * np.column_stack((-cases["r"][:, 1], cases["r"][:, 0]))
    leaves = np.einsum("ij,ij->i", contact, cases["normals"]) > 0.0
    cases["v"][leaves] *= -1.0
    cases["w"][leaves] *= -1.0
    cases["normals"][::5] *= 1.0 + 1e-4 * rng.uniform(-1.0, 1.0, (len(cases["normals"][::5]), 1))
    level = slice(0, count // 4)
    cases["normals"][level], cases["w"][level] = [0.0, 1.0], 0.0
    cases["v"][: count // 12] = [0.0, -1.0]
    cases["r"][: count // 24] = [0.0, -1.0]
    cases["v"][count // 12 : count // 4] = [-1.0, 0.0]
    cases["r"][count // 12 : count // 4, 1] = -4.0
    return cases


def scalar(cases: dict[str, np.ndarray], i: int, law: RestitutionLaw) -> PlanarImpact:
    return planar_impact(
        PlanarBody(mass=cases["masses"][i], inertia=cases["inertias"][i]),
        PlanarVelocity(v=tuple(cases["v"][i]), w=cases["w"][i]),
        PlanarContact(
            r=tuple(cases["r"][i]),
            normal=tuple(cases["normals"][i]),
            friction=cases["frictions"][i],
            restitution=cases["restitutions"][i],
        ),
        restitution_law=law,
    )


@pytest.mark.parametrize("law", RestitutionLaw)
def test_equals_the_scalar_call_to_the_last_bit(law: RestitutionLaw) -> None:
    # More than one chunk, so that their seams are inside.
    cases = random_cases(5000)
    batch = planar_impacts(**cases, restitution_law=law)
    assert set(batch.outcomes.tolist()) == set(ImpactOutcome)
    creates_energy = batch.creates_energy
    assert creates_energy.any() == (law is RestitutionLaw.NEWTON)
    for i in range(5000):
        answer = scalar(cases, i, law)
        assert batch.outcomes[i] == answer.outcome
        assert tuple(batch.v[i]) == answer.velocity.v
        assert batch.w[i] == answer.velocity.w
        assert tuple(batch.impulses_C[i]) == answer.impulse_C
        assert tuple(batch.compressions_C[i]) == answer.compression_C
        assert tuple(batch.velocities_before_C[i]) == answer.velocity_before_C
        assert tuple(batch.velocities_after_C[i]) == answer.velocity_after_C
        assert batch.energy_changes[i] == answer.energy_change
        assert creates_energy[i] == answer.creates_energy


def test_single_values_stand_for_all_rows() -> None:
    batch = planar_impacts(
        masses=1.0,
        inertias=1.0,
        v=[[-1.0, -1.0], [1.0, -1.0]],
        w=0.0,
        r=(0.0, -1.0),
        normals=(0.0, 1.0),
        frictions=0.1,
        restitutions=0.5,
    )
    assert batch.v.shape == (2, 2)
    assert batch.w[0] == -batch.w[1] != 0.0


def test_rows_of_unequal_lengths_are_refused() -> None:
    fields = {"masses": 1.0, "inertias": 1.0, "v": [[0.0, -1.0]] * 3, "w": [0.0, 0.0], "r": (0.0, -1.0)}
    with pytest.raises(InvalidFieldError, match="lengths"):
        planar_impacts(**fields, normals=(0.0, 1.0), frictions=0.1, restitutions=0.5)


def test_a_separating_row_is_named() -> None:
    cases = random_cases(6000)
    cases["v"][5000] *= -1.0
    cases["w"][5000] *= -1.0
    with pytest.raises(SeparatingContactError, match="case 5000"):
        planar_impacts(**cases)
