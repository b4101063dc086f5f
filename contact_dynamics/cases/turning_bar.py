"""A bar that one fingertip presses against a wall, away from its middle: does it turn?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact import ContactSet
from contact_dynamics.contact_modes import SpatialContactProblem, contact_modes
from contact_dynamics.rigid_body import BodyState, MassProperties


def exact(arm: float) -> float:
    """Return m g d / (I + m d^2), rad/s^2: a point contact resists no turning, so the bar is a pendulum."""
    return -STANDARD_GRAVITY_W[2] * arm / (0.01 + arm * arm)


def ours(arm: float) -> float:
    """Return the angular acceleration of a bar of 1 kg, rad/s^2, whose middle is beside the fingertip."""
    bar = MassProperties(mass=1.0, I_B=[[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]])
    state = BodyState(p_WB_W=[arm, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    wall = ContactSet(p_WC_W=[[0, 0, 0]], normals_W=[0, 1, 0], frictions=1.0)
    problem = SpatialContactProblem(
        body=bar,
        state=state,
        contacts=wall,
        force_W=[0.0, -50.0, STANDARD_GRAVITY_W[2]],  # the fingertip presses with 50 N, opposite the contact
        torque_W=[0.0, 0.0, 50.0 * arm],
    )
    (mode,) = contact_modes(problem).modes
    return float(mode.angular_acceleration_W[1])


def mujoco(arm: float) -> float:
    """Return the mean angular acceleration in the first 20 ms, rad/s^2, of a bar that cannot leave its plane."""
    simulation = Simulation(
        f'<geom type="plane" size="5 5 1" euler="-90 0 0"/><body pos="{arm} 0.005 0">'
        '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/>'
        '<joint type="hinge" axis="0 1 0"/><inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>'
        f'<geom size="0.005" pos="{-arm} 0 0"/></body>',
        defaults='friction="1 0.005 0.0001" condim="4"',
    )
    simulation.data.xfrc_applied[1][1] = -50.0
    simulation.run(0.02)
    return float(simulation.data.qvel[3]) / 0.02


def request(arm: float) -> str:
    """Return the request with the fingertip's press as the applied wrench."""
    return (
        f"{{inertia: {{m: 1.0, ixx: 0.01, iyy: 0.01, izz: 0.01}}, state_source: 1, state: {{pose: {{position: {{x: {arm}}}}}}},\n"
        "  contact_source: 1, contacts: {positions: [0.0, 0.0, 0.0], normals: [0.0, 1.0, 0.0], frictions: [1.0],\n"
        f"  restitutions: [0.0]}}, applied_wrench: {{force: {{y: -50.0}}, torque: {{z: {50.0 * arm}}}}}, problem: 2}}"
    )


CASE: Final = Case(
    title="A bar that swings about a fingertip",
    story="A user wanted an object to swing freely between two fingertips and could not disable the resistance. "
    "A point contact with Coulomb friction transmits no moment, so the bar is a pendulum.",
    threads=("https://github.com/Genesis-Embodied-AI/genesis-world/issues/1139",),
    setting="distance from the fingertip to the centre, m",
    settings=(0.1,),
    quantity="angular acceleration, rad/s²",
    formula="m g d / (I + m d²)",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-11,
    why_tolerance="rounding of a number of size 100, and of the search in space",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].angular_acceleration[1]",
        exact=exact,
        tolerance=1e-11,
    ),
)
