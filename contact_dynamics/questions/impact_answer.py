# SPDX-License-Identifier: Apache-2.0
"""The answer to a question about an impact."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.constants import ns_after
from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.resolved_impact import ResolvedImpact
from contact_dynamics.questions.services import Answer
from contact_dynamics.questions.subject import FitQuality
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class StruckBody(Record):
    """The second body of an impact, just before it.

    Attributes:
        name: The body's name, which may be empty.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: Its state just before the impact.
    """

    name: str
    p_FB_F: FloatArray
    state: BodyState


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactAnswer(Answer):
    """The impact, and the state and contacts just before it.

    Attributes:
        body_name: The body's name, which may be empty.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: Its state just before the impact, or before the first of several strikes in time.
        fit: How well the motion fits the published states that the state was found from, or None without a
            fit.
        other: The second body just before, or None if the world is struck. Its state after the impact is in
            ``impact``.
        seconds_to_contact: s, from the question's state to the impact. It is zero if the body touches
            already.
        contacts: The contacts. For strikes in time, these are the contacts that strike or stay.
        impact: The result of the impact.
        problem: PLANAR or SPATIAL.
        plane: The plane of motion, or None in space.
        out_of_plane: m/s, the largest motion out of the plane, or NaN in space.
        velocity_tolerance: m/s, the tolerance that was used.
        distance_tolerance: m, the tolerance that was used.
        warnings: What makes the answer doubtful, in words: an order of strikes that mechanics does not
            decide, a contact outside of the body's shape.
    """

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    fit: FitQuality | None
    other: StruckBody | None
    seconds_to_contact: float
    contacts: ContactSet
    impact: ResolvedImpact
    problem: Problem
    plane: PlaneOfMotion | None
    out_of_plane: float
    velocity_tolerance: float
    distance_tolerance: float
    warnings: tuple[str, ...] = ()

    @property
    def stamp_ns(self) -> int:
        """The stamp, ns, of the state that the question was about, or 0 without one."""
        stamp_ns = self.state.stamp_ns
        return stamp_ns and ns_after(stamp_ns, -self.seconds_to_contact)

    @property
    def predicted_state(self) -> BodyState:
        """The state just after the impact."""
        return self.impact.state

    @property
    def is_after_impact(self) -> bool:
        """Whether the predicted state is just after an impact, which it is."""
        return True
