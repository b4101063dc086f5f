# SPDX-License-Identifier: Apache-2.0
"""Configured shapes, where they are, and the inertia of a mass that fills them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.nodes.world_parameters import DESCRIPTIONS, ShapeParameters
from contact_dynamics.rigid_body import inertia
from contact_dynamics.shapes import ConvexShape

SIZES = {
    "box": [0.1, 0.2, 0.3],
    "sphere": [0.2],
    "capsule": [0.1, 0.3],
    "cylinder": [0.1, 0.3],
    "cone": [0.1, 0.3],
    "vertices": [0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.3],
}
"""Numbers of each shape."""


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


def hull(shape: ConvexShape) -> np.ndarray:
    """Corners of a polyhedron that a shape is nearly: 100 of each rim, and 1000 of each ball."""
    turns = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    points = [*shape.vertices]
    for rim in shape.rims:
        assert rim.axis == (0.0, 0.0, 1.0)
        points += [rim.center + rim.radius * np.array([np.cos(t), np.sin(t), 0.0]) for t in turns]
    height = np.linspace(-1.0, 1.0, 1000)
    spiral = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(1000)
    across = np.sqrt(1.0 - height**2)
    ball = np.column_stack([across * np.cos(spiral), across * np.sin(spiral), height])
    return (
        np.array(points) if shape.rounding == 0.0 else np.vstack([p + shape.rounding * ball for p in points])
    )


@pytest.mark.parametrize("name", DESCRIPTIONS)
def test_the_mass_is_where_the_shape_is(name: str) -> None:
    """A polyhedron of many corners has nearly the same mass properties, by integrals over its faces."""
    shape = configured(**{name: SIZES[name]})
    filled, near = shape.uniform(2.0), inertia.convex_hull(hull(shape.shape_F()), mass=2.0)
    # Chords between 100 points leave 0.2 % of a radius squared, the faces of 1000 points 1 %.
    np.testing.assert_allclose(near.p_FB_F, filled.p_FB_F, atol=1e-3 * np.sqrt(filled.I_B.max()))
    np.testing.assert_allclose(near.I_B, filled.I_B, rtol=0.015, atol=1e-3 * filled.I_B.max())


@pytest.mark.parametrize(
    ("given", "center", "moments"),
    [
        ({"box": [0.2, 0.4, 0.6]}, 0.0, [(0.16 + 0.36) / 12, (0.04 + 0.36) / 12, (0.04 + 0.16) / 12]),
        ({"sphere": [0.5]}, 0.0, [0.1, 0.1, 0.1]),
        ({"cylinder": [0.2, 0.6]}, 0.0, [0.01 + 0.03, 0.01 + 0.03, 0.02]),
        ({"cylinder": [0.2, 0.0]}, 0.0, [0.01, 0.01, 0.02]),
        ({"cone": [0.2, 0.4]}, 0.1, [0.012, 0.012, 0.012]),  # 3/80 (4 r^2 + h^2) and 3/10 r^2
        ({"capsule": [0.5, 0.0]}, 0.0, [0.1, 0.1, 0.1]),
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
