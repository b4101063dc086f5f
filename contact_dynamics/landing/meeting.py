# SPDX-License-Identifier: Apache-2.0
"""Finds when two bodies in flight meet, and where.

A plane separates two bodies that are apart (`contact.touches`). Seen from the centre of mass of the second
body, the plane moves at the mean of the speeds at which the nearest points of both approach it. Both bodies
stay on their sides for a time that bounds on their accelerations guarantee (`acceleration_bounds`). The
search goes to the end of that time, takes the plane that separates best then, and repeats, as that for an
obstacle does (`earliest`). It finds a touch within twice `GRAZING_DEPTH`, and misses no deeper one. Bodies of
several convex parts meet when the first pair of parts does. While the balls around two parts are far apart,
the plane is at right angles to the line between the centres.

A shape over which a ball rolls counts as its hull, and its radius is added to that of the other.

Not covered: shapes with circular rims.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import HORIZON, STANDARD_GRAVITY_W
from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.found import check_has_shape
from contact_dynamics.contact.pairs import BodyName, check_one_time
from contact_dynamics.contact.touches import Pair, Site, site_of, touches_between
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.landing.acceleration_bounds import all_free_for, bounds_of, free_for
from contact_dynamics.landing.earliest import Landing
from contact_dynamics.landing.search_work import OBSTACLE_STEP, SearchWork
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.shapes.hull_features import features_of
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, GRAZING_DEPTH, LEAVING_STEP, VELOCITY_TOLERANCE
from contact_dynamics.tumbling import free_motion
from contact_dynamics.validation import (
    FloatArray,
    check_not_negative,
    check_vector3,
    check_within,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.shapes.hull_features import Features
    from contact_dynamics.tumbling import FreeMotion
    from contact_dynamics.world import Body

MAX_STEPS: Final = 5_000
"""Largest number of steps of a search for each pair of parts. Two boxes that meet take ten to fifty."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Meeting(Landing):
    """The first contact of two bodies in flight; `Landing` documents the other fields.

    `bodies_impact([body, other], [meeting.state, meeting.other_state], meeting.contacts, meeting.pairs)` is
    the impact of both bodies. If there is one contact, `spatial_pair_impact` takes it too. Normals of the
    contacts point into the first body, and velocities are those of its points relative to the second body.
    Calls that take one body and the world, such as `several_impact`, reject these contacts.

    Attributes:
        other_state: State of the second body at that time.
    """

    other_state: BodyState

    @property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Return the two bodies of each contact, (0, 1), as `bodies_impact` takes them."""
        return ((0, 1),) * len(self.contacts)


def next_meeting(
    body: Body,
    state: BodyState,
    other: Body,
    other_state: BodyState,
    *,
    friction: float,
    restitution: float,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    other_gravity_W: ArrayLike | None = None,
    horizon: float = HORIZON,
    distance_tolerance: float = DISTANCE_TOLERANCE,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> Meeting | None:
    """Return the first contact of two bodies in free flight within ``horizon`` (s), or None without one.

    Args:
        body: First body, into which the normals of the contacts point.
        state: Its state.
        other: Second body.
        other_state: Its state, at the same time.
        friction: Coefficient of Coulomb friction between the two bodies, >= 0.
        restitution: Coefficient of restitution between them, in [0, 1].
        gravity_W: (3,), m/s^2, world axes.
        other_gravity_W: (3,), m/s^2, acceleration of the second body's centre of mass, if it is not
            ``gravity_W``. With zeros, its velocity is constant, such as that of a gripper.
        horizon: s, >= 0.
        distance_tolerance: m, >= 0. Points within this distance touch.
        velocity_tolerance: m/s, >= 0. Touching bodies are in flight if all contacts separate faster; then
            their next contact is returned.

    Raises:
        NoShapeError: a body has no shape.
        NotSupportedError: a shape has circular rims, or the bodies stay close to each other for too long.
        InvalidFieldError: a number is out of range, the stamps of the states differ, or the bodies penetrate
            each other by more than the tolerance.
        TooLargeError: the search takes too many steps, because a body spins too fast for the horizon.
    """
    check_one_time((state, other_state), "other_state")
    gravity = check_vector3("gravity_W", gravity_W)
    others = gravity if other_gravity_W is None else check_vector3("other_gravity_W", other_gravity_W)
    friction = check_not_negative("friction", friction)
    restitution = check_within("restitution", restitution, 0.0, 1.0)
    for each in (body, other):
        check_has_shape(each)
        if any(part.rims for part in each.shape.convex_parts):
            message = f"body {each.name!r} must have a shape without circular rims to meet another body"
            raise NotSupportedError(message)
    tolerance = max(check_not_negative("distance_tolerance", distance_tolerance), DISTANCE_TOLERANCE)
    bodies = _Bodies(
        body,
        other,
        free_motion(body.mass_properties, state, gravity_W=gravity),
        free_motion(other.mass_properties, other_state, gravity_W=others),
    )
    found = bodies.first_touch(
        check_not_negative("horizon", horizon),
        tolerance=tolerance,
        leaves=check_not_negative("velocity_tolerance", velocity_tolerance),
    )
    if found is None:
        return None
    seconds, touching = found
    approach = touching.approach
    stays = approach <= velocity_tolerance
    count = int(stays.sum())
    return Meeting(
        seconds=seconds,
        state=bodies.motion.state_at(seconds),
        other_state=bodies.others.state_at(seconds),
        contacts=ContactSet(
            p_WC_W=touching.points[stays],
            normals_W=touching.normals[stays],
            frictions=np.full(count, friction),
            restitutions=np.full(count, restitution),
            surfaces=(BodyName(other.name),) * count,
        ),
        velocities_W=touching.velocities[stays],
        strikes=bool((approach < -velocity_tolerance).any()),
    )


class _Relative(NamedTuple):
    """Two bodies at one time. Vectors are in world axes."""

    p: FloatArray  # (3,), m, from the second centre of mass to the first
    v: FloatArray  # (3,), m/s, of the first relative to the second
    w: FloatArray  # (3,), rad/s
    w_other: FloatArray  # (3,), rad/s
    R: FloatArray  # (3, 3), rotation of the first body
    R_other: FloatArray
    p_other: FloatArray  # (3,), m, in the world


class _Touching(NamedTuple):
    """Where two bodies touch, in the world."""

    points: FloatArray  # (n, 3), m
    normals: FloatArray  # (n, 3), unit, into the first body
    velocities: FloatArray  # (n, 3), m/s, of the first relative to the second

    @property
    def approach(self) -> FloatArray:
        """Return the speeds, (n,), m/s, at which the bodies separate there."""
        speeds: FloatArray = np.einsum("ni,ni->n", self.velocities, self.normals)
        return speeds


class _Hull(NamedTuple):
    name: str
    features: Features


class _PairOfParts:
    """A convex part of each of two bodies. The first has the sum of both roundings; the second is a hull."""

    def __init__(self, part: ConvexShape, theirs: ConvexShape, name: str) -> None:
        self.shape = replace(part, rounding=part.rounding + theirs.rounding)
        self.hull, self.rounding = _Hull(name, features_of(theirs)), theirs.rounding
        self.corners, self.theirs = part.vertices, theirs.vertices
        self.arms, self.their_arms = (np.linalg.norm(each, axis=1) for each in (self.corners, self.theirs))
        self.center, self.their_center = self.corners.mean(axis=0), self.theirs.mean(axis=0)
        self.radius = self.shape.rounding + float(  # m, the sum of those of balls around both parts
            np.linalg.norm(self.corners - self.center, axis=1).max()
            + np.linalg.norm(self.theirs - self.their_center, axis=1).max()
        )

    @property
    def both(self) -> Pair:
        """Return the two parts, the second with the distance of its surface from its hull."""
        return self.shape, self.hull, self.rounding

    def site(self, at: _Relative) -> Site:
        """Return where the parts are nearest, in the axes of the second body."""
        return site_of(self.shape, at.p @ at.R_other, at.R_other.T @ at.R, self.hull)


class _Bodies:
    """Two bodies in flight."""

    def __init__(self, body: Body, other: Body, motion: FreeMotion, others: FreeMotion) -> None:
        self.body, self.other, self.motion, self.others = body, other, motion, others
        self.pairs = [
            _PairOfParts(part, theirs, other.name)
            for part in body.shape.convex_parts
            for theirs in other.shape.convex_parts
        ]
        self.centers = np.array([pair.center for pair in self.pairs])
        self.their_centers = np.array([pair.their_center for pair in self.pairs])
        self.radii = np.array([pair.radius for pair in self.pairs])
        turning, their_turning = (bounds_of(each, np.eye(3)[0])(0.0).turning for each in (motion, others))
        # m/s^2, the largest accelerations of the centres towards each other by the rotations of both bodies
        self.pulls = turning * np.linalg.norm(self.centers, axis=1)
        self.pulls += their_turning * np.linalg.norm(self.their_centers, axis=1)

    def at(self, seconds: float) -> _Relative:
        """Return both bodies at a time, s."""
        mine, theirs = self.motion.sample(seconds), self.others.sample(seconds)
        p_other = np.array(theirs.p_WB_W)
        return _Relative(
            p=np.array(mine.p_WB_W) - p_other,
            v=np.subtract(mine.v_WB_W, theirs.v_WB_W),
            w=np.array(mine.w_WB_W),
            w_other=np.array(theirs.w_WB_W),
            R=rotation_matrix(np.array(mine.q_WB)),
            R_other=rotation_matrix(np.array(theirs.q_WB)),
            p_other=p_other,
        )

    def first_touch(
        self, horizon: float, *, tolerance: float, leaves: float
    ) -> tuple[float, _Touching] | None:
        """Return when they meet, s, and where."""
        work, now = SearchWork(), 0.0
        due = np.zeros(len(self.pairs))  # s. Until these times, pairs of parts cannot touch.
        for _ in range(MAX_STEPS * len(self.pairs)):
            at = self.at(now)
            near = self._near_pairs(at, now, due) if len(due) > 1 else [0] * int(due[0] <= now)
            work.spend(OBSTACLE_STEP * len(near) + 1, now)
            sites = {i: self.pairs[i].site(at) for i in near}
            gap = min((site.gap for site in sites.values()), default=math.inf)
            if now == 0.0:
                self._check_depth(-gap, tolerance)
            fastest = 0.0
            # At the beginning, points within the tolerance touch. Later, the search comes as near as it can.
            if gap <= (tolerance if now == 0.0 else 2.0 * GRAZING_DEPTH):
                touching = self._touching(at, tolerance)
                along = touching.approach
                if len(along) and not (along > (leaves if now == 0.0 else 0.0)).all():
                    closing = -float(along.min())
                    if now > 0.0 and closing > 0.0:  # a step of Newton's method leaves rounding
                        there = self._touching(self.at(now + gap / closing), tolerance)
                        # Bodies that graze each other leave before that.
                        if (there.approach <= 0.0).any():
                            return now + gap / closing, there
                    return now, touching
                fastest = float(along.max(initial=0.0))
            if now >= horizon:
                return None
            for i, site in sites.items():
                due[i] = now + self._free_for(self.pairs[i], at, site, fastest)
            now = min(float(due.min()), horizon)
        message = (
            f"other: the bodies must meet or pass each other, got bodies that stay close until {now:g} s"
        )
        raise NotSupportedError(message)

    def _check_depth(self, depth: float, tolerance: float) -> None:
        if depth > tolerance:
            raise InvalidFieldError(
                "other_state",
                f"{self.other.name!r} {depth:.6g} m deep in {self.body.name!r}",
                f"at most {tolerance:g} m deep (distance_tolerance)",
            )

    def _near_pairs(self, at: _Relative, now: float, due: FloatArray) -> list[int]:
        """Return the pairs of parts that are due and closer than their sizes, and put the others off."""
        pairs = np.flatnonzero(due <= now)
        arms, their_arms = self.centers[pairs] @ at.R.T, self.their_centers[pairs] @ at.R_other.T
        apart = at.p + arms - their_arms
        distances = np.linalg.norm(apart, axis=1)
        is_far = distances > 2.0 * self.radii[pairs]
        normals = apart[is_far] / distances[is_far, None]
        velocities = at.v + np.cross(at.w, arms[is_far]) - np.cross(at.w_other, their_arms[is_far])
        rates = np.einsum("ni,ni->n", velocities, normals)
        pulls = self.pulls[pairs[is_far]] - normals @ (self.motion.gravity_W - self.others.gravity_W)
        gaps = distances[is_far] - self.radii[pairs[is_far]]
        due[pairs[is_far]] = now + np.array([*map(free_for, gaps.tolist(), rates.tolist(), pulls.tolist())])
        near: list[int] = pairs[~is_far].tolist()
        return near

    def _free_for(self, pair: _PairOfParts, at: _Relative, site: Site, leaving: float) -> float:
        """Return for how long, s, parts cannot touch, or separate at the speed ``leaving``, m/s."""
        n = at.R_other @ site.normal_W
        heights = pair.corners @ (n @ at.R) + at.p @ n - pair.shape.rounding
        rates = pair.corners @ (np.cross(n, at.w) @ at.R) + at.v @ n
        depths = pair.theirs @ (n @ at.R_other)
        their_rates = pair.theirs @ (np.cross(n, at.w_other) @ at.R_other)
        mine, theirs = self._bound(pair, n)
        if leaving > 0.0 and site.gap <= 2.0 * GRAZING_DEPTH:
            pull = mine.max() + theirs.max()
            return max(math.sqrt(2.0 * GRAZING_DEPTH / pull) if pull > 0.0 else LEAVING_STEP, 0.0)
        low, high = int(heights.argmin()), int(depths.argmax())
        plane = 0.5 * (heights[low] + depths[high])
        speed = 0.5 * float(rates[low] + their_rates[high])
        return min(
            all_free_for(heights - plane, rates - speed, mine),
            all_free_for(plane - depths, speed - their_rates, theirs),
        )

    def _bound(self, pair: _PairOfParts, n: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the largest accelerations of corners of both parts towards a plane between them, m/s^2."""
        mine = bounds_of(self.motion, n)(0.0)
        theirs = bounds_of(self.others, -n)(0.0)
        return mine.fall + theirs.fall + pair.arms * mine.turning, pair.their_arms * theirs.turning

    def _touching(self, at: _Relative, tolerance: float) -> _Touching:
        apart = at.p + self.centers @ at.R.T - self.their_centers @ at.R_other.T
        near = np.flatnonzero(np.linalg.norm(apart, axis=1) <= self.radii + tolerance)
        pairs = [self.pairs[i].both for i in near]
        touches = touches_between(pairs, at.p @ at.R_other, at.R_other.T @ at.R, tolerance)
        normals = np.array([touch.normal_W for touch in touches]).reshape(-1, 3) @ at.R_other.T
        arms = np.array([touch.p_WC_W for touch in touches]).reshape(-1, 3) @ at.R_other.T
        velocities = at.v + np.cross(at.w, arms - at.p) - np.cross(at.w_other, arms)
        return _Touching(at.p_other + arms, normals, velocities)
