"""A body that turns over again and again (the tennis racket): after which time does it repeat?"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from contact_dynamics.cases.case import Case, Request
from contact_dynamics.cases.peer import Simulation
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.tumbling import free_motion, poinsot

MOMENTS: Final = (1.0e-3, 2.0e-3, 2.8e-3)  # kg m^2
SPIN: Final = 10.0  # rad/s, about the middle axis


def exact(wobble: float) -> float:
    """Return the period 4 K(m) / rate of the angular velocity in the body, s, by Jacobi's functions.

    With moments A < B < C and the spin (w1, w2, 0): rate^2 = (B - A) (2 T C - L^2) / (A B C), and the
    complement of the parameter is 1 - m = (C - A) (2 T B - L^2) / ((B - A) (2 T C - L^2)). K is found by the
    arithmetic-geometric mean. Both differences are written out, so that they do not cancel.
    """
    a, b, c = MOMENTS
    from_major = a * (c - a) * wobble**2 + b * (c - b) * SPIN**2  # 2 T C - L^2
    from_middle = a * (b - a) * wobble**2  # 2 T B - L^2
    rate = math.sqrt(from_major * (b - a) / (a * b * c))
    x, y = 1.0, math.sqrt((c - a) * from_middle / ((b - a) * from_major))
    for _ in range(12):  # it converges quadratically
        x, y = 0.5 * (x + y), math.sqrt(x * y)
    return 2.0 * math.pi / x / rate


def ours(wobble: float) -> float:
    """Return that period, s."""
    body = MassProperties(mass=1.0, I_B=np.diag([1.0e-3, 2.0e-3, 2.8e-3]))
    spin = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[wobble, 10.0, 0.0])
    return poinsot(free_motion(body, spin)).polhode_period


def mujoco(wobble: float) -> float:
    """Return the mean time between every other flip in 60 s, s, with MuJoCo's default integrator."""
    simulation = Simulation(
        '<body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="0.0028 0.002 0.001" '
        'quat="0.70710678118654752 0 0.70710678118654752 0"/></body>',
        gravity="0 0 0",
    )
    simulation.data.qvel[3:6] = [wobble, SPIN, 0.0]
    flips, before = [], SPIN
    for i in range(30_000):
        simulation.run(0.002)
        now = float(simulation.data.qvel[4])
        if before * now < 0.0:
            flips.append(0.002 * (i + before / (before - now)))
        before = now
    return 2.0 * (flips[-1] - flips[0]) / (len(flips) - 1) if len(flips) > 1 else math.inf


def request(wobble: float) -> str:
    """Return the request for one sample; Poinsot's constants come with every answer."""
    return (
        "{state_source: 1, inertia: {m: 1.0, ixx: 0.001, iyy: 0.002, izz: 0.0028}, gravity: 1,\n"
        f"  state: {{angular_velocity: {{x: {wobble:.9f}, y: 10.0}}}}, times: [1.0]}}"
    )


CASE: Final = Case(
    title="The flip period of a tennis racket",
    story="A body that spins about its middle axis flips periodically. Engines without the gyroscopic term "
    "never flip it, and others drift away from the period.",
    threads=(
        "https://github.com/google/brax/issues/156",
        "https://github.com/bepu/bepuphysics2/issues/79",
        "https://github.com/bulletphysics/bullet3/pull/346",
    ),
    setting="spin about the minor axis, rad/s",
    settings=(0.1, 1e-6),
    quantity="period of the angular velocity in the body, s",
    formula="4 K(m) / rate, from Jacobi's solution of Euler's equations",
    exact=exact,
    ours=ours,
    mujoco=mujoco,
    tolerance=1e-12,
    why_tolerance="rounding of the distance from the middle axis, on whose logarithm the period depends",
    request=Request(
        service="predict_tumbling",
        text=request,
        answer="poinsot.polhode_period",
        exact=exact,
        tolerance=1e-12,
    ),
)
