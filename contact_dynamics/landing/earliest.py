# SPDX-License-Identifier: Apache-2.0
"""Finds the end of a body's flight: its first contact with the world, and all contacts there.

At any time one plane separates the body from an obstacle (`contact.touches`). While the body stays above
this plane, it does not touch. `acceleration_bounds` says for how long it must stay above. The search goes to
the end of that time, takes the plane that separates best then, and repeats (conservative advancement;
Mirtich, Impulse-based dynamic simulation of rigid body systems, Berkeley 1996). It finds a touch within
`GRAZING_DEPTH`, and misses no deeper one. Each convex part of a body has its own plane and its own time.

Not covered: a body that hovers so close and so long that the search needs more than `MAX_STEPS` steps
(`NotSupportedError`), and rims that come to edges and corners (`contact.touches`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import HORIZON
from contact_dynamics.contact.found import check_not_inside, contacts_within
from contact_dynamics.contact.touches import site_of, touches_of
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.landing.plane_arrival import Descent, first_contact
from contact_dynamics.landing.search_work import OBSTACLE_STEP, SearchWork
from contact_dynamics.records import Record
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, GRAZING_DEPTH, LEAVING_STEP, VELOCITY_TOLERANCE
from contact_dynamics.tumbling import FreeMotion, free_motion
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact.touches import Site, Touch
    from contact_dynamics.landing.acceleration_bounds import Motion
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.shapes.obstacle import Obstacle
    from contact_dynamics.tumbling.motion import Sample
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, Surface, World


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Landing(Record):
    """End of a flight: the first contact of the body.

    A landing on an edge or a face has several contacts. Pass all of them to `several_impact`;
    `spatial_impact` takes one contact and ignores the others.

    Attributes:
        seconds: Time of the landing, s after the state's stamp. It is 0 if the body already touches.
        state: State of the body at that time.
        contacts: Contacts that touch and do not separate: one for a corner, two or more for an edge or a
            face.
        velocities_W: (n, 3), m/s, velocities of the body's contact points, world axes.
        strikes: Whether a contact approaches its surface faster than the velocity tolerance, so that there is
            an impact.
    """

    seconds: float
    state: BodyState
    contacts: ContactSet
    velocities_W: FloatArray
    strikes: bool


def next_landing(
    body: Body,
    state: BodyState,
    world: World,
    *,
    horizon: float = HORIZON,
    distance_tolerance: float = DISTANCE_TOLERANCE,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    motion: Motion | None = None,
    work: SearchWork | None = None,
) -> Landing | None:
    """Return the first contact of a flying body within ``horizon`` (s), or None without a contact.

    If the body already touches a surface, it is in flight only if all of its contacts separate faster than
    ``velocity_tolerance``; its next contact is then returned.

    Args:
        body: Body with a shape.
        state: State of the body at time 0.
        world: Surfaces, obstacles and gravity. Surfaces may have constant accelerations and rotate about
            their normals, such as a paddle or a turntable; the contacts then contain the velocities of the
            surfaces at the time of contact.
        horizon: s, >= 0. Look-ahead time.
        distance_tolerance: m, >= 0. A point within this distance of a surface touches it.
        velocity_tolerance: m/s, >= 0.
        motion: The flight from ``state``, in closed form or under forces. The default is free flight under
            the world's gravity.
        work: Count of search steps that this search shares with others. By default, it has its own.

    Raises:
        NoContactError: the body has no shape that could touch anything.
        InvalidFieldError: the body penetrates a surface by more than ``distance_tolerance``, the horizon or a
            tolerance is negative or not finite, or the motion begins in another state.
        NotSupportedError: a surface tilts, or rotates about an axis that moves sideways, or moves along its
            normal while the body moves under forces; or as in `first_touch`.
        TooLargeError: the search takes too many steps, because the body spins too fast for the horizon.

    Examples:
        >>> import contact_dynamics as cd
        >>> ball = cd.Body.sphere(0.03, mass=0.057)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.7
        ... )
        >>> dropped = cd.BodyState(p_WB_W=[0, 0, 1.03], q_WB=[0, 0, 0, 1], v_WB_W=[2, 0, 0])
        >>> landing = cd.next_landing(ball, dropped, cd.World(surfaces=(floor,)))
        >>> print(f"{landing.seconds:.4f} s", landing.contacts.p_WC_W.round(3))
        0.4516 s [[0.903 0.    0.   ]]
    """
    check_not_negative("horizon", horizon)
    check_not_negative("velocity_tolerance", velocity_tolerance)
    own = state if motion is None else motion.state
    if own is not state and own.to_dict() != state.to_dict():
        raise InvalidFieldError("motion", "one that begins in another", "one that begins in the given state")
    check_not_inside(body, state, world.surfaces, distance_tolerance=distance_tolerance)
    return landing_from(
        body,
        state,
        world,
        horizon=horizon,
        distance_tolerance=distance_tolerance,
        velocity_tolerance=velocity_tolerance,
        motion=motion,
        work=work,
    )


def landing_from(
    body: Body,
    state: BodyState,
    world: World,
    *,
    horizon: float,
    distance_tolerance: float,
    velocity_tolerance: float,
    motion: Motion | None = None,
    work: SearchWork | None = None,
) -> Landing | None:
    """Return the landing as `next_landing` does, however deep the body is in a surface."""
    world.after(0.0)  # raises where a surface moves in a way that is not supported
    now = _touching(body, state, world, distance_tolerance)
    if now is not None and (now.approach <= velocity_tolerance).any():
        return now.landing(0.0, state, velocity_tolerance)
    if motion is None:
        motion = free_motion(body.mass_properties, state, gravity_W=world.gravity_W)
    spent = SearchWork() if work is None else work
    arrivals = [
        seconds
        for surface in world.surfaces
        if (seconds := _arrival(motion, body, surface, horizon, spent)) is not None
    ]
    if not arrivals:
        return None
    seconds = min(arrivals)
    then = motion.state_at(seconds)
    touching = _touching(body, then, world.after(seconds), max(distance_tolerance, DISTANCE_TOLERANCE))
    return None if touching is None else touching.landing(seconds, then, velocity_tolerance)


def _arrival(
    motion: Motion, body: Body, surface: Surface | Obstacle, horizon: float, work: SearchWork
) -> float | None:
    if isinstance(surface, Obstacle):
        return first_touch(motion, body.shape, surface, horizon=horizon, work=work)
    if surface.moves:
        motion = _towards(motion, surface)
    found = first_contact(motion, body.shape, surface.p_WS_W, surface.normal_W, horizon=horizon, work=work)
    return None if found is None else found.seconds


def _towards(motion: Motion, surface: Surface) -> Motion:
    """Return a motion as it is seen from a surface that moves along its normal."""
    n = surface.normal_W
    speed, acceleration = float(n @ surface.v_WS_W), float(n @ surface.a_WS_W)
    if speed == acceleration == 0.0:
        return motion
    if not isinstance(motion, FreeMotion):
        message = (
            f"surface {surface.name!r} must not move along its normal where a body moves under forces, "
            f"got {speed:g} m/s and {acceleration:g} m/s^2"
        )
        raise NotSupportedError(message)
    state = motion.state
    seen = state.with_velocities(state.v_WB_W - speed * n, state.w_WB_W)
    return replace(motion, state=seen, gravity_W=motion.gravity_W - acceleration * n)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Touching:
    contacts: ContactSet
    velocities_W: FloatArray  # (n, 3), m/s
    approach: FloatArray  # (n,), m/s, normal velocities, negative towards the surface

    def landing(self, seconds: float, state: BodyState, velocity_tolerance: float) -> Landing:
        """Return the landing of the contacts that do not leave."""
        stays = self.approach <= velocity_tolerance
        contacts = self.contacts if stays.all() else self.contacts.subset(np.flatnonzero(stays).tolist())
        return Landing(
            seconds=seconds,
            state=state,
            contacts=contacts,
            velocities_W=self.velocities_W[stays],
            strikes=bool((self.approach < -velocity_tolerance).any()),
        )


def _touching(body: Body, state: BodyState, world: World, distance_tolerance: float) -> _Touching | None:
    contacts = contacts_within(body, state, world.surfaces, distance_tolerance)
    if len(contacts) == 0:
        return None
    velocities = state.velocity_of_point(contacts.p_WC_W)
    surface = contacts.surface_velocities_W
    relative = velocities if surface is None else velocities - surface
    approach = np.einsum("ni,ni->n", relative, contacts.normals_W)
    return _Touching(contacts=contacts, velocities_W=velocities, approach=approach)


MAX_STEPS: Final = 5_000
"""Largest number of steps of a search for each part, about a second. A toss takes ten to a hundred steps."""


def first_touch(
    motion: Motion,
    shape_B: ConvexShape,
    obstacle: Obstacle,
    *,
    horizon: float,
    work: SearchWork | None = None,
) -> float | None:
    """Return the first time in [0, horizon], s, at which a body touches an obstacle and does not leave it.

    If it touches at time 0 and does not leave, the time is 0. If it leaves, it is the time at which it comes
    back. The function returns None if the body does not touch.

    Raises:
        InvalidFieldError: the horizon is negative, the shape is empty, or an integrated motion does not reach
            as far as the search has to go.
        NotSupportedError: a rim comes to an edge or a corner, or the body hovers.
        TooLargeError: this search, and others that ``work`` counts, take too many steps together.
    """
    until = check_not_negative("horizon", horizon)
    if shape_B.is_empty:
        raise InvalidFieldError("shape_B", "nothing", "a shape, which can touch")
    parts, now = shape_B.convex_parts, 0.0
    due = [now] * len(parts)  # until these times, parts cannot touch
    for _ in range(MAX_STEPS * len(parts)):
        sample = motion.sample(now)
        pose = np.array(sample.p_WB_W), rotation_matrix(np.array(sample.q_WB))
        sites = {i: site_of(part, *pose, obstacle) for i, part in enumerate(parts) if due[i] <= now}
        if work is not None:
            work.spend(OBSTACLE_STEP * len(sites), now)
        if any(site.gap <= GRAZING_DEPTH for site in sites.values()):
            touches = touches_of(shape_B, *pose, obstacle, DISTANCE_TOLERANCE)
            if any(_approach(sample, touch) <= 0.0 for touch in touches):
                return now
        if now >= until:
            return None
        for i, site in sites.items():
            due[i] = _free_until(motion, parts[i], site, now)
        now = min(*due, until)
    message = f"obstacle {obstacle.name!r}: the body must pass it, got a body close to it until {now:g} s"
    raise NotSupportedError(message)


def _approach(sample: Sample, touch: Touch) -> float:
    """Return the speed, m/s, at which a body leaves a contact."""
    velocity = np.array(sample.v_WB_W) + np.cross(sample.w_WB_W, touch.p_WC_W - sample.p_WB_W)
    return float(velocity @ touch.normal_W)


def _free_until(motion: Motion, part: ConvexShape, site: Site, now: float) -> float:
    """Return the time, s, until which a convex part of a body cannot touch, or leaves an obstacle."""
    descent = Descent(motion, part, site.level * site.normal_W, site.normal_W)
    bound = descent.bound_from(now)
    if site.gap > GRAZING_DEPTH:
        step = descent.free_for(descent.at(now), bound)
    else:
        pull = bound.fall + descent.reach * bound.turning
        step = math.sqrt(2.0 * GRAZING_DEPTH / pull) if pull > 0.0 else LEAVING_STEP
    return min(now + step, bound.until)
