# SPDX-License-Identifier: Apache-2.0
"""Samples of tosses, held against single tosses, against what follows by hand, and against frequencies."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.rigid_body.body import BodyState, state_covariance
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.toss import TossDistribution, TossEventKind, TossUncertainty, sampled_toss, toss
from contact_dynamics.toss.distribution import BranchKind, region_of, region_of_face
from contact_dynamics.toss.law_spread import LawSpread
from contact_dynamics.toss.next_strikes import FEWEST_AT_ONCE, SampleEnd, next_strikes
from contact_dynamics.toss.solid import solid_of
from contact_dynamics.toss.uncertainty import EXACT, draw
from contact_dynamics.world import Body, Surface, World
from sweeps import seeds

SIZE = (0.1, 0.12, 0.07)
BRICK = Body.box(SIZE, mass=0.4, name="brick")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.2, restitution=0.4)
WORLD = World(bodies=(BRICK,), surfaces=(FLOOR,))


def thrown(seed: int) -> BodyState:
    """A brick in the air, turning."""
    chance = np.random.default_rng(seed)
    q = chance.standard_normal(4)
    return BodyState(
        p_WB_W=[0, 0, 0.3],
        q_WB=q / np.linalg.norm(q),
        v_WB_W=chance.normal(0.0, 0.7, 3),
        w_WB_W=chance.normal(0.0, 5.0, 3),
    )


def told(state: BodyState, count: int = 200, **given: object) -> TossDistribution:
    return sampled_toss(
        BRICK, state, WORLD, count=count, restitution_law=RestitutionLaw.POISSON, horizon=5.0, **given
    )  # type: ignore[arg-type]


@seeds(range(6))
def test_exact_samples_strike_as_the_toss_does(seed: int) -> None:
    """Corner, time and velocities of the next strikes, as the closed form and the single impact have them.

    Arrivals are found to 1e-7 m, which at 1 m/s is 1e-7 s. A strike that follows moves them some ten times.
    """
    state = thrown(seed)
    solid = solid_of(BRICK, WORLD)
    chance = np.random.default_rng(0)
    samples = draw(BRICK, state, WORLD, covariance=None, uncertainty=EXACT, count=2, chance=chance)
    many = next_strikes(
        solid, samples, law=RestitutionLaw.POISSON, spread=LawSpread(EXACT, 2, chance), depth=3, horizon=5.0
    )
    events = toss(BRICK, state, WORLD, max_alternatives=0).events
    strikes = [event for event in events if event.kind == TossEventKind.STRIKES]
    followed = int((many.corners[:, 0] >= 0).sum())
    assert followed == 3 or many.ends[0] == SampleEnd.STAYS
    assert followed >= 1
    for k in range(followed):
        assert many.corners[k, 0] == strikes[k].corners[0]
        assert many.seconds[k, 0] == pytest.approx(strikes[k].seconds, abs=1e-5)
        np.testing.assert_allclose(many.states[k, 0, 7:10], strikes[k].state.v_WB_W, atol=1e-4)
        np.testing.assert_allclose(many.states[k, 0, 10:], strikes[k].state.w_WB_W, atol=2e-3)
    np.testing.assert_array_equal(many.states[:followed, 0], many.states[:followed, 1])


def test_samples_that_go_on_together_are_where_the_strikes_would_have_them() -> None:
    """Their last states are those after the last strikes, told of or not; rows of batches are bit for bit."""
    state, solid = thrown(3), solid_of(BRICK, WORLD)
    covariance = np.diag([1e-3] * 3 + [0.02] * 3 + [0.02] * 3 + [0.3] * 3) ** 2
    chance = np.random.default_rng(0)
    samples = draw(BRICK, state, WORLD, covariance=covariance, uncertainty=EXACT, count=60, chance=chance)
    spread = LawSpread(EXACT, 60, chance)
    one, all_told = (
        next_strikes(
            solid,
            samples._replace(restitutions=np.full_like(samples.restitutions, 0.9)),
            law=RestitutionLaw.POISSON,
            spread=spread,
            depth=depth,
            horizon=0.8,
            further=further,
        )
        for depth, further in ((1, True), (40, False))
    )
    assert (all_told.corners[1] >= 0).sum() >= FEWEST_AT_ONCE
    np.testing.assert_array_equal(one.corners[0], all_told.corners[0])
    # The first goes on as long as there are enough, so at least as far as the strikes that all of these have.
    rounds = int(((all_told.corners >= 0).sum(axis=1) >= FEWEST_AT_ONCE).sum())
    assert rounds >= 2
    for i in np.flatnonzero((all_told.corners >= 0).sum(axis=0) < rounds):
        assert one.now[i] == all_told.now[i]
        np.testing.assert_array_equal(one.last[i], all_told.last[i])
    assert (one.now > one.seconds[0]).sum() >= FEWEST_AT_ONCE


def test_the_time_of_a_strike_is_as_uncertain_as_height_over_speed() -> None:
    """A brick that does not turn falls onto a corner: dt = dz / v, with v^2 = 2 g h."""
    q = np.array([0.3, 0.5, 0.1, 0.8])
    state = BodyState(p_WB_W=[0, 0, 0.5], q_WB=q / np.linalg.norm(q))
    covariance = np.zeros((12, 12))
    covariance[2, 2] = 1e-3**2
    first = told(state, 2000, covariance=covariance, strikes=1).strikes[0]
    drop = float((state.p_WB_W + BRICK.vertices_B @ state.R_WB.T)[:, 2].min())
    expected = 1e-3 / math.sqrt(2.0 * 9.80665 * drop)
    deviation = math.sqrt(first.seconds.covariance[0, 0])
    assert deviation == pytest.approx(expected, rel=0.06)  # of 2000 samples, four standard errors
    # Half of normal numbers are within 0.674 deviations, nine tenths within 1.645; of 2000, to some 5 %.
    np.testing.assert_allclose(first.seconds.radii, [0.674, 1.645], rtol=0.08)


def test_the_spread_of_the_law_is_that_of_velocities_after_a_strike() -> None:
    first = told(thrown(1), 2000, strikes=1, uncertainty=TossUncertainty(velocity=0.02, spin=0.3)).strikes[0]
    # The corner leaves fast, so that few are turned back. The median distance is that of normal residuals,
    # 1.538 deviations. Nine tenths are within 0.888 sqrt(3 F(3, 3)) = 3.57, and normal ones within 2.50.
    for region, size in ((first.velocity, 0.02), (first.spin, 0.3)):
        deviations = np.sqrt(np.trace(region.covariance) / 3.0) * region.radii / size
        np.testing.assert_allclose(deviations, [1.538, 3.57], rtol=0.12)  # of 2000 samples with heavy tails
    assert first.seconds.covariance[0, 0] < 1e-20


def test_corners_that_are_not_where_the_shape_has_them_make_the_time_uncertain() -> None:
    """A brick falls on a corner whose ray has the cosine c to the normal, so that dt = c dr / v."""
    q = np.array([0.3, 0.5, 0.1, 0.8])
    state = BodyState(p_WB_W=[0, 0, 0.5], q_WB=q / np.linalg.norm(q))
    first = told(state, 2000, strikes=1, uncertainty=TossUncertainty(height=1e-3)).strikes[0]
    corner = min((BRICK.vertices_B @ state.R_WB.T).tolist(), key=lambda point: point[2])
    cosine = -corner[2] / math.hypot(*corner)
    speed = math.sqrt(2.0 * 9.80665 * (0.5 + corner[2]))
    deviation = math.sqrt(first.seconds.covariance[0, 0])
    assert deviation == pytest.approx(1e-3 * cosine / speed, rel=0.07)  # four standard errors


def test_no_sample_goes_on_into_the_floor() -> None:
    """A spread as large as the speeds would send corners into the flat."""
    many = TossUncertainty(velocity=1.0, spin=10.0)
    state, solid, chance = thrown(2), solid_of(BRICK, WORLD), np.random.default_rng(3)
    samples = draw(BRICK, state, WORLD, covariance=None, uncertainty=EXACT, count=200, chance=chance)
    found = next_strikes(
        solid, samples, law=RestitutionLaw.POISSON, spread=LawSpread(many, 200, chance), depth=1, horizon=5.0
    )
    arms = np.einsum(
        "nij,nj->ni",
        matrices_of(found.states[0, :, 3:7]),
        samples.corners_B[np.arange(200), found.corners[0]],
    )
    rebounds = (found.states[0, :, 7:10] + np.cross(found.states[0, :, 10:], arms))[:, 2]
    assert rebounds.min() >= -1e-12
    assert np.median(rebounds) > 0.1


def test_uncertain_parameters_show_after_the_strike_and_not_before() -> None:
    """Friction, restitution and inertia play no part in a flight without torque; a mass centre does."""
    exact = told(thrown(4), strikes=1).strikes[0]
    some = np.zeros((6, 6))
    some[[0, 1, 5], [0, 1, 5]] = 0.05**2
    first = told(thrown(4), strikes=1, uncertainty=TossUncertainty(covariance=some)).strikes[0]
    assert first.seconds.covariance[0, 0] < 1e-18
    assert first.seconds.mean == pytest.approx(exact.seconds.mean, abs=1e-9)
    assert np.trace(first.velocity.covariance) > 1e-4
    some[:] = 0.0
    some[[2, 3, 4], [2, 3, 4]] = 0.002**2
    moved = told(thrown(4), strikes=1, uncertainty=TossUncertainty(covariance=some)).strikes[0]
    # The body's points are where they were. Their path is that of another mass centre: it differs by
    # d (1 - cos) of the angle turned, and by d w t - d sin, which are much smaller than d.
    assert 0.0 < math.sqrt(moved.position.covariance[2, 2]) < 2.5 * 0.002


def test_the_tree_has_all_samples_at_each_depth() -> None:
    found = told(thrown(5), 300, covariance=np.diag([1e-2] * 3 + [0.1] * 3 + [0.1] * 3 + [1.0] * 3) ** 2)
    for strike in (1, 2):
        level = [branch for branch in found.branches if branch.strike == strike]
        ended = [b for b in found.branches if b.strike < strike and b.kind != BranchKind.STRIKES]
        assert sum(branch.probability for branch in (*level, *ended)) == pytest.approx(1.0)
    assert len(found.branches) > 4
    for branch in found.branches:
        assert (branch.regions is None) == (
            branch.kind != BranchKind.STRIKES or branch.probability * 300 < 19.5
        )
        if branch.parent >= 0:
            assert found.branches[branch.parent].strike == branch.strike - 1
            assert found.branches[branch.parent].kind == BranchKind.STRIKES


def test_a_region_has_the_share_of_samples_that_it_says() -> None:
    chance = np.random.default_rng(1)
    values = chance.gamma(1.5, size=(400, 3)) @ chance.standard_normal((3, 3))
    held = region_of(values).holds(values).mean(axis=0)
    np.testing.assert_allclose(held, [0.5, 0.9], atol=1.0 / 400)
    flat = values.copy()
    flat[:, 2] = 0.25  # exact: no distance is lost by it, and what is off it is outside
    region = region_of(flat)
    np.testing.assert_allclose(region.holds(flat).mean(axis=0), [0.5, 0.9], atol=1.0 / 400)
    above = region.mean + np.array([0.0, 0.0, 1e-3])
    assert not region.holds(above).any()
    assert region.holds(above, noise=2e-3).all()
    assert region.distances(above, noise=[0.0, 0.0, 2e-3])[0] == pytest.approx(0.5)
    with pytest.raises(InvalidFieldError, match="values must be of shape"):
        region.holds([0.1, 0.2])
    with pytest.raises(InvalidFieldError, match=r"noise\[0\] must be >= 0"):
        region.holds(above, noise=-1.0)


def test_a_region_of_too_few_samples_says_so() -> None:
    region = region_of_face(np.random.default_rng(2).standard_normal((19, 3)))
    with pytest.raises(NotSupportedError, match="at least 20 samples"):
        region.holds(region.mean)


def test_the_same_seed_draws_the_same_samples() -> None:
    given = {"covariance": 1e-4 * np.eye(12), "uncertainty": TossUncertainty(velocity=0.02, spin=0.3)}
    one, same, other = (told(thrown(6), 40, seed=seed, **given) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.ghosts.p_WB_W, same.ghosts.p_WB_W)
    assert not np.array_equal(one.ghosts.p_WB_W[:10], other.ghosts.p_WB_W[:10])


def test_a_brick_on_its_edge_falls_to_either_side() -> None:
    """It is let go at rest on a long edge, the mass centre above it, and knows its tilt to a tenth."""
    y, z = 0.06, 0.035
    tilt = 0.5 * math.atan2(y, z)
    state = BodyState(p_WB_W=[0, 0, math.hypot(y, z) + 1e-3], q_WB=[math.sin(tilt), 0, 0, math.cos(tilt)])
    covariance = np.zeros((12, 12))
    covariance[3, 3] = 0.1**2
    found = told(state, 30, covariance=covariance, to_rest=True)
    assert len(found.face_probabilities) == 2
    assert found.face_probabilities.sum() == pytest.approx(1.0)
    assert found.face_probabilities.min() > 0.25  # half and half; of 60, four standard errors are 0.26
    normals = np.abs(found.face_normals_B).round(6)
    assert sorted(normals.tolist()) == [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
    assert found.rest is not None
    assert (np.diff(found.rest.seconds) >= 0.0).all()
    assert set(found.ghosts.strikes.tolist()) == {0, 1, 2}


def test_friction_that_lasts_stops_what_slides_and_strikes_have_their_own() -> None:
    """A brick that slides flush stops after v^2 / (2 mu g); a strike before has the friction of strikes."""
    flush = BodyState(p_WB_W=[0, 0, 0.035], q_WB=[0, 0, 0, 1], v_WB_W=[0.6, 0, 0])
    lasting = TossUncertainty(lasting_factors=[1.5], lasting_factor_stds=[0.1])
    found = told(flush, 300, to_rest=True, uncertainty=lasting).rest
    assert found is not None
    # Quantiles of 1 / factor are those of normal factors, the other way round.
    normal = np.array([1.645, 0.674, 0.0, -0.674, -1.645])
    expected = 0.6**2 / (2.0 * 9.80665 * 0.2 * (1.5 + 0.1 * normal))
    np.testing.assert_allclose(found.positions[:, 0], expected, rtol=0.03)  # of 300, four standard errors
    same, other = (told(thrown(1), strikes=1, uncertainty=each).strikes[0] for each in (EXACT, lasting))
    np.testing.assert_array_equal(same.velocity.mean, other.velocity.mean)
    went = toss(BRICK, flush, WORLD, lasting_factors=[1.5])
    assert went.state.p_WB_W[0] == pytest.approx(0.6**2 / (2.0 * 9.80665 * 0.3), rel=1e-4)


def test_a_surface_has_a_factor_of_its_own_that_a_list_replaces() -> None:
    flush = BodyState(p_WB_W=[0, 0, 0.035], q_WB=[0, 0, 0, 1], v_WB_W=[0.6, 0, 0])
    world = World(surfaces=(replace(FLOOR, lasting_factor=1.5),))
    for factors, factor in (((), 1.5), ([0.5], 0.5)):
        end = 0.6**2 / (2.0 * 9.80665 * 0.2 * factor)
        went = toss(BRICK, flush, world, lasting_factors=factors)
        assert went.state.p_WB_W[0] == pytest.approx(end, rel=1e-4)
        found = sampled_toss(
            BRICK,
            flush,
            world,
            uncertainty=TossUncertainty(lasting_factors=factors),
            count=2,
            to_rest=True,
            restitution_law=RestitutionLaw.POISSON,
            horizon=3.0,
        )
        assert found.rest is not None
        np.testing.assert_allclose(found.rest.positions[:, 0], end, rtol=1e-3)


def test_deviations_make_the_covariance_and_errors_come_in_arrays() -> None:
    covariance = state_covariance(position=0.002, velocity=0.05)
    np.testing.assert_array_equal(np.diag(covariance), [4e-6] * 3 + [0.0] * 3 + [0.05**2] * 3 + [0.0] * 3)
    found = told(thrown(1), covariance=covariance, to_rest=True)
    shares = found.face_probabilities
    by_hand = np.sqrt(shares * (1.0 - shares) / 200)
    np.testing.assert_allclose(found.standard_error(shares), by_hand, rtol=1e-14)
    with pytest.raises(InvalidFieldError, match=r"\(12, 12\), as rigid_body\.state_covariance makes one"):
        told(thrown(1), covariance=[0.002, 0.0, 0.05, 0.0])


@pytest.mark.parametrize("to_rest", [False, True])
def test_without_surfaces_all_samples_fly(*, to_rest: bool) -> None:
    found = sampled_toss(BRICK, thrown(1), World(bodies=(BRICK,)), count=20, horizon=1.0, to_rest=to_rest)
    assert [(branch.kind, branch.probability) for branch in found.branches] == [(BranchKind.FLIES, 1.0)]
