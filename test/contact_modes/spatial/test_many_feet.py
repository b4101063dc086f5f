# SPDX-License-Identifier: Apache-2.0
"""A body on many feet, whose loads are not known: all modes, without trying every cell of their sectors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, MassProperties, ModeVerdict, SpatialContactProblem
from contact_dynamics.contact_modes import contact_modes
from contact_modes.evidence import spatial_problem
from sweeps import seeds

MASS, WEIGHT, FRICTION = 2.0, 20.0, 0.4
BODY = MassProperties(mass=MASS, I_B=np.diag([0.3, 0.4, 0.5]))
AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])


def ring(n: int, height: float = 0.2) -> ContactSet:
    angles = 2.0 * math.pi * np.arange(n) / n
    return ContactSet(
        p_WC_W=np.column_stack([np.cos(angles), np.sin(angles), np.full(n, -height)]),
        normals_W=[0.0, 0.0, 1.0],
        frictions=FRICTION,
    )


@pytest.mark.parametrize("feet", [12, 16, 32])
@pytest.mark.parametrize(
    ("push", "torque", "first", "modes"),
    [
        ((0.0, 0.0), (0.0, 0.0, 0.0), "f", 1),
        ((7.0, 3.0), (0.0, 0.0, 0.0), "f", 1),  # 7.6 N of the 8 N that friction holds
        ((7.0, 4.0), (0.0, 0.0, 0.0), "c", 1),
        ((0.0, 0.0), (0.0, 0.0, 12.0), "c", 1),
        ((12.0, 0.1), (0.0, 0.0, 0.5), "c", 1),
        ((7.0, 3.0), (0.0, 0.0, 5.0), "c", None),  # the load decides which foot it turns about, or none
        ((10.0, 1.0), (0.5, 0.2, 4.0), "c", None),
        ((0.0, 0.0), (0.0, 25.0, 0.0), "f", 1),
    ],
)
def test_many_feet_take_few_trials(
    feet: int, push: tuple[float, float], torque: tuple[float, float, float], first: str, modes: int | None
) -> None:
    answer = contact_modes(spatial_problem(BODY, AT_REST, ring(feet), (*push, -WEIGHT), torque))
    if modes is not None:
        assert len(answer.modes) == modes
    if torque[1] == 25.0:  # N m, more than its weight has about the outermost foot
        assert answer.modes[0].mode == first + "s" * (feet - 1)
    else:
        assert first * feet in [mode.mode for mode in answer.modes]
    if first == "f" and not any(torque):  # it is proven to rest without a search
        assert answer.examined <= 1
    # Each cell of the arrangement of all sectors would be tens of thousands. Which of equal feet comes first
    # is up to rounding, so that LAPACKs differ: some 50 and 65 trials a foot were seen.
    assert answer.examined <= 150 * feet


def test_a_box_that_may_turn_on_32_feet_is_decided_in_few_trials() -> None:
    # Friction of 92 to 100 % of what holds it, so that pyramids let it slide where round cones need not.
    angles = 2.0 * math.pi * np.arange(32) / 32
    feet = ContactSet(
        p_WC_W=np.column_stack([np.cos(angles), np.sin(angles), np.full(32, -0.5)]),
        normals_W=[0.0, 0.0, 1.0],
        frictions=0.5,
    )
    box = MassProperties(mass=1.0, I_B=np.diag([0.1, 0.2, 0.25]))
    load = {"force_W": (1.0, 0.5, -9.8), "torque_W": (0.0, 0.0, 4.0)}
    answer = contact_modes(SpatialContactProblem(body=box, state=AT_REST, contacts=feet, **load))
    assert answer.verdict == ModeVerdict.INDETERMINATE
    assert {"c" * 32, "f" * 32} < {mode.mode for mode in answer.modes}
    assert max(mode.misdirection for mode in answer.modes) <= 1e-8
    assert answer.examined <= 100 * 32  # with care throughout it would be 150, each of a millisecond


@seeds(range(4))
def test_one_mode_stands_for_all_with_its_letters(seed: int) -> None:
    chance = np.random.default_rng(seed)
    contacts = ring(7)
    asked = {
        "force_W": (*chance.normal(0.0, 6.0, size=2), -WEIGHT),
        "torque_W": (0.0, 0.0, chance.normal(0.0, 4.0)),
    }
    every = contact_modes(
        SpatialContactProblem(body=BODY, state=AT_REST, contacts=contacts, sharpen=False, **asked)
    )
    few = contact_modes(SpatialContactProblem(body=BODY, state=AT_REST, contacts=contacts, **asked))
    assert {mode.mode for mode in few.modes} == {mode.mode for mode in every.modes}
    letters = [mode.mode for mode in few.modes if not mode.motion_unique]
    assert all(letters.count(one) == 1 for one in letters)
    assert [one for one in every.modes if one.mode not in letters and not one.motion_unique] == []
