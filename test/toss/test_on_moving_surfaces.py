# SPDX-License-Identifier: Apache-2.0
"""Tosses onto surfaces that all move alike, such as a belt that catches a parcel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import contact_dynamics as cd
from contact_dynamics.contact_modes import contact_modes
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.shapes import Obstacle
from contact_dynamics.toss import TossEnd

G = 9.80665
U, MU = 1.2, 0.4
BOX = cd.Body.box((0.2, 0.2, 0.1), 1.0)
LYING = cd.BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1], stamp_ns=7)
BELT = cd.Surface(
    name="belt", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=MU, restitution=0.2, v_WS_W=[U, 0, 0]
)
TUMBLING = cd.BodyState(
    p_WB_W=[0, 0, 0.3],
    q_WB=np.array([0.1, 0.2, 0, 1.0]) / np.sqrt(1.05),
    v_WB_W=[0.3, 0, 0],
    w_WB_W=[1, 2, 3],
)


def test_a_parcel_on_a_belt_slides_until_it_moves_with_it() -> None:
    toss = cd.toss(BOX, LYING, cd.World(surfaces=(BELT,)))
    # The toss ends where what is left of the motion would slide by a micrometre at most (docs/toss.md), which
    # is at a speed of up to sqrt(2 mu g 1e-6 m), 2.8 mm/s.
    left = np.sqrt(2.0 * MU * G * 1e-6)
    stops = U / (MU * G)
    assert toss.end == TossEnd.RESTS
    assert toss.seconds == pytest.approx(stops, abs=left / (MU * G))
    assert toss.state.p_WB_W[0] == pytest.approx(U * U / (2.0 * MU * G), abs=U * left / (MU * G))
    np.testing.assert_allclose(toss.state.v_WB_W, [U, 0, 0], atol=1e-15)
    half = toss.at([0.5 * stops, 2.0])
    np.testing.assert_allclose(half.v_WB_W[0], [0.5 * U, 0, 0], atol=1e-12)
    np.testing.assert_allclose(half.p_WB_W[0], [U * U / (8.0 * MU * G), 0, 0.05], atol=1e-12)
    # It goes on with the belt, and contact modes confirm that it is at rest there.
    assert half.p_WB_W[1, 0] == pytest.approx(toss.state.p_WB_W[0] + U * (2.0 - toss.seconds), rel=1e-14)
    np.testing.assert_allclose(half.v_WB_W[1], [U, 0, 0], atol=1e-15)
    riding = cd.SpatialContactProblem.of(BOX, toss.state, cd.World(surfaces=(BELT,)))
    assert [mode.mode for mode in contact_modes(riding).modes] == ["ffff"]
    # Friction dissipates the energy of the motion relative to the belt.
    assert toss.energy.lost_in_contact == pytest.approx(0.5 * U * U, rel=1e-12)


@pytest.mark.parametrize("a", [0.0, 1.0, 2.5, 2.75])
@pytest.mark.parametrize("leans", [False, True], ids=["accelerates", "slope"])
def test_rest_is_a_micrometre_early_by_the_friction_that_is_left(a: float, *, leans: bool) -> None:
    """By hand: a parcel on a belt slows down by mu g - a, one on a slope by mu g cos - g sin."""
    mu, tilt = 0.3, np.arcsin(a / G) if leans else 0.0
    slope = np.array([np.cos(tilt), 0, -np.sin(tilt)])
    normal = np.array([np.sin(tilt), 0, np.cos(tilt)])
    floor = cd.Surface(
        name="floor",
        p_WS_W=[0, 0, 0],
        normal_W=normal,
        friction=mu,
        restitution=0.0,
        v_WS_W=[0, 0, 0] if leans else [U, 0, 0],
        a_WS_W=[0, 0, 0] if leans else [a, 0, 0],
    )
    state = cd.BodyState(
        p_WB_W=0.05 * normal,
        q_WB=[0, np.sin(tilt / 2), 0, np.cos(tilt / 2)],
        v_WB_W=U * slope if leans else [0, 0, 0],
    )
    toss = cd.toss(BOX, state, cd.World(surfaces=(floor,)), horizon=20.0)
    left = mu * G * np.cos(tilt) - a
    stops, slides = U / left, U * U / (2.0 * left)
    moved = toss.state.p_WB_W @ slope
    found = moved if leans else U * toss.seconds + 0.5 * a * toss.seconds**2 - moved
    assert toss.end == TossEnd.RESTS
    # Both are to the tolerance of rest, a micrometre, and rounding.
    assert slides - 1.001e-6 <= found <= slides + 1e-9
    assert stops - 1.001 * np.sqrt(2e-6 / left) <= toss.seconds <= stops + 1e-9


@pytest.mark.parametrize("a", [0.0, 4.0, 4.15])
def test_rest_in_a_groove_is_a_micrometre_early_by_the_friction_that_is_left(a: float) -> None:
    """By hand: each side of a right angle presses with m g / sqrt(2), and sqrt(2) mu g - a is left."""
    mu, half = 0.3, np.sqrt(0.5)
    sides = tuple(
        cd.Surface(
            name=name,
            p_WS_W=[0, 0, 0],
            normal_W=[x, 0, half],
            friction=mu,
            restitution=0.0,
            v_WS_W=[0, U, 0],
            a_WS_W=[0, a, 0],
        )
        for name, x in (("left", half), ("right", -half))
    )
    cube = cd.Body.box((0.1, 0.1, 0.1), 1.0)
    turned = [0, np.sin(np.pi / 8), 0, np.cos(np.pi / 8)]
    state = cd.BodyState(p_WB_W=[0, 0, 0.05 / half], q_WB=turned)
    toss = cd.toss(cube, state, cd.World(surfaces=sides), horizon=200.0)
    left = mu * G / half - a
    found = U * toss.seconds + 0.5 * a * toss.seconds**2 - toss.state.p_WB_W[1]
    assert toss.end == TossEnd.RESTS
    # To the tolerance of rest, a micrometre, and the steps' error of 1e-7 m each.
    assert U * U / (2.0 * left) - 1.2e-6 <= found <= U * U / (2.0 * left) + 2e-7


@pytest.mark.parametrize("a", [[0.0, 0.0, 0.0], [0.5, 0.0, 1.5]])
def test_a_toss_is_the_same_from_a_frame_that_moves(a: list[float]) -> None:
    u, a_W = np.array([0.7, -0.4, 0.9]), np.array(a)
    still = replace(BELT, v_WS_W=np.zeros(3))
    moving = replace(BELT, v_WS_W=u, a_WS_W=a_W)
    alone = cd.toss(
        BOX, TUMBLING, cd.World(surfaces=(still,), gravity_W=np.array([0, 0, -G]) - a_W), max_alternatives=1
    )
    world = cd.World(surfaces=(moving,))
    found = cd.toss(BOX, replace(TUMBLING, v_WB_W=TUMBLING.v_WB_W + u), world, max_alternatives=1)
    assert [event.kind for event in found.events] == [event.kind for event in alone.events]
    assert len(found.strikes) > 3
    assert (found.end, len(found.alternatives)) == (alone.end, len(alone.alternatives))
    assert found.resting_corners == alone.resting_corners
    # Strikes amplify the rounding of the first velocities, 1e-16, by some 1e3 until rest.
    for one, other in [(found, alone), *zip(found.alternatives, alone.alternatives, strict=True)]:
        for event, its in zip(one.events, other.events, strict=True):
            t = its.seconds
            assert event.seconds == pytest.approx(t, abs=1e-10)
            shift = u * t + 0.5 * a_W * t * t
            np.testing.assert_allclose(event.p_WC_W - shift, its.p_WC_W, atol=1e-9)
            np.testing.assert_allclose(event.state.v_WB_W - u - a_W * t, its.state.v_WB_W, atol=1e-9)
    times = np.linspace(0.0, 2.0 * found.seconds, 30)
    here, there = found.at(times), alone.at(times)
    shifts = np.outer(times, u) + 0.5 * np.outer(times**2, a_W)
    np.testing.assert_allclose(here.p_WB_W - shifts, there.p_WB_W, atol=1e-9)
    np.testing.assert_allclose(here.v_WB_W - u - np.outer(times, a_W), there.v_WB_W, atol=1e-9)
    last = found.state_at(found.seconds)
    np.testing.assert_allclose(last.p_WB_W, found.state.p_WB_W, atol=1e-15)
    np.testing.assert_allclose(last.v_WB_W, found.state.v_WB_W, atol=1e-15)


def test_samples_are_the_same_from_a_frame_that_moves() -> None:
    u = np.array([0.7, -0.4, 0.3])
    still = replace(BELT, v_WS_W=np.zeros(3))
    options = {"covariance": 1e-6 * np.eye(12), "count": 25, "to_rest": True}
    alone = cd.sampled_toss(BOX, TUMBLING, cd.World(surfaces=(still,)), **options)
    moving = cd.World(surfaces=(replace(BELT, v_WS_W=u),))
    found = cd.sampled_toss(BOX, replace(TUMBLING, v_WB_W=TUMBLING.v_WB_W + u), moving, **options)
    np.testing.assert_array_equal(found.face_probabilities, alone.face_probabilities)
    assert [each.probability for each in found.branches] == [each.probability for each in alone.branches]
    for one, other in zip(found.strikes, alone.strikes, strict=True):
        np.testing.assert_allclose(one.velocity.mean - u, other.velocity.mean, atol=1e-9)
    assert found.rest is not None
    assert alone.rest is not None
    np.testing.assert_allclose(found.rest.seconds, alone.rest.seconds, atol=1e-9)
    # Of each sample, its two strikes and its rest: the places differ by u times its own times.
    ghosts, theirs = found.ghosts, alone.ghosts
    np.testing.assert_allclose(ghosts.v_WB_W - u, theirs.v_WB_W, atol=1e-9)
    shifts = (ghosts.p_WB_W - theirs.p_WB_W) @ u / (u @ u)
    np.testing.assert_allclose(ghosts.p_WB_W - theirs.p_WB_W, np.outer(shifts, u), atol=1e-9)
    first = shifts[ghosts.strikes == 1]
    assert first.mean() == pytest.approx(alone.strikes[0].seconds.mean[0], abs=1e-3)
    at_rest = shifts[ghosts.strikes == 0]
    assert np.median(at_rest) == pytest.approx(alone.rest.seconds[2], abs=1e-2)


def test_surfaces_that_move_differently_or_turn_are_refused() -> None:
    floor = replace(BELT, name="floor", v_WS_W=np.zeros(3))
    corners = BOX.vertices_B + np.array([5.0, 0.0, 0.0])
    block = Obstacle(name="block", vertices_W=corners, friction=0.1, restitution=0.1)
    turning = replace(BELT, w_WS_W=np.array([0, 0, 1.0]))
    for surfaces in [(BELT, floor), (floor, BELT), (BELT, block), (block, BELT), (turning,)]:
        for name in ("toss", "sampled_toss", "impact_sequence"):
            with pytest.raises(NotSupportedError, match=rf"world must have surfaces at rest in {name}, or"):
                getattr(cd, name)(BOX, TUMBLING, cd.World(surfaces=surfaces))
