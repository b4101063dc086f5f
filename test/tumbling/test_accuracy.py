# SPDX-License-Identifier: Apache-2.0
"""Attitude beside 50 digits, for every kind of body and up to 1e9 revolutions.

Those digits, in turn, beside a Taylor series.
"""

from __future__ import annotations

import itertools
import math
from decimal import Decimal

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.covariance import covariance_along
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, Regime, free_motion
from contact_dynamics.tumbling.flips import next_flips
from contact_dynamics.tumbling.poinsot_construction import poinsot, rolling_curves
from contact_dynamics.tumbling.polhode import Tumble
from oracles.tumbling_draws import BODIES, SPINS, Draw, draw
from oracles.tumbling_exact import ExactMotion, rotation_matrix
from oracles.tumbling_taylor import integrated
from sweeps import seeds
from tumbling.known_motions import MOTIONS, motion_of

TARGET = 5e-15
"""rad, a few tens of last bits. Measured: 1.2e-15."""

MOMENTS = (1.0, 1.4, 1.9)
UNIT = 1e-15
CONSERVED = 1e-13


def exact(motion: FreeMotion) -> ExactMotion:
    return ExactMotion(motion.body.I_B.tolist(), motion.state.q_WB.tolist(), motion.state.w_WB_W.tolist())


def motion_from(drawn: Draw) -> FreeMotion:
    state = BodyState(p_WB_W=np.zeros(3), q_WB=drawn.q_WB, w_WB_W=drawn.w_WB_W)
    return free_motion(MassProperties(mass=1.0, I_B=drawn.I_B), state)


def interesting_times(motion: FreeMotion, rng: np.random.Generator) -> list[float]:
    """Return now, a time in the first revolutions, one up to 1e9 of them off, and one near a flip there."""
    revolution = 2.0 * math.pi / float(np.linalg.norm(motion.state.w_WB_W))
    far = float(rng.choice([-1.0, 1.0]) * revolution * 10.0 ** rng.uniform(0.0, 9.0))
    times = [0.0, revolution * rng.uniform(-3.0, 3.0), far]
    rotation = motion.rotation
    if isinstance(rotation, Tumble) and rotation.m1 != 0:
        between = Decimal(math.pi) / (rotation.quarter * rotation.omega_p)
        flip = float(round(Decimal(far) / between) * between - rotation.u0 / rotation.omega_p)
        if abs(flip) < 2e9 * revolution:
            times.append(flip + revolution * rng.normal())
    return times


def errors(motion: FreeMotion, times: list[float]) -> list[float]:
    """Return the errors of attitude, rad, on both paths, and check that each answer is consistent."""
    truth = exact(motion)
    trajectory = motion.at(times)
    found = []
    for i, t in enumerate(times):
        one = motion.sample(t)
        found += truth.errors(t, trajectory.q_WB[i], one.q_WB)
        for q, w in ((trajectory.q_WB[i], trajectory.w_WB_W[i]), (one.q_WB, one.w_WB_W)):
            assert abs(math.sqrt(math.fsum(x * x for x in q)) - 1.0) <= UNIT
            _check_conserved(motion, q, w)
    return found


def _check_conserved(motion: FreeMotion, q: object, w: object) -> None:
    """L in the world and T are as at first, as far as numbers rounded to doubles can say of a needle."""
    with mpmath.workdps(40):
        I_B = mpmath.matrix(motion.body.I_B.tolist())

        def momentum(q: object, w: object) -> tuple[mpmath.matrix, mpmath.mpf]:
            R = rotation_matrix(q)
            w_W = mpmath.matrix([mpmath.mpf(x) for x in w])
            L = R * I_B * R.T * w_W
            return L, (L.T * w_W)[0]

        L0, T0 = momentum(motion.state.q_WB, motion.state.w_WB_W)
        L, T = momentum(q, w)
        size = mpmath.norm(L0)
        moments = np.linalg.eigvalsh(motion.body.I_B)
        needle = math.sqrt(moments[2] / moments[0])
        assert mpmath.norm(L - L0) <= CONSERVED * size * max(1.0, 0.01 * needle**2)
        assert abs(T - T0) <= CONSERVED * T0 * max(1.0, 0.01 * needle)


