# SPDX-License-Identifier: Apache-2.0
"""This file finds the next contacts of a body from its shape and the world, or among points that are given.

Both ways return a `Landing`. They recognise a corner, a ball or a given point when it comes back. On a rim,
each point is a contact of its own.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.landing.earliest import Landing, landing_from
from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.tolerances import DISTANCE_TOLERANCE
from contact_dynamics.tumbling import free_motion

if TYPE_CHECKING:
    from contact_dynamics.landing.search_work import SearchWork
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, SurfaceFrame, World


class FoundMeetings:
    """Contacts found from a body's shape and the world's surfaces. They are numbered as they are met.

    With a ``frame``, the world and the states are those of its axes, and `contacts` are those of the world.
    """

    def __init__(
        self,
        body: Body,
        world: World,
        *,
        frame: SurfaceFrame | None,
        distance_tolerance: float,
        velocity_tolerance: float,
        work: SearchWork,
    ) -> None:
        self._body, self._world, self._frame, self._work = body, world, frame, work
        self._distance_tolerance, self._velocity_tolerance = distance_tolerance, velocity_tolerance
        self._points_B: list[FloatArray] = []
        self._met: list[ContactSet] = []
        self._met_at: list[float] = []
        self._seconds = 0.0  # s, time of the newest landing

    def next(self, state: BodyState, now: float, horizon: float) -> Landing | None:
        """Return where free flight from a state at ``now``, s, ends within ``horizon``, s, or None."""
        landing = landing_from(
            self._body,
            state,
            self._world,
            horizon=horizon,
            distance_tolerance=self._distance_tolerance,
            velocity_tolerance=self._velocity_tolerance,
            work=self._work,
        )
        self._seconds = now if landing is None else now + landing.seconds
        return landing

    def index(self, landing: Landing, row: int) -> int:
        """Return the number of a contact. A contact that is met for the first time gets the next number."""
        contact = landing.contacts.subset([row])
        point_B = landing.state.R_WB.T @ (_feature(contact) - landing.state.p_WB_W)
        for i, (met, known_B) in enumerate(zip(self._met, self._points_B, strict=True)):
            if met.surfaces == contact.surfaces and float(abs(known_B - point_B).max()) <= DISTANCE_TOLERANCE:
                return i
        self._met.append(contact)
        self._met_at.append(self._seconds)
        self._points_B.append(point_B)
        return len(self._met) - 1

    @property
    def contacts(self) -> ContactSet:
        """All contacts that were met, each where it was when it was met first."""
        points = np.concatenate([np.zeros((0, 3)), *(contact.p_WC_W for contact in self._met)])
        velocities = accelerations = None
        if self._frame is not None:
            met_at = np.array(self._met_at)
            points = points + self._frame.displacement(met_at)
            velocities, accelerations = self._frame.velocity(met_at), self._frame.acceleration_W
        return ContactSet(
            p_WC_W=points,
            normals_W=np.concatenate([np.zeros((0, 3)), *(contact.normals_W for contact in self._met)]),
            frictions=np.array([float(contact.frictions[0]) for contact in self._met]),
            restitutions=np.array([float(contact.impact_restitutions[0]) for contact in self._met]),
            surfaces=tuple(name for contact in self._met for name in contact.surfaces),
            surface_velocities_W=velocities,
            surface_accelerations_W=accelerations,
        )


def _feature(contact: ContactSet) -> FloatArray:
    """Return the point, (3,), m, by which a contact is known again. On a ball, it is the ball's centre."""
    point: FloatArray = contact.p_WC_W[0]
    round_there = contact.body_curvatures
    if round_there is not None:
        along, across = float(round_there.along[0]), float(round_there.across[0])
        if along == across and 0.0 < along < math.inf:
            point = point + contact.normals_W[0] / along
    return point


class NamedMeetings:
    """Points of a body that touch at a state. Each can only touch the plane that it touches there."""

    def __init__(
        self,
        body: MassProperties,
        state: BodyState,
        contacts: ContactSet,
        *,
        gravity_W: FloatArray,
        distance_tolerance: float,
        velocity_tolerance: float,
        work: SearchWork,
    ) -> None:
        self._body, self._gravity_W, self._work = body, gravity_W, work
        self._contacts = contacts
        self._points_B = (contacts.p_WC_W - state.p_WB_W) @ state.R_WB
        self._distance_tolerance, self._velocity_tolerance = distance_tolerance, velocity_tolerance
        self._rows: list[int] = []  # which contacts touch at the newest landing

    def next(self, state: BodyState, now: float, horizon: float) -> Landing | None:  # noqa: ARG002
        """Return where free flight from a state ends within ``horizon``, s, or None, whatever the time."""
        touching = self._touching(0.0, state, self._distance_tolerance)
        if touching is not None:
            return touching
        motion = free_motion(self._body, state, gravity_W=self._gravity_W)
        arrivals = [
            found.seconds
            for point_B, plane_W, normal_W in zip(
                self._points_B, self._contacts.p_WC_W, self._contacts.normals_W, strict=True
            )
            if (
                found := first_contact(
                    motion, point_B[None], plane_W, normal_W, horizon=horizon, work=self._work
                )
            )
        ]
        if not arrivals:
            return None
        seconds = min(arrivals)
        tolerance = max(self._distance_tolerance, DISTANCE_TOLERANCE)
        return self._touching(seconds, motion.state_at(seconds), tolerance)

    def index(self, landing: Landing, row: int) -> int:  # noqa: ARG002  the newest landing's rows are known
        """Return the index of a contact in the set that was given."""
        return self._rows[row]

    @property
    def contacts(self) -> ContactSet:
        """The contacts that were given."""
        return self._contacts

    def _touching(self, seconds: float, state: BodyState, distance_tolerance: float) -> Landing | None:
        """Return the contacts that touch and do not leave, or None."""
        normals = self._contacts.normals_W
        points = state.p_WB_W + self._points_B @ state.R_WB.T
        gaps = np.einsum("ij,ij->i", points - self._contacts.p_WC_W, normals)
        velocities = state.velocity_of_point(points)
        approach = np.einsum("ij,ij->i", velocities, normals)
        rows = np.flatnonzero((gaps <= distance_tolerance) & (approach <= self._velocity_tolerance)).tolist()
        if not rows:
            return None
        self._rows = rows
        at_rest = self._contacts.subset(rows)
        return Landing(
            seconds=seconds,
            state=state,
            contacts=ContactSet(
                p_WC_W=points[rows],
                normals_W=at_rest.normals_W,
                frictions=at_rest.frictions,
                restitutions=at_rest.restitutions,
                surfaces=at_rest.surfaces,
            ),
            velocities_W=velocities[rows],
            strikes=bool((approach[rows] < -self._velocity_tolerance).any()),
        )


Meetings: TypeAlias = FoundMeetings | NamedMeetings
"""A way to find where a flight ends, which remembers the contacts that were met so far."""
