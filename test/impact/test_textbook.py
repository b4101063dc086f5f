# SPDX-License-Identifier: Apache-2.0
"""Impacts that textbooks solve by hand: balls, rods, cradles, cubes and rocking blocks."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.errors import InvalidFieldError, SeparatingContactError
from contact_dynamics.impact import (
    ImpactOutcome,
    ResolvedImpact,
    RestitutionLaw,
    SequenceEnd,
    SeveralContactsLaw,
    bodies_impact,
    impact_sequence,
    outcomes_over_orders,
    planar_impact,
    several_impact,
    spatial_impact,
    spatial_pair_impact,
)
from contact_dynamics.plane import planar_in_space
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body.body import BodyState, MassProperties, kinetic_energy
from contact_dynamics.world import Body, World

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
UP = (0.0, 1.0)
X_AND_Y = np.eye(2, 3)
SEQUENTIAL, SIMULTANEOUS = SeveralContactsLaw


def moving(p: list[float], v: list[float], w: list[float] | None = None) -> BodyState:
    return BodyState(p_WB_W=p, q_WB=IDENTITY, v_WB_W=v, w_WB_W=w or [0.0, 0.0, 0.0])


def contacts_at(
    points: list[list[float]], *, normal: tuple[float, float, float], friction: float, restitution: float
) -> ContactSet:
    return ContactSet(p_WC_W=np.array(points), normals_W=normal, frictions=friction, restitutions=restitution)


# A ball with spin (Garwin 1969, with Coulomb's friction in place of an elastic tangential bounce)


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("beta", [0.4, 2.0 / 3.0])
@pytest.mark.parametrize("spin", [-30.0, 0.0, 12.0])
def test_a_ball_grips_or_slides(spin: float, beta: float, law: RestitutionLaw) -> None:
    """I = beta m r^2. Gripping, it leaves rolling: v' = (v + beta r w) / (1 + beta). Sliding, mu J is taken.

    It grips where mu (1 + e) v_n is at least the slip times beta / (1 + beta).
    """
    mass, radius, e, v, fall = 0.2, 0.05, 0.6, 1.0, 2.0
    inertia = beta * mass * radius**2
    slip = v - radius * spin  # of the point below, with w about +y
    needed = abs(slip) * beta / (1.0 + beta) / ((1.0 + e) * fall)
    body = MassProperties(mass=mass, I_B=inertia * np.eye(3))
    state = moving([0.0, 0.0, radius], [v, 0.0, -fall], [0.0, spin, 0.0])
    for friction in (0.5 * needed, 1.5 * needed):
        impact = spatial_impact(
            body,
            state,
            Contact(p_WC_W=[0.0, 0.0, 0.0], normal_W=[0.0, 0.0, 1.0], friction=friction, restitution=e),
            restitution_law=law,
        )
        if friction > needed:
            rolling = (v + beta * radius * spin) / (1.0 + beta)
            expected, turning = rolling, rolling / radius
        else:
            taken = math.copysign(friction * (1.0 + e) * fall, slip)
            expected, turning = v - taken, spin + taken / (beta * radius)
        assert impact.state.v_WB_W == pytest.approx([expected, 0.0, e * fall], abs=1e-13)
        assert impact.state.w_WB_W == pytest.approx([0.0, turning, 0.0], abs=1e-11)
        grips = {ImpactOutcome.STICKS_IN_COMPRESSION, ImpactOutcome.STICKS_IN_RESTITUTION}
        assert (impact.outcome in grips) == (friction > needed)


# A thin rod of length 2 l, I = m l^2 / 3, that falls without spin and strikes with one end at angle theta


def dropped_rod(theta: float, *, friction: float, e: float, law: RestitutionLaw) -> PlanarVelocity:
    contact = PlanarContact(
        r=(-math.cos(theta), -math.sin(theta)), normal=UP, friction=friction, restitution=e
    )
    rod, falling = PlanarBody(mass=3.0, inertia=1.0), PlanarVelocity(v=(0.0, -1.0), w=0.0)
    return planar_impact(rod, falling, contact, restitution_law=law).velocity


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_central_rod_drop(e: float, law: RestitutionLaw) -> None:
    upright = dropped_rod(0.5 * math.pi, friction=0.4, e=e, law=law)
    assert upright.v == pytest.approx((0.0, e), abs=1e-15)
    assert upright.w == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("theta", [0.0, 0.3, 1.0])
def test_eccentric_rod_drop_on_smooth_ground(theta: float, law: RestitutionLaw) -> None:
    """Momentum alone: w = 3 (1 + e) v cos(theta) / (l (1 + 3 cos^2 theta)), clockwise for the left end."""
    e = 0.7
    after = dropped_rod(theta, friction=0.0, e=e, law=law)
    expected = 3.0 * (1.0 + e) * math.cos(theta) / (1.0 + 3.0 * math.cos(theta) ** 2)
    assert after.w == pytest.approx(-expected, rel=1e-14)
    assert after.v[0] == 0.0
    assert after.v[1] - after.w * math.cos(theta) == pytest.approx(e, rel=1e-13)  # the end's


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("theta", [0.3, 1.0])
def test_eccentric_rod_drop_on_rough_ground(theta: float, law: RestitutionLaw) -> None:
    """Without restitution the end stays, and the rod turns about it: w = 3 v cos(theta) / (4 l)."""
    after = dropped_rod(theta, friction=5.0, e=0.0, law=law)
    assert after.w == pytest.approx(-0.75 * math.cos(theta), rel=1e-14)
    assert after.v == pytest.approx(
        (0.75 * math.cos(theta) * math.sin(theta), -0.75 * math.cos(theta) ** 2), rel=1e-13
    )


# A ball against a free block


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_a_ball_strikes_a_free_block(offset: float, law: RestitutionLaw) -> None:
    """Without friction J = (1 + e) v / (1/m + 1/M + d^2/I), by which the block moves and turns."""
    ball, block, e, v = (
        MassProperties(mass=0.5, I_B=1e-3 * np.eye(3)),
        MassProperties(mass=4.0, I_B=0.8 * np.eye(3)),
        0.8,
        6.0,
    )
    impact = spatial_pair_impact(
        ball,
        moving([-0.05, 0.0, 0.0], [v, 0.0, 0.0]),
        block,
        moving([0.4, -offset, 0.0], [0.0, 0.0, 0.0]),
        Contact(p_WC_W=[0.0, 0.0, 0.0], normal_W=[-1.0, 0.0, 0.0], friction=0.0, restitution=e),
        restitution_law=law,
    )
    impulse = (1.0 + e) * v / (1.0 / 0.5 + 1.0 / 4.0 + offset**2 / 0.8)
    assert impact.state.v_WB_W == pytest.approx([v - impulse / 0.5, 0.0, 0.0], rel=1e-14)
    assert impact.other_state is not None
    assert impact.other_state.v_WB_W == pytest.approx([impulse / 4.0, 0.0, 0.0], rel=1e-14)
    assert impact.other_state.w_WB_W == pytest.approx([0.0, 0.0, -offset * impulse / 0.8], abs=1e-14)


# Newton's cradle: balls that touch in a row along x


def cradle(
    velocities: list[float],
    *,
    restitution: float,
    masses: list[float] | None = None,
    law: SeveralContactsLaw = SEQUENTIAL,
    restitution_law: RestitutionLaw = RestitutionLaw.NEWTON,
) -> tuple[list[float], ResolvedImpact]:
    n, radius = len(velocities), 0.02
    masses = masses or [1.0] * n
    bodies = [MassProperties(mass=m, I_B=0.4 * m * radius**2 * np.eye(3)) for m in masses]
    states = [moving([2.0 * radius * i, 0.0, 0.0], [v, 0.0, 0.0]) for i, v in enumerate(velocities)]
    contacts = contacts_at(
        [[radius * (2 * i + 1), 0.0, 0.0] for i in range(n - 1)],
        normal=(-1.0, 0.0, 0.0),  # into the left ball of each pair
        friction=0.3,
        restitution=restitution,
    )
    answer = bodies_impact(
        bodies,
        states,
        contacts,
        [(i, i + 1) for i in range(n - 1)],
        several_contacts_law=law,
        restitution_law=restitution_law,
    )
    assert answer.converged
    total = sum(m * v for m, v in zip(masses, velocities, strict=True))
    after = [float(state.v_WB_W[0]) for state in answer.states]
    assert sum(m * v for m, v in zip(masses, after, strict=True)) == pytest.approx(total, abs=1e-12)
    assert (answer.velocities_after_W[:, 0] <= 1e-9).all()  # no left ball approaches its right one
    return after, answer


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("n", [2, 3, 5, 7])
def test_of_equal_balls_the_last_one_leaves(n: int, law: RestitutionLaw) -> None:
    after, answer = cradle([1.0, *[0.0] * (n - 1)], restitution=1.0, restitution_law=law)
    assert after == pytest.approx([*[0.0] * (n - 1), 1.0], abs=1e-13)
    assert answer.order == tuple(range(n - 1))


def test_two_balls_in_two_balls_out_and_both_ends_at_once() -> None:
    after, _ = cradle([1.0, 1.0, 0.0, 0.0, 0.0], restitution=1.0)
    assert after == pytest.approx([0.0, 0.0, 0.0, 1.0, 1.0], abs=1e-13)
    after, _ = cradle([1.0, 0.0, -1.0], restitution=1.0)
    assert after == pytest.approx([-1.0, 0.0, 1.0], abs=1e-13)


def test_a_chain_of_unequal_balls_passes_on_what_each_pair_does() -> None:
    """Elastic: the last gets the product of 2 m_i / (m_i + m_(i+1)); descending masses never strike twice."""
    masses = [4.0, 2.0, 1.0, 0.5]
    after, answer = cradle([1.0, 0.0, 0.0, 0.0], restitution=1.0, masses=masses)
    expected = math.prod(2.0 * a / (a + b) for a, b in pairwise(masses))
    assert after[-1] == pytest.approx(expected, rel=1e-13)
    assert answer.order == (0, 1, 2)


def test_with_losses_the_last_ball_still_gets_its_share() -> None:
    """Each pair passes on (1 + e)/2; the balls behind then meet once more, but never reach the last."""
    e = 0.9
    after, answer = cradle([1.0, 0.0, 0.0], restitution=e)
    assert after[-1] == pytest.approx((0.5 * (1.0 + e)) ** 2, rel=1e-13)
    assert answer.order[:3] == (0, 1, 0)


@pytest.mark.parametrize("restitution_law", [RestitutionLaw.NEWTON, RestitutionLaw.POISSON])
@pytest.mark.parametrize("n", [3, 5])
def test_at_once_all_balls_move(n: int, restitution_law: RestitutionLaw) -> None:
    """Newton's: the balls at rest move as one, (1 + e)/n. Poisson's: that of the impulse of each contact.

    Neither is what steel balls do, as Newton's cradle shows; the laws are named for that.
    """
    e = 1.0
    after, _ = cradle(
        [1.0, *[0.0] * (n - 1)], restitution=e, law=SIMULTANEOUS, restitution_law=restitution_law
    )
    if restitution_law is RestitutionLaw.NEWTON:
        assert after == pytest.approx([(1.0 - (n - 1) * e) / n, *[(1.0 + e) / n] * (n - 1)], abs=1e-9)
    else:
        # Compression brings all to 1/n with impulses (n - 1 - i)/n at contact i, and each gives that back.
        assert after == pytest.approx([2.0 / n - 1.0, *[2.0 / n] * (n - 1)], abs=1e-9)


def test_bodies_refuse_what_they_cannot_mean() -> None:
    body, state = MassProperties(mass=1.0, I_B=np.eye(3)), moving([0.0, 0.0, 0.0], [0.0, 0.0, -1.0])
    contacts = contacts_at([[0.0, 0.0, -1.0]], normal=(0.0, 0.0, 1.0), friction=0.0, restitution=0.0)
    for pairs, text in (
        ([], r"pairs must be .*, got \[\]"),
        ([(0, 0)], r"pairs\[0\] must be .*, got \(0, 0\)"),
        ([(0, 2)], r"pairs\[0\]"),
        ([(-1, None)], r"pairs\[0\]"),
    ):
        with pytest.raises(InvalidFieldError, match=text):
            bodies_impact([body, body], [state, state], contacts, pairs)
    with pytest.raises(InvalidFieldError, match=r"states must be .*, got 1 states"):
        bodies_impact([body, body], [state], contacts, [(0, 1)])
    with pytest.raises(SeparatingContactError):
        bodies_impact([body, body], [moving([0, 0, 0], [0, 0, 1.0]), state], contacts, [(0, 1)])


# A cube that lands on a face or on an edge


CUBE = MassProperties(mass=0.5, I_B=0.5 * 0.1**2 / 6.0 * np.eye(3))
FACE = [[x, y, 0.0] for x in (-0.05, 0.05) for y in (-0.05, 0.05)]


@pytest.mark.parametrize("e", [0.0, 0.4, 0.9])
def test_a_cube_on_its_face(e: float) -> None:
    """At once the cube bounces level, by symmetry. In turn one corner is the first, and the orders spread."""
    contacts = contacts_at(FACE, normal=(0.0, 0.0, 1.0), friction=0.0, restitution=e)
    state = moving([0.0, 0.0, 0.05], [0.0, 0.0, -1.0])
    level = several_impact(CUBE, state, contacts, several_contacts_law=SIMULTANEOUS)
    assert level.state.v_WB_W == pytest.approx([0.0, 0.0, e], abs=1e-11)
    assert level.state.w_WB_W == pytest.approx([0.0, 0.0, 0.0], abs=1e-10)
    outcomes = outcomes_over_orders(CUBE, state, contacts)
    assert outcomes.complete
    # Even at e = 0: a strike throws the corner across that was struck before.
    assert outcomes.spread[3:5].min() > 0.5  # rad/s, about both level axes
    # The orders are mirror images of each other, so that they spread evenly to both sides.
    turns = outcomes.velocities_W[:, 3]
    assert turns.max() == pytest.approx(-turns.min(), rel=1e-9)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_cube_on_an_edge(e: float) -> None:
    """Tilted by 30 degrees, smooth: at once J = (1 + e) v / (1/m + d^2/I), d the edge's level lever."""
    tilt = math.radians(30.0)
    lever = 0.05 * math.sqrt(2.0) * math.sin(math.radians(45.0) - tilt)
    height = 0.05 * math.sqrt(2.0) * math.cos(math.radians(45.0) - tilt)
    contacts = contacts_at(
        [[lever, y, 0.0] for y in (-0.05, 0.05)], normal=(0.0, 0.0, 1.0), friction=0.0, restitution=e
    )
    state = moving([0.0, 0.0, height], [0.0, 0.0, -1.0])  # a cube's inertia is the same in all axes
    inertia = float(CUBE.I_B[0, 0])
    total = (1.0 + e) / (1.0 / 0.5 + lever**2 / inertia)
    at_once = several_impact(CUBE, state, contacts, several_contacts_law=SIMULTANEOUS)
    assert at_once.impulses_W.sum(axis=0) == pytest.approx([0.0, 0.0, total], rel=1e-9)
    assert at_once.state.w_WB_W == pytest.approx([0.0, -lever * total / inertia, 0.0], abs=1e-9)
    outcomes = outcomes_over_orders(CUBE, state, contacts)
    assert len(outcomes.orders) == 3
    assert outcomes.orders[0] == ()  # both ends tie, and strike as one
    as_one, first, second = outcomes.velocities_W
    assert as_one[2] == pytest.approx(at_once.state.v_WB_W[2], abs=1e-9)
    assert as_one[3:] == pytest.approx(at_once.state.w_WB_W, abs=1e-9)
    assert first == pytest.approx(second * [1.0, -1.0, 1.0, -1.0, 1.0, -1.0], abs=1e-9)  # mirror images
    if e == 0.0:
        assert first[2] == pytest.approx(at_once.state.v_WB_W[2], abs=1e-8)
    else:
        assert outcomes.spread[3] > 1.0  # rad/s about the level axis across the edge


