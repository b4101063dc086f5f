# SPDX-License-Identifier: Apache-2.0
"""The spread of residuals beyond their noise."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.calibration.estimation import extra_spread


def test_the_spread_beside_the_noise_is_found_though_a_tenth_is_far_off() -> None:
    random = np.random.default_rng(0)
    residuals = np.hypot(0.2, 0.3) * random.standard_normal((2000, 3))
    residuals[:200] *= 100.0
    # a tenth far off moves the median to the 55th of 100, by 8 % of the size
    found = extra_spread(residuals, np.broadcast_to(0.04 * np.eye(3), (2000, 3, 3)))
    assert found == pytest.approx(0.3, rel=0.15)


def test_there_is_none_where_the_noise_explains_all() -> None:
    residuals = 0.1 * np.random.default_rng(1).standard_normal((50, 3))
    assert extra_spread(residuals, np.broadcast_to(0.04 * np.eye(3), (50, 3, 3))) == 0.0
    assert extra_spread(np.zeros((0, 3)), np.zeros((0, 3, 3))) == 0.0
