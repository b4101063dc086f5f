# SPDX-License-Identifier: Apache-2.0
"""Whole tosses whose motion is known: bounces, sliding blocks, falling rods, plates, rolling balls."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.rigid_body import inertia
from contact_dynamics.shapes import box, sphere
from contact_dynamics.toss import TossEnd, TossEventKind, toss

G = 9.81
TILT = math.radians(20.0)


def floor(*, friction: float, restitution: float, tilt: float = 0.0) -> Surface:
    """Return a floor that descends towards +x."""
    return Surface(
        name="floor",
        p_WS_W=np.zeros(3),
        normal_W=[math.sin(tilt), 0.0, math.cos(tilt)],
        friction=friction,
        restitution=restitution,
    )


def world(surface: Surface) -> World:
    return World(surfaces=(surface,), gravity_W=[0.0, 0.0, -G])


def brick(size: tuple[float, float, float] = (0.2, 0.1, 0.04), mass: float = 0.5) -> Body:
    solid = inertia.box(size=size, mass=mass)
    return Body(name="brick", mass_properties=solid.mass_properties, shape=box(size=size))


def ball(radius: float = 0.1, mass: float = 0.5) -> Body:
    moment = 0.4 * mass * radius**2
    properties = MassProperties(mass=mass, I_B=moment * np.eye(3))
    return Body(name="ball", mass_properties=properties, shape=sphere(radius=radius))


def at(p: list[float], v: list[float], w: list[float], q: list[float] | None = None) -> BodyState:
    return BodyState(p_WB_W=p, q_WB=q or [0.0, 0.0, 0.0, 1.0], v_WB_W=v, w_WB_W=w)


@pytest.mark.parametrize("e", [0.125, 0.5, 0.8])
def test_bounces_that_are_not_followed_have_the_friction_of_the_weight(e: float) -> None:
    """While a ball slides, friction takes mu times the normal impulse, which is the weight's if it stays."""
    went = toss(
        ball(),
        at([0, 0, 0.3], [3.0, 0, 0], [0, 0, 0]),
        world(floor(friction=0.02, restitution=e)),
        horizon=3.0,
    )
    assert went.events[-1].kind == TossEventKind.NEW_MODE
    assert TossEventKind.SETTLES in {event.kind for event in went.events}
    assert went.state.v_WB_W[0] == pytest.approx(3.0 - 0.02 * G * 3.0, abs=1e-12)
    assert went.state.v_WB_W[2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("e", [0.0, 0.125, 0.5, 0.8])
def test_a_dropped_ball_rests_after_the_sum_of_its_bounces(e: float) -> None:
    height = 0.7
    went = toss(
        ball(), at([0, 0, 0.1 + height], [0, 0, 0], [0, 0, 0]), world(floor(friction=0.3, restitution=e))
    )
    fall = math.sqrt(2.0 * height / G)
    times = [fall * (1.0 + 2.0 * sum(e**k for k in range(1, n + 1))) for n in range(6)]
    strikes = [event.seconds for event in went.strikes]
    for found, known in zip(strikes[: 2 if e < 0.2 else 6], times, strict=False):
        assert found == pytest.approx(known, abs=1e-12)
    assert went.end == TossEnd.RESTS
    # The rebounds that are not followed would take twice the fall from a micrometre, over 1 - e.
    limit = fall * (1.0 + e) / (1.0 - e)
    assert limit - 2.0 * math.sqrt(2e-6 / G) / (1.0 - e) <= went.seconds <= limit + 1e-12
    assert went.state.p_WB_W == pytest.approx([0.0, 0.0, 0.1], abs=1e-9)


def test_a_ball_that_slides_rolls_at_five_sevenths_of_its_speed() -> None:
    speed, mu = 2.0, 0.3
    went = toss(
        ball(),
        at([0, 0, 0.1], [speed, 0, 0], [0, 0, 0]),
        world(floor(friction=mu, restitution=0.2)),
        horizon=1.0,
    )
    assert went.end == TossEnd.HORIZON  # nothing resists rolling
    rolls = next(event for event in went.events if event.mode == "f")
    assert rolls.seconds == pytest.approx(2.0 * speed / (7.0 * mu * G), rel=1e-5)
    assert went.state.v_WB_W[0] == pytest.approx(5.0 / 7.0 * speed, rel=1e-6)
    assert went.state.w_WB_W[1] == pytest.approx(went.state.v_WB_W[0] / 0.1, rel=1e-6)


def test_a_ball_rolls_down_a_slope_with_five_sevenths_of_its_pull() -> None:
    normal = np.array([math.sin(TILT), 0.0, math.cos(TILT)])
    went = toss(
        ball(),
        at((0.1 * normal).tolist(), [0, 0, 0], [0, 0, 0]),
        world(floor(friction=0.5, restitution=0.2, tilt=TILT)),
        horizon=0.8,
    )
    along = np.array([math.cos(TILT), 0.0, -math.sin(TILT)])
    moved = (went.state.p_WB_W - 0.1 * normal) @ along
    assert moved == pytest.approx(0.5 * 5.0 / 7.0 * G * math.sin(TILT) * 0.8**2, rel=1e-7)


@pytest.mark.parametrize("mu", [0.05, 0.2, 0.6])
def test_a_block_stops_where_friction_has_taken_its_energy(mu: float) -> None:
    speed = 1.5
    went = toss(
        brick(), at([0, 0, 0.02], [speed, 0, 0], [0, 0, 0]), world(floor(friction=mu, restitution=0.1))
    )
    assert went.end == TossEnd.RESTS
    # Rest is declared where the block would slide a micrometre.
    assert went.state.p_WB_W == pytest.approx([speed**2 / (2.0 * mu * G), 0.0, 0.02], abs=2e-6)
    assert went.seconds == pytest.approx(speed / (mu * G), abs=1.5e-3 / math.sqrt(mu))
    assert went.energy.lost_in_contact == pytest.approx(0.5 * 0.5 * speed**2, rel=1e-9)
    assert len(went.resting_corners) == 4
    assert went.resting_normal_B == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    half = went.at([0.4 * speed / (mu * G)])
    assert half.v_WB_W[0] == pytest.approx([0.6 * speed, 0.0, 0.0], abs=1e-8)


def test_a_block_on_a_slope_stays_or_slides_by_the_angle_of_friction() -> None:
    normal = np.array([math.sin(TILT), 0.0, math.cos(TILT)])
    q = [0.0, math.sin(0.5 * TILT), 0.0, math.cos(0.5 * TILT)]
    start = at((0.02 * normal).tolist(), [0, 0, 0], [0, 0, 0], q)
    stays = toss(brick(), start, world(floor(friction=math.tan(TILT) * 1.01, restitution=0.0, tilt=TILT)))
    assert (stays.end, stays.seconds) == (TossEnd.RESTS, 0.0)
    mu = 0.5 * math.tan(TILT)
    slides = toss(brick(), start, world(floor(friction=mu, restitution=0.0, tilt=TILT)), horizon=0.5)
    moved = np.linalg.norm(slides.state.p_WB_W - start.p_WB_W)
    assert moved == pytest.approx(0.5 * 0.25 * 0.5 * G * math.sin(TILT), rel=1e-7)


def rod(half: float = 0.3, mass: float = 0.4) -> Body:
    """Return a thin rod along x with its two ends."""
    moment = mass * half**2 / 3.0
    properties = MassProperties(mass=mass, I_B=np.diag([1e-3 * moment, moment, moment]))
    return Body(name="rod", mass_properties=properties, vertices_B=[[-half, 0.0, 0.0], [half, 0.0, 0.0]])


def leaning(angle: float, half: float, speed: float) -> BodyState:
    """Return a rod at rest but for its speed along x, whose end at -x stands on the floor."""
    return at(
        [0.0, 0.0, half * math.sin(angle)],
        [speed, 0, 0],
        [0, 0, 0],
        [0.0, -math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)],
    )


