# SPDX-License-Identifier: Apache-2.0
"""The map of modes over applied wrenches in space beside the modes themselves, and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from contact_dynamics import BodyState, ContactSet, MassProperties, SpatialContactProblem, mode_margins
from contact_dynamics.contact_modes import SpatialWrenchSet, contact_modes, wrench_sets
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_modes.evidence import spatial_problem
from sweeps import seeds

BODY = MassProperties(mass=2.0, I_B=np.diag([0.3, 0.4, 0.5]))
LENGTH = 0.45  # m, about the radius of gyration
CLEAR = 1e-5  # N: a thousand times the strictness asked of 1e-8 of wrenches of some N; nearer is not judged
WEIGHT = 20.0
DOWN = np.array([0.0, 0.0, -WEIGHT, 0.0, 0.0, 0.0])
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


def feet(height: float, friction: float) -> ContactSet:
    corners = [(-1.0, -0.5), (1.0, -0.5), (1.0, 0.5), (-1.0, 0.5)]
    return contact_set([(x, y, -height) for x, y in corners], [(0, 0, 1)] * 4, [friction] * 4)


def check(now: BodyState, contacts: ContactSet, wrench: np.ndarray, facets: int) -> int:
    """Compare the sets that hold a wrench with its modes, one for one; return how many there are."""
    asked = {"force_W": wrench[:3], "torque_W": wrench[3:], "friction_facets": facets}
    sets = wrench_sets(SpatialContactProblem(body=BODY, state=now, contacts=contacts, **asked))
    depths = [one.depth(wrench, LENGTH) for one in sets]
    if any(abs(depth) < CLEAR for depth in depths):
        return 0
    answer = contact_modes(
        SpatialContactProblem(body=BODY, state=now, contacts=contacts, sharpen=False, **asked)
    )

    def shown(mode: str) -> str:  # a frictionless contact that stays is f or c by its acceleration
        return "".join(
            "c" if letter == "f" and mu == 0.0 else letter
            for letter, mu in zip(mode, contacts.frictions, strict=True)
        )

    holding = [one for one, depth in zip(sets, depths, strict=True) if depth > 0.0]
    assert sorted(one.mode for one in holding) == sorted(shown(mode.mode) for mode in answer.modes)
    for mode in answer.modes:
        alike = [one for one in holding if one.mode == shown(mode.mode)]
        assert any(slides_within(one, mode.tangential_directions_W, contacts.normals_W) for one in alike)
    return len(holding)


def slides_within(one: SpatialWrenchSet, ways: np.ndarray, normals: np.ndarray) -> bool:
    """Say whether each contact that begins to slide does so between the set's two directions."""
    after = np.sum(normals * np.cross(one.sliding_from_W, ways), axis=1)
    before = np.sum(normals * np.cross(ways, one.sliding_to_W), axis=1)
    ahead = np.sum(ways * (one.sliding_from_W + one.sliding_to_W), axis=1)
    asked = one.sliding_from_W.any(axis=1)
    return bool((after > -1e-6).all() and (before > -1e-6).all() and (ahead[asked] > 0.0).all())


WHOLE = st.integers(-1, 1)
VECTOR = st.tuples(WHOLE, WHOLE, WHOLE)


@settings(max_examples=10)
@given(
    points=st.lists(VECTOR, min_size=2, max_size=2),
    normals=st.lists(VECTOR.filter(any), min_size=2, max_size=2),
    frictions=st.lists(st.sampled_from([0.0, 0.25, 1.0, 2.5]), min_size=2, max_size=2),
    seed=st.integers(0, 10_000),
    facets=st.sampled_from([3, 4, 5]),
)
def test_sets_hold_what_brings_their_modes_about_and_nothing_else(
    points: list, normals: list, frictions: list, seed: int, facets: int
) -> None:
    # Small whole numbers make coincident contacts, opposite normals, and bodies that are held fast.
    wrench = 3.0 * np.random.default_rng(seed).normal(size=6)
    check(state(), contact_set(points, normals, frictions), wrench, facets)


@settings(max_examples=15)
@given(seed=st.integers(0, 10_000), kind=st.sampled_from(["turns", "pivots", "slides"]))
def test_the_same_of_bodies_that_move(seed: int, kind: str) -> None:
    chance = np.random.default_rng(seed)
    centre, w = 0.5 * chance.normal(size=3), chance.normal(size=3)
    on_axis = [centre + w * chance.normal() for _ in range(2)]
    points, normals = on_axis, list(chance.normal(size=(2, 3)))
    v = -np.cross(w, centre)
    if kind == "turns":  # the first one slides around the axis, which its normal meets
        points = [centre + chance.normal(size=3), on_axis[1]]
        normals[0] = centre + w * chance.normal() - points[0]
    elif kind == "slides":
        v, w = np.cross(normals[0], normals[1]), NONE
    check(state(v, w), contact_set(points, normals, [0.5, 1.5]), 3.0 * chance.normal(size=6), 4)


