# SPDX-License-Identifier: Apache-2.0
"""What a case is, and all cases, by the names that the command line takes, in the order of the page."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.records import Record

OfSetting: TypeAlias = Callable[[float], float]
"""A number that follows from the setting of a case, in the units that the case states."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Case(Record):
    """One question with its exact answer. The engines (`engine.py`) answer it by its name in `CASES`."""

    title: str  # the question in a few words
    story: str  # what users saw, and what is right. One or two sentences.
    discussed: str  # public threads in which it was asked, as ``owner/repository/issues/1``, space-separated
    setting: str  # the name of the number that is varied
    settings: tuple[float, ...]  # its values
    quantity: str  # what the answer is, with its unit
    formula: str  # the closed form, in words and symbols
    exact: OfSetting = field(repr=False)  # the closed form as a function of the setting
    tolerance: float  # largest difference of this package's answer from it, in the unit of the quantity
    why_tolerance: str  # the reason for that size
    # service, and path of the number in its response: ``predict_tumbling.poinsot.polhode_period``.
    answer: str
    request: str  # the request in YAML, as `ros2 service call` takes it. ``%(x)s`` stands for the setting.
    # Other values in the request, by name, that follow from the setting.
    values: Callable[[float], dict[str, float]] | None = field(default=None, repr=False)
    # The number in the response, if it is not ``exact``, as a velocity is not a ratio.
    answer_exact: OfSetting | None = field(default=None, repr=False)
    answer_tolerance: float | None = None  # largest difference from it, if it is not ``tolerance``

    @property
    def threads(self) -> tuple[str, ...]:
        """The addresses of the threads."""
        return tuple(f"https://github.com/{thread}" for thread in self.discussed.split())

    def request_text(self, setting: float) -> str:
        """Return the request for a setting."""
        return self.request % {"x": setting, **(self.values(setting) if self.values else {})}

    def answer_of(self, setting: float) -> tuple[float, float]:
        """Return the exact number in the response to that request, and its tolerance."""
        exact = (self.answer_exact or self.exact)(setting)
        return exact, self.tolerance if self.answer_tolerance is None else self.answer_tolerance


_G: Final = -STANDARD_GRAVITY_W[2]


def _weight(mass: float, slope: float) -> dict[str, float]:
    """Return the components of a weight, N, down a slope, rad, and normal to it."""
    return {"down": mass * _G * math.sin(slope), "into": -mass * _G * math.cos(slope)}


def _friction_angle(beyond: float) -> float:
    """Return g (sin - mu cos) of the slope atan(mu) + d: g sin(d) sqrt(1 + mu^2), which does not cancel."""
    return max(0.0, _G * math.sin(beyond) * math.hypot(1.0, 0.5))


def _standing(beyond: float) -> float:
    """Return the angle of the ladder, rad: the limit atan(1 / (2 mu)) at mu = 1/2, less ``beyond``."""
    return math.atan(1.0) - beyond


def _ladder(beyond: float) -> float:
    """Return the acceleration of a sliding ladder with I = m l^2 / 3, and 0 where tan(angle) >= 1 / (2 mu)."""
    sin, cos = math.sin(_standing(beyond)), math.cos(_standing(beyond))
    return 0.0 if beyond < 0.0 else _G * (cos - sin) / (4.0 / 3.0 - sin * cos)


def _tipping_cube(friction: float) -> float:
    """Return alpha = 1.5 (1 - mu) f_n / (m h), where the front edge alone carries f_n and slides.

    With half side h and I = 2 m h^2 / 3, f_n = m g / (1 + 1.5 (1 - mu)).
    """
    share = 1.5 * (1.0 - friction)
    return 0.0 if friction <= 1.0 else share * _G / (0.05 * (1.0 + share))


def _rolling_down(degrees: float) -> float:
    """Return the acceleration of a ball that rolls up to tan(slope) = 7/2 mu, and slides beyond, m/s^2."""
    slope = math.radians(degrees)
    rolls = math.tan(slope) <= 3.5 * 0.2
    return _G * (5.0 / 7.0 * math.sin(slope) if rolls else math.sin(slope) - 0.2 * math.cos(slope))