# A rocking block (Housner 1963) of half width b and half height h; tan(alpha) = b/h


def rocking_block(alpha: float) -> tuple[PlanarBody, PlanarVelocity, list[PlanarContact]]:
    """It turns clockwise about its left corner and comes down flat on its right one."""
    half_width, half_height, mass, w = math.sin(alpha), math.cos(alpha), 2.0, -1.5
    body = PlanarBody(mass=mass, inertia=mass / 3.0)  # m (b^2 + h^2) / 3
    velocity = PlanarVelocity(v=(-w * half_height, w * half_width), w=w)  # w x (b, h)
    feet = [
        PlanarContact(r=(x, -half_height), normal=UP, friction=10.0, restitution=0.0)
        for x in (-half_width, half_width)
    ]
    return body, velocity, feet


@pytest.mark.parametrize("law", SeveralContactsLaw)
@pytest.mark.parametrize("alpha", [0.1, 0.4, 0.9])
def test_a_rocking_block_keeps_housners_share_of_its_spin(alpha: float, law: SeveralContactsLaw) -> None:
    """Angular momentum about the right corner stays: w'/w = 1 - 3/2 sin^2(alpha). The left corner lifts."""
    body, velocity, feet = rocking_block(alpha)
    answer = several_impact(*planar_in_space(body, velocity, feet, axes_W=X_AND_Y), several_contacts_law=law)
    kept = 1.0 - 1.5 * math.sin(alpha) ** 2
    assert answer.state.w_WB_W == pytest.approx([0.0, 0.0, -1.5 * kept], abs=1e-8)
    assert answer.velocities_after_W[0, 1] > 0.0
    assert answer.velocities_after_W[1] == pytest.approx([0.0, 0.0, 0.0], abs=1e-8)
    assert answer.impulses_W[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-8)


