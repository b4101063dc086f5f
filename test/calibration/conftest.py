# SPDX-License-Identifier: Apache-2.0
"""One calibration of made tosses, on which several files look."""

from __future__ import annotations

import pytest

from calibration.made_tosses import Truth, made_tosses
from contact_dynamics.calibration import Calibration, calibrate


@pytest.fixture(scope="session")
def found() -> Calibration:
    """Both ways, from twelve tosses with the default truth."""
    return calibrate(made_tosses(Truth(), 12, 0))
