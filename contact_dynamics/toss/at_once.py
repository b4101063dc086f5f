"""Strikes of several contacts at one instant that have no order: those of a tie, and those of SIMULTANEOUS.

The laws are those of `impact.several`. Contacts that approach equally fast strike as one under SEQUENTIAL, so
that a face that lands flat bounces level.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.orders import several_impact
from contact_dynamics.impact.several.result import SeveralContactsLaw, SeveralVerdict
from contact_dynamics.impact.several.tied import next_to_strike, strike_as_one
from contact_dynamics.numerics.vectors import norm
from contact_dynamics.tolerances import STRIKES, TIED_APPROACH
from contact_dynamics.toss.mode_choice import contacts_of, properties_of, state_of
from contact_dynamics.toss.one_impact import Struck

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.toss.solid import Numbers, Solid, Touch


def check_laws(restitution_law: RestitutionLaw, several_contacts_law: SeveralContactsLaw) -> None:
    """Raise an error if the two laws do not go together."""
    at_once = several_contacts_law == SeveralContactsLaw.SIMULTANEOUS
    if at_once and restitution_law == RestitutionLaw.ENERGETIC:
        raise InvalidFieldError("restitution_law", restitution_law.name, "POISSON or NEWTON for SIMULTANEOUS")


def next_in_turn(solid: Solid, y: Numbers, touching: list[Touch], rates: list[float]) -> list[Touch]:
    """Return the contact that approaches fastest, with those that tie with it and strike as one with it.

    ``rates`` are the normal velocities, m/s, and some contact approaches.
    """
    fastest = min(rates)
    tie = TIED_APPROACH * (norm((y[7], y[8], y[9])) + solid.reach * norm((y[10], y[11], y[12])))
    if sum(rate <= fastest + tie for rate in rates) < 2:
        return [touching[rates.index(fastest)]]
    contacts = _striking(solid, y, touching)
    group = next_to_strike(np.array(rates), contacts, tolerance=STRIKES, tie=tie)
    return [touching[k] for k in group]


def tied_strike(
    solid: Solid, y: Numbers, group: list[Touch], law: RestitutionLaw
) -> tuple[Numbers, list[Struck]]:
    """Return the state after the impact of contacts that strike as one, and the share of each."""
    shares, (after,) = strike_as_one(
        [properties_of(solid)],
        [state_of(y)],
        _striking(solid, y, group),
        [(0, None)] * len(group),
        law=law,
        tolerance=STRIKES,
    )
    struck = [
        Struck(touch, _vector(share.impulse_W.tolist()), share.outcome)
        for touch, share in zip(group, shares, strict=True)
    ]
    return _after(y, after), struck


def simultaneous_strike(
    solid: Solid, y: Numbers, touching: list[Touch], law: RestitutionLaw
) -> tuple[Numbers, list[Struck]] | None:
    """Return the state after the impact at all contacts at once, and each impulse, or None if not found."""
    impact = several_impact(
        properties_of(solid),
        state_of(y),
        _striking(solid, y, touching),
        several_contacts_law=SeveralContactsLaw.SIMULTANEOUS,
        restitution_law=law,
        velocity_tolerance=STRIKES,
    )
    if impact.verdict != SeveralVerdict.RESOLVED:
        return None
    struck = [
        Struck(touch, _vector(impulse), None)
        for touch, impulse in zip(touching, impact.impulses_W.tolist(), strict=True)
        if any(impulse)
    ]
    return _after(y, impact.state), struck


def _striking(solid: Solid, y: Numbers, touching: list[Touch]) -> ContactSet:
    """Return touching contacts with the friction of strikes."""
    contacts = contacts_of(solid, y, touching)
    frictions = [solid.flats[surface].strike_friction for surface, _ in touching]
    return replace(contacts, frictions=np.array(frictions), body_curvatures=None)


def _after(y: Numbers, state: BodyState) -> Numbers:
    return [*y[:7], *state.v_WB_W.tolist(), *state.w_WB_W.tolist()]


def _vector(numbers: list[float]) -> tuple[float, float, float]:
    x, y, z = numbers
    return (x, y, z)
