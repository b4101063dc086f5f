"""A capsule on a slope that is far from slipping: does it stay where it is?"""

from __future__ import annotations

import math
from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench


def exact(margin: float) -> float:
    """Return 0 m, since friction could hold ``margin`` times the load."""
    return 0.0 * margin


def ours(margin: float) -> float:
    """Return how far the capsule is after 10 s, m."""
    slope, g = math.atan(0.7 / margin), -STANDARD_GRAVITY_W[2]
    capsule = PlanarBody(mass=0.045, inertia=6e-6)
    ends = [PlanarContact(r=(x, -0.004), normal=(0.0, 1.0), friction=0.7) for x in (-0.02, 0.02)]
    weight = PlanarWrench(f=(0.045 * g * math.sin(slope), -0.045 * g * math.cos(slope)))
    (mode,) = contact_modes(PlanarContactProblem(body=capsule, contacts=ends, wrench=weight)).modes
    return 0.5 * mode.acceleration[0] * 10.0**2


def mujoco(margin: float) -> float:
    """Return how far it creeps in 10 s, with the elliptic cone and the impedance that MuJoCo advises."""
    slope, g = math.atan(0.7 / margin), -STANDARD_GRAVITY_W[2]
    simulation = Simulation(
        '<geom type="plane" size="5 5 1"/><body pos="0 0 0.004"><freejoint/>'
        '<geom type="capsule" size="0.004" fromto="-0.02 0 0 0.02 0 0" mass="0.045"/></body>',
        options='cone="elliptic" impratio="10"',
        gravity=f"{g * math.sin(slope)} 0 {-g * math.cos(slope)}",
        defaults='friction="0.7 0 0"',
    )
    simulation.run(1.0)  # it settles
    start = float(simulation.data.qpos[0])
    simulation.run(10.0)
    return float(simulation.data.qpos[0]) - start


def request(margin: float) -> str:
    """Return the request: two explicit contacts, and the weight along the slope as the applied wrench."""
    slope, weight = math.atan(0.7 / margin), -0.045 * STANDARD_GRAVITY_W[2]
    return (
        "{inertia: {m: 0.045, ixx: 0.000006, iyy: 0.000006, izz: 0.000006}, state_source: 1, contact_source: 1,\n"
        "  contacts: {positions: [-0.02, 0.0, -0.004, 0.02, 0.0, -0.004], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],\n"
        "  frictions: [0.7, 0.7], restitutions: [0.0, 0.0]}, gravity: 1, problem: 1, plane_normal: {y: -1.0},\n"
        f"  applied_wrench: {{force: {{x: {weight * math.sin(slope):.9f}, z: {-weight * math.cos(slope):.9f}}}}}}}"
    )


CASE: Final = Case(
    title="A capsule that must stick on a slope",
    story="A capsule rests on a slope, with a friction limit many times its load along the slope. Engines that "
    "regularize friction let it creep for as long as they run. With Coulomb friction it does not move.",
    threads=(
        "https://github.com/google-deepmind/mujoco/issues/3328",
        "https://github.com/liabru/matter-js/issues/613",
    ),
    setting="friction limit over the load along the slope",
    settings=(20.0, 95.0),
    quantity="distance after 10 s, m",
    formula="0, since tan(slope) = μ / margin is below μ",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-12,
    why_tolerance="rounding of g, times half of (10 s)²",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].linear_acceleration[0]",
        exact=exact,
        tolerance=1e-14,
    ),
)