@pytest.mark.parametrize("name", MOTIONS)
def test_known_motions(name: str) -> None:
    motion = motion_of(name)
    assert max(errors(motion, [0.0, -7.0, 1e3, 6e9])) <= TARGET


@seeds(range(5), slow=range(5, 12))
def test_drawn_motions(seed: int) -> None:
    rng = np.random.default_rng(seed)
    motion = motion_from(draw(rng))
    assert max(errors(motion, interesting_times(motion, rng))) <= TARGET


@pytest.mark.parametrize("w", [pytest.param((1e-60, 1.0, 3e-60), marks=pytest.mark.slow), (0.0, -1e3, 1e-40)])
def test_all_but_on_the_middle_axis(w: tuple[float, float, float]) -> None:
    """1 - m is 1e-120 and less, far beyond what input means; the doubles given are a motion all the same."""
    drawn = Draw(
        "generic", "middle", np.array(MOMENTS), np.diag(MOMENTS), np.array([0.0, 0.0, 0.0, 1.0]), np.array(w)
    )
    motion = motion_from(drawn)
    truth = ExactMotion(drawn.I_B.tolist(), drawn.q_WB.tolist(), w, digits=400)
    rotation = motion.rotation
    assert isinstance(rotation, Tumble)
    first = float(-rotation.u0 / rotation.omega_p)
    between = math.pi / float(rotation.quarter * abs(rotation.omega_p))
    flips = [first + n * between for n in (0, 1, -4)]
    for t in (0.0, 1e9, *flips, *(flip + 0.5 / abs(w[1]) for flip in flips)):
        assert max(truth.errors(t, motion.sample(t).q_WB)) <= TARGET


@seeds((), slow=range(1000, 3000))
def test_many_drawn_motions(seed: int) -> None:
    rng = np.random.default_rng(seed)
    motion = motion_from(draw(rng))
    assert max(errors(motion, interesting_times(motion, rng))) <= TARGET


def test_the_draws_reach_every_corner() -> None:
    rng = np.random.default_rng(7)
    draws = [draw(rng) for _ in range(2000)]
    assert {(d.body, d.spin) for d in draws} == {(body, spin) for body in BODIES for spin in SPINS}
    rotations = [motion_from(d).rotation for d in draws[:400]]
    tumbles = [r for r in rotations if isinstance(r, Tumble)]
    for low, high in ((1e-3, 1.0), (1e-8, 1e-3), (1e-13, 1e-8), (1e-17, 1e-13)):
        assert any(low < r.m1 <= high for r in tumbles), f"no 1 - m in ({low}, {high}]"
        assert any(low < r.m <= high for r in tumbles), f"no m in ({low}, {high}]"
        assert any(low < r.a2 <= high for r in tumbles), (
            f"no spin that near to a stable axis: ({low}, {high}]"
        )
        pairs = [(r.moments[1] - r.moments[0]) / r.moments[1] for r in tumbles]
        assert any(low < abs(pair) <= high for pair in pairs), f"no nearly equal moments: ({low}, {high}]"


@pytest.mark.parametrize(
    ("moments", "w", "seconds"),
    [
        ((1.0, 1.5, 2.0), (0.3, -0.5, 1.2), 4.0),
        ((2.0, 1.5, 1.0), (0.01, 1.0, -0.02), -4.0),
        ((1.0, 1.0 + 2.0**-40, 1.25), (0.3, 0.5, 1.2), 3.0),
    ],
)
def test_the_reference_agrees_with_a_taylor_series(
    moments: tuple[float, ...], w: tuple[float, ...], seconds: float
) -> None:
    upright = (0.0, 0.0, 0.0, 1.0)
    truth = ExactMotion(np.diag(moments).tolist(), upright, w)
    assert max(truth.errors(seconds, integrated(moments, upright, w, seconds))) < 1e-22


OBLIQUE = Rotation.from_euler("xyz", [-0.7, 0.4, 1.3])
TURN = Rotation.from_euler("xyz", [0.3, -1.1, 2.0])


