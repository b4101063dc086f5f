# SPDX-License-Identifier: Apache-2.0
"""Two moving bodies: momentum, closed forms, and the fixed world as the limit of a heavy second body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.contact import Contact
from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import RestitutionLaw, spatial_impact, spatial_pair_impact
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.rigid_body.body import angular_momentum, kinetic_energy, momentum

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def random_body(rng: np.random.Generator) -> tuple[MassProperties, BodyState]:
    moments = rng.uniform(0.05, 2.0, size=3)
    body = MassProperties(mass=float(rng.uniform(0.3, 3.0)), I_B=np.diag(moments.sum() - moments))
    q = rng.normal(size=4)
    state = BodyState(
        p_WB_W=rng.normal(size=3),
        q_WB=q / np.linalg.norm(q),
        v_WB_W=rng.normal(size=3),
        w_WB_W=rng.normal(size=3),
    )
    return body, state


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_momentum_and_energy(law: RestitutionLaw, seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, state = random_body(rng)
    second, other_state = random_body(rng)
    point, normal = rng.normal(size=3), rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    if normal @ (state.velocity_of_point(point) - other_state.velocity_of_point(point)) > 0.0:
        normal = -normal
    answer = spatial_pair_impact(
        first,
        state,
        second,
        other_state,
        Contact(
            p_WC_W=point,
            normal_W=normal,
            friction=float(10.0 ** rng.uniform(-1.5, 0.5)),
            restitution=float(rng.uniform()),
        ),
        restitution_law=law,
    )
    assert answer.other_state is not None
    before, after = (
        np.concatenate(
            [
                momentum(first, one) + momentum(second, two),
                angular_momentum(first, one)
                + angular_momentum(second, two)
                + np.cross(one.p_WB_W, momentum(first, one))
                + np.cross(two.p_WB_W, momentum(second, two)),
            ]
        )
        for one, two in ((state, other_state), (answer.state, answer.other_state))
    )
    size = float(np.linalg.norm(before)) + 10.0 * float(np.linalg.norm(answer.impulse_W)) + 10.0
    assert after == pytest.approx(before, abs=1e-14 * size)
    energies = [
        kinetic_energy(first, one) + kinetic_energy(second, two)
        for one, two in ((state, other_state), (answer.state, answer.other_state))
    ]
    assert energies[1] - energies[0] == pytest.approx(answer.energy_change, abs=1e-10 * (1.0 + energies[0]))
    relative = answer.state.velocity_of_point(point) - answer.other_state.velocity_of_point(point)
    assert relative == pytest.approx(answer.velocity_after_W, abs=1e-9)
    if law is not RestitutionLaw.NEWTON:
        assert not answer.creates_energy


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_a_heavy_second_body_is_the_world(law: RestitutionLaw, seed: int) -> None:
    rng = np.random.default_rng(seed)
    body, state = random_body(rng)
    contact = striking(state, rng.normal(size=3), rng)
    heavy = MassProperties(mass=1e30, I_B=1e30 * np.eye(3))
    rest = BodyState(p_WB_W=rng.normal(size=3), q_WB=IDENTITY)
    alone = spatial_impact(body, state, contact, restitution_law=law)
    answer = spatial_pair_impact(body, state, heavy, rest, contact, restitution_law=law)
    assert answer.outcome is alone.outcome
    assert answer.impulse_W == pytest.approx(alone.impulse_W, rel=1e-12, abs=1e-12)
    assert answer.state.v_WB_W == pytest.approx(alone.state.v_WB_W, rel=1e-12, abs=1e-11)


def striking(state: BodyState, point: np.ndarray, rng: np.random.Generator) -> Contact:
    """Return a contact at a point that approaches a resting world."""
    normal = rng.normal(size=3)
    if normal @ state.velocity_of_point(point) > 0.0:
        normal = -normal
    return Contact(
        p_WC_W=point,
        normal_W=normal / np.linalg.norm(normal),
        friction=float(10.0 ** rng.uniform(-2, 1)),
        restitution=float(rng.choice([0.0, 1.0, rng.uniform()])),
    )


def test_bodies_that_separate_are_refused() -> None:
    rng = np.random.default_rng(3)
    body, state = random_body(rng)
    contact = striking(state, rng.normal(size=3), rng)
    away = replace(contact, normal_W=-contact.normal_W)
    rest = BodyState(p_WB_W=rng.normal(size=3), q_WB=IDENTITY)
    with pytest.raises(SeparatingContactError, match="v_n = "):
        spatial_pair_impact(body, state, body, rest, away)
