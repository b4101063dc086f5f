"""Finds the contacts of a question: those that it states, or those that geometry finds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.contact.found import find_contacts, nearest_surface
from contact_dynamics.errors import NoContactError

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.subject import Subject
    from contact_dynamics.world import Body, World


def contacts_of(
    named: ContactSet | None, subject: Subject, world: World, *, distance_tolerance: float
) -> ContactSet:
    """Return the contacts that a question states, or else those of the body with the world's surfaces.

    Raises:
        NoContactError: there is none.
    """
    if named is not None:
        if len(named) == 0:
            message = "contacts: found none, allowed is at least one"
            raise NoContactError(message)
        return named
    body = subject.body
    check_has_shape(body)
    contacts = find_contacts(body, subject.state, world.surfaces, distance_tolerance=distance_tolerance)
    if len(contacts) == 0:
        message = f"contacts: no point of {body.name!r} is within {distance_tolerance:g} m of a surface"
        nearest = nearest_surface(body, subject.state, world.surfaces)
        if nearest is None:
            raise NoContactError(f"{message}: the world has none")
        surface, gap = nearest
        raise NoContactError(
            f"{message} (distance_tolerance): the nearest, {surface.name!r}, is {gap:.6g} m away"
        )
    return contacts


def check_has_shape(body: Body) -> None:
    """Raise `NoContactError` for a body without a shape that could touch anything."""
    if body.shape.is_empty:
        message = (
            f"contacts: body {body.name!r} has no shape to find them from, allowed are explicit contacts"
        )
        raise NoContactError(message)
