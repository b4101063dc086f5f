# SPDX-License-Identifier: Apache-2.0
"""Simulates one toss from event to event: flights, strikes, contact phases, jamming, and rest."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw
from contact_dynamics.impact.several.jamming import jamming_impact
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.impact.spatial.path import OUTCOMES
from contact_dynamics.impact.spatial.response import Strike
from contact_dynamics.tolerances import (
    BUSY,
    LIFT_OFF_PAUSE,
    LONGEST_SHORT_STEP,
    RESTING_ACCELERATION,
    SHORTEST_LINGER,
    SHORTEST_SHORT_STEP,
    SLIDING_STOPPED,
    STILL_TOUCHING,
    STRIKES,
)
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.flight import Descent
from contact_dynamics.toss.forces import held_in_place, out_of_flats, pushed_by_contacts
from contact_dynamics.toss.history import History
from contact_dynamics.toss.impacts import routh
from contact_dynamics.toss.laid_flat import laid_flat
from contact_dynamics.toss.mode_choice import choose_mode, may_be_wedged
from contact_dynamics.toss.phase import PhaseEnd, phase
from contact_dynamics.toss.result import FlightPiece, TossEnd, TossEventKind, UndecidedReason
from contact_dynamics.toss.short_step import short_step
from contact_dynamics.toss.solid import (
    approaches,
    contacts_of,
    energy_of,
    kinetic_energy_of,
    numbers_of,
    properties_of,
    state_of,
)
from contact_dynamics.toss.strike import Unsettled, low_rebounds_ended, strike

if TYPE_CHECKING:
    from contact_dynamics.toss.forces import HeldContacts
    from contact_dynamics.toss.laid_flat import Faces
    from contact_dynamics.toss.law_spread import Kick
    from contact_dynamics.toss.mode_choice import Choice, Mode
    from contact_dynamics.toss.solid import Held, Numbers, Solid, Touch
    from contact_dynamics.toss.strike import Strikes

MAX_STEPS: Final = 100_000
"""Largest number of integration steps in contact. A rolling ball takes some thirteen per turn."""

_ROUNDS: Final = 4
"""Largest number of rounds of a toss, relative to its largest number of events."""

_ROUNDS_AT_ONCE: Final = 12
"""Largest number of rounds of strikes, modes and flights within `Simulation.linger`. Up to six are usual at
one instant."""

_ROUNDS_WHILE_BUSY: Final = 400
"""Largest number of rounds within `BUSY`. After that, short steps pass over the chatter."""

_LONGEST_LINGER: Final = 0.1
"""Longest time, s, over which short steps replace rounds that repeat."""

_LONGER: Final = 4.0
"""Factor by which this time grows with each repetition."""

_SHARE: Final = 0.25
"""Length of a short step, relative to this time."""

_NEVER: Final = 2**31 - 1
"""A number of strikes that no toss reaches."""

_MAX_LAID: Final = 3
"""Largest number of times that a sample is laid flat. After that, its rattling is simulated in full."""

_SLOWER: Final = 0.25
"""Kinetic energy at which rest is checked again, relative to that at the last check."""


class TossSettings(NamedTuple):
    """Settings of a simulation.

    Attributes:
        solid: The body and the planes.
        law: Law of restitution.
        several_contacts_law: Law for several contacts that strike at one instant.
        horizon: Duration of the simulation, s.
        max_events: Largest number of events.
        error: Largest error of one step of a contact phase (`phase.phase`).
        kick: Random change of the velocities after strikes, or None.
        flat_after: Number of strikes after which a body that only rattles on a face is laid flat
            (`laid_flat`). If it is None, this is never done.
        thorough: True to compute all modes if friction may wedge the body. Otherwise, as for samples, the
            mode that is found first is taken, which is also the first branch of a toss.
        has_pieces: True to keep flights and steps, which contain the state at any time. Samples omit them.
    """

    solid: Solid
    law: RestitutionLaw
    several_contacts_law: SeveralContactsLaw
    horizon: float
    max_events: int
    error: float
    kick: Kick | None = None
    flat_after: int | None = None
    thorough: bool = True
    has_pieces: bool = True


class Simulation(History):
    """The simulation of one toss.

    It follows the branches ``ways`` at its first branch points, and branch 0 after these.
    """

    def __init__(
        self, settings: TossSettings, y: Numbers, ways: tuple[int, ...] = (), began_ns: int = 0
    ) -> None:
        super().__init__(settings.solid, y, ways, began_ns)
        self.is_sample = settings.flat_after is not None
        self.settings, self.kick, self.impact = settings, settings.kick, Strike(settings.law)
        self.horizon, self.error, self.max_events = settings.horizon, settings.error, settings.max_events
        self.thorough, self.has_pieces = settings.thorough, settings.has_pieces
        self.flat_after = _NEVER if settings.flat_after is None else settings.flat_after
        self.descent = Descent(settings.solid)
        self.slow = math.inf  # J, kinetic energy below which rest is checked
        self.struck = self.laid = self.steps = 0  # numbers of strikes, of layings flat, of contact steps
        self.mark, self.rounds = 0.0, 0  # a time, s, and the rounds since then
        self.busy_mark, self.busy_rounds = 0.0, 0  # the same over a longer time
        self.linger = SHORTEST_LINGER  # s, shortest time for the rounds, and duration of short steps
        self.settled: Strikes | None = None  # the last strikes
        self.unsettled = Unsettled()
        self.looked_at: list[Touch] = []  # contacts for which all modes were computed last
        self.faces: Faces = {}  # on which it could be laid
        self.quiet = 0.0  # s, time at which the omitted motion of a sample ends
        self.way_on: Mode | None = None  # the mode of a branch in which it does not rest

    def to_end(self) -> TossEnd:
        """Simulate the motion to its end, and return the reason for the end."""
        touching = self.touching_now(STRIKES)
        for _ in range(_ROUNDS * self.max_events):
            if self.count >= self.max_events or self.steps >= MAX_STEPS:
                return TossEnd.MAX_EVENTS
            if self.now >= self.horizon:
                return TossEnd.HORIZON
            touching = self._laid_flat(touching)
            if self._lingers():
                touching = self._pass_over()
            rates = approaches(self.solid, self.y, touching)
            if rates and min(rates) < -STRIKES:
                touching = self._strike(touching, rates)
                continue
            touching = [touching[k] for k in range(len(rates)) if rates[k] <= STILL_TOUCHING]
            if touching and self._rests(touching):
                return TossEnd.RESTS if self.now <= self.horizon else TossEnd.HORIZON
            touching = self._go_on(touching)
        return TossEnd.MAX_EVENTS

    def _go_on(self, touching: list[Touch]) -> list[Touch]:
        """Continue from contacts that neither approach nor separate, and return the touching contacts."""
        if not touching:
            return self._fly(0.0)
        found = self._next_mode(touching)
        if found is None:
            return self._jam(touching)
        mode, pushed = found
        if not mode:
            self.note(TossEventKind.LIFTS_OFF, touching)
            return self._fly(LIFT_OFF_PAUSE)
        if pushed.least_left() < 0.0:
            return self._pass_over()
        return self._follow(mode)

    # Flights

    def _fly(self, pause: float) -> list[Touch]:
        """Fly to the next contact or the horizon, and return the touching contacts.

        The search for arrivals begins after ``pause``, s, because contacts that have just lifted off have no
        speed.
        """
        left = self.horizon - self.now
        self.y = out_of_flats(self.solid, self.y)
        seconds = self.descent.fly(self.y, pause, left)
        if self.has_pieces:
            self.pieces.append(FlightPiece(self.now, self.solid, self.y))
            self._forget_instant()
        self.y = self.descent.state()
        self.now += seconds
        return self.touching_now(self._fast()) if seconds < left else []

    def _forget_instant(self) -> None:
        """Remove a piece of zero length, so that each time belongs to one piece."""
        last = len(self.pieces) - 1
        if last > 0 and self.pieces[last - 1].start == self.pieces[last].start:
            del self.pieces[last - 1]

    # Strikes

    def _strike(self, touching: list[Touch], rates: list[float]) -> list[Touch]:
        fast = -self._fast()
        striking = [touch for rate, touch in sorted(zip(rates, touching, strict=True)) if rate < fast]
        first, together = None, self.settings.several_contacts_law
        if len(striking) > 1 and together == SeveralContactsLaw.SEQUENTIAL:
            way = self.way(UndecidedReason.STRIKE_TOGETHER, len(striking))
            first = striking[way] if way > 0 else None
        y, before = self.y, energy_of(self.solid, self.y)
        strikes = strike(
            self.solid,
            self.y,
            touching,
            self.impact,
            self.settings.law,
            rates,
            self.unsettled,
            together,
            first,
        )
        self.settled = strikes
        self.y, staying = strikes.y, strikes.staying
        if self.kick is not None and not strikes.settled:
            self.y = self.kick.kicked(self.solid, y, self.y, touching)
            staying = self.touching_now(STILL_TOUCHING)
        for one in strikes.struck:
            kind = TossEventKind.SETTLES if one.settles else TossEventKind.STRIKES
            self.struck += kind == TossEventKind.STRIKES
            self.note(kind, [one.touch], (), one.impulse, one.outcome)
        if not strikes.settled:
            staying = self._end_low_rebounds(touching, staying, before)
        self.lost_in_strikes += before - energy_of(self.solid, self.y)
        self.slow = math.inf
        return staying

    def _end_low_rebounds(self, touching: list[Touch], staying: list[Touch], energy: float) -> list[Touch]:
        """Close contacts with a negligible rebound, and return those that stay.

        The friction impulses of these rebounds are reversed. If this would raise the energy above that before
        the strikes, ``energy`` in J, the rebounds are simulated.
        """
        ended = low_rebounds_ended(self.solid, self.y, touching, self.unsettled)
        if ended is None or energy_of(self.solid, ended.y) > energy:
            return staying
        change = [
            self.solid.mass * (after - now) for after, now in zip(ended.y[7:10], self.y[7:10], strict=True)
        ]
        self.y = ended.y
        self.note(TossEventKind.SETTLES, ended.staying, (), (change[0], change[1], change[2]))
        return ended.staying

    def _fast(self) -> float:
        """Return the speed of approach, m/s, above which the order of simultaneous strikes matters."""
        return math.sqrt(2.0 * self.solid.settling * vec.norm(self.solid.gravity)) + STRIKES

    def _jam(self, touching: list[Touch]) -> list[Touch]:
        """Resolve contacts without a consistent mode by an impact, and return the touching contacts.

        If no such impact is found, short steps replace it.
        """
        solid = self.solid
        before = energy_of(solid, self.y)
        if len(touching) == 1:
            self.y, outcome = routh(self.impact, solid, self.y, touching[0], False, True)  # noqa: FBT003
            if outcome == ImpactOutcome.NO_IMPULSE:
                return self._pass_over()
            self.lost_in_strikes += before - energy_of(solid, self.y)
            self.note(TossEventKind.JAMS, touching, (), self.impact.impulse, OUTCOMES[outcome])
            return self.touching_now(STILL_TOUCHING)
        contacts = contacts_of(solid, self.y, touching)
        impact = jamming_impact(
            properties_of(solid),
            state_of(self.y),
            replace(contacts, body_curvatures=None),
            is_settled=lambda state: bool(choose_mode(solid, numbers_of(state), touching).modes),
            force_W=solid.mass * np.array(solid.gravity),
        )
        if not impact.converged:
            return self._pass_over()
        self.y = [*self.y[:7], *impact.state.v_WB_W.tolist(), *impact.state.w_WB_W.tolist()]
        self.lost_in_strikes += before - energy_of(solid, self.y)
        x, y, z = impact.impulses_W.sum(axis=0).tolist()
        self.note(TossEventKind.JAMS, touching, (), (x, y, z))
        return self.touching_now(STILL_TOUCHING)

    # Contact

    def _next_mode(self, touching: list[Touch]) -> tuple[Mode, HeldContacts] | None:
        """Return the next mode with its rates and forces, or None if no mode is consistent."""
        if self.way_on is not None:
            mode, self.way_on = self.way_on, None
            return mode, pushed_by_contacts(self.solid, self.y, mode)
        thorough = self.thorough and touching != self.looked_at
        self.looked_at = touching
        known = self._known_since_strikes(touching, thorough)
        choice = known or choose_mode(self.solid, self.y, touching, thorough)
        if not choice.modes:
            return None
        options = len(choice.modes)
        way = self.way(UndecidedReason.SEVERAL_MODES, options) if options > 1 else 0
        return choice.modes[way], choice.pushed_in(way, self.solid, self.y)

    def _known_since_strikes(self, touching: list[Touch], thorough: bool) -> Choice | None:  # noqa: FBT001
        """Return the modes of these contacts in this state if the last strikes computed them."""
        last = self.settled
        if last is None or last.y is not self.y or last.staying != touching:
            return None
        return None if thorough and may_be_wedged(self.solid, touching) else last.choice

    def _follow(self, mode: Mode) -> list[Touch]:
        """Integrate a mode to its end, and return the touching contacts."""
        held = [one.touch for one in mode]
        self.note(TossEventKind.NEW_MODE, held, mode)
        before = energy_of(self.solid, self.y)
        went = phase(
            self.solid,
            self.y,
            mode,
            start=self.now,
            until=self.horizon,
            slow=min(self.slow, self._slow(held)),
            error=self.error,
            has_steps=self.has_pieces,
        )
        self.pieces += went.steps
        self.steps += went.step_count
        self.now, self.y = went.seconds, went.y
        self.lost_in_contact += before - energy_of(self.solid, self.y)
        if went.end == PhaseEnd.CREEPS:
            return self._pass_over()
        if went.end == PhaseEnd.COMES_DOWN:
            return held + [touch for touch in self.touching_now(self._fast()) if touch not in held]
        if went.end == PhaseEnd.SLOW:
            return held + [touch for touch in self.touching_now(math.inf) if touch not in held]
        return held

    def _lingers(self) -> bool:
        """Return whether there were too many events in a short time."""
        if self.now > self.mark + self.linger:
            self.mark, self.rounds = self.now, 0
            self.linger = max(0.5 * self.linger, SHORTEST_LINGER)
        self.rounds += 1
        if self.now > self.busy_mark + BUSY:
            self.busy_mark, self.busy_rounds = self.now, 0
        self.busy_rounds += 1
        if self.busy_rounds > _ROUNDS_WHILE_BUSY:
            self.linger = max(self.linger, _SHARE * BUSY)
            return True
        return self.rounds > _ROUNDS_AT_ONCE

    def _pass_over(self) -> list[Touch]:
        """Pass over a repetition of events in short steps, and return the touching contacts.

        If events repeat again, the next duration is longer.
        """
        until = min(self.now + self.linger, self.horizon)
        mode: tuple[Held, ...] = ()
        before = energy_of(self.solid, self.y)
        while self.now < until:
            span = min(until - self.now, max(_SHARE * self.linger, SHORTEST_SHORT_STEP), LONGEST_SHORT_STEP)
            went = short_step(self.solid, self.y, start=self.now, span=span)
            if self.has_pieces:
                self.pieces.append(went.step)
            mode = mode or went.mode
            self.y, self.now = went.y, self.now + went.step.span
            self.steps += 1
        self.note(TossEventKind.NEW_MODE, [one.touch for one in mode], mode)
        self.lost_in_contact += before - energy_of(self.solid, self.y)
        self.linger = min(_LONGER * self.linger, _LONGEST_LINGER)
        self.mark, self.rounds = self.now, 0
        self.busy_mark, self.busy_rounds = self.now, 0
        return self.touching_now(self._fast())

    def _slow(self, touching: list[Touch]) -> float:
        """Return the kinetic energy, J, with which the body rises or slides by at most `settling`.

        Without friction the body would never stop. Its speed must then be within `SLIDING_STOPPED`.
        """
        grip = 1.0 if touching else 0.0
        for surface, _ in touching:
            flat = self.solid.flats[surface]
            grip = min(grip, flat.friction)
        return self._stopped_within(self.solid.mass * vec.norm(self.solid.gravity) * grip)

    def _stopped_within(self, force: float) -> float:
        """Return the kinetic energy, J, that a force dissipates within `settling`, or that of rounding."""
        return max(force * self.solid.settling, 0.5 * self.solid.mass * SLIDING_STOPPED**2)

    def _laid_flat(self, touching: list[Touch]) -> list[Touch]:
        """Lay a sample that only rattles on a face flat on it, and return the touching contacts."""
        if self.struck < self.flat_after or self.laid >= _MAX_LAID:
            return touching
        flat = laid_flat(self.solid, self.y, self.faces, self.settings.law)
        if flat is None:
            return touching
        self.y, rattles = flat
        self.quiet = max(self.quiet, self.now + rattles)
        # It rattles again only after another strike.
        self.laid, self.flat_after, self.slow = self.laid + 1, self.struck + 1, math.inf
        return self.touching_now(STILL_TOUCHING)

    def _rests(self, touching: list[Touch]) -> bool:
        """Return whether the body has come to rest, and set its velocities to zero if it has."""
        energy = kinetic_energy_of(self.solid, self.y)
        # A body that has stopped is always checked: the energy at the last check may have been zero.
        if energy > max(min(self._slow(touching), self.slow), self._stopped_within(0.0)):
            return False
        touching = self.touching_now(math.inf)
        still = [*self.y[:7], *[0.0] * 6]
        choice = choose_mode(self.solid, still, touching, self.thorough)
        modes = choice.modes
        if not modes:
            return False
        pushed = choice.pushed_in(0, self.solid, still)
        _, _, _, _, _, _, _, a, b, c, d, e, f = pushed.rates
        fastest = max(abs(a), abs(b), abs(c)) + self.solid.reach * max(abs(d), abs(e), abs(f))
        # Nearly flush contacts may need pulling forces for rest, because they are not exactly flush.
        is_held = pushed.least_left() >= 0.0
        if not is_held or fastest > RESTING_ACCELERATION * vec.norm(self.solid.gravity):
            self.slow = _SLOWER * energy
            return False
        # Friction that carries a load, on a slope or accelerated planes, does not slow the body down.
        slowing = pushed.friction_left()
        self.slow = self._stopped_within(slowing)
        if energy > self.slow:
            return False
        if len(modes) > 1:
            way = self.way(UndecidedReason.SEVERAL_MODES, len(modes))
            if way > 0:
                self.way_on = modes[way]
                return False
        if self.is_sample:
            if slowing > 0.0:
                self.quiet = max(self.quiet, self.now + math.sqrt(2.0 * energy * self.solid.mass) / slowing)
            self.now = max(self.now, self.quiet)
        self.lost_in_contact += energy
        placed = out_of_flats(self.solid, held_in_place(self.solid, still, modes[0]))
        self.lost_in_contact += energy_of(self.solid, still) - energy_of(self.solid, placed)
        self.y, self.resting = placed, [one.touch for one in modes[0]]
        self.note(TossEventKind.RESTS, self.resting)
        return True
