# SPDX-License-Identifier: Apache-2.0
"""Several bodies strike each other and the fixed world at several contacts at once.

The laws are those of one body (`orders`). SEQUENTIAL strikes one contact after the other, each as the impact
of the two bodies that meet there (`impact.spatial`), and contacts that tie as one (`tied`). SIMULTANEOUS
solves one complementarity problem over all contacts and bodies (`simultaneous`). Momentum and angular
momentum of bodies that do not touch the world are conserved to rounding.

For Newton's cradle of equal balls at e = 1 the two laws differ, and rigid-body mechanics allows both. The
sequential law lets the last ball leave, as ball bearings do. The simultaneous one moves all of them.

Not covered: moments at the contacts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.pairs import check_one_time, check_pairs
from contact_dynamics.errors import NORMAL_HINT, InvalidFieldError, SeparatingContactError
from contact_dynamics.impact.energy import created
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import (
    ResolvedImpact,
    SeveralContactsLaw,
    in_terms_of_strikes,
)
from contact_dynamics.impact.several.simultaneous import simultaneous_impulses
from contact_dynamics.impact.several.tied import (
    materials_of,
    next_to_strike,
    pushed,
    response_of,
    strike_as_one,
)
from contact_dynamics.impact.spatial.one_contact import check_striking, spatial_impact, spatial_pair_impact
from contact_dynamics.tolerances import TIED_APPROACH, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_positive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact.spatial.result import SpatialImpact
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
    from contact_dynamics.validation import FloatArray

MAX_STRIKES: Final = 1000
"""Single impacts after which a sequence counts as not converged. Sequences of body and floor shrink by a
fixed factor each round, so that they come to rest within a few dozen."""


def bodies_impact(
    bodies: Sequence[HasMassProperties],
    states: Sequence[BodyState],
    contacts: ContactSet,
    pairs: Sequence[tuple[int, int | None]],
    *,
    several_contacts_law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> ResolvedImpact:
    """Return the outcome of an impact of several bodies at all ``contacts``, under the chosen laws.

    Args:
        bodies: Each a `Body`, or its `MassProperties`.
        states: Pose and velocities of each body just before the impact.
        contacts: All touching contacts, whether or not they approach; at least one.
        pairs: For each contact, the body into which its normal points, and the other body. Both are indices
            into ``bodies``; the second is None for the world.
        several_contacts_law: Law for several contacts.
        restitution_law: Law of restitution. ENERGETIC requires SEQUENTIAL.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly has no impact.

    Raises:
        SeparatingContactError: all contacts separate.
        InvalidFieldError: there are no contacts, lists differ in length, an index is out of range, the
            tolerance is not > 0, the stamps of the states differ, or ENERGETIC and SIMULTANEOUS are combined.
    """
    masses = [each.mass_properties for each in bodies]
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    check_pairs(len(masses), states, contacts, pairs)
    check_one_time(states, "states")
    touching = Touching(masses, contacts, pairs, restitution_law, tolerance)
    before = check_touching(touching, states)
    if several_contacts_law == SeveralContactsLaw.SEQUENTIAL:
        strikes, after, converged, order_is_open, _ = strike_in_turn(touching, states)
        found = in_terms_of_strikes(strikes, masses, states, after, count=len(contacts))
    else:
        response = response_of(masses, states, contacts.p_WC_W, pairs, contacts.surface_velocities_W)
        impulses, converged = simultaneous_impulses(contacts, restitution_law, response, tolerance=tolerance)
        after, order_is_open = pushed(response, states, impulses), False
        found = in_terms_of_strikes((), masses, states, after, count=len(contacts))
        found["impulses_W"] = impulses
    surfaces = contacts.surface_velocities_W
    work = 0.0 if surfaces is None else float(np.sum(found["impulses_W"] * surfaces))
    first, last = found["kinetic_energy_before"], found["kinetic_energy_after"]
    return ResolvedImpact(
        several_contacts_law=several_contacts_law,
        restitution_law=restitution_law,
        converged=converged,
        velocities_before_W=before,
        velocities_after_W=_relative_velocities(touching, after),
        creates_energy=created(last - first - work, first + abs(work)),
        order_is_open=order_is_open,
        **found,
    )


class Touching(NamedTuple):
    """Bodies in contact, and the laws of their strikes."""

    bodies: Sequence[MassProperties]
    contacts: ContactSet
    pairs: Sequence[tuple[int, int | None]]  # for each contact, the body of its normal and the other or None
    restitution_law: RestitutionLaw
    tolerance: float  # m/s; a contact that approaches less fast does not strike


def check_touching(touching: Touching, states: Sequence[BodyState]) -> FloatArray:
    """Return the contacts' velocities, (n, 3), m/s. Refuse sets in which none touches or approaches."""
    contacts, tolerance = touching.contacts, touching.tolerance
    if len(contacts) == 0:
        raise InvalidFieldError("contacts", "none", "at least one contact")
    _ = contacts.impact_restitutions
    for index, (body, state) in enumerate(zip(touching.bodies, states, strict=True)):
        check_striking(body, state, contacts.p_WC_W[[i for i, p in enumerate(touching.pairs) if index in p]])
    velocities = _relative_velocities(touching, states)
    slowest = float(np.einsum("ij,ij->i", velocities, contacts.normals_W).min())
    if slowest > tolerance:
        raise SeparatingContactError(
            "contact normal velocity",
            f"v_n >= {slowest:.9g} m/s at every contact",
            f"one of at most {tolerance:g} m/s ({NORMAL_HINT})",
        )
    return velocities


