"""Three balls that touch in a row and are struck by the first: how fast does the last one leave?"""

from __future__ import annotations

from typing import Final

import numpy as np

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation, softness
from contact_dynamics.contact import ContactSet
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw, bodies_impact
from contact_dynamics.rigid_body import BodyState, MassProperties


def exact_in_turn(restitution: float) -> float:
    """Return ((1 + e) / 2)^2 m/s: each pair passes on (1 + e) / 2."""
    return (0.5 * (1.0 + restitution)) ** 2


def exact_at_once(restitution: float) -> float:
    """Return (1 + e) / 3 m/s: the balls at rest leave together."""
    return (1.0 + restitution) / 3.0


def in_turn(restitution: float) -> float:
    """Return the speed of the last ball, m/s, where the pairs strike one after the other."""
    return last_ball(restitution, SeveralContactsLaw.SEQUENTIAL)


def at_once(restitution: float) -> float:
    """Return the speed of the last ball, m/s, where all contacts strike at once by Newton's law."""
    return last_ball(restitution, SeveralContactsLaw.SIMULTANEOUS)


def last_ball(restitution: float, law: SeveralContactsLaw) -> float:
    """Return the speed of the last of three equal balls after the first has struck at 1 m/s, m/s."""
    ball = MassProperties(mass=1.0, I_B=4e-4 * np.eye(3))
    row = [
        BodyState(
            p_WB_W=[0.1 * i, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[1.0 if i == 0 else 0.0, 0, 0], w_WB_W=[0, 0, 0]
        )
        for i in range(3)
    ]
    touching = ContactSet(
        p_WC_W=[[0.05, 0, 0], [0.15, 0, 0]], normals_W=[-1, 0, 0], frictions=0.0, restitutions=restitution
    )
    answer = bodies_impact(
        [ball] * 3,
        row,
        touching,
        [(0, 1), (1, 2)],
        several_contacts_law=law,
        restitution_law=RestitutionLaw.NEWTON,
    )
    return float(answer.states[-1].v_WB_W[0])


def mujoco(restitution: float) -> float:
    """Return that speed of MuJoCo's, whose contacts are springs and dampers for that restitution."""
    balls = "".join(
        f'<body pos="{0.1 * i} 0 0"><joint type="slide" axis="1 0 0"/><geom size="0.05" mass="1"/></body>'
        for i in range(3)
    )
    simulation = Simulation(balls, gravity="0 0 0", defaults=f'solref="{softness(restitution)}"')
    simulation.data.qvel[0] = 1.0
    simulation.run(1.0)
    return float(simulation.data.qvel[2])


def request(restitution: float) -> str:
    """Return the request about the first pair. The service answers about two bodies; the row is for Python."""
    return (
        "{inertia: {m: 1.0, ixx: 0.0004, iyy: 0.0004, izz: 0.0004}, state_source: 1, state: {linear_velocity: {x: 1.0}},\n"
        "  other_inertia: {m: 1.0, ixx: 0.0004, iyy: 0.0004, izz: 0.0004}, other_state: [{pose: {position: {x: 0.1}}}],\n"
        "  contact_source: 1, contacts: {positions: [0.05, 0.0, 0.0], normals: [-1.0, 0.0, 0.0], frictions: [0.0],\n"
        f"  restitutions: [{restitution}]}}}}"
    )


REQUEST: Final = Request(
    service="predict_impact",
    text=request,
    answer="impact.other_state_after[0].linear_velocity.x",
    exact=lambda restitution: 0.5 * (1.0 + restitution),
    tolerance=1e-14,
)

IN_TURN: Final = Case(
    title="Newton's cradle, sequential law",
    story="Rigid-body mechanics does not determine the motion of three balls in contact. If the pairs strike "
    "one after another, at e = 1 the last ball takes all the momentum, as steel balls nearly do. The "
    "question names this law.",
    threads=("https://github.com/liabru/matter-js/issues/361", "https://github.com/ekiefl/pooltool/pull/257"),
    setting="e",
    settings=(1.0, 0.8),
    quantity="speed of the last of three balls over that of the first",
    formula="((1 + e) / 2)²",
    exact=exact_in_turn,
    ours=in_turn,
    mujoco=mujoco,
    tolerance=1e-12,
    why_tolerance="rounding over a few strikes",
    request=REQUEST,
)

AT_ONCE: Final = Case(
    title="Newton's cradle, simultaneous law",
    story="If all contacts strike at once and each obeys Newton's law of restitution, the balls at rest leave "
    "together. Neither law is wrong; an engine that returns one number has chosen one.",
    threads=("https://github.com/liabru/matter-js/issues/361",),
    setting="e",
    settings=(1.0, 0.8),
    quantity="speed of the last of three balls over that of the first",
    formula="(1 + e) / 3",
    exact=exact_at_once,
    ours=at_once,
    mujoco=mujoco,
    tolerance=1e-9,
    why_tolerance="the complementarity problem is solved by projections to 1e-9",
    request=REQUEST,
)
