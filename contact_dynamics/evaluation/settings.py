# SPDX-License-Identifier: Apache-2.0
"""Settings of the predictions: horizons, impact laws, and the window of states for fits."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Final

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.evaluation.model_error import ModelError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.questions.impact_question import InTime
from contact_dynamics.records import Record
from contact_dynamics.tolerances import HOLD_STEP
from contact_dynamics.validation import check_positive

HORIZONS: Final = (0.02, 0.05, 0.1, 0.2)  # look-ahead times, s before an event

FIT_WINDOW: Final = 0.1
"""Duration of the states to which a flight is fitted, s. States before the start of the flight are left out.
"""

MAX_STRIKES: Final = 40
"""Largest number of successive strikes. Only those before the next flight count: a larger number changes no
error of the published tosses, and predictions take four times as long."""


class Law(Enum):
    """Impact laws under which predictions are compared."""

    POISSON = "poisson"
    NEWTON = "newton"
    ENERGETIC = "energetic"
    IN_TIME = "in time"
    """Poisson's law with strikes one after the other in time, in which corners may stay in contact."""

    @property
    def restitution_law(self) -> RestitutionLaw:
        """Definition of the coefficient of restitution."""
        return RestitutionLaw.POISSON if self is Law.IN_TIME else RestitutionLaw[self.name]

    @property
    def several_contacts_law(self) -> SeveralContactsLaw | InTime:
        """Law for several contacts."""
        return (
            InTime(hold_step=HOLD_STEP, max_strikes=MAX_STRIKES)
            if self is Law.IN_TIME
            else SeveralContactsLaw.SEQUENTIAL
        )


class Method(Enum):
    """Source of a prediction's initial state."""

    FIT = "fit"  # The flight fitted to the latest states. This is the recommended method.
    NEWEST = "newest"
    """The newest published state. It is a baseline for flights, and the only method for contact modes."""
    NO_IMPACT = "no impact"  # a baseline: the fitted flight, continued through the surface


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Settings(Record):
    """Settings of the predictions.

    Raises:
        InvalidFieldError: ``horizons`` or ``laws`` is empty, or a number is not > 0.
    """

    horizons: tuple[float, ...] = HORIZONS  # s, > 0, look-ahead times
    # Impact laws. The first one is also applied to the newest state, without a fit.
    laws: tuple[Law, ...] = tuple(Law)
    fit_window: float = FIT_WINDOW  # s, > 0, duration of the states to which a flight is fitted
    error: ModelError = field(default_factory=ModelError)  # model errors in addition to measurement noise

    def __post_init__(self) -> None:
        """Check the fields, and sort the horizons."""
        if not self.horizons or not self.laws:
            raise InvalidFieldError("horizons, laws", "an empty list", "at least one of each")
        horizons = tuple(sorted({check_positive("horizons", horizon) for horizon in self.horizons}))
        object.__setattr__(self, "horizons", horizons)
        object.__setattr__(self, "fit_window", check_positive("fit_window", self.fit_window))
