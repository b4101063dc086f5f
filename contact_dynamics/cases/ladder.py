"""A ladder between a rough floor and a smooth wall: does its foot slip?"""

from __future__ import annotations

import math
from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench

FRICTION: Final = 0.5


def exact(beyond: float) -> float:
    """Return 0 rad/s^2 where tan(angle) >= 1 / (2 mu), and otherwise the acceleration of the sliding ladder.

    With half length l and I = m l^2 / 3: alpha = g (cos - 2 mu sin) / (l (4/3 - 2 mu sin cos)).
    """
    angle, g = math.atan(0.5 / FRICTION) - beyond, -STANDARD_GRAVITY_W[2]
    excess = math.cos(angle) - 2.0 * FRICTION * math.sin(angle)
    if beyond < 0.0:
        return 0.0
    return g * excess / (4.0 / 3.0 - 2.0 * FRICTION * math.sin(angle) * math.cos(angle))


def ours(beyond: float) -> float:
    """Return the angular acceleration of a ladder of 2 m, rad/s^2."""
    angle = math.atan(0.5 / FRICTION) - beyond
    x, y = math.cos(angle), math.sin(angle)
    ladder = PlanarBody(mass=1.0, inertia=1.0 / 3.0)
    foot = PlanarContact(r=(x, -y), normal=(0.0, 1.0), friction=FRICTION)
    top = PlanarContact(r=(-x, y), normal=(1.0, 0.0), friction=0.0)
    weight = PlanarWrench(f=(0.0, STANDARD_GRAVITY_W[2]))
    (mode,) = contact_modes(PlanarContactProblem(body=ladder, contacts=[foot, top], wrench=weight)).modes
    return mode.angular_acceleration


def mujoco(beyond: float) -> float:
    """Return the mean angular acceleration of MuJoCo's ladder over the first 0.1 s, rad/s^2."""
    angle, ball = math.atan(0.5 / FRICTION) - beyond, 0.001
    x, y = math.cos(angle), math.sin(angle)
    simulation = Simulation(
        f'<geom type="plane" size="9 9 1" friction="{FRICTION} 0 0" priority="1"/>'
        f'<geom type="plane" size="9 9 1" pos="{-x - ball} 0 {y}" euler="0 90 0" friction="0 0 0" priority="1"/>'
        f'<body pos="0 0 {y + ball}"><freejoint/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.333333333 0.333333333 0.333333333"/>'
        f'<geom size="{ball}" pos="{x} 0 {-y}"/><geom size="{ball}" pos="{-x} 0 {y}"/></body>'
    )
    simulation.run(0.1)
    return -float(simulation.data.qvel[4]) / 0.1


def request(beyond: float) -> str:
    """Return the request with two explicit contacts."""
    angle = math.atan(0.5 / FRICTION) - beyond
    x, y = math.cos(angle), math.sin(angle)
    return (
        "{inertia: {m: 1.0, ixx: 0.333333333333, iyy: 0.333333333333, izz: 0.333333333333}, state_source: 1,\n"
        f"  contact_source: 1, contacts: {{positions: [{x:.15g}, 0.0, {-y:.15g}, {-x:.15g}, 0.0, {y:.15g}],\n"
        f"  normals: [0.0, 0.0, 1.0, 1.0, 0.0, 0.0], frictions: [{FRICTION}, 0.0], restitutions: [0.0, 0.0]}},\n"
        "  problem: 1, plane_normal: {y: -1.0}}"
    )


CASE: Final = Case(
    title="A ladder against a smooth wall",
    story="The foot holds if tan(angle) is at least 1 / (2 μ). Errors of approximate friction show at such "
    "thresholds: bodies move before they should.",
    threads=(
        "https://github.com/raisimTech/raisimLib/issues/55",
        "https://github.com/google-deepmind/mujoco/pull/3349",
    ),
    setting="angle below the limit, rad",
    settings=(-0.01, 0.01),
    quantity="angular acceleration, rad/s²",
    formula="0, or g (cos − 2 μ sin) / (l (4/3 − 2 μ sin cos)) of the angle, with half length l",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-13,
    why_tolerance="rounding of numbers of the size of g",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].angular_acceleration[1]",
        exact=lambda beyond: -exact(beyond),  # the plane is seen from -y
        tolerance=1e-10,
    ),
)