def oblique_motion(I_B: np.ndarray, w: np.ndarray, **place: object) -> FreeMotion:
    state = {"p_WB_W": np.zeros(3), "v_WB_W": np.zeros(3), **place}
    return free_motion(MassProperties(mass=1.0, I_B=I_B), BodyState(q_WB=TURN.as_quat(), w_WB_W=w, **state))


def oblique(moments: tuple[float, ...]) -> np.ndarray:
    R = OBLIQUE.as_matrix()
    I_B = R @ np.diag(moments) @ R.T
    return 0.5 * (I_B + I_B.T)


@pytest.mark.parametrize("inertia_unit", [1e-12, pytest.param(1e12, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("rate", "seconds"), [(1e6, 1e3), (1e6, -1e9), (6.0, 1e9), (1e-6, -1e15)])
@pytest.mark.parametrize(
    "moments", [(1.0, 1.4, 1.9), (0.7, 0.7, 0.7), (1.0, 1.0, 1.6), (0.4, 1.0, 1.0), (1.0, 2.0, 3.0)]
)
def test_any_size_any_spin_any_time(
    moments: tuple[float, ...], rate: float, seconds: float, inertia_unit: float
) -> None:
    """Axes are oblique, so that equal moments are equal to rounding only."""
    I_B = inertia_unit * oblique(moments)
    w = rate * np.array([0.3, -0.5, 0.8])
    motion = oblique_motion(I_B, w)
    truth = ExactMotion(I_B.tolist(), motion.state.q_WB.tolist(), w.tolist())
    answers = motion.sample(seconds).q_WB, motion.at([seconds] * 20).q_WB[7]
    assert max(truth.errors(seconds, *answers)) <= TARGET


def test_no_number_within_bounds_breaks_anything() -> None:
    """Warnings are errors here, and every answer is finite."""
    units = itertools.product((2e-60, 1e-12, 4e59), (0.0, 5e-324, 1e-300, 1e-59, 1e6, 1e60))
    spins = ((0.3, -0.5, 0.8), (1e-9, 1.0, 1e-9), (0.0, 0.0, 1.0))
    for (inertia, rate), spin in itertools.product(units, spins):
        for moments in ((1.0, 1.4, 1.9), (1.0, 1.0, 1.0), (1.0, 1.0, 2.0), (1e-8, 1.0, 1.0)):
            I_B = np.maximum(inertia * np.diag(moments), 1.1e-60 * np.eye(3))
            motion = oblique_motion(I_B, rate * np.array(spin))
            for t in (0.0, 1e-300, 1.0, -1e9, 1e60):
                if abs(t) <= motion.farthest:
                    q = motion.state_at(t).q_WB
                    assert abs(math.hypot(*q.tolist()) - 1.0) <= 1e-15
                    assert np.isfinite(motion.at([t] * 20).w_WB_W).all()
            poinsot(motion)
            next_flips(motion, 3, covariance=1e-6 * np.eye(12))
            covariance_along(motion, 1e-6 * np.eye(12), [min(1.0, motion.farthest)])
            if rate > 1e-50:
                rolling_curves(motion, 5)


def test_what_turns_nothing_in_the_age_of_the_universe_is_at_rest() -> None:
    motion = oblique_motion(np.diag([1.0, 1.4, 1.9]), np.array([0.0, 1e-61, 1e-70]))
    assert motion.regime is Regime.AT_REST
    np.testing.assert_array_equal(motion.state_at(1e17).w_WB_W, 0.0)


def test_times_beyond_the_last_turn_that_doubles_tell_apart_are_refused() -> None:
    motion = oblique_motion(np.diag([1.0, 1.4, 1.9]), np.array([0.0, 0.0, 10.0]))
    motion.at([9e14])
    for ask in (motion.state_at, lambda t: motion.at([0.0, t])):
        with pytest.raises(InvalidFieldError, match=r"seconds must be .*, got"):
            ask(-1.1e15)
    resting = oblique_motion(np.diag([1.0, 1.4, 1.9]), np.zeros(3))
    resting.state_at(1e60)
    with pytest.raises(InvalidFieldError, match="seconds"):
        resting.state_at(1e61)
