"""Uncertain states through an impact: closed forms where the law is linear, counted outcomes elsewhere."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import (
    ImpactDistribution,
    ImpactOutcome,
    planar_impact,
    planar_impact_distribution,
    spatial_impact_distribution,
)
from contact_dynamics.planar import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body import BodyState, MassProperties

BODY = PlanarBody(mass=1.0, inertia=1.0)
IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def planar(
    v: tuple[float, float], deviation: list[float], contact: PlanarContact, samples: int
) -> ImpactDistribution:
    return planar_impact_distribution(
        BODY, PlanarVelocity(v=v, w=0.0), contact, covariance=np.diag(np.square(deviation)), samples=samples
    )


def test_a_linear_law_carries_the_covariance_linearly() -> None:
    """Without friction, at the centre: v_x stays, v_y is turned round by e, w stays."""
    contact = PlanarContact(r=(0.0, -1.0), normal=(0.0, 1.0), friction=0.0, restitution=0.5)
    answer = planar((0.2, -10.0), [0.3, 0.2, 0.1], contact, 40_000)
    assert answer.mean == pytest.approx([0.2, 5.0, 0.0], abs=1e-12)
    # Of a standard deviation, 40 000 draws leave 0.35 %; of a variance, twice that.
    assert np.diag(answer.covariance) == pytest.approx([0.09, 0.01, 0.01], rel=0.03)
    assert answer.probabilities[ImpactOutcome.SLIDES] == 1.0
    assert answer.missed == 0.0


def test_probabilities_are_those_of_the_threshold() -> None:
    """A particle with mu = 1/2, e = 0 sticks where |v_x| < |v_y|/2, so P = erf(0.5/(sigma sqrt 2))."""
    contact = PlanarContact(r=(0.0, 0.0), normal=(0.0, 1.0), friction=0.5, restitution=0.0)
    answer = planar((0.0, -1.0), [0.5, 0.0, 0.0], contact, 100_000)
    expected = math.erf(1.0 / math.sqrt(2.0))
    # Five standard errors.
    error = 5.0 * math.sqrt(expected * (1.0 - expected) / 100_000)
    assert answer.probabilities[ImpactOutcome.STICKS_IN_COMPRESSION] == pytest.approx(expected, abs=error)
    assert answer.probabilities[ImpactOutcome.SLIDES] == pytest.approx(1.0 - expected, abs=error)
    assert answer.probabilities.sum() + answer.missed == pytest.approx(1.0, abs=1e-12)


def test_half_of_the_draws_miss_a_contact_at_rest() -> None:
    contact = PlanarContact(r=(0.0, -1.0), normal=(0.0, 1.0), friction=0.2, restitution=0.5)
    answer = planar((0.0, 0.0), [0.0, 1.0, 0.0], contact, 1000)
    assert answer.missed == 0.5


def test_no_uncertainty_gives_the_answer_itself() -> None:
    contact = PlanarContact(r=(0.3, -1.0), normal=(0.0, 1.0), friction=0.2, restitution=0.5)
    answer = planar((0.7, -1.0), [0.0, 0.0, 0.0], contact, 2)
    single = planar_impact(BODY, PlanarVelocity(v=(0.7, -1.0), w=0.0), contact)
    assert answer.mean.tolist() == [*single.velocity.v, single.velocity.w]
    assert answer.covariance.tolist() == [[0.0] * 3] * 3
    assert answer.probabilities[single.outcome] == 1.0


def test_space_agrees_with_the_plane() -> None:
    """Uncertain only in the plane: the same distribution, within what so few draws allow."""
    contact = PlanarContact(r=(0.3, -1.0), normal=(0.0, 1.0), friction=0.3, restitution=0.5)
    flat = planar((0.6, -1.0), [0.2, 0.1, 0.3], contact, 20_000)
    covariance = np.zeros((12, 12))
    covariance[6, 6], covariance[8, 8], covariance[10, 10] = 0.04, 0.01, 0.09
    answer = spatial_impact_distribution(
        MassProperties(mass=1.0, I_B=np.eye(3)),
        BodyState(p_WB_W=np.zeros(3), q_WB=IDENTITY, v_WB_W=[0.6, 0.0, -1.0], w_WB_W=np.zeros(3)),
        covariance=covariance,
        p_WC_W=[0.3, 0.0, -1.0],
        n_W=[0.0, 0.0, 1.0],
        friction=0.3,
        restitution=0.5,
        samples=600,
    )
    # x, z, and the turn about -y.
    errors = 5.0 * np.sqrt(np.diag(flat.covariance) / 600)
    assert (abs(answer.mean[[0, 2, 4]] * [1.0, 1.0, -1.0] - flat.mean) < errors).all()
    assert answer.probabilities == pytest.approx(flat.probabilities, abs=5.0 * 0.5 / math.sqrt(600))


def test_a_tilted_pose_moves_the_contact_with_it() -> None:
    """A frictionless point mass on a stick: a tilt by x shifts the contact by h x, and so spins the body."""
    covariance = np.zeros((12, 12))
    covariance[4, 4] = 0.01**2
    answer = spatial_impact_distribution(
        MassProperties(mass=1.0, I_B=np.eye(3)),
        BodyState(p_WB_W=[0.0, 0.0, 1.0], q_WB=IDENTITY, v_WB_W=[0.0, 0.0, -1.0], w_WB_W=np.zeros(3)),
        covariance=covariance,
        p_WC_W=[0.0, 0.0, 0.0],
        n_W=[0.0, 0.0, 1.0],
        friction=0.0,
        restitution=0.0,
        samples=400,
    )
    # Tilted by x about +y the lowest point is at -x, where the impulse m v turns the body by +x v m/I.
    assert answer.covariance[4, 10] == pytest.approx(0.01**2, rel=0.3)
    assert math.sqrt(answer.covariance[10, 10]) == pytest.approx(0.01, rel=0.15)


@pytest.mark.parametrize(
    ("covariance", "samples", "text"),
    [
        (np.diag([1.0, -1.0, 1.0]), 100, "covariance"),
        ([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 100, "covariance"),
        (np.eye(2), 100, "covariance"),
        (np.eye(3), 101, "samples"),
        (np.eye(3), 0, "samples"),
    ],
)
def test_bad_input_is_refused(covariance: object, samples: int, text: str) -> None:
    contact = PlanarContact(r=(0.0, -1.0), normal=(0.0, 1.0), friction=0.0, restitution=0.5)
    with pytest.raises(InvalidFieldError, match=text):
        planar_impact_distribution(
            BODY, PlanarVelocity(v=(0.0, -1.0), w=0.0), contact, covariance=covariance, samples=samples
        )
