"""Samples that go on together do what each does alone: impacts, steps, flights, and whole tosses."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.landing.search_work import SearchWork
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.shapes import box
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.tolerances import SAMPLED_PHASE_ERROR
from contact_dynamics.toss import TossEnd, TossEventKind, TossUncertainty
from contact_dynamics.toss.flight import AskedFlight
from contact_dynamics.toss.flights_of_many import fly_together
from contact_dynamics.toss.following import Following, Run
from contact_dynamics.toss.forces import pushed_by_contacts
from contact_dynamics.toss.held import Held
from contact_dynamics.toss.holding import held_in_place
from contact_dynamics.toss.impacts_of_many import strike_together
from contact_dynamics.toss.law_spread import LawSpread
from contact_dynamics.toss.one_impact import AskedImpact
from contact_dynamics.toss.phase_step import AskedStep, scales_of
from contact_dynamics.toss.solid import Solid, heights_and_rates, numbers_of, solid_of
from contact_dynamics.toss.steps_of_many import step_together
from contact_dynamics.toss.strike import approaches
from contact_dynamics.toss.together import FEWEST_IMPACTS, FEWEST_STEPS, together
from contact_dynamics.world import Body, Surface, World

COUNT = 40
SIZE = (0.1, 0.12, 0.07)


def uneven_brick(chance: np.random.Generator) -> Body:
    """No four corners are in a plane, so that rounding does not decide which comes down first."""
    vertices = box(size=SIZE).vertices + 1e-3 * chance.standard_normal((8, 3))
    return Body(
        name="brick",
        mass_properties=inertia.box(size=SIZE, mass=0.4).mass_properties,
        vertices_B=vertices,
    )


def tilted(friction: float) -> Surface:
    normal = np.array([0.05, -0.03, 1.0])
    return Surface(
        name="ramp",
        p_WS_W=[0, 0, 0],
        normal_W=normal / np.linalg.norm(normal),
        friction=friction,
        restitution=0.3,
    )


def solids(chance: np.random.Generator) -> list[Solid]:
    """Bricks and worlds that differ in all that samples differ in."""
    return [
        solid_of(uneven_brick(chance), World(surfaces=(tilted(mu),), gravity_W=[0.1, 0.2, -g]))
        for mu, g in zip(chance.uniform(0.05, 0.6, COUNT), chance.uniform(9.0, 10.0, COUNT), strict=True)
    ]


def state(chance: np.random.Generator, height: float, speed: float) -> BodyState:
    q = chance.standard_normal(4)
    return BodyState(
        p_WB_W=[0, 0, height],
        q_WB=q / np.linalg.norm(q),
        v_WB_W=chance.normal(0.0, speed, 3),
        w_WB_W=chance.normal(0.0, 5.0, 3),
    )


@pytest.mark.parametrize("law", list(RestitutionLaw))
def test_impacts_of_many_are_those_of_one_bit_for_bit(law: RestitutionLaw) -> None:
    """Corners approach, slide fast or not at all, or separate and get no impulse."""
    chance = np.random.default_rng(law)
    asked = []
    for k, solid in enumerate(solids(chance)):
        y = numbers_of(state(chance, 0.1, 1.0))
        if k % 8 == 0:
            y[7:13] = [0.0, 0.0, -1.0, 0.0, 0.0, 0.0]
        asked.append((solid, y, (0, k % 8)))
    many = [AskedImpact(*one, law) for one in asked]
    strike_together(many)
    for one, each in zip(asked, many, strict=True):
        alone = AskedImpact(*one, law)
        alone.work()
        assert alone.after == each.after
        assert alone.struck == each.struck


def test_flights_of_many_are_those_of_one() -> None:
    """Bricks fly at once or after a pause, from the air or from a corner that leaves.

    Some meet nothing. A quaternion and its opposite are one attitude.
    """
    chance = np.random.default_rng(5)
    pairs, flying = [], 0
    for k, solid in enumerate(solids(chance)):
        y = numbers_of(state(chance, 0.3, 1.0))
        if k % 3 == 0:  # a corner is on the ramp, and leaves
            height, _, (_, corner) = min(heights_and_rates(solid, y))
            y[:3] = [x - height * n for x, n in zip(y[:3], solid.flats[0].normal, strict=True)]
            y[9] += 1.0 - min(approaches(solid, y, [(0, corner)]))
        longest = 0.02 if k % 8 == 7 else 2.0
        pairs.append([flight_of(solid, y, pause=1e-6 * (k % 2), longest=longest) for _ in range(2)])
    fly_together([many for _, many in pairs])
    for alone, many in pairs:
        alone.work()
        assert many.kind == ("flight", 8)
        assert many.seconds == pytest.approx(alone.seconds, rel=0.0, abs=1e-13)
        turned = np.sign(np.dot(many.after[3:7], alone.after[3:7]))
        same = [*many.after[:3], *(turned * x for x in many.after[3:7]), *many.after[7:]]
        np.testing.assert_allclose(same, alone.after, rtol=0.0, atol=1e-12)
        flying += alone.seconds == alone.longest
    assert 3 < flying < COUNT // 2


def flight_of(solid: Solid, y: list[float], *, pause: float, longest: float) -> AskedFlight:
    return AskedFlight(
        solid,
        MassProperties(mass=solid.mass, I_B=solid.inertia),
        ConvexShape(vertices=np.array(solid.corners), rounding=solid.rounding),
        y,
        stamp_ns=0,
        longest=longest,
        pause=pause,
        search=SearchWork(),
        is_told=False,
    )


@pytest.mark.parametrize("corners", [(0,), (0, 1), (0, 7), (0, 1, 3), (0, 1, 2, 3)])
def test_steps_of_many_are_those_of_one(corners: tuple[int, ...]) -> None:
    """Only sums over stages are in another order, so numbers differ by rounding."""
    chance = np.random.default_rng(len(corners))
    mode = tuple(Held((0, corner), slides=True) for corner in corners)
    pairs = []
    for solid in solids(chance):
        if len(corners) > 3:  # on a face, so that all four touch
            solid = solid._replace(corners=tuple(map(tuple, box(size=SIZE).vertices.tolist())))  # noqa: PLW2901
        y = numbers_of(state(chance, 0.05, 1.0))
        for _ in range(30):  # from any attitude to one in which all of them touch
            y = held_in_place(solid, y, mode)
        pushed = pushed_by_contacts(solid, y, mode)
        span = float(chance.uniform(1e-4, 2e-2))
        pairs.append(
            [
                AskedStep(solid, y, pushed, mode, span=span, scales=scales_of(solid), error=1e-3)
                for _ in range(2)
            ]
        )
    assert {one.kind for one, _ in pairs} == {("step", len(corners))}
    step_together([many for _, many in pairs])
    for alone, many in pairs:
        alone.work()
        scale = max(map(abs, alone.after.rates))
        np.testing.assert_allclose(many.trial, alone.trial, rtol=0.0, atol=1e-13 * scale)
        np.testing.assert_allclose(many.stages, alone.stages, rtol=0.0, atol=1e-10 * scale)
        np.testing.assert_allclose(many.after.rates, alone.after.rates, rtol=0.0, atol=1e-10 * scale)
        size = max(np.abs(alone.after.forces).max(), 1.0)
        np.testing.assert_allclose(many.after.forces, alone.after.forces, rtol=0.0, atol=1e-10 * size)
        assert many.size == pytest.approx(alone.size, rel=1e-6, abs=1e-9)


def test_contacts_that_stick_or_begin_to_slide_go_on_alone() -> None:
    chance = np.random.default_rng(1)
    (solid, *_), y = solids(chance), numbers_of(state(chance, 0.05, 1.0))
    sliding, sticking = Held((0, 0), slides=True), Held((0, 1))
    for mode in ((sticking,), (sliding, sticking), (sliding._replace(begins=True, towards=(1.0, 0.0, 0.0)),)):
        pushed = pushed_by_contacts(solid, y, mode)
        asked = AskedStep(solid, y, pushed, mode, span=1e-3, scales=scales_of(solid), error=1e-3)
        assert asked.kind is None


def test_tosses_that_go_on_together_end_where_they_do_alone() -> None:
    """They bounce, tip, slide and rest, with different numbers of strikes and phases.

    Where a body that slides on a face tips by rounding, rounding decides which corner comes down first. That
    moved one of these places of rest by 0.07 mm.
    """
    assert max(FEWEST_IMPACTS, FEWEST_STEPS) < COUNT
    chance = np.random.default_rng(2)
    body = uneven_brick(chance)
    following = Following(
        solid_of(body, World(surfaces=(tilted(0.3),)), settling=1e-4),
        body.mass_properties,
        body.shape,
        RestitutionLaw.POISSON,
        horizon=3.0,
        max_events=300,
        error=SAMPLED_PHASE_ERROR,
        flat_after=2,
        has_pieces=False,
    )
    states = [state(chance, 0.15, 0.4) for _ in range(COUNT)]
    runs = [Run(following, each, ()) for each in states]
    together([run.go() for run in runs])
    assert sum(run.end == TossEnd.RESTS for run in runs) > COUNT // 2
    exact = 0
    for each, run in zip(states, runs, strict=True):
        alone = following.run(each, ())
        assert alone.end == run.end
        strikes = [event for event in run.events if event.kind == TossEventKind.STRIKES]
        assert len(strikes) == sum(event.kind == TossEventKind.STRIKES for event in alone.events)
        np.testing.assert_allclose(run.y, numbers_of(alone.state), atol=1e-3)
        exact += abs(run.now - alone.seconds) < 1e-7
    assert exact >= 0.9 * COUNT


def test_what_the_spread_does_to_a_sample_does_not_depend_on_which_goes_first() -> None:
    chance = np.random.default_rng(3)
    (solid, *_), y = solids(chance), numbers_of(state(chance, 0.5, 1.0))
    after = [*y[:7], *(x + 0.5 for x in y[7:])]
    changed = []
    for order in ((0, 1, 2), (2, 0, 1)):
        spread = LawSpread(TossUncertainty(velocity=0.02, spin=0.3), 3, np.random.default_rng(1))
        kicks = {i: spread.of_one(i)(solid, y, after, (0, 0)) for i in order}
        changed.append([kicks[i] for i in range(3)])
    assert changed[0] == changed[1]
    assert changed[0][0] != changed[0][1]
