# SPDX-License-Identifier: Apache-2.0
"""Interleaved impacts: bounds hold for every brute-force interleaving, and drawn outcomes are right."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties, RestitutionLaw, spatial_impact
from contact_dynamics.impact import outcomes_over_interleavings, outcomes_over_orders
from contact_dynamics.rigid_body.body import inverse_mass_matrix, kinetic_energy
from oracles import impact_interleaved
from sweeps import seeds


def landing(seed: int) -> tuple[MassProperties, BodyState, ContactSet]:
    """Draw a box that lands on two to four corners, with friction and restitution of each corner's own."""
    rng = np.random.default_rng(seed)
    n = 2 + seed % 3
    corners = np.array([[0.1, 0.1, 0.0], [-0.1, 0.1, 0.0], [0.1, -0.1, 0.0], [-0.1, -0.1, 0.0]])[:n]
    return (
        MassProperties(mass=1.0, I_B=np.diag([0.01, 0.012, 0.015])),
        BodyState(
            p_WB_W=[0.0, 0.0, 0.1],
            q_WB=[0.0, 0.0, 0.0, 1.0],
            v_WB_W=[*rng.normal(size=2), -1.0],
            w_WB_W=rng.normal(size=3),
        ),
        ContactSet(
            p_WC_W=corners,
            normals_W=[0.0, 0.0, 1.0],
            frictions=rng.uniform(0.0, 1.0, size=n),
            restitutions=rng.uniform(0.0, 1.0, size=n),
        ),
    )


@pytest.mark.parametrize("seed", [0, 1])
def test_brute_force_never_leaves_the_bounds(seed: int) -> None:
    body, state, contacts = landing(seed)
    outcomes = outcomes_over_interleavings(body, state, contacts, samples=1)
    rng = np.random.default_rng(seed)
    for _ in range(2):
        after = impact_interleaved.velocity_after(
            inverse_mass=inverse_mass_matrix(body.mass, body.I_B),
            twist=np.concatenate([state.v_WB_W, state.w_WB_W]),
            arms=contacts.p_WC_W - state.p_WB_W,
            normals=contacts.normals_W,
            frictions=contacts.frictions,
            restitutions=contacts.restitutions,
            increment=2e-3,
            weights=np.exp(3.0 * rng.normal(size=len(contacts))),
            rng=rng,
        )
        # The oracle's increments are 1/200 of the impulse, and its errors of their order.
        scale = np.array([0.01] * 3 + [0.1] * 3)
        assert (after >= outcomes.lowest_W - scale).all()
        assert (after <= outcomes.highest_W + scale).all()


@seeds(range(3))
def test_what_is_drawn_is_within_the_bounds_and_creates_no_energy(seed: int) -> None:
    body, state, contacts = landing(seed)
    outcomes = outcomes_over_interleavings(body, state, contacts, samples=50)
    width = outcomes.highest_W - outcomes.lowest_W
    # An increment is 1/200 of the impulse that stops the fastest approach.
    assert (outcomes.velocities_W >= outcomes.lowest_W - 0.01 * width).all()
    assert (outcomes.velocities_W <= outcomes.highest_W + 0.01 * width).all()
    assert (outcomes.gap >= -0.01 * width).all()
    before = kinetic_energy(body, state)
    for row in outcomes.velocities_W:
        after = BodyState(p_WB_W=state.p_WB_W, q_WB=state.q_WB, v_WB_W=row[:3], w_WB_W=row[3:])
        assert kinetic_energy(body, after) <= 1.005 * before
        lift = after.velocity_of_point(contacts.p_WC_W) @ [0.0, 0.0, 1.0]
        assert lift.min() >= -1e-8


def test_the_outcomes_of_all_orders_come_first() -> None:
    body, state, contacts = landing(1)
    ordered = outcomes_over_orders(body, state, contacts, restitution_law=RestitutionLaw.ENERGETIC)
    outcomes = outcomes_over_interleavings(body, state, contacts, samples=10)
    count = len(ordered.velocities_W)
    assert outcomes.velocities_W[:count].tolist() == ordered.velocities_W.tolist()
    assert (outcomes.spread >= ordered.spread).all()


@pytest.mark.parametrize("seed", [0])
def test_one_contact_has_one_outcome(seed: int) -> None:
    body, state, contacts = landing(seed)
    alone = contacts.subset([0])
    single = spatial_impact(body, state, alone[0], restitution_law=RestitutionLaw.ENERGETIC).state
    after = np.concatenate([single.v_WB_W, single.w_WB_W])
    change = np.linalg.norm(after[3:] - state.w_WB_W)
    outcomes = outcomes_over_interleavings(body, state, alone, samples=5)
    # First order in increments of 1/200.
    assert outcomes.velocities_W == pytest.approx(
        np.tile(after, (len(outcomes.velocities_W), 1)), abs=0.01 * change
    )


def test_a_level_frictionless_landing_without_restitution_ends_at_rest() -> None:
    """Each impulse at one end of a rod drives the other end down, so all of them end where both stop."""
    rod = MassProperties(mass=2.0, I_B=np.diag([1e-4, 2.0 / 3.0, 2.0 / 3.0]))
    ends = ContactSet(
        p_WC_W=[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], normals_W=[0, 0, 1], frictions=0.0, restitutions=0.0
    )
    state = BodyState(p_WB_W=np.zeros(3), q_WB=[0, 0, 0, 1], v_WB_W=[0.3, 0.0, -1.0])
    outcomes = outcomes_over_interleavings(rod, state, ends, samples=20)
    rest = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert outcomes.velocities_W == pytest.approx(np.tile(rest, (len(outcomes.velocities_W), 1)), abs=1e-8)
    # No impulse has a part along x or y, or a moment about x or z: the bounds know that.
    assert (outcomes.highest_W - outcomes.lowest_W)[[0, 1, 3, 5]] == pytest.approx(np.zeros(4), abs=1e-4)


def test_a_seed_gives_the_same_draw_again() -> None:
    body, state, contacts = landing(2)
    first, again, other = (
        outcomes_over_interleavings(body, state, contacts, samples=20, seed=seed) for seed in (7, 7, 8)
    )
    assert first.velocities_W.tolist() == again.velocities_W.tolist()
    assert first.velocities_W.tolist() != other.velocities_W.tolist()


def test_bounds_do_not_depend_on_the_list() -> None:
    body, state, contacts = landing(1)
    found = [
        outcomes_over_interleavings(body, state, contacts.subset(order), samples=1)
        for order in ([0, 1, 2], [2, 0, 1])
    ]
    for other in found[1:]:
        assert other.lowest_W == pytest.approx(found[0].lowest_W, abs=1e-6)
        assert other.highest_W == pytest.approx(found[0].highest_W, abs=1e-6)
