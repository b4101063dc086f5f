# SPDX-License-Identifier: Apache-2.0
"""Resolves all strikes of one instant, and ends series of small rebounds.

Under the sequential law (`impact.several`), the contact that approaches fastest is resolved by Routh's impact
at one contact (`impact.spatial`), and this is repeated until no contact approaches. Contacts that approach
equally fast strike as one. The order is not determined by mechanics, and ``first`` selects another contact
to begin with. Under the simultaneous law, all contacts strike at once.

Rebounds decrease geometrically, and infinitely many of them end in finite time (Zeno). A contact that would
rebound by at most the solid's `settling` remains closed from then on. Its impulse is that of all its rebounds
together. Contacts are closed only if the kinetic energy that this removes could not raise the body by more
than that height: a tall body rocks on a narrow face with corners that rise slowly, but far.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.impact.spatial.path import OUTCOMES
from contact_dynamics.tolerances import SLIDING_STOPPED, STILL_TOUCHING, STRIKES
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.forces import held_as_they_are, without_rebounds
from contact_dynamics.toss.impacts import (
    Struck,
    inelastic_impact,
    next_in_turn,
    routh,
    simultaneous_strike,
    sure_impact,
    tied_strike,
)
from contact_dynamics.toss.mode_choice import choose_mode
from contact_dynamics.toss.solid import Held, approaches, kinetic_energy_of, pose_of

if TYPE_CHECKING:
    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.impact.spatial.response import Strike
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.impacts import Inelastic
    from contact_dynamics.toss.mode_choice import Choice
    from contact_dynamics.toss.solid import Numbers, Solid, Touch

MAX_STRIKES_AT_ONCE: Final = 100
"""Largest number of strikes at one instant. Contacts that still approach then jam, and are resolved by one
impact without restitution. A prism that lands on a face of eight corners takes some twenty."""

_JAMS_AFTER: Final = 40
"""The same for contacts that approach so slowly that they would rebound by less than `settling`."""


class Unsettled:
    """The last contacts and state for which no contact mode exists.

    Successive strikes, at one instant or nanoseconds apart, mostly lead to the same state without rebounds,
    and the proof that it has no mode takes some 30 ms.
    """

    def __init__(self) -> None:
        self.touching: list[Touch] = []
        self.y: Numbers = []

    def are(self, solid: Solid, y: Numbers, touching: list[Touch]) -> bool:
        """Return whether these are the recorded contacts in the recorded state.

        The pose must be equal, and the velocities equal within the tolerance `STRIKES`.
        """
        last = self.y
        if touching != self.touching or y[:7] != last[:7]:
            return False
        moved = max(abs(y[7] - last[7]), abs(y[8] - last[8]), abs(y[9] - last[9]))
        turned = max(abs(y[10] - last[10]), abs(y[11] - last[11]), abs(y[12] - last[12]))
        return max(moved, solid.reach * turned) <= STRIKES

    def note(self, y: Numbers, touching: list[Touch]) -> None:
        """Record contacts that have no mode in a state."""
        self.y, self.touching = y, touching


class Strikes(NamedTuple):
    """The strikes of one instant.

    Attributes:
        y: State after them.
        struck: The individual strikes.
        staying: Contacts that neither separate nor approach.
        settled: True if contacts have settled without restitution.
        choice: Modes of the staying contacts in this state, or None if they were not computed.
    """

    y: Numbers
    struck: list[Struck]
    staying: list[Touch]
    settled: bool
    choice: Choice | None = None


def strike(  # noqa: PLR0917
    solid: Solid,
    y: Numbers,
    touching: list[Touch],
    impact: Strike,
    law: RestitutionLaw,
    rates: list[float],
    unsettled: Unsettled,
    together: SeveralContactsLaw,
    first: Touch | None,
) -> Strikes:
    """Return the state after all strikes of contacts that touch at one instant.

    Args:
        solid: The body and the planes.
        y: State before the strikes.
        touching: All touching contacts, approaching or not.
        impact: Solver for impacts at one contact, with the law of restitution.
        law: Law of restitution.
        rates: Normal velocities of these contacts, m/s (`approaches`).
        unsettled: Contacts without a mode, from earlier strikes; updated here.
        together: Law for several contacts.
        first: First contact to be resolved under SEQUENTIAL. If it is None, it is the one that approaches
            fastest, with those that tie with it.
    """
    struck: list[Struck] = []
    for k in range(MAX_STRIKES_AT_ONCE):
        if min(rates) >= -(_slow(solid) if k >= _JAMS_AFTER else STRIKES):
            break
        settled = _settled(solid, y, touching, rates, unsettled)
        if settled is not None:
            return settled._replace(struck=struck + settled.struck)
        group = next_in_turn(solid, y, touching, rates) if first is None else [first]
        first = None
        at_once = None
        if together == SeveralContactsLaw.SIMULTANEOUS and len(touching) > 1:
            at_once = simultaneous_strike(solid, y, touching, law)
            together = SeveralContactsLaw.SEQUENTIAL  # for remaining approaches
        elif len(group) > 1:
            at_once = tied_strike(solid, y, group, law)
        if at_once is None:
            y, outcome = routh(impact, solid, y, group[0])
            new = [Struck(group[0], impact.impulse, OUTCOMES[outcome])]
        else:
            y, new = at_once
        struck += new
        rates = approaches(solid, y, touching)
    if min(rates) < -STRIKES:
        ended = _all_together(sure_impact(solid, y, touching), touching)
        return ended._replace(struck=struck + ended.struck)
    staying = [touch for touch, rate in zip(touching, rates, strict=True) if rate <= STILL_TOUCHING]
    return Strikes(y, struck, staying, settled=False)


def low_rebounds_ended(
    solid: Solid, y: Numbers, touching: list[Touch], unsettled: Unsettled
) -> Strikes | None:
    """Return the state in which contacts with a negligible rebound stay closed, or None if there are none.

    No contact approaches. A contact stays closed if its normal acceleration brings it back before it has
    risen by the solid's `settling`. Its impulse removes the rebound.
    """
    rates = approaches(solid, y, touching)
    fast, is_slow = _slow(solid), False
    for rate in rates:
        if rate < -STRIKES:
            return None
        is_slow = is_slow or STILL_TOUCHING < rate <= fast
    if not is_slow:
        return None
    found = _settled(solid, y, touching, rates, unsettled)
    if found is None:
        return None
    low = [
        touch
        for touch, rate in zip(touching, rates, strict=True)
        if rate > STILL_TOUCHING and touch in found.staying
    ]
    return found._replace(y=without_rebounds(solid, y, found.staying), choice=None) if low else None


def _slow(solid: Solid) -> float:
    """Return the speed, m/s, at which a contact rises by the solid's `settling`."""
    return math.sqrt(2.0 * solid.settling * vec.norm(solid.gravity))


