# SPDX-License-Identifier: Apache-2.0
"""Every consistent mode in space, beside a linear program for each combination of letters."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_dynamics import BodyState, ContactSet, MassProperties, ModeVerdict
from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes import contact_modes
from contact_modes.evidence import spatial_problem
from oracles.spatial_modes import consistent_combinations
from sweeps import seeds

BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
NONE = np.zeros(3)


def state(v: np.ndarray = NONE, w: np.ndarray = NONE) -> BodyState:
    return BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=v, w_WB_W=w)


def contact_set(points: list, normals: list, frictions: list) -> ContactSet:
    directions = np.array(normals, dtype=float)
    return ContactSet(
        p_WC_W=np.array(points, dtype=float),
        normals_W=directions / np.linalg.norm(directions, axis=1)[:, None],
        frictions=np.array(frictions, dtype=float),
    )


def check(now: BodyState, contacts: ContactSet, wrench: np.ndarray, facets: int) -> int:
    """Compare letters, and accelerations where they are unique; return the number of modes."""
    answer = contact_modes(
        spatial_problem(BODY, now, contacts, wrench[:3], wrench[3:], friction_facets=facets, sharpen=False)
    )
    r, w = contacts.p_WC_W, now.w_WB_W
    velocities = now.v_WB_W + np.cross(w, r)
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    if np.any(v_n < -1e-9):
        assert answer.verdict == ModeVerdict.IMPACT
        return 0
    touching = np.flatnonzero(v_n <= 1e-9)
    gyroscopic = np.cross(w, BODY.I_B @ w)
    free = wrench[:3] / BODY.mass + np.cross(np.linalg.solve(BODY.I_B, wrench[3:] - gyroscopic), r)
    free = free + np.cross(w, np.cross(w, r))
    edges = []
    for i in touching:
        normal, friction = contacts.normals_W[i], float(contacts.frictions[i])
        slides = velocities[i] - v_n[i] * normal
        speed = float(np.linalg.norm(slides))
        if speed > 1e-9:
            edges.append((normal - friction * slides / speed)[None, :])
        elif friction == 0.0:
            edges.append(normal[None, :])
        else:
            edges.append(linearised_cone(normal, friction, facets, towards=-free[i]))
    expected = consistent_combinations(
        BODY.mass,
        BODY.I_B,
        r=r[touching],
        w=w,
        wrench=wrench,
        normals=contacts.normals_W[touching],
        edges=edges,
    )

    def shown(letters: str) -> str:  # a frictionless contact that stays is f or c by its acceleration
        kept = [letters[i] if contacts.frictions[i] > 0.0 else letters[i].replace("f", "c") for i in touching]
        return "".join(kept)

    assert sorted(shown(mode.mode) for mode in answer.modes) == sorted(letters for letters, _, _ in expected)
    for mode in answer.modes:
        if mode.motion_unique:
            own = np.concatenate([mode.acceleration_W, mode.angular_acceleration_W])
            others = [
                np.concatenate([a, alpha]) for letters, a, alpha in expected if letters == shown(mode.mode)
            ]
            size = 1e-6 * (1.0 + np.abs(own).max() + np.abs(wrench).max())
            assert min(np.abs(other - own).max() for other in others) <= size
    return len(expected)


WHOLE = st.integers(-1, 1)
VECTOR = st.tuples(WHOLE, WHOLE, WHOLE)
FRICTIONS = st.sampled_from([0.0, 0.25, 1.0, 2.5])
FORCES = st.tuples(*[st.integers(-3, 3)] * 6)


@settings(max_examples=8)
@given(
    points=st.lists(VECTOR, min_size=2, max_size=2),
    normals=st.lists(VECTOR.filter(any), min_size=2, max_size=2),
    frictions=st.lists(FRICTIONS, min_size=2, max_size=2),
    wrench=FORCES,
    facets=st.sampled_from([3, 4, 5]),
)
def test_two_contacts_at_whole_places(
    points: list, normals: list, frictions: list, wrench: tuple, facets: int
) -> None:
    # Small whole numbers make coincident contacts, opposite normals and forces on the edge of a cone.
    check(state(), contact_set(points, normals, frictions), np.array(wrench, dtype=float), facets)


@settings(max_examples=2)
@given(
    corners=st.sampled_from(
        [[(0, 1), (1, -1), (-1, -1)], [(-1, 0), (0, 0), (1, 0)], [(1, 1), (1, 1), (-1, 0)]]
    ),
    friction=st.sampled_from([0.25, 1.0]),
    wrench=FORCES,
    height=st.sampled_from([0.2, 1.5]),
)
def test_three_feet_on_a_floor(corners: list, friction: float, wrench: tuple, height: float) -> None:
    points = [(x, y, -height) for x, y in corners]
    pushed = np.array(wrench, dtype=float) - [0.0, 0.0, 4.0, 0.0, 0.0, 0.0]
    check(state(), contact_set(points, [(0, 0, 1)] * 3, [friction] * 3), pushed, 3)


@settings(max_examples=15)
@given(seed=st.integers(0, 10_000), motion=st.sampled_from(["turns", "slides"]))
def test_bodies_that_move(seed: int, motion: str) -> None:
    # About an axis that normals meet, contacts turn without approaching; along it, they slide.
    chance = np.random.default_rng(seed)
    centre, w = chance.normal(size=3), chance.normal(size=3)
    points = [
        centre + chance.normal(size=3),
        centre + w * chance.normal(),
    ]  # the second is on the axis: at rest
    normals = [centre + w * chance.normal() - points[0], chance.normal(size=3)]
    v = -np.cross(w, centre)
    if motion == "slides":
        along = np.cross(normals[0], normals[1])
        v, w = along / np.linalg.norm(along), np.zeros(3)
    contacts = contact_set(points, normals, [0.5, 1.5])
    check(state(v, w), contacts, chance.normal(size=6), 4)


@seeds(range(3), slow=range(3, 6))
def test_bodies_that_pivot_about_an_edge(seed: int) -> None:
    # Both contacts are on the axis, at rest, with centripetal terms; in odd draws a third one turns about it.
    chance = np.random.default_rng(seed)
    centre, w = 0.4 * chance.normal(size=3), chance.normal(size=3)
    points = [centre + w * chance.normal(), centre + w * chance.normal()]
    normals = [chance.normal(size=3), chance.normal(size=3)]
    if seed % 2:
        points.append(centre + chance.normal(size=3))
        normals.append(centre + w * chance.normal() - points[2])
    contacts = contact_set(points, normals, [0.5, 1.0, 0.5][: len(points)])
    check(state(-np.cross(w, centre), w), contacts, 3.0 * chance.normal(size=6), 3)


@pytest.mark.parametrize("moving", [0.0, 1.0])
def test_ambiguous_and_inconsistent_sets(moving: float) -> None:
    # High friction makes both common: in the first draws, two of three answers at rest, all three in motion.
    numbers = set()
    for seed in range(20) if moving else (3, 5, 8):
        chance = np.random.default_rng(seed)
        points, normals = chance.normal(size=(2, 3)), chance.normal(size=(2, 3))
        contacts = contact_set(list(points), list(normals), [2.5, 2.5])
        v = moving * np.cross(contacts.normals_W[0], contacts.normals_W[1])
        numbers.add(min(2, check(state(v), contacts, np.append(chance.normal(size=3), NONE), 4)))
    assert numbers == ({0, 1, 2} if moving else {1, 2})


@seeds((), slow=range(40))
def test_drawn_sets_of_three(seed: int) -> None:
    chance = np.random.default_rng(seed)
    points = chance.integers(-1, 2, size=(3, 3)) if seed % 2 else chance.normal(size=(3, 3))
    normals = np.array([0.0, 0.0, 1.0]) + 0.7 * chance.normal(size=(3, 3))
    frictions = chance.choice([0.3, 1.0, 2.5], size=3)
    check(
        state(),
        contact_set(list(points), list(normals), list(frictions)),
        chance.normal(size=6),
        3 + seed % 2,
    )