def test_a_rod_falls_without_friction_as_its_energy_says() -> None:
    half, angle = 0.3, math.radians(50.0)
    went = toss(
        rod(half), leaning(angle, half, 0.0), world(floor(friction=0.0, restitution=0.0)), horizon=2.0
    )
    lands = next(event for event in went.strikes if event.corners == (1,))
    before = went.state_at(math.nextafter(lands.seconds, 0.0))
    # (m l^2 + I) w^2 / 2 = m g l sin(angle), with I = m l^2 / 3.
    assert -before.w_WB_W[1] == pytest.approx(-math.sqrt(1.5 * G * math.sin(angle) / half), rel=1e-7)
    assert before.p_WB_W[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("mu", [0.1, 0.4])
def test_a_sliding_rod_falls_as_an_integration_of_its_own_says(mu: float) -> None:
    half, mass, angle, speed = 0.3, 0.4, math.radians(60.0), 3.0
    moment = mass * half**2 / 3.0

    def rates(_: float, y: np.ndarray) -> list[float]:
        _, v, theta, omega = y
        c, s = math.cos(theta), math.sin(theta)
        pressing = (G - half * omega**2 * s) / (1.0 / mass + half**2 * c * (c + mu * s) / moment)
        return [v, -mu * pressing / mass, omega, -pressing * half * (c + mu * s) / moment]

    def lands(_: float, y: np.ndarray) -> float:
        return float(y[2])

    lands.terminal = True  # type: ignore[attr-defined]
    known = solve_ivp(
        rates, (0.0, 2.0), [0.0, speed, angle, 0.0], method="DOP853", rtol=1e-12, atol=1e-13, events=lands
    )
    went = toss(rod(half, mass), leaning(angle, half, speed), world(floor(friction=mu, restitution=0.0)))
    landed = next(event for event in went.strikes if event.corners == (1,))
    assert landed.seconds == pytest.approx(known.t[-1], abs=1e-6)
    before = went.state_at(math.nextafter(landed.seconds, 0.0))
    found = [before.p_WB_W[0], before.v_WB_W[0], -before.w_WB_W[1]]
    # A step may be off by 1e-7 m, and a fall takes some ten.
    assert found == pytest.approx([known.y[0, -1], known.y[1, -1], known.y[3, -1]], abs=2e-5)


def test_a_plate_that_is_tilted_past_its_edge_tips_over_and_one_before_it_rocks_back() -> None:
    size = (0.04, 0.1, 0.2)
    plate, rough = brick(size), world(floor(friction=0.8, restitution=0.0))
    balance = math.atan2(size[0], size[2])
    for angle, face in ((balance + 0.02, 0), (balance - 0.02, 2)):
        q = [0.0, math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)]
        height = 0.5 * (size[2] * math.cos(angle) + size[0] * math.sin(angle))
        went = toss(plate, at([0.0, 0.0, height], [0, 0, 0], [0, 0, 0], q), rough, max_alternatives=0)
        assert went.end == TossEnd.RESTS
        assert abs(went.resting_normal_B[face]) == pytest.approx(1.0, abs=1e-9)
        assert went.state.p_WB_W[2] == pytest.approx(0.5 * size[face], abs=1e-9)


