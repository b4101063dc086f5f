# SPDX-License-Identifier: Apache-2.0
"""Strikes in time with flight between: closed forms, brute force, and what must never happen."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact import (
    ImpactSequence,
    RestitutionLaw,
    SequenceEnd,
    impact_sequence,
    several_impact,
)
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.rigid_body.body import BodyState, MassProperties, kinetic_energy
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.world import Body, Surface, World, box_vertices
from oracles import strikes_in_time

G = 9.80665
IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
UP = np.array([0.0, 0.0, 1.0])


def floor(*, e: float, mu: float = 0.0) -> Surface:
    return Surface(name="floor", p_WS_W=np.zeros(3), normal_W=UP, friction=mu, restitution=e)


def world_of(body: Body, surface: Surface) -> World:
    return World(bodies=(body,), surfaces=(surface,))


PIN = Body(  # a single corner straight below the centre: it bounces as a point mass does
    name="pin",
    mass_properties=MassProperties(mass=0.3, I_B=np.diag([1e-3, 2e-3, 1.5e-3])),
    vertices_B=np.array([[0.0, 0.0, -0.1]]),
)


def dropped_pin(height: float) -> BodyState:
    return BodyState(p_WB_W=[0.0, 0.0, 0.1 + height], q_WB=IDENTITY, v_WB_W=[0.2, 0.0, 0.0])


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("e", [0.1, 0.5, 0.8])
def test_a_bouncing_point_comes_to_rest_in_finite_time(e: float, law: RestitutionLaw) -> None:
    """After a first strike at speed v, rebound k flies for 2 e^k v / g. All sum to 2 e v / (g (1 - e))."""
    height = 0.002
    v = math.sqrt(2.0 * G * height)
    sequence = impact_sequence(
        PIN, dropped_pin(height), world_of(PIN, floor(e=e)), restitution_law=law, window=1.0
    )
    assert sequence.end is SequenceEnd.CHATTERS
    assert sequence.staying == (0,)
    times = np.array([strike.seconds for strike in sequence.strikes])
    assert times[0] == pytest.approx(v / G, rel=1e-12)
    flights = 2.0 * v * e ** np.arange(1, len(times)) / G
    # The time of a strike at speed u is found to rounding of the height, 1e-17 m, over u.
    assert np.diff(times) == pytest.approx(flights, abs=1e-12)
    assert sequence.limit_seconds == pytest.approx(v / G + 2.0 * e * v / (G * (1.0 - e)), abs=1e-12)
    assert [strike.state_after.v_WB_W[0] for strike in sequence.strikes] == pytest.approx([0.2] * len(times))


def test_a_rebound_without_restitution_stays_at_once() -> None:
    sequence = impact_sequence(PIN, dropped_pin(0.002), world_of(PIN, floor(e=0.0, mu=0.3)))
    assert (sequence.end, sequence.order, sequence.staying) == (SequenceEnd.STAYS, (0,), (0,))
    assert sequence.limit_seconds == sequence.seconds


def test_beyond_the_window_nothing_strikes() -> None:
    state, world = dropped_pin(0.002), world_of(PIN, floor(e=0.5))
    first = math.sqrt(2.0 * 0.002 / G)
    early = impact_sequence(PIN, state, world, window=0.9 * first)
    assert (early.strikes, early.end) == ((), SequenceEnd.WINDOW_ENDED)
    alone = impact_sequence(PIN, state, world, window=0.9999 * first + 1e-5)
    assert (alone.end, len(alone.strikes)) == (SequenceEnd.CHATTERS, len(alone.strikes))
    # The first rebound, at e = 1, takes twice as long as the fall.
    elastic = impact_sequence(PIN, state, world_of(PIN, floor(e=1.0)), window=1.9 * first)
    assert (elastic.end, elastic.order) == (SequenceEnd.NOTHING_STRIKES, (0,))
    assert elastic.limit_seconds is None


def test_the_number_of_strikes_is_bounded() -> None:
    sequence = impact_sequence(
        PIN, dropped_pin(0.001), world_of(PIN, floor(e=1.0)), window=1.0, max_strikes=3
    )
    assert (sequence.end, sequence.order) == (SequenceEnd.MAX_STRIKES, (0, 0, 0))


ROD = Body(
    name="rod",
    mass_properties=MassProperties(mass=2.0, I_B=np.diag([1e-4, 2.0 / 3.0, 2.0 / 3.0])),
    vertices_B=[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]],
)


@pytest.mark.parametrize("e", [0.3, 1.0])
def test_a_tilted_rod_strikes_with_one_end_and_then_with_the_other(e: float) -> None:
    """Frictionless, by hand: the strike at lever c = l cos(tilt) takes J = (1 + e) v / (1/m + c^2/I)."""
    tilt, v, inertia, mass = 0.01, 1.0, 2.0 / 3.0, 2.0
    # A turn by +tilt about y takes +x down: the first end is the one at +x.
    state = BodyState(
        p_WB_W=[0.0, 0.0, math.sin(tilt)],
        q_WB=[0.0, math.sin(tilt / 2), 0.0, math.cos(tilt / 2)],
        v_WB_W=[0.0, 0.0, -v],
    )
    sequence = impact_sequence(ROD, state, world_of(ROD, floor(e=e)))
    lever = math.cos(tilt)
    impulse = (1.0 + e) * v / (1.0 / mass + lever**2 / inertia)
    v_z, w_y = -v + impulse / mass, -lever * impulse / inertia

    def other_end(t: float) -> float:
        return math.sin(tilt) + v_z * t - 0.5 * G * t * t + math.sin(tilt + w_y * t)

    second = brentq(other_end, 1e-4, 0.1, xtol=1e-16)
    assert sequence.order[:2] == (0, 1)
    assert sequence.strikes[0].seconds == pytest.approx(0.0, abs=1e-15)
    assert sequence.strikes[1].seconds == pytest.approx(second, abs=1e-13)
    angle = tilt + w_y * second
    lever = math.cos(angle)
    approach = v_z - G * second + w_y * lever  # of the end at -lever
    impulse = -(1.0 + e) * approach / (1.0 / mass + lever**2 / inertia)
    after = sequence.strikes[1].state_after
    assert after.v_WB_W == pytest.approx([0.0, 0.0, v_z - G * second + impulse / mass], abs=1e-12)
    assert after.w_WB_W == pytest.approx([0.0, w_y + lever * impulse / inertia, 0.0], abs=1e-12)


def test_strikes_that_come_together_are_those_of_the_sequential_law() -> None:
    """For a tilt towards zero the two strikes become those of the rod on two supports at once."""
    contacts = ContactSet(
        p_WC_W=[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], normals_W=UP, frictions=0.0, restitutions=0.5
    )
    level = BodyState(p_WB_W=np.zeros(3), q_WB=IDENTITY, v_WB_W=[0.0, 0.0, -1.0])
    at_once = several_impact(ROD.mass_properties, level, contacts)
    named = impact_sequence(ROD, level, World(), contacts=contacts, window=1e-6)
    found = impact_sequence(ROD, level, world_of(ROD, floor(e=0.5)), window=1e-6)
    for sequence in (named, found):
        assert sequence.order == at_once.order
        assert sequence.seconds == 0.0
        assert sequence.state.v_WB_W == pytest.approx(at_once.state.v_WB_W, abs=1e-14)
        assert sequence.state.w_WB_W == pytest.approx(at_once.state.w_WB_W, abs=1e-14)


def test_named_points_strike_their_own_planes_alone() -> None:
    """Two supports of unequal height: the plane of the higher one does not reach below the other end."""
    tilt = 0.2
    s, c = math.sin(tilt), math.cos(tilt)
    contacts = ContactSet(
        p_WC_W=[[c, 0.0, -s], [-c, 0.0, s]],
        normals_W=UP,
        frictions=0.0,
        restitutions=0.6,
        surfaces=("low", "high"),
    )
    state = BodyState(
        p_WB_W=np.zeros(3), q_WB=[0.0, math.sin(tilt / 2), 0.0, math.cos(tilt / 2)], v_WB_W=[0.0, 0.0, -0.3]
    )
    sequence = impact_sequence(ROD, state, World(), contacts=contacts, window=0.3)
    assert len(sequence.strikes) > 2
    assert sequence.contacts is contacts
    for strike in sequence.strikes:
        assert strike.p_WC_W[2] == pytest.approx([-s, s][strike.contact], abs=1.1e-6)  # within it, it touches
        assert strike.state_before.velocity_of_point(strike.p_WC_W)[2] < 0.0


def random_toss(seed: int) -> tuple[Body, BodyState]:
    """A box of random proportions just above the floor, on its way down."""
    rng = np.random.default_rng(seed)
    size = rng.uniform(0.05, 0.2, size=3)
    mass = float(rng.uniform(0.1, 1.0))
    moments = mass / 12.0 * ((size**2).sum() - size**2)
    vertices = box_vertices((float(size[0]), float(size[1]), float(size[2])))
    body = Body(
        name="box", mass_properties=MassProperties(mass=mass, I_B=np.diag(moments)), vertices_B=vertices
    )
    q = rng.normal(size=4)
    state = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=q / np.linalg.norm(q),
        v_WB_W=[*rng.normal(size=2), -rng.uniform(0.5, 2.0)],
        w_WB_W=5.0 * rng.normal(size=3),
    )
    lowest = float((vertices @ state.R_WB.T)[:, 2].min())
    raised = BodyState(
        p_WB_W=[0.0, 0.0, 0.01 - lowest], q_WB=state.q_WB, v_WB_W=state.v_WB_W, w_WB_W=state.w_WB_W
    )
    return body, raised


def stepped(
    body: Body, state: BodyState, *, e: float, mu: float, until: float
) -> list[strikes_in_time.Strike]:
    toss = strikes_in_time.Toss(
        mass=body.mass_properties.mass,
        moments=np.diag(body.mass_properties.I_B),
        corners=body.vertices_B,
        p=state.p_WB_W,
        q=state.q_WB,
        v=state.v_WB_W,
        w=state.w_WB_W,
    )
    return strikes_in_time.strikes(toss, e=e, mu=mu, gravity=G, until=until)


def assert_agrees(
    sequence: ImpactSequence, expected: list[strikes_in_time.Strike], *, seconds: float, speed: float
) -> None:
    assert len(expected) > 1
    for ours, theirs in zip(sequence.strikes, expected, strict=False):
        assert ours.seconds == pytest.approx(theirs.time, abs=seconds)
        assert ours.state_after.v_WB_W == pytest.approx(theirs.v, abs=speed)
        assert ours.state_after.w_WB_W == pytest.approx(theirs.w, abs=speed / 0.02)


SEEDS_AND_RESTITUTIONS = [
    (0, 0.3),
    (1, 0.5),
    *(pytest.param(seed, e, marks=pytest.mark.slow) for seed, e in ((2, 0.7), (3, 0.9), (5, 1.0))),
]


@pytest.mark.parametrize(("seed", "e"), SEEDS_AND_RESTITUTIONS)
def test_brute_force_in_small_steps_comes_to_the_same_strikes(seed: int, e: float) -> None:
    """Without friction, the stepped flight errs by about 1e-12 at 50 us, and each strike multiplies that."""
    body, state = random_toss(seed)
    sequence = impact_sequence(body, state, world_of(body, floor(e=e)), window=0.6)
    last = sequence.strikes[min(2, len(sequence.strikes) - 1)].seconds
    expected = stepped(body, state, e=e, mu=0.0, until=last + 1e-4)
    assert_agrees(sequence, expected, seconds=1e-8, speed=1e-6)


@pytest.mark.parametrize("seed", [pytest.param(9, marks=pytest.mark.slow), 11])
def test_brute_force_with_friction(seed: int) -> None:
    """The stepped impulse is of first order: its 1000 increments leave some 1e-3 of the speeds."""
    body, state = random_toss(seed)
    sequence = impact_sequence(body, state, world_of(body, floor(e=0.3, mu=0.3)), window=0.1)
    expected = stepped(body, state, e=0.3, mu=0.3, until=sequence.strikes[1].seconds + 1e-4)
    assert_agrees(sequence, expected, seconds=2e-5, speed=5e-3)


def energy(body: Body, state: BodyState) -> float:
    mass = body.mass_properties.mass
    return kinetic_energy(body.mass_properties, state) + mass * G * float(state.p_WB_W[2])


@given(
    seed=st.integers(0, 2**32),
    e=st.sampled_from([0.0, 1e-6, 0.1, 0.5, 0.9, 1.0]),
    mu=st.sampled_from([0.0, 0.2, 1.0]),
    law=st.sampled_from([RestitutionLaw.POISSON, RestitutionLaw.ENERGETIC]),
)
def test_energy_never_grows_and_nothing_sinks_in(seed: int, e: float, mu: float, law: RestitutionLaw) -> None:
    body, state = random_toss(seed)
    sequence = impact_sequence(body, state, world_of(body, floor(e=e, mu=mu)), restitution_law=law)
    energies = [energy(body, state)]
    before = 0.0
    for strike in sequence.strikes:
        assert strike.seconds >= before
        before = strike.seconds
        assert strike.p_WC_W[2] == pytest.approx(0.0, abs=2e-6)  # within the distance tolerance
        assert strike.state_before.velocity_of_point(strike.p_WC_W)[2] < 0.0
        assert strike.state_after.velocity_of_point(strike.p_WC_W)[2] >= -1e-14  # rounding, at e = 0
        assert strike.state_before.stamp_ns == pytest.approx(1e9 * strike.seconds, abs=len(sequence.strikes))
        heights = strike.state_before.p_WB_W[2] + (body.vertices_B @ strike.state_before.R_WB.T)[:, 2]
        assert heights.min() >= -2e-9 * len(sequence.strikes) - 1e-12
        energies += [energy(body, strike.state_before), energy(body, strike.state_after)]
    assert len(sequence.strikes) > 0
    size = max(energies) - min(0.0, *energies)
    assert np.diff(energies).max() <= 1e-12 * size  # flight keeps it, strikes take of it
    assert not sequence.creates_energy
    taken = sequence.kinetic_energy_before - sequence.kinetic_energy_after
    fallen = sequence.strikes[0].state_before.p_WB_W[2] - sequence.state.p_WB_W[2]
    assert energies[1] - energies[-1] == pytest.approx(
        taken + body.mass_properties.mass * G * fallen, abs=1e-11 * size
    )
    if sequence.limit_seconds is not None:
        assert sequence.limit_seconds >= sequence.seconds
        assert sequence.staying


def test_a_corner_that_turns_up_leaves_even_without_restitution() -> None:
    """At e = 0 the corner's velocity is zero; fast spin takes it up (w^2 r > g), and the flight goes on."""
    body = Body(
        name="wheel",
        mass_properties=MassProperties(mass=1.0, I_B=0.01 * np.eye(3)),
        vertices_B=[[0.0, 0.0, -0.1], [0.1, 0.0, 0.0], [0.0, 0.0, 0.1], [-0.1, 0.0, 0.0]],
    )
    state = BodyState(p_WB_W=[0.0, 0.0, 0.1], q_WB=IDENTITY, v_WB_W=[0.0, 0.0, -0.5], w_WB_W=[0.0, 30.0, 0.0])
    sequence = impact_sequence(body, state, world_of(body, floor(e=0.0)), window=0.2)
    assert sequence.order[:2] == (0, 1)
    # Frictionless strike below the centre: only the fall is taken. The next corner comes a quarter turn later
    # at most, while the centre falls freely.
    assert sequence.strikes[0].state_after.v_WB_W == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)

    def next_corner(t: float) -> float:
        return 0.1 - 0.5 * G * t * t - 0.1 * math.sin(30.0 * t)

    expected = brentq(next_corner, 0.01, 0.5 * math.pi / 30.0, xtol=1e-16)
    assert sequence.strikes[1].seconds == pytest.approx(expected, abs=1e-8)  # it leaves within 1e-9 s


