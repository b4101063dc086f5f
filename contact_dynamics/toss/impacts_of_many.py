"""Impacts of many samples at one contact each. The numbers are those of `one_impact`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from contact_dynamics.impact.law import ImpactOutcome
from contact_dynamics.impact.spatial.path import trace_all
from contact_dynamics.impact.spatial.response import contact_axes, pushed, responding
from contact_dynamics.tolerances import STRIKES
from contact_dynamics.toss.one_impact import Struck
from contact_dynamics.toss.solid import arm_of, pose_of, velocity_of
from contact_dynamics.toss.solids_of_many import CONTACT, solids_together, states_together

if TYPE_CHECKING:
    from contact_dynamics.toss.one_impact import AskedImpact


def strike_together(asked: list[AskedImpact]) -> None:
    """Do impacts of one law."""
    solid = solids_together([one.solid for one in asked], [(one.touch,) for one in asked])
    y = states_together([one.y for one in asked])
    pose, flat = pose_of(solid, y), cast("Any", solid.flats[0])
    n_x, n_y, n_z = flat.normal
    x, yy, z = cast("Any", arm_of(solid, pose, CONTACT))
    body = responding(solid.mass, solid.inertia, y[3:7], (x[0], yy[0], z[0]), pose.v, pose.w)
    axes = contact_axes(body, None, (n_x[0], n_y[0], n_z[0]))
    u1, u2, v_n = axes.components(velocity_of(pose, body.r))
    still = np.sqrt(u1 * u1 + u2 * u2) <= STRIKES
    u1, u2, v_n = np.where(still, 0.0, u1), np.where(still, 0.0, u2), np.where(v_n >= -STRIKES, 0.0, v_n)
    mu, e = flat.strike_friction[0], flat.restitution[0]
    columns = (axes.l1, axes.l2, axes.k1, axes.k2, axes.kn, mu, u1, u2, v_n, e)
    paths = trace_all(np.column_stack([np.broadcast_to(x, len(asked)) for x in columns]), asked[0].law)
    impulse = axes.in_world(paths.impulse)
    v, w = pushed(body, impulse)
    after = np.array([*v, *w]).T.tolist()
    impulses, outcomes = np.array(impulse).T.tolist(), paths.outcomes.tolist()
    for one, velocities, (x, yy, z), outcome in zip(asked, after, impulses, outcomes, strict=True):
        one.after = [*one.y[:7], *velocities]
        one.struck = Struck(one.touch, (x, yy, z), ImpactOutcome(outcome))
