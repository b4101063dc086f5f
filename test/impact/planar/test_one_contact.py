# SPDX-License-Identifier: Apache-2.0
"""One planar contact: the lecture's numbers, every outcome class, the laws, and exact arithmetic."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import ImpactOutcome, PathEvent, PlanarImpact, RestitutionLaw, planar_impact
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from oracles import impact_exact

UNIT_BODY = PlanarBody(mass=1.0, inertia=1.0)
UP = (0.0, 1.0)


def strike(
    r: tuple[float, float],
    v: tuple[float, float],
    w: float = 0.0,
    *,
    friction: float = 0.25,
    restitution: float = 0.5,
    body: PlanarBody = UNIT_BODY,
    normal: tuple[float, float] = UP,
    law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = 1e-9,
) -> PlanarImpact:
    return planar_impact(
        body,
        PlanarVelocity(v=v, w=w),
        PlanarContact(r=r, normal=normal, friction=friction, restitution=restitution),
        restitution_law=law,
        velocity_tolerance=velocity_tolerance,
    )


# Lecture 27's numbers.


def test_sliding_rod() -> None:
    answer = strike((-1.0, -4.0), (-1.0, 0.0), friction=math.tan(math.radians(30.0)))
    assert answer.outcome is ImpactOutcome.STICKS_IN_COMPRESSION
    assert answer.jams
    assert [event for event, _ in answer.path] == [
        PathEvent.START,
        PathEvent.SLIDING_STOPS,
        PathEvent.COMPRESSION_ENDS,
        PathEvent.RESTITUTION_ENDS,
    ]
    assert answer.path[1][1][1] == pytest.approx(0.1719704, abs=5e-8)
    assert answer.compression_C == pytest.approx((1 / 9, 2 / 9), rel=1e-14)
    assert answer.impulse_C == pytest.approx((7 / 51, 1 / 3), rel=1e-14)
    assert answer.velocity.v == pytest.approx((-44 / 51, 1 / 3), rel=1e-14)
    assert answer.velocity.w == pytest.approx(11 / 51, rel=1e-14)
    assert answer.velocity_after_C == pytest.approx((0.0, 2 / 17), rel=1e-14)
    assert answer.energy_change == pytest.approx(-5 / 102, rel=1e-13)


# Every outcome class, each with the reason why the case belongs to it.

CLASSES = [
    ("no coupling, friction too weak to stop it", (0.0, 0.0), (-1.0, -1.0), 0.25, ImpactOutcome.SLIDES),
    (
        "no coupling, stops after 0.4 of 1.5",
        (0.0, 0.0),
        (-0.1, -1.0),
        0.25,
        ImpactOutcome.STICKS_IN_COMPRESSION,
    ),
    (
        "no coupling, stops after 1.2 of 1.5",
        (0.0, 0.0),
        (-0.3, -1.0),
        0.25,
        ImpactOutcome.STICKS_IN_RESTITUTION,
    ),
    ("|b|/a = 1/2 is more than mu", (1.0, -1.0), (-0.1, -1.0), 0.25, ImpactOutcome.REVERSES_IN_COMPRESSION),
    (
        "the same, stopping at 0.53 of 0.67",
        (1.0, -1.0),
        (-0.8, -1.0),
        0.25,
        ImpactOutcome.REVERSES_IN_RESTITUTION,
    ),
    ("nothing drives it sideways", (0.0, -1.0), (0.0, -1.0), 0.25, ImpactOutcome.STICKS_THROUGHOUT),
    ("coupling starts the sliding", (1.0, -1.0), (0.0, -1.0), 0.25, ImpactOutcome.SLIDES),
    ("rests and slides without jamming", (0.0, -1.0), (-1.0, 0.0), 0.25, ImpactOutcome.NO_IMPULSE),
    ("rests", (0.0, -1.0), (0.0, 0.0), 0.25, ImpactOutcome.NO_IMPULSE),
]


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize(
    ("reason", "r", "v", "friction", "outcome"), CLASSES, ids=[case[0] for case in CLASSES]
)
def test_outcome_classes(
    *,
    reason: str,  # noqa: ARG001
    r: tuple[float, float],
    v: tuple[float, float],
    friction: float,
    outcome: ImpactOutcome,
    law: RestitutionLaw,
) -> None:
    answer = strike(r, v, friction=friction, law=law)
    assert answer.outcome is outcome
    assert answer.outcome.sticks == (
        answer.velocity_after_C[0] == 0.0 and outcome is not ImpactOutcome.NO_IMPULSE
    )


def test_the_rod_jams_only_above_its_threshold() -> None:
    """The threshold c = mu |b| is at mu = 1/2 for the lecture's rod."""
    assert strike((-1.0, -4.0), (-1.0, 0.0), friction=0.5 - 1e-12).outcome is ImpactOutcome.NO_IMPULSE
    assert (
        strike((-1.0, -4.0), (-1.0, 0.0), friction=0.5 + 1e-12).outcome is ImpactOutcome.STICKS_IN_COMPRESSION
    )


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("friction", [1e8, 1e100, 1e307])
def test_unbounded_friction_is_the_rough_limit(friction: float, law: RestitutionLaw) -> None:
    """With a rough contact the impulse holds the tangential velocity at 0 and the rest is one-dimensional."""
    answer = strike((0.3, -1.0), (0.7, -1.0), friction=friction, law=law)
    a, b, det = 2.0, 0.3, 1.0 + 1.09
    v_stop = -1.0 - b * 0.7 / a
    p_compression = -v_stop * a / det
    assert answer.compression_C[1] == pytest.approx(p_compression, rel=1e-7)
    assert answer.velocity_after_C[0] == 0.0
    if law is RestitutionLaw.POISSON:
        assert answer.velocity_after_C[1] == pytest.approx(0.5 * p_compression * det / a, rel=1e-7)


