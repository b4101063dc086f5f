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

from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact.found import check_not_inside
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.in_time.meetings import FoundMeetings, NamedMeetings
from contact_dynamics.impact.in_time.result import carried_by
from contact_dynamics.impact.in_time.strike_by_strike import StrikeByStrike
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.landing.search_work import SearchWork
from contact_dynamics.tolerances import (
    DISTANCE_TOLERANCE,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import (
    check_array,
    check_at_rest,
    check_not_negative,
    check_positive,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact.in_time.result import ImpactSequence
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties
    from contact_dynamics.world import Body, World

STRIKE_WINDOW: Final = 0.05
"""s. A cube of 0.1 m whose first corner has struck at 1 m/s lands with the others within it."""

MAX_STRIKES: Final = 200
"""Strikes after which a sequence ends unfinished. Rebounds of e = 0.9 have lost their height by then."""


def impact_sequence(
    body: Body,
    state: BodyState,
    world: World,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    window: float = STRIKE_WINDOW,
    max_strikes: int = MAX_STRIKES,
    distance_tolerance: float = DISTANCE_TOLERANCE,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    hold_step: float | None = None,
) -> ImpactSequence:
    """Return the strikes of a body's corners on the world's surfaces, from a state in contact or in flight.

    Args:
        body: Mass properties and corners.
        state: Initial pose and velocities. The first strike must also be within the window.
        world: Surfaces and gravity. Surfaces may move if all have the same velocity and acceleration and none
            turns.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        window: s, > 0. Longest flight between two strikes of one landing.
        max_strikes: Largest number of strikes, >= 1.
        distance_tolerance: m, >= 0. A corner within this distance of a surface touches it.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly does not strike.
        hold_step: s, > 0. Time step with which the sequence continues if a contact stays closed. If it is
            None, the sequence ends there.

    Raises:
        TooLargeError: the sequence takes too many strikes, or too many steps over contacts that stay closed.
        InvalidFieldError: a number is out of range, or the body penetrates a surface by more than the
            tolerance.
        NoContactError: the body has no shape that could touch anything.
        NotSupportedError: surfaces move differently or turn.
    """
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    held = None if hold_step is None else check_positive("hold_step", hold_step)
    world, frame = world.seen_from_surfaces("impact_sequence")
    state = state if frame is None else frame.seen(state)
    check_not_inside(body, state, world.surfaces, distance_tolerance=distance_tolerance)
    work = SearchWork("strike_window")
    meetings = FoundMeetings(
        body,
        world,
        frame=frame,
        distance_tolerance=distance_tolerance,
        velocity_tolerance=tolerance,
        work=work,
    )
    sequence = StrikeByStrike(
        body.mass_properties,
        world.gravity_W,
        meetings,
        restitution_law,
        tolerance=tolerance,
        hold_step=held,
        work=work,
    )
    return carried_by(sequence.run(state, check_positive("window", window), max_strikes), frame)


def impact_sequence_of(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    window: float = STRIKE_WINDOW,
    max_strikes: int = MAX_STRIKES,
    distance_tolerance: float = DISTANCE_TOLERANCE,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    hold_step: float | None = None,
) -> ImpactSequence:
    """Return the strikes at given contacts. Each contact is a point of the body on the plane that it touches.

    Each point can strike only its own plane: immediately if it approaches, and whenever it returns to the
    plane.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Initial pose and velocities.
        contacts: All touching contacts, whether or not they approach.
        gravity_W: (3,), m/s^2, world axes.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        window: s, > 0. Longest flight between two strikes of one landing.
        max_strikes: Largest number of strikes, >= 1.
        distance_tolerance: m, >= 0. A point within this distance of its plane touches it.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly does not strike.
        hold_step: s, > 0. Time step with which the sequence continues if a contact stays closed. If it is
            None, the sequence ends there.

    Raises:
        TooLargeError: the sequence takes too many strikes, or too many steps over contacts that stay closed.
        InvalidFieldError: a number is out of range, or a contact has a curvature and is therefore not a fixed
            point of the body.
    """
    body = body.mass_properties
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    held = None if hold_step is None else check_positive("hold_step", hold_step)
    if contacts.body_curvatures is not None or contacts.surface_curvatures is not None:
        raise InvalidFieldError("contacts.curvatures", "some", "none: a point of the body on a plane")
    check_at_rest("contacts", contacts, "impact_sequence_of")
    _ = contacts.impact_restitutions
    gravity = check_array("gravity_W", gravity_W, (3,))
    work = SearchWork("strike_window")
    meetings = NamedMeetings(
        body,
        state,
        contacts,
        gravity_W=gravity,
        distance_tolerance=check_not_negative("distance_tolerance", distance_tolerance),
        velocity_tolerance=tolerance,
        work=work,
    )
    sequence = StrikeByStrike(
        body, gravity, meetings, restitution_law, tolerance=tolerance, hold_step=held, work=work
    )
    return sequence.run(state, check_positive("window", window), max_strikes)
