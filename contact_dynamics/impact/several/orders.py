# SPDX-License-Identifier: Apache-2.0
"""One body strikes at several contacts at once. No single law is accepted for this, so laws have names.

* SEQUENTIAL (Routh 1860; Ivanov 1995; Smith et al. 2012) applies the law for one contact to one contact after
  the other, until none approaches. The contact that approaches fastest comes first. Contacts that approach
  equally fast strike as one (`tied`), so that the order of the list never decides.
* SIMULTANEOUS demands that impulses and velocities are complementary over all contacts (`simultaneous`), with
  Newton's hypothesis (Moreau 1988) or Poisson's (Anitescu and Potra 1997). The energetic law has no such form
  here, because it needs the work at each contact along the path, and this law only knows the path's ends.

`outcomes_over_orders` gives the outcomes that the sequential law reaches over its admissible orders. Their
spread says how far the answer is undecided. A planar problem is put into space (`plane.planar_in_space`).

Moments at the contacts are left out. So are resting contacts that their own sliding would jam, which
`impact.spatial` answers for one contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import islice, permutations
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.velocities import warn_if_far
from contact_dynamics.errors import TooLargeError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import ResolvedImpact, SeveralContactsLaw
from contact_dynamics.impact.several.sequential import (
    Touching,
    bodies_impact,
    check_touching,
    strike_in_turn,
)
from contact_dynamics.records import Record
from contact_dynamics.tolerances import SAME_IMPULSES, VELOCITY_TOLERANCE
from contact_dynamics.validation import FloatArray, check_positive, check_whole

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties

MAX_ORDERS: Final = 120
"""Number of orders that `outcomes_over_orders` tries. These are all orders of up to five contacts."""

FIRST_TRIED: Final = 8
"""Contacts that a warning of an open order names and tries as the first: as many as a flat rim has."""

MAX_STRIKES_OVER_ORDERS: Final = 6000
"""Bound on the strikes of all these orders together, which take some 2 s. An order takes ten or twenty
strikes, and more only where contacts throw each other back for long."""


def several_impact(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    several_contacts_law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> ResolvedImpact:
    """Return the outcome of an impact of ``body`` at all ``contacts``, under the chosen laws.

    For a landing on an edge or face, pass the body, ``landing.state`` and ``landing.contacts``.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Pose and velocities just before the impact.
        contacts: All touching contacts, whether or not they approach; at least one.
        several_contacts_law: Law for several contacts.
        restitution_law: Law of restitution. ENERGETIC requires SEQUENTIAL.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly has no impact.

    Raises:
        SeparatingContactError: all contacts separate.
        InvalidFieldError: there are no contacts, the tolerance is not > 0, or ENERGETIC and SIMULTANEOUS are
            combined.

    Examples:
        >>> import contact_dynamics as cd
        >>> box = cd.Body.box((0.1, 0.1, 0.1), mass=1.0)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5
        ... )
        >>> dropped = cd.BodyState(p_WB_W=[0, 0, 0.5], q_WB=[0, 0, 0, 1])
        >>> landing = cd.next_landing(box, dropped, cd.World(surfaces=(floor,)))
        >>> impact = cd.several_impact(box, landing.state, landing.contacts)
        >>> print(len(landing.contacts), landing.state.v_WB_W.round(2), impact.state.v_WB_W.round(2))
        4 [ 0.    0.   -2.97] [0.   0.   1.49]
    """
    warn_if_far(body, state, contacts.p_WC_W)
    return bodies_impact(
        [body],
        [state],
        contacts,
        [(0, None)] * len(contacts),
        several_contacts_law=several_contacts_law,
        restitution_law=restitution_law,
        velocity_tolerance=velocity_tolerance,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class OrderedOutcomes(Record):
    """Outcomes of a law for several contacts over orders of the contacts. Row i belongs to order i.

    Attributes:
        orders: Contacts that struck in each sequence, or the order that led to a simultaneous solution. Empty
            for the law's own solution if it has no order, because contacts strike at once.
        velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after the impact, world axes.
        complete: Whether every order of the contacts was tried.
        not_converged: Number of orders that are omitted because they reached the limit on strikes or
            iterations.
    """

    orders: tuple[tuple[int, ...], ...]
    velocities_W: FloatArray
    complete: bool
    not_converged: int

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between outcomes in each component, (6,), m/s and rad/s."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread


def outcomes_over_orders(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    max_orders: int = MAX_ORDERS,
) -> OrderedOutcomes:
    """Return the outcomes of the sequential law over its admissible orders.

    Each order follows from a priority of the contacts: at each step, the first approaching contact in the
    priority is resolved. Different priorities can lead to the same order, which is listed once. The outcome
    of `several_impact`, in which the fastest approach is resolved first, is always included; it is the last
    one if no priority leads to it. If it resolves contacts of equal approach speed together, it has an empty
    order and is the first one.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Pose and velocities just before the impact.
        contacts: All touching contacts; at least one.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly has no impact.
        max_orders: Largest number of priorities to try, >= 1. ``complete`` of the result is true if these
            were all.

    Raises:
        SeparatingContactError: all contacts separate.
        InvalidFieldError: there are no contacts, the tolerance is not > 0, or ``max_orders`` is not a whole
            number >= 1.
        TooLargeError: the orders require more impacts in total than `MAX_STRIKES_OVER_ORDERS`.
    """
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    n = len(contacts)
    touching = Touching([body.mass_properties], contacts, [(0, None)] * n, restitution_law, tolerance)
    check_touching(touching, [state])
    max_orders = check_whole("max_orders", max_orders, 1)
    own = strike_in_turn(touching, [state])
    found: dict[tuple[int, ...], FloatArray] = {}
    if own.ties and own.converged:
        found[()] = _velocities(own.states[0])
    struck, lost = len(own.strikes), 0
    for priority in islice(permutations(range(n)), max_orders):
        turn = strike_in_turn(touching, [state], priority=priority)
        struck += len(turn.strikes)
        if struck > MAX_STRIKES_OVER_ORDERS:
            count = f"{n} contacts, over whose orders there are more strikes"
            raise TooLargeError("contacts", count, f"at most {MAX_STRIKES_OVER_ORDERS} over all orders")
        if turn.converged:
            found[turn.order] = _velocities(turn.states[0])
        else:
            lost += 1
    if not own.ties and own.converged:
        found[own.order] = _velocities(own.states[0])
    return OrderedOutcomes(
        orders=tuple(found),
        velocities_W=np.array(list(found.values())).reshape(-1, 6),
        complete=math.factorial(n) <= max_orders,
        not_converged=lost,
    )


def with_orders(impact: ResolvedImpact, outcomes: OrderedOutcomes) -> ResolvedImpact:
    """Return an impact with the outcomes over the admissible orders of its contacts."""
    return replace(
        impact,
        orders=outcomes.orders,
        order_velocities_W=outcomes.velocities_W,
        orders_complete=outcomes.complete,
        orders_not_converged=outcomes.not_converged,
    )


def order_warning(
    bodies: Sequence[MassProperties],
    states: Sequence[BodyState],
    contacts: ContactSet,
    pairs: Sequence[tuple[int, int | None]],
    *,
    restitution_law: RestitutionLaw,
    velocity_tolerance: float,
) -> str:
    """Return in words that the order of strikes decides the sequential law's answer, or an empty text.

    Each contact that approaches is tried as the first. So the differences that are named are found ones, and
    `outcomes_over_orders` may find larger ones.
    """
    touching = Touching(bodies, contacts, pairs, restitution_law, velocity_tolerance)
    own = strike_in_turn(touching, states)
    if not own.order_is_open:
        return ""
    approach = np.einsum("ij,ij->i", check_touching(touching, states), contacts.normals_W)
    first = np.flatnonzero(approach < -velocity_tolerance).tolist()
    named = f"{', '.join(map(str, first[:FIRST_TRIED]))}{', ...' if len(first) > FIRST_TRIED else ''}"
    if len(first) == 1:
        return "several contacts approach after the first impact, and their order can matter (include_orders)"
    outcomes = [
        np.concatenate([_velocities(state) for state in turn.states]).reshape(-1, 6)
        for turn in (own, *(strike_in_turn(touching, states, first=i) for i in first[:FIRST_TRIED]))
    ]
    linear, angular = np.abs(outcomes - outcomes[0]).reshape(len(outcomes), -1, 2, 3).max(axis=(0, 1, 3))
    scale = float(np.abs(outcomes).max())
    if max(linear, angular) <= SAME_IMPULSES * scale:
        return ""
    how = "together" if own.ties else "one at a time, the fastest approach first"
    return (
        f"contacts {named} are resolved {how}: "
        f"other orders differ by up to {linear:.3g} m/s and {angular:.3g} rad/s (include_orders)"
    )


def _velocities(state: BodyState) -> FloatArray:
    return np.concatenate([state.v_WB_W, state.w_WB_W])
