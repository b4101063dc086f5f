# SPDX-License-Identifier: Apache-2.0
"""Several contacts at once: named landings in closed form, and what every law must obey."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_dynamics.contact import ContactSet
from contact_dynamics.errors import InvalidFieldError, SeparatingContactError
from contact_dynamics.impact import (
    RestitutionLaw,
    SeveralContactsLaw,
    bodies_impact,
    outcomes_over_orders,
    several_impact,
    spatial_impact,
)
from contact_dynamics.impact.several import simultaneous
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.rigid_body.body import angular_momentum, kinetic_energy, momentum
from oracles import impact_in_turn
from sweeps import seeds

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
CUBE = MassProperties(mass=0.5, I_B=0.5 * 0.1**2 / 6.0 * np.eye(3))
SEQUENTIAL, SIMULTANEOUS = SeveralContactsLaw
LAWS = [
    (SEQUENTIAL, RestitutionLaw.POISSON),
    (SEQUENTIAL, RestitutionLaw.NEWTON),
    (SEQUENTIAL, RestitutionLaw.ENERGETIC),
    (SIMULTANEOUS, RestitutionLaw.POISSON),
    (SIMULTANEOUS, RestitutionLaw.NEWTON),
]


def floor_contacts(points: list[list[float]], *, friction: float, restitution: float) -> ContactSet:
    return ContactSet(p_WC_W=points, normals_W=[0.0, 0.0, 1.0], frictions=friction, restitutions=restitution)


def falling(height: float, v: list[float], w: list[float] | None = None) -> BodyState:
    return BodyState(p_WB_W=[0.0, 0.0, height], q_WB=IDENTITY, v_WB_W=v, w_WB_W=w or [0.0, 0.0, 0.0])


FACE = [[x, y, 0.0] for x in (-0.05, 0.05) for y in (-0.05, 0.05)]


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_sliding_cube_on_its_face_at_once(restitution: float) -> None:
    """Friction of mu times the whole impulse slows the slide; its lever arm loads the leading feet more."""
    contacts = floor_contacts(FACE, friction=0.1, restitution=restitution)
    answer = several_impact(
        CUBE, falling(0.05, [3.0, 0.0, -1.0]), contacts, several_contacts_law=SIMULTANEOUS
    )
    assert answer.converged
    total = 0.5 * (1.0 + restitution)
    if restitution == 0.0:
        assert answer.state.v_WB_W == pytest.approx([3.0 - 0.1 * total / 0.5, 0.0, 0.0], abs=1e-10)
        assert answer.state.w_WB_W == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    leading = answer.impulses_W[2:, 2].sum()
    assert leading > answer.impulses_W[:2, 2].sum()
    # Moments about the centre balance: friction's arm is the half height, the feet's the half side.
    if restitution == 0.0:
        assert (2.0 * leading - total) * 0.05 == pytest.approx(0.1 * total * 0.05, rel=1e-8)


@pytest.mark.parametrize("law", RestitutionLaw)
def test_level_rod_on_two_supports(law: RestitutionLaw) -> None:
    """The strikes are elastic and frictionless, at one end, then at the other. Both orders are mirror images.

    By hand for half length l and I = m l^2/3: the first strike at the right takes J = 2 v m / 4 = m v / 2, so
    that the centre falls at v/2 and the left end at 2 v; the second strike takes J = 2 (2 v) m / 4 = m v. The
    centre then rises at v/2, and the rod turns by +3 v / (2 l), so that the right end falls at v. The third
    takes m v / 2 again, and the rod rises level at v. The ends tie, so by default both strike as one, which
    leads there at once.
    """
    rod = MassProperties(mass=2.0, I_B=np.diag([1e-4, 2.0 / 3.0, 2.0 / 3.0]))
    contacts = floor_contacts([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], friction=0.0, restitution=1.0)
    state = falling(0.0, [0.0, 0.0, -1.0])
    answer = several_impact(rod, state, contacts, restitution_law=law)
    assert answer.order_is_open
    assert answer.impulses_W == pytest.approx(np.array([[0.0, 0.0, 2.0]] * 2), abs=1e-12)
    assert answer.state.v_WB_W == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert answer.state.w_WB_W == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    outcomes = outcomes_over_orders(rod, state, contacts, restitution_law=law)
    assert outcomes.complete
    assert outcomes.orders == ((), (0, 1, 0), (1, 0, 1))
    assert outcomes.velocities_W == pytest.approx(np.array([[0, 0, 1, 0, 0, 0]] * 3), abs=1e-12)


def random_set(seed: int) -> tuple[MassProperties, BodyState, ContactSet]:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    moments = rng.uniform(0.1, 1.0, size=3)
    body = MassProperties(mass=float(rng.uniform(0.5, 2.0)), I_B=np.diag(moments.sum() - moments))
    points = rng.uniform(-1.0, 1.0, size=(n, 3))
    points[:, 2] = -rng.uniform(0.3, 1.0)
    normals = rng.normal(size=(n, 3)) * 0.2 + [0.0, 0.0, 1.0]
    contacts = ContactSet(
        p_WC_W=points,
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=rng.uniform(0.0, 0.6, size=n),
        restitutions=rng.choice([0.0, 0.3, 0.7], size=n),
    )
    velocity = rng.normal(size=3) * 0.5 - [0.0, 0.0, 2.0]
    state = BodyState(p_WB_W=np.zeros(3), q_WB=IDENTITY, v_WB_W=velocity, w_WB_W=rng.normal(size=3))
    return body, state, contacts


@pytest.mark.parametrize(("law", "restitution_law"), LAWS)
@given(seed=st.integers(0, 2**32))
def test_resolved_answers_are_admissible(
    law: SeveralContactsLaw, restitution_law: RestitutionLaw, seed: int
) -> None:
    body, state, contacts = random_set(seed)
    try:
        answer = several_impact(
            body, state, contacts, several_contacts_law=law, restitution_law=restitution_law
        )
    except SeparatingContactError:
        return
    normals = contacts.normals_W
    normal_impulses = np.einsum("ij,ij->i", answer.impulses_W, normals)
    tangential = answer.impulses_W - normal_impulses[:, None] * normals
    size = float(abs(answer.impulses_W).max()) + 1e-12
    assert (normal_impulses >= -1e-12 * size).all()
    assert (np.linalg.norm(tangential, axis=1) <= contacts.frictions * normal_impulses + 1e-10 * size).all()
    gained = body.mass * (answer.state.v_WB_W - state.v_WB_W)
    assert gained == pytest.approx(answer.impulses_W.sum(axis=0), abs=1e-11 * size * len(contacts) + 1e-12)
    if answer.converged:
        assert (np.einsum("ij,ij->i", answer.velocities_after_W, normals) >= -1e-8).all()
    if law is SEQUENTIAL and restitution_law is not RestitutionLaw.NEWTON:
        assert kinetic_energy(body, answer.state) <= kinetic_energy(body, state) * (1.0 + 1e-10)


@pytest.mark.parametrize("restitution_law", RestitutionLaw)
def test_one_contact_is_the_single_law(restitution_law: RestitutionLaw) -> None:
    body, state, contacts = random_set(5)
    alone = ContactSet(
        p_WC_W=contacts.p_WC_W[:1],
        normals_W=contacts.normals_W[:1],
        frictions=contacts.frictions[:1],
        restitutions=contacts.restitutions[:1],
    )
    answer = several_impact(body, state, alone, restitution_law=restitution_law)
    single = spatial_impact(body, state, alone[0], restitution_law=restitution_law)
    assert answer.order == (0,)
    assert answer.impulses_W[0].tolist() == single.impulse_W.tolist()
    outcomes = outcomes_over_orders(body, state, alone, restitution_law=restitution_law)
    assert outcomes.orders == ((0,),)
    assert outcomes.spread.tolist() == [0.0] * 6


CORNERS = [
    (Fraction(1, 20), Fraction(1, 25)),
    (Fraction(-1, 16), Fraction(1, 20)),
    (Fraction(1, 50), Fraction(-1, 18)),
]


def in_turn(priority: tuple[int, ...] | None) -> tuple[tuple[int, ...], list[float]]:
    """Return the exact order and velocities, v_z, w_x, w_y, of a frictionless landing on three corners."""
    order, after = impact_in_turn.strikes(
        mass=Fraction(1, 2),
        moments=(Fraction(1, 1000), Fraction(1, 800), Fraction(1, 700)),
        v_z=Fraction(-1),
        corners=CORNERS,
        e=Fraction(1, 2),
        priority=priority,
        tolerance=Fraction(1e-9),
    )
    return order, [float(x) for x in after]


@pytest.mark.parametrize("most", [1, 2, 4, 6])
def test_orders_and_their_outcomes_are_those_of_exact_strikes(most: int) -> None:
    """The law's own outcome comes first, of corners that tie, then those of priorities as they are listed."""
    body = MassProperties(mass=0.5, I_B=np.diag([1 / 1000, 1 / 800, 1 / 700]))
    contacts = floor_contacts([[float(x), float(y), 0.0] for x, y in CORNERS], friction=0.0, restitution=0.5)
    outcomes = outcomes_over_orders(body, falling(0.1, [0.0, 0.0, -1.0]), contacts, max_orders=most)
    priorities = itertools.islice(itertools.permutations(range(3)), most)
    expected = {(): in_turn(None)[1], **dict(in_turn(priority) for priority in priorities)}
    assert outcomes.orders == tuple(expected)
    assert outcomes.complete == (most == 6)
    # Each strike rounds; there are at most 60.
    assert outcomes.velocities_W[:, 2:5] == pytest.approx(
        np.array(list(expected.values())), rel=1e-12, abs=1e-12
    )


