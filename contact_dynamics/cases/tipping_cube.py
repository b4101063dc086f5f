"""A cube that slides: does it stay flat, or tip over its front edge?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench


def exact(friction: float) -> float:
    """Return 0 rad/s^2 up to friction 1. Beyond, the front edge alone carries and slides.

    With half side h and I = 2 m h^2 / 3: f_n = m g / (1 + 1.5 (1 - mu)), alpha = 1.5 (1 - mu) f_n / (m h).
    """
    half, g = 0.05, -STANDARD_GRAVITY_W[2]
    if friction <= 1.0:
        return 0.0
    share = 1.5 * (1.0 - friction)
    return share * g / (half * (1.0 + share))


def ours(friction: float) -> float:
    """Return the angular acceleration of a cube of 0.1 m that slides to the right, rad/s^2."""
    cube = PlanarBody(mass=1.0, inertia=0.1**2 / 6.0)
    feet = [PlanarContact(r=(x, -0.05), normal=(0.0, 1.0), friction=friction) for x in (-0.05, 0.05)]
    sliding, weight = PlanarVelocity(v=(6.0, 0.0), w=0.0), PlanarWrench(f=(0.0, STANDARD_GRAVITY_W[2]))
    problem = PlanarContactProblem(body=cube, velocity=sliding, contacts=feet, wrench=weight)
    (mode,) = contact_modes(problem).modes
    return mode.angular_acceleration


def mujoco(friction: float) -> float:
    """Return the mean angular acceleration over the first 20 ms, rad/s^2, of a cube that lay still before."""
    simulation = Simulation(
        '<geom type="plane" size="50 50 1"/><body pos="0 0 0.05"><freejoint/>'
        '<geom type="box" size="0.05 0.05 0.05" mass="1"/></body>',
        defaults=f'friction="{friction} 0 0"',
    )
    simulation.run(1.0)
    simulation.data.qvel[0] = 6.0
    simulation.run(0.02)
    return -float(simulation.data.qvel[4]) / 0.02


def request(friction: float) -> str:
    """Return the request with two explicit contacts."""
    return (
        "{inertia: {m: 1.0, ixx: 0.0016666666666666668, iyy: 0.0016666666666666668, izz: 0.0016666666666666668},\n"
        "  state_source: 1, state: {linear_velocity: {x: 6.0}}, contact_source: 1, problem: 1, plane_normal: {y: -1.0},\n"
        "  contacts: {positions: [-0.05, 0.0, -0.05, 0.05, 0.0, -0.05], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],\n"
        f"  frictions: [{friction}, {friction}], restitutions: [0.0, 0.0]}}}}"
    )


CASE: Final = Case(
    title="A sliding cube that tips only above μ = 1",
    story="A cube is pushed and slides. Its centre of mass is as far above the floor as its front edge is ahead "
    "of it, so it stays flat up to μ = 1 and tips beyond. Users saw it tumble at μ = 0.5.",
    threads=("https://github.com/Genesis-Embodied-AI/genesis-world/issues/3115",),
    setting="μ",
    settings=(0.5, 0.99, 1.01),
    quantity="angular acceleration, rad/s² (negative: forwards)",
    formula="0 up to μ = 1; then 1.5 (1 − μ) g / (h (1 + 1.5 (1 − μ))) with half side h",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-11,
    why_tolerance="rounding of g, over h",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].angular_acceleration[1]",
        exact=lambda friction: -exact(friction),  # the plane is seen from -y
        tolerance=1e-11,
    ),
)
