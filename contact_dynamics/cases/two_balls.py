"""A ball strikes another without losses: which velocities have they then?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation, softness
from contact_dynamics.contact import Contact
from contact_dynamics.impact import spatial_pair_impact
from contact_dynamics.rigid_body import BodyState, inertia


def exact(mass: float) -> float:
    """Return 2 m / (m + M) m/s, for a ball of mass m that strikes one of 10 kg at 1 m/s."""
    return 2.0 * mass / (mass + 10.0)


def ours(mass: float) -> float:
    """Return the speed of the ball that was struck, m/s."""
    first, second = (inertia.sphere(radius=0.5, mass=m).mass_properties for m in (mass, 10.0))
    coming = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0, 0], w_WB_W=[0, 0, 0])
    waiting = BodyState(p_WB_W=[1, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    touch = Contact(p_WC_W=[0.5, 0, 0], normal_W=[-1, 0, 0], friction=0.0, restitution=1.0)
    other = spatial_pair_impact(first, coming, second, waiting, touch).other_state
    return 0.0 if other is None else float(other.v_WB_W[0])


def mujoco(mass: float) -> float:
    """Return that speed where the contact is a spring without a damper, m/s."""
    balls = "".join(
        f'<body pos="{1.1 * i} 0 0"><joint type="slide" axis="1 0 0"/><geom size="0.5" mass="{m}"/></body>'
        for i, m in enumerate((mass, 10.0))
    )
    simulation = Simulation(balls, gravity="0 0 0", defaults=f'solref="{softness(1.0)}"')
    simulation.data.qvel[0] = 1.0
    simulation.run(2.0)
    return float(simulation.data.qvel[1])


def request(mass: float) -> str:
    """Return the request about two bodies."""
    return (
        f"{{inertia: {{m: {mass}, ixx: 1.0, iyy: 1.0, izz: 1.0}}, state_source: 1, state: {{linear_velocity: {{x: 1.0}}}},\n"
        "  other_inertia: {m: 10.0, ixx: 1.0, iyy: 1.0, izz: 1.0}, other_state: [{pose: {position: {x: 1.0}}}],\n"
        "  contact_source: 1, contacts: {positions: [0.5, 0.0, 0.0], normals: [-1.0, 0.0, 0.0], frictions: [0.0],\n"
        "  restitutions: [1.0]}}"
    )


CASE: Final = Case(
    title="An elastic collision of two balls",
    story="Users set the restitution to 1 and saw an inelastic collision, or an increase of energy. "
    "Conservation of momentum and energy leaves one answer.",
    threads=(
        "https://github.com/DanielChappuis/reactphysics3d/issues/96",
        "https://github.com/erincatto/solver2d/issues/19",
        "https://github.com/keenon/nimblephysics/issues/143",
    ),
    setting="mass of the first ball, kg",
    settings=(10.0, 1.0),
    quantity="speed of the second ball (10 kg) over that of the first",
    formula="m over the mean of m and M, where m is the first mass and M the second",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-15,
    why_tolerance="rounding of a number of size 1",
    request=Request(
        service="predict_impact",
        text=request,
        answer="impact.other_state_after[0].linear_velocity.x",
        exact=exact,
        tolerance=1e-15,
    ),
)