def _settled(
    solid: Solid, y: Numbers, touching: list[Touch], rates: list[float], unsettled: Unsettled
) -> Strikes | None:
    """Return the state after the end of all slow rebounds, or None if a contact still rebounds."""
    fast = 2.0 * solid.settling * vec.norm(solid.gravity)
    for rate in rates:
        if rate < 0.0 and rate * rate > fast:
            return None
    impact = inelastic_impact(solid, y, touching)
    if impact is None:
        return None
    motions = impact.motions
    slow = _slow_ones(solid, touching, motions, fast)
    stopped = _held(solid, impact.y, slow, touching)
    if stopped is not None and not _loses_little(solid, impact.y, stopped):
        # Contacts that stick together stop a turn that moves others fast.
        slow = [Held(one.touch, True) for one in slow]  # noqa: FBT003  C has no keywords
        stopped = _held(solid, impact.y, slow, touching)
    if stopped is None:
        return _all_together(impact, touching)
    touches = [one.touch for one in slow]
    choice = None
    if _loses_little(solid, impact.y, stopped):
        choice = _modes_of(solid, stopped, touches, unsettled)
    staying = None if choice is None else _pressed(solid, stopped, choice, touching, rates, motions)
    if staying is None:
        return None
    known = choice
    if staying != touches:
        stopped = _held(solid, impact.y, [one for one in slow if one.touch in staying], touching)
        known = None
    if stopped is None:
        return _all_together(impact, touching)
    return Strikes(stopped, _struck(impact, touching), staying, settled=True, choice=known)


