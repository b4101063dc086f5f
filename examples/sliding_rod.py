"""Lecture 26's rod: no contact mode is consistent, or two are. Lecture 27 settles the first as an impact."""

import math

from contact_dynamics import (
    PlanarBody,
    PlanarContact,
    PlanarVelocity,
    PlanarWrench,
    planar_impact,
)
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes

rod = PlanarBody(mass=1.0, inertia=1.0)
theta = math.radians(75.0)
contact = PlanarContact(
    r=(-4.0 * math.cos(theta), -4.0 * math.sin(theta)),
    normal=(0.0, 1.0),
    friction=math.tan(math.radians(30.0)),
)

sliding = PlanarVelocity(v=(-1.0, 0.0), w=0.0)
answer = contact_modes(
    PlanarContactProblem(body=rod, velocity=sliding, contacts=[contact], wrench=PlanarWrench(f=(0.0, -9.81)))
)
print(f"sliding left under gravity: {answer.verdict.name.lower()}")
for refused in answer.refused:
    print(f"  {refused.mode}: {refused.refusal.name.lower()}, {refused.amount:.4f}")
impact = planar_impact(rod, sliding, contact)
print(f"  as an impact: {impact.outcome.name.lower()}, v = {impact.velocity.v}, w = {impact.velocity.w:.4f}")

at_rest = PlanarContactProblem(body=rod, contacts=[contact], wrench=PlanarWrench(f=(-1.0, 0.0)))
answer = contact_modes(at_rest)
print(f"at rest, pulled along the wall: {answer.verdict.name.lower()}")
for mode in answer.modes:
    print(f"  {mode.mode}: force (t, n) = {mode.contact_forces[0]}, acceleration {mode.acceleration}")
