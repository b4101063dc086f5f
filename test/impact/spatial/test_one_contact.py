# SPDX-License-Identifier: Apache-2.0
"""One contact in space: two independent integrations, closed forms, the plane inside it, special cases."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from contact_dynamics.contact.contact import Contact
from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import (
    ImpactOutcome,
    PathEvent,
    RestitutionLaw,
    SpatialImpact,
    planar_impact,
    spatial_impact,
)
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body.body import BodyState, MassProperties, kinetic_energy
from impact.spatial.drawn_problem import IDENTITY, UP, random_problem, random_rotation, solve
from oracles import impact_increments, impact_swerving
from sweeps import seeds

# Independent integrations.


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("seed", [0, 3, 6, 8, 14, 43, 113])
def test_agrees_with_the_impulse_to_40_digits(seed: int, law: RestitutionLaw) -> None:
    """The sliding direction turns fast or hardly, and sliding stops, reverses or continues."""
    problem = random_problem(seed)
    problem["friction"] *= 0.2
    answer, normal = solve(problem, law), problem["n_W"]
    axes = np.vstack([np.linalg.svd(normal[None])[2][1:], normal])
    *sliding, v_n = (axes @ answer.velocity_before_W).tolist()
    exact = impact_swerving.impulse(
        (axes @ answer.inverse_inertia_W @ axes.T).tolist(),
        tuple(sliding),
        v_n,
        mu=problem["friction"],
        e=problem["restitution"],
        law=law.name.lower(),
    )
    expected = np.array([float(x) for x in exact]) @ axes
    assert answer.impulse_W == pytest.approx(expected, abs=1e-11 * float(np.linalg.norm(expected)))


@pytest.mark.parametrize(
    ("seed", "outcome", "law"),
    [
        (0, ImpactOutcome.SLIDES, RestitutionLaw.POISSON),
        (3, ImpactOutcome.STICKS_IN_COMPRESSION, RestitutionLaw.ENERGETIC),
        (14, ImpactOutcome.STICKS_IN_RESTITUTION, RestitutionLaw.NEWTON),
        (113, ImpactOutcome.REVERSES_IN_COMPRESSION, RestitutionLaw.ENERGETIC),
        (43, ImpactOutcome.REVERSES_IN_RESTITUTION, RestitutionLaw.NEWTON),
    ],
)
def test_agrees_with_increments_in_every_outcome_class(
    seed: int, outcome: ImpactOutcome, law: RestitutionLaw
) -> None:
    problem = random_problem(seed)
    problem["friction"] *= 0.2
    problem["restitution"] = 1.0
    assert solve(problem).outcome is outcome
    answer = solve(problem, law)
    size = float(np.linalg.norm(answer.impulse_W))
    errors = [
        np.linalg.norm(increments(problem, law, size / n) - answer.impulse_W) / size for n in (100, 400)
    ]
    # First order: an error of a few increments, which falls with them.
    assert errors[0] < 5.0 / 100
    assert errors[1] < 5.0 / 400


def increments(problem: dict[str, object], law: RestitutionLaw, increment: float) -> np.ndarray:
    state = problem["state"]
    body = impact_increments.Body(
        problem["body"].mass, problem["body"].inertia_in_world(state.R_WB), state.v_WB_W, state.w_WB_W
    )
    return impact_increments.impact(
        body,
        problem["p_WC_W"] - state.p_WB_W,
        problem["n_W"],
        mu=problem["friction"],
        e=problem["restitution"],
        law=law.name.lower(),
        increment=increment,
    )


# Closed forms.


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("friction", [1e6, 1e100, 1e308])
def test_unbounded_friction_is_the_rough_limit(friction: float, law: RestitutionLaw) -> None:
    """A rough contact stops at once. Then normal impulse meets the normal response of a held contact.

    Compression makes the contact's velocity W I + u zero, restitution is one-dimensional.
    """
    for seed in range(20):
        problem = random_problem(seed)
        problem["friction"] = friction
        answer, e, n = solve(problem, law), problem["restitution"], problem["n_W"]
        compression = -np.linalg.solve(answer.inverse_inertia_W, answer.velocity_before_W)
        if n @ compression <= 0.0:
            continue
        assert answer.outcome is ImpactOutcome.STICKS_IN_COMPRESSION
        size = float(np.linalg.norm(compression))
        # What is left of the slide at finite friction is its share of the impulse.
        assert answer.compression_W == pytest.approx(compression, abs=1e-8 * size + 30.0 / friction * size)
        if law is RestitutionLaw.POISSON:
            held = np.linalg.solve(answer.inverse_inertia_W, n)
            restitution = e * (n @ compression) * held / (n @ held)
            tolerance = (1e-8 + 30.0 / friction) * size
            assert answer.restitution_W == pytest.approx(restitution, abs=tolerance)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 1.0])
def test_without_friction_the_laws_agree(restitution: float) -> None:
    """The impulse is normal, and (1 + e) times what stops the approach."""
    for seed in range(20):
        problem = {**random_problem(seed), "friction": 0.0, "restitution": restitution}
        n = problem["n_W"]
        for law in RestitutionLaw:
            answer = solve(problem, law)
            size = -(1.0 + restitution) * (n @ answer.velocity_before_W) / (n @ answer.inverse_inertia_W @ n)
            assert answer.impulse_W == pytest.approx(size * n, abs=1e-12 * size)


@pytest.mark.parametrize("angle", np.linspace(0.0, 6.0, 7))
def test_from_rest_a_contact_leaves_in_an_invariant_direction(angle: float) -> None:
    """A contact that friction cannot hold slides straight, the way that its own sliding keeps."""
    c, s = math.cos(angle), math.sin(angle)
    body = MassProperties(mass=1.0, I_B=np.diag([0.2, 0.3, 0.35]))
    arm = np.array([0.8 * c, 0.8 * s, -0.6])
    state = BodyState(p_WB_W=np.zeros(3), q_WB=IDENTITY, v_WB_W=[0.0, 0.0, -1.0])
    answer = spatial_impact(body, state, Contact(p_WC_W=arm, normal_W=UP, friction=0.1, restitution=0.5))
    assert answer.outcome is ImpactOutcome.SLIDES
    assert PathEvent.SAMPLE not in answer.path_events
    after = answer.velocity_after_W[:2]
    along, friction = after / np.linalg.norm(after), answer.impulse_W[:2] / answer.impulse_W[2]
    assert friction == pytest.approx(-0.1 * along, rel=1e-12)
    # The acceleration under the friction of this direction has this direction.
    rate = answer.inverse_inertia_W @ [*friction, 1.0]
    assert rate[0] * along[1] - rate[1] * along[0] == pytest.approx(0.0, abs=1e-13 * np.linalg.norm(rate))


# The plane inside space.


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_planar_problems_have_planar_answers(law: RestitutionLaw, seed: int) -> None:
    rng = np.random.default_rng(seed)
    r, v = rng.normal(size=2) * 10.0 ** rng.uniform(-1.0, 1.0), rng.normal(size=2)
    w = float(rng.normal())
    v[1] = -abs(v[1]) - w * r[0]
    if rng.uniform() < 0.1:
        v[0] = w * r[1]
    mass, inertia = float(rng.uniform(0.3, 3.0)), float(10.0 ** rng.uniform(-1.0, 1.0))
    friction, e = float(10.0 ** rng.uniform(-2.0, 2.0)), float(rng.choice([0.0, 1.0, rng.uniform()]))
    flat = planar_impact(
        PlanarBody(mass=mass, inertia=inertia),
        PlanarVelocity(v=tuple(v), w=w),
        PlanarContact(r=tuple(r), normal=(0.0, 1.0), friction=friction, restitution=e),
        restitution_law=law,
    )
    # Plane x, y with z as the axis; then the whole problem turned at random.
    turn = random_rotation(rng)
    other = rng.uniform(0.0, 1.0)
    body = MassProperties(
        mass=mass, I_B=turn @ np.diag([other * inertia, (1.0 - 0.5 * other) * inertia, inertia]) @ turn.T
    )
    state = BodyState(p_WB_W=np.zeros(3), q_WB=IDENTITY, v_WB_W=turn @ [*v, 0.0], w_WB_W=turn @ [0.0, 0.0, w])
    answer = spatial_impact(
        body,
        state,
        Contact(p_WC_W=turn @ [*r, 0.0], normal_W=turn @ [0.0, 1.0, 0.0], friction=friction, restitution=e),
        restitution_law=law,
    )
    assert answer.outcome is flat.outcome
    assert answer.jams == flat.jams
    scale = math.hypot(*flat.impulse)
    # 1e-12 is where a direction counts as invariant; far contacts lose digits in r^2/I beside 1/m.
    assert answer.impulse_W == pytest.approx(turn @ [*flat.impulse, 0.0], abs=1e-9 * scale)
    planar_compression = flat.compression_C
    assert answer.compression_W == pytest.approx(
        turn @ [planar_compression[0], planar_compression[1], 0.0], abs=1e-9 * scale
    )


@pytest.mark.parametrize("law", RestitutionLaw)
@given(seed=st.integers(0, 2**32))
def test_planes_along_the_axes_have_planar_answers_to_rounding(law: RestitutionLaw, seed: int) -> None:
    """Where no turn rounds the plane away, the whole path is the planar one, vertex by vertex."""
    rng = np.random.default_rng(seed)
    r, v = rng.normal(size=2), rng.normal(size=2) * [rng.choice([0.0, 1.0]), 1.0]
    v[1] = -abs(v[1])
    mass, inertia = float(rng.uniform(0.3, 3.0)), float(10.0 ** rng.uniform(-1.0, 1.0))
    friction, e = float(rng.choice([0.0, 10.0 ** rng.uniform(-2.0, 1.0), 1e9])), float(rng.uniform())
    flat = planar_impact(
        PlanarBody(mass=mass, inertia=inertia),
        PlanarVelocity(v=tuple(v), w=0.0),
        PlanarContact(r=tuple(r), normal=(0.0, 1.0), friction=friction, restitution=e),
        restitution_law=law,
    )
    answer = spatial_impact(
        MassProperties(mass=mass, I_B=inertia * np.diag([0.7, 1.0, 0.8])),
        BodyState(p_WB_W=np.zeros(3), q_WB=IDENTITY, v_WB_W=[v[0], 0.0, v[1]]),
        Contact(p_WC_W=[r[0], 0.0, r[1]], normal_W=UP, friction=friction, restitution=e),
        restitution_law=law,
    )
    assert answer.outcome is flat.outcome
    assert list(answer.path_events) == [event for event, _ in flat.path]
    vertices = np.array([[i_t, 0.0, i_n] for _, (i_t, i_n) in flat.path])
    # The same formulas in another order: rounding, times what nearly jamming makes of it.
    lifting = abs(flat.inverse_inertia.c - friction * abs(flat.inverse_inertia.b))
    amplified = 1.0 + flat.inverse_inertia.c / lifting if friction < 100.0 else 2.0
    assert answer.path_W == pytest.approx(vertices, abs=1e-13 * amplified * math.hypot(*flat.impulse))


# Special cases by name.


@pytest.mark.parametrize("law", RestitutionLaw)
def test_a_swerving_contact_can_be_compressed_twice(law: RestitutionLaw) -> None:
    """The contact swerves into a direction that jams during restitution. A search found this case."""
    normal = np.array([-0.07, 0.99, -0.14])
    problem = {
        "body": MassProperties(mass=1.0, I_B=np.diag([0.023, 0.098, 0.105])),
        "state": BodyState(p_WB_W=np.zeros(3), q_WB=IDENTITY, v_WB_W=[-1.7, -1.15, -0.17]),
        "p_WC_W": np.array([0.42, -1.05, 0.79]),
        "n_W": normal / np.linalg.norm(normal),
        "friction": 0.72,
        "restitution": 1.0,
    }
    answer = solve(problem, law)
    assert answer.path_events.count(PathEvent.COMPRESSION_ENDS) == 2
    size = float(np.linalg.norm(answer.impulse_W))
    # First order, and errors at the first end of compression have grown by the second.
    assert increments(problem, law, size / 1500) == pytest.approx(answer.impulse_W, abs=10 / 1500 * size)


def test_resting_contact_gets_no_impulse_unless_it_jams() -> None:
    """The lecture's sliding rod, in space: at mu = 1/2 sliding begins to drive it into the floor."""
    body = MassProperties(mass=1.0, I_B=np.eye(3))
    state = BodyState(p_WB_W=[0.0, 0.0, 0.0], q_WB=IDENTITY, v_WB_W=[-1.0, 0.0, 0.0])

    def strike(friction: float) -> SpatialImpact:
        return spatial_impact(
            body, state, Contact(p_WC_W=[-1.0, 0.0, -4.0], normal_W=UP, friction=friction, restitution=0.5)
        )

    assert strike(0.499).outcome is ImpactOutcome.NO_IMPULSE
    assert strike(0.499).state.v_WB_W.tolist() == [-1.0, 0.0, 0.0]
    rod = strike(math.tan(math.radians(30.0)))
    assert rod.jams
    assert rod.impulse_W == pytest.approx([7 / 51, 0.0, 1 / 3], rel=1e-13)


