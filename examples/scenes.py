# SPDX-License-Identifier: Apache-2.0
"""Four moving scenes, computed in Python and drawn in rerun.

`scenes.py SCENE [FILE.rrd]` draws a scene into a file, or opens the viewer; without a scene it draws each
into a file of its name. `belt` is a parcel that falls
onto a belt, `paddle` a ball that a paddle juggles, `stack` two boxes on a tray that accelerates, and `grasp`
a box between two fingers that press with a given force.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace

import numpy as np

import contact_dynamics as cd
from contact_dynamics.constants import to_ns
from contact_dynamics.contact_modes import BodiesContactProblem, contact_modes
from contact_dynamics.questions import Context, ImpactQuestion, TossQuestion, ask
from contact_dynamics.viewing import view
from contact_dynamics.viewing.sinks import NowhereToDrawError

G = 9.80665  # m/s^2
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def belt(path: str | None) -> None:
    """Drop a parcel onto a belt, on which it bounces, slides and comes to rest."""
    parcel = cd.Body.box((0.3, 0.2, 0.15), mass=2.0, name="parcel")
    moving = cd.Surface(
        name="belt", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.2, v_WS_W=[1.2, 0, 0]
    )
    world = cd.World(bodies=(parcel,), surfaces=(moving,))
    dropped = cd.BodyState(p_WB_W=[-0.5, 0, 0.4], q_WB=[0, 0.1305, 0, 0.9914], w_WB_W=[0.5, 0, 1.0])
    toss = cd.toss(parcel, dropped, world)
    print(f"the parcel {toss.end.name.lower()} on the belt after {toss.seconds:.2f} s")
    answer = ask(TossQuestion(body="parcel", state=dropped), Context(world=world))
    moves = [toss.state_at(t) for t in np.arange(0.0, toss.seconds + 0.5, 0.01)]
    view(world, [answer], motions={"parcel": moves}, path=path)


def paddle(path: str | None) -> None:
    """Juggle a ball: a paddle that rises at u returns it at the speed v at which it came."""
    ball = cd.Body.sphere(0.02, mass=0.0027, name="ball")
    bat = cd.Body.box((0.16, 0.16, 0.01), mass=0.2, name="paddle")
    world = cd.World(bodies=(ball, bat))
    e, v = 0.8, 2.0
    u = v * (1.0 - e) / (1.0 + e)  # solves e (v + u) + u = v
    period = 2.0 * v / G
    touch = cd.ContactSet(
        p_WC_W=[[0, 0, 0]], normals_W=[0, 0, 1], frictions=0.3, restitutions=e, surface_velocities_W=[0, 0, u]
    )
    state = cd.BodyState(p_WB_W=[0, 0, 0.02], q_WB=UPRIGHT, v_WB_W=[0, 0, v])
    strikes, flights, strokes = [], list[cd.BodyState](), []
    for _ in range(6):
        flight = cd.free_motion(ball, state)
        flights += [flight.state_at(t) for t in np.linspace(0.0, period, 40)[1:]]
        strikes.append(
            ask(ImpactQuestion(body="ball", state=flights[-1], contacts=touch), Context(world=world))
        )
        state = strikes[-1].impact.state
    for each in flights:  # the paddle swings, and rises through height 0 at each strike
        phase = 2.0 * math.pi * (each.stamp_ns * 1e-9) / period
        height = u * period / (2.0 * math.pi) * math.sin(phase)
        strokes.append(cd.BodyState(p_WB_W=[0, 0, height - 0.005], q_WB=UPRIGHT, stamp_ns=each.stamp_ns))
    print(
        f"the paddle rises at {u:.3f} m/s; after {len(strikes)} strikes the ball at {state.v_WB_W[2]:.9g} m/s"
    )
    view(world, strikes, motions={"ball": flights, "paddle": strokes}, path=path)


def stack(path: str | None) -> None:
    """Accelerate a tray under two boxes, of which the upper one slips first."""
    lower, upper = (
        cd.Body.box((0.3, 0.3, 0.1), mass=2.0, name="lower"),
        cd.Body.box((0.2, 0.2, 0.1), mass=1.0, name="upper"),
    )
    feet = [[x, y, z] for s, z in ((0.15, 0.0), (0.1, 0.1)) for x in (-s, s) for y in (-s, s)]
    pairs: list[tuple[int, int | None]] = [(0, None)] * 4 + [(1, 0)] * 4
    problems = {}
    for k, pull in enumerate((2.0, 4.0, 6.0)):  # m/s^2
        states = [cd.BodyState(p_WB_W=[0, 0, z], q_WB=UPRIGHT, stamp_ns=to_ns(k)) for z in (0.05, 0.15)]
        contacts = cd.ContactSet(
            p_WC_W=feet,
            normals_W=[0, 0, 1],
            frictions=[0.5] * 4 + [0.3] * 4,
            surface_accelerations_W=[[pull, 0, 0]] * 4 + [[0, 0, 0]] * 4,
        )
        problems[f"tray at {pull} m/s²"] = BodiesContactProblem(
            bodies=[lower, upper],
            states=states,
            contacts=contacts,
            pairs=pairs,
            forces_W=[[0, 0, -2.0 * G], [0, 0, -G]],
        )
    _view_modes([lower, upper], problems, path)


def grasp(path: str | None) -> None:
    """Hold a box between two fingers. One that presses with a given force is a very heavy body with it."""
    held = cd.Body.box((0.06, 0.06, 0.12), mass=0.5, name="box")
    left, right = (cd.Body.box((0.02, 0.03, 0.03), mass=1e6, name=name) for name in ("left", "right"))
    points = [[x, y, z] for x in (-0.03, 0.03) for y in (-0.015, 0.015) for z in (-0.015, 0.015)]
    contacts = cd.ContactSet(p_WC_W=points, normals_W=[[1, 0, 0]] * 4 + [[-1, 0, 0]] * 4, frictions=0.5)
    problems = {}
    for k, grip in enumerate((8.0, 6.0, 4.0)):  # N; the least that holds is the weight / (2 mu), 4.9 N
        states = [cd.BodyState(p_WB_W=[x, 0, 0], q_WB=UPRIGHT, stamp_ns=to_ns(k)) for x in (0.0, -0.04, 0.04)]
        problems[f"grip of {grip} N"] = BodiesContactProblem(
            bodies=[held, left, right],
            states=states,
            contacts=contacts,
            pairs=[(0, 1)] * 4 + [(0, 2)] * 4,
            forces_W=[[0, 0, -0.5 * G], [grip, 0, 0], [-grip, 0, 0]],
        )
    _view_modes([held, left, right], problems, path)


def _view_modes(bodies: list[cd.Body], problems: dict[str, BodiesContactProblem], path: str | None) -> None:
    """Draw the contact modes of problems, and for half a second after each the motion of its first mode."""
    motions: dict[str, list[cd.BodyState]] = {body.name: [] for body in bodies}
    answers = [contact_modes(problem) for problem in problems.values()]
    for answer, (name, problem) in zip(answers, problems.items(), strict=True):
        print(f"{name}: {answer.modes[0].mode}")
        for begin, a_W, motion in zip(
            problem.states, answer.modes[0].accelerations_W, motions.values(), strict=True
        ):
            motion += [
                replace(
                    begin,
                    p_WB_W=begin.p_WB_W + 0.5 * a_W * t * t,
                    v_WB_W=a_W * t,
                    stamp_ns=begin.stamp_ns + to_ns(t),
                )
                for t in np.linspace(0.0, 0.5, 20).tolist()
            ]
    view(cd.World(bodies=tuple(bodies)), answers, motions=motions, path=path)


SCENES = {scene.__name__: scene for scene in (belt, paddle, stack, grasp)}

if __name__ == "__main__":
    if len(sys.argv) > 3 or (len(sys.argv) > 1 and sys.argv[1] not in SCENES):
        raise SystemExit(f"usage: scenes.py [{'|'.join(SCENES)} [FILE.rrd]]")
    if len(sys.argv) == 1:
        for name, scene in SCENES.items():
            scene(f"{name}.rrd")
    else:
        try:
            SCENES[sys.argv[1]](sys.argv[2] if len(sys.argv) == 3 else None)
        except NowhereToDrawError as error:
            raise SystemExit(f"{error}: `scenes.py {sys.argv[1]} FILE.rrd` writes a file") from None
