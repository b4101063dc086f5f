# SPDX-License-Identifier: Apache-2.0
"""What is asked about each event: how long before, under which laws, from how many states."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.questions.impact_question import InTime
from contact_dynamics.records import Record
from contact_dynamics.tolerances import HOLD_STEP
from contact_dynamics.validation import check_positive

HORIZONS: Final = (0.02, 0.05, 0.1, 0.2)
"""s before an event."""

FIT_WINDOW: Final = 0.1
"""s of states that a flight is fitted to, or as many as there are since it began."""


MAX_STRIKES: Final = 40
"""Strikes in time that are resolved. Those until the next flight begins count alone: of the published tosses
no error changes if more are, and answers take four times as long."""


class Law(Enum):
    """The laws of impact that predictions are compared under."""

    POISSON = "poisson"
    NEWTON = "newton"
    ENERGETIC = "energetic"
    IN_TIME = "in time"
    """Poisson's, with strikes one after the other and going on over corners that stay."""

    @property
    def restitution_law(self) -> RestitutionLaw:
        """What coefficients of restitution mean."""
        return RestitutionLaw.POISSON if self is Law.IN_TIME else RestitutionLaw[self.name]

    @property
    def several_contacts_law(self) -> SeveralContactsLaw | InTime:
        """What happens at several contacts."""
        return (
            InTime(hold_step=HOLD_STEP, max_strikes=MAX_STRIKES)
            if self is Law.IN_TIME
            else SeveralContactsLaw.SEQUENTIAL
        )


class Method(Enum):
    """What a prediction is made from."""

    FIT = "fit"
    """The flight that fits the states of the last time. It is what the package recommends."""
    NEWEST = "newest"
    """The newest state as it was published. For flights it is a baseline; for modes the only way."""
    NO_IMPACT = "no impact"
    """A baseline: the fit, flying on through the surface."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Settings(Record):
    """What is asked.

    Attributes:
        horizons: s, > 0, how long before an event it is asked about.
        laws: The laws of impact. The first one is also asked about the newest state without a fit.
        fit_window: s, > 0, of states that a flight is fitted to.

    Raises:
        InvalidFieldError: there is no horizon or no law, a number is not > 0, or a law is none.
    """

    horizons: tuple[float, ...] = HORIZONS
    laws: tuple[Law, ...] = tuple(Law)
    fit_window: float = FIT_WINDOW

    def __post_init__(self) -> None:
        """Check all three."""
        if not self.horizons or not self.laws:
            raise InvalidFieldError("horizons, laws", "an empty list", "at least one of each")
        horizons = tuple(sorted({check_positive("horizons", horizon) for horizon in self.horizons}))
        object.__setattr__(self, "horizons", horizons)
        object.__setattr__(self, "fit_window", check_positive("fit_window", self.fit_window))
