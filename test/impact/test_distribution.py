# SPDX-License-Identifier: Apache-2.0
"""Uncertain states through an impact: closed forms where the law is linear, counted outcomes elsewhere."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import BodyState, Contact, MassProperties, spatial_impact
from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import ImpactDistribution, ImpactOutcome, spatial_impact_distribution

BODY = MassProperties(mass=1.0, I_B=np.eye(3))
IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
FOOT = Contact(p_WC_W=[0.0, 0.0, 0.0], normal_W=[0.0, 0.0, 1.0], friction=0.2, restitution=0.5)


def in_plane(
    v: tuple[float, float], deviation: list[float], contact: Contact, samples: int, *, x: float = 0.0
) -> ImpactDistribution:
    """Return what follows a fall at x and above the contact, uncertain in v_x, v_z and the turn about y."""
    covariance = np.zeros((12, 12))
    covariance[[6, 8, 10], [6, 8, 10]] = np.square(deviation)
    state = BodyState(p_WB_W=[x, 0.0, 1.0], q_WB=IDENTITY, v_WB_W=[v[0], 0.0, v[1]])
    return spatial_impact_distribution(BODY, state, contact, covariance=covariance, samples=samples)


def test_a_linear_law_carries_the_covariance_linearly() -> None:
    """Without friction, below the centre: v_x stays, v_z is turned round by e, the turn stays."""
    answer = in_plane((0.2, -10.0), [0.3, 0.2, 0.1], replace(FOOT, friction=0.0), 40_000)
    assert answer.mean == pytest.approx([0.2, 0.0, 5.0, 0.0, 0.0, 0.0], abs=1e-12)
    # Of a standard deviation, 40 000 draws leave 0.35 %; of a variance, twice that.
    assert np.diag(answer.covariance)[[6, 8, 10]] == pytest.approx([0.09, 0.01, 0.01], rel=0.03)
    assert answer.probabilities[ImpactOutcome.SLIDES] == 1.0
    assert answer.missed == 0.0


def test_probabilities_are_those_of_the_threshold() -> None:
    """At the centre, mu = 1/2 and e = 0: it sticks where |v_x| < |v_z|/2, so P = erf(0.5/(sigma sqrt 2))."""
    contact = replace(FOOT, p_WC_W=[0.0, 0.0, 1.0], friction=0.5, restitution=0.0)
    answer = in_plane((0.0, -1.0), [0.5, 0.0, 0.0], contact, 100_000)
    expected = math.erf(1.0 / math.sqrt(2.0))
    # Five standard errors.
    error = 5.0 * math.sqrt(expected * (1.0 - expected) / 100_000)
    assert answer.probabilities[ImpactOutcome.STICKS_IN_COMPRESSION] == pytest.approx(expected, abs=error)
    assert answer.probabilities[ImpactOutcome.SLIDES] == pytest.approx(1.0 - expected, abs=error)
    assert answer.probabilities.sum() + answer.missed == pytest.approx(1.0, abs=1e-12)


def test_half_of_the_draws_miss_a_contact_at_rest() -> None:
    assert in_plane((0.0, 0.0), [0.0, 1.0, 0.0], FOOT, 1000).missed == 0.5


def test_no_uncertainty_gives_the_answer_itself() -> None:
    answer = in_plane((0.7, -1.0), [0.0, 0.0, 0.0], FOOT, 2, x=-0.3)
    state = BodyState(p_WB_W=[-0.3, 0.0, 1.0], q_WB=IDENTITY, v_WB_W=[0.7, 0.0, -1.0])
    single = spatial_impact(BODY, state, FOOT)
    assert answer.mean.tolist() == [*single.state.v_WB_W, *single.state.w_WB_W]
    assert not answer.covariance.any()
    assert answer.probabilities[single.outcome] == 1.0


def test_rounding_errors_of_equal_variances_change_next_to_nothing() -> None:
    """The axes of equal variances are arbitrary, and a rounding error turns them by radians."""
    state = BodyState(p_WB_W=[-0.3, 0.0, 1.0], q_WB=IDENTITY, v_WB_W=[0.7, 0.0, -1.0])
    rounding = np.random.default_rng(0).normal(size=(12, 12)) * 1e-16
    one, other = (
        spatial_impact_distribution(BODY, state, FOOT, covariance=covariance, samples=200)
        for covariance in (0.01 * np.eye(12), 0.01 * np.eye(12) + rounding + rounding.T)
    )
    assert other.mean == pytest.approx(one.mean, abs=1e-12)
    assert other.covariance == pytest.approx(one.covariance, abs=1e-13)


def test_a_tilted_pose_moves_the_contact_with_it() -> None:
    """A frictionless point mass on a stick: a tilt by x shifts the contact by h x, and so spins the body."""
    covariance = np.zeros((12, 12))
    covariance[4, 4] = 0.01**2
    answer = spatial_impact_distribution(
        MassProperties(mass=1.0, I_B=np.eye(3)),
        BodyState(p_WB_W=[0.0, 0.0, 1.0], q_WB=IDENTITY, v_WB_W=[0.0, 0.0, -1.0]),
        Contact(p_WC_W=[0.0, 0.0, 0.0], normal_W=[0.0, 0.0, 1.0], friction=0.0, restitution=0.0),
        covariance=covariance,
        samples=400,
    )
    # Tilted by x about +y the lowest point is at -x, where the impulse m v turns the body by +x v m/I.
    assert answer.covariance[4, 10] == pytest.approx(0.01**2, rel=0.3)
    assert math.sqrt(answer.covariance[10, 10]) == pytest.approx(0.01, rel=0.15)


def test_agrees_with_plain_monte_carlo() -> None:
    """Independent draws, one call each, counted, whose contact point moves with the pose."""
    body = MassProperties(mass=0.5, I_B=np.diag([0.02, 0.03, 0.04]))
    quaternion = np.array([0.1, -0.2, 0.3, math.sqrt(0.86)])
    state = BodyState(
        p_WB_W=[0.1, 0.2, 0.3], q_WB=quaternion, v_WB_W=[0.4, -0.1, -0.5], w_WB_W=[1.0, -0.5, 0.3]
    )
    arm = np.array([0.1, -0.05, -0.3])
    contact = Contact(p_WC_W=state.p_WB_W + arm, normal_W=[0.0, 0.0, 1.0], friction=0.35, restitution=0.4)
    spread = np.array([0.01] * 3 + [0.1, 0.15, 0.1] + [0.3, 0.3, 0.3] + [0.5, 0.5, 0.5])
    mixing = np.random.default_rng(3).normal(size=(12, 12)) * 0.2 + np.eye(12)
    covariance = (spread[:, None] * mixing) @ (spread[:, None] * mixing).T
    answer = spatial_impact_distribution(body, state, contact, covariance=covariance, samples=20_000)
    draws = np.random.default_rng(98).multivariate_normal(np.zeros(12), covariance, size=1500)
    after, counts = np.empty((1500, 6)), np.zeros(len(ImpactOutcome))
    for i, draw in enumerate(draws):
        turn = Rotation.from_rotvec(draw[3:6])
        drawn = BodyState(
            p_WB_W=state.p_WB_W + draw[:3],
            q_WB=(turn * Rotation.from_quat(quaternion)).as_quat(),
            v_WB_W=state.v_WB_W + draw[6:9],
            w_WB_W=state.w_WB_W + draw[9:],
        )
        try:
            moved = replace(contact, p_WC_W=drawn.p_WB_W + turn.apply(arm))
            single = spatial_impact(body, drawn, moved)
        except SeparatingContactError:
            after[i] = [*drawn.v_WB_W, *drawn.w_WB_W]
            continue
        after[i] = [*single.state.v_WB_W, *single.state.w_WB_W]
        counts[single.outcome] += 1
    assert np.count_nonzero(counts > 50) >= 3
    compare(answer, after, np.concatenate((draws[:, :6], after), axis=1), counts)


def compare(answer: ImpactDistribution, after: np.ndarray, whole: np.ndarray, counts: np.ndarray) -> None:
    """Compare within five standard errors of the plain draws, which are fewer.

    A variance's standard error is sqrt(2/n) of it for a normal distribution; ours have heavier tails, so that
    a covariance is allowed ten.
    """
    count = len(after)
    deviations = after.std(axis=0)
    assert (abs(answer.mean - after.mean(axis=0)) <= 5.0 * deviations / math.sqrt(count)).all()
    sizes = whole.std(axis=0)
    difference = abs(answer.covariance - np.cov(whole, rowvar=False)) / np.outer(sizes, sizes)
    assert difference.max() <= 10.0 / math.sqrt(count)
    shares = counts / count
    errors = np.sqrt(np.maximum(shares * (1.0 - shares), 1.0 / count) / count)
    assert (abs(answer.probabilities - shares) <= 5.0 * errors).all()
    assert answer.missed == pytest.approx(1.0 - shares.sum(), abs=5.0 * 0.5 / math.sqrt(count))
