# SPDX-License-Identifier: Apache-2.0
"""Wrenches and drag: what they hold, what they refuse, and that they act as their formulas say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH, ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.integrated import forced_motion
from contact_dynamics.rigid_body.body import BodyState, MassProperties

UPSIDE_DOWN = (1.0, 0.0, 0.0, 0.0)  # half a turn about x
BODY = MassProperties(mass=2.0, I_B=np.diag([0.5, 0.5, 0.5]))


def accelerations(
    v: tuple[float, ...] = (0.0, 0.0, 0.0), w: tuple[float, ...] = (0.0, 0.0, 0.0), **forces: object
) -> tuple[np.ndarray, np.ndarray]:
    """The accelerations of a ball that is upside down, m/s^2 and rad/s^2, by a central difference."""
    state = BodyState(p_WB_W=np.zeros(3), q_WB=UPSIDE_DOWN, v_WB_W=v, w_WB_W=w)
    motion = forced_motion(BODY, state, gravity_W=np.zeros(3), **forces)
    before, after = motion.sample(-1e-4), motion.sample(1e-4)
    return (
        (np.array(after.v_WB_W) - np.array(before.v_WB_W)) / 2e-4,
        (np.array(after.w_WB_W) - np.array(before.w_WB_W)) / 2e-4,
    )


def test_nothing_acts_unless_it_is_said() -> None:
    assert not NO_WRENCH.force.any()
    assert not NO_WRENCH.torque.any()
    assert Drag() == NO_DRAG == Drag(linear=0.0, quadratic=0.0, linear_angular=0.0, quadratic_angular=0.0)
    for acceleration in accelerations(v=(1.0, 2.0, 3.0), w=(1.0, 2.0, 3.0)):
        np.testing.assert_allclose(acceleration, 0.0, atol=1e-10)


def test_a_wrench_is_constant_in_the_axes_it_names() -> None:
    force, torque = (2.0, 4.0, 6.0), (0.5, 1.0, 1.5)
    for axes, flip in ((WrenchAxes.WORLD, 1.0), (WrenchAxes.BODY, -1.0)):
        a, alpha = accelerations(wrench=ConstantWrench(force=force, torque=torque, axes=axes))
        np.testing.assert_allclose(a, [1.0, 2.0 * flip, 3.0 * flip], atol=1e-6)
        np.testing.assert_allclose(alpha, [1.0, 2.0 * flip, 3.0 * flip], atol=1e-6)


def test_drag_follows_its_law() -> None:
    """For v = (3, 0, -4), whose length is 5, it is -(c + q 5) v / m. The same holds for w and I."""
    v = np.array([3.0, 0.0, -4.0])
    drag = Drag(linear=0.1, quadratic=0.02, linear_angular=0.03, quadratic_angular=0.004)
    a, alpha = accelerations(v=tuple(v), w=tuple(v), drag=drag)
    np.testing.assert_allclose(a, -(0.1 + 0.02 * 5.0) / 2.0 * v, atol=1e-6)
    np.testing.assert_allclose(alpha, -(0.03 + 0.004 * 5.0) / 0.5 * v, atol=1e-6)


def test_wrenches_are_copies_that_nobody_changes() -> None:
    force = np.array([1.0, 2.0, 3.0])
    wrench = ConstantWrench(force=force)
    force[0] = 9.0
    assert wrench.force[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        wrench.force[0] = 9.0


@pytest.mark.parametrize("name", ["linear", "quadratic", "linear_angular", "quadratic_angular"])
@pytest.mark.parametrize("value", [-1e-9, math.nan, math.inf, "much", None])
def test_drag_that_drives_is_refused(name: str, value: object) -> None:
    with pytest.raises(InvalidFieldError, match=f"{name}_drag must be"):
        Drag(**{name: value})


@pytest.mark.parametrize("name", ["force", "torque"])
@pytest.mark.parametrize("value", [(1.0, 2.0), (1.0, 2.0, math.nan), (1.0, 2.0, math.inf), 3.0, "up"])
def test_wrenches_that_are_none_are_refused(name: str, value: object) -> None:
    with pytest.raises(InvalidFieldError, match=f"{name} must be"):
        ConstantWrench(**{name: value})
