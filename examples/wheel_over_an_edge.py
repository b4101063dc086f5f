# SPDX-License-Identifier: Apache-2.0
"""A wheel rolls off the end of a table: up to which speed it tips over the edge, and when it flies off."""

import math

from contact_dynamics import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes

RADIUS, MASS, GRAVITY = 0.25, 2.0, 9.81
wheel = PlanarBody(mass=MASS, inertia=0.5 * MASS * RADIUS**2)
weight = PlanarWrench(f=(0.0, -MASS * GRAVITY))
on_the_table = PlanarContact(r=(0.0, -RADIUS), normal=(0.0, 1.0), friction=0.9, body_curvature=1.0 / RADIUS)
on_its_edge = PlanarContact(
    r=(0.0, -RADIUS),
    normal=(0.0, 1.0),
    friction=0.9,
    body_curvature=1.0 / RADIUS,
    surface_curvature=math.inf,  # a corner of the world
)
for speed in (0.5, 1.5, 1.6):
    rolling = PlanarVelocity(v=(speed, 0.0), w=-speed / RADIUS)
    for where, contact in (("on the table", on_the_table), ("on its edge ", on_its_edge)):
        (mode,) = contact_modes(
            PlanarContactProblem(body=wheel, velocity=rolling, contacts=[contact], wrench=weight)
        ).modes
        print(f"{speed} m/s {where}: {mode.mode}, presses with {mode.contact_forces[0][1]:.3f} N")
print(f"it flies off above sqrt(g R) = {math.sqrt(GRAVITY * RADIUS):.3f} m/s")
