"""A body that falls: how far is it after a time?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.rigid_body import BodyState, inertia
from contact_dynamics.tumbling import free_motion


def exact(seconds: float) -> float:
    """Return -g t^2 / 2, m."""
    return 0.5 * STANDARD_GRAVITY_W[2] * seconds**2


def ours(seconds: float) -> float:
    """Return the height after falling from rest at 0, m."""
    ball = inertia.sphere(radius=0.1, mass=1.0).mass_properties
    at_rest = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    return float(free_motion(ball, at_rest).state_at(seconds).p_WB_W[2])


def mujoco(seconds: float) -> float:
    """Return that height with a time step of 1/60 s, as in the thread, m."""
    simulation = Simulation(
        '<body><freejoint/><geom size="0.1" mass="1"/></body>', options=f'timestep="{1.0 / 60.0!r}"'
    )
    simulation.run(seconds)
    return float(simulation.data.qpos[2])


def request(seconds: float) -> str:
    """Return the request for one sample."""
    return f"{{state_source: 1, inertia: {{m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}}, times: [{seconds}]}}"


CASE: Final = Case(
    title="Free fall",
    story="An integrator that uses the velocity at the end of the step makes a body fall g t Δt / 2 too far. "
    "Here flight is a closed form at any time.",
    threads=(
        "https://github.com/dimforge/rapier/issues/525",
        "https://github.com/schteppe/cannon.js/issues/353",
    ),
    setting="time, s",
    settings=(1.0,),
    quantity="height, m",
    formula="−g t² / 2",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-15,
    why_tolerance="rounding of a number of size 5",
    request=Request(
        service="predict_tumbling",
        text=request,
        answer="trajectory.positions[2]",
        exact=exact,
        tolerance=1e-15,
    ),
)