def _loses_little(solid: Solid, before: Numbers, after: Numbers) -> bool:
    """Return whether the lost kinetic energy could raise the body by at most `settling`, or is rounding."""
    allowed = max(solid.settling * vec.norm(solid.gravity), 0.5 * SLIDING_STOPPED**2)
    return kinetic_energy_of(solid, before) - kinetic_energy_of(solid, after) <= solid.mass * allowed


def _slow_ones(solid: Solid, touching: list[Touch], motions: list[Vector3], fast: float) -> list[Held]:
    """Return the contacts that rise slowly after an impact. ``fast`` is a square, m^2/s^2."""
    slow = []
    for touch, motion in zip(touching, motions, strict=True):
        if motion[2] * motion[2] <= fast:
            flat, speed = solid.flats[touch[0]], motion[0] * motion[0] + motion[1] * motion[1]
            slow.append(Held(touch, speed > fast * flat.friction))
    return slow


def _modes_of(solid: Solid, y: Numbers, touching: list[Touch], unsettled: Unsettled) -> Choice | None:
    """Return the modes of settling contacts, or None if there are none."""
    if unsettled.are(solid, y, touching):
        return None
    choice = choose_mode(solid, y, touching)
    if choice.modes:
        return choice
    unsettled.note(y, touching)
    return None


def _held(solid: Solid, y: Numbers, slow: list[Held], touching: list[Touch]) -> Numbers | None:
    """Return the state with slow contacts held, or None if contacts approach in it."""
    mode = tuple(slow)
    held = held_as_they_are(solid, y, mode)
    return held if min(approaches(solid, held, touching)) >= -STRIKES else None


def _all_together(impact: Inelastic, touching: list[Touch]) -> Strikes:
    """Return the strikes of an impact without restitution at contacts that jam: they cannot all be held.

    Held contacts would then obey more equations than there are degrees of freedom, and the residuals would
    make some of them approach repeatedly. After the impact, the struck contacts have no normal velocity.
    """
    staying = [
        touch for touch, motion in zip(touching, impact.motions, strict=True) if motion[2] <= STILL_TOUCHING
    ]
    return Strikes(impact.y, _struck(impact, touching), staying, settled=True)


def _struck(impact: Inelastic, touching: list[Touch]) -> list[Struck]:
    return [
        Struck(touch, impulse, None, settles=True)
        for touch, impulse in zip(touching, impact.impulses, strict=True)
        if impulse != (0.0, 0.0, 0.0)
    ]


def _pressed(  # noqa: PLR0917
    solid: Solid,
    y: Numbers,
    choice: Choice,
    touching: list[Touch],
    before: list[float],
    motions: list[Vector3],
) -> list[Touch] | None:
    """Return the slow contacts that stay, or None if the force at a struck contact is too small to settle it.

    ``choice`` contains at least one mode of all slow contacts. A contact that stays loses its remaining
    normal velocity. It stays if the force on it is so large that it would rise by less than the solid's
    `settling` before it returns.
    """
    pushed = choice.pushed_in(0, solid, y)
    forces = {one.touch: pushed.force(i) for i, one in enumerate(choice.modes[0])}
    pose = pose_of(solid, y)
    staying = []
    for touch, rate, motion in zip(touching, before, motions, strict=True):
        surface, corner = touch
        flat, arm = solid.flats[surface], pose.arm(surface, corner)
        rebound = max(motion[2], -flat.restitution * rate)
        moment = vec.cross(arm, flat.normal)
        pull = 0.0
        if touch in forces:
            response = 1.0 / solid.mass + vec.dot(moment, vec.times(pose.inverse, moment))
            force = forces[touch]
            pull = response * max(vec.dot(force, flat.normal), 0.0)
        if motion[2] <= STILL_TOUCHING or rebound * rebound <= 2.0 * solid.settling * pull:
            staying.append(touch)
        elif rate < -STRIKES:
            return None
    return staying