def test_newton_creates_energy_where_friction_stops_the_slide() -> None:
    """With e = 1 the normal velocity is reversed, which costs more than the slide had: 0.07 J, by hand."""
    answers = {
        law: strike((1.0, -1.0), (-0.3, -1.0), friction=0.6, restitution=1.0, law=law)
        for law in RestitutionLaw
    }
    newton = answers[RestitutionLaw.NEWTON]
    assert newton.creates_energy
    assert newton.energy_change == pytest.approx(0.07, rel=1e-12)
    assert [law for law in RestitutionLaw if answers[law].creates_energy] == [RestitutionLaw.NEWTON]


@pytest.mark.parametrize("law", RestitutionLaw)
def test_separating_contact_is_refused_by_its_velocity(law: RestitutionLaw) -> None:
    with pytest.raises(SeparatingContactError, match=r"v_n = 0\.001"):
        strike((0.0, -1.0), (0.0, 1e-3), law=law)
    assert (
        strike((0.0, -1.0), (0.0, 1e-3), law=law, velocity_tolerance=2e-3).outcome is ImpactOutcome.NO_IMPULSE
    )


def test_no_impulse_leaves_the_velocity_untouched() -> None:
    answer = strike((0.1, -1.0), (0.3, 1e-12), 1e-13)
    assert answer.velocity == PlanarVelocity(v=(0.3, 1e-12), w=1e-13)
    assert answer.path == ((PathEvent.START, (0.0, 0.0)),)
    assert answer.energy_change == 0.0


# Random input, with every singular end in its own logarithmic distance.

logarithmic = st.builds(
    lambda exponent, mantissa: mantissa * 10.0**exponent, st.integers(-8, 2), st.floats(1.0, 9.0)
)
signed = st.one_of(st.just(0.0), st.builds(math.copysign, logarithmic, st.sampled_from([-1.0, 1.0])))
coefficient = st.one_of(
    st.sampled_from([0.0, 1.0]), st.floats(0.0, 1.0), logarithmic.filter(lambda x: x < 1.0)
)
near_one = st.builds(lambda x, s: 1.0 + s * min(x, 0.5), logarithmic, st.sampled_from([-1.0, 0.0, 1.0]))


