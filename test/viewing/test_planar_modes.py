from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes, mode_margins, wrench_sets
from contact_dynamics.nodes.pictured_contact_modes import applied_wrench
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.viewing.planar_modes import (
    MOST_SETS,
    PlanarModesPicture,
    draw_planar_map,
    draw_planar_modes,
    silhouette,
)
from contact_dynamics.viewing.shape import convex_shape
from contact_dynamics.world import box_vertices

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from viewing.drawn import Drawn

ROD = PlanarBody(mass=1.0, inertia=1.0)
TIP = PlanarContact(
    r=(-4.0 * math.cos(math.radians(75.0)), -4.0 * math.sin(math.radians(75.0))),
    normal=(0.0, 1.0),
    friction=math.tan(math.radians(30.0)),
)
AT_REST = PlanarVelocity(v=(0.0, 0.0), w=0.0)
ALONG = PlanarWrench(f=(-1.0, 0.0))


def picture_of(*, applied: PlanarWrench, velocity: PlanarVelocity) -> PlanarModesPicture:
    answer = contact_modes(PlanarContactProblem(body=ROD, velocity=velocity, contacts=[TIP], wrench=applied))
    margins = mode_margins(PlanarContactProblem(body=ROD, velocity=velocity, contacts=[TIP], wrench=applied))
    return PlanarModesPicture(
        contacts=(TIP,),
        modes=answer.modes,
        margins=tuple(f"({margin.margin:.2f} N)" for margin in margins),
        verdict="no consistent mode",
        sets=wrench_sets(
            PlanarContactProblem(
                body=ROD, velocity=velocity, contacts=[TIP], wrench=PlanarWrench(f=(0.0, 0.0))
            )
        ),
        length=ROD.radius_of_gyration,
        applied=applied,
        change=margins[0].change if margins else None,
    )


def test_the_modes_of_the_indeterminate_rod_stand_side_by_side(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    picture = picture_of(applied=ALONG, velocity=AT_REST)
    draw_planar_modes(recording, picture, outline=np.array([TIP.r, (-TIP.r[0], -TIP.r[1])]))
    drawn = read()
    titles = [drawn.last(f"/planar_modes/mode_{i}/title", "Points2D:labels")[0][0] for i in (1, 2)]
    assert sorted(titles) == ["f", "l"]
    places = [drawn.array(f"/planar_modes/mode_{i}/contacts", "Points2D:positions")[0] for i in (1, 2)]
    assert places[1][0] - places[0][0] > 2.0 * abs(TIP.r[0]) + 1.0
    assert places[1][1] == places[0][1]
    assert drawn.last("/planar_modes/mode_3", "Clear:is_recursive") == [True]


def test_the_inconsistent_rod_says_so(recording: rr.RecordingStream, read: Callable[[], Drawn]) -> None:
    falling = PlanarWrench(f=(0.0, -9.81))
    picture = picture_of(applied=falling, velocity=PlanarVelocity(v=(-1.0, 0.0), w=0.0))
    draw_planar_modes(recording, picture, outline=np.zeros((0, 2)))
    draw_planar_map(recording, picture, None)
    drawn = read()
    assert drawn.last("/planar_modes/mode_1/title", "Points2D:labels") == ["no consistent mode"]
    assert drawn.last("/planar_modes/mode_2", "Clear:is_recursive") == [True]
    assert "black: none is" in drawn.last("/mode_map/captions", "Points2D:labels")[-1]


def test_a_map_that_looks_as_before_is_not_drawn_again(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    picture = picture_of(applied=ALONG, velocity=AT_REST)
    turned = replace(TIP, r=(TIP.r[0] * 1.001, TIP.r[1]))
    nearly = replace(
        picture,
        sets=wrench_sets(
            PlanarContactProblem(body=ROD, contacts=[turned], wrench=PlanarWrench(f=(0.0, 0.0)))
        ),
        applied=PlanarWrench(f=(0.0, -1.0)),
    )
    far = replace(
        picture,
        sets=wrench_sets(
            PlanarContactProblem(
                body=ROD, contacts=[replace(TIP, friction=0.9)], wrench=PlanarWrench(f=(0.0, 0.0))
            )
        ),
    )
    drawn_map = draw_planar_map(recording, picture, None)
    assert draw_planar_map(recording, nearly, drawn_map) is drawn_map
    other = draw_planar_map(recording, far, drawn_map)
    assert other is not drawn_map
    assert draw_planar_map(recording, replace(picture, sets=()), other) is other
    drawn = read()
    assert len(drawn.values["/mode_map/regions", "Image:buffer"]) == 2
    assert len(drawn.values["/mode_map/applied", "Points2D:positions"]) == 3


def test_a_map_of_too_many_modes_is_left_out(
    recording: rr.RecordingStream, read: Callable[[], Drawn]
) -> None:
    picture = picture_of(applied=ALONG, velocity=AT_REST)
    many = replace(picture, sets=picture.sets[:1] * (MOST_SETS + 1))
    assert draw_planar_map(recording, many, None) is None
    drawn = read()
    assert drawn.last("/mode_map", "Clear:is_recursive") == [True]
    assert "/mode_map/regions" not in drawn.entities


@pytest.mark.parametrize("applied", [ALONG, PlanarWrench(f=(0.3, -2.0), moment=0.4)])
def test_the_applied_wrench_follows_from_a_mode(applied: PlanarWrench) -> None:
    for mode in contact_modes(
        PlanarContactProblem(body=ROD, velocity=AT_REST, contacts=[TIP], wrench=applied)
    ).modes:
        found = applied_wrench(mode, [TIP], mass=ROD.mass, inertia=ROD.inertia)
        assert found.f == pytest.approx(applied.f, abs=1e-12)
        assert found.moment == pytest.approx(applied.moment, abs=1e-12)


def test_a_silhouette_is_the_hull_as_seen() -> None:
    box = convex_shape(box_vertices((0.4, 0.2, 0.1)))
    strip = silhouette(box, np.eye(3)[[0, 2]])
    assert len(strip) == 5
    np.testing.assert_allclose(strip[0], strip[-1])
    np.testing.assert_allclose(np.ptp(strip, axis=0), [0.4, 0.1])
    rod = convex_shape(np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    assert len(silhouette(rod, np.eye(3)[:2])) == 2
    assert len(silhouette(convex_shape(np.zeros((0, 3))), np.eye(3)[:2])) == 0
