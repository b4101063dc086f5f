# SPDX-License-Identifier: Apache-2.0
"""Contacts that approach equally fast strike as one: no list decides, and what is symmetric stays so."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact import (
    RestitutionLaw,
    bodies_impact,
    impact_sequence,
    outcomes_over_orders,
    several_impact,
)
from contact_dynamics.rigid_body.body import BodyState, MassProperties, kinetic_energy
from contact_dynamics.world import Body, World
from sweeps import seeds

LEVEL = [0.0, 0.0, 0.0, 1.0]
MIRROR = np.array([-1.0, 1.0, 1.0])
Landing = tuple[MassProperties, BodyState, ContactSet]


def tied(seed: int) -> Landing:
    """Draw a body whose contacts all approach equally fast, with one or two materials.

    They are on a level floor, or on a cone around the velocity, and the body does not turn or, on the floor,
    turns about the vertical.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 6))
    moments = rng.uniform(0.1, 1.0, size=3)
    points = rng.uniform(-1.0, 1.0, size=(n, 3))
    points[:, 2] = -rng.uniform(0.3, 1.0)
    around = rng.uniform(0.0, 2.0 * math.pi, size=n)
    tilt = rng.uniform(0.2, 1.0) if seed % 2 else 0.0
    normals = np.column_stack(
        [np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around), np.full(n, np.cos(tilt))]
    )
    two = rng.integers(2, size=n) * (seed % 3 == 0)
    velocity = np.array([0.0, 0.0, -2.0]) + (0.0 if seed % 2 else [*rng.normal(size=2), 0.0])
    return (
        MassProperties(mass=float(rng.uniform(0.5, 2.0)), I_B=np.diag(moments.sum() - moments)),
        BodyState(
            p_WB_W=np.zeros(3),
            q_WB=LEVEL,
            v_WB_W=velocity,
            w_WB_W=[0.0, 0.0, 0.0 if seed % 2 else rng.normal()],
        ),
        ContactSet(
            p_WC_W=points,
            normals_W=normals,
            frictions=np.where(two, *rng.uniform(0.0, 0.7, size=2)),
            restitutions=np.where(two, *rng.choice([0.0, 0.3, 0.7, 1.0], size=2)),
        ),
    )


def velocities(state: BodyState) -> np.ndarray:
    return np.concatenate([state.v_WB_W, state.w_WB_W])


@seeds(range(20), slow=range(20, 402))
def test_ties_know_no_list_no_hand_and_no_axes_and_make_no_energy(seed: int) -> None:
    body, state, contacts = tied(seed)
    rng = np.random.default_rng(seed)
    listed = rng.permutation(len(contacts)).tolist()
    rotation = Rotation.random(random_state=seed)
    turn = rotation.as_matrix().T
    mirrored = BodyState(
        p_WB_W=MIRROR * state.p_WB_W, q_WB=LEVEL, v_WB_W=MIRROR * state.v_WB_W, w_WB_W=-MIRROR * state.w_WB_W
    )
    turned = BodyState(
        p_WB_W=state.p_WB_W @ turn,
        q_WB=rotation.as_quat(),
        v_WB_W=state.v_WB_W @ turn,
        w_WB_W=state.w_WB_W @ turn,
    )

    def elsewhere(points: np.ndarray, normals: np.ndarray) -> ContactSet:
        return ContactSet(
            p_WC_W=points, normals_W=normals, frictions=contacts.frictions, restitutions=contacts.restitutions
        )

    for law in RestitutionLaw:
        answer = several_impact(body, state, contacts, restitution_law=law)
        after = velocities(answer.state)
        size = 1.0 + float(np.abs(after).max())
        again = several_impact(body, state, contacts.subset(listed), restitution_law=law)
        assert velocities(again.state) == pytest.approx(after, abs=1e-10 * size)
        assert again.impulses_W == pytest.approx(answer.impulses_W[listed], abs=1e-10 * size)
        image = several_impact(
            body,
            mirrored,
            elsewhere(MIRROR * contacts.p_WC_W, MIRROR * contacts.normals_W),
            restitution_law=law,
        )
        assert image.state.v_WB_W == pytest.approx(MIRROR * answer.state.v_WB_W, abs=1e-10 * size)
        assert image.state.w_WB_W == pytest.approx(-MIRROR * answer.state.w_WB_W, abs=1e-10 * size)
        round_it = several_impact(
            body, turned, elsewhere(contacts.p_WC_W @ turn, contacts.normals_W @ turn), restitution_law=law
        )
        assert round_it.state.v_WB_W == pytest.approx(answer.state.v_WB_W @ turn, abs=1e-9 * size)
        assert round_it.state.w_WB_W == pytest.approx(answer.state.w_WB_W @ turn, abs=1e-9 * size)

        normal = np.einsum("ij,ij->i", answer.impulses_W, contacts.normals_W)
        tangential = np.linalg.norm(answer.impulses_W - normal[:, None] * contacts.normals_W, axis=1)
        assert (tangential <= contacts.frictions * normal + 1e-12 * size).all()
        gained = body.mass * (answer.state.v_WB_W - state.v_WB_W)
        assert gained == pytest.approx(answer.impulses_W.sum(axis=0), abs=1e-12 * size)
        moments = np.cross(contacts.p_WC_W, answer.impulses_W).sum(axis=0)
        turning = body.I_B @ (answer.state.w_WB_W - state.w_WB_W)
        assert turning == pytest.approx(moments, abs=1e-12 * size)
        if law is not RestitutionLaw.NEWTON:
            assert kinetic_energy(body, answer.state) <= kinetic_energy(body, state) * (1.0 + 1e-12)


