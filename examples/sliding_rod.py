# SPDX-License-Identifier: Apache-2.0
"""Lecture 26's rod: no contact mode is consistent, or two are. Lecture 27 settles the first as an impact."""

import math

from contact_dynamics import (
    PlanarBody,
    PlanarContact,
    PlanarVelocity,
    PlanarWrench,
    planar_impact,
)
from contact_dynamics.contact_modes import PlanarContactProblem, Refusal, contact_modes

rod = PlanarBody(mass=1.0, inertia=1.0)
theta = math.radians(75.0)
contact = PlanarContact(
    r=(-4.0 * math.cos(theta), -4.0 * math.sin(theta)),
    normal=(0.0, 1.0),
    friction=math.tan(math.radians(30.0)),
    restitution=0.0,
)

sliding = PlanarVelocity(v=(-1.0, 0.0), w=0.0)
answer = contact_modes(
    PlanarContactProblem(body=rod, velocity=sliding, contacts=[contact], wrench=PlanarWrench(f=(0.0, -9.81)))
)
print(f"sliding left under gravity: {answer.verdict.name.lower()}")
units = {
    Refusal.PENETRATES: "m/s^2 of normal acceleration",
    Refusal.NO_SOLUTION: "1/kg of normal acceleration for each N of normal force",
}
for refused in answer.refused:
    name = refused.refusal.name.lower().replace("_", " ")
    print(f"  {refused.mode}: {name}, {refused.amount:.4f} {units[refused.refusal]}")
impact = planar_impact(rod, sliding, contact)
(x, y), w = impact.velocity.v, impact.velocity.w
outcome = impact.outcome.name.lower().replace("_", " ")
print(f"  as an impact: it {outcome}, v = ({x:.4f}, {y:.4f}) m/s, w = {w:.4f} rad/s")

at_rest = PlanarContactProblem(body=rod, contacts=[contact], wrench=PlanarWrench(f=(-1.0, 0.0)))
answer = contact_modes(at_rest)
print(f"at rest, pulled along the wall: {answer.verdict.name.lower()}")
for mode in answer.modes:
    (t, n), (x, y) = mode.contact_forces[0], mode.acceleration[:2]
    print(f"  {mode.mode}: force (t, n) = ({t:.4f}, {n:.4f}) N, acceleration ({x:.4f}, {y:.4f}) m/s^2")
