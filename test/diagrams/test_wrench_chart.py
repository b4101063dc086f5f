# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.contact_modes import WrenchHalfSpace
from contact_dynamics.diagrams.wrench_chart import (
    ANTICLOCKWISE,
    CLOCKWISE,
    HIDDEN,
    DirectionChart,
    ForceChart,
    ForceDualChart,
    WrenchChart,
    part_centre,
    picture_size,
)
from contact_dynamics.plane.types import PlanarBody, PlanarWrench, force_dual

BODY = PlanarBody(mass=2.0, inertia=0.5)
RHO = BODY.radius_of_gyration
CHARTS = [
    DirectionChart(length=RHO, resolution=60),
    ForceDualChart(length=RHO, half_side=1.5, centre=(0.2, -0.1), resolution=60),
    ForceChart(moment=0.3, half_side=4.0, resolution=60),
]


@pytest.mark.parametrize("chart", CHARTS, ids=lambda chart: type(chart).__name__)
def test_a_wrench_stands_where_the_chart_shows_it(chart: WrenchChart) -> None:
    wrenches, shown = chart.wrenches()
    width, height = picture_size(chart)
    assert shown.shape == (height, width)
    rows, columns = np.nonzero(shown)
    places, part = chart.place(wrenches[shown])
    np.testing.assert_allclose(places, np.column_stack([columns + 0.5, -rows - 0.5]), atol=1e-9)
    assert set(part.tolist()) == set(range(chart.parts))
    for i in range(chart.parts):
        assert np.all(np.abs(places[part == i] - part_centre(chart, i)) <= 0.5 * chart.resolution)


def test_a_disc_keeps_areas_and_directions() -> None:
    chart = DirectionChart(length=RHO, resolution=400)
    wrenches, shown = chart.wrenches()
    scaled = wrenches[shown] / (1.0, 1.0, RHO)
    np.testing.assert_allclose(np.linalg.norm(scaled, axis=1), 1.0, rtol=1e-12)
    for height in (-0.9, -0.3, 0.0, 0.5, 0.8):
        # The share of a sphere above a height; a disc of 400 points is jagged by about 1 in 400.
        assert np.mean(scaled[:, 2] > height) == pytest.approx(0.5 * (1.0 - height), abs=5e-3)
    centres = [part_centre(chart, part) for part in (ANTICLOCKWISE, CLOCKWISE)]
    (left, up), part = chart.place(np.array([[-1.0, 0.0, 0.3], [0.0, 1.0, -0.3]]))
    assert part.tolist() == [ANTICLOCKWISE, CLOCKWISE]
    assert left[0] < centres[0][0]
    assert left[1] == pytest.approx(centres[0][1])
    assert up[0] == pytest.approx(centres[1][0])
    assert up[1] > centres[1][1]
    _, part = chart.place(np.array([[1.0, 0.0, 0.0], [1.0, 0.0, -1e-12]]))
    assert part.tolist() == [ANTICLOCKWISE, ANTICLOCKWISE]


@pytest.mark.parametrize("wrench", [(1.0, 2.0, 0.7), (1.0, -2.0, -0.9), (-0.2, 0.1, 0.4)])
def test_the_force_dual_is_where_lecture_26_has_it(wrench: tuple[float, float, float]) -> None:
    chart = ForceDualChart(length=RHO, half_side=3.0)
    dual = force_dual(BODY, PlanarWrench(f=wrench[:2], moment=wrench[2]))
    assert dual is not None
    places, part = chart.place(np.array([wrench]))
    assert part[0] == (ANTICLOCKWISE if dual.turn > 0 else CLOCKWISE)
    np.testing.assert_allclose(places, chart.place_points(np.array([dual.point]), part), atol=1e-9)


def test_what_the_chart_does_not_reach_is_hidden() -> None:
    chart = ForceDualChart(length=RHO, half_side=1.0)
    _, part = chart.place(np.array([[1.0, 0.0, 0.0], [1.0, 0.0, 1e-3], [0.0, 0.0, 1.0]]))
    assert part.tolist() == [HIDDEN, HIDDEN, ANTICLOCKWISE]
    _, part = CHARTS[2].place(np.array([[5.0, 0.0, 0.0], [3.0, 0.0, 9.0]]))
    assert part.tolist() == [HIDDEN, ANTICLOCKWISE]


@pytest.mark.parametrize("chart", CHARTS, ids=lambda chart: type(chart).__name__)
@pytest.mark.parametrize("a", [(0.6, 0.8, 0.0), (0.3, -0.1, 1.5), (-1.0, 0.0, -0.2)])
def test_a_boundary_is_where_the_half_space_ends(chart: WrenchChart, a: tuple[float, float, float]) -> None:
    side = WrenchHalfSpace(a=a, b=0.4 if isinstance(chart, ForceChart) else 0.0)
    wrenches = chart.boundary(side)
    np.testing.assert_allclose(wrenches @ np.array(a), side.b, atol=1e-12 * np.abs(wrenches).max())
    places, part = chart.place(wrenches)
    together = (part[1:] == part[:-1]) & (part[1:] != HIDDEN)
    assert together.any()
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    if not isinstance(chart, ForceDualChart):  # where the far ends of a line are all but infinitely far
        assert steps[together].max() < 1.0


def test_a_half_space_of_torques_has_no_boundary_among_forces() -> None:
    assert len(CHARTS[2].boundary(WrenchHalfSpace(a=(0.0, 0.0, 1.0), b=0.1))) == 0
