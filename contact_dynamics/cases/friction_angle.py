"""A block on a slope at its friction angle, and a hair above and below: does it slide?"""

from __future__ import annotations

import math
from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench


def exact(beyond: float) -> float:
    """Return g (sin - mu cos) of a slope that is steeper than atan(mu), m/s^2, and 0 otherwise.

    With the slope atan(mu) + d this is g sin(d) sqrt(1 + mu^2), which does not cancel.
    """
    return max(0.0, -STANDARD_GRAVITY_W[2] * math.sin(beyond) * math.hypot(1.0, 0.5))


def ours(beyond: float) -> float:
    """Return the acceleration down the slope, m/s^2."""
    slope, g = math.atan(0.5) + beyond, -STANDARD_GRAVITY_W[2]
    block = PlanarBody(mass=1.0, inertia=1.0 / 600.0)
    feet = [PlanarContact(r=(x, -0.02), normal=(0.0, 1.0), friction=0.5) for x in (-0.05, 0.05)]
    weight = PlanarWrench(f=(g * math.sin(slope), -g * math.cos(slope)))
    problem = PlanarContactProblem(body=block, contacts=feet, wrench=weight, acceleration_tolerance=1e-12)
    (mode,) = contact_modes(problem).modes
    return mode.acceleration[0]


def mujoco(beyond: float) -> float:
    """Return the mean acceleration over 1 s of a block that lay there for 1 s, m/s^2."""
    slope, g = math.atan(0.5) + beyond, -STANDARD_GRAVITY_W[2]
    simulation = Simulation(
        '<geom type="plane" size="50 50 1"/><body pos="0 0 0.02"><freejoint/>'
        '<geom type="box" size="0.05 0.05 0.02" mass="1"/></body>',
        gravity=f"{g * math.sin(slope)} 0 {-g * math.cos(slope)}",
        defaults='friction="0.5 0 0"',
    )
    simulation.run(1.0)
    before = float(simulation.data.qvel[0])
    simulation.run(1.0)
    return float(simulation.data.qvel[0]) - before


def request(beyond: float) -> str:
    """Return the request at ten times the angle, which the service's tolerance of accelerations (1e-9) tells."""
    slope, weight = math.atan(0.5) + 10.0 * beyond, -STANDARD_GRAVITY_W[2]
    return (
        "{inertia: {m: 1.0, ixx: 0.002, iyy: 0.002, izz: 0.002}, state_source: 1, contact_source: 1,\n"
        "  contacts: {positions: [-0.05, 0.0, -0.02, 0.05, 0.0, -0.02], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],\n"
        "  frictions: [0.5, 0.5], restitutions: [0.0, 0.0]}, gravity: 1, problem: 1, plane_normal: {y: -1.0},\n"
        f"  applied_wrench: {{force: {{x: {weight * math.sin(slope)!r}, z: {-weight * math.cos(slope)!r}}}}}}}"
    )


CASE: Final = Case(
    title="A block on a slope at its friction angle",
    story="The slope differs from atan μ by a billionth of a radian. Below atan μ the block rests, and above it "
    "slides. With regularized friction it slides in both cases.",
    threads=(
        "https://github.com/schteppe/cannon.js/issues/288",
        "https://github.com/liabru/matter-js/issues/752",
        "https://github.com/raisimTech/raisimLib/issues/55",
    ),
    setting="slope minus atan μ, rad",
    settings=(-1e-9, 1e-9),
    quantity="acceleration, m/s²",
    formula="0, or g (sin(slope) − μ cos(slope))",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-14,
    why_tolerance="rounding of numbers of the size of g, of which this is the difference",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].linear_acceleration[0]",
        exact=lambda beyond: exact(10.0 * beyond),
        tolerance=1e-13,
    ),
)
