# SPDX-License-Identifier: Apache-2.0
"""MuJoCo's answers to the cases, measured in simulations with its default settings and time step.

Where a function departs from the defaults, it says so. The numbers hold for the version that is installed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W

if TYPE_CHECKING:
    from typing_extensions import Self

CONTACT_S: Final = 0.02  # how long a bounce on a spring and damper lasts, s

_FLOOR: Final = '<geom type="plane" size="9 9 1"/>'
_SLIDES: Final = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
_MOMENTS: Final = (1.0e-3, 2.0e-3, 2.8e-3)  # kg m^2, of the racket
_RACKET: Final = (
    '<body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="0.0028 0.002 0.001" '
    'quat="0.70710678118654752 0 0.70710678118654752 0"/></body>'
)


def softness(restitution: float) -> str:
    """Return the `solref` of a spring and damper that gives back this share of the speed, in (0, 1].

    A linear oscillator with damping ratio z loses the factor exp(-pi z / sqrt(1 - z^2)) in half a swing. Half
    a swing lasts `CONTACT_S`, which is ten default time steps, so that MuJoCo can resolve it.
    """
    loss = -math.log(restitution)
    ratio = loss / math.hypot(math.pi, loss)
    frequency = math.hypot(math.pi, loss) / CONTACT_S
    return f'solref="{-frequency * frequency} {-2.0 * ratio * frequency}"'


class Simulation:
    """A model with its state."""

    def __init__(self, world: str, geoms: str = "", *, options: str = "", slope: float | None = 0.0) -> None:
        """Compile a model of a `worldbody`, with attributes of every `geom` and of its `option`.

        Standard gravity is tilted towards x by ``slope``, rad, and there is none if it is None.
        """
        g, angle = (0.0, 0.0) if slope is None else (-STANDARD_GRAVITY_W[2], slope)
        gravity = f"{g * math.sin(angle)} 0 {-g * math.cos(angle)}"
        self._mujoco: Any = import_module("mujoco")
        self.model: Any = self._mujoco.MjModel.from_xml_string(
            f'<mujoco><option gravity="{gravity}" {options}/><default><geom {geoms}/></default>'
            f"<worldbody>{world}</worldbody></mujoco>"
        )
        self.data: Any = self._mujoco.MjData(self.model)

    def moving(self, velocities: Mapping[int, float]) -> Self:
        """Set generalized velocities by index; 0 to 5 are linear and angular of a free body."""
        for i, velocity in velocities.items():
            self.data.qvel[i] = velocity
        return self

    def pushed(self, *wrench: float) -> Self:
        """Apply a force, N, and a torque, N m, (6,), world axes, to the first body from now on."""
        self.data.xfrc_applied[1] = wrench
        return self

    def run(self, seconds: float) -> Self:
        """Simulate a duration, s, to the nearest step."""
        self._mujoco.mj_step(self.model, self.data, nstep=round(seconds / float(self.model.opt.timestep)))
        return self

    def position(self, i: int) -> float:
        """Return a generalized position."""
        return float(self.data.qpos[i])

    def velocity(self, i: int) -> float:
        """Return a generalized velocity."""
        return float(self.data.qvel[i])

    def loads(self) -> list[float]:
        """Return the normal force at each contact, N."""
        force, found = np.zeros(6), []
        for i in range(int(self.data.ncon)):
            self._mujoco.mj_contactForce(self.model, self.data, i, force)
            found.append(float(force[0]))
        return found


def _body(height: float, geom: str) -> str:
    """Return a free body of one geom, m above the origin."""
    return f'<body pos="0 0 {height}"><freejoint/><geom {geom}/></body>'


def _ball(height: float, *, mass: float = 1.0) -> str:
    """Return a free ball of radius 0.1 m, m above the origin."""
    return _body(height, f'size="0.1" mass="{mass}"')


def _friction(friction: float) -> str:
    """Return the attribute for sliding friction, without rolling and torsional friction."""
    return f'friction="{friction} 0 0"'


def creeping_capsule(margin: float) -> float:
    """Return how far it creeps in 10 s, with the elliptic cone and the impedance that MuJoCo advises."""
    capsule = Simulation(
        _FLOOR + _body(0.004, 'type="capsule" size="0.004" fromto="-0.02 0 0 0.02 0 0" mass="0.045"'),
        _friction(0.7),
        options='cone="elliptic" impratio="10"',
        slope=math.atan(0.7 / margin),
    )
    start = capsule.run(1.0).position(0)  # it settles
    return capsule.run(10.0).position(0) - start


def friction_angle(beyond: float) -> float:
    """Return the mean acceleration over 1 s of a block that lay there for 1 s, m/s^2."""
    block = _body(0.02, 'type="box" size="0.05 0.05 0.02" mass="1"')
    simulation = Simulation(_FLOOR + block, _friction(0.5), slope=math.atan(0.5) + beyond)
    before = simulation.run(1.0).velocity(0)
    return simulation.run(1.0).velocity(0) - before


def pressed_book(friction: float) -> float:
    """Return the mean downward acceleration over 1 s, m/s^2."""
    wall = '<geom type="plane" size="9 9 1" euler="0 90 0" pos="-0.01 0 0"/>'
    book = _body(0.0, 'type="box" size="0.01 0.1 0.1" mass="1"')
    return -Simulation(wall + book, _friction(friction)).pushed(-20.0, 0, 0, 0, 0, 0).run(1.0).velocity(2)


def turning_bar(arm: float) -> float:
    """Return the mean angular acceleration over 20 ms, rad/s^2, of a bar that cannot leave its plane."""
    bar = Simulation(
        f'<geom type="plane" size="5 5 1" euler="-90 0 0"/><body pos="{arm} 0.005 0">{_SLIDES}'
        '<joint type="slide" axis="0 1 0"/><joint type="hinge" axis="0 1 0"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>'
        f'<geom size="0.005" pos="{-arm} 0 0"/></body>',
        'friction="1 0.005 0.0001" condim="4"',
    )
    return bar.pushed(0, -50.0, 0, 0, 0, 0).run(0.02).velocity(3) / 0.02


def ladder(beyond: float) -> float:
    """Return the mean angular acceleration over 0.1 s, rad/s^2, of a ladder with small balls as ends."""
    angle, ball = math.atan(1.0) - beyond, 0.001
    x, y = math.cos(angle), math.sin(angle)
    simulation = Simulation(
        f'<geom type="plane" size="9 9 1" priority="1" {_friction(0.5)}/>'
        f'<geom type="plane" size="9 9 1" priority="1" {_friction(0)} pos="{-x - ball} 0 0" euler="0 90 0"/>'
        f'<body pos="0 0 {y + ball}"><freejoint/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.333333333 0.333333333 0.333333333"/>'
        f'<geom size="{ball}" pos="{x} 0 {-y}"/><geom size="{ball}" pos="{-x} 0 {y}"/></body>'
    )
    return -simulation.run(0.1).velocity(4) / 0.1


def jamming_drawer(friction: float) -> float:
    """Return the mean acceleration over 0.1 s, m/s^2, of a body with two small balls between walls."""
    drawer = Simulation(
        '<geom type="plane" size="9 9 1" pos="-0.05 0 0" euler="0 90 0"/>'
        '<geom type="plane" size="9 9 1" pos="0.05 0 0" euler="0 -90 0"/>'
        f'<body>{_SLIDES}<joint type="hinge" axis="0 1 0"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>'
        '<geom size="0.001" pos="-0.049 0 0.1"/><geom size="0.001" pos="0.049 0 -0.1"/></body>',
        _friction(friction),
        slope=None,
    )
    return drawer.pushed(0, 0, 10.0, 0, -1.0, 0).run(0.1).velocity(1) / 0.1


def four_feet(mass: float) -> float:
    """Return how far the load of a foot moves if that foot is 0.1 mm shorter, N. One run gives one load."""
    loads = []
    for shorter in (0.0, 1e-4):
        feet = "".join(
            f'<geom size="0.01" pos="{x} {y} {-0.24 + (shorter if x == y == 0.5 else 0.0)}"/>'
            for x in (-0.5, 0.5)
            for y in (-0.5, 0.5)
        )
        moments = f"{mass / 9.6} {mass / 9.6} {mass / 6.0}"
        inertial = f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{moments}"/>'
        table = Simulation(f'{_FLOOR}<body pos="0 0 0.25"><freejoint/>{inertial}{feet}</body>').run(5.0)
        loads.append(table.loads()[-1] if table.data.ncon == 4 else 0.0)
    return abs(loads[0] - loads[1])


def tipping_cube(friction: float) -> float:
    """Return the mean angular acceleration over the first 20 ms, rad/s^2, of a cube that lay still before."""
    cube = _body(0.05, 'type="box" size="0.05 0.05 0.05" mass="1"')
    settled = Simulation(_FLOOR + cube, _friction(friction)).run(1.0)
    return -settled.moving({0: 6.0}).run(0.02).velocity(4) / 0.02


def oblique_sliding(degrees: float) -> float:
    """Return the mean acceleration across over 0.2 s, m/s^2, with MuJoCo's default cone, a pyramid."""
    box = _body(0.01, 'type="box" size="0.1 0.1 0.01" mass="1"')
    settled = Simulation(_FLOOR + box, _friction(0.5)).run(1.0)
    x, y = 2.0 * math.cos(math.radians(degrees)), 2.0 * math.sin(math.radians(degrees))
    return (settled.moving({0: x, 1: y}).run(0.2).velocity(1) - y) / 0.2


