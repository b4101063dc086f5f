# SPDX-License-Identifier: Apache-2.0
"""Measured motion whose events are known: exact flights, slides and rests, with noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.evaluation.asking import Informed
from contact_dynamics.evaluation.recording import Recording
from contact_dynamics.measured.motion import MeasuredMotion, StateColumns, motions_of
from contact_dynamics.questions import Defaults
from contact_dynamics.shapes import sphere
from oracles.bouncing_toss import MOMENTS, RATE, Leg, toss
from oracles.rigid_flight import fly

GRAVITY = 9.81
RADIUS = 0.08
P_NOISE = 2e-4
Q_NOISE = 1.75e-3
BALL = Body(
    name="ball", mass_properties=MassProperties(mass=0.4, I_B=np.diag(MOMENTS)), shape=sphere(radius=RADIUS)
)
BRICK = Body.box((0.15, 0.09, 0.05), mass=0.4, name="brick")


class Bounces(NamedTuple):
    """A ball that bounces and then lies still."""

    recording: Recording
    strikes: list[float]  # s
    velocities_after: list[np.ndarray]  # (6,), m/s and rad/s
    rest: float  # s


def world_of(body: Body, height: float = 0.0) -> World:
    """A level floor at a height, m."""
    floor = Surface(
        name="floor", p_WS_W=[0.0, 0.0, height], normal_W=[0.0, 0.0, 1.0], friction=0.3, restitution=0.6
    )
    return World(bodies=(body,), surfaces=(floor,), gravity_W=[0.0, 0.0, -GRAVITY])


def recording_of(
    body: Body,
    world: World,
    times: np.ndarray,
    p: np.ndarray,
    q: np.ndarray,
    *,
    delay: float = 0.0,
    noise: tuple[float, float] | None = (P_NOISE, Q_NOISE),
) -> Recording:
    """Poses as a recording; velocities, which only baselines read, are zero."""
    zero = np.zeros(3)
    states = [
        BodyState(p_WB_W=row, q_WB=turn, v_WB_W=zero, w_WB_W=zero, stamp_ns=round(1e9 * time))
        for time, row, turn in zip(times.tolist(), p, q, strict=True)
    ]
    arrivals = [state.stamp_ns + round(1e9 * delay) for state in states]
    return Recording(
        motions=tuple(motions_of(body, world, StateColumns(states, arrivals), noise=noise)),
        informed=Informed(
            world=world,
            defaults=Defaults(velocity_tolerance=0.1, distance_tolerance=0.003, out_of_plane_tolerance=0.1),
            state_timeout=0.5,
        ),
    )


def bounces(*, seed: int = 0, at_rest: float = 0.3, delay: float = 0.0, noise: float = 1.0) -> Bounces:
    """A spinning ball that falls, strikes a floor three times and stops where it touches it again."""
    rises = (1.6, 1.2, 0.8)  # m/s, upwards after each strike
    spins = ((-9.0, 8.0, 2.0), (3.0, -5.0, 6.0), (4.0, 2.0, -3.0))
    legs = [Leg(0.3, (0.7, -0.3, -0.5), (5.0, 3.0, -4.0))]
    legs += [Leg(2.0 * up / GRAVITY, (0.5, -0.2, up), w) for up, w in zip(rises, spins, strict=True)]
    known = toss(legs, at_rest=at_rest, p_noise=noise * P_NOISE, q_noise=noise * Q_NOISE, seed=seed)
    height = known.rest[1][2] - RADIUS
    recording = recording_of(BALL, world_of(BALL, height), known.times, known.p, known.q, delay=delay)
    return Bounces(
        recording=recording,
        strikes=[*(time for time, _, _ in known.strikes), known.rest[0]],
        velocities_after=[np.concatenate([after.v, after.w]) for _, _, after in known.strikes],
        rest=known.rest[0],
    )


class Slide(NamedTuple):
    """A brick that lands flat, slides and stops."""

    recording: Recording
    landing: float  # s
    stop: float  # s


def slide(*, friction: float = 0.5, speed: float = 1.5, seed: int = 0, at_rest: float = 0.3) -> Slide:
    """A brick that falls flat without spin, and slides under Coulomb's friction until it stops."""
    fall, half = 0.25, 0.025
    level = np.array([0.0, 0.0, 0.0, 1.0])
    start = np.array([0.0, 0.0, half + 0.5 * GRAVITY * fall * fall])
    lasts = speed / (friction * GRAVITY)
    times = np.arange(int((fall + lasts + at_rest) * RATE) + 1) / RATE
    flight = times[times < fall]
    motion = fly([*flight, fall], start, level, (speed, 0.0, 0.0), (0.0, 0.0, 0.0), moments=MOMENTS)
    since = np.minimum(times[times >= fall] - fall, lasts)
    along = speed * fall + speed * since - 0.5 * friction * GRAVITY * since * since
    ground = np.column_stack([along, np.zeros_like(along), np.full_like(along, half)])
    random = np.random.default_rng(seed)
    p = np.concatenate([motion.p[:-1], ground])
    p = p + P_NOISE * random.standard_normal(p.shape)
    q = np.tile(level, (len(p), 1)) + 0.5 * Q_NOISE * np.column_stack(
        [random.standard_normal((len(p), 3)), np.zeros(len(p))]
    )
    q = q / np.linalg.norm(q, axis=1)[:, None]
    recording = recording_of(BRICK, world_of(BRICK), times, p, q)
    return Slide(recording=recording, landing=fall, stop=fall + lasts)


def only_motion(recording: Recording) -> MeasuredMotion:
    """The motion of a recording that has one."""
    (motion,) = recording.motions
    return motion