def _painleve_rod(friction: float) -> float:
    """Return the upward velocity by Routh's construction, m/s, with m = 1, I = 1, v = (-1, 0), e = 0.5.

    Friction (mu, 1) stops the sliding while the tip is driven into the floor. From there the path follows the
    sticking line until the tip has stopped approaching. Restitution adds half of that impulse.
    """
    x, y = -4.0 * math.cos(math.radians(75.0)), -4.0 * math.sin(math.radians(75.0))
    tangent, cross, normal = 1.0 + y * y, -x * y, 1.0 + x * x
    stop = 1.0 / (tangent * friction + cross)
    approach = (cross * friction + normal) * stop
    return 1.5 * (stop - approach / (normal - cross * cross / tangent))


def _flip_period(wobble: float) -> float:
    """Return the period 4 K(m) / rate of the angular velocity in the body, s, by Jacobi's functions.

    With moments A < B < C and the spin (w1, w2, 0): rate^2 = (B - A) (2 T C - L^2) / (A B C), and the
    complement of the parameter is 1 - m = (C - A) (2 T B - L^2) / ((B - A) (2 T C - L^2)). K is found by the
    arithmetic-geometric mean. Both differences are written out, so that they do not cancel.
    """
    a, b, c = 1.0e-3, 2.0e-3, 2.8e-3
    from_major = a * (c - a) * wobble**2 + b * (c - b) * 10.0**2  # 2 T C - L^2
    from_middle = a * (b - a) * wobble**2  # 2 T B - L^2
    rate = math.sqrt(from_major * (b - a) / (a * b * c))
    x, y = 1.0, math.sqrt((c - a) * from_middle / ((b - a) * from_major))
    for _ in range(12):  # it converges quadratically
        x, y = 0.5 * (x + y), math.sqrt(x * y)
    return 2.0 * math.pi / x / rate


# The service answers about two bodies; the row of three is for Python.
_FIRST_PAIR: Final = """{inertia: {m: 1.0, ixx: 0.0004, iyy: 0.0004, izz: 0.0004}, state_source: 1, state: {linear_velocity: {x: 1.0}},
  other_inertia: {m: 1.0, ixx: 0.0004, iyy: 0.0004, izz: 0.0004}, other_state: [{pose: {position: {x: 0.1}}}],
  contact_source: 1, contacts: {positions: [0.05, 0.0, 0.0], normals: [-1.0, 0.0, 0.0], frictions: [0.0],
  restitutions: [%(x)s]}}"""