@st.composite
def problems(draw: st.DrawFn, *, resting: bool = True) -> impact_exact.Problem:
    """Draw a problem without spin, whose contact velocity is exact; friction may be near a threshold."""
    mass, inertia = draw(st.floats(0.1, 10.0)), draw(logarithmic)
    r_t, r_n = draw(signed), draw(signed)
    approach = logarithmic.map(lambda x: -x)
    v_t, v_n = draw(signed), draw(st.one_of(st.just(0.0), approach) if resting else approach)
    a, b, c = 1 / mass + r_n**2 / inertia, abs(r_t * r_n) / inertia, 1 / mass + r_t**2 / inertia
    at = [0.0] if b == 0.0 else [b / a, c / b]
    friction = draw(
        st.one_of(st.just(0.0), logarithmic, st.builds(lambda x, k: x * k, st.sampled_from(at), near_one))
    )
    exact = [Fraction(x) for x in (mass, inertia, r_t, r_n, v_t, v_n, friction, draw(coefficient))]
    mass_, inertia_, r_t_, r_n_, v_t_, v_n_, friction_, e_ = exact
    return impact_exact.Problem(mass_, inertia_, (r_t_, r_n_), (v_t_, v_n_), Fraction(0), friction_, e_)


# Sticking, its contact approaches 400 times more slowly than sliding drives it.
FAR_FROM_THE_CENTRE = impact_exact.Problem(
    mass=Fraction(2),
    inertia=Fraction(1),
    r=(Fraction(20), Fraction(20)),
    v=(Fraction(20), Fraction(-20)),
    w=Fraction(0),
    mu=Fraction(2),
    e=Fraction(0),
)


def answer_to(problem: impact_exact.Problem, law: RestitutionLaw) -> PlanarImpact:
    return strike(
        (float(problem.r[0]), float(problem.r[1])),
        (float(problem.v[0]), float(problem.v[1])),
        friction=float(problem.mu),
        restitution=float(problem.e),
        body=PlanarBody(mass=float(problem.mass), inertia=float(problem.inertia)),
        law=law,
        velocity_tolerance=0.0,
    )


def compare_with_exact(answer: PlanarImpact, exact: impact_exact.Walk, tolerance: float) -> None:
    scale = max(1e-300, *(abs(float(x)) for x in exact.vertices[-1]))
    assert answer.impulse_C == pytest.approx([float(x) for x in exact.vertices[-1]], abs=tolerance * scale)
    assert answer.compression_C == pytest.approx([float(x) for x in exact.compression], abs=tolerance * scale)
    # Velocities are sums of the one before and the impulse's share, which may cancel.
    speed = max(scale * answer.inverse_inertia.c, *(abs(x) for x in answer.velocity_before_C))
    assert answer.velocity.v == pytest.approx([float(x) for x in exact.v], abs=tolerance * speed)


@pytest.mark.parametrize("law", [RestitutionLaw.POISSON, RestitutionLaw.NEWTON])
@given(problem=problems())
@example(problem=FAR_FROM_THE_CENTRE)
def test_agrees_with_exact_arithmetic(law: RestitutionLaw, problem: impact_exact.Problem) -> None:
    """To rounding, times what the problem makes of it: its rates are differences with mu in them."""
    r_t, r_n = problem.r
    a, b = 1 / problem.mass + r_n**2 / problem.inertia, abs(r_t * r_n) / problem.inertia
    c = 1 / problem.mass + r_t**2 / problem.inertia
    lifting, slowing = abs(c - problem.mu * b), abs(problem.mu * a - b)
    assume(lifting * 10**6 > c)
    assume(slowing * 10**6 > problem.mu * a)
    amplified = 1 + c / lifting + (problem.mu * a / slowing if slowing else 0)
    exact = impact_exact.walk(problem, law.name.lower())
    if 0 in exact.sliding:  # what is left of the approach where it sticks is a difference, over c - b^2 / a
        amplified += a * c / (a * c - b * b)
    compare_with_exact(answer_to(problem, law), exact, tolerance=1e-14 * float(amplified))


