# SPDX-License-Identifier: Apache-2.0
"""A body on an edge whose friction hardly suffices: its corners stick, or begin to slide as Coulomb says."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.shapes import box
from contact_dynamics.tolerances import BEGINNING_ROUNDING
from contact_dynamics.toss.forces import pushed_by_contacts
from contact_dynamics.toss.mode_choice import Mode, corrected
from contact_dynamics.toss.solid import Held, Touch, numbers_of, solid_of
from contact_dynamics.world import Body, Surface, World

SIZE = (0.1, 0.12, 0.07)
MASS = 0.4
GRAVITY = np.array([0.0, 0.0, -9.81])
HALVINGS = 60
CLEAR = 5e-3  # m, of the corners that do not touch


class OnEdge(NamedTuple):
    """A brick that turns about an edge on a ramp."""

    body: Body
    ramp: Surface
    state: BodyState
    touching: tuple[Touch, Touch]

    def mode(self, friction: float) -> Mode | None:
        solid = solid_of(
            self.body, World(surfaces=(replace(self.ramp, friction=friction),), gravity_W=GRAVITY)
        )
        y = numbers_of(self.state)
        return corrected(solid, y, tuple(map(Held, self.touching)))[0]


def on_edge(seed: int) -> OnEdge:
    chance = np.random.default_rng(seed)
    vertices = np.array(box(size=SIZE).vertices) + 1e-3 * chance.standard_normal((8, 3))
    body = Body(
        name="brick", mass_properties=inertia.box(size=SIZE, mass=MASS).mass_properties, vertices_B=vertices
    )
    n = np.array([*chance.uniform(-0.4, 0.4, 2), 1.0])
    n /= np.linalg.norm(n)
    ramp = Surface(name="ramp", p_WS_W=[0, 0, 0], normal_W=n, friction=1.0, restitution=0.3)
    while True:
        turn = Rotation.from_quat(chance.standard_normal(4))
        i, j = np.argsort(turn.apply(vertices) @ n)[:2].tolist()
        edge = turn.apply(vertices[j] - vertices[i])
        axis = np.cross(edge, n)
        angle = math.atan2(float(edge @ n), float(np.linalg.norm(axis)))
        turn = Rotation.from_rotvec(-angle * axis / np.linalg.norm(axis)) * turn
        heights = turn.apply(vertices) @ n
        if abs(heights[i] - heights[j]) < 1e-12 and np.sort(heights)[2] > heights[i] + CLEAR:
            break
    edge = turn.apply(vertices[j] - vertices[i])
    w = chance.normal(0.0, 4.0) * edge / np.linalg.norm(edge)
    state = BodyState(
        p_WB_W=-n * heights[i], q_WB=turn.as_quat(), v_WB_W=-np.cross(w, turn.apply(vertices[i])), w_WB_W=w
    )
    return OnEdge(body, ramp, state, ((0, i), (0, j)))


def sticks(mode: Mode | None) -> bool:
    return mode is not None and len(mode) == 2 and not any(one.slides for one in mode)


def min_friction(case: OnEdge) -> float | None:
    """The friction from which on both corners stick, if they do for any."""
    low, high = 1e-3, 50.0
    if not sticks(case.mode(high)):
        return None
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if sticks(case.mode(middle)) else (middle, high)
    return high


def obeys_coulomb(case: OnEdge, friction: float, mode: Mode) -> None:
    """Newton's and Euler's equations with the forces of a mode, and Coulomb's law at each corner."""
    solid = solid_of(case.body, World(surfaces=(replace(case.ramp, friction=friction),), gravity_W=GRAVITY))
    held = {one.touch: one for one in mode}
    forces = dict(
        zip(held, map(np.array, pushed_by_contacts(solid, numbers_of(case.state), mode).forces), strict=True)
    )
    R, w, n = case.state.R_WB, case.state.w_WB_W, case.ramp.normal_W
    arms = {touch: R @ np.asarray(case.body.vertices_B)[touch[1]] for touch in case.touching}
    a = GRAVITY + sum(forces.values()) / MASS
    I_W = R @ case.body.mass_properties.I_B @ R.T
    torque = sum((np.cross(arms[touch], force) for touch, force in forces.items()), np.zeros(3))
    alpha = np.linalg.solve(I_W, torque - np.cross(w, I_W @ w))
    slack = BEGINNING_ROUNDING * (1.0 + np.linalg.norm(GRAVITY))  # m/s^2, which the search leaves
    for touch, arm in arms.items():
        moved = a + np.cross(alpha, arm) + np.cross(w, np.cross(w, arm))
        along = moved - n * (moved @ n)
        if touch not in held:
            assert moved @ n >= -slack
            continue
        assert abs(moved @ n) < slack
        force = forces[touch]
        pressing = force @ n
        across = force - n * pressing
        assert pressing >= -1e-8
        if held[touch].slides:
            assert np.linalg.norm(across) == pytest.approx(friction * pressing, rel=1e-9, abs=1e-12)
            assert np.linalg.norm(np.cross(along, across)) <= 2.0 * slack * np.linalg.norm(across)
            assert along @ across <= slack * np.linalg.norm(across)
        else:
            assert np.linalg.norm(along) < slack
            assert np.linalg.norm(across) <= friction * pressing + 1e-8


@pytest.mark.parametrize("block", range(4))
def test_an_edge_whose_friction_hardly_suffices_begins_to_slide_as_coulomb_says(block: int) -> None:
    """Sticking needs some friction; with less by any share of it, down to rounding, there is a mode."""
    swept = 0
    for seed in range(12 * block, 12 * (block + 1)):
        case = on_edge(seed)
        least = min_friction(case)
        if least is None:
            continue
        swept += 1
        for share in (0.5, *(10.0**-k for k in range(1, 13))):
            friction = least * (1.0 - share)
            mode = case.mode(friction)
            assert mode is not None, (seed, share)
            obeys_coulomb(case, friction, mode)
    assert swept > 8