@pytest.mark.parametrize("law", [law for law in RestitutionLaw if (SIMULTANEOUS, law) not in LAWS])
def test_a_law_without_a_form_at_once_is_refused(law: RestitutionLaw) -> None:
    asked = (CUBE, falling(0.05, [0.0, 0.0, -1.0]), floor_contacts(FACE, friction=0.3, restitution=0.5))
    refused = f"^restitution_law must be POISSON or NEWTON for SIMULTANEOUS.*, got {law.name}"
    with pytest.raises(InvalidFieldError, match=refused):
        several_impact(*asked, several_contacts_law=SIMULTANEOUS, restitution_law=law)


def test_refusals() -> None:
    contacts = floor_contacts(FACE, friction=0.3, restitution=0.5)
    with pytest.raises(SeparatingContactError, match="every contact"):
        several_impact(CUBE, falling(0.05, [0.0, 0.0, 1.0]), contacts)
    none = ContactSet(
        p_WC_W=np.zeros((0, 3)), normals_W=np.zeros((0, 3)), frictions=np.zeros(0), restitutions=np.zeros(0)
    )
    with pytest.raises(InvalidFieldError, match="contacts"):
        several_impact(CUBE, falling(0.05, [0.0, 0.0, -1.0]), none)


@pytest.mark.parametrize(("law", "restitution_law"), LAWS)
@settings(max_examples=15)
@given(seed=st.integers(0, 2**32))
def test_bodies_that_touch_no_world_keep_their_momenta(
    law: SeveralContactsLaw, restitution_law: RestitutionLaw, seed: int
) -> None:
    """Linear and angular momentum about the world's origin, of two bodies with up to three contacts."""
    body, state, contacts = random_set(seed)
    other = MassProperties(mass=2.0, I_B=np.diag([0.5, 0.6, 0.7]))
    below = BodyState(p_WB_W=[0.1, -0.2, -1.5], q_WB=IDENTITY, v_WB_W=[0.1, 0.0, 0.3], w_WB_W=state.w_WB_W)
    pairs = [(0, 1)] * len(contacts)
    try:
        answer = bodies_impact(
            [body, other],
            [state, below],
            contacts,
            pairs,
            several_contacts_law=law,
            restitution_law=restitution_law,
        )
    except SeparatingContactError:
        return
    size = float(abs(answer.impulses_W).max()) * len(contacts) * 3.0 + 1.0  # arms are within 2 m
    for kept in (momentum, about_origin):
        before = kept(body, state) + kept(other, below)
        after = kept(body, answer.states[0]) + kept(other, answer.states[1])
        assert after == pytest.approx(before, abs=1e-12 * size)
    if law is SEQUENTIAL and restitution_law is not RestitutionLaw.NEWTON:
        energy_before = kinetic_energy(body, state) + kinetic_energy(other, below)
        energy_after = kinetic_energy(body, answer.states[0]) + kinetic_energy(other, answer.states[1])
        assert energy_after <= energy_before * (1.0 + 1e-10)
    if answer.converged:
        leaving = np.einsum("ij,ij->i", answer.velocities_after_W, contacts.normals_W)
        assert (leaving >= -1e-8).all()