@pytest.mark.parametrize("law", SeveralContactsLaw)
def test_a_flat_block_does_not_rock_over(law: SeveralContactsLaw) -> None:
    """Where sin^2(alpha) > 2/3 Housner's share is negative; the left corner stops it."""
    body, velocity, feet = rocking_block(1.2)
    answer = several_impact(*planar_in_space(body, velocity, feet, axes_W=X_AND_Y), several_contacts_law=law)
    assert answer.converged
    assert answer.state.w_WB_W == pytest.approx([0.0, 0.0, 0.0], abs=1e-7)
    assert answer.state.v_WB_W == pytest.approx([0.0, 0.0, 0.0], abs=1e-7)


def test_a_rocking_block_in_time_stays_on_its_right_foot() -> None:
    alpha = 0.4
    half_width, half_height = math.sin(alpha), math.cos(alpha)
    block = MassProperties(mass=2.0, I_B=2.0 / 3.0 * np.eye(3))
    contacts = contacts_at(
        [[-half_width, 0.0, 0.0], [half_width, 0.0, 0.0]],
        normal=(0.0, 0.0, 1.0),
        friction=10.0,
        restitution=0.0,
    )
    state = moving([0.0, 0.0, half_height], [1.5 * half_height, 0.0, -1.5 * half_width], [0.0, 1.5, 0.0])
    sequence = impact_sequence(Body(name="block", mass_properties=block), state, World(), contacts=contacts)
    assert sequence.order == (1,)
    assert (sequence.end, sequence.staying) == (SequenceEnd.STAYS, (1,))
    kept = 1.0 - 1.5 * math.sin(alpha) ** 2
    assert sequence.state.w_WB_W == pytest.approx([0.0, 1.5 * kept, 0.0], abs=1e-12)


