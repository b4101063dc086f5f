"""The impact without restitution at all contacts that touch at one instant, together (Moreau 1988).

The impulses are in their friction cones, no contact approaches afterwards, and one that leaves has none.
Friction acts against the sliding afterwards. So the impulses do no work, and kinetic energy never grows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from contact_dynamics.numerics.vectors import cross, dot
from contact_dynamics.tolerances import CONE_CREEPS
from contact_dynamics.toss.cone_forces import Site, cone_forces
from contact_dynamics.toss.solid import arm_of, pose_of, times, velocity_of

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Numbers, Solid, Touch


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
    solid: Solid, y: Numbers, touching: list[Touch], *, room: list[float] | None = None
) -> Inelastic | None:
    """Return the impact without restitution at contacts, or None if none was found.

    ``room`` has the speeds, m/s, with which contacts may approach, as those do that are not down yet. Motions
    are relative to that.
    """
    pose = pose_of(solid, y)
    sites = []
    for k, touch in enumerate(touching):
        flat, arm = solid.flats[touch[0]], arm_of(solid, pose, touch)
        velocity, axes = velocity_of(pose, arm), (*flat.tangents, flat.normal)
        normal = dot(velocity, axes[2]) + (0.0 if room is None else room[k])
        sites.append(
            Site(arm, axes, flat.friction, (dot(velocity, axes[0]), dot(velocity, axes[1]), normal), None)
        )
    found = cone_forces(1.0 / solid.mass, pose.inverse, sites, enough=CONE_CREEPS)
    if found is None:
        return None
    pushes, motions = found
    after, impulses = list(y), []
    for site, (p, q, r) in zip(sites, pushes, strict=True):
        t1, t2, n = site.axes
        impulse = (
            p * t1[0] + q * t2[0] + r * n[0],
            p * t1[1] + q * t2[1] + r * n[1],
            p * t1[2] + q * t2[2] + r * n[2],
        )
        turning = times(pose.inverse, cross(site.arm, impulse))
        for k in range(3):
            after[7 + k] += impulse[k] / solid.mass
            after[10 + k] += turning[k]
        impulses.append(impulse)
    return Inelastic(after, impulses, motions)


def sure_impact(
    solid: Solid, y: Numbers, touching: list[Touch], *, room: list[float] | None = None
) -> Inelastic:
    """Return the impact without restitution. Where none is found, friction is left out, or the body stops."""
    impact = inelastic_impact(solid, y, touching, room=room)
    if impact is None:
        smooth = solid._replace(flats=tuple(flat._replace(friction=0.0) for flat in solid.flats))
        impact = inelastic_impact(smooth, y, touching, room=room)
    if impact is None:
        none = [(0.0, 0.0, 0.0)] * len(touching)
        impact = Inelastic([*y[:7], *[0.0] * 6], none, none)
    return impact