def test_the_sequence_goes_on_where_the_next_landing_is() -> None:
    """A body far up: its landing first, then the strikes, whose stamps go on from the landing's."""
    body, state = random_toss(4)
    world = world_of(body, floor(e=0.4, mu=0.2))
    far = BodyState(
        p_WB_W=state.p_WB_W + UP, q_WB=state.q_WB, v_WB_W=state.v_WB_W, w_WB_W=state.w_WB_W, stamp_ns=10**18
    )
    landing = next_landing(body, far, world, horizon=2.0)
    assert landing is not None
    sequence = impact_sequence(body, landing.state, world)
    assert sequence.strikes[0].state_before.stamp_ns == 10**18 + round(1e9 * landing.seconds)
    assert sequence.contacts.p_WC_W[0] == pytest.approx(landing.contacts.p_WC_W[0], abs=1e-12)
    assert sequence.contacts.surfaces[0] == "floor"


def test_a_ball_that_spins_bounces_as_one_that_does_not() -> None:
    """Its point of contact moves over it, which the gap knows nothing of: it rests when a point would."""
    radius, e = 0.05, 0.5
    ball = Body(
        name="ball",
        mass_properties=MassProperties(mass=0.2, I_B=2e-4 * np.eye(3)),
        shape=ConvexShape(vertices=np.zeros((1, 3)), rounding=radius),
    )
    state = BodyState(
        p_WB_W=np.array([0.0, 0.0, radius]),
        q_WB=IDENTITY,
        v_WB_W=np.array([0.0, 0.0, -0.2]),
        w_WB_W=np.array([0.0, 40.0, 0.0]),  # w^2 r = 80 m/s^2: far above g
    )
    sequence = impact_sequence(ball, state, world_of(ball, floor(e=e)), window=0.2)
    assert sequence.end is SequenceEnd.CHATTERS
    assert set(sequence.order) == {0}
    assert sequence.limit_seconds == pytest.approx(2.0 * e * 0.2 / (G * (1.0 - e)), abs=1e-10)
    still = impact_sequence(ball, state, world_of(ball, floor(e=0.0)))
    assert (still.end, still.order, still.staying) == (SequenceEnd.STAYS, (0,), (0,))


