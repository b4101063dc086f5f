# SPDX-License-Identifier: Apache-2.0
"""The law of impact for many variations of strikes at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from calibration.made_tosses import BRICK, FLOOR, MASS
from contact_dynamics.calibration.impacts import velocities_after
from contact_dynamics.calibration.model import Model


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