class InTurn(NamedTuple):
    """What striking in turn leads to.

    Tied contacts follow each other, each with its share and the states after all of them.
    """

    strikes: tuple[tuple[int, SpatialImpact], ...]
    states: list[BodyState]  # afterwards
    converged: bool  # no contact approaches then
    order_is_open: bool  # several contacts approached at one time
    ties: bool  # tied contacts struck as one

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order."""
        return tuple(contact for contact, _ in self.strikes)


def strike_in_turn(
    touching: Touching,
    states: Sequence[BodyState],
    *,
    priority: tuple[int, ...] | None = None,
    first: int | None = None,
) -> InTurn:
    """Strike one contact after the other until none approaches.

    The order follows ``priority`` or, if that is None, the fastest approach comes first, and tied contacts
    strike as one. If ``first`` is given, that contact, which approaches, is struck before.
    """
    now = list(states)
    strikes: list[tuple[int, SpatialImpact]] = []
    tie, is_open, ties = 0.0, False, False
    if first is not None:
        strikes.append((first, _strike(touching, now, first)))
    while len(strikes) < MAX_STRIKES:
        velocities = _relative_velocities(touching, now)
        tie = tie or TIED_APPROACH * float(np.abs(velocities).max())
        approach = np.einsum("ij,ij->i", velocities, touching.contacts.normals_W)
        is_open = is_open or int((approach < -touching.tolerance).sum()) > 1
        group = _next_contacts(approach, touching, priority, tie)
        if not group:
            return InTurn(tuple(strikes), now, converged=True, order_is_open=is_open, ties=ties)
        if len(group) == 1:
            strikes.append((group[0], _strike(touching, now, group[0])))
        else:
            strikes += _tied(touching, now, group)
            ties = True
    return InTurn(tuple(strikes), now, converged=False, order_is_open=is_open, ties=ties)


def _tied(touching: Touching, states: list[BodyState], group: list[int]) -> list[tuple[int, SpatialImpact]]:
    """Return the share of each contact in an impact of tied ones, and replace the states."""
    contacts, pairs = touching.contacts.subset(group), [touching.pairs[i] for i in group]
    shares, states[:] = strike_as_one(
        touching.bodies,
        states,
        contacts,
        pairs,
        law=touching.restitution_law,
        tolerance=touching.tolerance,
    )
    return list(zip(group, shares, strict=True))


def _strike(touching: Touching, states: list[BodyState], contact: int) -> SpatialImpact:
    """Return the impact at one contact, and replace the states of its bodies by those after it."""
    bodies, contacts = touching.bodies, touching.contacts
    first, second = touching.pairs[contact]
    touch, law = contacts[contact], touching.restitution_law
    # Half the tolerance counts here, because the approach was judged by a sum that rounds differently.
    tolerance = 0.5 * touching.tolerance
    if second is None:
        impact = spatial_impact(
            bodies[first], states[first], touch, restitution_law=law, velocity_tolerance=tolerance
        )
    else:
        impact = spatial_pair_impact(
            bodies[first],
            states[first],
            bodies[second],
            states[second],
            touch,
            restitution_law=law,
            velocity_tolerance=tolerance,
        )
        if impact.other_state is not None:
            states[second] = impact.other_state
    states[first] = impact.state
    return impact


def _relative_velocities(touching: Touching, states: Sequence[BodyState]) -> FloatArray:
    """Return the velocities, (n, 3), m/s, of the first body of each contact relative to what it touches."""
    contacts, pairs = touching.contacts, touching.pairs
    velocities = np.zeros((len(contacts), 3))
    if contacts.surface_velocities_W is not None:
        velocities -= contacts.surface_velocities_W
    for index, state in enumerate(states):
        for sign, rows in (
            (1.0, [i for i, (first, _) in enumerate(pairs) if first == index]),
            (-1.0, [i for i, (_, second) in enumerate(pairs) if second == index]),
        ):
            if rows:
                velocities[rows] += sign * state.velocity_of_point(contacts.p_WC_W[rows])
    return velocities


def _next_contacts(
    approach: FloatArray, touching: Touching, priority: tuple[int, ...] | None, tie: float
) -> list[int]:
    """Return the contacts that strike next, several if they tie, or none if none approaches."""
    if priority is not None:
        return [i for i in priority if approach[i] < -touching.tolerance][:1]
    materials = materials_of(touching.contacts)
    return next_to_strike(approach.tolist(), materials, tolerance=touching.tolerance, tie=tie)
