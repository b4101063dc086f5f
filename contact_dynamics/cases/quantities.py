"""What published numbers are about, as the package answers it. A value's data file names the function and its inputs.

Inputs are in SI units, angles in degrees. Each function is a few calls of the package, without formulas of
its own for what it asks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from contact_dynamics.contact import Contact
from contact_dynamics.contact_modes import PlanarContactProblem, PlanarMode, contact_modes
from contact_dynamics.impact import planar_impact, spatial_pair_impact
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.questions import TumblingQuestion, UntilPlane, ask
from contact_dynamics.rigid_body import BodyState, MassProperties, inertia
from contact_dynamics.rigid_body.inertia import MassDistribution
from contact_dynamics.tumbling import free_motion, poinsot
from contact_dynamics.world import Body

_PARTICLE: Final = MassProperties(mass=1.0, I_B=np.eye(3))
_LONG_S: Final = 1000.0


def _thrown(up: float, ahead: float) -> BodyState:
    return BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[ahead, 0, up], w_WB_W=[0, 0, 0])


def flight_at_time(of: str, *, seconds: float, g: float, up: float, ahead: float = 0.0) -> float:
    """Return what is asked ``of`` a flight after a time: height, ahead, climb (upward velocity) or speed."""
    state = free_motion(_PARTICLE, _thrown(up, ahead), gravity_W=[0.0, 0.0, -g]).state_at(seconds)
    answers = {
        "height": state.p_WB_W[2],
        "ahead": state.p_WB_W[0],
        "climb": state.v_WB_W[2],
        "speed": np.linalg.norm(state.v_WB_W),
    }
    return float(answers[of])


def flight_at_height(of: str, *, height: float, g: float, up: float, ahead: float = 0.0) -> float:
    """Return what is asked ``of`` a flight where it comes down to a height: time, ahead, climb or speed."""
    start = free_motion(_PARTICLE, _thrown(up, ahead), gravity_W=[0.0, 0.0, -g]).state_at(max(0.0, up / g))
    question = TumblingQuestion(
        body=Body(name="particle", mass_properties=_PARTICLE),
        state=start,
        gravity_W=np.array([0.0, 0.0, -g]),
        sampling=UntilPlane(
            plane_point=[0, 0, height],
            plane_normal=[0, 0, 1],
            body_point=[0, 0, 0],
            rate=1.0,
            duration=_LONG_S,
        ),
    )
    event = ask(question).event
    if event is None:
        return math.nan
    answers = {
        "time": event.seconds + max(0.0, up / g),
        "ahead": event.point_W[0],
        "climb": event.velocity_W[2],
        "speed": np.linalg.norm(event.velocity_W),
    }
    return float(answers[of])


def _only_mode(problem: PlanarContactProblem) -> PlanarMode:
    (mode,) = contact_modes(problem).modes
    return mode


def block(
    of: str,
    *,
    mass: float,
    friction: float,
    g: float,
    push: float = 0.0,
    slope: float = 0.0,
    speed: float = 0.0,
) -> float:
    """Return the acceleration down a slope (or along the push) of a block, or the friction on it."""
    angle, weight = math.radians(slope), mass * g
    feet = [PlanarContact(r=(x, -0.1), normal=(0.0, 1.0), friction=friction) for x in (-1.0, 1.0)]
    mode = _only_mode(
        PlanarContactProblem(
            body=PlanarBody(mass=mass, inertia=mass),
            velocity=PlanarVelocity(v=(speed, 0.0), w=0.0),
            contacts=feet,
            wrench=PlanarWrench(f=(push + weight * math.sin(angle), -weight * math.cos(angle))),
        )
    )
    return {"acceleration": mode.acceleration[0], "friction": -sum(f[0] for f in mode.contact_forces)}[of]


def round_body(
    of: str,
    *,
    slope: float,
    share: float,
    friction: float,
    g: float,
    radius: float = 1.0,
    speed: float = 0.0,
) -> float:
    """Return what is asked of a round body on a slope, with I = share m r^2, that slides down without turning.

    It may be acceleration, spin_up (angular acceleration, positive where it rolls down), friction_used (the
    friction force over the normal force) or slips (1 or 0).
    """
    angle = math.radians(slope)
    mode = _only_mode(
        PlanarContactProblem(
            body=PlanarBody(mass=1.0, inertia=share * radius**2),
            velocity=PlanarVelocity(v=(speed, 0.0), w=0.0),
            contacts=[PlanarContact(r=(0.0, -radius), normal=(0.0, 1.0), friction=friction)],
            wrench=PlanarWrench(f=(g * math.sin(angle), -g * math.cos(angle))),
        )
    )
    (force,) = mode.contact_forces
    answers = {
        "acceleration": mode.acceleration[0],
        "spin_up": -mode.angular_acceleration,
        "friction_used": -force[0] / force[1],
        "slips": float(mode.mode != "f"),
    }
    return answers[of]


def ladder(of: str, *, weight: float, angle: float, friction: float) -> float:
    """Return a force on a uniform ladder at a smooth wall that stays: floor, wall or friction."""
    x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    foot = PlanarContact(r=(x, -y), normal=(0.0, 1.0), friction=friction)
    top = PlanarContact(r=(-x, y), normal=(1.0, 0.0), friction=0.0)
    mode = _only_mode(
        PlanarContactProblem(
            body=PlanarBody(mass=1.0, inertia=1.0 / 3.0),
            contacts=[foot, top],
            wrench=PlanarWrench(f=(0.0, -weight)),
        )
    )
    (along, up), (_, away) = mode.contact_forces  # each is tangential and normal
    return {"floor": up, "wall": away, "friction": -along}[of]


def beam(of: str, *, length: float, mass: float, load: float, at: float, g: float) -> float:
    """Return the force of the left or the right support of a beam with a load at a distance from its left end."""
    total = mass + load
    middle = (0.5 * mass * length + load * at) / total
    ends = [PlanarContact(r=(x - middle, 0.0), normal=(0.0, 1.0), friction=0.0) for x in (0.0, length)]
    mode = _only_mode(
        PlanarContactProblem(
            body=PlanarBody(mass=total, inertia=total),
            contacts=ends,
            wrench=PlanarWrench(f=(0.0, -total * g)),
        )
    )
    return mode.contact_forces[("left", "right").index(of)][1]


def strike(of: str, *, masses: Sequence[float], speeds: Sequence[float], restitution: float) -> float:
    """Return the velocity of the first or the second ball after a straight strike, or the energy share passed on."""
    bodies = [inertia.sphere(radius=0.5, mass=mass).mass_properties for mass in masses]
    states = [
        BodyState(p_WB_W=[x, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[v, 0, 0], w_WB_W=[0, 0, 0])
        for x, v in zip((0.0, 1.0), speeds, strict=True)
    ]
    touch = Contact(p_WC_W=[0.5, 0, 0], normal_W=[-1, 0, 0], friction=0.0, restitution=restitution)
    answer = spatial_pair_impact(bodies[0], states[0], bodies[1], states[1], touch)
    second = states[1] if answer.other_state is None else answer.other_state
    first, other = float(answer.state.v_WB_W[0]), float(second.v_WB_W[0])
    passed = masses[1] * other**2 / (masses[0] * speeds[0] ** 2)
    return {"first": first, "second": other, "energy_share": passed}[of]


def rod_drop(of: str, *, angle: float, friction: float, restitution: float) -> float:
    """Return the velocity after one end of a falling rod of half length 1 and mass 3 strikes at 1 m/s: up or turn."""
    x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    tip = PlanarContact(r=(-x, -y), normal=(0.0, 1.0), friction=friction, restitution=restitution)
    after = planar_impact(
        PlanarBody(mass=3.0, inertia=1.0), PlanarVelocity(v=(0.0, -1.0), w=0.0), tip
    ).velocity
    return {"up": after.v[1], "turn": -after.w}[of]


_SHAPES: Final[Mapping[str, Callable[..., MassDistribution]]] = {
    "box": inertia.box,
    "capsule": inertia.capsule,
    "cone": inertia.cone,
    "cylinder": inertia.cylinder,
    "cylindrical_shell": inertia.cylindrical_shell,
    "disc": inertia.disc,
    "ellipsoid": inertia.ellipsoid,
    "hemisphere": inertia.hemisphere,
    "hollow_sphere": inertia.hollow_sphere,
    "plate": inertia.plate,
    "ring": inertia.ring,
    "rod": inertia.rod,
    "sphere": inertia.sphere,
    "spherical_shell": inertia.spherical_shell,
    "torus": inertia.torus,
    "tube": inertia.tube,
}


def moment(
    of: str,
    *,
    parts: Sequence[Mapping[str, Any]] = (),
    particles: Sequence[Sequence[float]] = (),
    axis: Sequence[float],
    through: Sequence[float] | None = None,
    revolutions: float = 0.0,
) -> float:
    """Return the moment of inertia of parts and particles about an axis, or the energy of turning about it.

    Each part has a shape, what that shape takes, and where it is (at). Each particle is mass, x, y, z. The
    axis goes through a point, or through the centre of mass.
    """
    bodies = []
    for part in parts:
        size = {name: value for name, value in part.items() if name not in {"shape", "at"}}
        bodies.append(_SHAPES[part["shape"]](**size).placed(p_GF_G=part.get("at", (0.0, 0.0, 0.0))))
    if particles:
        bodies.append(inertia.particles([one[0] for one in particles], [list(one[1:]) for one in particles]))
    whole = inertia.combined(bodies) if len(bodies) > 1 else bodies[0]
    about = whole.angular_inertia_about(axis, p_FQ_F=through)
    spin = 2.0 * math.pi * revolutions
    return {"inertia": about, "energy": 0.5 * about * spin**2}[of]


def symmetric_top(of: str, *, axial: float, transverse: float, spin: float, wobble: float) -> float:
    """Return what is asked of a free symmetric top: the rate at which its spin circles in the body, or in space.

    Both are in rad/s. ``spin`` is about the axis of symmetry and ``wobble`` at right angles to it, rad/s.
    """
    body = MassProperties(mass=1.0, I_B=np.diag([transverse, transverse, axial]))
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[wobble, 0.0, spin])
    picture = poinsot(free_motion(body, state))
    in_space = picture.precession_per_period / picture.polhode_period
    return {"in_body": 2.0 * math.pi / picture.polhode_period, "in_space": in_space}[of]


QUANTITIES: Final[Mapping[str, Callable[..., float]]] = {
    function.__name__: function
    for function in (
        flight_at_time,
        flight_at_height,
        block,
        round_body,
        ladder,
        beam,
        strike,
        rod_drop,
        moment,
        symmetric_top,
    )
}
"""The functions that data files name."""
