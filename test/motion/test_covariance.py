# SPDX-License-Identifier: Apache-2.0
"""Covariances along free motions: two methods beside each other, known cases, and where not to trust them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import BodyState, MassProperties, free_motion
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion import CarriedCovariance, ConstantWrench, Drag, PropagationMethod, WrenchAxes
from contact_dynamics.motion.covariance import covariance_along, propagate_covariance
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.motion.integrated import forced_motion
from tumbling.known_motions import MOTIONS, motion_of

TIMES = np.array([0.0, 0.1, 1.0, 5.0, -3.0])
SPHERE = MassProperties(mass=2.0, I_B=0.4 * np.eye(3))


def drawn_covariance(seed: int, deviation: float) -> np.ndarray:
    """A covariance with correlations of all parts, and one deviation for every number."""
    rng = np.random.default_rng(seed)
    factor = rng.normal(size=(12, 12)) + 2.0 * np.eye(12)
    covariance = factor @ factor.T
    scale = deviation / np.sqrt(covariance.diagonal())
    return covariance * np.outer(scale, scale)


def apart(one: CarriedCovariance, other: CarriedCovariance) -> np.ndarray:
    """The largest difference of entries beside the product of the deviations that they belong to, (n,)."""
    scale = np.sqrt(np.einsum("nii->ni", one.covariances))
    unit = scale[:, :, None] * scale[:, None, :]
    return (np.abs(one.covariances - other.covariances) / unit).max(axis=(1, 2))


@pytest.mark.parametrize("name", sorted(MOTIONS))
def test_small_clouds_move_as_the_derivative_says(name: str) -> None:
    """The draws have the covariance exactly, so what is left is curvature, deviations squared."""
    motion, covariance = motion_of(name), drawn_covariance(1, 1e-5)
    linearised = covariance_along(motion, covariance, TIMES)
    sampled = covariance_along(motion, covariance, TIMES, method=PropagationMethod.SAMPLED, samples=60)
    assert linearised.method is PropagationMethod.LINEARISED
    assert sampled.method is PropagationMethod.SAMPLED
    assert apart(linearised, sampled).max() < 3e-6
    assert linearised.trusted.all()


def test_uncertain_gravity_counts_in_the_fit_and_in_the_flight() -> None:
    """As the difference of two fits to the same poses, each under its own gravity, flown on under that."""
    motion, pull, ahead = motion_of("flat"), np.array([0.3, -0.2, 0.1]), 0.4
    states = [motion.state_at(seconds) for seconds in np.linspace(0.0, 0.2, 9)]
    fits = [
        fit_free_motion(motion.body, states, gravity_W=motion.gravity_W + each) for each in (0.0 * pull, pull)
    ]
    one, other = (
        free_motion(motion.body, fit.state, gravity_W=motion.gravity_W + each).state_at(ahead)
        for fit, each in zip(fits, (0.0 * pull, pull), strict=True)
    )
    assert fits[0].by_gravity is not None
    exact, uncertain = (
        propagate_covariance(
            motion.body,
            fits[0].state,
            np.zeros((12, 12)),
            [ahead],
            gravity_W=motion.gravity_W,
            gravity_covariance_W=covariance,
            by_gravity=fits[0].by_gravity,
        ).covariances[0]
        for covariance in (None, np.outer(pull, pull))
    )
    assert not exact.any()
    off = np.zeros(12)
    off[0:3], off[6:9] = other.p_WB_W - one.p_WB_W, other.v_WB_W - one.v_WB_W
    np.testing.assert_allclose(uncertain, np.outer(off, off), rtol=1e-6, atol=1e-12)
    with pytest.raises(InvalidFieldError, match="gravity_covariance_W"):
        propagate_covariance(
            motion.body, fits[0].state, np.zeros((12, 12)), [ahead], gravity_covariance_W=-np.eye(3)
        )


@pytest.mark.parametrize("name", sorted(MOTIONS))
def test_where_linearisation_is_trusted_it_may_be(name: str) -> None:
    motion, times = motion_of(name), np.linspace(-15.0, 15.0, 31)
    linearised = covariance_along(motion, drawn_covariance(2, 1e-2), times)
    sampled = covariance_along(
        motion, drawn_covariance(2, 1e-2), times, method=PropagationMethod.SAMPLED, samples=150
    )
    trusted = linearised.trusted
    assert 3 < trusted.sum() < 31
    largest = sampled.orientation_deviations[trusted] / linearised.orientation_deviations[trusted]
    np.testing.assert_allclose(largest, 1.0, rtol=0.0, atol=0.01)
    assert apart(linearised, sampled)[trusted].max() < 1.0 / 3.0


def test_a_cloud_near_the_separatrix_is_lost_and_said_to_be() -> None:
    motion = motion_of("near the middle axis")
    times = np.linspace(0.0, 60.0, 61)
    linearised = covariance_along(motion, drawn_covariance(3, 1e-2), times)
    sampled = covariance_along(
        motion, drawn_covariance(3, 1e-2), times, method=PropagationMethod.SAMPLED, samples=100
    )
    lost = ~linearised.trusted
    assert (np.diff(lost.astype(int)) >= 0).all()
    assert lost[-1]
    assert linearised.orientation_deviations.max() > 10.0
    # Of orientations that are anywhere the root mean square angle is 2.2 rad, some 1.3 about each axis.
    assert sampled.orientation_deviations.max() < math.pi
    assert not sampled.trusted[-1]


@pytest.mark.parametrize("drag", [None, Drag(linear=1e-3)])
def test_once_lost_stays_lost_although_it_comes_near_again(drag: Drag | None) -> None:
    """Neighbours of a steady spin nutate: they part, and after a period are where they were.

    Drag that turns nothing changes nothing of it.
    """
    free = motion_of("about the minor axis alone")
    motion = free if drag is None else forced_motion(free.body, free.state, drag=drag)
    covariance = np.zeros((12, 12))
    covariance[3:6, 3:6] = 0.08**2 * np.eye(3)
    times = np.linspace(0.0, 50.0, 401)
    carried = covariance_along(motion, covariance, times)
    first = int(np.argmin(carried.trusted))
    assert first > 0
    near = carried.orientation_deviations[first:] < 0.1
    assert near.any()
    assert not carried.trusted[first:].any()
    # Asked for alone, the late times are no more trusted.
    assert not covariance_along(motion, covariance, times[first:][near]).trusted.any()


FORCED = forced_motion(
    MassProperties(mass=1.3, I_B=np.diag([1.0, 1.4, 1.9])),
    BodyState(
        p_WB_W=[0.1, 0.2, 1.5], q_WB=[0.5, 0.5, 0.5, 0.5], v_WB_W=[3.0, 0.0, 2.0], w_WB_W=[0.9, -1.4, 0.6]
    ),
    wrench=ConstantWrench(torque=[0.2, -0.1, 0.3], force=[1.0, 0.0, 0.0], axes=WrenchAxes.BODY),
    drag=Drag(linear=0.2, quadratic=0.1, linear_angular=0.05, quadratic_angular=0.1),
)
"""With every kind of force, and a covariance that fades in parts and grows in others."""


@pytest.mark.parametrize(("deviation", "limit"), [(1e-5, 3e-6), (1e-2, 0.05)])
def test_under_forces_clouds_move_as_the_derivative_says(deviation: float, limit: float) -> None:
    """What is left is curvature: deviations, in the square with what a flow of this kind bends, some 3."""
    times = [0.0, 0.5, 3.0, -0.3]
    linearised = covariance_along(FORCED, drawn_covariance(1, deviation), times)
    sampled = covariance_along(
        FORCED, drawn_covariance(1, deviation), times, method=PropagationMethod.SAMPLED, samples=60
    )
    assert apart(linearised, sampled).max() < limit
    assert linearised.trusted.all()


def test_a_sphere_and_its_place() -> None:
    """Only rates and what they are rates of are coupled. Turning errors about the spin's axis add up."""
    w, t = np.array([0.0, 0.0, 2.0]), 3.0
    state = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], w_WB_W=w)
    deviations = np.repeat([1e-3, 2e-3, 3e-3, 4e-3], 3)
    carried = propagate_covariance(SPHERE, state, np.diag(deviations**2), [t]).covariances[0]
    place = carried[np.ix_([0, 6], [0, 6])]
    expected = np.array([[1e-6 + t * t * 9e-6, t * 9e-6], [t * 9e-6, 9e-6]])
    np.testing.assert_allclose(place, expected, rtol=1e-12)
    turn = carried[np.ix_([5, 11], [5, 11])]
    expected = np.array([[4e-6 + t * t * 16e-6, t * 16e-6], [t * 16e-6, 16e-6]])
    np.testing.assert_allclose(turn, expected, rtol=1e-12)
    # An error of attitude is carried round by the spin and stays as large; one of the rate, d across w, leads
    # to the integral of Exp(w s) d, which is 2 sin(w t / 2) d / w long.
    across = 4e-6 + 16e-6 * (2.0 * math.sin(w[2] * t / 2.0) / w[2]) ** 2
    np.testing.assert_allclose(carried[3, 3], across, rtol=1e-12)
    np.testing.assert_allclose(carried[9, 9], 16e-6, rtol=1e-12)