# The plane's laws for several contacts, beside those for one and those of space


@pytest.mark.parametrize("law", RestitutionLaw)
def test_one_contact_in_the_plane_is_the_planar_law(law: RestitutionLaw) -> None:
    body, velocity = PlanarBody(mass=1.0, inertia=1.0), PlanarVelocity(v=(-1.0, -1.0), w=0.4)
    contact = PlanarContact(r=(-1.0, -2.0), normal=UP, friction=0.25, restitution=0.5)
    one = planar_impact(body, velocity, contact, restitution_law=law)
    axes = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])  # the plane seen from +x
    several = several_impact(*planar_in_space(body, velocity, [contact], axes_W=axes), restitution_law=law)
    assert several.state.v_WB_W == pytest.approx([0.0, *one.velocity.v], abs=1e-13)
    assert several.state.w_WB_W == pytest.approx([one.velocity.w, 0.0, 0.0], abs=1e-13)
    assert several.outcome is one.outcome


def test_momentum_and_energy_of_a_heap() -> None:
    """Three boxes in a stack on the floor, struck from above: admissible, and no energy from nowhere."""
    box = MassProperties(mass=1.0, I_B=0.02 * np.eye(3))
    states = [moving([0.0, 0.0, 0.1 + 0.2 * i], [0.3 * (i == 2), 0.0, -2.0 * (i == 2)]) for i in range(3)]
    corners = [[x, y] for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    contacts = contacts_at(
        [[x, y, 0.2 * level] for level in range(3) for x, y in corners],
        normal=(0.0, 0.0, 1.0),
        friction=0.4,
        restitution=0.2,
    )
    pairs: list[tuple[int, int | None]] = [
        (level, level - 1 if level else None) for level in range(3) for _ in corners
    ]
    before = sum(kinetic_energy(box, state) for state in states)
    for law in SeveralContactsLaw:
        answer = bodies_impact([box] * 3, states, contacts, pairs, several_contacts_law=law)
        assert answer.converged
        assert answer.velocities_after_W[:, 2].min() >= -1e-8
        after = sum(kinetic_energy(box, state) for state in answer.states)
        assert after < before
        # What the floor gives is all that the heap gains.
        floor = answer.impulses_W[:4].sum(axis=0)
        gained = sum(state.v_WB_W - old.v_WB_W for state, old in zip(answer.states, states, strict=True))
        assert gained == pytest.approx(floor, abs=1e-12)
