"""Several contacts of one body at once: no single law is accepted for them, so laws have names here.

* SEQUENTIAL (Routh 1860; Ivanov 1995; Smith et al. 2012): the single-contact law at one contact after the
  other, the one that approaches fastest first (the first in the list where they tie), until none approaches.
* SIMULTANEOUS: complementarity of impulses and velocities over all contacts (`simultaneous`), with Newton's
  hypothesis (Moreau 1988) or Poisson's (Anitescu and Potra 1997).

`outcomes_over_orders` gives the set that the sequential law reaches over its admissible orders, and its
spread: how far the answer is undecided.

Not covered: moments at the contacts, contacts between several bodies, and resting contacts that their own
sliding would jam (`spatial` answers that for one).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from itertools import islice, permutations
from typing import Final

import numpy as np

from contact_dynamics.contact import ContactSet
from contact_dynamics.errors import InvalidFieldError, SeparatingContactError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.simultaneous import simultaneous_impulses
from contact_dynamics.impact.spatial import spatial_impact
from contact_dynamics.impact.spatial_result import SpatialImpact
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import FloatArray, check_positive

MOST_STRIKES: Final = 1000
"""Single impacts after which a sequence counts as not converged. Sequences of body and floor shrink by a
fixed factor each round, so that they come to rest within a few dozen."""

MOST_ORDERS: Final = 120
"""Orders that `outcomes_over_orders` tries: all of them up to five contacts."""


class SeveralContactsLaw(IntEnum):
    """The law for several contacts at once."""

    SEQUENTIAL = 0
    SIMULTANEOUS = 1


class SeveralVerdict(IntEnum):
    """Whether the law has an answer."""

    RESOLVED = 0
    """No contact approaches afterwards."""
    NOT_CONVERGED = 1
    """The bound on strikes or iterations was reached; the state is the last one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SeveralImpact:
    """The answer for several contacts; contact i is row i, impulses act on the body, axes are the world's."""

    law: SeveralContactsLaw  # the law for several contacts
    restitution_law: RestitutionLaw  # the law of restitution
    verdict: SeveralVerdict  # whether the answer holds
    state: BodyState  # afterwards: the pose of before, new velocities
    impulses_W: FloatArray  # (n, 3), N s, total
    velocities_before_W: FloatArray  # (n, 3), m/s, of the contacts
    velocities_after_W: FloatArray  # (n, 3), m/s, of the contacts
    strikes: tuple[
        tuple[int, SpatialImpact], ...
    ]  # sequential: each contact struck, in order, with its impact

    @property
    def order(self) -> tuple[int, ...]:
        """Return the contacts that were struck, in order; empty for a simultaneous law."""
        return tuple(contact for contact, _ in self.strikes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OrderedOutcomes:
    """What the sequential law comes to over its admissible orders; row i belongs to order i."""

    orders: tuple[tuple[int, ...], ...]  # the contacts struck, in order
    velocities_W: FloatArray  # (m, 6), m/s and rad/s, linear then angular velocity afterwards, world axes
    complete: bool  # whether every priority of the contacts was tried
    not_converged: int  # how many sequences were left out because they reached the bound on strikes

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between outcomes, (6,), m/s and rad/s, axis by axis."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread


def several_impact(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> SeveralImpact:
    """Return what the impact of ``body`` at all ``contacts`` does, under a named law.

    Args:
        body: Mass and angular inertia.
        state: Pose and velocities just before.
        contacts: All that touch, approaching or not; at least one.
        law: The law for several contacts.
        restitution_law: What the coefficients of restitution mean; ENERGETIC only with SEQUENTIAL.
        velocity_tolerance: m/s, > 0. A contact that approaches less fast does not strike.

    Raises:
        SeparatingContactError: every contact separates.
        InvalidFieldError: no contacts, a tolerance that is not > 0, or ENERGETIC with SIMULTANEOUS.
    """
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    before = _check_touching(state, contacts, tolerance)
    if law == SeveralContactsLaw.SEQUENTIAL:
        return _sequence(body, state, contacts, restitution_law, tolerance, priority=None)
    if restitution_law == RestitutionLaw.ENERGETIC:
        raise InvalidFieldError("restitution_law", "ENERGETIC", "POISSON or NEWTON for SIMULTANEOUS")
    impulses, converged = simultaneous_impulses(body, state, contacts, restitution_law, tolerance)
    arms = contacts.p_WC_W - state.p_WB_W
    turn = np.linalg.solve(body.inertia_in_world(state.R_WB), np.cross(arms, impulses).sum(axis=0))
    after = BodyState(
        p_WB_W=state.p_WB_W,
        q_WB=state.q_WB,
        v_WB_W=state.v_WB_W + impulses.sum(axis=0) / body.mass,
        w_WB_W=state.w_WB_W + turn,
        stamp_ns=state.stamp_ns,
    )
    return SeveralImpact(
        law=law,
        restitution_law=restitution_law,
        verdict=SeveralVerdict.RESOLVED if converged else SeveralVerdict.NOT_CONVERGED,
        state=after,
        impulses_W=impulses,
        velocities_before_W=before,
        velocities_after_W=after.velocity_of_point(contacts.p_WC_W),
        strikes=(),
    )


def outcomes_over_orders(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    most_orders: int = MOST_ORDERS,
) -> OrderedOutcomes:
    """Return the outcomes of the sequential law over its admissible orders.

    An order follows a priority of the contacts: each time, the first in it that approaches is struck.
    Different priorities can come to the same order, which is listed once.

    Args:
        body: Mass and angular inertia.
        state: Pose and velocities just before.
        contacts: All that touch; at least one.
        restitution_law: What the coefficients of restitution mean.
        velocity_tolerance: m/s, > 0. A contact that approaches less fast does not strike.
        most_orders: How many priorities to try; `complete` says whether that was all of them.

    Raises:
        SeparatingContactError: every contact separates.
        InvalidFieldError: no contacts, or a tolerance that is not > 0.
    """
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    _check_touching(state, contacts, tolerance)
    found: dict[tuple[int, ...], FloatArray] = {}
    lost = 0
    priorities = permutations(range(len(contacts)))
    for priority in islice(priorities, most_orders):
        answer = _sequence(body, state, contacts, restitution_law, tolerance, priority=priority)
        if answer.verdict == SeveralVerdict.RESOLVED:
            found[answer.order] = np.concatenate([answer.state.v_WB_W, answer.state.w_WB_W])
        else:
            lost += 1
    return OrderedOutcomes(
        orders=tuple(found),
        velocities_W=np.array(list(found.values())).reshape(-1, 6),
        complete=next(priorities, None) is None,
        not_converged=lost,
    )


def _check_touching(state: BodyState, contacts: ContactSet, tolerance: float) -> FloatArray:
    """Return the contacts' velocities, (n, 3), or refuse a set in which nothing touches or approaches."""
    if len(contacts) == 0:
        raise InvalidFieldError("contacts", "none", "at least one contact")
    velocities = state.velocity_of_point(contacts.p_WC_W)
    slowest = float(np.einsum("ij,ij->i", velocities, contacts.normals_W).min())
    if slowest > tolerance:
        raise SeparatingContactError(
            "contact normal velocity",
            f"v_n >= {slowest:.9g} m/s at every contact",
            f"one of at most {tolerance:g} m/s",
        )
    return velocities


def _sequence(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    restitution_law: RestitutionLaw,
    tolerance: float,
    *,
    priority: tuple[int, ...] | None,
) -> SeveralImpact:
    """Strike one contact after the other: by ``priority``, or the fastest approach first."""
    velocities = before = state.velocity_of_point(contacts.p_WC_W)
    impulses = np.zeros((len(contacts), 3))
    strikes: list[tuple[int, SpatialImpact]] = []
    verdict = SeveralVerdict.NOT_CONVERGED
    for _ in range(MOST_STRIKES):
        approach = np.einsum("ij,ij->i", velocities, contacts.normals_W)
        contact = _next_contact(approach, tolerance, priority)
        if contact is None:
            verdict = SeveralVerdict.RESOLVED
            break
        impact = spatial_impact(
            body,
            state,
            p_WC_W=contacts.p_WC_W[contact],
            n_W=contacts.normals_W[contact],
            friction=float(contacts.frictions[contact]),
            restitution=float(contacts.restitutions[contact]),
            law=restitution_law,
            # Half, since the approach was judged by another sum with other rounding.
            velocity_tolerance=0.5 * tolerance,
        )
        strikes.append((contact, impact))
        impulses[contact] += impact.impulse_W
        state = impact.state
        velocities = state.velocity_of_point(contacts.p_WC_W)
    return SeveralImpact(
        law=SeveralContactsLaw.SEQUENTIAL,
        restitution_law=restitution_law,
        verdict=verdict,
        state=state,
        impulses_W=impulses,
        velocities_before_W=before,
        velocities_after_W=velocities,
        strikes=tuple(strikes),
    )


def _next_contact(approach: FloatArray, tolerance: float, priority: tuple[int, ...] | None) -> int | None:
    if priority is None:
        fastest = int(approach.argmin())
        return fastest if approach[fastest] < -tolerance else None
    return next((i for i in priority if approach[i] < -tolerance), None)
