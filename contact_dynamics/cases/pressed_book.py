"""A hand presses a book against a wall: does the book stay?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench


def exact(friction: float) -> float:
    """Return the downward acceleration g - mu N / m, m/s^2, and 0 where friction holds it."""
    return max(0.0, -STANDARD_GRAVITY_W[2] - friction * 20.0)


def ours(friction: float) -> float:
    """Return the downward acceleration of a book of 1 kg that 20 N press against the wall, m/s^2."""
    book = PlanarBody(mass=1.0, inertia=0.01)
    corners = [PlanarContact(r=(-0.01, y), normal=(1.0, 0.0), friction=friction) for y in (-0.1, 0.1)]
    # The hand is smooth and presses where the book would not turn.
    press = PlanarWrench(f=(-20.0, STANDARD_GRAVITY_W[2]))
    (mode,) = contact_modes(PlanarContactProblem(body=book, contacts=corners, wrench=press)).modes
    return -mode.acceleration[1]


def mujoco(friction: float) -> float:
    """Return the mean downward acceleration over 1 s, m/s^2."""
    simulation = Simulation(
        '<geom type="plane" size="50 50 1" euler="0 90 0"/><body pos="0.01 0 0"><freejoint/>'
        '<geom type="box" size="0.01 0.1 0.1" mass="1"/></body>',
        defaults=f'friction="{friction} 0 0"',
    )
    simulation.data.xfrc_applied[1][0] = -20.0
    simulation.run(1.0)
    return -float(simulation.data.qvel[2])


def request(friction: float) -> str:
    """Return the request with the press as the applied force; gravity acts as configured."""
    return (
        "{inertia: {m: 1.0, ixx: 0.01, iyy: 0.01, izz: 0.01}, state_source: 1, contact_source: 1,\n"
        "  contacts: {positions: [-0.01, 0.0, -0.1, -0.01, 0.0, 0.1], normals: [1.0, 0.0, 0.0, 1.0, 0.0, 0.0],\n"
        f"  frictions: [{friction}, {friction}], restitutions: [0.0, 0.0]}}, problem: 1, plane_normal: {{y: -1.0}},\n"
        "  applied_wrench: {force: {x: -20.0}}}"
    )


CASE: Final = Case(
    title="A book pressed against a wall",
    story="Objects slip out of simulated hands however large μ is. Here a smooth hand presses a book against a "
    "wall with the force N. With Coulomb friction the book stays if μ N ≥ m g.",
    threads=(
        "https://github.com/gazebosim/gazebo-classic/issues/2703",
        "https://github.com/bulletphysics/bullet3/issues/2607",
        "https://github.com/PickNikRobotics/ros2_robotiq_gripper/pull/15",
    ),
    setting="μ (the limit is 0.4903)",
    settings=(0.48, 0.5),
    quantity="downward acceleration, m/s²",
    formula="g − μ N / m, but not below 0",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-13,
    why_tolerance="rounding of numbers of the size of g",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].linear_acceleration[2]",
        exact=lambda friction: -exact(friction),
        tolerance=1e-13,
    ),
)