# Going on where a contact stays


@pytest.mark.parametrize("friction", [0.0, 50.0])
def test_a_rod_that_turns_about_a_held_end_strikes_with_the_other(friction: float) -> None:
    """One end rests on the floor, the other is let go. By energy: m g (sin t0 - sin t) l = J w^2 / 2.

    J = I + m l^2 about an end that sticks, I + m l^2 cos^2 t for one that slides without friction. The steps
    are of first order: the strike is found at the end of a step.
    """
    tilt, mass, inertia, step = 0.1, 2.0, 2.0 / 3.0, 1e-3
    state = BodyState(
        p_WB_W=[0.0, 0.0, math.sin(tilt)], q_WB=[0.0, math.sin(tilt / 2), 0.0, math.cos(tilt / 2)]
    )

    def rate(angle: float) -> float:
        lever = 1.0 if friction > 0.0 else math.cos(angle) ** 2
        lost = mass * G * (math.sin(tilt) - math.sin(angle))
        return math.sqrt(2.0 * lost / (inertia + mass * lever))

    # With t = t0 - s^2 the integrand of dt / w is smooth.
    expected = quad(lambda s: 2.0 * s / rate(tilt - s * s), 0.0, math.sqrt(tilt))[0]
    world = world_of(ROD, floor(e=0.0, mu=friction))
    ended = impact_sequence(ROD, state, world, window=0.3)
    assert (ended.end, ended.strikes, ended.staying) == (SequenceEnd.STAYS, (), (0,))
    held = impact_sequence(ROD, state, world, window=0.3, max_strikes=1, hold_step=step)
    assert held.order == (1,)
    strike = held.strikes[0]
    assert strike.seconds == pytest.approx(expected, abs=1.5 * step)
    assert -strike.state_before.w_WB_W[1] == pytest.approx(rate(0.0), rel=0.02)
    assert strike.state_before.p_WB_W[0] == pytest.approx(
        math.cos(tilt) - 1.0 if friction > 0.0 else 0.0, abs=1e-3
    )


