"""A ball without losses: is it as high after many bounces as it was dropped?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation, softness
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.impact import spatial_impact
from contact_dynamics.landing import next_landing
from contact_dynamics.rigid_body import BodyState, inertia
from contact_dynamics.shapes import sphere
from contact_dynamics.world import Body, Surface, World


def exact(bounces: float) -> float:
    """Return 1 m, however often it bounces, since nothing takes energy."""
    return 1.0 + 0.0 * bounces


def ours(bounces: float) -> float:
    """Return the height to which a ball rises after so many bounces, m, that was dropped from 1 m."""
    ball = Body(
        name="ball",
        mass_properties=inertia.sphere(radius=0.1, mass=1.0).mass_properties,
        shape=sphere(radius=0.1),
    )
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=1.0)
    world = World(bodies=(ball,), surfaces=(floor,))
    state = BodyState(p_WB_W=[0, 0, 1.1], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    for _ in range(int(bounces)):
        landing = next_landing(ball, state, world, horizon=2.0)
        if landing is None:
            break
        state = spatial_impact(ball, landing.state, landing.contacts[0]).state
    return float(state.v_WB_W[2]) ** 2 / (-2.0 * STANDARD_GRAVITY_W[2])


def mujoco(bounces: float) -> float:
    """Return that height with a contact that is a spring without a damper."""
    simulation = Simulation(
        '<geom type="plane" size="5 5 1"/><body pos="0 0 1.1"><freejoint/><geom size="0.1" mass="1"/></body>',
        defaults=f'solref="{softness(1.0)}"',
    )
    seen, rising, height = 0, False, 0.0
    for _ in range(100 * int(bounces) * 10):
        simulation.run(float(simulation.model.opt.timestep))
        speed, above = float(simulation.data.qvel[2]), float(simulation.data.qpos[2]) - 0.1
        if speed > 0.0 and not rising and above < 0.01:
            seen += 1
        rising = speed > 0.0
        height = max(height, above) if seen == bounces else height
        if seen > bounces:
            break
    return height


def request(bounces: float) -> str:
    """Return the request about one bounce, with the speed after falling 1 m."""
    del bounces
    return (
        "{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1,\n"
        "  state: {linear_velocity: {z: -4.428690551}}, contact_source: 1, contacts: {positions: [0.0, 0.0, -0.1],\n"
        "  normals: [0.0, 0.0, 1.0], frictions: [0.5], restitutions: [1.0]}}"
    )


CASE: Final = Case(
    title="A ball at e = 1 that keeps its height",
    story="Users found that a lossless ball jumps higher with every bounce, or lower, because gravity and "
    "impact share a time step. Here flight and impact are computed separately, each exactly.",
    threads=(
        "https://github.com/dimforge/rapier/issues/97",
        "https://github.com/jrouwe/JoltPhysics/issues/1286",
        "https://github.com/erincatto/box2d/issues/167",
        "https://github.com/bulletphysics/bullet3/issues/1530",
    ),
    setting="number of bounces",
    settings=(100.0,),
    quantity="height after the bounces, m",
    formula="1, the initial height",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-12,
    why_tolerance="rounding over a hundred landings",
    request=Request(
        service="predict_impact",
        text=request,
        answer="impact.state_after.linear_velocity.z",
        exact=lambda _bounces: 4.428690551,
        tolerance=1e-14,
    ),
)
