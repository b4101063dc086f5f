# SPDX-License-Identifier: Apache-2.0
"""Tosses among one to four flats: each comes to an end, gains no energy, and stays out of the flats.

The whole sweep has 10,000 tosses in blocks of a hundred:

    pytest -m "slow or not slow" test/toss/test_among_flats.py

A part is named by a block, as in `test/toss/test_among_flats.py::test_tosses_end[slow17]`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from contact_dynamics import Body, BodyState, Contact, ContactSet, Surface, World, inertia
from contact_dynamics.contact_modes import SpatialContactProblem, contact_modes
from contact_dynamics.shapes import capsule, polyhedron, rounded, sphere
from contact_dynamics.toss import Toss, TossEnd, toss
from sweeps import seeds

if TYPE_CHECKING:
    from numpy.typing import NDArray

G = 9.81
BLOCK = 10
HORIZON = 30.0
ROUND_HORIZON = 3.0  # s, since a ball in a groove rolls on
DEEPEST = 1e-9  # m
UP = [0.0, 0.0, 1.0]
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


def unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    return vector / np.linalg.norm(vector)


def leaning(azimuth: float, angle: float) -> list[float]:
    """The normal of a flat that leans from the horizontal by an angle, rad, towards an azimuth."""
    return [math.cos(azimuth) * math.sin(angle), math.sin(azimuth) * math.sin(angle), math.cos(angle)]


def drawn_normals(rng: np.random.Generator, count: int) -> list[list[float]]:
    """Floors, slopes, grooves, walls, corners of rooms, troughs, funnels, and boxes without a lid."""
    turn = rng.uniform(0.0, 2.0 * math.pi) if rng.random() < 0.5 else 0.0
    wall = 0.5 * math.pi
    slope = 0.25 * math.pi if rng.random() < 0.3 else rng.uniform(0.2, 1.4)
    lean, apart = rng.uniform(0.0, 0.6), rng.uniform(0.5, 1.0) * math.pi
    around = [turn + 2.0 * math.pi * k / max(count, 1) + rng.uniform(-0.3, 0.3) for k in range(count)]
    groove = [leaning(turn, slope), leaning(turn + math.pi, slope)]
    kinds = {
        1: [[UP], [leaning(turn, lean)]],
        2: [groove, [UP, leaning(turn, wall)], [leaning(turn, 2.0 * lean), leaning(turn + apart, slope)]],
        3: [
            [UP, leaning(turn, wall), leaning(turn + wall, wall)],
            [UP, leaning(turn, 1.4 - lean), leaning(turn + math.pi, 1.4 - lean)],
            [leaning(azimuth, slope) for azimuth in around],
        ],
        4: [
            [*groove, leaning(turn + wall, wall), leaning(turn - wall, wall)],
            [UP, *(leaning(turn + k * wall, wall) for k in range(3))],
            [leaning(azimuth, slope) for azimuth in around],
        ],
    }[count]
    return kinds[int(rng.integers(len(kinds)))]


def drawn_points(rng: np.random.Generator) -> NDArray[np.float64]:
    """Cubes, boxes, rods, tetrahedra, octahedra, prisms and hulls of drawn points."""
    n, high, wide = int(rng.integers(3, 9)), rng.uniform(0.01, 0.1), rng.uniform(0.03, 0.08)
    angles = 2.0 * math.pi * np.arange(n) / n
    ring = wide * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(n)])
    kinds: list[NDArray[np.float64]] = [
        0.05 * CORNERS,
        rng.uniform(0.02, 0.1, 3) * CORNERS,
        rng.uniform([0.1, 0.01, 0.01], [0.2, 0.02, 0.02]) * CORNERS,
        0.06 * CORNERS[[0, 3, 5, 6]],
        0.08 * np.vstack([np.eye(3), -np.eye(3)]),
        np.vstack([ring + high * np.array(UP), ring - high * np.array(UP)]),
        0.08 * rng.normal(size=(int(rng.integers(4, 11)), 3)),
    ]
    return kinds[int(rng.integers(len(kinds)))]


def drawn(seed: int) -> tuple[Body, BodyState, World]:
    """Return a body, its throw, and flats. Half of the throws have components of few digits.

    Where the flats have no lowest place, they are smooth, so that bodies slide on. A body that tumbles down a
    slope for 30 s would strike it thousands of times.
    """
    rng = np.random.default_rng(seed)
    points = drawn_points(rng)
    body = Body.of("body", inertia.convex_hull(points, density=500.0), shape_F=polyhedron(points))
    count = int(rng.integers(1, 5))
    normals = drawn_normals(rng, count)
    frictions = rng.choice([0.0, 0.05, 0.2, 0.5, 1.0, 1.5], size=count, p=[0.04, 0.16, 0.2, 0.25, 0.2, 0.15])
    restitutions = rng.choice([0.0, 0.1, 0.3, 0.6, 0.8], size=count, p=[0.4, 0.2, 0.2, 0.1, 0.1])
    if rng.random() < 0.5:
        frictions[:], restitutions[:] = frictions[0], restitutions[0]
    if nnls(np.array(normals).T, np.array(UP))[1] > 1e-9:
        frictions, restitutions = np.minimum(frictions, 0.05), np.zeros(count)
    reach = float(np.linalg.norm(body.vertices_B, axis=1).max())
    apart = rng.uniform(0.0, 0.3, count) if rng.random() < 0.5 else np.full(count, rng.uniform(0.0, 0.3))
    surfaces = [
        Surface(
            name=f"flat {k}",
            p_WS_W=-(reach + 1e-3 + apart[k]) * unit(np.array(normal)),
            normal_W=unit(np.array(normal)),
            friction=float(frictions[k]),
            restitution=float(restitutions[k]),
        )
        for k, normal in enumerate(normals)
    ]
    if rng.random() < 0.5:
        q, v, w = rng.normal(size=4), rng.normal(size=3), 5.0 * rng.normal(size=3)
    else:
        q, v, w = rng.integers(-2, 3, 4) + 0.0, 0.5 * rng.integers(-2, 3, 3), 1.0 * rng.integers(-2, 3, 3)
        q = q if q.any() else np.array([0.0, 0.0, 0.0, 1.0])
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=unit(q), v_WB_W=v, w_WB_W=w)
    return body, state, World(surfaces=tuple(surfaces), gravity_W=[0, 0, -G])


def drawn_round(seed: int) -> tuple[Body, BodyState, World]:
    """Balls, unbalanced ones, capsules, cubes and hulls with round corners, thrown as the others are."""
    _, state, world = drawn(seed)
    rng = np.random.default_rng([seed, 1])
    radius = rng.uniform(0.01, 0.05)
    length = radius * rng.uniform(0.2, 6.0)
    shape, mass = [
        (sphere(radius), inertia.sphere(radius, density=500.0)),
        (sphere(radius), inertia.ellipsoid([radius, 0.9 * radius, 0.7 * radius], density=500.0)),
        (capsule(radius, length), inertia.capsule(radius, length, density=500.0)),
        (rounded(polyhedron(0.04 * CORNERS), 0.2 * radius), inertia.box([0.1, 0.1, 0.1], density=500.0)),
        (
            rounded(polyhedron(0.05 * rng.normal(size=(6, 3))), 0.2 * radius),
            inertia.sphere(0.05, density=500.0),
        ),
    ][int(rng.integers(5))]
    body = Body.of("body", mass, shape_F=shape)
    reach = float(np.linalg.norm(body.shape.vertices, axis=1).max()) + body.shape.rounding
    surfaces = [
        replace(flat, p_WS_W=-(reach + 1e-3 + rng.choice([0.0, 0.2]) * rng.random()) * flat.normal_W)
        for flat in world.surfaces
        if isinstance(flat, Surface)
    ]
    return body, state, replace(world, surfaces=tuple(surfaces))


def corners_at(body: Body, p: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
    corners: NDArray[np.float64] = p + body.shape.vertices @ Rotation.from_quat(q).as_matrix().T
    return corners


def check_ends_well(body: Body, state: BodyState, world: World, horizon: float = HORIZON) -> Toss:
    """Check all that has to hold of a toss, by the motion that it returns."""
    went = toss(body, state, world, horizon=horizon, max_alternatives=0)
    assert went.end in {TossEnd.RESTS, TossEnd.HORIZON}
    mass = body.mass_properties
    begun = [*went.starts, *(event.seconds for event in went.events)]
    looked = np.unique([*begun, *np.linspace(0.0, went.seconds, 200)])
    moved = went.at(looked)
    energies = []
    for p, q, v, w in zip(moved.p_WB_W, moved.q_WB, moved.v_WB_W, moved.w_WB_W, strict=True):
        w_B = Rotation.from_quat(q).as_matrix().T @ w
        energies.append(0.5 * mass.mass * v @ v + 0.5 * w_B @ mass.I_B @ w_B + mass.mass * G * p[2])
        corners = corners_at(body, p, q)
        for flat in world.surfaces:
            assert isinstance(flat, Surface)
            assert flat.gaps(corners).min() - body.shape.rounding >= -DEEPEST
    # Steps may be off by 1e-7 m/s, and within them some 1e-6 m/s.
    size = float(np.ptp(energies)) + mass.mass * G * 0.1
    assert float(np.diff(energies).max(initial=0.0)) <= 1e-5 * size
    if went.end == TossEnd.RESTS:
        check_rests(body, went.state, world)
    else:
        check_moves(went, world, horizon)
    return went


def check_rests(body: Body, state: BodyState, world: World) -> None:
    """`contact_modes` finds that the body may stay where it is, with contacts found from the shape alone."""
    corners = corners_at(body, state.p_WB_W, state.q_WB)
    rounding = body.shape.rounding
    reach = float(np.linalg.norm(body.shape.vertices, axis=1).max()) + rounding
    contacts = [
        Contact(
            p_WC_W=corner - rounding * flat.normal_W,
            normal_W=flat.normal_W,
            friction=flat.friction,
            restitution=0.0,
        )
        for flat in world.surfaces
        if isinstance(flat, Surface)
        for corner, gap in zip(corners, flat.gaps(corners), strict=True)
        if gap - rounding <= 1e-6
    ]
    answer = contact_modes(
        SpatialContactProblem(
            body=body.mass_properties,
            state=state,
            contacts=ContactSet.of(contacts),
            force_W=body.mass_properties.mass * world.gravity_W,
        )
    )
    least = min(
        float(np.abs(mode.acceleration_W).max() + reach * np.abs(mode.angular_acceleration_W).max())
        for mode in answer.modes
    )
    assert least <= 1e-5 * G


def check_moves(went: Toss, world: World, horizon: float) -> None:
    """A body that does not rest is in motion, by far more than rounding.

    Without friction, what one wall after another takes may leave it any speed (seed 11129: 3e-6 m/s).
    """
    slides = all(isinstance(flat, Surface) and flat.friction == 0.0 for flat in world.surfaces)
    speed = np.linalg.norm(went.state.v_WB_W) + 0.1 * np.linalg.norm(went.state.w_WB_W)
    assert speed > (1e-9 if slides else 1e-4)
    assert went.seconds == horizon


@seeds(range(BLOCK), slow=range(BLOCK, 1000 * BLOCK))
def test_tosses_end(seed: int) -> None:
    check_ends_well(*drawn(seed))


@seeds(range(BLOCK), slow=range(BLOCK, 100 * BLOCK))
def test_tosses_of_round_bodies_end(seed: int) -> None:
    check_ends_well(*drawn_round(seed), horizon=ROUND_HORIZON)


def test_a_body_that_only_forces_that_pull_would_hold_does_not_rest() -> None:
    """A prism in a groove, with an edge on one side and its base, some 1e-7 m off flush, on the other."""
    check_ends_well(*drawn(2054))


def test_a_corner_that_comes_down_and_leaves_within_a_step_is_seen() -> None:
    """It had been 0.15 mm deep in a flat."""
    check_ends_well(*drawn_round(202), horizon=ROUND_HORIZON)


def test_a_body_that_changes_its_contacts_again_and_again_goes_on() -> None:
    """It slides on one side of a groove and touches the other, and had 10,000 new modes, 20 us each."""
    check_ends_well(*drawn(6737))