def about_origin(body: MassProperties, state: BodyState) -> np.ndarray:
    return angular_momentum(body, state) + np.cross(state.p_WB_W, momentum(body, state))


def corners(seed: int, order: tuple[int, ...]) -> tuple[MassProperties, BodyState, ContactSet]:
    """Return a box that falls on its four corners, listed in some order, with frictions of their own."""
    chance = np.random.default_rng(seed)
    frictions = chance.uniform(0.1, 1.0, size=4) if seed % 2 else np.full(4, 0.5)
    state = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=[0.0, 0.0, 0.0, 1.0],
        v_WB_W=chance.normal(size=3) - (0.0, 0.0, 1.5),
        w_WB_W=3.0 * chance.normal(size=3),
    )
    places = np.array([[x, y, -0.1] for x in (-0.2, 0.2) for y in (-0.15, 0.15)])
    chosen = list(order)
    contacts = ContactSet(
        p_WC_W=places[chosen], normals_W=[0.0, 0.0, 1.0], frictions=frictions[chosen], restitutions=0.3
    )
    return MassProperties(mass=1.0, I_B=np.diag([0.02, 0.03, 0.04])), state, contacts


@seeds(range(12))
def test_the_default_order_is_among_the_orders(seed: int) -> None:
    body, state, contacts = corners(seed, (0, 1, 2, 3))
    answer = several_impact(body, state, contacts)
    outcomes = outcomes_over_orders(body, state, contacts)
    assert answer.order in outcomes.orders


def test_impulses_that_do_not_settle_in_the_allowed_sweeps_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simultaneous, "MAX_SWEEPS", 2)
    monkeypatch.setattr(simultaneous, "_MAX_STEPS", 1)
    contacts = floor_contacts(FACE, friction=0.3, restitution=0.5)
    for listed in (contacts, contacts.subset([3, 1, 0, 2])):
        answer = several_impact(
            CUBE, falling(0.05, [3.0, 0.5, -1.0], [1.0, 2.0, 3.0]), listed, several_contacts_law=SIMULTANEOUS
        )
        assert not answer.converged
