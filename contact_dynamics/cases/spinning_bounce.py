"""A ball with back spin that bounces: where does it go?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation, softness
from contact_dynamics.contact import Contact
from contact_dynamics.impact import spatial_impact
from contact_dynamics.rigid_body import BodyState, inertia


def exact(spin: float) -> float:
    """Return 5/7 (v + 2/5 r w), m/s, with v = 2 m/s and r = 0.1 m: the ball grips and leaves rolling."""
    return 5.0 / 7.0 * (2.0 + 0.4 * 0.1 * spin)


def ours(spin: float) -> float:
    """Return the forward velocity after the bounce, m/s."""
    ball = inertia.sphere(radius=0.1, mass=1.0).mass_properties
    thrown = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[2, 0, -4], w_WB_W=[0, spin, 0])
    floor = Contact(p_WC_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.8, restitution=0.8)
    return float(spatial_impact(ball, thrown, floor).state.v_WB_W[0])


def mujoco(spin: float) -> float:
    """Return that velocity of MuJoCo's, whose contact is a spring and damper for e = 0.8, m/s."""
    simulation = Simulation(
        '<geom type="plane" size="50 50 1"/><body pos="0 0 0.11"><freejoint/><geom size="0.1" mass="1"/></body>',
        gravity="0 0 0",
        defaults=f'friction="0.8 0 0" solref="{softness(0.8)}"',
    )
    simulation.data.qvel[0:6] = [2.0, 0.0, -4.0, 0.0, spin, 0.0]
    simulation.run(0.5)
    return float(simulation.data.qvel[0])


def request(spin: float) -> str:
    """Return the request with one explicit contact."""
    return (
        "{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1,\n"
        f"  state: {{linear_velocity: {{x: 2.0, z: -4.0}}, angular_velocity: {{y: {spin}}}}}, contact_source: 1,\n"
        "  contacts: {positions: [0.0, 0.0, -0.1], normals: [0.0, 0.0, 1.0], frictions: [0.8], restitutions: [0.8]}}"
    )


CASE: Final = Case(
    title="A ball with backspin",
    story="Users found that friction and spin decay over bounces, or that spin does not affect the velocity. A "
    "rigid ball that grips leaves the floor rolling, and enough backspin sends it back.",
    threads=("https://github.com/avianphysics/avian/issues/200",),
    setting="spin, rad/s (negative: backspin)",
    settings=(-40.0, -80.0),
    quantity="forward velocity after the bounce, m/s",
    formula="5/7 (v + 2/5 r ω)",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-14,
    why_tolerance="rounding of numbers of size 10",
    request=Request(
        service="predict_impact",
        text=request,
        answer="impact.state_after.linear_velocity.x",
        exact=exact,
        tolerance=1e-14,
    ),
)
