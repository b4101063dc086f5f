"""Free motion of all kinds of bodies: beside an integrator that knows no elliptic functions; conservation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body import BodyState, MassProperties, angular_momentum, kinetic_energy
from contact_dynamics.tumbling import FreeMotion, Regime, free_motion
from oracles.tumbling_stepped import stepped

TURN = Rotation.from_euler("xyz", [0.3, -1.1, 2.0])
ALIGNED = Rotation.identity()
OBLIQUE = Rotation.from_euler("xyz", [-0.7, 0.4, 1.3])

MOTIONS = {
    # moments, their axes in the body, angular velocity in those axes
    "about the major axis": ((1.0, 1.4, 1.9), OBLIQUE, (0.3, -0.5, 1.2), Regime.ABOUT_MAJOR_AXIS),
    "about the opposite of it": ((1.0, 1.4, 1.9), OBLIQUE, (0.3, 0.5, -1.2), Regime.ABOUT_MAJOR_AXIS),
    "about the minor axis": ((1.0, 1.4, 1.9), OBLIQUE, (-1.3, 0.5, 0.2), Regime.ABOUT_MINOR_AXIS),
    "moments out of order": ((1.9, 1.0, 1.4), ALIGNED, (0.3, 1.5, -0.2), Regime.ABOUT_MINOR_AXIS),
    "a rod": ((0.001, 1.0, 1.0005), OBLIQUE, (3.0, 0.5, 0.4), Regime.ABOUT_MINOR_AXIS),
    "flat": ((1.0, 2.0, 3.0), OBLIQUE, (0.1, 0.2, 1.4), Regime.ABOUT_MAJOR_AXIS),
    "near the middle axis": ((1.0, 1.4, 1.9), OBLIQUE, (1e-3, 1.2, 1e-4), Regime.ABOUT_MINOR_AXIS),
    "nearer to it": ((1.0, 1.4, 1.9), OBLIQUE, (1e-4, 1.2, 1e-3), Regime.ABOUT_MAJOR_AXIS),
    "about the middle axis": ((1.0, 1.4, 1.9), ALIGNED, (0.0, -1.2, 0.0), Regime.PRINCIPAL_AXIS),
    "about the major axis alone": ((1.0, 1.4, 1.9), ALIGNED, (0.0, 0.0, 1.2), Regime.PRINCIPAL_AXIS),
    "about the minor axis alone": ((1.0, 1.4, 1.9), ALIGNED, (-1.2, 0.0, 0.0), Regime.PRINCIPAL_AXIS),
    "near the major axis": ((1.0, 1.4, 1.9), OBLIQUE, (1e-9, 0.0, 1.2), Regime.ABOUT_MAJOR_AXIS),
    "separatrix": ((3.0, 4.0, 6.0), ALIGNED, (2.0, -0.5, 1.0), Regime.SEPARATRIX),
    "its other branch": ((3.0, 4.0, 6.0), ALIGNED, (-2.0, -0.5, 1.0), Regime.SEPARATRIX),
    "sphere": ((0.7, 0.7, 0.7), ALIGNED, (0.3, -0.5, 1.2), Regime.SPHERICAL),
    "sphere to rounding": ((0.7, 0.7, 0.7), OBLIQUE, (0.3, -0.5, 1.2), Regime.SPHERICAL),
    "oblate": ((1.0, 1.0, 1.6), ALIGNED, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "oblate to rounding": ((1.0, 1.0, 1.6), OBLIQUE, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "oblate in its plane": ((1.0, 1.0, 1.6), ALIGNED, (0.3, -0.5, 0.0), Regime.AXISYMMETRIC),
    "oblate near its plane": ((1.0, 1.0, 1.6), OBLIQUE, (0.3, -0.5, 1e-9), Regime.AXISYMMETRIC),
    "prolate": ((0.4, 1.0, 1.0), ALIGNED, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "prolate to rounding": ((0.4, 1.0, 1.0), OBLIQUE, (0.3, -0.5, 1.2), Regime.AXISYMMETRIC),
    "prolate about its axis": ((0.4, 1.0, 1.0), ALIGNED, (1.2, 0.0, 0.0), Regime.AXISYMMETRIC),
    "at rest": ((1.0, 1.4, 1.9), OBLIQUE, (0.0, 0.0, 0.0), Regime.AT_REST),
}


def motion_of(name: str) -> FreeMotion:
    moments, axes, w_P, _ = MOTIONS[name]
    R_BP = axes.as_matrix()
    inertia = R_BP @ np.diag(moments) @ R_BP.T if axes is OBLIQUE else np.diag(moments)
    attitude = TURN if axes is OBLIQUE else ALIGNED  # exact numbers stay exact
    state = BodyState(
        p_WB_W=[0.1, 0.2, 1.5],
        q_WB=attitude.as_quat(),
        v_WB_W=[1.0, -0.5, 2.0],
        w_WB_W=attitude.as_matrix() @ R_BP @ np.array(w_P),
        stamp_ns=1_700_000_000_123_456_789,
    )
    return free_motion(MassProperties(mass=1.3, I_B=inertia), state)


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_agrees_with_an_integrator(name: str, direction: float) -> None:
    motion = motion_of(name)
    times = [direction * t for t in (0.0, 0.01, 1.0, 5.0, 10.0)]
    attitudes, rates = stepped(motion.body.I_B, motion.state.q_WB, motion.state.w_WB_W, times)
    trajectory = motion.at(times)
    # The integrator's tolerances, grown e^5 times where the separatrix repels.
    for i, attitude in enumerate(attitudes):
        assert (attitude.inv() * Rotation.from_quat(trajectory.q_WB[i])).magnitude() < 3e-8
    assert np.abs(trajectory.w_WB_W - rates).max() < 3e-8


@pytest.mark.parametrize("name", MOTIONS)
def test_regime_has_its_name(name: str) -> None:
    assert motion_of(name).regime is MOTIONS[name][3]


@pytest.mark.parametrize("name", MOTIONS)
def test_one_time_and_many_agree(name: str) -> None:
    motion = motion_of(name)
    times = np.concatenate([np.linspace(-50.0, 50.0, 101), [1e6, -1e9]])
    trajectory = motion.at(times)
    largest_rate = _largest_rate(motion)
    for i, t in enumerate(times.tolist()):
        one = motion.sample(t)
        sign = np.sign(trajectory.q_WB[i] @ one.q_WB)
        assert trajectory.q_WB[i] == pytest.approx(sign * np.array(one.q_WB), abs=2e-15)
        assert trajectory.w_WB_W[i] == pytest.approx(one.w_WB_W, abs=1e-15 * largest_rate)
        assert trajectory.p_WB_W[i] == pytest.approx(one.p_WB_W, rel=1e-15)
        assert trajectory.v_WB_W[i] == pytest.approx(one.v_WB_W, rel=1e-15)


@pytest.mark.parametrize("name", MOTIONS)
def test_momentum_and_energy_stay(name: str) -> None:
    motion = motion_of(name)
    L = angular_momentum(motion.body, motion.state)
    T = kinetic_energy(motion.body, _without_translation(motion.state))
    for t in (0.0, -3.7, 1e3, 1e9):
        later = motion.state_at(t)
        assert angular_momentum(motion.body, later) == pytest.approx(L, abs=1e-14 * float(np.linalg.norm(L)))
        assert kinetic_energy(motion.body, _without_translation(later)) == pytest.approx(T, rel=1e-13)


def _largest_rate(motion: FreeMotion) -> float:
    """Return |L| / I_min, by which an attitude's rounding appears in w = I^-1 L."""
    moments = np.linalg.eigvalsh(motion.body.I_B)
    return float(np.linalg.norm(angular_momentum(motion.body, motion.state)) / moments[0])