@seeds(range(2), slow=range(2, 4))
def test_three_contacts_with_much_friction(seed: int) -> None:
    chance = np.random.default_rng(seed)
    contacts = contact_set(
        list(chance.normal(size=(3, 3))), list(chance.normal(size=(3, 3))), [1.0, 2.5, 2.5]
    )
    check(state(), contacts, 3.0 * chance.normal(size=6), 3)


def test_draws_reach_ambiguous_and_inconsistent_wrenches() -> None:
    numbers = set()
    for seed in range(12):
        chance = np.random.default_rng(seed)
        normals = chance.normal(size=(2, 3))
        contacts = contact_set(list(chance.normal(size=(2, 3))), list(normals), [2.5, 2.5])
        wrench = 3.0 * chance.normal(size=6)
        numbers.add(min(2, check(state(np.cross(normals[0], normals[1])), contacts, wrench, 4)))
    assert numbers == {0, 1, 2}


def drawn_wrenches(count: int) -> np.ndarray:
    chance = np.random.default_rng(1)
    drawn = chance.normal(size=(count, 6)) * [5.0, 5.0, 10.0, 5.0, 5.0, 5.0]
    return drawn + chance.choice([0.0, 1.0], size=(count, 1)) * DOWN


def test_a_block_on_a_floor_has_a_mode_under_every_wrench() -> None:
    # Too little friction to jam it. How four feet share its weight as it turns is open, and so is the mode.
    sets = wrench_sets(spatial_problem(BODY, state(), feet(0.2, 0.4), (0.0, 0.0, 0.0), friction_facets=4))
    reached = set()
    for wrench in drawn_wrenches(300):
        depths = np.array([one.depth(wrench, LENGTH) for one in sets])
        assert depths.max() > -1e-9 * WEIGHT
        reached.add(sets[int(depths.argmax())].mode)
    assert {"ssss", "ffff", "cccc"} <= reached
    assert len(reached) > 6


def test_one_foot_has_one_mode_under_every_wrench() -> None:
    sets = wrench_sets(
        spatial_problem(
            BODY,
            state(),
            contact_set([(0.3, 0.1, -0.2)], [(0, 0, 1)], [0.4]),
            (0.0, 0.0, 0.0),
            friction_facets=4,
        )
    )
    reached = set()
    for wrench in drawn_wrenches(300):
        holding = [i for i, one in enumerate(sets) if one.depth(wrench, LENGTH) > -1e-9 * WEIGHT]
        assert len(holding) == 1
        reached |= {*holding}
    assert len(reached) == len(sets) == 10


@pytest.mark.parametrize(
    ("now", "contacts"),
    [
        (state(), feet(0.3, 0.5)),
        (state(np.array([1.0, 0.5, 0.0])), feet(0.3, 0.5)),
        (
            state(w=np.array([0.0, 0.0, 2.0])),
            contact_set([(0, 0, 1), (0, 1, -1)], [(1, 0, 1), (0, -1, 1)], [0.5] * 2),
        ),
    ],
    ids=["rests", "slides", "turns"],
)
def test_both_forms_are_one_set(now: BodyState, contacts: ContactSet) -> None:
    chance = np.random.default_rng(0)
    sets = wrench_sets(spatial_problem(BODY, now, contacts, (0.0, 0.0, 0.0), friction_facets=3))
    assert sets
    for one in sets:
        shares = chance.uniform(size=len(one.vertices))
        mixture = (
            shares / shares.sum() @ one.vertices + chance.uniform(size=len(one.generators)) @ one.generators
        )
        assert one.depth(mixture, LENGTH) > -1e-9 * (1.0 + np.abs(mixture).max())
        # What lies inside all half-spaces is made by the generators: walk out from the mixture.
        way = chance.normal(size=6)
        rates = one.half_spaces[:, :6] @ way
        rooms = one.half_spaces[:, 6] - one.half_spaces[:, :6] @ mixture
        reach = min([5.0, *(rooms[rates > 1e-12] / rates[rates > 1e-12])])
        inside = mixture + 0.999 * reach * way
        columns = np.hstack(
            [
                np.vstack([one.vertices.T, np.ones(len(one.vertices))]),
                np.vstack([one.generators.T, np.zeros(len(one.generators))]),
            ]
        )
        assert nnls(columns, np.append(inside, 1.0))[1] < 1e-8 * (1.0 + np.abs(inside).max())


def test_a_block_is_held_up_to_the_side_of_its_pyramid_and_to_its_edges() -> None:
    (held,) = wrench_sets(
        spatial_problem(BODY, state(), feet(0.2, 0.4), (0.0, 0.0, 0.0), friction_facets=4), modes=["ffff"]
    )
    slope = math.atan(0.4 * math.cos(math.pi / 4.0))
    assert held.depth(DOWN, 1e-3) == pytest.approx(
        WEIGHT * math.sin(slope), rel=1e-4
    )  # torques cost nearly all
    (tall,) = wrench_sets(
        spatial_problem(BODY, state(), feet(1.0, 2.0), (0.0, 0.0, 0.0), friction_facets=4), modes=["ffff"]
    )
    assert tall.depth(DOWN, 1e3) == pytest.approx(WEIGHT * 0.5 / 1e3, rel=1e-4)  # they cost next to nothing
    assert held.vertices == pytest.approx(np.zeros((1, 6)))
    assert not held.sliding_from_W.any()


