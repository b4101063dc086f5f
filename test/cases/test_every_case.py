# SPDX-License-Identifier: Apache-2.0
"""Each case: the package's answer is the exact one, and MuJoCo's simulation answers the same question."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from importlib import import_module

import pytest

from contact_dynamics.cases import CASES, Case
from contact_dynamics.cases.engine import MUJOCO, OURS, PEERS, Engine
from contact_dynamics.cases.mujoco import CONTACT_S, Simulation, softness

SETTINGS = [(name, setting) for name, case in CASES.items() for setting in case.settings]


@pytest.mark.parametrize(("name", "setting"), SETTINGS)
def test_ours_is_the_exact_answer(name: str, setting: float) -> None:
    case = CASES[name]
    assert abs(OURS.answer(name, setting) - case.exact(setting)) <= case.tolerance


def test_there_are_at_least_fifteen_and_each_was_asked_in_public() -> None:
    assert len(CASES) >= 15
    for case in CASES.values():
        assert case.threads
        for address in case.threads:
            assert re.fullmatch(r"https://github\.com/[\w.-]+/[\w.-]+/(issues|pull)/\d+", address)


@pytest.mark.parametrize("engine", [OURS, *PEERS], ids=lambda engine: engine.name)
def test_an_engine_answers_every_case(engine: Engine) -> None:
    assert [name for name in CASES if not callable(getattr(import_module(engine.module), name, None))] == []


@pytest.mark.parametrize("name", ["four_feet", "cradle_at_once", "turning_bar"])
def test_a_tolerance_tells_the_answer_from_what_is_nearly_it(name: str) -> None:
    """Tolerances are rounding: an answer that is off by a millionth is wrong."""
    case = CASES[name]
    for setting in case.settings:
        assert case.tolerance < 1e-6 * max(abs(case.exact(setting)), 0.1)


QUICK = {
    "bounce": 0.1,  # of the exact answer: a spring and damper that ten steps resolve
    "two_balls": 0.01,
    "bowling_ball": 0.01,
    "rolling_down": 0.01,
    "flip_period": 0.05,
}
"""Cases in which MuJoCo comes close, and how close: there, both answer the same question."""


def close_to(name: str, case: Case) -> Iterator[tuple[float, float]]:
    for setting in case.settings:
        yield (
            MUJOCO.answer(name, setting),
            pytest.approx(case.exact(setting), abs=QUICK[name] * max(case.exact(setting), 1.0)),
        )


@pytest.mark.skipif(not MUJOCO.version, reason="NOT RUN: MuJoCo is not installed")
@pytest.mark.parametrize("name", QUICK)
def test_mujoco_is_asked_the_same_question(name: str) -> None:
    for answer, exact in close_to(name, CASES[name]):
        assert answer == exact


@pytest.mark.skipif(not MUJOCO.version, reason="NOT RUN: MuJoCo is not installed")
def test_the_loads_on_a_ball_are_its_weight() -> None:
    simulation = Simulation(
        '<geom type="plane" size="1 1 1"/><body pos="0 0 0.1"><freejoint/><geom size="0.1" mass="2"/></body>'
    )
    simulation.run(2.0)
    assert simulation.loads() == pytest.approx([2.0 * 9.80665], rel=1e-3)


@pytest.mark.parametrize("restitution", [0.2, 0.75, 1.0])
def test_a_spring_and_damper_gives_back_what_it_is_made_for(restitution: float) -> None:
    """From x = 0, x'' = -k x - b x': after half a swing x' has the factor -exp(-b T / 2)."""
    stiffness, damping = (-float(text) for text in softness(restitution).split('"')[1].split())
    swing = math.pi / math.sqrt(stiffness - damping**2 / 4.0)
    assert swing == pytest.approx(CONTACT_S, rel=1e-12)
    assert math.exp(-0.5 * damping * swing) == pytest.approx(restitution, rel=1e-12)
