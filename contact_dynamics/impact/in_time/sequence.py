# SPDX-License-Identifier: Apache-2.0
"""A landing takes time: corners strike some milliseconds apart, with free flight between the strikes.

In recordings of real bodies, contacts that look simultaneous are mostly not. One corner strikes, the body
flies on, and another corner strikes. Each strike is Routh's impact at one contact (`impact.spatial`). Each
flight is free motion in closed form (`tumbling`). The next strike is found to rounding (`landing`), and
nothing is stepped. Contacts of one instant are struck one after the other, the fastest approach first and
tied ones as one, as in the sequential law (`impact.several`). Their order is a choice. The order of different
instants is not.

The sequence ends where nothing strikes within a window, where a contact stays, or where strikes accumulate.
Rebounds that shrink by a ratio r < 1 have all ended d / (1 - r) after a strike whose rebound takes d (Zeno).
Then free flight is over. Contact modes, not impacts, then say which contacts stay, slide or roll.

With a ``hold_step`` the sequence goes on. The body moves freely for that time, then an impulse without
restitution takes away the contact's approach (Moreau's time-stepping, with Coulomb's friction), and so on
until the contact leaves. Only this part is an approximation, of first order in the step. Times are known to a
step, the contact sinks by half a step's fall each time, and other contacts that approach by at most two
steps' fall are held too.

A resting contact that its own sliding jams is not covered.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.found import check_not_inside
from contact_dynamics.contact.pairs import check_with_world
from contact_dynamics.contact.velocities import velocity_accelerations
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.energy import created
from contact_dynamics.impact.in_time.meetings import FoundMeetings, NamedMeetings
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import (
    ImpactSequence,
    SequenceEnd,
    SequenceStrike,
    SeveralContactsLaw,
    in_terms_of_strikes,
)
from contact_dynamics.impact.several.tied import materials_of, next_to_strike, strike_as_one
from contact_dynamics.impact.spatial.one_contact import spatial_impact
from contact_dynamics.landing.search_work import SearchWork
from contact_dynamics.rotations.many import crosses
from contact_dynamics.rotations.one import cross_matrix
from contact_dynamics.tolerances import (
    CHATTER_HEIGHT,
    CHATTER_PAUSE,
    DISTANCE_TOLERANCE,
    HELD_STILL,
    TIED_APPROACH,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.tumbling import Precision, free_motion
from contact_dynamics.validation import (
    check_at_rest,
    check_not_negative,
    check_positive,
    check_whole,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact.in_time.meetings import Meetings
    from contact_dynamics.impact.spatial.result import SpatialImpact
    from contact_dynamics.landing.earliest import Landing
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, SurfaceFrame, World


STRIKE_WINDOW: Final = 0.05
"""s. A cube of 0.1 m whose first corner has struck at 1 m/s lands with the others within it."""

MAX_STRIKES: Final = 200
"""Strikes after which a sequence ends unfinished. Rebounds of e = 0.9 have lost their height by then."""


def impact_sequence(
    body: Body,
    state: BodyState,
    world: World,
    *,
    contacts: ContactSet | None = None,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    window: float = STRIKE_WINDOW,
    max_strikes: int = MAX_STRIKES,
    distance_tolerance: float = DISTANCE_TOLERANCE,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    hold_step: float | None = None,
) -> ImpactSequence:
    """Return the impacts of a body over time, from a state in contact or in flight.

    Args:
        body: Mass properties, and corners if contacts are detected.
        state: Initial pose and velocities. The first impact must also be within the window.
        world: Surfaces and gravity. Surfaces may move if all have the same velocity and acceleration and none
            rotates.
        contacts: All touching contacts, whether or not they approach. Each is a point of the body on a plane,
            and can hit only this plane: immediately if it approaches, and whenever it returns. If None,
            contacts of the body's corners with the world's surfaces are detected.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        window: s, > 0. Longest flight between two impacts of one landing.
        max_strikes: Largest number of impacts, >= 1.
        distance_tolerance: m, >= 0. A corner within this distance of a surface touches it.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly has no impact.
        hold_step: s, > 0. Time step with which the sequence continues if a contact stays closed. If it is
            None, the sequence ends there.

    Raises:
        TooLargeError: the sequence requires too many impacts, or too many time steps with closed contacts.
        InvalidFieldError: a number is out of range, the body penetrates a surface by more than the
            tolerance, or one of ``contacts`` has a curvature.
        NoContactError: the body has no shape that could touch anything.
        NotSupportedError: surfaces move differently or rotate, or one of ``contacts`` has a moving surface.
    """
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    held = None if hold_step is None else check_positive("hold_step", hold_step)
    work, frame = SearchWork("strike_window"), None
    meetings: Meetings
    if contacts is None:
        world, frame = world.seen_from_surfaces("impact_sequence")
        state = state if frame is None else frame.seen(state)
        check_not_inside(body, state, world.surfaces, distance_tolerance=distance_tolerance)
        meetings = FoundMeetings(
            body,
            world,
            frame=frame,
            distance_tolerance=distance_tolerance,
            velocity_tolerance=tolerance,
            work=work,
        )
    else:
        if contacts.body_curvatures is not None or contacts.surface_curvatures is not None:
            raise InvalidFieldError("contacts.curvatures", "some", "none: a point of the body on a plane")
        check_at_rest("contacts", contacts, "impact_sequence")
        check_with_world("contacts", contacts.surfaces)
        _ = contacts.impact_restitutions
        meetings = NamedMeetings(
            body.mass_properties,
            state,
            contacts,
            gravity_W=world.gravity_W,
            distance_tolerance=check_not_negative("distance_tolerance", distance_tolerance),
            velocity_tolerance=tolerance,
            work=work,
        )
    sequence = _StrikeByStrike(
        body.mass_properties,
        world.gravity_W,
        meetings,
        restitution_law,
        frame=frame,
        tolerance=tolerance,
        hold_step=held,
        work=work,
    )
    return sequence.run(state, check_positive("window", window), max_strikes)


HELD: Final = 2.0
"""Largest approach of a held contact, relative to the speed that a step of free motion gives it. If it is
faster, something else struck."""

MAX_HELD: Final = 100
"""Bound on the impulses that hold contacts at one instant. Two ends of a rod need four, the corners of a face
some ten."""

ROUND: Final = 20
"""Steps of the search that a strike counts for besides its own search. A step over contacts that stay counts
for as many. So a sequence comes to an end within some 2500 of both."""

STILL: Final = 0.1
"""Speed of a held body after a step below which it rests, relative to the speed that a step of free motion
gives it. A body that begins to fall over is faster, unless it is balanced to within some degrees."""


class _StrikeByStrike:
    """Resolves one strike after the other, and decides where the sequence waits, continues or ends."""

    def __init__(
        self,
        body: MassProperties,
        gravity_W: FloatArray,
        meetings: Meetings,
        law: RestitutionLaw,
        *,
        frame: SurfaceFrame | None,
        tolerance: float,
        hold_step: float | None,
        work: SearchWork,
    ) -> None:
        self.work = work
        self.body, self.gravity_W, self.meetings = body, gravity_W, meetings
        self.law, self.tolerance, self.hold_step = law, tolerance, hold_step
        self.frame = frame  # in which surfaces are at rest
        self.strikes: list[SequenceStrike] = []  # in world axes
        self.impacts: list[tuple[int, SpatialImpact]] = []  # the same in the frame, each with its contact
        self.creates_energy = False
        self.chattering: tuple[tuple[int, ...], float] | None = None  # struck last, if so, and the limit time
        self.limit: float | None = None
        self.staying: tuple[int, ...] = ()
        self.order_is_open = False
        self._lifted: tuple[Landing, FloatArray] | None = None  # the last landing's accelerations

    def run(self, state: BodyState, window: float, max_strikes: int) -> ImpactSequence:
        """Return the sequence from a state on. Each strike comes within a window, s, of the one before."""
        most = check_whole("max_strikes", max_strikes, 1)
        end = self._strike_on(state, window, most)
        if end == SequenceEnd.NOTHING_STRIKES and not self.strikes:
            end = SequenceEnd.WINDOW_ENDED
        stays = end in {SequenceEnd.STAYS, SequenceEnd.CHATTERS}
        first = self.strikes[0].state_before if self.strikes else self._in_world(state, 0.0)
        last = self.strikes[-1].state_after if self.strikes else first
        contacts = self.meetings.contacts
        before, after = np.zeros((2, len(contacts), 3))
        for contact, impact in reversed(self.impacts):
            before[contact] = impact.velocity_before_W
        for contact, impact in self.impacts:
            after[contact] = impact.velocity_after_W
        return ImpactSequence(
            restitution_law=self.law,
            several_contacts_law=SeveralContactsLaw.SEQUENTIAL,
            converged=end != SequenceEnd.MAX_STRIKES,
            velocities_before_W=before,
            velocities_after_W=after,
            creates_energy=self.creates_energy,
            order_is_open=self.order_is_open,
            strikes=tuple(self.strikes),
            end=end,
            staying=self.staying if stays else (),
            limit_seconds=self.limit if stays else None,
            contacts=contacts,
            **in_terms_of_strikes(self.impacts, [self.body], [first], [last], count=len(contacts)),
        )

    def _in_world(self, state: BodyState, seconds: float) -> BodyState:
        return state if self.frame is None else self.frame.in_world(state, seconds)

    def _strike_on(self, state: BodyState, window: float, most: int) -> SequenceEnd:
        now, until = 0.0, window  # s since the beginning
        lifts = 0  # times, since the beginning, that free motion took resting contacts off
        held = 0  # impulses, at this instant, that hold contacts
        while True:
            self.work.spend(ROUND, now)
            landing = self.meetings.next(state, now, until - now)
            if self.chattering is not None and not self._strikes_elsewhere(landing, now):
                self._stay(*self.chattering)
                end, wait = SequenceEnd.CHATTERS, self.hold_step
            elif landing is None:
                return SequenceEnd.NOTHING_STRIKES
            else:
                if landing.seconds > 0.0:  # it has left all contacts meanwhile
                    self.staying, self.limit = (), None
                state = landing.state
                now += landing.seconds
                still = HELD_STILL if held < MAX_HELD else HELD
                if landing.strikes and not self._approaches_by(landing, still):
                    if self._approaches_by(landing, HELD):
                        held += 1
                        state = self._impacts(landing, self._next(landing), held=True)[0].state
                        continue
                    if len(self.strikes) >= most:  # contacts that strike as one may pass the bound
                        return SequenceEnd.MAX_STRIKES
                    state = self._strike(landing, now)
                    until = now + window
                    continue
                lifts += 1
                end, wait = self._wait(landing, now, may_leave=lifts <= most)
            now += wait or 0.0
            if wait is None or now >= until:
                return end
            self.chattering, held = None, 0
            motion = free_motion(self.body, state, gravity_W=self.gravity_W, precision=Precision.DOUBLE)
            state = motion.state_at(wait)

    def _wait(self, landing: Landing, now: float, *, may_leave: bool) -> tuple[SequenceEnd, float | None]:
        """Return why the sequence may end where nothing strikes, and how long to wait before it continues, s.

        If the second is None, the sequence ends here.
        """
        wait = self._time_to_leave(landing)
        if wait is not None and may_leave:
            return SequenceEnd.NOTHING_STRIKES, wait
        lifting = self._lifting(landing)
        rests = self.limit is not None and self._is_still(landing, float(-lifting.min()))
        self._stay(
            tuple(self.meetings.index(landing, int(row)) for row in np.flatnonzero(lifting <= 0.0)), now
        )
        return SequenceEnd.STAYS, None if rests else self.hold_step

    def _is_still(self, landing: Landing, pressing: float) -> bool:
        """Return whether a body that is held has not moved, after a step, by more than holding leaves it."""
        state = landing.state
        reach = float(np.linalg.norm(landing.contacts.p_WC_W - state.p_WB_W, axis=1).max())
        speed = math.hypot(*state.v_WB_W.tolist()) + reach * math.hypot(*state.w_WB_W.tolist())
        return speed <= STILL * pressing * (self.hold_step or 0.0)

    def _stay(self, contacts: tuple[int, ...], since: float) -> None:
        """Note that contacts stay. If contacts stayed before, the time since when is kept."""
        if self.limit is None:
            self.limit = since
        self.staying = contacts

    def _approaches_by(self, landing: Landing, share: float) -> bool:
        """Return whether a contact stays and the fastest approach is within a share of a step's fall."""
        if self.hold_step is None or self.limit is None:
            return False
        row = _fastest(landing)
        speed = -float(landing.velocities_W[row] @ landing.contacts.normals_W[row])
        return speed <= share * self.hold_step * -float(self._lifting(landing)[row])

    def _strike(self, landing: Landing, now: float) -> BodyState:
        """Resolve the strike at the contacts that approach fastest, and return the state after it."""
        contacts, group = landing.contacts, self._next(landing)
        self.chattering = None
        impacts, struck, limits = self._impacts(landing, group, held=False), [], []
        before, after = (self._in_world(each, now) for each in (landing.state, impacts[0].state))
        moved = 0.0 if self.frame is None else self.frame.displacement(now)
        for row, impact in zip(group, impacts, strict=True):
            normal = contacts.normals_W[row]
            approach, rebound = (
                float(-impact.velocity_before_W @ normal),
                float(impact.velocity_after_W @ normal),
            )
            pressing = -float(self._lifting(landing)[row])
            if self.tolerance < rebound < approach and rebound * rebound <= 2.0 * CHATTER_HEIGHT * pressing:
                limits.append(now + 2.0 * rebound / pressing / (1.0 - rebound / approach))
            struck.append(self.meetings.index(landing, row))
            self.strikes.append(
                SequenceStrike(
                    seconds=now,
                    contact=struck[-1],
                    outcome=impact.outcome,
                    p_WC_W=contacts.p_WC_W[row] + moved,
                    impulse_W=impact.impulse_W,
                    state_before=before,
                    state_after=after,
                )
            )
        self.impacts += zip(struck, impacts, strict=True)
        # Where several contacts strike as one, a contact can return energy that another absorbed.
        changes = [impact.energy_change for impact in impacts]
        self.creates_energy |= (
            impacts[0].creates_energy
            if len(impacts) == 1
            else bool(created(sum(changes), sum(map(abs, changes))))
        )
        if len(limits) == len(group):
            self.chattering = tuple(struck), max(limits)
        return impacts[0].state

    def _next(self, landing: Landing) -> list[int]:
        """Return the rows of the contacts that strike next: the fastest, and those that tie with it."""
        approach = _normal_parts(landing.velocities_W, landing.contacts)
        self.order_is_open = self.order_is_open or int((approach < -self.tolerance).sum()) > 1
        tie = TIED_APPROACH * float(np.abs(landing.velocities_W).max())
        materials = materials_of(landing.contacts)
        return next_to_strike(approach.tolist(), materials, tolerance=self.tolerance, tie=tie)

    def _impacts(self, landing: Landing, rows: list[int], *, held: bool) -> Sequence[SpatialImpact]:
        """Return the impact at each of these contacts, which strike as one, without restitution if held."""
        contacts = landing.contacts.subset(rows)
        if held:
            contacts = replace(contacts, restitutions=np.zeros(len(rows)))
        if len(rows) > 1:
            shares, _ = strike_as_one(
                [self.body],
                [landing.state],
                contacts,
                [(0, None)] * len(rows),
                law=self.law,
                tolerance=self.tolerance,
            )
            return shares
        impact = spatial_impact(
            self.body,
            landing.state,
            contacts[0],
            restitution_law=self.law,
            # Half the tolerance counts, because the approach was judged by a sum that rounds differently.
            velocity_tolerance=0.5 * self.tolerance,
        )
        return [impact]

    def _time_to_leave(self, landing: Landing) -> float | None:
        """Return the time, s, in which the free motion takes resting contacts off, or None if they stay."""
        approach = _normal_parts(landing.velocities_W, landing.contacts)
        lifting = self._lifting(landing)
        if len(lifting) == 0:
            return CHATTER_PAUSE
        if not (lifting > 0.0).all():
            return None
        return float(((2.0 * self.tolerance - approach) / lifting).max())

    def _strikes_elsewhere(self, landing: Landing | None, now: float) -> bool:
        """Return whether another contact strikes before the one that chatters has come to rest."""
        if landing is None or self.chattering is None or not landing.strikes:
            return False
        contacts, limit = self.chattering
        return (
            now + landing.seconds < limit and self.meetings.index(landing, _fastest(landing)) not in contacts
        )

    def _lifting(self, landing: Landing) -> FloatArray:
        """Return the accelerations, (n,), m/s^2, that the contacts' gaps have in free motion."""
        if self._lifted is not None and self._lifted[0] is landing:
            return self._lifted[1]
        state, contacts = landing.state, landing.contacts
        w = state.w_WB_W
        inertia, spin = self.body.inertia_in_world(state.R_WB), cross_matrix(w)
        angular = np.array(np.linalg.solve(inertia, crosses(inertia @ w, w)), dtype=np.float64)
        turning = cross_matrix(angular) + spin @ spin
        accelerations = self.gravity_W + (contacts.p_WC_W - state.p_WB_W) @ turning.T
        rolling = velocity_accelerations(contacts, landing.velocities_W, w)
        self._lifted = landing, _normal_parts(accelerations + rolling, contacts)
        return self._lifted[1]


def _fastest(landing: Landing) -> int:
    """Return the row of the contact that approaches fastest."""
    return int(_normal_parts(landing.velocities_W, landing.contacts).argmin())


def _normal_parts(vectors: FloatArray, contacts: ContactSet) -> FloatArray:
    parts: FloatArray = np.einsum("ij,ij->i", vectors, contacts.normals_W)
    return parts
