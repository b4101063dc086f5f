"""A ball on a slope: how fast does it gain speed?"""

from __future__ import annotations

import math
from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench


def exact(degrees: float) -> float:
    """Return 5/7 g sin where it rolls, up to tan = 7/2 mu, and g (sin - mu cos) where it slides, m/s^2."""
    slope, g = math.radians(degrees), -STANDARD_GRAVITY_W[2]
    if math.tan(slope) <= 3.5 * 0.2:
        return 5.0 / 7.0 * g * math.sin(slope)
    return g * (math.sin(slope) - 0.2 * math.cos(slope))


def ours(degrees: float) -> float:
    """Return the acceleration of a ball on the slope, m/s^2."""
    slope, g = math.radians(degrees), -STANDARD_GRAVITY_W[2]
    ball = PlanarBody(mass=1.0, inertia=0.4 * 0.1**2)
    ground = PlanarContact(r=(0.0, -0.1), normal=(0.0, 1.0), friction=0.2)
    weight = PlanarWrench(f=(g * math.sin(slope), -g * math.cos(slope)))
    (mode,) = contact_modes(PlanarContactProblem(body=ball, contacts=[ground], wrench=weight)).modes
    return mode.acceleration[0]


def mujoco(degrees: float) -> float:
    """Return the mean acceleration over 1 s, m/s^2."""
    slope, g = math.radians(degrees), -STANDARD_GRAVITY_W[2]
    simulation = Simulation(
        '<geom type="plane" size="99 99 1"/><body pos="0 0 0.1"><freejoint/><geom size="0.1" mass="1"/></body>',
        gravity=f"{g * math.sin(slope)} 0 {-g * math.cos(slope)}",
        defaults='friction="0.2 0 0"',
    )
    simulation.run(1.0)
    return float(simulation.data.qvel[0])


def request(degrees: float) -> str:
    """Return the request with the weight as the applied wrench."""
    slope, weight = math.radians(degrees), -STANDARD_GRAVITY_W[2]
    return (
        "{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1, contact_source: 1,\n"
        "  contacts: {positions: [0.0, 0.0, -0.1], normals: [0.0, 0.0, 1.0], frictions: [0.2], restitutions: [0.0]},\n"
        "  gravity: 1, problem: 1, plane_normal: {y: -1.0},\n"
        f"  applied_wrench: {{force: {{x: {weight * math.sin(slope)!r}, z: {-weight * math.cos(slope)!r}}}}}}}"
    )


CASE: Final = Case(
    title="A ball on a slope, rolling or sliding",
    story="Users saw balls roll down at constant speed, or shoot off. A rigid ball rolls with 5/7 g sin(slope) "
    "up to tan(slope) = 7/2 μ, and slides on steeper slopes.",
    threads=(
        "https://github.com/liabru/matter-js/issues/1158",
        "https://github.com/gazebosim/gz-physics/issues/7",
    ),
    setting="slope, degrees",
    settings=(30.0, 40.0),
    quantity="acceleration, m/s²",
    formula="5/7 g sin(slope), or g (sin(slope) − μ cos(slope))",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-13,
    why_tolerance="rounding of numbers of the size of g",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].linear_acceleration[0]",
        exact=exact,
        tolerance=1e-13,
    ),
)
