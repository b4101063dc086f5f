"""A ball that is dropped: does it leave with the coefficient of restitution that was asked for?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation, softness
from contact_dynamics.contact import Contact
from contact_dynamics.impact import spatial_impact
from contact_dynamics.rigid_body import BodyState, inertia


def exact(restitution: float) -> float:
    """Return the coefficient itself, by its definition."""
    return restitution


def ours(restitution: float) -> float:
    """Return the speed after the impact over that before."""
    ball = inertia.sphere(radius=0.1, mass=1.0).mass_properties
    falling = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -3.0], w_WB_W=[0, 0, 0])
    floor = Contact(p_WC_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=restitution)
    return float(spatial_impact(ball, falling, floor).state.v_WB_W[2]) / 3.0


def mujoco(restitution: float) -> float:
    """Return that ratio of a ball whose contact is a spring and damper for that restitution (`solref`)."""
    simulation = Simulation(
        '<geom type="plane" size="5 5 1"/><body pos="0 0 0.11"><freejoint/><geom size="0.1" mass="1"/></body>',
        defaults=f'solref="{softness(restitution)}"',
        gravity="0 0 0",
    )
    simulation.data.qvel[2] = -3.0
    simulation.run(0.5)
    return float(simulation.data.qvel[2]) / 3.0


def request(restitution: float) -> str:
    """Return the request with one explicit contact."""
    return (
        "{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1,\n"
        "  state: {linear_velocity: {z: -3.0}}, contact_source: 1, contacts: {positions: [0.0, 0.0, -0.1],\n"
        f"  normals: [0.0, 0.0, 1.0], frictions: [0.5], restitutions: [{restitution}]}}}}"
    )


CASE: Final = Case(
    title="A ball with a given restitution",
    story="In engines with spring-damper contacts, restitution follows from stiffness, damping and time step, "
    "and only approximates the intended value. In this package, e is the value you state.",
    threads=(
        "https://github.com/google-deepmind/mujoco/issues/2080",
        "https://github.com/NVIDIAGameWorks/PhysX/issues/351",
    ),
    setting="e",
    settings=(0.75, 0.3),
    quantity="speed after the impact over speed before",
    formula="e, by definition",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-15,
    why_tolerance="rounding of a number of size 1",
    request=Request(
        service="predict_impact",
        text=request,
        answer="impact.state_after.linear_velocity.z",
        exact=lambda restitution: 3.0 * restitution,
        tolerance=1e-14,
    ),
)
