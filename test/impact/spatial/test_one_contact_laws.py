# SPDX-License-Identifier: Apache-2.0
"""What every impact at one contact in space obeys: its laws, and turned and mirrored problems."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from contact_dynamics.contact.contact import Contact
from contact_dynamics.impact import PathEvent, RestitutionLaw, spatial_impact
from contact_dynamics.rigid_body.body import BodyState, MassProperties, kinetic_energy
from impact.spatial.drawn_problem import random_problem, solve
from sweeps import seeds


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_admissible(law: RestitutionLaw, seed: int) -> None:
    problem = random_problem(seed)
    answer = solve(problem, law)
    normal, mu, body = problem["n_W"], problem["friction"], problem["body"]
    i_n = float(answer.impulse_W @ normal)
    size = float(np.linalg.norm(answer.impulse_W))
    assert np.linalg.norm(answer.impulse_W - i_n * normal) <= mu * i_n * (1 + 1e-12) + 1e-14 * size
    speed = float(np.linalg.norm(answer.velocity_before_W))
    after = answer.state.velocity_of_point(problem["p_WC_W"])
    assert after == pytest.approx(answer.velocity_after_W, abs=1e-10 * speed)
    assert answer.velocity_after_W @ normal >= -1e-12 * speed
    if answer.outcome.sticks:
        sliding = answer.velocity_after_W - normal * (normal @ answer.velocity_after_W)
        assert np.linalg.norm(sliding) <= 1e-13 * speed
    if law is not RestitutionLaw.NEWTON:
        assert not answer.creates_energy
    before_energy = kinetic_energy(body, problem["state"])
    assert kinetic_energy(body, answer.state) - before_energy == pytest.approx(
        answer.energy_change, abs=1e-11 * max(before_energy, size * speed)
    )


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_laws_mean_what_they_say(law: RestitutionLaw, seed: int) -> None:
    problem = random_problem(seed)
    answer = solve(problem, law)
    assume(answer.path_events.count(PathEvent.COMPRESSION_ENDS) == 1)
    normal, e = problem["n_W"], problem["restitution"]
    if law is RestitutionLaw.POISSON:
        assert answer.restitution_W @ normal == pytest.approx(
            e * (answer.compression_W @ normal), rel=1e-9, abs=1e-14
        )
    elif law is RestitutionLaw.NEWTON:
        assert answer.velocity_after_W @ normal == pytest.approx(
            -e * (answer.velocity_before_W @ normal), rel=1e-9, abs=1e-12
        )
    at_end = (
        problem["state"].velocity_of_point(problem["p_WC_W"])
        + answer.inverse_inertia_W @ answer.compression_W
    )
    assert at_end @ normal == pytest.approx(0.0, abs=1e-10 * float(np.linalg.norm(at_end) + 1.0))


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_mirrored_problems_have_mirrored_answers_to_the_last_bit(law: RestitutionLaw, seed: int) -> None:
    """In a coordinate plane, since only signs change."""
    problem = random_problem(seed)
    state, body = problem["state"], problem["body"]
    mirror = np.array([1.0, -1.0, 1.0])
    image = {
        **problem,
        "body": MassProperties(mass=body.mass, I_B=body.I_B * np.outer(mirror, mirror)),
        "state": BodyState(
            p_WB_W=state.p_WB_W * mirror,
            q_WB=state.q_WB * [-1.0, 1.0, -1.0, 1.0],
            v_WB_W=state.v_WB_W * mirror,
            w_WB_W=-state.w_WB_W * mirror,
        ),
        "p_WC_W": problem["p_WC_W"] * mirror,
        "n_W": problem["n_W"] * mirror,
    }
    answer, other = solve(problem, law), solve(image, law)
    assert other.outcome is answer.outcome
    assert other.impulse_W.tolist() == (answer.impulse_W * mirror).tolist()
    assert other.state.v_WB_W.tolist() == (answer.state.v_WB_W * mirror).tolist()
    assert other.state.w_WB_W.tolist() == (-answer.state.w_WB_W * mirror).tolist()


@seeds(range(40))
def test_the_laws_agree_where_a_body_falls_without_spin(seed: int) -> None:
    """The contact then slides in one direction throughout, or sticks throughout: the path is straight."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=4)
    second_moments = rng.uniform(0.05, 2.0, size=3)
    body = MassProperties(mass=1.3, I_B=np.diag(second_moments.sum() - second_moments))
    state = BodyState(p_WB_W=np.zeros(3), q_WB=q / np.linalg.norm(q), v_WB_W=[0.0, 0.0, -2.0])
    arm = rng.normal(size=3)
    contact = Contact(
        p_WC_W=[arm[0], arm[1], -abs(arm[2])],
        normal_W=[0.0, 0.0, 1.0],
        friction=float(rng.uniform(0.0, 1.0)),
        restitution=float(rng.uniform(0.0, 1.0)),
    )
    poisson, *others = (spatial_impact(body, state, contact, restitution_law=law) for law in RestitutionLaw)
    for other in others:
        np.testing.assert_allclose(other.impulse_W, poisson.impulse_W, rtol=1e-12, atol=1e-12)
