# SPDX-License-Identifier: Apache-2.0
"""The contact phases of whole tosses, held against an integration in high precision that shares no code."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tolerances import GRAZING_DEPTH, PHASE_ERROR, SAMPLED_PHASE_ERROR
from contact_dynamics.toss import Toss, TossEventKind, toss
from contact_dynamics.toss.phase import PhaseStep
from contact_dynamics.toss.solid import heights_and_rates, solid_of
from contact_dynamics.world import Body, Surface, World
from oracles.held_motion import HeldBody, accelerations, held_motion
from sweeps import seeds

SIZE = (0.1, 0.12, 0.07)
MASS, GRAVITY = 0.4, 9.80665
BRICK = Body.box(SIZE, mass=MASS, name="brick")
REACH = 0.5 * float(np.linalg.norm(SIZE))


def world(friction: float) -> World:
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=friction, restitution=0.2)
    return World(bodies=(BRICK,), surfaces=(floor,), gravity_W=[0, 0, -GRAVITY])


def thrown(seed: int) -> BodyState:
    chance = np.random.default_rng(seed)
    q = chance.standard_normal(4)
    return BodyState(
        p_WB_W=[0, 0, 0.15],
        q_WB=q / np.linalg.norm(q),
        v_WB_W=chance.normal(0.0, 0.7, 3),
        w_WB_W=chance.normal(0.0, 5.0, 3),
    )


def as_matrices(y: np.ndarray) -> np.ndarray:
    """The oracle's 18 numbers of 13."""
    q = np.array(y[3:7])
    R = rotation_matrix(q / np.linalg.norm(q))
    return np.concatenate([y[:3], R.ravel(), y[7:]])


def speeds(body: HeldBody, y: np.ndarray, corners: list[int]) -> np.ndarray:
    """The speeds along the floor of corners of a body whose 13 numbers are y, m/s."""
    x = as_matrices(y)
    arms = body.corners_B[corners] @ x[3:12].reshape(3, 3).T
    found: np.ndarray = np.linalg.norm((x[12:15] + np.cross(x[15:], arms))[:, :2], axis=1)
    return found


def phases(went: Toss) -> list[tuple[tuple[int, ...], str, list[PhaseStep]]]:
    """The corners, the letters and the steps of each contact phase."""
    found = []
    for event, after in zip(went.events, went.events[1:], strict=False):
        if event.kind == TossEventKind.NEW_MODE:
            steps = [
                piece
                for piece in went.pieces
                if isinstance(piece, PhaseStep) and event.seconds <= piece.start < after.seconds
            ]
            if steps:
                found.append((event.corners, event.mode, steps))
    return found


@pytest.mark.parametrize("error", [PHASE_ERROR, SAMPLED_PHASE_ERROR])
@pytest.mark.parametrize("friction", [0.2, 0.6])
@seeds(range(2), slow=range(2, 40))
def test_each_contact_phase_is_that_of_the_oracle(seed: int, friction: float, error: float) -> None:
    """Each step may be off by ``error``, m and m/s; what is off grows on, by less than ten times here.

    All corners stay above the floor, all contacts press, and what sticks is held by friction, at all times
    of the oracle's motion. So the phase has not gone on beyond its end.
    """
    one = world(friction)
    body = HeldBody(MASS, BRICK.mass_properties.I_B, BRICK.shape.vertices, friction, GRAVITY)
    solid = solid_of(BRICK, one)
    went = toss(BRICK, thrown(seed), one, max_alternatives=0, error=error)
    checked = 0
    for corners, letters, steps in phases(went):
        start = np.array(steps[0].y)
        x = as_matrices(start)
        end = steps[-1].start + steps[-1].span
        sliding = [corner for corner, letter in zip(corners, letters, strict=True) if letter == "c"]
        if len(corners) > 3 or (speeds(body, start, sliding) < 1e-2).any():
            continue  # forces are not unique, or sliding has only just begun and has no direction yet
        last = np.array(steps[-1].at(end))
        final = as_matrices(last)
        off_at_most = 10.0 * len(steps) * error
        slowest = min(
            speeds(body, np.array(step.at(step.start + share * step.span)), sliding).min(initial=np.inf)
            for step in steps
            for share in np.linspace(0.0, 1.0, 20)
        )
        if slowest < max(1e-3, 10.0 * error):
            continue  # it may stop sliding within the error, and the oracle's direction is rounding there
        rows = held_motion(body, x, corners, letters, np.linspace(0.0, end - steps[0].start, 12))
        scales = np.array([1.0] * 3 + [REACH] * 9 + [1.0] * 3 + [REACH] * 3)
        off = np.abs((final - rows[-1]) * scales).max()
        assert off <= off_at_most, (corners, letters)
        for row in rows:
            forces = accelerations(body, row, corners, letters)[6:].reshape(-1, 3)
            weight = MASS * GRAVITY
            assert forces[:, 2].min() >= -1e-5 * weight - weight * error / REACH
            heights = row[2] + body.corners_B @ row[3:12].reshape(3, 3)[2]
            assert heights.min() >= -2.0 * GRAZING_DEPTH - off_at_most
        # A corner that was a little below already, by rounding or a low rebound, may go on so.
        before, after = (
            {touch[1]: height for height, _, touch in heights_and_rates(solid, y.tolist())}
            for y in (start, last)
        )
        for corner in set(before) - set(corners):
            assert after[corner] >= min(before[corner], 0.0) - 2.0 * GRAZING_DEPTH
        checked += 1
    assert checked >= 1
