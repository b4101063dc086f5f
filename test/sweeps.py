# SPDX-License-Identifier: Apache-2.0
"""Seeds of sweeps: a few that run each time, and the many that run with `make test-slow`."""

from __future__ import annotations

from typing import Any

import pytest


def sweep(few: int, *, whole: int) -> list[Any]:
    """Return ``whole`` numbers, from 0 on, of which all but the first ``few`` are slow."""
    return [pytest.param(number, marks=() if number < few else pytest.mark.slow) for number in range(whole)]
