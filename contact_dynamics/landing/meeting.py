# SPDX-License-Identifier: Apache-2.0
"""Finds when two convex bodies in flight meet, and where.

A plane separates two bodies that are apart (`contact.touches`). Seen from the centre of mass of the second
body, the plane moves at the mean of the speeds at which the nearest points of both approach it. Both bodies
stay on their sides for a time that bounds on their accelerations guarantee (`acceleration_bounds`). The
search goes to the end of that time, takes the plane that separates best then, and repeats, as that for an
obstacle does (`earliest`). It finds a touch within twice `GRAZING_DEPTH`, and misses no deeper one.

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
from contact_dynamics.contact.pairs import check_one_time
from contact_dynamics.contact.touches import site_of, touches_of
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.landing.acceleration_bounds import all_free_for, bounds_of
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
    from contact_dynamics.shapes.hull_features import Features
    from contact_dynamics.tumbling import FreeMotion
    from contact_dynamics.world import Body

MAX_STEPS: Final = 5_000
"""Largest number of steps of a search. Two boxes that meet take ten to fifty."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Meeting(Landing):
    """The first contact of two bodies in flight; `Landing` documents the other fields.

    Pass one contact to `spatial_pair_impact`, and several to `bodies_impact`. Normals of the contacts point
    into the first body, and velocities are those of its points relative to the second body.

    Attributes:
        other_state: State of the second body at that time.
    """

    other_state: BodyState


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
        if each.shape.rims:
            message = f"body {each.name!r} must have a shape without circular rims to meet another body"
            raise NotSupportedError(message)
    tolerance = max(check_not_negative("distance_tolerance", distance_tolerance), DISTANCE_TOLERANCE)
    pair = _Pair(
        body,
        other,
        free_motion(body.mass_properties, state, gravity_W=gravity),
        free_motion(other.mass_properties, other_state, gravity_W=others),
    )
    _check_apart(pair, tolerance)
    found = pair.first_touch(
        check_not_negative("horizon", horizon),
        tolerance=tolerance,
        leaves=check_not_negative("velocity_tolerance", velocity_tolerance),
    )
    if found is None:
        return None
    seconds, points, normal_W, velocities = found
    approach = velocities @ normal_W
    stays = approach <= velocity_tolerance
    count = int(stays.sum())
    return Meeting(
        seconds=seconds,
        state=pair.motion.state_at(seconds),
        other_state=pair.others.state_at(seconds),
        contacts=ContactSet(
            p_WC_W=points[stays],
            normals_W=np.tile(normal_W, (count, 1)),
            frictions=np.full(count, friction),
            restitutions=np.full(count, restitution),
            surfaces=(other.name,) * count,
        ),
        velocities_W=velocities[stays],
        strikes=bool((approach < -velocity_tolerance).any()),
    )


def _check_apart(pair: _Pair, tolerance: float) -> None:
    gap = pair.at(0.0).gap
    if gap < -tolerance:
        raise InvalidFieldError(
            "other_state",
            f"{pair.other.name!r} {-gap:.6g} m deep in {pair.body.name!r}",
            f"at most {tolerance:g} m deep (distance_tolerance)",
        )


class _Apart(NamedTuple):
    """Two bodies at one time, and the plane that separates them best. Vectors are in world axes."""

    p: FloatArray  # (3,), m, from the second centre of mass to the first
    v: FloatArray  # (3,), m/s, of the first relative to the second
    w: FloatArray  # (3,), rad/s
    w_other: FloatArray  # (3,), rad/s
    R: FloatArray  # (3, 3), rotation of the first body
    R_other: FloatArray
    p_other: FloatArray  # (3,), m, in the world
    gap: float  # m, negative where they penetrate
    normal: FloatArray  # (3,), unit, into the first body


class _Hull(NamedTuple):
    name: str
    features: Features


