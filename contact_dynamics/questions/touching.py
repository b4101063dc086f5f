# SPDX-License-Identifier: Apache-2.0
"""Finds the contacts of a question: those that it states, or those that geometry finds."""

from __future__ import annotations

import math
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.found import NO_CONTACTS, contacts_within, find_contacts, nearest_surface
from contact_dynamics.contact.noise import NoisyState, resting, touching
from contact_dynamics.contact.touches import RIM_POINTS
from contact_dynamics.contact.velocities import relative_velocities
from contact_dynamics.errors import NoContactError, NoShapeError, NotSupportedError
from contact_dynamics.questions.extent import check_extent
from contact_dynamics.rigid_body.published_frame import covariance_of_other_point
from contact_dynamics.shapes.hull_features import RIM_CORNERS, features_of
from contact_dynamics.shapes.obstacle import closest_points
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, MOVES_INTO
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.carried_surface import CarrierNoise
    from contact_dynamics.questions.subject import Subject
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

_FAR: Final = 6.0
"""Standard deviations of the distance beyond which a body does not touch a carried plane."""

_SAME_SIDE: Final = 0.99
"""Cosine of the angle between normals from which on a given contact counts as one with a surface."""

_PAIRS_AT_ONCE: Final = 100_000
"""Points times triangles whose distances are worked out together, in some 50 MB."""

_MOST_TOLD: Final = 4  # maximum number of contacts off the shape's surface with a warning each


def contacts_of(
    named: ContactSet | None, subject: Subject, world: World, *, distance_tolerance: float
) -> ContactSet:
    """Return the contacts that a question states, or else those of the body with the world's surfaces.

    Raises:
        NoContactError: there is none.
    """
    if named is not None:
        if len(named) == 0:
            raise NoContactError("contacts must be at least one, got none")
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
            f"{message} (distance_tolerance): the nearest, {surface.name!r}, is {gap:.6g} m away (a measured "
            "state requires a covariance or a larger tolerance)"
        )
    return contacts


def in_contact(
    named: ContactSet | None,
    subject: Subject,
    world: World,
    *,
    distance_tolerance: float,
    velocity_tolerance: float,
    carriers: Sequence[CarrierNoise] = (),
) -> tuple[Subject, ContactSet, NoisyState | None]:
    """Return a subject and its contacts, which touch and rest where the noise of its state allows it.

    The noise of the bodies that carry planes near it, ``carriers``, counts too.

    Without a covariance the state is exact. With one, it is the likeliest state in which the contacts that
    may touch and rest do so (`contact.noise`). The third value is then the state, with its noise, in which
    they touch and nothing is known yet of rest.

    Raises:
        NoContactError: there is no contact.
    """
    subject = _with_noise_of(carriers, subject, distance_tolerance=distance_tolerance)
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


def _with_noise_of(
    carriers: Sequence[CarrierNoise], subject: Subject, *, distance_tolerance: float
) -> Subject:
    """Return a subject with the covariance of its state relative to the carriers of the planes near it.

    A plane is near if the body may touch it within `_FAR` standard deviations. The errors of a carrier are
    those of a rigid motion, which the subject's own errors oppose or add to.
    """
    if subject.body.shape.is_empty:
        return subject
    own = np.zeros((12, 12)) if subject.covariance is None else subject.covariance
    added: dict[str, FloatArray] = {}
    for each in carriers:
        lever_B = each.state.R_WB.T @ (subject.state.p_WB_W - each.state.p_WB_W)
        moved = covariance_of_other_point(each.covariance, each.state, lever_B)
        near = distance_tolerance + _FAR * math.sqrt(float(np.trace((own + moved)[:3, :3])))
        found = nearest_surface(subject.body, subject.state, (each.plane,))
        if found is not None and found[1] <= near:
            added[each.carrier] = moved
    return replace(subject, covariance=own + sum(added.values())) if added else subject


def outside_shape(
    body: Body,
    *,
    points_W: FloatArray,
    p_WB_W: FloatArray,
    R_WB: FloatArray,
    distance_tolerance: float = DISTANCE_TOLERANCE,
    numbers: Sequence[int] | None = None,
) -> tuple[str, ...]:
    """Return warnings of explicit contact points that are outside of the body's shape, or inside it.

    A rim counts as the hull of some of its points, widened by what these leave out. Points where two parts of
    a shape touch count as on its surface.

    Args:
        body: The body. Without a shape it has no outside.
        points_W: (n, 3), m, world axes.
        p_WB_W: (n, 3), or (3,) for all: m, positions of the centre of mass.
        R_WB: (n, 3, 3), or (3, 3) for all: rotations, body to world.
        distance_tolerance: m, >= 0.
        numbers: Numbers of the contacts in the warnings. By default, they begin with 0.
    """
    shape = body.shape
    if shape.is_empty:
        return ()
    numbers = range(len(points_W)) if numbers is None else numbers
    points_B = np.einsum("...j,...jk->...k", points_W - p_WB_W, R_WB)
    gaps: FloatArray = np.min([_hull_gaps(part, points_B) for part in shape.convex_parts], axis=0)
    largest = max((rim.radius for part in shape.convex_parts for rim in part.rims), default=0.0)
    left_out = largest * (1.0 - math.cos(math.pi / RIM_CORNERS))
    tolerance = max(distance_tolerance, DISTANCE_TOLERANCE) + left_out
    warnings: list[str] = []
    for where, off in (("outside of", gaps), ("inside", -gaps)):
        found = np.flatnonzero(off > tolerance).tolist()
        if len(found) > _MOST_TOLD:
            farthest = int(off.argmax())
            most = f"the farthest by {off[farthest]:.6g} m: contact {numbers[farthest]}"
            warnings.append(
                f"{len(found)} of {len(off)} contacts are {where} the shape of {body.name!r}, {most}"
            )
        else:
            warnings += (
                f"contact {numbers[i]} is {off[i]:.6g} m {where} the shape of {body.name!r}" for i in found
            )
    return tuple(warnings)