@settings(max_examples=10)
@given(seed=st.integers(0, 2**32), e=st.sampled_from([0.0, 0.1, 0.4]), mu=st.sampled_from([0.0, 0.2, 1.0]))
def test_holding_takes_energy_and_never_gives(seed: int, e: float, mu: float) -> None:
    body, state = random_toss(seed)
    step = 1e-3
    sequence = impact_sequence(
        body, state, world_of(body, floor(e=e, mu=mu)), window=0.02, hold_step=step, max_strikes=12
    )
    energies = [energy(body, state)]
    for strike in sequence.strikes:
        energies += [energy(body, strike.state_before), energy(body, strike.state_after)]
        # It sinks by what a corner at 3 m/s goes in one step, and by half a step's fall in each other.
        heights = strike.state_before.p_WB_W[2] + (body.vertices_B @ strike.state_before.R_WB.T)[:, 2]
        assert heights.min() > -4.0 * step
    size = max(energies) - min(0.0, *energies)
    assert np.diff(energies).max(initial=0.0) <= 1e-12 * size  # nothing strikes within some windows
    if sequence.end in {SequenceEnd.STAYS, SequenceEnd.CHATTERS}:
        assert sequence.staying
        assert sequence.limit_seconds is not None


def test_what_leaves_is_not_held() -> None:
    """A sequence that no contact ends is the same with and without holding."""
    body, state = random_toss(1)
    world = world_of(body, floor(e=0.9))
    free = impact_sequence(body, state, world, window=0.1, max_strikes=4)
    held = impact_sequence(body, state, world, window=0.1, max_strikes=4, hold_step=1e-3)
    assert free.limit_seconds is None
    assert [strike.seconds for strike in held.strikes] == [strike.seconds for strike in free.strikes]
