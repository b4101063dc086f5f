"""Many rotations at once: the same as one by one."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.poinsot import sensitivity
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, free_motion, rotations_of_many
from oracles.tumbling_draws import draw

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def one(moments: np.ndarray, w: np.ndarray) -> FreeMotion:
    state = BodyState(p_WB_W=np.zeros(3), q_WB=UPRIGHT, v_WB_W=np.zeros(3), w_WB_W=w)
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


def test_more_than_a_chunk() -> None:
    rng = np.random.default_rng(2)
    w = rng.normal(size=(10_000, 3))
    q, w_then = rotations_of_many((1.0, 1.4, 1.9), w, 1.5)
    for part in (slice(0, 10), slice(4090, 4100), slice(9990, None)):
        few, few_then = rotations_of_many((1.0, 1.4, 1.9), w[part], 1.5)
        assert q[part] == pytest.approx(few, abs=1e-14)
        assert w_then[part] == pytest.approx(few_then, abs=1e-14)


def test_none_at_all() -> None:
    q, w_then = rotations_of_many((1.0, 1.4, 1.9), np.zeros((0, 3)), 1.0)
    assert q.shape == (0, 4)
    assert w_then.shape == (0, 3)


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("moments", ((1.0, 1.4), np.ones((2, 3)), 1.0)),
        ("moments", (np.ones((3, 3)), np.ones((2, 3)), 1.0)),
        ("moments", ((1.0, 1.4, 0.0), np.ones((2, 3)), 1.0)),
        ("angular_velocities", ((1.0, 1.4, 1.9), np.ones(3), 1.0)),
        ("angular_velocities", ((1.0, 1.4, 1.9), [[0.0, np.nan, 1.0]], 1.0)),
        ("times", ((1.0, 1.4, 1.9), np.ones((2, 3)), np.ones(3))),
        ("times", ((1.0, 1.4, 1.9), np.ones((2, 3)), np.inf)),
    ],
)
def test_bad_input_is_refused_by_name(field: str, arguments: tuple[object, object, object]) -> None:
    with pytest.raises(InvalidFieldError, match=field):
        rotations_of_many(*arguments)  # type: ignore[arg-type]
