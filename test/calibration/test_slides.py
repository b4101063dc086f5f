# SPDX-License-Identifier: Apache-2.0
"""Friction where contact lasts, from whole tosses that were made with another one than their strikes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.made_tosses import BRICK, FLOOR, MASS, WORLD
from contact_dynamics.calibration import Calibration, Free, calibrate
from contact_dynamics.calibration.free import STANDARD
from contact_dynamics.calibration.impacts import velocities_after
from contact_dynamics.calibration.model import Model
from contact_dynamics.calibration.report import content_of, report
from contact_dynamics.calibration.slides import LASTING_SPEED
from contact_dynamics.calibration.toss_uncertainty import toss_uncertainty
from contact_dynamics.measured.motion import MeasuredMotion, StateColumns, motions_of
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import turned
from contact_dynamics.toss import TossEnd, toss

RATE = 240.0
STRIKES, LASTS, SCATTER = 0.2, 0.3, 0.015
NOISE = (1e-4, 1e-3)  # m, rad


def whole_toss(
    random: np.random.Generator, friction: float, noise: tuple[float, float] = NOISE
) -> MeasuredMotion:
    """One toss from the hand to rest, as it is measured. Strikes have another friction than what lasts."""
    floor = replace(FLOOR, friction=STRIKES, restitution=0.3)
    while True:
        q = random.standard_normal(4)
        state = BodyState(
            p_WB_W=[0, 0, 0.3],
            q_WB=q / np.linalg.norm(q),
            v_WB_W=[*random.uniform(0.8, 1.6, 2), 0.0],
            w_WB_W=random.uniform(-3.0, 3.0, 3),
        )
        world = replace(WORLD, surfaces=(floor,))
        went = toss(BRICK, state, world, max_alternatives=0, lasting_factors=[friction / STRIKES])
        if went.end == TossEnd.RESTS:
            break
    times = np.arange(round((went.seconds + 0.15) * RATE)) / RATE
    path = went.at(np.minimum(times, went.seconds))
    p = path.p_WB_W + noise[0] * random.standard_normal(path.p_WB_W.shape)
    q_shaken = turned(path.q_WB, noise[1] * random.standard_normal(p.shape))
    states = [
        BodyState(p_WB_W=p[i], q_WB=q_shaken[i], stamp_ns=round(1e9 * (t + 1.0)))
        for i, t in enumerate(times.tolist())
    ]
    stamps = [each.stamp_ns for each in states]
    (motion,) = motions_of(BRICK, WORLD, StateColumns(states, stamps), noise=noise)
    return motion


@pytest.fixture(scope="module")
def motions() -> list[MeasuredMotion]:
    """Tosses whose lasting friction scatters."""
    random = np.random.default_rng(5)
    return [whole_toss(random, LASTS + SCATTER * random.standard_normal()) for _ in range(24)]


@pytest.fixture(scope="module")
def found(motions: list[MeasuredMotion]) -> Calibration:
    return calibrate(motions, with_paths=False)


def test_slides_tell_the_friction_that_lasts_and_strikes_theirs(found: Calibration) -> None:
    (lasting,) = found.lasting_frictions
    assert lasting.surface == "floor"
    assert lasting.slides >= 10
    assert abs(lasting.friction - LASTS) < 4.0 * lasting.std
    assert lasting.std < 0.01
    assert 0.4 * SCATTER < lasting.scatter < 2.0 * SCATTER  # by the median of some twenty
    strikes = found.estimate("friction.floor")
    assert abs(strikes.value - STRIKES) < 5.0 * strikes.std
    assert strikes.value < LASTS - 0.05


def test_tosses_are_sampled_with_it(found: Calibration) -> None:
    (lasting,) = found.lasting_frictions
    known = toss_uncertainty(found)
    (floor,) = found.surfaces
    assert floor.lasting_factor * floor.friction == pytest.approx(lasting.friction)
    assert floor.lasting_speed == LASTING_SPEED
    np.testing.assert_array_equal(known.lasting_factors, [floor.lasting_factor])
    deviation = known.lasting_factor_stds * found.surfaces[0].friction
    assert deviation == pytest.approx(math.hypot(lasting.std, lasting.scatter))


def test_with_sharp_corners_strikes_of_all_speeds_keep_one_friction(motions: list[MeasuredMotion]) -> None:
    free = [each for each in STANDARD if each is not Free.ROUNDING]
    sharp = calibrate(motions, free=free, with_paths=False)
    (floor,) = sharp.surfaces
    assert sharp.body.shape.rounding == floor.lasting_speed == 0.0
    assert floor.lasting_factor > 1.0


def test_the_report_tells_it(found: Calibration) -> None:
    (lasting,) = found.lasting_frictions
    assert f"Friction of floor in sustained contact: {lasting.friction:.3g} +- {lasting.std:.2g}" in report(
        found
    )
    assert content_of(found)["lasting_frictions"] == [lasting.to_dict()]


def test_without_slides_strikes_tell_what_is_known() -> None:
    """Four tosses are too few, so that the factor and the speed stay as they are configured."""
    random = np.random.default_rng(6)
    motions = [whole_toss(random, LASTS) for _ in range(4)]
    for configured in (1.0, 1.2):
        world = replace(WORLD, surfaces=(replace(FLOOR, lasting_factor=configured, lasting_speed=0.2),))
        found = calibrate([replace(motion, world=world) for motion in motions], with_paths=False)
        assert found.lasting_frictions == ()
        assert found.surfaces[0].lasting_speed == 0.2
        known = toss_uncertainty(found)
        np.testing.assert_array_equal(known.lasting_factors, [configured])
        np.testing.assert_array_equal(known.lasting_factor_stds, [0.0])


def test_variations_have_the_answers_that_each_has_alone_to_the_last_bit() -> None:
    random = np.random.default_rng(0)
    model = Model(BRICK, [FLOOR])
    described = [
        model.describe(model.configured + 0.01 * random.uniform(size=len(model.configured))) for _ in range(4)
    ]
    q = random.standard_normal((3, 4))
    state: dict[str, Any] = {
        "q_WB": (q / np.linalg.norm(q, axis=1)[:, None])[None],
        "velocities_W": random.uniform(-2.0, -1.0, (4, 3, 3)),
        "spins_W": random.uniform(-5.0, 5.0, (1, 3, 3)),
        "corners": np.array([0, 3, 5]),
        "surfaces": np.zeros(3, dtype=int),
    }
    together = velocities_after(described, MASS, **state)
    assert together.shape == (4, 3, 6)
    for k, one in enumerate(described):
        alone = {**state, "velocities_W": state["velocities_W"][k : k + 1]}
        assert velocities_after([one], MASS, **alone)[0].tolist() == together[k].tolist()
