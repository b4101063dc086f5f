"""A peg or a drawer that is pushed beside its middle: does it move, or jam?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench

OFFSET: Final = 0.1  # m, from the middle to the push


def exact(friction: float) -> float:
    """Return (F / m) (1 - 2 mu d / L) m/s^2, and 0 where 2 mu d >= L: the walls press with F d / L each."""
    return max(0.0, 10.0 * (1.0 - 2.0 * friction * OFFSET / 0.2))


def ours(friction: float) -> float:
    """Return the acceleration of a drawer of 1 kg and 0.2 m that is pushed with 10 N, m/s^2."""
    drawer = PlanarBody(mass=1.0, inertia=0.01)
    left = PlanarContact(r=(-0.05, 0.1), normal=(1.0, 0.0), friction=friction)
    right = PlanarContact(r=(0.05, -0.1), normal=(-1.0, 0.0), friction=friction)
    push = PlanarWrench(f=(0.0, 10.0), moment=10.0 * OFFSET)
    answer = contact_modes(PlanarContactProblem(body=drawer, contacts=[left, right], wrench=push))
    return min(mode.acceleration[1] for mode in answer.modes)


def mujoco(friction: float) -> float:
    """Return the mean acceleration over the first 0.1 s, m/s^2, of a body with two small balls between walls."""
    simulation = Simulation(
        '<geom type="plane" size="9 9 1" pos="-0.05 0 0" euler="0 90 0"/>'
        '<geom type="plane" size="9 9 1" pos="0.05 0 0" euler="0 -90 0"/>'
        '<body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>'
        '<geom size="0.001" pos="-0.049 0 0.1"/><geom size="0.001" pos="0.049 0 -0.1"/></body>',
        gravity="0 0 0",
        defaults=f'friction="{friction} 0 0"',
    )
    simulation.data.xfrc_applied[1] = [0.0, 0.0, 10.0, 0.0, -10.0 * OFFSET, 0.0]
    simulation.run(0.1)
    return float(simulation.data.qvel[1]) / 0.1


def request(friction: float) -> str:
    """Return the request in the plane, without gravity."""
    return (
        "{inertia: {m: 1.0, ixx: 0.01, iyy: 0.01, izz: 0.01}, state_source: 1, contact_source: 1,\n"
        "  contacts: {positions: [-0.05, 0.0, 0.1, 0.05, 0.0, -0.1], normals: [1.0, 0.0, 0.0, -1.0, 0.0, 0.0],\n"
        f"  frictions: [{friction}, {friction}], restitutions: [0.0, 0.0]}}, gravity: 1, problem: 1,\n"
        f"  plane_normal: {{y: -1.0}}, applied_wrench: {{force: {{z: 10.0}}, torque: {{y: {-10.0 * OFFSET}}}}}}}"
    )


CASE: Final = Case(
    title="A peg or drawer that jams",
    story="An off-centre push presses a peg, or a drawer, against both walls. Above a friction of L / (2 d) it "
    "jams, however hard it is pushed. Users saw pegs pass through walls, or not move at all.",
    threads=(
        "https://github.com/bulletphysics/bullet3/issues/2148",
        "https://github.com/google-deepmind/mujoco/issues/1544",
    ),
    setting="μ (the limit is 1)",
    settings=(0.9, 1.1),
    quantity="acceleration along the walls, m/s²",
    formula="F (1 − 2 μ d / L) / m, but not below 0",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-13,
    why_tolerance="rounding of numbers of size 10",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].linear_acceleration[2]",
        exact=exact,
        tolerance=1e-13,
    ),
)
