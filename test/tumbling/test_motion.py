# SPDX-License-Identifier: Apache-2.0
"""Free motion of all kinds of bodies: many times at once, gravity, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics.rigid_body.body import BodyState, MassProperties, angular_momentum
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion
from tumbling.known_motions import MOTIONS, motion_of


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


def _largest_rate(motion: FreeMotion) -> float:
    """Return |L| / I_min, by which an attitude's rounding appears in w = I^-1 L."""
    moments = np.linalg.eigvalsh(motion.body.I_B)
    return float(np.linalg.norm(angular_momentum(motion.body, motion.state)) / moments[0])


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


def test_a_state_seen_before_is_answered_alike_and_no_other_is_taken_for_it() -> None:
    body = MassProperties(mass=1.0, I_B=np.diag([1.0, 1.4, 1.9]))

    def asked(w: float, **options: object) -> tuple[float, ...]:
        state = BodyState(p_WB_W=np.zeros(3), q_WB=(0, 0, 0, 1), w_WB_W=(0.3, 0.5, w))
        return free_motion(body, state, **options).sample(7.0)

    first = asked(1.2)
    assert asked(1.2) == first
    assert asked(math.nextafter(1.2, 2.0)).q_WB != first.q_WB
    assert asked(1.2, gravity_W=(0.0, 0.0, 0.0)).p_WB_W != first.p_WB_W
    assert asked(1.2, precision=Precision.DOUBLE).q_WB == pytest.approx(first.q_WB, abs=1e-14)
    assert asked(1.2) == first
