"""Routh's impact at one contact of a toss (`impact.spatial`)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from contact_dynamics.impact.spatial.path import SlidingLaw, trace
from contact_dynamics.impact.spatial.response import contact_axes, pushed, responding
from contact_dynamics.tolerances import STRIKES
from contact_dynamics.toss.solid import arm_of, pose_of, velocity_of

if TYPE_CHECKING:
    from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Numbers, Solid, Touch


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
    solid: Solid, y: Numbers, touch: Touch, law: RestitutionLaw, *, friction: float
) -> tuple[Numbers, Struck]:
    """Return the state after the impact at one contact, which approaches or jams (lecture 27)."""
    pose, flat = pose_of(solid, y), solid.flats[touch[0]]
    body = responding(solid.mass, solid.inertia, y[3:7], arm_of(solid, pose, touch), pose.v, pose.w)
    axes = contact_axes(body, None, flat.normal)
    u1, u2, v_n = axes.components(velocity_of(pose, body.r))
    if math.hypot(u1, u2) <= STRIKES:
        u1 = u2 = 0.0
    if v_n >= -STRIKES:  # it jams, without approach
        v_n = 0.0
    sliding = SlidingLaw(axes.l1, axes.l2, axes.k1, axes.k2, axes.kn, friction)
    path = trace(sliding, (u1, u2), v_n, restitution=flat.restitution, law=law)
    impulse = axes.in_world(path.impulse)
    v, w = pushed(body, impulse)
    return [*y[:7], *v, *w], Struck(touch, impulse, path.outcome)
