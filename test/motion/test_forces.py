# SPDX-License-Identifier: Apache-2.0
"""Wrenches and drag: what they keep and what they refuse. That they act as they say is in test_integrated."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.motion.forces import ConstantWrench


def test_wrenches_are_copies_that_nobody_changes() -> None:
    force = np.array([1.0, 2.0, 3.0])
    wrench = ConstantWrench(force=force)
    force[0] = 9.0
    assert wrench.force[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        wrench.force[0] = 9.0
