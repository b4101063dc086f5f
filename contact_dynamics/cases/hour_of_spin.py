"""An asymmetric body that spins for an hour: is its energy the same?"""

from __future__ import annotations

from typing import Final

import numpy as np

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.flip_period import MOMENTS
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.rigid_body import BodyState, MassProperties, kinetic_energy
from contact_dynamics.tumbling import free_motion


def exact(seconds: float) -> float:
    """Return 0, since without torque the energy stays."""
    return 0.0 * seconds


def ours(seconds: float) -> float:
    """Return the relative change of the kinetic energy."""
    body = MassProperties(mass=1.0, I_B=np.diag([1.0e-3, 2.0e-3, 2.8e-3]))
    spin = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0.1, 10.0, 0.0])
    later = free_motion(body, spin, gravity_W=[0, 0, 0]).state_at(seconds)
    return kinetic_energy(body, later) / kinetic_energy(body, spin) - 1.0


def mujoco(seconds: float) -> float:
    """Return that change of MuJoCo's with its default integrator. It is stopped once the energy has doubled."""
    simulation = Simulation(
        '<body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="0.0028 0.002 0.001" '
        'quat="0.70710678118654752 0 0.70710678118654752 0"/></body>',
        gravity="0 0 0",
    )
    simulation.data.qvel[3:6] = [0.1, 10.0, 0.0]
    before = 0.5 * float(np.dot(MOMENTS, simulation.data.qvel[3:6] ** 2))
    change = 0.0
    for _ in range(round(seconds)):
        simulation.run(1.0)
        change = 0.5 * float(np.dot(MOMENTS, simulation.data.qvel[3:6] ** 2)) / before - 1.0
        if change >= 1.0:  # a little later it is beyond all bounds
            break
    return change


def request(seconds: float) -> str:
    """Return the request for one sample; the energy comes with every answer."""
    return (
        "{state_source: 1, inertia: {m: 1.0, ixx: 0.001, iyy: 0.002, izz: 0.0028}, gravity: 1,\n"
        f"  state: {{angular_velocity: {{x: 0.1, y: 10.0}}}}, times: [{seconds}]}}"
    )


CASE: Final = Case(
    title="Energy after an hour of free spin",
    story="Users report engines that gain or lose energy in free spin, or drift to another axis. The closed "
    "form conserves energy and angular momentum at any time. (MuJoCo's default integrator is stopped once "
    "the energy has doubled; its Runge-Kutta integrator does far better.)",
    threads=(
        "https://github.com/avianphysics/avian/pull/993",
        "https://github.com/jrouwe/JoltPhysics/issues/803",
    ),
    setting="time, s",
    settings=(60.0, 3600.0),
    quantity="relative change of energy",
    formula="0",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-13,
    why_tolerance="the closed form conserves energy and angular momentum to 1e-13",
    request=Request(
        service="predict_tumbling",
        text=request,
        answer="poinsot.rotational_energy",
        exact=lambda _seconds: 0.5 * (1e-3 * 0.1**2 + 2e-3 * 10.0**2),
        tolerance=1e-16,
    ),
)