@pytest.mark.parametrize("law", RestitutionLaw)
@given(problem=problems())
def test_admissible(law: RestitutionLaw, problem: impact_exact.Problem) -> None:
    answer = answer_to(problem, law)
    mu = float(problem.mu)
    i_t, i_n = answer.impulse_C
    assert i_n >= 0.0
    assert abs(i_t) <= mu * i_n * (1 + 1e-12)
    assert answer.velocity_after_C[1] >= 0.0
    if answer.outcome.sticks:
        assert answer.velocity_after_C[0] == 0.0
    if law is not RestitutionLaw.NEWTON:
        assert not answer.creates_energy
    for (_, (_, before)), (_, (_, after)) in pairwise(answer.path):
        assert after >= before


@given(problem=problems())
def test_the_energetic_law_returns_its_part_of_the_work(problem: impact_exact.Problem) -> None:
    """The work of the normal impulse, exactly, along the straight pieces of the path: out = e^2 in."""
    answer = answer_to(problem, RestitutionLaw.ENERGETIC)
    assume(answer.outcome is not ImpactOutcome.NO_IMPULSE)
    _, b, c, _ = answer.inverse_inertia
    v_n = [answer.velocity_before_C[1] + b * i_t + c * p for _, (i_t, p) in answer.path]
    work = [
        0.5 * (v_n[i] + v_n[i + 1]) * (answer.path[i + 1][1][1] - answer.path[i][1][1])
        for i in range(len(v_n) - 1)
    ]
    events = [event for event, _ in answer.path]
    end = events.index(PathEvent.COMPRESSION_ENDS)
    taken, returned = -sum(work[:end]), sum(work[end:])
    # v_n is a difference of terms of this size, and so is its error.
    speed = abs(answer.velocity_before_C[1]) + abs(b * answer.impulse_C[0]) + c * answer.impulse_C[1]
    assert returned == pytest.approx(
        float(problem.e) ** 2 * taken, rel=1e-9, abs=1e-14 * speed * answer.impulse_C[1]
    )


@pytest.mark.parametrize("law", RestitutionLaw)
@given(problem=problems(resting=False), w=st.floats(-10.0, 10.0), angle=st.floats(-math.pi, math.pi))
def test_turned_and_spinning_problems_have_the_same_impulse(
    law: RestitutionLaw, problem: impact_exact.Problem, w: float, angle: float
) -> None:
    """The impulse depends on the contact's velocity alone, and turns with the axes of the plane."""
    r, v = (float(problem.r[0]), float(problem.r[1])), (float(problem.v[0]), float(problem.v[1]))
    # The contact's velocity is rounded in the new axes; where that rounding is a visible part of it, answers
    # may differ.
    lost = 1e-15 * (abs(v[0]) + abs(v[1]) + abs(w) * math.hypot(*r))
    assume(-v[1] > 1e6 * lost)
    assume(abs(v[0]) > 1e6 * lost)
    # The same for the contact's position.
    assume(min((abs(x) for x in r if x != 0.0), default=1.0) > 1e-6 * math.hypot(*r))
    c, s = math.cos(angle), math.sin(angle)

    def turn(x: tuple[float, float]) -> tuple[float, float]:
        return (c * x[0] - s * x[1], s * x[0] + c * x[1])

    answer = answer_to(problem, law)
    turned = strike(
        turn(r),
        turn((v[0] + w * r[1], v[1] - w * r[0])),
        w,
        normal=turn(UP),
        friction=float(problem.mu),
        restitution=float(problem.e),
        body=PlanarBody(mass=float(problem.mass), inertia=float(problem.inertia)),
        law=law,
        velocity_tolerance=0.0,
    )
    assert turned.impulse == pytest.approx(turn(answer.impulse), abs=1e-4 * math.hypot(*answer.impulse))