@pytest.mark.parametrize("method", list(PropagationMethod))
def test_no_uncertainty_stays_none(method: PropagationMethod) -> None:
    carried = covariance_along(motion_of("flat"), np.zeros((12, 12)), TIMES, method=method)
    np.testing.assert_allclose(carried.covariances, 0.0, rtol=0.0, atol=1e-28)  # rounding, squared
    assert carried.trusted.all()


@pytest.mark.parametrize("method", list(PropagationMethod))
def test_covariances_are_symmetric_and_not_negative(method: PropagationMethod) -> None:
    rank_one = np.outer(np.arange(12.0), np.arange(12.0)) * 1e-8
    carried = covariance_along(motion_of("a rod"), rank_one, TIMES, method=method)
    np.testing.assert_array_equal(carried.covariances, carried.covariances.transpose(0, 2, 1))
    lowest = np.linalg.eigvalsh(carried.covariances)[:, 0]
    assert (lowest >= -1e-14 * np.trace(carried.covariances, axis1=1, axis2=2)).all()
    np.testing.assert_allclose(carried.covariances[0], rank_one, rtol=0.0, atol=1e-15)


def test_what_no_double_holds_is_not_trusted() -> None:
    carried = covariance_along(motion_of("about the middle axis"), drawn_covariance(4, 1e-6), [1.0, 1e6])
    assert carried.trusted.tolist() == [True, False]
    assert carried.orientation_deviations[1] == math.inf


def test_too_few_samples_are_refused() -> None:
    with pytest.raises(InvalidFieldError, match="samples"):
        covariance_along(motion_of("flat"), np.eye(12), TIMES, method=PropagationMethod.SAMPLED, samples=10)
