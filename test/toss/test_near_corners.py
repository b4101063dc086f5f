# SPDX-License-Identifier: Apache-2.0
"""Corners of a body that are at one place, or nearly: meshes have them, and a toss must come to rest."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Surface, World, inertia
from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.shapes import box_vertices, polyhedron
from contact_dynamics.tolerances import SAME_CORNER
from contact_dynamics.toss import TossEnd, sampled_toss, toss
from contact_dynamics.validation import FloatArray
from sweeps import seeds

FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.25, restitution=0.2)
SIZE = np.array([0.1, 0.08, 0.06])
CORNERS = box_vertices(SIZE)
THROWN = BodyState(
    p_WB_W=[0, 0, 0.3], q_WB=[0.3, 0.2, 0.1, 0.9273618495], v_WB_W=[1, 0, 1], w_WB_W=[3, -4, 2]
)
TRIANGLES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
TRIANGLES += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]


def brick(vertices: FloatArray, size: FloatArray = SIZE) -> Body:
    mass = inertia.box(size=size, mass=0.4).mass_properties
    return Body(name="brick", mass_properties=mass, shape=polyhedron(vertices))


def world(body: Body) -> World:
    return World(bodies=(body,), surfaces=(FLOOR,))


def test_the_triangles_of_a_mesh_are_the_shape_with_its_corners_once() -> None:
    mesh = brick(CORNERS[np.array(TRIANGLES).ravel()])
    assert len(mesh.shape.vertices) == 8
    order = [int(np.flatnonzero((vertex == CORNERS).all(axis=1))[0]) for vertex in mesh.shape.vertices]
    plain, meshed = toss(brick(CORNERS), THROWN, world(mesh)), toss(mesh, THROWN, world(mesh))
    # Corners of one strike are added up in the order of their list, so that last bits differ.
    np.testing.assert_allclose(meshed.state.p_WB_W, plain.state.p_WB_W, rtol=0.0, atol=1e-12)
    assert sorted(order[k] for k in meshed.resting_corners) == list(plain.resting_corners)
    assert meshed.undecided == plain.undecided


@pytest.mark.parametrize("apart", [1e-15, 1e-12, 1e-9, 1e-7, 0.5 * SAME_CORNER])
def test_corners_nearer_than_the_tolerance_are_one_and_the_first_is_told(apart: float) -> None:
    """The pairs are next to each other in the list, so that indices are those of every second corner."""
    body = brick(np.repeat(CORNERS, 2, axis=0) + np.tile([[0.0, 0.0, 0.0], [apart, 0.0, 0.0]], (8, 1)))
    plain, went = toss(brick(CORNERS), THROWN, world(body)), toss(body, THROWN, world(body))
    np.testing.assert_array_equal(went.state.p_WB_W, plain.state.p_WB_W)
    assert went.resting_corners == tuple(2 * corner for corner in plain.resting_corners)
    assert [event.corners for event in went.events] == [
        tuple(2 * corner for corner in event.corners) for event in plain.events
    ]


def test_samples_tell_the_corners_of_the_list_that_was_given() -> None:
    body = brick(np.repeat(CORNERS, 2, axis=0) + np.tile([[0.0, 0.0, 0.0], [1e-9, 0.0, 0.0]], (8, 1)))
    plain, told = (
        sampled_toss(
            each,
            THROWN,
            world(each),
            covariance=1e-6 * np.eye(12),
            count=8,
            restitution_law=RestitutionLaw.POISSON,
            horizon=2.0,
        )
        for each in (brick(CORNERS), body)
    )
    assert [branch.corner for branch in told.branches] == [
        2 * branch.corner if branch.corner >= 0 else -1 for branch in plain.branches
    ]


@seeds(range(12), slow=range(12, 600))
def test_two_corners_in_place_of_each_at_any_distance_come_to_rest(seed: int) -> None:
    """From one corner to two that are seen, over all sizes between.

    They were held together where one was higher by the tolerance, which turned the body over by that angle.
    """
    chance = np.random.default_rng(seed)
    apart = 10.0 ** chance.uniform(-13.0, -2.3)
    size = chance.uniform(0.05, 0.15, 3)
    away = chance.normal(size=(8, 3))
    corners = box_vertices(size)
    other = corners + apart * away / np.linalg.norm(away, axis=1, keepdims=True)
    q = chance.normal(size=4)
    thrown = BodyState(
        p_WB_W=[0, 0, 0.3],
        q_WB=q / np.linalg.norm(q),
        v_WB_W=chance.normal(size=3),
        w_WB_W=5.0 * chance.normal(size=3),
    )
    body = brick(np.concatenate([corners, other]), size)
    went = toss(body, thrown, world(body), max_alternatives=0)
    assert went.end is TossEnd.RESTS
    heights = (went.state.p_WB_W + body.shape.vertices @ went.state.R_WB.T)[:, 2]
    assert -2.0 * SAME_CORNER < heights.min() < 2.0 * SAME_CORNER
