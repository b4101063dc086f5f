# SPDX-License-Identifier: Apache-2.0
"""This file finds the points of a body that touch the world's surfaces at a pose.

A face or an edge that lies flush gives its extreme points as contacts: the corners of a face, the two ends of
a cylinder's or a capsule's line. They carry every force that the whole face or edge can. A ball touches in
one point. A rim touches in its lowest point. If it lies flush as a whole, it touches in `touches.RIM_POINTS`
points, evenly spaced, the first towards the body's x axis (for a rim about x: its y axis). Their wrenches
form a cone inside that of the whole rim, with at least 92 % of its tipping moments (the cosine of 22.5
degrees).

A round body's contact has the body's curvature (`contact.curvature`). It is that of the ball that rolls over
the shape, and along a rim of radius R whose plane is tilted by theta, sin(theta) / R.

`touches` finds the points where a body touches one surface. A plane touches the hull of a body of several
parts, and an obstacle the parts.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import ContactSet, static_or_none
from contact_dynamics.contact.curvature import Curvatures
from contact_dynamics.contact.touches import Side, Touch, flat_touches, gap_between, lowest_along, touches_of
from contact_dynamics.errors import InvalidFieldError, NoShapeError
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, FAR_CONTACT
from contact_dynamics.validation import FloatArray, check_not_negative
from contact_dynamics.world import Body, Surface, World

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.shapes.obstacle import Obstacle


def find_contacts(
    body: Body,
    state: BodyState,
    world: World,
    *,
    distance_tolerance: float = DISTANCE_TOLERANCE,
) -> ContactSet:
    """Return the contacts of a body with the world's surfaces, in the order of the surfaces.

    At each plane, contacts of corners precede those of circular rims. A rim lies flush if all of it touches.
    The set may be empty.

    Args:
        body: Body with a shape.
        state: Pose and velocities of the body.
        world: Surfaces and obstacles.
        distance_tolerance: m, >= 0. A point touches if its height above a surface, or its depth below it, is
            at most this. Measured poses require a tolerance of the size of their noise.

    Raises:
        NoContactError: the body has no shape that could touch anything.
        InvalidFieldError: the body penetrates a surface by more than the tolerance, or the tolerance is
            negative or not finite.
        NotSupportedError: a rim of the body touches an edge of an obstacle (`touches`).

    Examples:
        >>> import contact_dynamics as cd
        >>> box = cd.Body.box((0.2, 0.1, 0.1), mass=1.0)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5
        ... )
        >>> standing = cd.BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1])
        >>> print(cd.find_contacts(box, standing, cd.World(surfaces=(floor,))).p_WC_W)
        [[-0.1  -0.05  0.  ]
         [-0.1   0.05  0.  ]
         [ 0.1  -0.05  0.  ]
         [ 0.1   0.05  0.  ]]
    """
    check_not_inside(body, state, world.surfaces, distance_tolerance=distance_tolerance)
    return contacts_within(body, state, world.surfaces, distance_tolerance)


def check_not_inside(
    body: Body,
    state: BodyState,
    surfaces: Sequence[Surface | Obstacle],
    *,
    distance_tolerance: float = DISTANCE_TOLERANCE,
) -> None:
    """Raise `InvalidFieldError` where a body is deeper in a surface than a tolerance, m, or the default one.

    It raises `NoShapeError` where the body has no shape.
    """
    check_has_shape(body)
    allowed = max(check_not_negative("distance_tolerance", distance_tolerance), DISTANCE_TOLERANCE)
    for surface in surfaces:
        gap = _gap(body, state, surface)
        if gap < -allowed:
            raise InvalidFieldError(
                "state",
                f"{body.name!r} {-gap:.6g} m deep in {surface.name!r}",
                f"at most {allowed:g} m deep in a surface (distance_tolerance)",
                hint="is p_WB_W that of the centre of mass?"
                if -gap > FAR_CONTACT * body.shape.reach
                else "measured poses need a larger distance_tolerance",
            )


def contacts_within(
    body: Body, state: BodyState, surfaces: Sequence[Surface | Obstacle], distance_tolerance: float
) -> ContactSet:
    """Return the contacts as `find_contacts` does, however deep the body is in a surface."""
    check_has_shape(body)
    shape, R_WB = body.shape, state.R_WB
    points = state.p_WB_W + shape.vertices @ R_WB.T
    flats = [surface for surface in surfaces if isinstance(surface, Surface)]
    if shape.is_polyhedron and len(flats) == len(surfaces):
        return _corners(points, flats, distance_tolerance)
    touches: list[Touch] = []
    owners: list[Surface | Obstacle] = []
    for surface in surfaces:
        if isinstance(surface, Surface):
            level = float(surface.p_WS_W @ surface.normal_W)
            for hull in shape.hulls:
                touches += flat_touches(
                    hull, state.p_WB_W, R_WB, surface.normal_W, level=level, tolerance=distance_tolerance
                )
        else:
            touches += touches_of(shape, state.p_WB_W, R_WB, surface, distance_tolerance)
        owners += [surface] * (len(touches) - len(owners))
    found = ContactSet(
        p_WC_W=np.array([touch.p_WC_W for touch in touches]).reshape(-1, 3),
        normals_W=np.array([touch.normal_W for touch in touches]).reshape(-1, 3),
        frictions=np.array([owner.friction for owner in owners]),
        restitutions=np.array([owner.restitution for owner in owners]),
        surfaces=tuple(owner.name for owner in owners),
        body_curvatures=_sides([touch.body for touch in touches]),
        surface_curvatures=_sides([touch.surface for touch in touches]),
        static_frictions=_static(owners),
    )
    return _on_moving(found, owners)


def nearest_surface(
    body: Body, state: BodyState, surfaces: Sequence[Surface | Obstacle]
) -> tuple[Surface | Obstacle, float] | None:
    """Return the surface that a body with a shape is nearest to, and the gap to it, m. There may be none.

    The gap is negative where they penetrate. Of an obstacle it may be less than the distance (`site_of`).
    """
    gaps = ((surface, _gap(body, state, surface)) for surface in surfaces)
    return min(gaps, key=lambda pair: pair[1], default=None)


def _gap(body: Body, state: BodyState, surface: Surface | Obstacle) -> float:
    """Return the gap between a body with a shape and a surface, m, as `nearest_surface` does."""
    if isinstance(surface, Surface):
        lowest = lowest_along(body.shape, state.p_WB_W, state.R_WB, surface.normal_W[None])
        return float(lowest[0] - surface.p_WS_W @ surface.normal_W)
    return gap_between(body.shape, state.p_WB_W, state.R_WB, surface)


def check_has_shape(body: Body) -> None:
    """Raise `NoShapeError` where a body has no shape that could touch anything."""
    if body.shape.is_empty:
        message = f"body {body.name!r} must have `vertices_B` or a `shape`, got neither"
        raise NoShapeError(message)


def _sides(sides: list[Side]) -> Curvatures:
    return Curvatures(
        along=np.array([along for along, _, _ in sides]),
        across=np.array([across for _, across, _ in sides]),
        directions_W=np.array([direction for _, _, direction in sides]).reshape(-1, 3),
    )


def _static(owners: Sequence[Surface | Obstacle]) -> list[float] | None:
    return static_or_none([owner.static_friction for owner in owners], [owner.friction for owner in owners])


def _on_moving(contacts: ContactSet, owners: Sequence[Surface | Obstacle]) -> ContactSet:
    """Return contacts with the motion of the surfaces that they touch."""
    moving = [(i, each) for i, each in enumerate(owners) if isinstance(each, Surface) and each.moves]
    if not moving:
        return contacts
    v, w, a = np.zeros((3, len(owners), 3))
    for i, surface in moving:
        v[i], a[i] = surface.motion_at(contacts.p_WC_W[i])
        w[i] = surface.w_WS_W
    return replace(
        contacts, surface_velocities_W=v, surface_angular_velocities_W=w, surface_accelerations_W=a
    )


def _corners(points: FloatArray, surfaces: Sequence[Surface], distance_tolerance: float) -> ContactSet:
    touching = [points[surface.gaps(points) <= distance_tolerance] for surface in surfaces]
    owners = [surface for surface, found in zip(surfaces, touching, strict=True) for _ in range(len(found))]
    if not owners:
        return NO_CONTACTS
    found = ContactSet(
        p_WC_W=touching[0] if len(surfaces) == 1 else np.concatenate(touching),
        normals_W=np.array([owner.normal_W for owner in owners]),
        frictions=np.array([owner.friction for owner in owners]),
        restitutions=np.array([owner.restitution for owner in owners]),
        surfaces=tuple([owner.name for owner in owners]),
        static_frictions=_static(owners),
    )
    return _on_moving(found, owners)


NO_CONTACTS: Final = ContactSet(
    p_WC_W=np.zeros((0, 3)), normals_W=np.zeros((0, 3)), frictions=np.zeros(0), restitutions=np.zeros(0)
)
"""The contacts of a body that touches nothing."""
