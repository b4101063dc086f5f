"""Which velocities follow an impact? Routh's frictional rigid impact (lecture 27)."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.resolved_impact import ResolvedImpact
from contact_dynamics.questions.subject import FitQuality
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class StruckBody(Record):
    """The second body of an impact, just before.

    Attributes:
        name: The body's name; empty where it has none.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: Its state just before the impact.
    """

    name: str
    p_FB_F: FloatArray
    state: BodyState


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactAnswer(Record):
    """What the impact does.

    Attributes:
        body_name: The body's name; empty where it has none.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: Its state just before the impact; of strikes in time, before the first.
        fit: How well the motion fits the published states that the state was found from. None: no fit.
        other: The second body just before; its state after is in ``impact``. None: it strikes the world.
        seconds_to_contact: s, from the state that was taken to the impact; zero where it touches already.
        contacts: The contacts; of strikes in time, those that strike or stay.
        impact: What the impact comes to.
        problem: PLANAR or SPATIAL.
        plane: The plane of motion. None: space.
        out_of_plane: m/s, the largest motion out of the plane. Zero in space.
        velocity_tolerance: m/s, that was used.
        distance_tolerance: m, that was used.
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
