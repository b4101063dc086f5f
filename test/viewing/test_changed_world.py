# SPDX-License-Identifier: Apache-2.0
"""A world that changes while it is drawn: each surface and shape has its form of the time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.world import Body, Surface, World, box_vertices
from viewing.drawn import STAMP_NS

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from viewing.drawn import Drawn

LATER_NS = STAMP_NS + 1_000_000_000
FLOOR = "/world/surfaces/floor/patch"
FACES = "/world/bodies/brick/faces"


def raised(floor: Surface, height: float) -> Surface:
    return Surface(
        name=floor.name, p_WS_W=[0.0, 0.0, height], normal_W=floor.normal_W, friction=0.3, restitution=0.0
    )


def state(stamp_ns: int) -> BodyState:
    return BodyState(
        p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0], stamp_ns=stamp_ns
    )


def test_each_form_is_drawn_from_when_it_came(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, floor: Surface
) -> None:
    picture = Picture(recording, World(bodies=(body,), surfaces=(floor,)), surface_side=1.0)
    picture.add_states("brick", [state(STAMP_NS)])
    larger = Body(
        name="brick",
        mass_properties=body.mass_properties,
        shape=type(body.shape)(vertices=box_vertices((0.3, 0.2, 0.1))),
    )
    for height, stamp_ns in ((0.25, LATER_NS), (0.5, LATER_NS + 5)):
        world = World(bodies=(larger,), surfaces=(raised(floor, height),))
        picture.change_world(world, stamp_ns=stamp_ns)
    picture.change_world(World(bodies=(larger,)), stamp_ns=LATER_NS + 7)
    drawn = read()
    for path in (FLOOR, FACES):  # what was drawn for all times is emptied, since rerun would always show it
        assert [] in [value for _, value in drawn.values[path, "Mesh3D:vertex_positions"]]
    heights = [drawn.array(f"{FLOOR}/{form}", "Mesh3D:vertex_positions")[0, 2] for form in (1, 2, 3)]
    np.testing.assert_allclose(heights, [0.0, 0.25, 0.5], atol=1e-7)
    assert drawn.stamps(f"{FLOOR}/1", "Mesh3D:vertex_positions") == [STAMP_NS]
    assert drawn.stamps(f"{FLOOR}/2", "Mesh3D:vertex_positions") == [LATER_NS]
    assert drawn.stamps(f"{FLOOR}/1", "Clear:is_recursive") == [LATER_NS]
    assert drawn.stamps(f"{FLOOR}/3", "Clear:is_recursive") == [LATER_NS + 7]
    np.testing.assert_allclose(
        drawn.array(f"{FACES}/1", "Mesh3D:vertex_positions").max(axis=0), [0.075, 0.045, 0.025]
    )
    np.testing.assert_allclose(
        drawn.array(f"{FACES}/2", "Mesh3D:vertex_positions").max(axis=0), [0.15, 0.1, 0.05]
    )
    assert drawn.stamps(f"{FACES}/2", "Mesh3D:vertex_positions") == [LATER_NS]


def test_a_change_before_the_first_state_is_drawn_for_all_times(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, floor: Surface
) -> None:
    picture = Picture(recording, World(bodies=(body,), surfaces=(floor,)), surface_side=1.0)
    picture.change_world(World(bodies=(body,), surfaces=(raised(floor, 0.25),)), stamp_ns=LATER_NS)
    drawn = read()
    heights = [value[0][2] for _, value in drawn.values[FLOOR, "Mesh3D:vertex_positions"]]
    assert 0.25 in heights
    assert f"{FLOOR}/1" not in drawn.entities