def test_path_runs_from_nothing_to_the_total() -> None:
    answer = solve(random_problem(3))
    assert answer.path_events[0] is PathEvent.START
    assert answer.path_events[-1] is PathEvent.RESTITUTION_ENDS
    assert answer.path_W.shape == (len(answer.path_events), 3)
    assert answer.path_W[0].tolist() == [0.0, 0.0, 0.0]
    assert answer.path_W[-1] == pytest.approx(answer.impulse_W, rel=1e-14)
    compression = answer.path_events.index(PathEvent.COMPRESSION_ENDS)
    assert answer.path_W[compression] == pytest.approx(answer.compression_W, rel=1e-14)


def test_separating_contact_is_refused() -> None:
    problem = random_problem(0)
    with pytest.raises(SeparatingContactError, match="v_n = "):
        solve({**problem, "n_W": -problem["n_W"]})


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("offset", [0.0, 1e-30, 1e-18, 1e-14, 1e-9])
def test_weak_coupling_ends_in_the_central_impact(offset: float, law: RestitutionLaw) -> None:
    """A corner below the centre, off by rounding: the terms of its swerve underflow or nearly do."""
    body = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
    state = BodyState(p_WB_W=UP, q_WB=IDENTITY, v_WB_W=[1e-6, 2e-6, -1e-7])
    answer = spatial_impact(
        body,
        state,
        Contact(p_WC_W=[offset, -0.3 * offset, 0.0], normal_W=UP, friction=0.0, restitution=0.5),
        restitution_law=law,
    )
    assert answer.impulse_W == pytest.approx([0.0, 0.0, 2.0 * 1.5e-7], rel=1e-8, abs=1e-22)


