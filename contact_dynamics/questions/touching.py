"""Finds the contacts of a question: those that it states, or those that geometry finds."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.found import find_contacts, nearest_surface
from contact_dynamics.contact.noise import NoisyState, resting, touching
from contact_dynamics.errors import NoContactError
from contact_dynamics.questions.extent import check_extent
from contact_dynamics.shapes.hull_features import RIM_CORNERS, features_of
from contact_dynamics.shapes.obstacle import closest_points
from contact_dynamics.tolerances import DISTANCE_TOLERANCE

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
            message = "contacts must be at least one, got none"
            raise NoContactError(message)
        return named
    body = subject.body
    check_has_shape(body)
    contacts = find_contacts(body, subject.state, world, distance_tolerance=distance_tolerance)
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


def in_contact(
    named: ContactSet | None,
    subject: Subject,
    world: World,
    *,
    distance_tolerance: float,
    velocity_tolerance: float,
) -> tuple[Subject, ContactSet, NoisyState | None]:
    """Return a subject and its contacts, which touch and rest where the noise of its state allows it.

    Without a covariance the state is exact. With one, it is the likeliest state in which the contacts that
    may touch and rest do so (`contact.noise`). The third value is then the state, with its noise, in which
    they touch and nothing is known yet of rest.

    Raises:
        NoContactError: there is no contact.
    """
    if subject.covariance is None:
        return subject, contacts_of(named, subject, world, distance_tolerance=distance_tolerance), None
    check_extent(subject.body.mass_properties, subject.state)
    noisy = NoisyState.of(subject.state, subject.covariance)
    if named is None and not subject.body.shape.is_empty:
        noisy = touching(subject.body, noisy, world.surfaces, distance_tolerance=distance_tolerance)
        subject = replace(subject, state=noisy.state)
    contacts = contacts_of(named, subject, world, distance_tolerance=distance_tolerance)
    found = resting(noisy, contacts, velocity_tolerance=velocity_tolerance)
    return replace(subject, state=found.state, covariance=found.root @ found.root.T), contacts, noisy


def outside_shape(contacts: ContactSet, subject: Subject, *, distance_tolerance: float) -> tuple[str, ...]:
    """Return a warning for each stated contact that is farther outside of the body's known shape, m.

    A rim counts as the hull of some of its points, widened by what these leave out.
    """
    shape, state = subject.body.shape, subject.state
    if shape.is_empty:
        return ()
    features = features_of(shape)
    points_B = (contacts.p_WC_W - state.p_WB_W) @ state.R_WB
    gaps = np.linalg.norm(points_B - closest_points(features, points_B), axis=1) - shape.rounding
    if len(features.triangles) > 0:
        levels = (features.normals @ features.corners.T).max(axis=1)
        inside = (points_B @ features.normals.T <= levels).all(axis=1)
        gaps[inside] = 0.0
    largest = max((rim.radius for rim in shape.rims), default=0.0)
    left_out = largest * (1.0 - math.cos(math.pi / RIM_CORNERS))
    return tuple(
        f"contact {i} is {gap:.6g} m outside of the shape of {subject.body.name!r}"
        for i, gap in enumerate(gaps.tolist())
        if gap > max(distance_tolerance, DISTANCE_TOLERANCE) + left_out
    )


def check_has_shape(body: Body) -> None:
    """Raise `NoContactError` for a body without a shape that could touch anything."""
    if body.shape.is_empty:
        message = (
            f"contacts must be given explicitly, since body {body.name!r} has no shape to find them from"
        )
        raise NoContactError(message)
