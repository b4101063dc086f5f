"""A ball that starts sliding on a floor: how fast is it when it rolls, and does it go on?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench


def exact(speed: float) -> float:
    """Return 5/7 of the speed, m/s, whatever the friction."""
    return 5.0 / 7.0 * speed


def ours(speed: float) -> float:
    """Return the speed at which a ball of radius 0.1 m rolls that started sliding, m/s."""
    ball, radius = PlanarBody(mass=7.0, inertia=0.4 * 7.0 * 0.1**2), 0.1
    floor = PlanarContact(r=(0.0, -radius), normal=(0.0, 1.0), friction=0.2)
    weight = PlanarWrench(f=(0.0, 7.0 * STANDARD_GRAVITY_W[2]))
    sliding = PlanarVelocity(v=(speed, 0.0), w=0.0)
    problem = PlanarContactProblem(body=ball, velocity=sliding, contacts=[floor], wrench=weight)
    (mode,) = contact_modes(problem).modes
    # Both accelerations are constant until the point below the ball has stopped sliding.
    rolls_after = speed / -(mode.acceleration[0] + radius * mode.angular_acceleration)
    return speed + rolls_after * mode.acceleration[0]


def mujoco(speed: float) -> float:
    """Return the speed after 10 s, m/s. Neither rolling nor torsional friction acts."""
    simulation = Simulation(
        '<geom type="plane" size="99 99 1"/><body pos="0 0 0.1"><freejoint/><geom size="0.1" mass="7"/></body>',
        defaults='friction="0.2 0 0"',
    )
    simulation.data.qvel[0] = speed
    simulation.run(10.0)
    return float(simulation.data.qvel[0])


def request(speed: float) -> str:
    """Return the request about the sliding ball, whose round side is stated by its curvature."""
    return (
        f"{{inertia: {{m: 7.0, ixx: 0.028, iyy: 0.028, izz: 0.028}}, state_source: 1, state: {{linear_velocity: {{x: {speed}}}}},\n"
        "  contact_source: 1, contacts: {positions: [0.0, 0.0, -0.1], normals: [0.0, 0.0, 1.0], frictions: [0.2],\n"
        "  restitutions: [0.0], kinds: [2], body_curvatures: [10.0], surface_curvatures: [0.0]}, problem: 1,\n"
        "  plane_normal: {y: -1.0}}"
    )


CASE: Final = Case(
    title="A bowling ball that slides and then rolls",
    story="Users ask why a ball never stops, and engines add damping to stop it. A rigid ball decelerates while "
    "it slides, and then rolls at 5/7 of its initial speed. Rolling resistance is a different model, "
    "which this package does not have.",
    threads=(
        "https://github.com/schteppe/cannon.js/issues/345",
        "https://github.com/lo-th/Oimo.js/issues/64",
    ),
    setting="initial speed, m/s",
    settings=(7.0,),
    quantity="speed once it rolls, m/s",
    formula="5/7 of the initial speed",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-13,
    why_tolerance="rounding of numbers of size 10",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].linear_acceleration[0]",
        exact=lambda _speed: 0.2 * STANDARD_GRAVITY_W[2],
        tolerance=1e-13,
    ),
)
