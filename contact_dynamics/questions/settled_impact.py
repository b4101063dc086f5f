# SPDX-License-Identifier: Apache-2.0
"""Resolves the impact that settles a question about contact modes, and finds the modes after it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    ModeVerdict,
    PlanarContactProblem,
    SpatialContactProblem,
    SpatialMode,
    contact_modes,
)
from contact_dynamics.impact import (
    ResolvedImpact,
    jamming_impact,
    outcomes_over_orders,
    planar_impact,
    several_impact,
    spatial_impact,
)
from contact_dynamics.impact.several.orders import with_orders
from contact_dynamics.impact.several.result import of_one_contact
from contact_dynamics.plane.lifting import equal_shares, planar_in_space, planar_velocity
from contact_dynamics.questions.plane_of_motion import lifted_impact, lifted_mode, several_in_plane
from contact_dynamics.questions.subject import Subject
from contact_dynamics.records import Record
from contact_dynamics.validation import FloatArray

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.contact_modes import PlanarModeAnswer, SpatialModeAnswer
    from contact_dynamics.plane.projection import PlanarProblem
    from contact_dynamics.plane.types import PlanarVelocity
    from contact_dynamics.rigid_body.body import BodyState, MassProperties

MAX_CONTACTS_IN_ORDERS: Final = 4
"""Up to this many contacts the outcomes over all orders are listed. These are 24 sequences and take some
milliseconds."""

_UNSETTLED: Final = (ModeVerdict.INCONSISTENT, ModeVerdict.IMPACT)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SettledImpact(Record):
    """The impact by which an inconsistent or approaching contact set comes to a contact mode.

    Attributes:
        impact: The result of the impact.
        verdict: The verdict on the velocities after it.
        modes: All consistent modes with these velocities, as in `ContactModeAnswer`.
    """

    impact: ResolvedImpact
    verdict: ModeVerdict
    modes: tuple[SpatialMode, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ModeCase(Record):
    """A question about contact modes after all that it names has been looked up.

    Attributes:
        subject: The body in the question's state.
        contacts: The contacts at which it touches.
        force_W: (3,), N, applied besides contact forces, gravity included, world axes.
        torque_W: (3,), N m, applied about the centre of mass, world axes.
        velocity_tolerance: m/s.
        distance_tolerance: m.
        friction_facets: Edges of each friction pyramid in space, in what says whether contacts jam.
    """

    subject: Subject
    contacts: ContactSet
    force_W: FloatArray
    torque_W: FloatArray
    velocity_tolerance: float
    distance_tolerance: float
    friction_facets: int

    @property
    def in_space(self) -> SpatialContactProblem:
        """The question about contact modes in space."""
        return SpatialContactProblem(
            body=self.subject.body.mass_properties,
            state=self.subject.state,
            contacts=self.contacts,
            force_W=self.force_W,
            torque_W=self.torque_W,
            friction_facets=self.friction_facets,
            velocity_tolerance=self.velocity_tolerance,
        )


def settled_in_space(case: ModeCase, verdict: ModeVerdict) -> SettledImpact | None:
    """Return the impact and the modes after it, or None if the verdict on a spatial case requires none."""
    if verdict not in _UNSETTLED:
        return None
    body, state = case.subject.body.mass_properties, case.subject.state
    contacts, problem = case.contacts, case.in_space

    def modes_after(state: BodyState) -> SpatialModeAnswer:
        return contact_modes(replace(problem, state=state))

    if len(contacts) == 1:
        impact = spatial_impact(body, state, contacts[0], velocity_tolerance=case.velocity_tolerance)
        resolved = of_one_contact(impact, [body], [state])
    else:
        several = _several(
            case,
            body,
            state,
            contacts,
            verdict,
            is_settled=lambda state: modes_after(state).verdict != ModeVerdict.INCONSISTENT,
        )
        resolved = _with_orders(several, case, (body, state, contacts), verdict)
    then = modes_after(resolved.state)
    return SettledImpact(impact=resolved, verdict=then.verdict, modes=then.modes)


def settled_in_plane(
    case: ModeCase,
    problem: PlanarProblem,
    in_plane: PlanarContactProblem,
    verdict: ModeVerdict,
    partners: tuple[int, ...],
) -> SettledImpact | None:
    """Return the impact and the modes after it, or None if the verdict on a planar case requires none.

    The case in its plane of motion is ``problem``, and its question about contact modes ``in_plane``. The
    ``partners`` are the mirror images of the contacts, which share forces and simultaneous impulses. An
    impulse of a sequence belongs to the contact that struck.
    """
    if verdict not in _UNSETTLED:
        return None
    plane, body, state = problem.plane, case.subject.body.mass_properties, case.subject.state

    def modes_after(velocity: PlanarVelocity) -> PlanarModeAnswer:
        return contact_modes(replace(in_plane, velocity=velocity))

    if len(problem.contacts) == 1:
        impact = planar_impact(
            problem.body, problem.velocity, problem.contacts[0], velocity_tolerance=case.velocity_tolerance
        )
        velocity = impact.velocity
        resolved = of_one_contact(lifted_impact(impact, problem, state), [body], [state])
    else:
        flat = planar_in_space(problem.body, problem.velocity, problem.contacts, axes_W=plane.axes_W)
        several = _several(
            case,
            *flat,
            verdict,
            is_settled=lambda state: (
                modes_after(planar_velocity(plane, state)).verdict != ModeVerdict.INCONSISTENT
            ),
            plane_normal_W=plane.normal_W,
        )
        velocity = planar_velocity(plane, several.state)
        if not several.order:
            several = replace(several, impulses_W=equal_shares(several.impulses_W, partners))
        resolved = _with_orders(several_in_plane(several, problem, body, state), case, flat, verdict)
    then = modes_after(velocity)
    return SettledImpact(
        impact=resolved,
        verdict=then.verdict,
        modes=tuple(lifted_mode(mode, problem, partners) for mode in then.modes),
    )


def _several(
    case: ModeCase,
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    verdict: ModeVerdict,
    *,
    is_settled: Callable[[BodyState], bool],
    plane_normal_W: FloatArray | None = None,
) -> ResolvedImpact:
    """Return the impact of several contacts: one by one if they approach, at once if they jam."""
    if verdict == ModeVerdict.IMPACT:
        return several_impact(body, state, contacts, velocity_tolerance=case.velocity_tolerance)
    return jamming_impact(
        body,
        state,
        contacts,
        is_settled=is_settled,
        force_W=case.force_W,
        torque_W=case.torque_W,
        plane_normal_W=plane_normal_W,
        friction_facets=case.friction_facets,
        velocity_tolerance=case.velocity_tolerance,
    )


def _with_orders(
    resolved: ResolvedImpact,
    case: ModeCase,
    ordered: tuple[MassProperties, BodyState, ContactSet],
    verdict: ModeVerdict,
) -> ResolvedImpact:
    """Return an impact with the outcomes over the orders of the approaching contacts, if these are few."""
    if verdict != ModeVerdict.IMPACT or len(ordered[2]) > MAX_CONTACTS_IN_ORDERS:
        return resolved
    return with_orders(resolved, outcomes_over_orders(*ordered, velocity_tolerance=case.velocity_tolerance))
