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

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.orders import several_impact
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.impact.several.tied import mean_path, next_to_strike
from contact_dynamics.impact.spatial.response import refuse
from contact_dynamics.tolerances import CONE_CREEPS, NO_SHARED_RESPONSE, STRIKES, TIED_APPROACH
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.cone_forces import ConeForces
from contact_dynamics.toss.solid import approaches, contacts_of, pose_of, properties_of, state_of

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact.law import ImpactOutcome
    from contact_dynamics.impact.spatial.response import Strike
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


def routh(  # noqa: PLR0917
    impact: Strike,
    solid: Solid,
    y: Numbers,
    touch: Touch,
    skips: bool = False,  # noqa: FBT001, FBT002  C has no keywords
    lasts: bool = False,  # noqa: FBT001, FBT002  C has no keywords
) -> tuple[Numbers, int]:
    """Return the state after the impact at one contact, which approaches or jams, and the outcome.

    ``impact`` makes it (lecture 27), and has the impulse afterwards. If it ``skips``, nothing happens to a
    contact that separates. If the contact ``lasts``, the friction is that of sustained contact.
    """
    surface, corner = touch
    pose, flat = pose_of(solid, y), solid.flats[surface]
    arm = pose.arm(surface, corner)
    friction = flat.friction if lasts else flat.friction_at(vec.dot(pose.velocity(arm), flat.normal))
    impact.body.take(solid.mass, solid.inertia, (y[3], y[4], y[5], y[6]), arm, pose.v, pose.w)
    outcome = impact.strike(flat.normal, friction, flat.restitution, False, STRIKES, skips)  # noqa: FBT003  as compiled
    if outcome < 0:
        refuse(impact, outcome, STRIKES)
    v, w = impact.body.v, impact.body.w
    return [*y[:7], v[0], v[1], v[2], w[0], w[1], w[2]], outcome


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
    tied = 0
    for rate in rates:
        tied += rate <= fastest + tie
    if tied < 2:
        return [touching[rates.index(fastest)]]
    flats = [solid.flats[flat] for flat, _ in touching]
    materials = [(flat.restitution, flat.friction_at(fastest)) for flat in flats]
    return [touching[k] for k in next_to_strike(rates, materials, tolerance=STRIKES, tie=tie)]


def tied_strike(
    solid: Solid, y: Numbers, group: list[Touch], law: RestitutionLaw
) -> tuple[Numbers, list[Struck]]:
    """Return the state after the impact of contacts that strike as one, and the share of each.

    This is `impact.several.tied` for one body, in plain floats. Each contact has three axes: the direction in
    which it slides, or would begin to, the one across, and the normal. The mean velocity in these axes
    responds to the impulse that all contacts share.
    """
    pose, per_mass = pose_of(solid, y), 1.0 / solid.mass
    arms = [pose.arm(surface, corner) for surface, corner in group]
    normals = [solid.flats[surface].normal for surface, _ in group]
    a, turning = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)  # how the body begins to move if all normals push alike
    for arm, n in zip(arms, normals, strict=True):
        a, turning = vec.plus(a, per_mass, n), vec.plus(turning, 1.0, vec.cross(arm, n))
    turning = vec.times(pose.inverse, turning)
    firsts, seconds, none_slides = [], [], True
    for arm, n in zip(arms, normals, strict=True):
        across, size = vec.without(pose.velocity(arm), n), STRIKES
        if not vec.norm(across) > size:
            tendency = vec.plus(a, 1.0, vec.cross(turning, arm))
            across, size = vec.without(tendency, n), NO_SHARED_RESPONSE * vec.norm(tendency)
        first = (0.0, 0.0, 0.0)
        if vec.norm(across) > size:
            first, none_slides = vec.normalised(across), False
        firsts.append(first)
        seconds.append(vec.cross(n, first))
    if none_slides:
        firsts = [solid.flats[surface].tangents[0] for surface, _ in group]
        seconds = [solid.flats[surface].tangents[1] for surface, _ in group]
    one, other = _shared(pose, arms, firsts), _shared(pose, arms, seconds)
    # The path needs tangents along which the response is diagonal.
    xx, xy, yy = (
        _coupled(one, one, per_mass),
        _coupled(one, other, per_mass),
        _coupled(other, other, per_mass),
    )
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
    c, s = math.cos(angle), math.sin(angle)
    turned = [
        (vec.combined(c, x, s, z), vec.combined(-s, x, c, z)) for x, z in zip(firsts, seconds, strict=True)
    ]
    firsts, seconds = [x for x, _ in turned], [z for _, z in turned]
    one, other, along = (
        _shared(pose, arms, firsts),
        _shared(pose, arms, seconds),
        _shared(pose, arms, normals),
    )
    flat = solid.flats[group[0][0]]
    path = mean_path(
        (
            _coupled(one, one, per_mass),
            _coupled(other, other, per_mass),
            _coupled(one, along, per_mass),
            _coupled(other, along, per_mass),
            _coupled(along, along, per_mass),
        ),
        (_moving(pose, one), _moving(pose, other), _moving(pose, along)),
        restitution=flat.restitution,
        friction=flat.friction_at(vec.dot(pose.velocity(arms[0]), flat.normal)),
        law=law,
        tolerance=STRIKES,
    )
    i1, i2, p = path.impulse
    v, w, share = pose.v, pose.w, 1.0 / len(group)
    struck = []
    for touch, arm, x, z, n in zip(group, arms, firsts, seconds, normals, strict=True):
        impulse = vec.plus(vec.combined(share * i1, x, share * i2, z), share * p, n)
        v = vec.plus(v, per_mass, impulse)
        w = vec.plus(w, 1.0, vec.times(pose.inverse, vec.cross(arm, impulse)))
        struck.append(Struck(touch, impulse, path.outcome))
    return [*y[:7], v[0], v[1], v[2], w[0], w[1], w[2]], struck


class Shared:
    """The mean velocity of contacts, each along an axis of its own, as a function of the body's velocities.

    Attributes:
        force: By the velocity of the mass centre.
        moment: m, by the angular velocity.
        turning: 1/(kg m), the angular velocity of a unit impulse that contacts share along these axes.
    """

    def __init__(self, force: Vector3, moment: Vector3, turning: Vector3) -> None:
        self.force, self.moment, self.turning = force, moment, turning


def _shared(pose: Pose, arms: list[Vector3], axes: list[Vector3]) -> Shared:
    force, moment, share = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0 / len(arms)
    for arm, axis in zip(arms, axes, strict=True):
        force, moment = vec.plus(force, share, axis), vec.plus(moment, share, vec.cross(arm, axis))
    return Shared(force, moment, vec.times(pose.inverse, moment))


def _coupled(one: Shared, other: Shared, per_mass: float) -> float:
    """Return the mean velocity along some axes by a unit impulse that is shared along others, 1/kg."""
    return per_mass * vec.dot(one.force, other.force) + vec.dot(one.moment, other.turning)


def _moving(pose: Pose, shared: Shared) -> float:
    """Return the mean velocity, m/s."""
    return vec.dot(shared.force, pose.v) + vec.dot(shared.moment, pose.w)


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
    if not impact.converged:
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
    rates = approaches(solid, y, touching)
    flats = [solid.flats[surface] for surface, _ in touching]
    frictions = [flat.friction_at(rate) for flat, rate in zip(flats, rates, strict=True)]
    return replace(contacts, frictions=np.array(frictions), static_frictions=None, body_curvatures=None)


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
