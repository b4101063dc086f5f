"""The impact that settles a question about contact modes, and the modes after it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.contact_modes import (
    ModeVerdict,
    PlanarContactProblem,
    SpatialContactProblem,
    contact_modes,
)
from contact_dynamics.impact import (
    outcomes_over_orders,
    planar_impact,
    several_impact,
    spatial_impact,
)
from contact_dynamics.impact.several.settling import settling_impact
from contact_dynamics.plane.in_space import planar_in_space
from contact_dynamics.plane.lifting import equal_shares, planar_velocity, with_planar_velocity
from msg_adapters.contact_mode import planar_modes_to_msgs, spatial_modes_to_msgs
from msg_adapters.impact import (
    Before,
    planar_impact_to_msg,
    several_impact_to_msg,
    spatial_impact_to_msg,
    write_orders,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes import PlanarModeAnswer, SpatialModeAnswer
    from contact_dynamics.impact import OrderedOutcomes, SeveralImpact
    from contact_dynamics.nodes.subject import Subject
    from contact_dynamics.plane.projection import PlanarProblem
    from contact_dynamics.plane.types import PlanarVelocity
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MOST_CONTACTS_IN_ORDERS: Final = 4
"""Up to that many contacts the outcomes over all orders are listed: 24 sequences, of some milliseconds."""

_UNSETTLED: Final = (ModeVerdict.INCONSISTENT, ModeVerdict.IMPACT)


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """What a question about contact modes is about, in space."""

    subject: Subject
    contacts: ContactSet
    force_W: FloatArray  # (3,), N, gravity included
    torque_W: FloatArray  # (3,), N m, about the centre of mass
    velocity_tolerance: float  # m/s
    distance_tolerance: float  # m
    friction_facets: int  # edges of each friction pyramid in space

    @property
    def in_space(self) -> SpatialContactProblem:
        """Return what is asked about contact modes in space."""
        return SpatialContactProblem(
            body=self.subject.body.mass_properties,
            state=self.subject.state,
            contacts=self.contacts,
            force_W=self.force_W,
            torque_W=self.torque_W,
            friction_facets=self.friction_facets,
            velocity_tolerance=self.velocity_tolerance,
        )

    @property
    def before(self) -> Before:
        """Return what the adapters need of the body."""
        subject = self.subject
        return Before(
            body=subject.body.mass_properties, state=subject.state, state_to_msg=subject.state_to_msg
        )


def settle_in_space(response: Any, question: Question, verdict: ModeVerdict) -> None:
    """Write the impact, and the modes after it, into a response whose verdict calls for one."""
    if verdict not in _UNSETTLED:
        return
    body, state, contacts = question.before.body, question.before.state, question.contacts

    def modes_after(state: BodyState) -> SpatialModeAnswer:
        return contact_modes(replace(question.in_space, state=state))

    if len(contacts) == 1:
        impact = spatial_impact(
            body,
            state,
            contacts[0],
            velocity_tolerance=question.velocity_tolerance,
        )
        after, msg = impact.state, spatial_impact_to_msg(impact, question.before)
    else:
        several = _several(
            question,
            body,
            state,
            contacts,
            verdict,
            is_settled=lambda state: modes_after(state).verdict != ModeVerdict.INCONSISTENT,
        )
        after, msg = several.state, several_impact_to_msg(several, question.before)
        outcomes = _orders(question, body, state, contacts, verdict)
        if outcomes is not None:
            write_orders(msg, outcomes)
    then = modes_after(after)
    response.impact = [msg]
    response.verdict_after_impact = int(then.verdict)
    response.modes_after_impact = spatial_modes_to_msgs(then.modes)


def settle_in_plane(
    response: Any,
    question: Question,
    problem: PlanarProblem,
    verdict: ModeVerdict,
    partners: tuple[int, ...],
) -> None:
    """Write the impact, and the modes after it, into a response whose verdict calls for one.

    Args:
        response: Of `PredictContactMode`.
        question: In space.
        problem: The same in its plane of motion.
        verdict: On it.
        partners: The mirror image of each contact in the plane, for the shares of forces and of impulses at
            once; impulses in turn belong to the contact that struck.
    """
    if verdict not in _UNSETTLED:
        return
    plane = problem.plane

    def modes_after(velocity: PlanarVelocity) -> PlanarModeAnswer:
        return contact_modes(
            PlanarContactProblem(
                body=problem.body,
                velocity=velocity,
                contacts=problem.contacts,
                wrench=problem.wrench,
                velocity_tolerance=question.velocity_tolerance,
            )
        )

    if len(problem.contacts) == 1:
        impact = planar_impact(
            problem.body,
            problem.velocity,
            problem.contacts[0],
            velocity_tolerance=question.velocity_tolerance,
        )
        velocity, msg = impact.velocity, planar_impact_to_msg(impact, problem, question.before)
    else:
        flat = planar_in_space(problem.body, problem.velocity, problem.contacts, axes_W=plane.axes_W)
        several = _several(
            question,
            *flat,
            verdict,
            is_settled=lambda state: (
                modes_after(planar_velocity(plane, state)).verdict != ModeVerdict.INCONSISTENT
            ),
            plane_normal_W=plane.normal_W,
        )
        velocity = planar_velocity(plane, several.state)
        after = with_planar_velocity(problem, question.before.state, velocity)
        impulses = several.impulses_W if several.strikes else equal_shares(several.impulses_W, partners)
        msg = several_impact_to_msg(replace(several, state=after, impulses_W=impulses), question.before)
        outcomes = _orders(question, *flat, verdict)
        if outcomes is not None:
            write_orders(msg, outcomes)
    then = modes_after(velocity)
    response.impact = [msg]
    response.verdict_after_impact = int(then.verdict)
    response.modes_after_impact = planar_modes_to_msgs(then.modes, problem, partners)


def _several(
    question: Question,
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    verdict: ModeVerdict,
    *,
    is_settled: Callable[[BodyState], bool],
    plane_normal_W: FloatArray | None = None,
) -> SeveralImpact:
    """Return the impact of several contacts: those that approach strike in turn, those that jam at once."""
    if verdict == ModeVerdict.IMPACT:
        return several_impact(body, state, contacts, velocity_tolerance=question.velocity_tolerance)
    return settling_impact(
        body,
        state,
        contacts,
        is_settled=is_settled,
        force_W=question.force_W,
        torque_W=question.torque_W,
        plane_normal_W=plane_normal_W,
        friction_facets=question.friction_facets,
        velocity_tolerance=question.velocity_tolerance,
    )


def _orders(
    question: Question, body: MassProperties, state: BodyState, contacts: ContactSet, verdict: ModeVerdict
) -> OrderedOutcomes | None:
    """Return the outcomes over the orders of contacts that approach, where they are few."""
    if verdict != ModeVerdict.IMPACT or len(contacts) > MOST_CONTACTS_IN_ORDERS:
        return None
    return outcomes_over_orders(body, state, contacts, velocity_tolerance=question.velocity_tolerance)
