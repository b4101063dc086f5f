# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.contact_modes import PlanarContactProblem, PlanarWrenchSet, contact_modes, wrench_sets
from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.force_dual import force_dual, split_generators
from contact_dynamics.diagrams.mode_map import (
    NO_MODE,
    OUTSIDE,
    borders_of,
    chart_for,
    look_alike,
    mode_map,
    mode_regions,
    paint_of_modes,
    widest_places,
)
from contact_dynamics.diagrams.wrench_chart import DirectionChart, ForceChart, ForceDualChart, WrenchChart
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.plane.types import acceleration_centre
from diagrams.marks_of import marks_of

BODY = PlanarBody(mass=1.0, inertia=0.25)
RHO = BODY.radius_of_gyration
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)
ON_FLOOR = [PlanarContact(r=(x, -0.4), normal=(0.0, 1.0), friction=0.8) for x in (-0.9, 0.3)]
ON_WALL = [PlanarContact(r=(0.6, y), normal=(-1.0, 0.0), friction=0.8) for y in (-0.1, 0.5)]
TRAY = [*ON_FLOOR, *ON_WALL]
SETS = wrench_sets(PlanarContactProblem(body=BODY, contacts=TRAY, wrench=PlanarWrench(f=(0.0, 0.0))))
PIVOT = [PlanarContact(r=(0.0, -0.5), normal=(0.0, 1.0), friction=0.5)]


@pytest.mark.parametrize(
    ("contacts", "velocity", "chart"),
    [
        (TRAY, AT_REST, DirectionChart(length=RHO, resolution=64)),
        (TRAY, AT_REST, ForceDualChart(length=RHO, half_side=2.0, resolution=64)),
        (PIVOT, PlanarVelocity(v=(-1.5, 0.0), w=-3.0), ForceChart(moment=0.7, half_side=30.0, resolution=64)),
    ],
    ids=["directions", "force dual", "forces on a turning body"],
)
def test_each_point_has_the_modes_of_its_wrench(
    contacts: list[PlanarContact], velocity: PlanarVelocity, chart: WrenchChart
) -> None:
    regions = mode_regions(
        wrench_sets(
            PlanarContactProblem(
                body=BODY, velocity=velocity, contacts=contacts, wrench=PlanarWrench(f=(0.0, 0.0))
            )
        ),
        chart,
    )
    wrenches, shown = chart.wrenches()
    assert np.array_equal(regions.classes == OUTSIDE, ~shown)
    inner = np.zeros(shown.shape, dtype=bool)  # on a boundary strictness decides, which the map does not draw
    same = regions.classes
    inner[1:-1, 1:-1] = np.all(
        [
            same[1:-1, 1:-1] == other
            for other in (same[:-2, 1:-1], same[2:, 1:-1], same[1:-1, :-2], same[1:-1, 2:])
        ],
        axis=0,
    )
    places = np.argwhere(inner & shown)
    for row, column in np.random.default_rng(0).permutation(places)[:150]:
        f_x, f_y, moment = wrenches[row, column].tolist()
        answer = contact_modes(
            PlanarContactProblem(
                body=BODY,
                velocity=velocity,
                contacts=contacts,
                wrench=PlanarWrench(f=(f_x, f_y), moment=moment),
            )
        )
        assert {mode.mode for mode in answer.modes} == set(regions.modes[regions.classes[row, column]])


def test_the_tray_has_regions_with_several_modes_and_a_sliding_rod_one_with_none() -> None:
    chart = DirectionChart(length=RHO, resolution=64)
    regions = mode_regions(SETS, chart)
    assert ("ffff", "rsrs") in {tuple(sorted(modes)) for modes in regions.modes}
    assert not (regions.classes == NO_MODE).any()
    rod = PlanarBody(mass=1.0, inertia=1.0)
    tip = PlanarContact(r=(-1.04, -3.86), normal=(0.0, 1.0), friction=0.58)
    sliding = PlanarVelocity(v=(-1.0, 0.0), w=0.0)
    regions = mode_regions(
        wrench_sets(
            PlanarContactProblem(
                body=rod, velocity=sliding, contacts=[tip], wrench=PlanarWrench(f=(0.0, 0.0))
            )
        ),
        chart,
    )
    assert (regions.classes == NO_MODE).any()


def test_borders_lie_between_regions() -> None:
    chart = DirectionChart(length=RHO, resolution=200)
    classes = mode_regions(SETS, chart).classes
    for one in SETS:
        strips = borders_of(one, chart)
        assert strips
        for x, y in (np.vstack(strips)[::50] * (1.0, -1.0)).round().astype(int):
            assert len(np.unique(classes[y - 2 : y + 3, x - 2 : x + 3])) > 1


