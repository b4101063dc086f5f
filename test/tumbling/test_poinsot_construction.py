# SPDX-License-Identifier: Apache-2.0
"""Poinsot's picture: its constants against the motion itself, its curves against the surfaces they lie on."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.body import BodyState, MassProperties, angular_momentum, rotational_energy
from contact_dynamics.rigid_body.inertia import principal_axes
from contact_dynamics.tumbling import FreeMotion, Regime, free_motion
from contact_dynamics.tumbling.poinsot_construction import (
    poinsot,
    polhode,
    polhode_period,
    rolling_curves,
    sensitivity,
)
from oracles.tumbling_draws import draw
from tumbling.known_motions import MOTIONS, motion_of

PERIODIC = [name for name in MOTIONS if math.isfinite(poinsot(motion_of(name)).polhode_period)]
CONSTANT = [name for name in MOTIONS if math.isnan(poinsot(motion_of(name)).polhode_period)]


def test_each_kind_of_motion_is_among_the_known_ones() -> None:
    assert len(PERIODIC) >= 10
    assert len(CONSTANT) >= 8
    assert set(MOTIONS) - set(PERIODIC) - set(CONSTANT) == {"separatrix", "its other branch"}


@pytest.mark.parametrize("name", MOTIONS)
def test_constants(name: str) -> None:
    motion = motion_of(name)
    picture = poinsot(motion)
    energy = rotational_energy(motion.body, motion.state)
    L_W = angular_momentum(motion.body, motion.state)
    assert picture.regime is motion.regime
    assert picture.rotational_energy == pytest.approx(energy, rel=1e-13)
    assert pytest.approx(L_W, rel=1e-13) == picture.L_W
    if motion.regime is Regime.AT_REST:
        assert math.isnan(picture.invariable_plane_distance)
    else:
        distance = 2.0 * energy / float(np.linalg.norm(L_W))
        assert picture.invariable_plane_distance == pytest.approx(distance, rel=1e-13)


@pytest.mark.parametrize("name", PERIODIC)
def test_after_a_period_the_body_rate_is_back_and_the_body_has_turned_about_L(name: str) -> None:
    motion = motion_of(name)
    picture = poinsot(motion)
    begin, end = motion.state_at(0.0), motion.state_at(picture.polhode_period)
    rounding = 1e-14 * float(np.linalg.norm(begin.w_WB_W)) + 1e-15 * picture.sensitivity
    assert end.R_WB.T @ end.w_WB_W == pytest.approx(begin.R_WB.T @ begin.w_WB_W, abs=100.0 * rounding)
    axis = picture.L_W / np.linalg.norm(picture.L_W)
    turn = Rotation.from_rotvec(picture.precession_per_period * axis)
    difference = (turn * Rotation.from_quat(begin.q_WB)).inv() * Rotation.from_quat(end.q_WB)
    assert difference.magnitude() <= 1e-13 + 1e-15 * picture.precession_per_period


@pytest.mark.parametrize("name", PERIODIC)
def test_no_shorter_time_is_a_period(name: str) -> None:
    motion = motion_of(name)
    period = poinsot(motion).polhode_period
    w_B = motion.state.R_WB.T @ motion.state.w_WB_W
    for part in (1 / 2, 1 / 3, 2 / 3):
        state = motion.state_at(part * period)
        assert np.abs(state.R_WB.T @ state.w_WB_W - w_B).max() > 1e-10


@pytest.mark.parametrize("name", CONSTANT)
def test_where_the_rate_is_constant_there_is_no_period(name: str) -> None:
    motion = motion_of(name)
    trajectory = motion.at(np.linspace(0.0, 100.0, 50))
    assert np.ptp(trajectory.w_WB_W, axis=0).max() <= 1e-13
    assert math.isnan(poinsot(motion).precession_per_period)


@pytest.mark.parametrize("name", ["separatrix", "its other branch"])
def test_the_separatrix_takes_for_ever(name: str) -> None:
    picture = poinsot(motion_of(name))
    assert picture.polhode_period == math.inf
    assert math.isnan(picture.precession_per_period)
    assert picture.sensitivity == math.inf


@pytest.mark.parametrize("name", MOTIONS)
def test_polhode_lies_on_both_ellipsoids_and_passes_the_motion(name: str) -> None:
    motion = motion_of(name)
    I_B = motion.body.I_B
    curve = polhode(motion, 4001)
    momenta = curve @ I_B
    L2 = float(np.sum(angular_momentum(motion.body, motion.state) ** 2))
    assert np.einsum("ij,ij->i", curve, momenta) == pytest.approx(
        2.0 * rotational_energy(motion.body, motion.state), rel=1e-13
    )
    assert np.einsum("ij,ij->i", momenta, momenta) == pytest.approx(L2, rel=1e-13)
    if name in PERIODIC:
        assert curve[0] == pytest.approx(curve[-1], abs=1e-14)
    for t in (0.0, 1.0, -2.7):
        state = motion.state_at(t)
        steps = np.linalg.norm(curve - state.R_WB.T @ state.w_WB_W, axis=1)
        assert steps.min() <= 1e-3 * max(1.0, float(np.abs(curve).max()))


@pytest.mark.parametrize("name", MOTIONS)
def test_curves_touch_where_the_motion_is_then(name: str) -> None:
    motion = motion_of(name)
    curves = rolling_curves(motion, 801)
    then = motion.at(curves.seconds)
    w_B = Rotation.from_quat(then.q_WB).inv().apply(then.w_WB_W)
    # Of bodies symmetric to rounding the period is some 1e16 turns, of which a double's last bit is a turn;
    # the rod spins at 3 rad/s for 2e3 rad; near the separatrix the last digit of time is felt.
    size = np.linalg.norm(w_B, axis=1).max()
    np.testing.assert_allclose(curves.polhode_B, w_B, rtol=0.0, atol=1e-9 * size)
    np.testing.assert_allclose(curves.herpolhode_W, then.w_WB_W, rtol=0.0, atol=1e-13 * size)
    assert (np.diff(curves.seconds) >= 0.0).all()
    assert curves.seconds[0] <= 0.0 <= curves.seconds[-1]
    if name in PERIODIC:
        period = poinsot(motion).polhode_period
        assert curves.seconds[-1] - curves.seconds[0] == pytest.approx(period, rel=1e-13)


def test_curves_that_take_longer_than_doubles_can_tell_are_refused() -> None:
    """Moments that nearly agree, and spin near their plane: some 1e16 turns a period."""
    drawn = draw(np.random.default_rng(2000316))
    state = BodyState(p_WB_W=np.zeros(3), q_WB=drawn.q_WB, w_WB_W=drawn.w_WB_W)
    motion = free_motion(MassProperties(mass=1.0, I_B=drawn.I_B), state)
    with pytest.raises(InvalidFieldError, match=r"rolling curves must be .*, got a period of"):
        rolling_curves(motion, 10)


def length(curve: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum())


@pytest.mark.parametrize("name", ["about the major axis", "about the minor axis", "oblate", "separatrix"])
def test_the_curves_roll_on_each_other_without_slipping(name: str) -> None:
    """Arcs are equally long; chords are shorter by 1e-4 at most, as few rows turn by more than 2 degrees."""
    curves = rolling_curves(motion_of(name), 4001)
    for part in (slice(500, 1001), slice(1500, 1700), slice(2000, 3500)):
        assert length(curves.polhode_B[part]) == pytest.approx(length(curves.herpolhode_W[part]), rel=1e-4)


@pytest.mark.parametrize("name", MOTIONS)
def test_principal_axes_are_those_of_mass_properties(name: str) -> None:
    motion = motion_of(name)
    picture, axes = poinsot(motion), principal_axes(motion.body.I_B)
    np.testing.assert_array_equal(picture.principal_moments, axes.moments)
    np.testing.assert_array_equal(picture.principal_axes_B, axes.R_BP)
    np.testing.assert_allclose(picture.I_B, motion.body.I_B, rtol=0.0, atol=1e-15)


def by_trying(motion: FreeMotion, relative: float, turned: float) -> float:
    """Return the sensitivity from three slightly different motions, at all phases of one late period."""
    state = motion.state
    size = float(np.linalg.norm(state.w_WB_W))
    times = turned / size + np.linspace(0.0, polhode_period(motion.rotation), 2001)
    base = Rotation.from_quat(motion.at(times).q_WB)
    changes = []
    for step in relative * size * np.eye(3):
        other = replace(state, w_WB_W=state.w_WB_W + step)
        attitudes = Rotation.from_quat(free_motion(motion.body, other).at(times).q_WB)
        changes.append((attitudes * base.inv()).as_rotvec())
    jacobians = np.array(changes).transpose(1, 2, 0) / relative  # rad per relative error
    return float((np.linalg.norm(jacobians, 2, axis=(1, 2)) / (times * size)).max())


@pytest.mark.parametrize(
    ("moments", "w"),
    [
        ((1.0, 1.4, 1.9), (0.3, -0.5, 1.2)),
        ((1.0, 1.4, 1.9), (-1.3, 0.5, 0.2)),
        ((1.0, 1.4, 1.9), (0.01, 1.2, 0.02)),
        ((1.0, 1.4, 1.9), (0.01, 1.2, 0.003)),
        ((0.01, 1.0, 1.005), (5.0, 0.5, 0.4)),
        ((1.0, 1.0, 1.6), (0.3, -0.5, 1.2)),
        ((0.4, 1.0, 1.0), (0.3, -0.5, 1.2)),
        ((1.0, 1.02, 1.9), (0.5, 0.8, 0.1)),
    ],
)
def test_sensitivity_is_what_errors_grow_by(moments: tuple[float, ...], w: tuple[float, ...]) -> None:
    body = MassProperties(mass=1.0, I_B=np.diag(moments))
    state = BodyState(p_WB_W=np.zeros(3), q_WB=(0.0, 0.0, 0.0, 1.0), w_WB_W=w)
    motion = free_motion(body, state)
    # After 1e5 rad what does not grow is 1e-5 of what does; steps of 1e-11 are far from nonlinear.
    assert by_trying(motion, 1e-11, 1e5) == pytest.approx(sensitivity(motion), rel=3e-3)


def test_sensitivity_of_steady_spin() -> None:
    for name in ("sphere", "sphere to rounding", "about the major axis alone", "about the minor axis alone"):
        assert sensitivity(motion_of(name)) == 1.0
    assert sensitivity(motion_of("about the middle axis")) == math.inf
    assert math.isnan(sensitivity(motion_of("at rest")))
