"""A rod that slides on a rough floor and leans so that no finite force is consistent: what happens?"""

from __future__ import annotations

import math
from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.impact import planar_impact
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity

LEAN: Final = math.radians(75.0)
REACH: Final = (-4.0 * math.cos(LEAN), -4.0 * math.sin(LEAN))  # the tip from the centre of mass, m


def exact(friction: float) -> float:
    """Return the upward velocity by Routh's construction, m/s, with m = 1, I = 1, v = (-1, 0), e = 0.5.

    Friction (mu, 1) stops the sliding while the tip is driven into the floor. From there the path follows the
    sticking line until the tip has stopped approaching. Restitution adds half of that impulse.
    """
    x, y = REACH
    tangent, cross, normal = 1.0 + y * y, -x * y, 1.0 + x * x
    stop = 1.0 / (tangent * friction + cross)
    approach = (cross * friction + normal) * stop
    compression = stop - approach / (normal - cross * cross / tangent)
    return 1.5 * compression


def ours(friction: float) -> float:
    """Return the upward velocity of the centre of mass after the jam, m/s."""
    rod, sliding = PlanarBody(mass=1.0, inertia=1.0), PlanarVelocity(v=(-1.0, 0.0), w=0.0)
    tip = PlanarContact(r=REACH, normal=(0.0, 1.0), friction=friction, restitution=0.5)
    return planar_impact(rod, sliding, tip).velocity.v[1]


def mujoco(friction: float) -> float:
    """Return the largest upward velocity in the first 0.2 s, m/s, of a rod with a small ball as its tip."""
    x, y = REACH
    simulation = Simulation(
        f'<geom type="plane" size="50 50 1"/><body pos="0 0 {-y}"><freejoint/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        f'<geom size="0.01" pos="{x} 0 {y + 0.01}"/></body>',
        options='timestep="0.0005"',
        defaults=f'friction="{friction} 0 0"',
    )
    simulation.data.qvel[0] = -1.0
    most = 0.0
    for _ in range(400):
        simulation.run(0.0005)
        most = max(most, float(simulation.data.qvel[2]))
    return most


def request(friction: float) -> str:
    """Return the request about the sliding rod in its plane."""
    x, y = REACH
    return (
        "{inertia: {m: 1.0, ixx: 1.0, iyy: 1.0, izz: 1.0}, state_source: 1, state: {linear_velocity: {x: -1.0}},\n"
        f"  contact_source: 1, contacts: {{positions: [{x!r}, 0.0, {y!r}], normals: [0.0, 0.0, 1.0],\n"
        f"  frictions: [{friction}], restitutions: [0.5]}}, problem: 1, plane_normal: {{y: -1.0}}}}"
    )


CASE: Final = Case(
    title="A sliding rod in Painlevé's paradox",
    story="Sliding drives the rod's tip into the floor, and no finite force is consistent. A rigid rod jams: an "
    "impact without approach stops the tip and throws the rod up, by the same amount for any such μ. Soft "
    "contacts hide or delay the jam.",
    threads=(
        "https://github.com/RobotLocomotion/drake/pull/4539",
        "https://github.com/RobotLocomotion/drake/pull/5175",
    ),
    setting="μ",
    settings=(0.6, 1.0),
    quantity="upward velocity after the jam, m/s",
    formula="1.5 P, where P is the normal impulse at which Routh's path, along the cone's edge and then the "
    "sticking line, ends compression",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-14,
    why_tolerance="rounding of numbers of size 1",
    request=Request(
        service="predict_impact",
        text=request,
        answer="impact.state_after.linear_velocity.z",
        exact=exact,
        tolerance=1e-14,
    ),
)