def test_a_name_stands_inside_its_region() -> None:
    chart = DirectionChart(length=RHO, resolution=200)
    regions = mode_regions(SETS, chart)
    widest = widest_places(regions, chart)
    assert {one.region for one in widest} == set(np.unique(regions.classes).tolist()) - {OUTSIDE}
    for one in widest:
        column, row = (one.place * (1.0, -1.0)).astype(int)
        near = regions.classes[row - 3 : row + 4, column - 3 : column + 4]
        assert one.region in near
        if one.room > 4 / 200:
            assert np.all(near == one.region)


def test_colours_say_what_a_region_is() -> None:
    every = ["ff", "fs", "ls", "ss"]
    assert paint_of_modes(["ff"], every).dark == palette.FIXED
    assert paint_of_modes(["ss"], every).dark == palette.SEPARATE
    assert paint_of_modes(["ff", "ls"], every).dark == palette.UNDECIDED
    assert paint_of_modes([], every).dark == palette.NO_MODE
    assert len({palette.mode_color("ls", i) for i in range(18)}) == 18


def test_the_chart_suits_the_motion() -> None:
    wrench = PlanarWrench(f=(3.0, -4.0), moment=0.2)
    assert isinstance(chart_for(SETS, length=RHO, applied=wrench), DirectionChart)
    turning = wrench_sets(
        PlanarContactProblem(
            body=BODY,
            velocity=PlanarVelocity(v=(-1.5, 0.0), w=-3.0),
            contacts=PIVOT,
            wrench=PlanarWrench(f=(0.0, 0.0)),
        )
    )
    chart = chart_for(turning, length=RHO, applied=wrench)
    assert isinstance(chart, ForceChart)
    assert chart.moment == 0.2
    assert chart.half_side >= 10.0


def test_the_map_has_the_wrench_and_its_way_out() -> None:
    chart = DirectionChart(length=RHO, resolution=160)
    applied, change = PlanarWrench(f=(1.0, -3.0), moment=0.1), PlanarWrench(f=(-3.0, 0.5), moment=0.2)
    diagram = mode_map(SETS, chart, applied=applied, change=change)
    marks = marks_of(diagram)
    assert {"ffff", "ssss", "lsss"} <= {*marks["names"].texts, *marks["names_on_dark"].texts}
    assert [text for _, text in diagram.axes[0].ticks] == ["torque anticlockwise", "torque clockwise"]
    assert diagram.title.endswith("; white: several")
    (way,) = marks["applied/way_out"].strips
    ends = np.array([[1.0, -3.0, 0.1], [-2.0, -2.5, 0.3]])
    np.testing.assert_allclose(way[[0, -1]], chart.place(ends)[0])
    np.testing.assert_allclose(marks["applied"].places, chart.place(ends[:1])[0])
    assert marks["applied"].legend.startswith("applied: (1, -3) N,\n0.1 N m")


def test_numbers_on_the_axes_of_a_square_are_where_they_belong() -> None:
    chart = ForceChart(moment=0.7, half_side=30.0, resolution=64)
    forces = np.array([[-22.5, 0.0, 0.7], [0.0, 22.5, 0.7]])
    (left, _), (_, above) = chart.place(forces)[0]
    always = PlanarWrenchSet(mode="f", vertices=(), generators=(), half_spaces=())
    across, upward = mode_map([always], chart).axes
    assert (across.name, upward.name) == ("force to the right, N", "force up, N")
    assert (left, "-22.5") in across.ticks
    assert (above, "22.5") in upward.ticks


def test_the_construction_of_rsrs() -> None:
    rsrs = next(one for one in SETS if one.mode == "rsrs")
    forces, motions = split_generators(rsrs, TRAY)
    assert sorted(number for number, _ in forces) == [1, 3]
    (motion,) = motions
    centre = acceleration_centre((motion.f[0], motion.f[1]), motion.moment / BODY.inertia)
    assert centre is not None
    np.testing.assert_allclose(centre.point, (-0.9, -0.1), atol=1e-12)  # above contact 1, beside contact 3
    chart = ForceDualChart(length=RHO, half_side=1.2, resolution=100)
    marks = marks_of(force_dual(rsrs, TRAY, chart, outlines=[np.array([[-0.9, -0.4], [0.6, -0.4]])]))
    (place,) = marks["acceleration_centres"].places
    np.testing.assert_allclose(place, chart.place_points(np.array([centre.point]), 0)[0])
    assert "-c1" in marks["contact_forces_names"].texts


def test_a_map_without_half_spaces_is_one_region() -> None:
    always = PlanarWrenchSet(mode="f", vertices=(), generators=(), half_spaces=())
    regions = mode_regions([always], DirectionChart(length=1.0, resolution=20))
    assert regions.modes[2:] == (("f",),)
    assert look_alike([always], [always], length=1.0)
    assert not borders_of(always, DirectionChart(length=1.0, resolution=20))