RADIUS, HEIGHT, MASS = 0.0121, 0.002, 0.0075
COIN = MassProperties(
    mass=MASS,
    I_B=MASS * np.diag([RADIUS**2 / 4 + HEIGHT**2 / 12, RADIUS**2 / 4 + HEIGHT**2 / 12, RADIUS**2 / 2]),
)


def flat_coin(*, v_x: float = 0.0, friction: float = 0.3) -> Landing:
    """Return a coin that lands flat at 1 m/s, with eight points of its rim, e = 0.5."""
    turns = 2.0 * math.pi * np.arange(8) / 8
    rim = np.column_stack([RADIUS * np.cos(turns), RADIUS * np.sin(turns), np.zeros(8)])
    contacts = ContactSet(p_WC_W=rim, normals_W=[0.0, 0.0, 1.0], frictions=friction, restitutions=0.5)
    return (COIN, BodyState(p_WB_W=[0, 0, HEIGHT / 2], q_WB=LEVEL, v_WB_W=[v_x, 0, -1]), contacts)


@pytest.mark.parametrize("law", RestitutionLaw)
def test_a_coin_dropped_flat_bounces_level_and_its_order_is_open(law: RestitutionLaw) -> None:
    """It had 17 rad/s, of a rim point that was listed first."""
    answer = several_impact(*flat_coin(), restitution_law=law)
    assert velocities(answer.state) == pytest.approx([0.0, 0.0, 0.5, 0.0, 0.0, 0.0], abs=1e-12)
    assert answer.impulses_W[:, 2] == pytest.approx(np.full(8, 1.5 * MASS / 8), rel=1e-12)
    assert answer.order_is_open
    coin, state, contacts = flat_coin()
    body, world = Body(name="coin", mass_properties=coin), World()
    in_time = impact_sequence(body, state, world, contacts=contacts, restitution_law=law, window=0.01)
    assert velocities(in_time.state) == pytest.approx([0.0, 0.0, 0.5, 0.0, 0.0, 0.0], abs=1e-12)
    assert in_time.order_is_open
    assert not in_time.creates_energy


def test_one_strike_at_a_time_leaves_no_order_open() -> None:
    coin, state, rim = flat_coin()
    tilted = BodyState(p_WB_W=state.p_WB_W, q_WB=LEVEL, w_WB_W=[0.0, 1.0, 0.0])
    answer = several_impact(coin, tilted, rim.subset([0, 4]))  # one falls, one rises
    assert not answer.order_is_open
    assert len(outcomes_over_orders(coin, tilted, rim.subset([0, 4])).orders) == 1


def test_a_sliding_coin_stays_in_its_plane_of_symmetry() -> None:
    answer = several_impact(*flat_coin(v_x=0.4))
    v, w = answer.state.v_WB_W, answer.state.w_WB_W
    assert (v[1], w[0], w[2]) == pytest.approx((0.0, 0.0, 0.0), abs=1e-11)
    assert v[0] < 0.4
    # The rim points on both sides of the plane have the same impulses.
    assert answer.impulses_W[[1, 2, 3], 2] == pytest.approx(answer.impulses_W[[7, 6, 5], 2], abs=1e-13)