def without_contacts(
    body: Body, state: BodyState, world: World, normals_W: FloatArray, *, distance_tolerance: float
) -> tuple[str, ...]:
    """Return warnings of surfaces that a body touches, along whose normals no contact is given, (n, 3)."""
    touched = _touched(body, state, world, distance_tolerance)
    missing = (touched.normals_W @ normals_W.T).max(axis=1, initial=-1.0) < _SAME_SIDE
    names = dict.fromkeys(np.array(touched.surfaces, dtype=object)[missing])
    return tuple(f"{body.name!r} touches {name!r}, where no contact is given" for name in names)


def moves_into(
    body: Body, state: BodyState, world: World, *, distance_tolerance: float, velocity_tolerance: float
) -> tuple[str, ...]:
    """Return a warning if a body that touches a surface of the world moves into it after an impact."""
    contacts = _touched(body, state, world, distance_tolerance)
    if len(contacts) == 0:
        return ()
    velocities = relative_velocities(state, contacts)
    approach = -np.einsum("ij,ij->i", velocities, contacts.normals_W)
    fastest = int(approach.argmax())
    if approach[fastest] <= max(velocity_tolerance, MOVES_INTO * float(np.abs(velocities).max())):
        return ()
    return (
        (
            f"after the impact, {body.name!r} moves into {contacts.surfaces[fastest]!r}, which it touches, "
            f"at {approach[fastest]:.3g} m/s: the contacts there were not part of the impact"
        ),
    )


def _hull_gaps(shape: ConvexShape, points_B: FloatArray) -> FloatArray:
    """Return the distances, (n,), m, of points, (n, 3), from a convex shape. They are negative inside."""
    features = features_of(shape)
    away = np.arange(len(points_B))
    gaps = np.zeros(len(points_B))  # negative inside the shape
    if len(features.triangles) > 0:
        levels = (features.normals @ features.corners.T).max(axis=1)
        gaps = (points_B @ features.normals.T - levels).max(axis=1)
        away = away[gaps > 0.0]
        # Rounding puts half of the contacts just outside. On the way to its centre, the shape is so near.
        center = features.corners.mean(axis=0)
        depth = max(0.0, float((levels - features.normals @ center).min()))
        near = gaps[away] / (gaps[away] + depth) * np.linalg.norm(points_B[away] - center, axis=1)
        away = away[near > DISTANCE_TOLERANCE]
    step = max(1, _PAIRS_AT_ONCE // max(1, len(features.triangles)))
    for rows in (away[start : start + step] for start in range(0, len(away), step)):
        gaps[rows] = np.linalg.norm(points_B[rows] - closest_points(features, points_B[rows]), axis=1)
    return gaps - shape.rounding


def _touched(body: Body, state: BodyState, world: World, distance_tolerance: float) -> ContactSet:
    """Return the contacts of a body with the world, without those of a rim at the edge of an obstacle."""
    if not body.shape.is_empty:
        with suppress(NotSupportedError):
            return contacts_within(body, state, world.surfaces, distance_tolerance)
    return NO_CONTACTS


def friction_in_tosses(world: World, contacts: ContactSet, speeds: Sequence[float | None]) -> tuple[str, ...]:
    """Return warnings of surfaces with another friction in tosses than at the contacts found with them.

    Args:
        world: The surfaces.
        contacts: Contacts found with them.
        speeds: Approach speed of each contact in an impact, m/s, 0 for one that slides, or None for neither.
    """
    planes = {each.name: each for each in world.surfaces if isinstance(each, Surface)}
    found = {}
    for name, speed in zip(contacts.surfaces, speeds, strict=True):
        plane = planes.get(name)
        if plane is None or speed is None or plane.lasting_factor == 1.0:
            continue
        if speed == 0.0 or speed < plane.lasting_speed:
            found[name] = (
                f"the friction of {name!r} is {plane.friction:g} in this answer. In tosses "
                f"it is {plane.lasting_factor * plane.friction:.3g} in sustained contact, and in between in "
                "slow impacts"
            )
    return tuple(found.values())


def flush_rim(body: Body, contacts: ContactSet) -> tuple[str, ...]:
    """Return a warning if contacts found on a body's shape are those of a rim that lies flush."""
    most = max(Counter(contacts.surfaces).values(), default=0)
    if most < RIM_POINTS or not any(hull.rims for hull in body.shape.hulls):
        return ()
    too_small = f"{1.0 - math.cos(math.pi / RIM_POINTS):.0%}"
    words = f"the flush rim of {body.name!r} counts as {RIM_POINTS} points"
    return (f"{words}: the loads that it bears without tipping are up to {too_small} too small",)


def check_has_shape(body: Body) -> None:
    """Raise `NoShapeError` for a body without a shape that could touch anything."""
    if body.shape.is_empty:
        raise NoShapeError(
            f"contacts must be given explicitly, since body {body.name!r} has no shape to find them from"
        )
