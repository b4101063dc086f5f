# SPDX-License-Identifier: Apache-2.0
"""Wrenches and drag: what they keep and what they refuse. That they act as they say is in test_integrated."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.forces import ConstantWrench, Drag


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