def test_one_foot_has_sets_all_around() -> None:
    foot = contact_set([(0, 0, -1)], [(0, 0, 1)], [0.5])
    sets = wrench_sets(spatial_problem(BODY, state(), foot, (0.0, 0.0, 0.0), friction_facets=4))
    assert [one.mode for one in sets] == ["c"] * 8 + ["f", "s"]
    ranges = [
        (
            math.atan2(one.sliding_from_W[0, 1], one.sliding_from_W[0, 0]),
            math.atan2(one.sliding_to_W[0, 1], one.sliding_to_W[0, 0]),
        )
        for one in sets[:8]
    ]
    widths = sorted((high - low) % (2.0 * math.pi) for low, high in ranges)
    assert widths == pytest.approx([0.0] * 4 + [0.5 * math.pi] * 4)
    assert (
        wrench_sets(spatial_problem(BODY, state(), foot, (0.0, 0.0, 0.0), friction_facets=4), modes=["f"])[
            0
        ].mode
        == "f"
    )
    assert (
        wrench_sets(
            spatial_problem(BODY, state(np.array([1.0, 0.0, 0.0])), foot, (0.0, 0.0, 0.0), friction_facets=4),
            modes=["f"],
        )
        == ()
    )


@seeds(range(3), slow=range(3, 6))
def test_depths_in_pyramids_inside_and_around_the_cones_bound_the_margins(seed: int) -> None:
    wrench = DOWN + np.random.default_rng(seed).normal(size=6)
    wider = 1.0 / math.cos(math.pi / 8)
    for now in (state(), state(np.array([1.0, 2.0, 0.0]))):
        inside, around = (
            spatial_problem(BODY, now, feet(0.2, friction), wrench[:3], wrench[3:], friction_facets=8)
            for friction in (0.4, 0.4 * wider)
        )
        (margin,) = mode_margins(inside, margin_length=LENGTH)
        ((low,), (high,)) = (wrench_sets(one, modes=[margin.mode]) for one in (inside, around))
        if now.v_WB_W.any():  # friction is on an edge, and exact
            assert low.depth(wrench, LENGTH) == pytest.approx(margin.margin, rel=1e-9)
        else:
            assert low.depth(wrench, LENGTH) <= margin.margin * (1.0 + 1e-9)
            assert margin.margin <= high.depth(wrench, LENGTH) * (1.0 + 1e-9)


def test_a_body_that_leaves_and_one_that_approaches() -> None:
    (free,) = wrench_sets(
        spatial_problem(
            BODY, state(np.array([0.0, 0.0, 1.0])), feet(0.2, 0.4), (0.0, 0.0, 0.0), friction_facets=4
        )
    )
    assert (free.mode, len(free.half_spaces), free.depth(DOWN, 1.0)) == ("ssss", 0, math.inf)
    assert (
        wrench_sets(
            spatial_problem(
                BODY, state(np.array([0.0, 0.0, -1.0])), feet(0.2, 0.4), (0.0, 0.0, 0.0), friction_facets=4
            )
        )
        == ()
    )


def test_misuse_is_refused_by_name() -> None:
    with pytest.raises(InvalidFieldError, match=r"modes must be .*, got lll"):
        wrench_sets(
            spatial_problem(BODY, state(), feet(0.2, 0.4), (0.0, 0.0, 0.0), friction_facets=4), modes=["lll"]
        )
    ring = [(math.cos(a), math.sin(a), -1.0) for a in np.linspace(0.0, 6.0, 12)]
    with pytest.raises(TooLargeError, match="sets of planes"):
        wrench_sets(
            spatial_problem(
                BODY,
                state(),
                contact_set(ring, [(0, 0, 1)] * 12, [0.5] * 12),
                (0.0, 0.0, 0.0),
                friction_facets=8,
            )
        )
    with pytest.raises(TooLargeError, match="edges"):
        wrench_sets(spatial_problem(BODY, state(), feet(0.2, 0.4), (0.0, 0.0, 0.0), friction_facets=40))
    with pytest.raises(TooLargeError, match="sets of wrenches"):
        wrench_sets(spatial_problem(BODY, state(), feet(0.2, 0.4), (0.0, 0.0, 0.0), friction_facets=12))


@pytest.mark.parametrize(
    ("corners", "facets"), [(4, 16), (4, 32), (6, 12), (6, 20), (8, 16), (16, 8), (32, 4)]
)
def test_sizes_that_could_never_be_built_are_rejected(corners: int, facets: int) -> None:
    """Ways of sliding are counted until they are too many, which is before any set is built."""
    ring = [(math.cos(a), math.sin(a), -1.0) for a in np.arange(corners) * 2.0 * math.pi / corners]
    around = contact_set(ring, [(0, 0, 1)] * corners, [0.5] * corners)
    with pytest.raises(
        TooLargeError, match=r"at most (2000|10000): fewer contacts, or fewer friction_facets"
    ):
        wrench_sets(spatial_problem(BODY, state(), around, (0.0, 0.0, 0.0), friction_facets=facets))
