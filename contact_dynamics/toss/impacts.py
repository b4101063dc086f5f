# SPDX-License-Identifier: Apache-2.0
"""The impacts that `strike` puts together: at one contact, and at several contacts of one instant.

- At one contact: Routh's (`impact.spatial`).
- At contacts that have no order, which are those of a tie and those of SIMULTANEOUS: by the laws of
  `impact.several`. Contacts that approach equally fast strike as one under SEQUENTIAL, so that a face that
  lands flat bounces level.
- Without restitution, at all contacts that touch (Moreau 1988). The impulses are in their friction cones, no
  contact approaches afterwards, and one that leaves has none. Friction acts against the sliding afterwards.
  So the impulses do no work, and kinetic energy never grows.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.orders import several_impact
from contact_dynamics.impact.several.result import SeveralContactsLaw, SeveralVerdict
from contact_dynamics.impact.several.tied import (
    impulses_of,
    next_to_strike,
    response_of,
    shared_path,
    twist_after,
)
from contact_dynamics.impact.spatial.path import OUTCOMES
from contact_dynamics.impact.spatial.response import Strike, refuse
from contact_dynamics.tolerances import CONE_CREEPS, STRIKES, TIED_APPROACH
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.cone_forces import ConeForces
from contact_dynamics.toss.solid import contacts_of, points_of, pose_of, properties_of, state_of

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact.law import ImpactOutcome
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Numbers, Pose, Solid, Touch


class Struck(NamedTuple):
    """One strike.

    Attributes:
        touch: The contact.
        impulse: N s, on the body, world axes.
        outcome: What the contact did, or None if all contacts struck at once or settled.
        settles: Whether it was settled without restitution, together with others.
    """

    touch: Touch
    impulse: Vector3
    outcome: ImpactOutcome | None
    settles: bool = False


def routh(
    solid: Solid, y: Numbers, touch: Touch, law: RestitutionLaw, friction: float
) -> tuple[Numbers, Struck]:
    """Return the state after the impact at one contact, which approaches or jams (lecture 27)."""
    surface, corner = touch
    pose, flat = pose_of(solid, y), solid.flats[surface]
    arm = pose.arm(surface, corner)
    one = Strike(law)
    one.body.take(solid.mass, solid.inertia, (y[3], y[4], y[5], y[6]), arm, pose.v, pose.w)
    outcome = one.strike(flat.normal, friction, flat.restitution, False, STRIKES)  # noqa: FBT003  as compiled
    if outcome < 0:
        refuse(one, outcome, STRIKES)
    v, w = one.body.v, one.body.w
    after = [*y[:7], v[0], v[1], v[2], w[0], w[1], w[2]]
    return after, Struck(touch, one.impulse, OUTCOMES[outcome])


def check_laws(restitution_law: RestitutionLaw, several_contacts_law: SeveralContactsLaw) -> None:
    """Raise an error if the two laws do not go together."""
    at_once = several_contacts_law == SeveralContactsLaw.SIMULTANEOUS
    if at_once and restitution_law == RestitutionLaw.ENERGETIC:
        raise InvalidFieldError("restitution_law", restitution_law.name, "POISSON or NEWTON for SIMULTANEOUS")


def next_in_turn(solid: Solid, y: Numbers, touching: list[Touch], rates: list[float]) -> list[Touch]:
    """Return the contact that approaches fastest, with those that tie with it and strike as one with it.

    ``rates`` are the normal velocities, m/s, and some contact approaches.
    """
    fastest = min(rates)
    tie = TIED_APPROACH * (vec.norm((y[7], y[8], y[9])) + solid.reach * vec.norm((y[10], y[11], y[12])))
    if sum(rate <= fastest + tie for rate in rates) < 2:
        return [touching[rates.index(fastest)]]
    flats = [solid.flats[flat] for flat, _ in touching]
    materials = [(flat.restitution, flat.strike_friction) for flat in flats]
    return [touching[k] for k in next_to_strike(rates, materials, tolerance=STRIKES, tie=tie)]


def tied_strike(
    solid: Solid, y: Numbers, group: list[Touch], law: RestitutionLaw
) -> tuple[Numbers, list[Struck]]:
    """Return the state after the impact of contacts that strike as one, and the share of each."""
    state, body = state_of(y), properties_of(solid)
    response = response_of([body], [state], np.array(points_of(solid, y, group)), [(0, None)] * len(group))
    flats = [solid.flats[flat] for flat, _ in group]
    normals = np.array([flat.normal for flat in flats])
    path, axes = shared_path(
        response, normals, flats[0].restitution, flats[0].strike_friction, law=law, tolerance=STRIKES
    )
    impulses = impulses_of(path, axes)
    struck = [
        Struck(touch, _vector(impulse), path.outcome)
        for touch, impulse in zip(group, impulses.tolist(), strict=True)
    ]
    return [*y[:7], *twist_after(response, impulses).tolist()], struck


def simultaneous_strike(
    solid: Solid, y: Numbers, touching: list[Touch], law: RestitutionLaw
) -> tuple[Numbers, list[Struck]] | None:
    """Return the state after the impact at all contacts at once, and each impulse, or None if not found."""
    impact = several_impact(
        properties_of(solid),
        state_of(y),
        _striking(solid, y, touching),
        several_contacts_law=SeveralContactsLaw.SIMULTANEOUS,
        restitution_law=law,
        velocity_tolerance=STRIKES,
    )
    if impact.verdict != SeveralVerdict.RESOLVED:
        return None
    struck = [
        Struck(touch, _vector(impulse), None)
        for touch, impulse in zip(touching, impact.impulses_W.tolist(), strict=True)
        if any(impulse)
    ]
    after = impact.state
    return [*y[:7], *after.v_WB_W.tolist(), *after.w_WB_W.tolist()], struck


def _striking(solid: Solid, y: Numbers, touching: list[Touch]) -> ContactSet:
    """Return touching contacts with the friction of strikes."""
    contacts = contacts_of(solid, y, touching)
    frictions = [solid.flats[surface].strike_friction for surface, _ in touching]
    return replace(contacts, frictions=np.array(frictions), body_curvatures=None)


def _vector(numbers: list[float]) -> tuple[float, float, float]:
    x, y, z = numbers
    return (x, y, z)


class Inelastic(NamedTuple):
    """An impact without restitution.

    Attributes:
        y: The state after it.
        impulses: N s, on the body, world axes, at each contact.
        motions: m/s, the velocity of each contact afterwards, by its two tangents and its normal.
    """

    y: Numbers
    impulses: list[Vector3]
    motions: list[Vector3]


def inelastic_impact(
    solid: Solid, y: Numbers, touching: list[Touch], room: list[float] | None = None
) -> Inelastic | None:
    """Return the impact without restitution at contacts, or None if none was found.

    ``room`` has the speeds, m/s, with which contacts may approach, as those do that are not down yet. Motions
    are relative to that.
    """
    pose = pose_of(solid, y)
    cones = _cones_of(solid, pose, touching, room)
    return _pushed(solid, y, pose, touching, cones) if cones.solve(1.0 / solid.mass, CONE_CREEPS) else None


def sure_impact(
    solid: Solid,
    y: Numbers,
    touching: list[Touch],
    room: list[float] | None = None,
    enough: float = CONE_CREEPS,
) -> Inelastic:
    """Return the impact without restitution. Where none is found, friction is left out, or the body stops.

    ``enough`` is the error of velocities that is allowed, relative to the largest one.
    """
    pose = pose_of(solid, y)
    cones = _cones_of(solid, pose, touching, room)
    if cones.solve(1.0 / solid.mass, enough) or cones.solve_without_friction():
        return _pushed(solid, y, pose, touching, cones)
    none = [(0.0, 0.0, 0.0)] * len(touching)
    return Inelastic([*y[:7], *[0.0] * 6], none, none)


def _cones_of(solid: Solid, pose: Pose, touching: list[Touch], room: list[float] | None) -> ConeForces:
    cones = ConeForces(len(touching))
    for i, (surface, corner) in enumerate(touching):
        arm = pose.arm(surface, corner)
        cones.add(pose, arm, solid.flats[surface], pose.velocity(arm), 0.0 if room is None else room[i])
    return cones


def _pushed(solid: Solid, y: Numbers, pose: Pose, touching: list[Touch], cones: ConeForces) -> Inelastic:
    """Return what the pushes do to the body."""
    after, impulses = list(y), []
    for i, (surface, corner) in enumerate(touching):
        p, q, r = cones.push(i)
        flat = solid.flats[surface]
        n = flat.normal
        t1, t2 = flat.tangents
        impulse = (
            p * t1[0] + q * t2[0] + r * n[0],
            p * t1[1] + q * t2[1] + r * n[1],
            p * t1[2] + q * t2[2] + r * n[2],
        )
        turning = vec.times(pose.inverse, vec.cross(pose.arm(surface, corner), impulse))
        after[7] += impulse[0] / solid.mass
        after[8] += impulse[1] / solid.mass
        after[9] += impulse[2] / solid.mass
        after[10] += turning[0]
        after[11] += turning[1]
        after[12] += turning[2]
        impulses.append(impulse)
    return Inelastic(after, impulses, [cones.motion(i) for i in range(len(touching))])
