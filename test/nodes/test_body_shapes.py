# SPDX-License-Identifier: Apache-2.0
"""Configured shapes, where they are, and the inertia of a mass that fills them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.nodes.world_parameters import DESCRIPTIONS, ShapeParameters

CORNERS = [x for signs in np.ndindex(2, 2, 2) for x in (np.array(signs) - 0.5) * [0.2, 0.4, 0.6]]
"""Of the box below."""


def configured(*, rounding: float = 0.0, **given: list[float]) -> ShapeParameters:
    return ShapeParameters(
        numbers={name: given.get(name, [0.0]) for name in DESCRIPTIONS},
        rounding=rounding,
        position=given.get("position", [0.0, 0.0, 0.0]),
        orientation=given.get("orientation", [0.0, 0.0, 0.0, 1.0]),
    )


def test_none_is_no_shape() -> None:
    assert configured().shape_F().is_empty


@pytest.mark.parametrize(
    ("given", "corners", "rims", "rounding"),
    [
        ({"box": [0.1, 0.2, 0.3]}, 8, 0, 0.0),
        ({"box": [0.1, 0.2, 0.3], "rounding": 0.01}, 8, 0, 0.01),
        ({"sphere": [0.1]}, 1, 0, 0.1),
        ({"capsule": [0.1, 0.0]}, 1, 0, 0.1),
        ({"cylinder": [0.1, 0.2]}, 0, 2, 0.0),
        ({"cylinder": [0.1, 0.0]}, 0, 1, 0.0),
        ({"cone": [0.1, 0.2]}, 1, 1, 0.0),
        ({"vertices": [0.0] * 12}, 1, 0, 0.0),
    ],
)
def test_each_shape_has_its_parts(given: dict[str, Any], corners: int, rims: int, rounding: float) -> None:
    shape = configured(**given).shape_F()
    assert (len(shape.vertices), len(shape.rims), shape.rounding) == (corners, rims, rounding)


@pytest.mark.parametrize(
    ("given", "center", "moments"),
    [
        ({"box": [0.2, 0.4, 0.6]}, 0.0, [(0.16 + 0.36) / 12, (0.04 + 0.36) / 12, (0.04 + 0.16) / 12]),
        ({"sphere": [0.5]}, 0.0, [0.1, 0.1, 0.1]),
        ({"cylinder": [0.2, 0.6]}, 0.0, [0.01 + 0.03, 0.01 + 0.03, 0.02]),
        ({"cylinder": [0.2, 0.0]}, 0.0, [0.01, 0.01, 0.02]),
        ({"cone": [0.2, 0.4]}, 0.1, [0.012, 0.012, 0.012]),  # 3/80 (4 r^2 + h^2) and 3/10 r^2
        ({"capsule": [0.5, 1.0]}, 0.0, [0.3025, 0.3025, 0.115]),  # 0.6 of the mass between the ends
        ({"vertices": CORNERS}, 0.0, [(0.16 + 0.36) / 12, (0.04 + 0.36) / 12, (0.04 + 0.16) / 12]),
    ],
)
def test_a_mass_that_fills_it(given: dict[str, Any], center: float, moments: list[float]) -> None:
    """Turned so that its z axis is the frame's x, and shifted."""
    turn = Rotation.from_euler("y", 90.0, degrees=True)
    uniform = configured(position=[0.0, 1.0, 0.0], orientation=turn.as_quat().tolist(), **given).uniform(2.0)
    assert uniform.mass == 2.0
    np.testing.assert_allclose(uniform.p_FB_F, [center, 1.0, 0.0], atol=1e-15)
    x, y, z = (2.0 * moment for moment in moments)
    np.testing.assert_allclose(uniform.I_B, np.diag([z, y, x]), atol=1e-15)
