# SPDX-License-Identifier: Apache-2.0
"""Many rotations at once: the same as one by one."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, free_motion, rotations_of_many, states_of_many
from contact_dynamics.tumbling.poinsot_construction import sensitivity
from oracles.tumbling_draws import draw

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def one(moments: np.ndarray, w: np.ndarray) -> FreeMotion:
    state = BodyState(p_WB_W=np.zeros(3), q_WB=UPRIGHT, w_WB_W=w)
    return free_motion(MassProperties(mass=1.0, I_B=np.diag(moments)), state)


def check(moments: np.ndarray, w: np.ndarray, seconds: np.ndarray) -> None:
    q, w_then = rotations_of_many(moments, w, seconds)
    each = np.broadcast_to(moments, w.shape)
    for i, t in enumerate(np.broadcast_to(seconds, len(w)).tolist()):
        motion = one(each[i], w[i])
        rate = float(np.linalg.norm(w[i]))
        expected = motion.sample(t)
        growth = min(1.0 + sensitivity(motion) if rate else 1.0, 1e5)
        limit = 5e-15 * (1.0 + rate * abs(t)) * growth
        attitude = Rotation.from_quat(expected.q_WB)
        assert abs(np.linalg.norm(q[i]) - 1.0) <= 1e-15
        assert (attitude.inv() * Rotation.from_quat(q[i])).magnitude() <= limit
        w_B = attitude.inv().apply(expected.w_WB_W)
        assert w_then[i] == pytest.approx(w_B, abs=limit * max(rate, 1e-300))


def test_every_order_of_axes_and_every_octant() -> None:
    signs = np.array(list(itertools.product([-1.0, 1.0], repeat=3)))
    for moments in itertools.permutations((1.0, 1.4, 1.9)):
        for w in ((0.3, 0.5, 1.2), (1.3, 0.5, 0.2), (0.02, 1.0, 0.03)):
            check(np.array(moments), signs * np.array(w), np.array(2.7))


def test_steady_spins() -> None:
    axes = np.vstack([np.eye(3), -2.0 * np.eye(3), np.zeros((1, 3))])
    check(np.array([1.0, 1.4, 1.9]), axes, np.array(3.0))
    check(np.array([1.0, 1.0, 1.0]), np.array([[0.3, 0.5, -1.2], [0.0, 0.0, 1.0]]), np.array(3.0))
    check(np.array([1.0, 1.0, 1.6]), np.array([[0.3, 0.5, 0.0], [0.3, -0.5, 1.0]]), np.array(3.0))
    check(np.array([0.5, 1.0, 1.0]), np.array([[0.0, 0.5, 0.7], [0.3, -0.5, 1.0]]), np.array(3.0))


@pytest.mark.parametrize("moments", [(1.0, 1.0, 1.6), (0.4, 1.0, 1.0), (1.0, 1.0 + 1e-9, 1.6)])
@pytest.mark.parametrize("count", [1, 3])
def test_symmetric_bodies_among_themselves(moments: tuple[float, ...], count: int) -> None:
    w = np.array([[0.3, -0.5, 1.2], [1.0, 2.0, -0.1], [-3.0, 0.2, 0.7]])[:count]
    check(np.array(moments), w, np.array(3.0))


def test_the_separatrix() -> None:
    w = np.array([[2.0, -0.5, 1.0], [-2.0, -0.5, 1.0], [2.0, 0.0, -1.0]])
    check(np.array([3.0, 4.0, 6.0]), w, np.array([2.0, -3.0, 1.0]))


def test_drawn_bodies_each_at_its_time() -> None:
    draws = [draw(np.random.default_rng(seed)) for seed in range(400)]
    aligned = [d for d in draws if not d.I_B[np.triu_indices(3, 1)].any()]
    mild = [d for d in aligned if d.body != "needle" and d.spin in ("generic", "axis")]
    assert len(mild) > 50
    w = np.array([Rotation.from_quat(d.q_WB).inv().apply(d.w_WB_W) for d in mild])
    rng = np.random.default_rng(1)
    check(
        np.array([np.diag(d.I_B) for d in mild]),
        w,
        rng.uniform(-20.0, 20.0, len(mild)) / np.linalg.norm(w, axis=1),
    )


def many(count: int, seed: int) -> dict[str, np.ndarray]:
    """States and bodies of all shapes and attitudes, none near the separatrix."""
    rng = np.random.default_rng(seed)
    spreads = rng.uniform(0.1, 1.0, (count, 3))
    spreads[::4] = spreads[::4, :1]  # spheres to rounding
    spreads[1::4, 1] = spreads[1::4, 0]  # symmetric to rounding
    R = Rotation.random(count, random_state=seed).as_matrix()
    moments = spreads.sum(axis=1, keepdims=True) - spreads
    I_B = np.einsum("nij,nj,nkj->nik", R, moments, R)
    return {
        "I_B": 0.5 * (I_B + I_B.transpose(0, 2, 1)),
        "p_WB_W": rng.normal(size=(count, 3)),
        "q_WB": Rotation.random(count, random_state=seed + 1).as_quat(),
        "v_WB_W": rng.normal(size=(count, 3)),
        "w_WB_W": rng.normal(size=(count, 3)) * 10.0 ** rng.uniform(-3.0, 3.0, (count, 1)),
    }


def test_states_of_many_bodies_are_those_of_each() -> None:
    bodies = many(80, 5)
    rates = np.linalg.norm(bodies["w_WB_W"], axis=1)
    seconds = np.random.default_rng(6).uniform(-20.0, 20.0, 80) / rates
    found = states_of_many(**bodies, seconds=seconds)
    np.testing.assert_array_equal(found.seconds, seconds)
    np.testing.assert_allclose(np.linalg.norm(found.q_WB, axis=1), 1.0, rtol=0.0, atol=1e-15)
    for i, t in enumerate(seconds.tolist()):
        state = {name: values[i] for name, values in bodies.items() if name != "I_B"}
        motion = free_motion(MassProperties(mass=1.0, I_B=bodies["I_B"][i]), BodyState(**state))
        single = motion.state_at(t)
        limit = 5e-15 * (1.0 + rates[i] * abs(t)) * min(1.0 + sensitivity(motion), 1e5)
        turn = Rotation.from_quat(single.q_WB).inv() * Rotation.from_quat(found.q_WB[i])
        assert turn.magnitude() <= limit
        assert found.w_WB_W[i] == pytest.approx(single.w_WB_W, abs=limit * rates[i])
        np.testing.assert_array_equal(found.p_WB_W[i], single.p_WB_W)
        np.testing.assert_array_equal(found.v_WB_W[i], single.v_WB_W)


def test_each_body_may_have_a_gravity_of_its_own() -> None:
    bodies, pulls = many(5, 8), np.random.default_rng(9).normal(0.0, 10.0, (5, 3))
    together = states_of_many(**bodies, seconds=0.3, gravity_W=pulls)
    for i, pull in enumerate(pulls):
        rows = {name: values[i : i + 1] for name, values in bodies.items()}
        alone = states_of_many(**rows, seconds=0.3, gravity_W=pull)
        np.testing.assert_array_equal(together.p_WB_W[i], alone.p_WB_W[0])
        np.testing.assert_array_equal(together.v_WB_W[i], alone.v_WB_W[0])
    with pytest.raises(InvalidFieldError, match="gravity_W"):
        states_of_many(**bodies, seconds=0.3, gravity_W=pulls[:4])


def test_one_body_in_many_states() -> None:
    bodies = many(20, 7)
    one = {**bodies, "I_B": bodies["I_B"][2]}
    each = {**bodies, "I_B": np.tile(bodies["I_B"][2], (20, 1, 1))}
    none = {"gravity_W": (0.0, 0.0, 0.0)}
    found, expected = states_of_many(**one, seconds=0.3, **none), states_of_many(**each, seconds=0.3, **none)
    np.testing.assert_array_equal(found.q_WB, expected.q_WB)
    np.testing.assert_array_equal(found.v_WB_W, one["v_WB_W"])
    nobody = {name: values[:0] for name, values in bodies.items()}
    empty = states_of_many(**nobody, seconds=1.0)
    assert empty.q_WB.shape == (0, 4)


@pytest.mark.parametrize(
    ("field", "spoil"),
    [
        ("^I_B ", {"I_B": np.diag([1.0, 1.0, -1.0])}),
        ("^I_B ", {"I_B": np.eye(3) + np.eye(3, k=1)}),
        ("^I_B ", {"I_B": np.ones((2, 3, 3))}),
        ("^p_WB_W must be .*, got 2 rows", {"p_WB_W": np.zeros((2, 3))}),
        ("^seconds must be .*, got 2 rows", {"seconds": np.zeros(2)}),
        ("^I_B must be .*, got principal moments", {"I_B": np.diag([1.0, 1.0, 3.0])}),
    ],
)
def test_states_that_are_none_are_refused_by_name(field: str, spoil: dict[str, object]) -> None:
    with pytest.raises(InvalidFieldError, match=field):
        states_of_many(**{**many(3, 8), "seconds": 1.0, **spoil})


def test_more_than_a_chunk() -> None:
    rng = np.random.default_rng(2)
    w = rng.normal(size=(10_000, 3))
    q, w_then = rotations_of_many((1.0, 1.4, 1.9), w, 1.5)
    for part in (slice(0, 10), slice(4090, 4100), slice(9990, None)):
        few, few_then = rotations_of_many((1.0, 1.4, 1.9), w[part], 1.5)
        assert q[part] == pytest.approx(few, abs=1e-14)
        assert w_then[part] == pytest.approx(few_then, abs=1e-14)
