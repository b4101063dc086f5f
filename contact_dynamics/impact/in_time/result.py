# SPDX-License-Identifier: Apache-2.0
"""The result of a landing over several strikes says when each was, and why the sequence ends."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact.energy import created
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.spatial.result import SpatialImpact
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray
from contact_dynamics.world import SurfaceFrame


class SequenceEnd(NamedInt):
    """Reason for the end of a sequence of impacts."""

    NOTHING_STRIKES = 0
    """There is no impact within the window after the last one. The body flies, and may land later."""
    STAYS = 1
    """A contact neither approaches nor separates, and free motion would penetrate, so the flight is over."""
    CHATTERS = 2
    """The rebounds of a contact decrease by a constant ratio. Infinitely many impacts accumulate
    at the limit time, and from then on the contact stays closed."""
    MAX_STRIKES = 3
    """The limit on the number of impacts was reached."""
    WINDOW_ENDED = 4
    """There is no impact within the window after the initial state. The body may land later."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TimedStrike(Record):
    """One impact of a sequence.

    Attributes:
        seconds: Time of the impact, s after the stamp of the initial state.
        contact: Index into the contacts of the sequence.
        p_WC_W: (3,), m, position of the contact at that time, world.
        state_before: State just before the impact, stamped with its time.
        impact: Impact at this contact. Its ``state`` is the state just after the impact.
    """

    seconds: float
    contact: int
    p_WC_W: FloatArray
    state_before: BodyState
    impact: SpatialImpact


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactSequence(Record):
    """Impacts of a landing at separate times, with free flight between them.

    Attributes:
        restitution_law: Law of restitution of all impacts.
        window: s, longest flight that was followed.
        contacts: The given contacts. If contacts were detected from the shape, those with an impact or that
            stay closed, each at the position of the first such event.
        strikes: Impacts in the order of time; simultaneous ones are in the order of resolution. Contacts of
            equal approach speed are resolved together, each with its share of the impulse and the state
            after all of them.
        end: Reason for which there is no further impact.
        state: State just after the last impact, or the initial state if there is none.
        staying: Indices of the contacts that stay closed, if ``end`` is STAYS or CHATTERS.
        limit_seconds: Time from which these contacts stay closed, s after the initial state's stamp, or None.
        order_is_open: Whether several contacts approached at the same instant, so that rigid-body mechanics
            also admits other orders of their impacts.
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
        """Return the time of the last impact, s after the initial state's stamp, or 0 without an impact."""
        return self.strikes[-1].seconds if self.strikes else 0.0

    @property
    def message(self) -> str:
        """Return a text with the reason for the end of the sequence, and a hint for the next call."""
        stay = ", ".join(map(str, self.staying))
        return {
            SequenceEnd.NOTHING_STRIKES: f"no further impact within the window of {self.window:g} s after "
            "the last one; a longer window may contain one",
            SequenceEnd.STAYS: f"the contacts {stay} stay closed; compute their contact modes",
            SequenceEnd.CHATTERS: f"the rebounds vanish, and then the contacts {stay} stay closed",
            SequenceEnd.MAX_STRIKES: f"the limit of {len(self.strikes)} impacts was reached; another "
            "impact may follow immediately",
            SequenceEnd.WINDOW_ENDED: f"no impact within the window of {self.window:g} s after the state; a "
            "longer window, or `next_landing`, may find one",
        }[self.end]

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that struck, in order."""
        return tuple(strike.contact for strike in self.strikes)

    @property
    def energy_change(self) -> float:
        """Return the change of energy in all impacts, J. Flights between them conserve energy."""
        return sum(strike.impact.energy_change for strike in self.strikes)

    @property
    def creates_energy(self) -> bool:
        """Return whether an impact increased the energy by more than rounding error.

        Only Newton's law can do this. Contacts that are resolved together are added up, because one can
        return energy that another absorbed.
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


def carried_by(sequence: ImpactSequence, frame: SurfaceFrame | None) -> ImpactSequence:
    """Return a sequence in the frame of moving surfaces as it is in the world, except its contacts."""
    if frame is None:
        return sequence
    after: dict[int, BodyState] = {}  # strikes as one share the state after them
    strikes = []
    for one in sequence.strikes:
        state = after.setdefault(id(one.impact.state), frame.in_world(one.impact.state, one.seconds))
        strikes.append(
            replace(
                one,
                p_WC_W=one.p_WC_W + frame.displacement(one.seconds),
                state_before=frame.in_world(one.state_before, one.seconds),
                impact=replace(one.impact, state=state),
            )
        )
    last = strikes[-1].impact.state if strikes else frame.in_world(sequence.state, 0.0)
    return replace(sequence, strikes=tuple(strikes), state=last)