def _without_translation(state: BodyState) -> BodyState:
    return BodyState(p_WB_W=state.p_WB_W, q_WB=state.q_WB, v_WB_W=np.zeros(3), w_WB_W=state.w_WB_W)


@pytest.mark.parametrize("name", MOTIONS)
def test_begins_with_the_state(name: str) -> None:
    motion = motion_of(name)
    begin = motion.at([0.0])
    assert begin.q_WB[0] == pytest.approx(motion.state.q_WB, abs=1e-15)
    assert begin.w_WB_W[0] == pytest.approx(motion.state.w_WB_W, abs=1e-15 * _largest_rate(motion))
    assert begin.p_WB_W[0].tolist() == motion.state.p_WB_W.tolist()
    assert begin.v_WB_W[0].tolist() == motion.state.v_WB_W.tolist()


def test_centre_of_mass_flies_a_parabola() -> None:
    state = motion_of("sphere").state
    motion = free_motion(motion_of("sphere").body, state, gravity_W=(0.0, 1.0, -2.0))
    later = motion.state_at(3.0)
    assert later.p_WB_W.tolist() == [0.1 + 3.0, 0.2 - 1.5 + 4.5, 1.5 + 6.0 - 9.0]
    assert later.v_WB_W.tolist() == [1.0, -0.5 + 3.0, 2.0 - 6.0]
    assert later.stamp_ns == state.stamp_ns + 3_000_000_000


def test_quaternions_are_continuous_along_the_list_in_any_order() -> None:
    motion = motion_of("about the major axis")
    times = np.linspace(-40.0, 40.0, 4001)
    for order in (times, times[::-1]):
        q_WB = motion.at(order).q_WB
        assert (np.einsum("ij,ij->i", q_WB[1:], q_WB[:-1]) > 0.99).all()  # 0.02 s at 1.3 rad/s


def test_no_times_give_no_samples() -> None:
    trajectory = motion_of("sphere").at([])
    assert len(trajectory) == 0
    assert trajectory.q_WB.shape == (0, 4)


@pytest.mark.parametrize("bad", [[np.nan], [0.0, np.inf], [[0.0]], "now", 1.0])
def test_times_that_are_no_list_of_numbers_are_refused(bad: object) -> None:
    with pytest.raises(InvalidFieldError, match="times"):
        motion_of("sphere").at(bad)  # type: ignore[arg-type]


def test_gravity_that_is_no_vector_is_refused() -> None:
    motion = motion_of("sphere")
    with pytest.raises(InvalidFieldError, match="gravity"):
        free_motion(motion.body, motion.state, gravity_W=(0.0, 0.0))