def test_a_spinning_coin_is_slowed_by_all_of_its_rim() -> None:
    """Friction mu times the impulse acts around the rim: w falls by mu R (1 + e) v / (R^2 / 2)."""
    coin, state, rim = flat_coin(friction=0.1)
    spinning = BodyState(p_WB_W=state.p_WB_W, q_WB=LEVEL, v_WB_W=state.v_WB_W, w_WB_W=[0.0, 0.0, 100.0])
    answer = several_impact(coin, spinning, rim)
    slowed = 100.0 - 0.1 * 1.5 * 1.0 / (RADIUS / 2.0)
    assert velocities(answer.state) == pytest.approx([0.0, 0.0, 0.5, 0.0, 0.0, slowed], abs=1e-10)


@pytest.mark.parametrize("law", RestitutionLaw)
def test_a_ball_struck_from_both_sides_stays(law: RestitutionLaw) -> None:
    """Each outer ball of mass m rebounds with e, as from a wall, and the middle one is not moved."""
    radius, e = 0.02, 0.6
    ball = MassProperties(mass=0.1, I_B=0.4 * 0.1 * radius**2 * np.eye(3))
    states = [
        BodyState(p_WB_W=[2 * radius * i, 0, 0], q_WB=LEVEL, v_WB_W=[v, 0, 0])
        for i, v in enumerate((1.0, 0.0, -1.0))
    ]
    contacts = ContactSet(
        p_WC_W=[[radius, 0, 0], [3 * radius, 0, 0]], normals_W=[-1, 0, 0], frictions=0.3, restitutions=e
    )
    answer = bodies_impact([ball] * 3, states, contacts, [(0, 1), (1, 2)], restitution_law=law)
    after = np.array([state.v_WB_W[0] for state in answer.states])
    assert after == pytest.approx([-e, 0.0, e], abs=1e-13)


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("degrees", [5.0, 30.0, 45.0, 60.0, 85.0])
def test_a_ball_dropped_into_a_groove_bounces_by_hand_calculation(
    degrees: float, friction: float, restitution: float, law: RestitutionLaw
) -> None:
    """Both sides take the same impulse, and the ball moves up and down only.

    While it falls, friction helps the sides, dv/dp = 2 (cos + mu sin) / m for the normal impulse p of a side.
    While it rises, friction holds it back, dv/dp = 2 (cos - mu sin) / m, or for good if that is not positive.
    """
    angle, radius = math.radians(degrees), 0.05
    c, s = math.cos(angle), math.sin(angle)
    normals = np.array([[s, 0.0, c], [-s, 0.0, c]])
    body = MassProperties(mass=1.0, I_B=0.4 * radius**2 * np.eye(3))
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=LEVEL, v_WB_W=[0, 0, -1])
    contacts = ContactSet(
        p_WC_W=-radius * normals, normals_W=normals, frictions=friction, restitutions=restitution
    )
    impact = several_impact(body, state, contacts, restitution_law=law)
    down, up = 2.0 * (c + friction * s), 2.0 * (c - friction * s)
    compression, expected = 1.0 / down, 0.0
    if up > 1e-9:
        expected = {
            RestitutionLaw.POISSON: restitution * compression * up,
            RestitutionLaw.NEWTON: restitution,
            RestitutionLaw.ENERGETIC: restitution * math.sqrt(up / down),
        }[law]
    # What is left of the response of contacts that stick counts as 1e-12, so v is off by some 1e-12.
    np.testing.assert_allclose(impact.state.v_WB_W, [0.0, 0.0, expected], atol=1e-10)
    np.testing.assert_allclose(impact.state.w_WB_W, 0.0, atol=1e-10)
    pressing = (impact.impulses_W * normals).sum(axis=1)
    across = np.linalg.norm(impact.impulses_W - pressing[:, None] * normals, axis=1)
    assert (pressing >= compression * (1.0 - 1e-10)).all()
    assert (across <= friction * pressing * (1.0 + 1e-10) + 1e-10).all()
