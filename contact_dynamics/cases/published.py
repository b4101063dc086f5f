# SPDX-License-Identifier: Apache-2.0
"""Published numbers, read from their data files, and the package's answers to them.

Inputs are in SI units, angles in degrees. Each function is a few calls of the package, without formulas of
its own for what it answers.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any, Final

import numpy as np

from contact_dynamics.contact import Contact
from contact_dynamics.contact_modes import PlanarContactProblem, PlanarMode, contact_modes
from contact_dynamics.impact import planar_impact, spatial_pair_impact
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.questions import TumblingQuestion, UntilPlane, ask
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body import BodyState, MassProperties, inertia
from contact_dynamics.tumbling import free_motion, poinsot
from contact_dynamics.world import Body


class PublishedVerdict(NamedInt):
    """What comes of comparing a published number with the package's."""

    RIGHT = 0
    """They agree within the tolerance."""
    EXPLAINED = 1
    """They differ, and the data file says why the published number is off."""
    WRONG = 2
    """They differ without explanation."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PublishedValue(Record):
    """One published number."""

    source: str  # the title of the source
    where: str  # where the number stands in the source, or its derivation
    what: str  # what the number is, with its unit
    ask: str  # the function of `QUANTITIES` that answers it
    of: str  # which of that function's answers
    inputs: Mapping[str, Any]  # the function's arguments
    expected: float  # the published number
    tolerance: float  # largest difference that counts as agreement, in its unit
    explained: str = ""  # why the published number is off, or empty

    def ours(self) -> float:
        """Return the package's answer."""
        return float(QUANTITIES[self.ask](**self.inputs)[self.of])

    def verdict(self, ours: float) -> PublishedVerdict:
        """Return what comes of comparing the published number with an answer."""
        if abs(ours - self.expected) <= self.tolerance:
            return PublishedVerdict.RIGHT
        return PublishedVerdict.EXPLAINED if self.explained else PublishedVerdict.WRONG


def published_values() -> tuple[PublishedValue, ...]:
    """Return all published numbers, file by file."""
    folder = resources.files("contact_dynamics.cases.published_values")
    names = sorted(file.name for file in folder.iterdir() if file.name.endswith(".json"))
    contents = [json.loads((folder / name).read_text(encoding="utf-8")) for name in names]
    return tuple(
        PublishedValue(source=one["source"], **fields) for one in contents for fields in one["values"]
    )


_PARTICLE: Final = MassProperties(mass=1.0, I_B=np.eye(3))
_LONG_S: Final = 1000.0


def _flying(seconds: float, g: float, up: float, ahead: float) -> BodyState:
    thrown = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[ahead, 0, up], w_WB_W=[0, 0, 0])
    return free_motion(_PARTICLE, thrown, gravity_W=[0.0, 0.0, -g]).state_at(seconds)


def flight_at_time(*, seconds: float, g: float, up: float, ahead: float = 0.0) -> dict[str, float]:
    """Return what a flight is after a time: height, ahead, climb (upward velocity) and speed."""
    state = _flying(seconds, g, up, ahead)
    speed = float(np.linalg.norm(state.v_WB_W))
    return {"height": state.p_WB_W[2], "ahead": state.p_WB_W[0], "climb": state.v_WB_W[2], "speed": speed}


def flight_at_height(*, height: float, g: float, up: float, ahead: float = 0.0) -> dict[str, float]:
    """Return what a flight is where it comes down to a height: time, ahead, climb and speed."""
    apex = max(0.0, up / g)
    up_W, origin_B = [0, 0, 1], [0, 0, 0]
    landing = UntilPlane(
        plane_point=[0, 0, height], plane_normal=up_W, body_point=origin_B, rate=1.0, duration=_LONG_S
    )
    question = TumblingQuestion(
        body=Body(name="particle", mass_properties=_PARTICLE),
        state=_flying(apex, g, up, ahead),
        gravity_W=np.array([0.0, 0.0, -g]),
        sampling=landing,
    )
    event = ask(question).event
    if event is None:
        return dict.fromkeys(("time", "ahead", "climb", "speed"), math.nan)
    speed = float(np.linalg.norm(event.velocity_W))
    return {
        "time": event.seconds + apex,
        "ahead": event.point_W[0],
        "climb": event.velocity_W[2],
        "speed": speed,
    }


def _only_mode(
    mass: float,
    moment: float,
    contacts: Sequence[PlanarContact],
    force: tuple[float, float],
    speed: float = 0.0,
) -> PlanarMode:
    """Return the mode of a body under a force, N, that slides at a speed along x."""
    problem = PlanarContactProblem(
        body=PlanarBody(mass=mass, inertia=moment),
        velocity=PlanarVelocity(v=(speed, 0.0), w=0.0),
        contacts=contacts,
        wrench=PlanarWrench(f=force),
    )
    (mode,) = contact_modes(problem).modes
    return mode


def block(
    *, mass: float, friction: float, g: float, push: float = 0.0, slope: float = 0.0, speed: float = 0.0
) -> dict[str, float]:
    """Return the acceleration down a slope (or along the push) of a block, and the friction on it."""
    angle, weight = math.radians(slope), mass * g
    feet = [PlanarContact(r=(x, -0.1), normal=(0.0, 1.0), friction=friction) for x in (-1.0, 1.0)]
    force = (push + weight * math.sin(angle), -weight * math.cos(angle))
    mode = _only_mode(mass, mass, feet, force, speed)
    return {"acceleration": mode.acceleration[0], "friction": -sum(f[0] for f in mode.contact_forces)}


