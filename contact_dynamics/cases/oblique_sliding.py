"""A box that slides askew to the axes: is friction straight against the sliding?"""

from __future__ import annotations

import math
from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact import ContactSet
from contact_dynamics.contact_modes import SpatialContactProblem, contact_modes
from contact_dynamics.rigid_body import BodyState, inertia


def exact(degrees: float) -> float:
    """Return -mu g sin of the direction, m/s^2."""
    return 0.5 * STANDARD_GRAVITY_W[2] * math.sin(math.radians(degrees))


def ours(degrees: float) -> float:
    """Return the acceleration across the x axis of a box that slides at 2 m/s in this direction, m/s^2."""
    box = inertia.box(size=(0.2, 0.2, 0.02), mass=1.0).mass_properties
    v = [2.0 * math.cos(math.radians(degrees)), 2.0 * math.sin(math.radians(degrees)), 0.0]
    sliding = BodyState(p_WB_W=[0, 0, 0.01], q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=[0, 0, 0])
    corners = [[0.1, 0.1, 0.0], [0.1, -0.1, 0.0], [-0.1, 0.1, 0.0], [-0.1, -0.1, 0.0]]
    feet = ContactSet(p_WC_W=corners, normals_W=[0, 0, 1], frictions=0.5)
    problem = SpatialContactProblem(
        body=box, state=sliding, contacts=feet, force_W=[0.0, 0.0, STANDARD_GRAVITY_W[2]]
    )
    (mode,) = contact_modes(problem).modes
    return float(mode.acceleration_W[1])


def mujoco(degrees: float) -> float:
    """Return the mean acceleration across over 0.2 s, m/s^2, with MuJoCo's default cone, a pyramid."""
    simulation = Simulation(
        '<geom type="plane" size="50 50 1"/><body pos="0 0 0.01"><freejoint/>'
        '<geom type="box" size="0.1 0.1 0.01" mass="1"/></body>',
        defaults='friction="0.5 0 0"',
    )
    simulation.run(1.0)
    v = (2.0 * math.cos(math.radians(degrees)), 2.0 * math.sin(math.radians(degrees)))
    simulation.data.qvel[0:2] = v
    simulation.run(0.2)
    return (float(simulation.data.qvel[1]) - v[1]) / 0.2


def request(degrees: float) -> str:
    """Return the request about the sliding box."""
    x, y = 2.0 * math.cos(math.radians(degrees)), 2.0 * math.sin(math.radians(degrees))
    return (
        "{inertia: {m: 1.0, ixx: 0.003366666667, iyy: 0.003366666667, izz: 0.006666666667}, state_source: 1, problem: 2,\n"
        f"  state: {{pose: {{position: {{z: 0.01}}}}, linear_velocity: {{x: {x!r}, y: {y!r}}}}}, contact_source: 1,\n"
        "  contacts: {positions: [0.1, 0.1, 0.0, 0.1, -0.1, 0.0, -0.1, 0.1, 0.0, -0.1, -0.1, 0.0],\n"
        "  normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0], frictions: [0.5, 0.5, 0.5, 0.5],\n"
        "  restitutions: [0.0, 0.0, 0.0, 0.0]}}"
    )


CASE: Final = Case(
    title="A box that slides obliquely to the axes",
    story="Engines that replace the friction cone by a pyramid decelerate a body differently along different "
    "directions, and bend its path. Coulomb friction is exactly opposite to the sliding.",
    threads=(
        "https://github.com/dimforge/rapier/issues/137",
        "https://github.com/osrf/gazebo_tutorials/pull/174",
    ),
    setting="direction of sliding, degrees from the x axis",
    settings=(20.0, 45.0),
    quantity="acceleration along y, m/s²",
    formula="−μ g sin(direction)",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-12,
    why_tolerance="rounding of numbers of the size of g",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].linear_acceleration[1]",
        exact=exact,
        tolerance=1e-12,
    ),
)