def test_a_cube_that_slides_into_a_wall_strikes_it_and_rests() -> None:
    wall = Surface(name="wall", p_WS_W=[0.5, 0, 0], normal_W=[-1.0, 0, 0], friction=0.0, restitution=0.5)
    cube = brick((0.1, 0.1, 0.1))
    both = World(surfaces=(floor(friction=0.2, restitution=0.0), wall), gravity_W=[0, 0, -G])
    went = toss(cube, at([0, 0, 0.05], [2.0, 0, 0], [0, 0, 0]), both, max_alternatives=0)
    struck = [event for event in went.strikes if "wall" in event.surfaces]
    speed = math.sqrt(2.0**2 - 2.0 * 0.2 * G * 0.45)
    assert struck[0].seconds == pytest.approx((2.0 - speed) / (0.2 * G), abs=1e-7)
    assert went.end == TossEnd.RESTS
    assert went.state.p_WB_W[0] < 0.45


def test_nothing_below_flies_on() -> None:
    nothing = World(gravity_W=[0, 0, -G])
    went = toss(brick(), at([0, 0, 1], [1, 0, 0], [1, 2, 3]), nothing, horizon=0.5)
    assert went.end == TossEnd.HORIZON
    assert went.events == ()
    assert went.state.p_WB_W == pytest.approx([0.5, 0.0, 1.0 - 0.5 * G * 0.25], abs=1e-12)


def test_jammed_rods_leave_with_an_impulse() -> None:
    """Lecture 26: no mode is consistent, and the jam throws the rod up."""
    properties = MassProperties(mass=1.0, I_B=np.diag([1.0, 1.0, 0.5]))
    body = Body(name="rod", mass_properties=properties, vertices_B=[[-1.0, 0.0, -4.0], [1.0, 0.0, 4.0]])
    start = at([0.0, 0.0, 4.0], [-1.0, 0, 0], [0, 0, 0])
    went = toss(
        body, start, world(floor(friction=math.tan(math.radians(30.0)), restitution=0.5)), horizon=0.2
    )
    assert went.events[0].kind == TossEventKind.JAMS
    assert went.events[0].impulse_W == pytest.approx([0.1372549, 0.0, 0.3333333], abs=1e-6)


@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("sign", "+-")
def test_the_face_on_top_of_a_brick_at_rest_is_named(axis: str, sign: str) -> None:
    up = (1.0 if sign == "+" else -1.0) * np.eye(3)["xyz".index(axis)]
    turned, _ = Rotation.align_vectors([[0.0, 0.0, 1.0]], [up])
    state = at([0, 0, 0.15], [0, 0, 0], [0, 0, 0], turned.as_quat().tolist())
    cube = brick((0.2, 0.2, 0.2))
    went = toss(cube, state, world(floor(friction=0.5, restitution=0.0)))
    assert went.end == TossEnd.RESTS
    assert went.face_on_top == f"{sign}{axis}"
    assert f"{sign}{axis} on top" in went.in_short()
    lowest = cube.vertices_B[[*went.resting_corners]]
    assert lowest @ up == pytest.approx(-0.1 * np.ones(len(lowest)), abs=1e-15)
    moving = toss(cube, state, world(floor(friction=0.5, restitution=0.0)), horizon=0.05)
    assert moving.face_on_top == ""
