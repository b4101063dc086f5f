# SPDX-License-Identifier: Apache-2.0
"""Constants in doubles: as good as extended ones at first, and worse by what their last bits do in time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion
from contact_dynamics.tumbling.poinsot_construction import sensitivity
from oracles.tumbling_draws import draw
from tumbling.known_motions import MOTIONS, motion_of

LAST_BITS = 2e-15


def in_doubles(motion: FreeMotion) -> FreeMotion:
    return free_motion(motion.body, motion.state, precision=Precision.DOUBLE)


def difference(motion: FreeMotion, seconds: float) -> float:
    exact, rounded = motion.sample(seconds).q_WB, in_doubles(motion).sample(seconds).q_WB
    return float((Rotation.from_quat(exact).inv() * Rotation.from_quat(rounded)).magnitude())


@pytest.mark.parametrize("name", sorted(set(MOTIONS) - {"at rest", "about the middle axis"}))
def test_known_motions(name: str) -> None:
    motion = motion_of(name)
    rate = float(np.linalg.norm(motion.state.w_WB_W))
    growth = min(sensitivity(motion), 100.0)  # e^5 times on the separatrix, in these times
    for turned in (0.0, 0.3, -8.0, 300.0):
        limit = LAST_BITS * (1.0 + growth * abs(turned))
        assert difference(motion, turned / rate) <= limit
    assert in_doubles(motion).regime is motion.regime


@given(seed=st.integers(0, 2**32 - 1), turned=st.floats(-100.0, 100.0))
def test_drawn_motions(seed: int, turned: float) -> None:
    drawn = draw(np.random.default_rng(seed))
    # There, what the last bit of the state does is beyond any bound in doubles.
    assume(drawn.spin not in ("separatrix", "middle") and drawn.body != "needle")
    rate = float(np.linalg.norm(drawn.w_WB_W))
    state = BodyState(p_WB_W=np.zeros(3), q_WB=drawn.q_WB, w_WB_W=drawn.w_WB_W)
    motion = free_motion(MassProperties(mass=1.0, I_B=drawn.I_B), state)
    limit = LAST_BITS * (1.0 + sensitivity(motion)) * (1.0 + abs(turned))
    assert difference(motion, turned / rate) <= limit


@pytest.mark.parametrize("precision", Precision)
@pytest.mark.parametrize(
    ("moment_unit", "rate_unit"), [(1e-55, 1.0), (1e55, 1e20), (1.0, 1e-59), (1e-20, 1e55)]
)
@pytest.mark.parametrize("w", [(0.3, -0.5, 1.2), (1e-3, 1.0, 1e-4)])
def test_the_unit_does_not_matter(
    w: tuple[float, ...], moment_unit: float, rate_unit: float, precision: Precision
) -> None:
    def motion(moment_unit: float, rate_unit: float) -> FreeMotion:
        body = MassProperties(mass=1.0, I_B=moment_unit * np.diag((1.0, 1.4, 1.9)))
        rates = rate_unit * np.array(w)
        state = BodyState(p_WB_W=np.zeros(3), q_WB=(0.0, 0.0, 0.0, 1.0), w_WB_W=rates)
        return free_motion(body, state, precision=precision)

    usual, other = motion(1.0, 1.0), motion(moment_unit, rate_unit)
    assert other.sample(3.0 / rate_unit).q_WB == pytest.approx(usual.sample(3.0).q_WB, abs=5e-15)
    assert sensitivity(other) == pytest.approx(sensitivity(usual), rel=1e-9)