def bowling_ball(speed: float) -> float:
    """Return the speed after 10 s, m/s. Neither rolling nor torsional friction acts."""
    return Simulation(_FLOOR + _ball(0.1, mass=7.0), _friction(0.2)).moving({0: speed}).run(10.0).velocity(0)


def rolling_down(degrees: float) -> float:
    """Return the mean acceleration over 1 s, m/s^2."""
    return Simulation(_FLOOR + _ball(0.1), _friction(0.2), slope=math.radians(degrees)).run(1.0).velocity(0)


def bounce(restitution: float) -> float:
    """Return the ratio of speeds with a contact that is a spring and damper for that restitution."""
    ball = Simulation(_FLOOR + _ball(0.11), softness(restitution), slope=None)
    return ball.moving({2: -3.0}).run(0.5).velocity(2) / 3.0


def hundred_bounces(bounces: float) -> float:
    """Return the height, m, with a contact that is a spring without a damper."""
    ball = Simulation(_FLOOR + _ball(1.1), softness(1.0))
    seen, rising, height = 0, False, 0.0
    for _ in range(100 * int(bounces) * 10):
        ball.run(0.002)
        speed, above = ball.velocity(2), ball.position(2) - 0.1
        if speed > 0.0 and not rising and above < 0.01:
            seen += 1
        rising = speed > 0.0
        height = max(height, above) if seen == bounces else height
        if seen > bounces:
            break
    return height


