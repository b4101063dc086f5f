# SPDX-License-Identifier: Apache-2.0
"""The result of a landing over several strikes says when each was, and why the sequence ends."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact.energy import created
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.result import SpatialImpact
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


class SequenceEnd(NamedInt):
    """Why a sequence of strikes has no further one."""

    NOTHING_STRIKES = 0
    """Nothing strikes within the window after the last strike. The body flies, and may come down later."""
    STAYS = 1
    """A contact neither approaches nor leaves, and free motion would press it in. So the flight is over."""
    CHATTERS = 2
    """A contact's rebounds shrink by a ratio and have no height any more. Infinitely many strikes end at the
    limit time, and from then on the contact stays."""
    MAX_STRIKES = 3
    """The bound on the number of strikes was reached."""
    WINDOW_ENDED = 4
    """Nothing has struck within the window after the given state. The body may land later."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TimedStrike(Record):
    """One strike of a sequence.

    Attributes:
        seconds: s after the stamp of the state that the sequence began with.
        contact: Index into the sequence's contacts.
        p_WC_W: (3,), m, where the contact is then, world.
        state_before: The state just before, stamped with the time of the strike.
        impact: The impact at this one contact. Its ``state`` is the state just after.
    """

    seconds: float
    contact: int
    p_WC_W: FloatArray
    state_before: BodyState
    impact: SpatialImpact


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactSequence(Record):
    """A landing as strikes in time, with free flight between them.

    Attributes:
        restitution_law: The law of each strike.
        window: s, the longest flight that was followed.
        contacts: The contacts that were given. If they were found from geometry, those that struck or stay,
            each where it first did.
        strikes: The strikes in the order of time. Those of one instant are in the order of resolution.
            Contacts that approach equally fast strike as one, each with its share of the impulse and the
            state after all of them.
        end: Why there is no further strike.
        state: The state just after the last strike, or the first state if there is no strike.
        staying: Indices of the contacts that stay, if ``end`` is STAYS or CHATTERS.
        limit_seconds: s after the first state's stamp, the time from which on they stay, or None.
        order_is_open: Whether several contacts approached at one instant, so that rigid-body mechanics allows
            other orders of their strikes.
    """

    restitution_law: RestitutionLaw
    window: float
    contacts: ContactSet
    strikes: tuple[TimedStrike, ...]
    end: SequenceEnd
    state: BodyState
    staying: tuple[int, ...]
    limit_seconds: float | None
    order_is_open: bool = False

    @property
    def seconds(self) -> float:
        """Return the time of the last strike, s after the first state's stamp, or 0 if there is no strike."""
        return self.strikes[-1].seconds if self.strikes else 0.0

    @property
    def message(self) -> str:
        """Return in words why there is no further strike, and which question would tell more."""
        stay = ", ".join(map(str, self.staying))
        return {
            SequenceEnd.NOTHING_STRIKES: f"no further strike within the window of {self.window:g} s after "
            "the last one; a longer window follows the flight on",
            SequenceEnd.STAYS: f"flight is over: the contacts {stay} stay; contact modes say what follows",
            SequenceEnd.CHATTERS: f"infinitely many rebounds end: the contacts {stay} stay from then on",
            SequenceEnd.MAX_STRIKES: f"the bound of {len(self.strikes)} strikes was reached; the body may "
            "strike again at once",
            SequenceEnd.WINDOW_ENDED: f"no strike within the window of {self.window:g} s after the state; a "
            "longer window, or `next_landing`, may find one",
        }[self.end]

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order."""
        return tuple(strike.contact for strike in self.strikes)

    @property
    def energy_change(self) -> float:
        """Return the change of energy by all strikes, J. Flights between them keep the energy."""
        return sum(strike.impact.energy_change for strike in self.strikes)

    @property
    def creates_energy(self) -> bool:
        """Return whether a strike gave the body energy, beyond rounding. Only Newton's law can do that.

        Contacts that strike as one count together, since one of them may give what another takes.
        """
        return any(
            strikes[0].impact.creates_energy
            if len(strikes) == 1
            else created(
                sum(one.impact.energy_change for one in strikes),
                sum(abs(one.impact.energy_change) for one in strikes),
            )
            for _, group in groupby(self.strikes, key=lambda strike: id(strike.impact.state))
            for strikes in [tuple(group)]
        )
