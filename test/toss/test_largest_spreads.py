# SPDX-License-Identifier: Apache-2.0
"""Uncertainties of any size are sampled or refused by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Surface, World
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.toss import TossUncertainty, sampled_toss
from contact_dynamics.toss.uncertainty import MAX_INERTIA_SPREAD, MAX_SPREAD

SIZE = (0.1, 0.08, 0.06)
BRICK = Body.box(SIZE, mass=0.4, name="brick")
WORLD = World(
    bodies=(BRICK,),
    surfaces=(Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.2),),
)
THROWN = BodyState(p_WB_W=[0, 0, 0.5], q_WB=[0, 0, 0, 1], v_WB_W=[0.5, 0, 0], w_WB_W=[1, 3, 2])
EXACT_STATE = np.zeros((12, 12))


def spread(variance: float, *, rows: int = 9, only: int | None = None) -> np.ndarray:
    """A covariance of the parameters with this variance of all, or of one."""
    matrix = np.zeros((rows, rows))
    each = range(rows) if only is None else [only]
    for k in each:
        matrix[k, k] = min(variance, MAX_INERTIA_SPREAD**2) if k == 5 and only is None else variance
    return matrix


def ask(uncertainty: TossUncertainty, covariance: np.ndarray = EXACT_STATE) -> None:
    told = sampled_toss(
        BRICK,
        THROWN,
        WORLD,
        covariance=covariance,
        uncertainty=uncertainty,
        count=5,
        restitution_law=RestitutionLaw.POISSON,
        horizon=2.0,
    )
    assert told.samples == 5


@pytest.mark.parametrize(
    "given",
    [
        {"velocity": MAX_SPREAD},
        {"spin": MAX_SPREAD},
        {"height": 1.0},
        {"covariance": spread(1.0)},
        {"covariance": spread(MAX_SPREAD**2, only=0)},
        {"covariance": spread(MAX_INERTIA_SPREAD**2, only=5)},
        {"lasting_factors": [MAX_SPREAD], "lasting_factor_stds": [MAX_SPREAD]},
    ],
)
def test_the_largest_are_sampled(given: dict[str, Any]) -> None:
    ask(TossUncertainty(**given))


@pytest.mark.parametrize("field", ["velocity", "spin", "height"])
def test_a_larger_spread_is_refused_by_name(field: str) -> None:
    with pytest.raises(InvalidFieldError, match=rf"{field} must be in \[0, 1e\+06\].*, got .*"):
        TossUncertainty(**{field: np.nextafter(MAX_SPREAD, np.inf)})


def test_a_larger_variance_is_refused_by_name() -> None:
    with pytest.raises(InvalidFieldError, match=r"covariance must be .*, got 1e.300"):
        TossUncertainty(covariance=spread(1e300))
    with pytest.raises(
        InvalidFieldError, match=r"covariance must be .*, got a variance of the inertia of 101"
    ):
        ask(TossUncertainty(covariance=spread(101.0, only=5, rows=6)))
    with pytest.raises(InvalidFieldError, match=r"^covariance must be .*, got 1e.300"):
        ask(TossUncertainty(), 1e300 * np.eye(12))
    with pytest.raises(InvalidFieldError, match=r"lasting_factors must be .*, got 1e.300"):
        TossUncertainty(lasting_factors=[1e300])
