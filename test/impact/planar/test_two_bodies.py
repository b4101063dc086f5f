# SPDX-License-Identifier: Apache-2.0
"""Two moving bodies: momentum, closed forms, and the fixed world as the limit of a heavy second body."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_dynamics.contact.contact import Contact
from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import (
    RestitutionLaw,
    planar_impact,
    planar_pair_impact,
    spatial_impact,
    spatial_pair_impact,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body.body import (
    BodyState,
    MassProperties,
    angular_momentum,
    kinetic_energy,
    momentum,
)

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def planar_draw(
    seed: int,
) -> tuple[PlanarBody, PlanarVelocity, PlanarBody, PlanarVelocity, PlanarContact, tuple[float, float]]:
    rng = np.random.default_rng(seed)
    bodies = [
        PlanarBody(mass=10.0 ** rng.uniform(-1, 1), inertia=10.0 ** rng.uniform(-1, 1)) for _ in range(2)
    ]
    velocities = [PlanarVelocity(v=tuple(rng.normal(size=2)), w=float(rng.normal())) for _ in range(2)]
    r, s, angle = rng.normal(size=2), rng.normal(size=2), rng.uniform(-math.pi, math.pi)
    normal = np.array([math.cos(angle), math.sin(angle)])
    points = [
        np.array(velocity.v) + velocity.w * np.array([-arm[1], arm[0]])
        for velocity, arm in zip(velocities, (r, s), strict=True)
    ]
    if normal @ (points[0] - points[1]) > 0.0:
        normal = -normal
    contact = PlanarContact(
        r=tuple(r),
        normal=tuple(normal),
        friction=float(10.0 ** rng.uniform(-2, 1)),
        restitution=float(rng.choice([0.0, 1.0, rng.uniform()])),
    )
    return bodies[0], velocities[0], bodies[1], velocities[1], contact, tuple(s)


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
def test_planar_momentum_and_energy(law: RestitutionLaw, seed: int) -> None:
    first, before, second, other_before, contact, other_r = planar_draw(seed)
    answer = planar_pair_impact(
        first, before, second, other_before, contact, other_r=other_r, restitution_law=law
    )
    after, other_after = answer.velocity, answer.other_velocity
    assert other_after is not None
    # Angular momentum about the contact, to which each body's centre is at -r.
    totals = []
    for one, two in ((before, other_before), (after, other_after)):
        linear = first.mass * np.array(one.v) + second.mass * np.array(two.v)
        angular = first.inertia * one.w + second.inertia * two.w
        angular -= first.mass * (contact.r[0] * one.v[1] - contact.r[1] * one.v[0])
        angular -= second.mass * (other_r[0] * two.v[1] - other_r[1] * two.v[0])
        totals.append(np.append(linear, angular))
    size = 1e-14 * (np.linalg.norm(totals[0]) + 10.0 * math.hypot(*answer.impulse) + 20.0)
    assert totals[1] == pytest.approx(totals[0], abs=size)
    change = sum(
        0.5 * sign * (body.mass * np.dot(velocity.v, velocity.v) + body.inertia * velocity.w**2)
        for sign, body, velocity in (
            (1, first, after),
            (1, second, other_after),
            (-1, first, before),
            (-1, second, other_before),
        )
    )
    assert answer.energy_change == pytest.approx(change, abs=1e-12 * (1.0 + abs(change)) * 100.0)
    if law is not RestitutionLaw.NEWTON:
        assert not answer.creates_energy


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_spatial_momentum_and_energy(law: RestitutionLaw, seed: int) -> None:
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
    first, before, _, _, contact, other_r = planar_draw(seed)
    v_x, v_y = before.v
    v_n = (v_x - before.w * contact.r[1]) * contact.normal[0] + (
        v_y + before.w * contact.r[0]
    ) * contact.normal[1]
    if v_n > 0.0:
        contact = replace(contact, normal=(-contact.normal[0], -contact.normal[1]))
    heavy = PlanarBody(mass=1e30, inertia=1e30)
    rest = PlanarVelocity(v=(0.0, 0.0), w=0.0)
    alone = planar_impact(first, before, contact, restitution_law=law)
    answer = planar_pair_impact(first, before, heavy, rest, contact, other_r=other_r, restitution_law=law)
    assert answer.outcome is alone.outcome
    assert answer.impulse == pytest.approx(alone.impulse, rel=1e-12, abs=1e-12)
    assert answer.velocity.v == pytest.approx(alone.velocity.v, rel=1e-12, abs=1e-11)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_balls_in_line(restitution: float) -> None:
    """The textbook's two balls: v1' = (m1 - e m2) v / (m1 + m2), v2' = (1 + e) m1 v / (m1 + m2)."""
    light, heavy = PlanarBody(mass=1.0, inertia=0.4), PlanarBody(mass=3.0, inertia=1.2)
    answer = planar_pair_impact(
        light,
        PlanarVelocity(v=(2.0, 0.0), w=0.0),
        heavy,
        PlanarVelocity(v=(0.0, 0.0), w=0.0),
        PlanarContact(r=(1.0, 0.0), normal=(-1.0, 0.0), friction=0.3, restitution=restitution),
        other_r=(-1.0, 0.0),
    )
    assert answer.velocity.v[0] == pytest.approx((1.0 - 3.0 * restitution) * 2.0 / 4.0, abs=2e-15)
    assert answer.other_velocity is not None
    assert answer.other_velocity.v[0] == pytest.approx((1.0 + restitution) * 2.0 / 4.0, rel=1e-15)


def test_bodies_that_separate_are_refused() -> None:
    first, before, second, other_before, contact, other_r = planar_draw(3)
    away = replace(contact, normal=(-contact.normal[0], -contact.normal[1]))
    with pytest.raises(SeparatingContactError, match="v_n = "):
        planar_pair_impact(first, before, second, other_before, away, other_r=other_r)


def test_the_fixed_world_has_no_state_afterwards() -> None:
    body, state = random_body(np.random.default_rng(0))
    point = state.p_WB_W + 0.1
    normal = -state.velocity_of_point(point)
    answer = spatial_impact(
        body,
        state,
        Contact(p_WC_W=point, normal_W=normal / np.linalg.norm(normal), friction=0.1, restitution=0.1),
    )
    assert answer.other_state is None
