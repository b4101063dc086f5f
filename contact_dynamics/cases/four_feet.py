"""A table on four feet: how much does each carry?"""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.contact import ContactSet
from contact_dynamics.contact_modes import SpatialContactProblem, contact_modes
from contact_dynamics.rigid_body import BodyState, inertia


def exact(mass: float) -> float:
    """Return half the weight, N: each foot may carry anything from nothing to that."""
    return -0.5 * mass * STANDARD_GRAVITY_W[2]


def ours(mass: float) -> float:
    """Return how far the load of a foot is open, N: what it bears with its opposite foot alone, if it is open."""
    table = inertia.box(size=(1.0, 1.0, 0.5), mass=mass).mass_properties
    state = BodyState(p_WB_W=[0, 0, 0.25], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    corners = [[0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [-0.5, 0.5, 0.0]]
    weight = [0.0, 0.0, mass * STANDARD_GRAVITY_W[2]]
    four, two = (
        contact_modes(
            SpatialContactProblem(
                body=table,
                state=state,
                contacts=ContactSet(p_WC_W=feet, normals_W=[0, 0, 1], frictions=0.5),
                force_W=weight,
            )
        ).modes
        for feet in (corners, corners[:2])
    )
    still = next(mode for mode in two if mode.mode == "ff")
    return 0.0 if four[0].forces_unique else float(still.contact_forces_W[0, 2])


def mujoco(mass: float) -> float:
    """Return how far the load of a foot moves if that foot is 0.1 mm shorter, N. One run gives one load."""
    loads = []
    for shorter in (0.0, 1e-4):
        feet = "".join(
            f'<geom size="0.01" pos="{x} {y} {-0.24 + (shorter if x == y == 0.5 else 0.0)}"/>'
            for x in (-0.5, 0.5)
            for y in (-0.5, 0.5)
        )
        simulation = Simulation(
            '<geom type="plane" size="5 5 1"/><body pos="0 0 0.25"><freejoint/>'
            f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{mass / 9.6} {mass / 9.6} {mass / 6.0}"/>{feet}</body>'
        )
        simulation.run(5.0)
        loads.append(simulation.loads()[-1] if simulation.data.ncon == 4 else 0.0)
    return abs(loads[0] - loads[1])


def request(mass: float) -> str:
    """Return the request about the table on two opposite feet, which answers what one of them can bear."""
    moment = mass / 12.0
    return (
        f"{{inertia: {{m: {mass}, ixx: {1.25 * moment:.9f}, iyy: {1.25 * moment:.9f}, izz: {2.0 * moment:.9f}}},\n"
        "  state_source: 1, state: {pose: {position: {z: 0.25}}}, contact_source: 1, problem: 2,\n"
        "  contacts: {positions: [0.5, 0.5, 0.0, -0.5, -0.5, 0.0], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],\n"
        "  frictions: [0.5, 0.5], restitutions: [0.0, 0.0]}}"
    )


CASE: Final = Case(
    title="The load on one of four feet",
    story="Rigid-body mechanics does not determine how four feet share a weight, and the answer reports this "
    "(`forces_unique`). An engine returns one distribution, which depends on its contact softness and changes if "
    "one foot is slightly shorter. MuJoCo's number is that change.",
    threads=(
        "https://github.com/schteppe/cannon.js/issues/274",
        "https://github.com/google-deepmind/mujoco/issues/2630",
    ),
    setting="mass, kg",
    settings=(8.0,),
    quantity="width of the range of possible loads on one foot, N",
    formula="m g / 2, since two opposite feet can carry the whole weight",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-10,
    why_tolerance="rounding of the weight, N",
    request=Request(
        service="predict_contact_mode",
        text=request,
        answer="modes[0].contact_forces[2]",
        exact=exact,
        tolerance=1e-10,
    ),
)
