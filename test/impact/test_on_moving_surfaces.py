# SPDX-License-Identifier: Apache-2.0
"""Impacts on surfaces that move: rackets, paddles and belts. Only velocities relative to them count."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import contact_dynamics as cd
from contact_dynamics import RestitutionLaw, bodies_impact
from contact_dynamics.errors import InvalidFieldError, SeparatingContactError
from contact_dynamics.impact import (
    ResolvedImpact,
    SeveralContactsLaw,
    StrikingBodies,
    outcomes_over_orders,
    spatial_impacts,
)
from contact_dynamics.plane import planar_in_space
from contact_dynamics.rigid_body import kinetic_energy
from impact.spatial.drawn_problem import random_problem

UP = (0.0, 0.0, 1.0)
BALL = cd.MassProperties(mass=0.06, I_B=0.4 * 0.06 * 0.033**2 * np.eye(3))
BRICK = cd.MassProperties(mass=0.4, I_B=np.diag([3e-4, 9e-4, 1e-3]))
BOOST = np.array([3.0, -7.0, 2.0])


def drawn(seed: int) -> tuple[cd.MassProperties, cd.BodyState, cd.Contact]:
    problem = random_problem(seed)
    contact = cd.Contact(
        p_WC_W=problem["p_WC_W"],  # type: ignore[arg-type]
        normal_W=problem["n_W"],  # type: ignore[arg-type]
        friction=problem["friction"],  # type: ignore[arg-type]
        restitution=problem["restitution"],  # type: ignore[arg-type]
    )
    return problem["body"], problem["state"], contact  # type: ignore[return-value]


def boosted(state: cd.BodyState, velocity: np.ndarray = BOOST) -> cd.BodyState:
    return replace(state, v_WB_W=state.v_WB_W + velocity)


@pytest.mark.parametrize("law", RestitutionLaw)
def test_a_velocity_that_body_and_surface_share_is_added_to_the_answer(law: RestitutionLaw) -> None:
    for seed in range(20):
        body, state, contact = drawn(seed)
        still = cd.spatial_impact(body, state, contact, restitution_law=law)
        moving = replace(contact, surface_velocity_W=BOOST, surface_angular_velocity_W=[0, 0, 9])
        found = cd.spatial_impact(body, boosted(state), moving, restitution_law=law)
        size = 1e-13 * float(abs(state.v_WB_W).max() + 10.0) / float(abs(still.velocity_before_W).max())
        assert found.outcome is still.outcome
        assert found.state.v_WB_W == pytest.approx(still.state.v_WB_W + BOOST, rel=1e-9)
        assert found.state.w_WB_W == pytest.approx(still.state.w_WB_W, rel=1e-9)
        assert found.impulse_W == pytest.approx(still.impulse_W, abs=1e3 * size * abs(still.impulse_W).max())
        for name in ("velocity_before_W", "velocity_after_W"):
            speed = float(abs(still.velocity_before_W).max())
            assert getattr(found, name) == pytest.approx(getattr(still, name), abs=1e-9 * speed)
        # What the surface does to the body is its work and the change that is relative to it.
        gained = kinetic_energy(body, found.state) - kinetic_energy(body, boosted(state))
        worked = float(found.impulse_W @ BOOST)
        assert found.energy_change == pytest.approx(still.energy_change, rel=1e-9)
        assert gained == pytest.approx(found.energy_change + worked, rel=1e-9, abs=1e-9 * abs(worked))
        if law is not RestitutionLaw.NEWTON:
            assert not found.creates_energy


FEET = cd.ContactSet(
    p_WC_W=[[x, y, 0.0] for x in (-0.1, 0.1) for y in (-0.05, 0.05)],
    normals_W=UP,
    frictions=0.4,
    restitutions=0.5,
)
LEANING = cd.BodyState(p_WB_W=[0, 0, 0.03], q_WB=[0, 0, 0, 1], v_WB_W=[0.4, 0.1, -1], w_WB_W=[0.3, -0.2, 0.5])
FLAT = cd.BodyState(p_WB_W=[0, 0, 0.03], q_WB=[0, 0, 0, 1], v_WB_W=[0.4, 0.1, -1])
SEVERAL: dict[str, Callable[[cd.BodyState, cd.ContactSet], np.ndarray]] = {
    **{
        f"{law.name} {state}": lambda state, contacts, law=law: _velocity(  # type: ignore[misc]
            cd.several_impact(BRICK, state, contacts, several_contacts_law=law).state
        )
        for law in SeveralContactsLaw
        for state in ("leaning", "flat")
    },
    "bodies leaning": lambda state, contacts: _velocity(
        bodies_impact([BRICK], [state], contacts, [(0, None)] * 4).states[0]
    ),
    "orders leaning": lambda state, contacts: (
        outcomes_over_orders(BRICK, state, contacts, max_orders=3).velocities_W
    ),
}


def _velocity(state: cd.BodyState) -> np.ndarray:
    return np.concatenate([state.v_WB_W, state.w_WB_W])


@pytest.mark.parametrize("name", SEVERAL)
def test_at_several_contacts_too(name: str) -> None:
    state = LEANING if name.endswith("leaning") else FLAT
    still = SEVERAL[name](state, FEET)
    found = SEVERAL[name](boosted(state), replace(FEET, surface_velocities_W=BOOST))
    assert found - np.concatenate([BOOST, np.zeros(3)]) == pytest.approx(still, abs=1e-9)


@pytest.mark.parametrize("law", SeveralContactsLaw)
def test_a_brick_between_two_belts_ends_without_approaching_either(law: SeveralContactsLaw) -> None:
    # Two feet on each belt; one of the belts rises. Friction and e differ little, so that none tie.
    belts = np.repeat([[0.5, 0.0, 0.0], [-1.0, 0.3, 0.4]], 2, axis=0)
    contacts = replace(FEET, surface_velocities_W=belts, frictions=[0.3, 0.35, 0.4, 0.45])
    found = cd.several_impact(BRICK, FLAT, contacts, several_contacts_law=law)
    points = contacts.p_WC_W
    relative = np.array([found.state.velocity_of_point(p) for p in points]) - belts
    assert found.velocities_after_W == pytest.approx(relative, abs=1e-12)
    assert found.velocities_before_W == pytest.approx(FLAT.v_WB_W - belts, abs=1e-12)
    assert (relative[:, 2] >= -1e-8).all()
    across = np.linalg.norm(found.impulses_W[:, :2], axis=1)
    assert (across <= contacts.frictions * found.impulses_W[:, 2] + 1e-9).all()
    gained = kinetic_energy(BRICK, found.state) - kinetic_energy(BRICK, FLAT)
    mean = 0.5 * (found.velocities_before_W + found.velocities_after_W) + belts
    assert gained == pytest.approx(float((found.impulses_W * mean).sum()), rel=1e-9)
    momentum = BRICK.mass * (found.state.v_WB_W - FLAT.v_WB_W)
    assert found.impulses_W.sum(axis=0) == pytest.approx(momentum, abs=1e-9)


def test_a_face_that_lands_flat_on_a_rising_tray_bounces_level() -> None:
    tray = replace(FEET, surface_velocities_W=[0.4, 0.1, 0.6])
    found = cd.several_impact(BRICK, FLAT, tray)
    assert found.state.v_WB_W == pytest.approx([0.4, 0.1, (1.0 + 0.5) * 0.6 + 0.5], abs=1e-12)
    assert found.state.w_WB_W == pytest.approx([0, 0, 0], abs=1e-12)


def test_a_ball_on_a_rising_paddle() -> None:
    e, v, paddle = 0.8, -2.0, 1.5
    falling = cd.BodyState(p_WB_W=[0, 0, 0.033], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, v])
    contact = cd.Contact(
        p_WC_W=[0, 0, 0], normal_W=UP, friction=0.3, restitution=e, surface_velocity_W=[0, 0, paddle]
    )
    expected = (1.0 + e) * paddle - e * v
    assert cd.spatial_impact(BALL, falling, contact).state.v_WB_W == pytest.approx([0, 0, expected])
    planar = cd.planar_impact(
        cd.PlanarBody(mass=0.06, inertia=1e-4),
        cd.PlanarVelocity(v=(0.0, v), w=0.0),
        cd.PlanarContact(
            r=(0.0, -0.033), normal=(0.0, 1.0), friction=0.3, restitution=e, surface_velocity=(0.0, paddle)
        ),
    )
    assert planar.velocity.v == pytest.approx((0.0, expected))
    assert planar.velocity_before_C == pytest.approx((0.0, v - paddle))
    # A paddle that draws back faster than the ball follows is not struck, and one at rest is.
    with pytest.raises(SeparatingContactError):
        cd.spatial_impact(BALL, falling, replace(contact, surface_velocity_W=[0, 0, -3]))
    # A ball at rest is struck by a rising paddle.
    resting = cd.BodyState(p_WB_W=[0, 0, 0.033], q_WB=[0, 0, 0, 1])
    assert cd.spatial_impact(BALL, resting, contact).state.v_WB_W[2] == pytest.approx(1.8 * paddle)


@pytest.mark.parametrize("mu", [0.05, 0.9], ids=["slides", "sticks"])
def test_a_racket_brushes_a_ball(mu: float) -> None:
    # In closed form: an impulse of (2/7) m u holds the ball, if friction allows as much.
    e, r = 0.75, 0.033
    racket, v, w = np.array([1.0, -4.0, 6.0]), np.array([2.0, 0.5, -9.0]), np.array([30.0, 200.0, -40.0])
    state = cd.BodyState(p_WB_W=[0, 0, r], q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=w)
    contact = cd.Contact(p_WC_W=[0, 0, 0], normal_W=UP, friction=mu, restitution=e, surface_velocity_W=racket)
    found = cd.spatial_impact(BALL, state, contact)
    u = v + np.cross(w, [0, 0, -r]) - racket
    normal = (1.0 + e) * BALL.mass * -u[2]
    slip = np.array([u[0], u[1], 0.0])
    hold = 2.0 / 7.0 * BALL.mass * np.linalg.norm(slip)
    impulse = np.array([0, 0, normal]) - min(hold, mu * normal) * slip / np.linalg.norm(slip)
    assert found.outcome.sticks == (mu > 0.5)
    assert found.impulse_W == pytest.approx(impulse, rel=1e-12)
    assert found.state.v_WB_W == pytest.approx(v + impulse / BALL.mass, rel=1e-12)
    spun = w + np.cross([0, 0, -r], impulse) / (0.4 * BALL.mass * r**2)
    assert found.state.w_WB_W == pytest.approx(spun, rel=1e-11)


def test_a_mechanism_strikes_a_moving_surface() -> None:
    body, state, contact = drawn(5)
    moving = replace(contact, surface_velocity_W=BOOST)
    expected = cd.spatial_impact(body, boosted(state), moving)
    velocity = boosted(state).velocity_of_point(contact.p_WC_W)
    found = cd.response_impact(expected.inverse_inertia_W, velocity, moving)
    assert found.impulse_W == pytest.approx(expected.impulse_W, rel=1e-9)
    assert found.velocity_after_W == pytest.approx(expected.velocity_after_W, rel=1e-9, abs=1e-9)


def test_a_batch_has_the_numbers_of_single_calls() -> None:
    cases = [drawn(seed) for seed in range(12)]
    surfaces = np.array([BOOST * (i % 3) for i in range(12)])
    bodies = StrikingBodies(
        masses=[body.mass for body, _, _ in cases],
        inertias_B=[body.I_B for body, _, _ in cases],
        q_WB=[state.q_WB for _, state, _ in cases],
        v_WB_W=[state.v_WB_W + u for (_, state, _), u in zip(cases, surfaces, strict=True)],
        w_WB_W=[state.w_WB_W for _, state, _ in cases],
        r_W=[contact.p_WC_W - state.p_WB_W for _, state, contact in cases],
    )
    table = {
        "normals_W": [contact.normal_W for _, _, contact in cases],
        "frictions": [contact.friction for _, _, contact in cases],
        "restitutions": [contact.impact_restitution for _, _, contact in cases],
    }
    found = spatial_impacts(bodies, surface_velocities_W=surfaces, **table)  # type: ignore[arg-type]
    for i, ((body, state, contact), u) in enumerate(zip(cases, surfaces, strict=True)):
        one = cd.spatial_impact(body, boosted(state, u), replace(contact, surface_velocity_W=u))
        assert found.v_WB_W[i].tolist() == one.state.v_WB_W.tolist()
        assert found.w_WB_W[i].tolist() == one.state.w_WB_W.tolist()
        assert found.impulses_W[i].tolist() == one.impulse_W.tolist()
        assert found.velocities_after_W[i].tolist() == one.velocity_after_W.tolist()
    away = spatial_impacts(
        bodies,
        surface_velocities_W=-100.0 * np.array(table["normals_W"]),
        skip_separating=True,
        **table,  # type: ignore[arg-type]
    )
    assert away.v_WB_W.tolist() == bodies.v_WB_W.tolist()
    with pytest.raises(InvalidFieldError, match="surface_velocities_W must be None where bodies"):
        spatial_impacts(bodies, others=bodies, surface_velocities_W=surfaces, **table)  # type: ignore[arg-type]
    with pytest.raises(InvalidFieldError, match=r"surface_velocities_W must be of shape|batch"):
        spatial_impacts(bodies, surface_velocities_W=np.zeros((5, 3)), **table)  # type: ignore[arg-type]


def test_two_bodies_have_no_moving_surface_between_them() -> None:
    other = replace(LEANING, p_WB_W=np.array([0, 0, -0.03]), v_WB_W=np.zeros(3))
    belt = np.zeros((4, 3))
    belt[2] = BOOST
    contacts = replace(FEET, surface_velocities_W=belt)
    pairs = [(0, None), (0, None), (0, 1), (0, 1)]
    with pytest.raises(InvalidFieldError, match=r"contacts.surface_velocities_W\[2\] must be zero between"):
        bodies_impact([BRICK, BRICK], [LEANING, other], contacts, pairs)
    belt[[0, 2]] = belt[[2, 0]]
    after = bodies_impact(
        [BRICK, BRICK], [LEANING, other], replace(FEET, surface_velocities_W=belt), pairs
    ).velocities_after_W
    assert (after[:, 2] >= -1e-8).all()


def planar_several(
    body: cd.PlanarBody, velocity: cd.PlanarVelocity, feet: list[cd.PlanarContact]
) -> ResolvedImpact:
    return cd.several_impact(*planar_in_space(body, velocity, feet, axes_W=np.eye(2, 3)))


def test_several_contacts_in_the_plane_are_relative_to_their_surfaces() -> None:
    body = cd.PlanarBody(mass=2.0, inertia=0.1)
    feet = [
        cd.PlanarContact(r=(x, -0.3), normal=(0.0, 1.0), friction=0.5, restitution=0.3) for x in (-0.2, 0.3)
    ]
    still = planar_several(body, cd.PlanarVelocity(v=(0.5, -1.0), w=0.2), feet)
    belt = [replace(foot, surface_velocity=(1.5, 0.4)) for foot in feet]
    moving = planar_several(body, cd.PlanarVelocity(v=(2.0, -0.6), w=0.2), belt)
    np.testing.assert_allclose(moving.impulses_W, still.impulses_W, atol=1e-12)
    np.testing.assert_allclose(
        moving.state.v_WB_W, still.state.v_WB_W + np.array([1.5, 0.4, 0.0]), atol=1e-12
    )
    np.testing.assert_allclose(moving.velocities_after_W, still.velocities_after_W, atol=1e-12)
    one = cd.planar_impact(body, cd.PlanarVelocity(v=(2.0, -0.6), w=0.2), belt[0])
    alone = planar_several(body, cd.PlanarVelocity(v=(2.0, -0.6), w=0.2), belt[:1])
    np.testing.assert_allclose(alone.state.v_WB_W[:2], one.velocity.v, atol=1e-12)
