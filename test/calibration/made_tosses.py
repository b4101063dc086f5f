# SPDX-License-Identifier: Apache-2.0
"""Tosses of a brick whose every parameter is known: a flight, a strike of one corner, and a flight."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact_dynamics.contact.contact import Contact
from contact_dynamics.impact import spatial_impact
from contact_dynamics.measured.motion import MeasuredMotion, StateColumns, motions_of
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.rotations.many import turned
from contact_dynamics.shapes import box
from contact_dynamics.tumbling import free_motion
from contact_dynamics.world import Body, Surface, World

RATE = 240.0
BEFORE = 0.16  # s of flight before the strike
AFTER = 0.12
SIZE = np.array([0.12, 0.10, 0.08])
MASS = 0.4
I_B = (
    MASS
    / 12.0
    * np.diag([SIZE[1] ** 2 + SIZE[2] ** 2, SIZE[0] ** 2 + SIZE[2] ** 2, SIZE[0] ** 2 + SIZE[1] ** 2])
)
BRICK = Body(name="brick", mass_properties=MassProperties(mass=MASS, I_B=I_B), shape=box(size=SIZE))
FLOOR = Surface(name="floor", p_WS_W=[0.0, 0.0, 0.0], normal_W=[0.0, 0.0, 1.0], friction=0.3, restitution=0.4)
WORLD = World(bodies=(BRICK,), surfaces=(FLOOR,), gravity_W=[0.0, 0.0, -9.81])
"""What is configured: nothing of it is exactly true."""


@dataclass(frozen=True, kw_only=True)
class Truth:
    """What the tosses are made with."""

    friction: float = 0.22
    restitution: float = 0.55
    center: tuple[float, float, float] = (0.002, -0.003, 0.004)
    inertia: float = 1.15
    gravity: float = 9.7
    tilt: float = 0.015  # rad, of gravity, in any direction
    p_noise: float = 1e-4
    q_noise: float = 1e-3
    bow: float = 0.0  # 1/m, curvature of the surface
    law_velocity: float = 0.0  # m/s, error of the law
    law_spin: float = 0.0  # rad/s

    @property
    def properties(self) -> MassProperties:
        return MassProperties(mass=MASS, I_B=self.inertia * I_B)


def made_toss(truth: Truth, random: np.random.Generator) -> MeasuredMotion:
    """One toss, as it is measured."""
    center = np.array(truth.center)
    while True:
        q = _unit(random.standard_normal(4))
        R = BodyState(p_WB_W=[0, 0, 0], q_WB=q).R_WB
        heights = np.sort((BRICK.vertices_B @ R.T)[:, 2])
        if heights[1] - heights[0] < 0.02:
            continue
        corner = BRICK.vertices_B[int(np.argmin((BRICK.vertices_B @ R.T)[:, 2]))]
        place = np.array([*random.uniform(-0.3, 0.3, 2), 0.0])
        place[2] = 0.5 * truth.bow * float(place @ place)
        p = place - R @ (corner - center)
        v = np.array([*random.uniform(-1.5, 1.5, 2), random.uniform(-2.5, -1.2)])
        w = random.uniform(-7.0, 7.0, 3)
        before = BodyState(p_WB_W=p, q_WB=q, v_WB_W=v, w_WB_W=w)
        if before.velocity_of_point(place)[2] > -0.5:
            continue
        contact = Contact(
            p_WC_W=place, normal_W=[0, 0, 1], friction=truth.friction, restitution=truth.restitution
        )
        hit = spatial_impact(truth.properties, before, contact)
        after = replace(
            before,
            v_WB_W=hit.state.v_WB_W + truth.law_velocity * random.standard_normal(3),
            w_WB_W=hit.state.w_WB_W + truth.law_spin * random.standard_normal(3),
        )
        motion = _measured(truth, before, after, center, random)
        if motion is not None:
            return motion


def _measured(
    truth: Truth, before: BodyState, after: BodyState, center: np.ndarray, random: np.random.Generator
) -> MeasuredMotion | None:
    """The poses of both flights, or None if another corner strikes within them."""
    tilt = random.uniform(0.0, 2.0 * np.pi)
    down = _unit(np.array([truth.tilt * np.cos(tilt), truth.tilt * np.sin(tilt), -1.0]))
    offset = random.uniform(0.0, 1.0 / RATE)
    times = np.arange(-round(BEFORE * RATE), round(AFTER * RATE)) / RATE + offset
    p, q = np.empty((len(times), 3)), np.empty((len(times), 4))
    for state, which in ((before, times < 0.0), (after, times >= 0.0)):
        flight = free_motion(truth.properties, state, gravity_W=truth.gravity * down).at(times[which])
        p[which], q[which] = flight.p_WB_W, flight.q_WB
    q_shaken = turned(q, truth.q_noise * random.standard_normal((len(q), 3)))
    matrices = np.array([_matrix(row) for row in q])
    places = p - matrices @ center  # of the configured mass centre
    lowest = (places[:, None] + np.einsum("nij,kj->nki", matrices, BRICK.vertices_B))[:, :, 2].min(axis=1)
    if (lowest[np.abs(times) > 2.0 / RATE] < 0.0).any() and truth.bow == 0.0:
        return None
    shaken = places + truth.p_noise * random.standard_normal(p.shape)
    states = [
        BodyState(p_WB_W=shaken[i], q_WB=q_shaken[i], stamp_ns=round(1e9 * (times[i] + 1.0)))
        for i in range(len(times))
    ]
    (motion,) = motions_of(
        BRICK,
        WORLD,
        StateColumns(states, [state.stamp_ns for state in states]),
        noise=(truth.p_noise, truth.q_noise),
    )
    return motion


def made_tosses(truth: Truth, count: int, seed: int) -> list[MeasuredMotion]:
    """Some tosses."""
    random = np.random.default_rng(seed)
    return [made_toss(truth, random) for _ in range(count)]


def true_values(truth: Truth) -> np.ndarray:
    """The values of the free parameters of a body with sharp corners on a floor whose height is known."""
    return np.array([*truth.center, truth.inertia, truth.friction, truth.restitution])


def true_standard(truth: Truth) -> np.ndarray:
    """The values of the standard free parameters: corners are sharp, and the floor is where it should be."""
    *others, friction, restitution = true_values(truth)
    return np.array([*others, 0.0, friction, restitution, 0.0])


def _unit(vector: np.ndarray) -> np.ndarray:
    unit: np.ndarray = vector / np.linalg.norm(vector)
    return unit


def _matrix(q: np.ndarray) -> np.ndarray:
    return BodyState(p_WB_W=[0, 0, 0], q_WB=q).R_WB