def round_body(
    *, slope: float, share: float, friction: float, g: float, radius: float = 1.0, speed: float = 0.0
) -> dict[str, float]:
    """Return what a round body on a slope does, with I = share m r^2, that slides down without turning.

    The answers are acceleration, spin_up (angular acceleration, positive where it rolls down), friction_used
    (the friction force over the normal force) and slips (1 or 0).
    """
    angle = math.radians(slope)
    ground = PlanarContact(r=(0.0, -radius), normal=(0.0, 1.0), friction=friction)
    mode = _only_mode(1.0, share * radius**2, [ground], (g * math.sin(angle), -g * math.cos(angle)), speed)
    (force,) = mode.contact_forces
    return {
        "acceleration": mode.acceleration[0],
        "spin_up": -mode.angular_acceleration,
        "friction_used": -force[0] / force[1],
        "slips": float(mode.mode != "f"),
    }


def ladder(*, weight: float, angle: float, friction: float) -> dict[str, float]:
    """Return the forces on a uniform ladder at a smooth wall that stays: floor, wall and friction."""
    x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    foot = PlanarContact(r=(x, -y), normal=(0.0, 1.0), friction=friction)
    top = PlanarContact(r=(-x, y), normal=(1.0, 0.0), friction=0.0)
    mode = _only_mode(1.0, 1.0 / 3.0, [foot, top], (0.0, -weight))
    (along, up), (_, away) = mode.contact_forces  # each is tangential and normal
    return {"floor": up, "wall": away, "friction": -along}


def beam(*, length: float, mass: float, load: float, at: float, g: float) -> dict[str, float]:
    """Return the forces of the left and right support of a beam with a load at a distance from the left."""
    total = mass + load
    middle = (0.5 * mass * length + load * at) / total
    ends = [PlanarContact(r=(x - middle, 0.0), normal=(0.0, 1.0), friction=0.0) for x in (0.0, length)]
    left, right = _only_mode(total, total, ends, (0.0, -total * g)).contact_forces
    return {"left": left[1], "right": right[1]}


def strike(*, masses: Sequence[float], speeds: Sequence[float], restitution: float) -> dict[str, float]:
    """Return the velocities of two balls after a central impact, and the share of energy passed on."""
    bodies = [inertia.sphere(radius=0.5, mass=mass).mass_properties for mass in masses]
    states = [
        BodyState(p_WB_W=[x, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[v, 0, 0], w_WB_W=[0, 0, 0])
        for x, v in zip((0.0, 1.0), speeds, strict=True)
    ]
    touch = Contact(p_WC_W=[0.5, 0, 0], normal_W=[-1, 0, 0], friction=0.0, restitution=restitution)
    answer = spatial_pair_impact(bodies[0], states[0], bodies[1], states[1], touch)
    second = states[1] if answer.other_state is None else answer.other_state
    first, other = float(answer.state.v_WB_W[0]), float(second.v_WB_W[0])
    passed = masses[1] * other**2 / (masses[0] * speeds[0] ** 2) if speeds[0] else math.nan
    return {"first": first, "second": other, "energy_share": passed}


def rod_drop(*, angle: float, friction: float, restitution: float) -> dict[str, float]:
    """Return the velocity (up, turn) of a rod of half length 1 and mass 3 after an end strikes at 1 m/s."""
    x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    rod, falling = PlanarBody(mass=3.0, inertia=1.0), PlanarVelocity(v=(0.0, -1.0), w=0.0)
    tip = PlanarContact(r=(-x, -y), normal=(0.0, 1.0), friction=friction, restitution=restitution)
    after = planar_impact(rod, falling, tip).velocity
    return {"up": after.v[1], "turn": -after.w}


def moment(
    *,
    parts: Sequence[Mapping[str, Any]] = (),
    particles: Sequence[Sequence[float]] = (),
    axis: Sequence[float],
    through: Sequence[float] | None = None,
    revolutions: float = 0.0,
) -> dict[str, float]:
    """Return the moment of inertia of parts and particles about an axis, and the energy of turning about it.

    Each part has a shape (a function of `inertia`), that function's arguments, and where it is (at). Each
    particle is mass, x, y, z. The axis goes through a point, or through the centre of mass.
    """
    bodies = []
    for part in parts:
        size = {name: value for name, value in part.items() if name not in {"shape", "at"}}
        bodies.append(getattr(inertia, part["shape"])(**size).placed(p_GF_G=part.get("at", (0.0, 0.0, 0.0))))
    if particles:
        bodies.append(inertia.particles([one[0] for one in particles], [list(one[1:]) for one in particles]))
    whole = inertia.combined(bodies) if len(bodies) > 1 else bodies[0]
    about = whole.angular_inertia_about(axis, p_FQ_F=through)
    return {"inertia": about, "energy": 0.5 * about * (2.0 * math.pi * revolutions) ** 2}


def symmetric_top(*, axial: float, transverse: float, spin: float, wobble: float) -> dict[str, float]:
    """Return the rate, rad/s, at which the spin of a free symmetric top circles in the body and in space.

    ``spin`` is about the axis of symmetry and ``wobble`` at right angles to it, rad/s.
    """
    body = MassProperties(mass=1.0, I_B=np.diag([transverse, transverse, axial]))
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[wobble, 0.0, spin])
    picture = poinsot(free_motion(body, state))
    in_space = picture.precession_per_period / picture.polhode_period
    return {"in_body": 2.0 * math.pi / picture.polhode_period, "in_space": in_space}


QUANTITIES: Final[Mapping[str, Callable[..., dict[str, float]]]] = {  # the functions that data files name
    "flight_at_time": flight_at_time,
    "flight_at_height": flight_at_height,
    "block": block,
    "round_body": round_body,
    "ladder": ladder,
    "beam": beam,
    "strike": strike,
    "rod_drop": rod_drop,
    "moment": moment,
    "symmetric_top": symmetric_top,
}