def spinning_bounce(spin: float) -> float:
    """Return the velocity with a contact that is a spring and damper for e = 0.8, m/s."""
    ball = Simulation(_FLOOR + _ball(0.11), f"{_friction(0.8)} {softness(0.8)}", slope=None)
    return ball.moving({0: 2.0, 2: -4.0, 4: spin}).run(0.5).velocity(0)


def _row(masses: tuple[float, ...], *, radius: float, distance: float, restitution: float) -> Simulation:
    """Return balls in a row, of which the first moves at 1 m/s."""
    balls = "".join(
        f'<body pos="{distance * i} 0 0"><joint type="slide" axis="1 0 0"/>'
        f'<geom size="{radius}" mass="{mass}"/></body>'
        for i, mass in enumerate(masses)
    )
    return Simulation(balls, softness(restitution), slope=None).moving({0: 1.0})


def two_balls(mass: float) -> float:
    """Return the speed with a contact that is a spring without a damper, m/s."""
    return _row((mass, 10.0), radius=0.5, distance=1.1, restitution=1.0).run(2.0).velocity(1)


def cradle_in_turn(restitution: float) -> float:
    """Return the speed with contacts that are springs and dampers for that restitution, m/s."""
    return _row((1, 1, 1), radius=0.05, distance=0.1, restitution=restitution).run(1.0).velocity(2)


cradle_at_once = cradle_in_turn


def painleve_rod(friction: float) -> float:
    """Return the largest upward velocity in the first 0.2 s, m/s, of a rod with a small ball as its tip."""
    x, y = -4.0 * math.cos(math.radians(75.0)), -4.0 * math.sin(math.radians(75.0))
    rod = Simulation(
        f'{_FLOOR}<body pos="0 0 {-y}"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        f'<geom size="0.01" pos="{x} 0 {y + 0.01}"/></body>',
        _friction(friction),
        options='timestep="0.0005"',
    ).moving({0: -1.0})
    return max(0.0, *(rod.run(0.0005).velocity(2) for _ in range(400)))


def free_fall(seconds: float) -> float:
    """Return the height with a time step of 1/60 s, as in the thread, m."""
    return Simulation(_ball(0.0), options=f'timestep="{1.0 / 60.0!r}"').run(seconds).position(2)


def flip_period(wobble: float) -> float:
    """Return the mean time between every other flip in 60 s, s, with MuJoCo's default integrator."""
    racket = Simulation(_RACKET, slope=None).moving({3: wobble, 4: 10.0})
    flips, before = [], 10.0
    for i in range(30_000):
        now = racket.run(0.002).velocity(4)
        if before * now < 0.0:
            flips.append(0.002 * (i + before / (before - now)))
        before = now
    return 2.0 * (flips[-1] - flips[0]) / (len(flips) - 1) if len(flips) > 1 else math.inf


def hour_of_spin(seconds: float) -> float:
    """Return the change with MuJoCo's default integrator, which is stopped once the energy has doubled."""
    racket = Simulation(_RACKET, slope=None).moving({3: 0.1, 4: 10.0})
    change, before = 0.0, float(np.dot(_MOMENTS, racket.data.qvel[3:6] ** 2))
    for _ in range(round(seconds)):
        change = float(np.dot(_MOMENTS, racket.run(1.0).data.qvel[3:6] ** 2)) / before - 1.0
        if change >= 1.0:  # a little later it is beyond all bounds
            break
    return change