BODIES = {
    "ball": MassProperties(mass=0.1, I_B=4e-5 * np.eye(3)),
    "brick": MassProperties(mass=0.4, I_B=np.diag([3.5e-4, 8.3e-4, 1.02e-3])),
}

STATE = BodyState(p_WB_W=[0.0, 2.9, 1.0], q_WB=[0, 0, 1, 0], v_WB_W=[0, -0.4, 1.0], w_WB_W=[2.4, -0.5, 0.0])

SIZES = [5e-324, *(10.0**-k for k in (320, 308, 300, 200, 100, 60, 35, 30, 25, 21, 19, 17, 15))]


@pytest.mark.parametrize("friction", SIZES)
@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("body", BODIES)
def test_the_least_friction_acts_as_none(body: str, law: RestitutionLaw, friction: float) -> None:
    slid, free = (
        spatial_impact(
            BODIES[body],
            STATE,
            Contact(p_WC_W=[-0.45, -0.45, 1.0], normal_W=[0, 0, 1], friction=mu, restitution=0.3),
            restitution_law=law,
        ).state
        for mu in (friction, 0.0)
    )
    # The arm is ten times the body, so that friction acts a hundred times as much, and rounding too.
    np.testing.assert_allclose(slid.v_WB_W, free.v_WB_W, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(slid.w_WB_W, free.w_WB_W, rtol=0.0, atol=1e-11)


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
