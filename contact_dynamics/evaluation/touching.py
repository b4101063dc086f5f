"""Which surface a measured body is nearest to, and which of its points touch it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact_dynamics.contact.found import contacts_within
from contact_dynamics.records import Record
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.world import Body, World


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Touch(Record):
    """What a body touches.

    Attributes:
        surface: Name of the nearest surface.
        gap: m, height of the body's lowest point above it, negative below. It is None at an obstacle, whose
            contacts tell no height.
        contacts: All contacts, with whichever surface.
    """

    surface: str
    gap: float | None
    contacts: ContactSet


def touch_of(body: Body, state: BodyState, world: World, *, within: float) -> Touch | None:
    """Return what a body touches within that gap, m. Without a shape or a surface it touches nothing."""
    if body.shape.is_empty or not world.surfaces:
        return None
    contacts = contacts_within(body, state, world.surfaces, within)
    if len(contacts) == 0:
        return None
    flats = {surface.name: surface for surface in world.surfaces if isinstance(surface, Surface)}
    gaps = [
        (float(flats[name].gaps(point)), name)
        for name, point in zip(contacts.surfaces, contacts.p_WC_W, strict=True)
        if name in flats
    ]
    if not gaps:
        return Touch(surface=contacts.surfaces[0], gap=None, contacts=contacts)
    gap, surface = min(gaps)
    return Touch(surface=surface, gap=gap, contacts=contacts)