CASES: Final = {
    "creeping_capsule": Case(
        title="A capsule that must stick on a slope",
        story="A capsule rests on a slope, with a friction limit many times its load along the slope. "
        "Engines with regularized friction, which approximates sticking by slow sliding, let it creep. With "
        "Coulomb friction, it does not move.",
        discussed="google-deepmind/mujoco/issues/3328 liabru/matter-js/issues/613",
        setting="friction limit over the load along the slope",
        settings=(20.0, 95.0),
        quantity="distance after 10 s, m",
        formula="0, since tan(slope) is below μ",
        exact=lambda _: 0.0,
        tolerance=1e-12,
        why_tolerance="rounding error of g, multiplied by half of (10 s)²",
        answer="predict_contact_mode.modes[0].linear_acceleration[0]",
        request="""{inertia: {m: 0.045, ixx: 0.000006, iyy: 0.000006, izz: 0.000006}, state_source: 1, contact_source: 1,
  contacts: {positions: [-0.02, 0.0, -0.004, 0.02, 0.0, -0.004], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
  frictions: [0.7, 0.7], restitutions: [0.0, 0.0]}, gravity: 1, problem: 1, plane_normal: {y: -1.0},
  applied_wrench: {force: {x: %(down).9f, z: %(into).9f}}}""",
        values=lambda margin: _weight(0.045, math.atan(0.7 / margin)),
        answer_tolerance=1e-14,
    ),
    "friction_angle": Case(
        title="A block on a slope at its friction angle",
        story="The slope differs from atan μ by a billionth of a radian. Below atan μ the block rests, and "
        "above it slides. With regularized friction it slides in both cases.",
        discussed="schteppe/cannon.js/issues/288 liabru/matter-js/issues/752 raisimTech/raisimLib/issues/55",
        setting="slope minus atan μ, rad",
        settings=(-1e-09, 1e-09),
        quantity="acceleration, m/s²",
        formula="0, or g (sin(slope) − μ cos(slope))",
        exact=_friction_angle,
        tolerance=1e-14,
        why_tolerance="rounding error of two numbers near g, whose difference is the answer",
        answer="predict_contact_mode.modes[0].linear_acceleration[0]",
        request="""{inertia: {m: 1.0, ixx: 0.002, iyy: 0.002, izz: 0.002}, state_source: 1, contact_source: 1,
  contacts: {positions: [-0.05, 0.0, -0.02, 0.05, 0.0, -0.02], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
  frictions: [0.5, 0.5], restitutions: [0.0, 0.0]}, gravity: 1, problem: 1, plane_normal: {y: -1.0},
  applied_wrench: {force: {x: %(down)s, z: %(into)s}}}""",
        # At ten times the angle, whose acceleration is well above the service's tolerance of 1e-9 m/s^2.
        values=lambda beyond: _weight(1.0, math.atan(0.5) + 10.0 * beyond),
        answer_exact=lambda beyond: _friction_angle(10.0 * beyond),
        answer_tolerance=1e-13,
    ),
    "pressed_book": Case(
        title="A book pressed against a wall",
        story="In simulations, objects slip out of hands even if μ is large. Here, a smooth hand presses a "
        "book against a wall with the force N. With Coulomb friction, the book stays if μ N ≥ m g.",
        discussed="gazebosim/gazebo-classic/issues/2703 bulletphysics/bullet3/issues/2607 "
        "PickNikRobotics/ros2_robotiq_gripper/pull/15",
        setting="μ (the limit is 0.4903)",
        settings=(0.48, 0.5),
        quantity="downward acceleration, m/s²",
        formula="g − μ N / m, but not below 0",
        exact=lambda friction: max(0.0, _G - friction * 20.0),
        tolerance=1e-13,
        why_tolerance="rounding error of numbers near g",
        answer="predict_contact_mode.modes[0].linear_acceleration[2]",
        request="""{inertia: {m: 1.0, ixx: 0.01, iyy: 0.01, izz: 0.01}, state_source: 1, contact_source: 1,
  contacts: {positions: [-0.01, 0.0, -0.1, -0.01, 0.0, 0.1], normals: [1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
  frictions: [%(x)s, %(x)s], restitutions: [0.0, 0.0]}, problem: 1, plane_normal: {y: -1.0},
  applied_wrench: {force: {x: -20.0}}}""",
        answer_exact=lambda friction: -max(0.0, _G - friction * 20.0),
    ),
    "turning_bar": Case(
        title="A bar that swings about a fingertip",
        story="A user wanted an object to swing freely between two fingertips and could not disable the "
        "resistance. A point contact with Coulomb friction transmits no moment, so the bar is a pendulum.",
        discussed="Genesis-Embodied-AI/genesis-world/issues/1139",
        setting="distance from the fingertip to the centre, m",
        settings=(0.1,),
        quantity="angular acceleration, rad/s²",
        formula="m g d / (I + m d²), with the distance d and the moment of inertia I",
        exact=lambda arm: _G * arm / (0.01 + arm * arm),
        tolerance=1e-11,
        why_tolerance="rounding error of numbers near 100, and of the spatial search",
        answer="predict_contact_mode.modes[0].angular_acceleration[1]",
        request="""{inertia: {m: 1.0, ixx: 0.01, iyy: 0.01, izz: 0.01}, state_source: 1, state: {pose: {position: {x: %(x)s}}},
  contact_source: 1, contacts: {positions: [0.0, 0.0, 0.0], normals: [0.0, 1.0, 0.0], frictions: [1.0],
  restitutions: [0.0]}, applied_wrench: {force: {y: -50.0}, torque: {z: %(moment)s}}, problem: 2}""",
        values=lambda arm: {"moment": 50.0 * arm},
    ),
    "ladder": Case(
        title="A ladder against a smooth wall",
        story="The foot sticks if tan(α) is at least 1 / (2 μ), with the angle α between ladder and floor. With approximate friction, bodies move too "
        "early at such thresholds.",
        discussed="raisimTech/raisimLib/issues/55 google-deepmind/mujoco/pull/3349",
        setting="angle below the limit, rad",
        settings=(-0.01, 0.01),
        quantity="angular acceleration, rad/s²",
        formula="0, or g (cos α − 2 μ sin α) / (l (4/3 − 2 μ sin α cos α)), with the angle α and half the length l",
        exact=_ladder,
        tolerance=1e-13,
        why_tolerance="rounding error of numbers near g",
        answer="predict_contact_mode.modes[0].angular_acceleration[1]",
        request="""{inertia: {m: 1.0, ixx: 0.333333333333, iyy: 0.333333333333, izz: 0.333333333333}, state_source: 1,
  contact_source: 1, contacts: {positions: [%(x).15g, 0.0, -%(z).15g, -%(x).15g, 0.0, %(z).15g],
  normals: [0.0, 0.0, 1.0, 1.0, 0.0, 0.0], frictions: [0.5, 0.0], restitutions: [0.0, 0.0]},
  problem: 1, plane_normal: {y: -1.0}}""",
        values=lambda beyond: {"x": math.cos(_standing(beyond)), "z": math.sin(_standing(beyond))},
        answer_exact=lambda beyond: -_ladder(beyond),  # the plane is seen from -y
        answer_tolerance=1e-10,
    ),
    "jamming_drawer": Case(
        title="A peg or drawer that jams",
        story="An off-centre push presses a peg, or a drawer, against both walls. It jams if the friction "
        "coefficient exceeds L / (2 d), where L is its length between the walls, and d the distance of the push "
        "from its axis. Users saw pegs pass through walls, or not move at all.",
        discussed="bulletphysics/bullet3/issues/2148 google-deepmind/mujoco/issues/1544",
        setting="μ (the limit is 1)",
        settings=(0.9, 1.1),
        quantity="acceleration along the walls, m/s²",
        formula="F (1 − 2 μ d / L) / m, but not below 0",
        exact=lambda friction: max(0.0, 10.0 * (1.0 - 2.0 * friction * 0.1 / 0.2)),
        tolerance=1e-13,
        why_tolerance="rounding error of numbers near 10",
        answer="predict_contact_mode.modes[0].linear_acceleration[2]",
        request="""{inertia: {m: 1.0, ixx: 0.01, iyy: 0.01, izz: 0.01}, state_source: 1, contact_source: 1,
  contacts: {positions: [-0.05, 0.0, 0.1, 0.05, 0.0, -0.1], normals: [1.0, 0.0, 0.0, -1.0, 0.0, 0.0],
  frictions: [%(x)s, %(x)s], restitutions: [0.0, 0.0]}, gravity: 1, problem: 1,
  plane_normal: {y: -1.0}, applied_wrench: {force: {z: 10.0}, torque: {y: -1.0}}}""",
    ),
    "four_feet": Case(
        title="The load on one of four feet",
        story="Rigid-body mechanics does not determine how four feet share a weight, and the answer reports "
        "this (`forces_unique`). An engine returns one distribution, which depends on its contact "
        "softness and changes if one foot is slightly shorter. The number in MuJoCo's column is this "
        "change.",
        discussed="schteppe/cannon.js/issues/274 google-deepmind/mujoco/issues/2630",
        setting="mass, kg",
        settings=(8.0,),
        quantity="width of the range of possible loads on one foot, N",
        formula="m g / 2, since two opposite feet can carry the whole weight",
        exact=lambda mass: 0.5 * mass * _G,
        tolerance=1e-10,
        why_tolerance="rounding error of the weight, N",
        answer="predict_contact_mode.modes[0].contact_forces[2]",
        # The table on two opposite feet: the response has the most that one of them can carry.
        request="""{inertia: {m: %(x)s, ixx: %(moment).9f, iyy: %(moment).9f, izz: %(axial).9f},
  state_source: 1, state: {pose: {position: {z: 0.25}}}, contact_source: 1, problem: 2,
  contacts: {positions: [0.5, 0.5, 0.0, -0.5, -0.5, 0.0], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
  frictions: [0.5, 0.5], restitutions: [0.0, 0.0]}}""",
        values=lambda mass: {"moment": mass / 12.0 * 1.25, "axial": mass / 12.0 * 2.0},
    ),
    "tipping_cube": Case(
        title="A sliding cube that tips only above μ = 1",
        story="A cube is pushed and slides. The height of its centre of mass equals the horizontal distance "
        "to its front edge, so the cube stays flat up to μ = 1 and tips beyond. Users saw such a cube "
        "tumble at μ = 0.5.",
        discussed="Genesis-Embodied-AI/genesis-world/issues/3115",
        setting="μ",
        settings=(0.5, 0.99, 1.01),
        quantity="angular acceleration, rad/s² (negative: forwards)",
        formula="0 up to μ = 1; then 1.5 (1 − μ) g / (h (1 + 1.5 (1 − μ))) with half side h",
        exact=_tipping_cube,
        tolerance=1e-11,
        why_tolerance="rounding error of g, divided by h",
        answer="predict_contact_mode.modes[0].angular_acceleration[1]",
        request="""{inertia: {m: 1.0, ixx: 0.0016666666666666668, iyy: 0.0016666666666666668, izz: 0.0016666666666666668},
  state_source: 1, state: {linear_velocity: {x: 6.0}}, contact_source: 1, problem: 1, plane_normal: {y: -1.0},
  contacts: {positions: [-0.05, 0.0, -0.05, 0.05, 0.0, -0.05], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
  frictions: [%(x)s, %(x)s], restitutions: [0.0, 0.0]}}""",
        answer_exact=lambda friction: -_tipping_cube(friction),  # the plane is seen from -y
    ),
    "oblique_sliding": Case(
        title="A box that slides obliquely to the axes",
        story="Engines that replace the friction cone by a pyramid decelerate a body differently along "
        "different directions, and bend its path. Coulomb friction is exactly opposite to the sliding.",
        discussed="dimforge/rapier/issues/137 osrf/gazebo_tutorials/pull/174",
        setting="direction of sliding, degrees from the x axis",
        settings=(20.0, 45.0),
        quantity="acceleration along y, m/s²",
        formula="−μ g sin(direction)",
        exact=lambda degrees: -0.5 * _G * math.sin(math.radians(degrees)),
        tolerance=1e-12,
        why_tolerance="rounding error of numbers near g",
        answer="predict_contact_mode.modes[0].linear_acceleration[1]",
        request="""{inertia: {m: 1.0, ixx: 0.003366666667, iyy: 0.003366666667, izz: 0.006666666667}, state_source: 1, problem: 2,
  state: {pose: {position: {z: 0.01}}, linear_velocity: {x: %(vx)s, y: %(vy)s}}, contact_source: 1,
  contacts: {positions: [0.1, 0.1, 0.0, 0.1, -0.1, 0.0, -0.1, 0.1, 0.0, -0.1, -0.1, 0.0],
  normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0], frictions: [0.5, 0.5, 0.5, 0.5],
  restitutions: [0.0, 0.0, 0.0, 0.0]}}""",
        values=lambda degrees: {
            "vx": 2.0 * math.cos(math.radians(degrees)),
            "vy": 2.0 * math.sin(math.radians(degrees)),
        },
    ),
    "bowling_ball": Case(
        title="A bowling ball that slides and then rolls",
        story="Users ask why a ball never stops, and engines add damping to stop it. A rigid ball "
        "decelerates while it slides, and then rolls at 5/7 of its initial speed. Rolling resistance is a "
        "different model, which this package does not include.",
        discussed="schteppe/cannon.js/issues/345 lo-th/Oimo.js/issues/64",
        setting="initial speed, m/s",
        settings=(7.0,),
        quantity="speed once it rolls, m/s",
        formula="5/7 of the initial speed",
        exact=lambda speed: 5.0 / 7.0 * speed,
        tolerance=1e-13,
        why_tolerance="rounding error of numbers near 10",
        answer="predict_contact_mode.modes[0].linear_acceleration[0]",
        request="""{inertia: {m: 7.0, ixx: 0.028, iyy: 0.028, izz: 0.028}, state_source: 1, state: {linear_velocity: {x: %(x)s}},
  contact_source: 1, contacts: {positions: [0.0, 0.0, -0.1], normals: [0.0, 0.0, 1.0], frictions: [0.2],
  restitutions: [0.0], kinds: [2], body_curvatures: [10.0], surface_curvatures: [0.0]}, problem: 1,
  plane_normal: {y: -1.0}}""",
        answer_exact=lambda _: -0.2 * _G,
    ),
    "rolling_down": Case(
        title="A ball on a slope, rolling or sliding",
        story="Users saw balls roll down at constant speed, or shoot off. A rigid ball rolls with 5/7 g "
        "sin(slope) up to tan(slope) = 7/2 μ, and slides on steeper slopes.",
        discussed="liabru/matter-js/issues/1158 gazebosim/gz-physics/issues/7",
        setting="slope, degrees",
        settings=(30.0, 40.0),
        quantity="acceleration, m/s²",
        formula="5/7 g sin(slope), or g (sin(slope) − μ cos(slope))",
        exact=_rolling_down,
        tolerance=1e-13,
        why_tolerance="rounding error of numbers near g",
        answer="predict_contact_mode.modes[0].linear_acceleration[0]",
        request="""{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1, contact_source: 1,
  contacts: {positions: [0.0, 0.0, -0.1], normals: [0.0, 0.0, 1.0], frictions: [0.2], restitutions: [0.0]},
  gravity: 1, problem: 1, plane_normal: {y: -1.0},
  applied_wrench: {force: {x: %(down)s, z: %(into)s}}}""",
        values=lambda degrees: _weight(1.0, math.radians(degrees)),
    ),
    "bounce": Case(
        title="A ball with a given restitution",
        story="In engines with spring-damper contacts, restitution follows from stiffness, damping and time "
        "step, and only approximates the intended value. In this package, e is the value you set.",
        discussed="google-deepmind/mujoco/issues/2080 NVIDIAGameWorks/PhysX/issues/351",
        setting="e",
        settings=(0.75, 0.3),
        quantity="speed after the impact over speed before",
        formula="e, by definition",
        exact=lambda restitution: restitution,
        tolerance=1e-15,
        why_tolerance="rounding error of a number near 1",
        answer="predict_impact.impact.state_after.linear_velocity.z",
        request="""{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1,
  state: {linear_velocity: {z: -3.0}}, contact_source: 1, contacts: {positions: [0.0, 0.0, -0.1],
  normals: [0.0, 0.0, 1.0], frictions: [0.5], restitutions: [%(x)s]}}""",
        answer_exact=lambda restitution: 3.0 * restitution,
        answer_tolerance=1e-14,
    ),
    "hundred_bounces": Case(
        title="A ball at e = 1 that keeps its height",
        story="Users found that a lossless ball jumps higher, or lower, with every bounce, because gravity "
        "and impact share a time step. Here, flight and impact are computed separately, and exactly.",
        discussed="dimforge/rapier/issues/97 jrouwe/JoltPhysics/issues/1286 erincatto/box2d/issues/167 "
        "bulletphysics/bullet3/issues/1530",
        setting="number of bounces",
        settings=(100.0,),
        quantity="height after the bounces, m",
        formula="1, the initial height",
        exact=lambda _: 1.0,
        tolerance=1e-12,
        why_tolerance="rounding error over a hundred landings",
        answer="predict_impact.impact.state_after.linear_velocity.z",
        # One bounce, with the speed after falling 1 m.
        request="""{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1,
  state: {linear_velocity: {z: -4.428690551}}, contact_source: 1, contacts: {positions: [0.0, 0.0, -0.1],
  normals: [0.0, 0.0, 1.0], frictions: [0.5], restitutions: [1.0]}}""",
        answer_exact=lambda _: 4.428690551,
        answer_tolerance=1e-14,
    ),
    "spinning_bounce": Case(
        title="A ball with backspin",
        story="Users found that friction and spin decay over bounces, or that spin does not affect the "
        "velocity. A rigid ball that grips leaves the floor rolling, and enough backspin sends it back.",
        discussed="avianphysics/avian/issues/200",
        setting="spin, rad/s (negative: backspin)",
        settings=(-40.0, -80.0),
        quantity="forward velocity after the bounce, m/s",
        formula="5/7 (v + 2/5 r ω), with the velocity v before the bounce, the radius r and the spin ω",
        exact=lambda spin: 5.0 / 7.0 * (2.0 + 0.4 * 0.1 * spin),
        tolerance=1e-14,
        why_tolerance="rounding error of numbers near 10",
        answer="predict_impact.impact.state_after.linear_velocity.x",
        request="""{inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, state_source: 1,
  state: {linear_velocity: {x: 2.0, z: -4.0}, angular_velocity: {y: %(x)s}}, contact_source: 1,
  contacts: {positions: [0.0, 0.0, -0.1], normals: [0.0, 0.0, 1.0], frictions: [0.8], restitutions: [0.8]}}""",
    ),
    "two_balls": Case(
        title="An elastic collision of two balls",
        story="Users set the restitution to 1 and saw an inelastic collision, or an increase of energy. "
        "Conservation of momentum and energy admits only one solution.",
        discussed="DanielChappuis/reactphysics3d/issues/96 erincatto/solver2d/issues/19 "
        "keenon/nimblephysics/issues/143",
        setting="mass of the first ball, kg",
        settings=(10.0, 1.0),
        quantity="speed of the second ball (10 kg) over that of the first",
        formula="2 / (1 + M / m), with the mass m of the first ball and M of the second",
        exact=lambda mass: 2.0 * mass / (mass + 10.0),
        tolerance=1e-15,
        why_tolerance="rounding error of a number near 1",
        answer="predict_impact.impact.other_state_after[0].linear_velocity.x",
        request="""{inertia: {m: %(x)s, ixx: 1.0, iyy: 1.0, izz: 1.0}, state_source: 1, state: {linear_velocity: {x: 1.0}},
  other_inertia: {m: 10.0, ixx: 1.0, iyy: 1.0, izz: 1.0}, other_state: [{pose: {position: {x: 1.0}}}],
  contact_source: 1, contacts: {positions: [0.5, 0.0, 0.0], normals: [-1.0, 0.0, 0.0], frictions: [0.0],
  restitutions: [1.0]}}""",
    ),
    "cradle_in_turn": Case(
        title="Newton's cradle, sequential law",
        story="Rigid-body mechanics does not determine the motion of three balls in contact. If the pairs "
        "collide one after another with e = 1, the last ball receives all the momentum, as approximately "
        "observed with steel balls. This case uses the sequential law.",
        discussed="liabru/matter-js/issues/361 ekiefl/pooltool/pull/257",
        setting="e",
        settings=(1.0, 0.8),
        quantity="speed of the last of three balls over that of the first",
        formula="((1 + e) / 2)²",
        exact=lambda restitution: (0.5 * (1.0 + restitution)) ** 2,
        tolerance=1e-12,
        why_tolerance="rounding error over a few impacts",
        answer="predict_impact.impact.other_state_after[0].linear_velocity.x",
        request=_FIRST_PAIR,
        answer_exact=lambda restitution: 0.5 * (1.0 + restitution),
        answer_tolerance=1e-14,
    ),
    "cradle_at_once": Case(
        title="Newton's cradle, simultaneous law",
        story="If all contacts collide simultaneously, each under Newton's law of restitution, the balls at "
        "rest leave together. Neither law is wrong, and an engine that returns a single result has "
        "chosen one of them.",
        discussed="liabru/matter-js/issues/361",
        setting="e",
        settings=(1.0, 0.8),
        quantity="speed of the last of three balls over that of the first",
        formula="(1 + e) / 3",
        exact=lambda restitution: (1.0 + restitution) / 3.0,
        tolerance=1e-09,
        why_tolerance="the complementarity problem is solved by projections to 1e-9",
        answer="predict_impact.impact.other_state_after[0].linear_velocity.x",
        request=_FIRST_PAIR,
        answer_exact=lambda restitution: 0.5 * (1.0 + restitution),
        answer_tolerance=1e-14,
    ),
    "painleve_rod": Case(
        title="A sliding rod in Painlevé's paradox",
        story="A rod slides on its tip. If μ is large, no finite contact force is consistent, because friction drives "
        "the tip into the floor. The rod jams dynamically: an impact without approach stops the tip and throws "
        "the rod up. Soft contacts hide or delay this impact.",
        discussed="RobotLocomotion/drake/pull/4539 RobotLocomotion/drake/pull/5175",
        setting="μ",
        settings=(0.6, 1.0),
        quantity="upward velocity after the impact, m/s",
        formula="1.5 P, where P is the normal impulse at the end of compression on Routh's impulse path",
        exact=_painleve_rod,
        tolerance=1e-14,
        why_tolerance="rounding error of numbers near 1",
        answer="predict_impact.impact.state_after.linear_velocity.z",
        request="""{inertia: {m: 1.0, ixx: 1.0, iyy: 1.0, izz: 1.0}, state_source: 1, state: {linear_velocity: {x: -1.0}},
  contact_source: 1, contacts: {positions: [-1.035276180410083, 0.0, -3.8637033051562732], normals: [0.0, 0.0, 1.0],
  frictions: [%(x)s], restitutions: [0.5]}, problem: 1, plane_normal: {y: -1.0}}""",
    ),
    "free_fall": Case(
        title="Free fall",
        story="An integrator that uses the velocity at the end of the step makes a body fall g t Δt / 2 too "
        "far. Here, the flight is computed in closed form at any time.",
        discussed="dimforge/rapier/issues/525 schteppe/cannon.js/issues/353",
        setting="time, s",
        settings=(1.0,),
        quantity="height, m",
        formula="−g t² / 2",
        exact=lambda seconds: -0.5 * _G * seconds**2,
        tolerance=1e-15,
        why_tolerance="rounding error of a number near 5",
        answer="predict_tumbling.trajectory.positions[2]",
        request="{state_source: 1, inertia: {m: 1.0, ixx: 0.004, iyy: 0.004, izz: 0.004}, times: [%(x)s]}",
    ),
    "flip_period": Case(
        title="The flip period of a tennis racket",
        story="A body that spins about its intermediate axis flips periodically. Engines without the gyroscopic "
        "term never flip it, and others drift away from the period.",
        discussed="google/brax/issues/156 bepu/bepuphysics2/issues/79 bulletphysics/bullet3/pull/346",
        setting="spin about the minor axis, rad/s",
        settings=(0.1, 1e-06),
        quantity="period of the angular velocity in the body, s",
        formula="4 K(m) / rate, from Jacobi's solution of Euler's equations; K is the complete elliptic integral",
        exact=_flip_period,
        tolerance=1e-12,
        why_tolerance="rounding error of the distance from the intermediate axis, on whose logarithm the period depends",
        answer="predict_tumbling.poinsot.polhode_period",
        request="""{state_source: 1, inertia: {m: 1.0, ixx: 0.001, iyy: 0.002, izz: 0.0028}, gravity: 1,
  state: {angular_velocity: {x: %(x).9f, y: 10.0}}, times: [1.0]}""",
    ),
    "hour_of_spin": Case(
        title="Energy after an hour of free spin",
        story="Users report engines that gain or lose energy in free spin, or drift to another axis. The "
        "closed form conserves energy and angular momentum at any time. (MuJoCo's default integrator is "
        "stopped once the energy has doubled; its Runge-Kutta integrator is far more accurate.)",
        discussed="avianphysics/avian/pull/993 jrouwe/JoltPhysics/issues/803",
        setting="time, s",
        settings=(60.0, 3600.0),
        quantity="relative change of energy",
        formula="0",
        exact=lambda _: 0.0,
        tolerance=1e-13,
        why_tolerance="the closed form conserves energy and angular momentum to 1e-13",
        answer="predict_tumbling.poinsot.rotational_energy",
        request="""{state_source: 1, inertia: {m: 1.0, ixx: 0.001, iyy: 0.002, izz: 0.0028}, gravity: 1,
  state: {angular_velocity: {x: 0.1, y: 10.0}}, times: [%(x)s]}""",
        answer_exact=lambda _: 0.5 * (1e-3 * 0.1**2 + 2e-3 * 10.0**2),
        answer_tolerance=1e-16,
    ),
}