class _Pair:
    """Two bodies in flight. The first has the sum of both roundings, and the second is a hull."""

    def __init__(self, body: Body, other: Body, motion: FreeMotion, others: FreeMotion) -> None:
        self.body, self.other, self.motion, self.others = body, other, motion, others
        self.rounding = other.shape.rounding  # m, of the second body
        self.shape = replace(body.shape, rounding=body.shape.rounding + self.rounding)
        self.hull = _Hull(other.name, features_of(other.shape))
        self.corners, self.theirs = body.shape.vertices, other.shape.vertices
        self.arms, self.their_arms = (np.linalg.norm(each, axis=1) for each in (self.corners, self.theirs))

    def at(self, seconds: float) -> _Apart:
        """Return both bodies at a time, s."""
        mine, theirs = self.motion.sample(seconds), self.others.sample(seconds)
        R, R_other = rotation_matrix(np.array(mine.q_WB)), rotation_matrix(np.array(theirs.q_WB))
        p_other = np.array(theirs.p_WB_W)
        p, v = np.array(mine.p_WB_W) - p_other, np.subtract(mine.v_WB_W, theirs.v_WB_W)
        site = site_of(self.shape, p @ R_other, R_other.T @ R, self.hull)
        return _Apart(
            p=p,
            v=v,
            w=np.array(mine.w_WB_W),
            w_other=np.array(theirs.w_WB_W),
            R=R,
            R_other=R_other,
            p_other=p_other,
            gap=site.gap,
            normal=R_other @ site.normal_W,
        )

    def first_touch(
        self, horizon: float, *, tolerance: float, leaves: float
    ) -> tuple[float, FloatArray, FloatArray, FloatArray] | None:
        """Return when they meet, s, the contact points, (n, 3), the normal and the relative velocities."""
        work, now = SearchWork(), 0.0
        for _ in range(MAX_STEPS):
            work.spend(OBSTACLE_STEP, now)
            apart = self.at(now)
            fastest = 0.0
            # At the beginning, points within the tolerance touch. Later, the search comes as near as it can.
            if apart.gap <= (tolerance if now == 0.0 else 2.0 * GRAZING_DEPTH):
                points, velocities = self._touching(apart, tolerance)
                along = velocities @ apart.normal
                if len(along) and not (along > (leaves if now == 0.0 else 0.0)).all():
                    closing = -float(along.min())
                    if now > 0.0 and closing > 0.0:  # a step of Newton's method leaves rounding
                        later = self.at(now + apart.gap / closing)
                        there = self._touching(later, tolerance)
                        # Bodies that graze each other leave before that.
                        if (there[1] @ later.normal <= 0.0).any():
                            return now + apart.gap / closing, there[0], later.normal, there[1]
                    return now, points, apart.normal, velocities
                fastest = float(along.max(initial=0.0))
            if now >= horizon:
                return None
            now = min(now + self._free_for(apart, fastest), horizon)
        message = (
            f"other: the bodies must meet or pass each other, got bodies that stay close until {now:g} s"
        )
        raise NotSupportedError(message)

    def _free_for(self, apart: _Apart, leaving: float) -> float:
        """Return for how long, s, they cannot touch, or a separation at the speed ``leaving``, m/s, lasts."""
        n = apart.normal
        heights = self.corners @ (n @ apart.R) + apart.p @ n - self.shape.rounding
        rates = self.corners @ (np.cross(n, apart.w) @ apart.R) + apart.v @ n
        depths = self.theirs @ (n @ apart.R_other)
        their_rates = self.theirs @ (np.cross(n, apart.w_other) @ apart.R_other)
        mine, theirs = self._bound(n)
        if leaving > 0.0 and apart.gap <= 2.0 * GRAZING_DEPTH:
            pull = mine.max() + theirs.max()
            return max(math.sqrt(2.0 * GRAZING_DEPTH / pull) if pull > 0.0 else LEAVING_STEP, 0.0)
        low, high = int(heights.argmin()), int(depths.argmax())
        plane = 0.5 * (heights[low] + depths[high])
        speed = 0.5 * float(rates[low] + their_rates[high])
        return min(
            all_free_for(heights - plane, rates - speed, mine),
            all_free_for(plane - depths, speed - their_rates, theirs),
        )

    def _bound(self, n: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the largest accelerations of corners of both bodies towards a plane between them, m/s^2."""
        mine = bounds_of(self.motion, n)(0.0)
        theirs = bounds_of(self.others, -n)(0.0)
        return mine.fall + theirs.fall + self.arms * mine.turning, self.their_arms * theirs.turning

    def _touching(self, apart: _Apart, tolerance: float) -> tuple[FloatArray, FloatArray]:
        """Return contact points, (n, 3), m, world, and their velocities relative to the second body, m/s."""
        touches = touches_of(
            self.shape, apart.p @ apart.R_other, apart.R_other.T @ apart.R, self.hull, tolerance
        )
        arms = np.array([touch.p_WC_W for touch in touches]).reshape(-1, 3) @ apart.R_other.T
        arms = arms + self.rounding * apart.normal  # from the second hull to its surface
        velocities = apart.v + np.cross(apart.w, arms - apart.p) - np.cross(apart.w_other, arms)
        return apart.p_other + arms, velocities
