# SPDX-License-Identifier: Apache-2.0
"""What was measured after an impact is drawn with the numbers that were found."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.diagrams.after_impact import LATE_S, SPAN_S, AwaitedImpacts
from contact_dynamics.viewing.picture import Picture
from diagrams.test_after_impact import STRIKE_NS, flight, prediction

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.world import World
    from viewing.drawn import Drawn

SPEED = "/speed/brick/after\\ impact\\,\\ "


def test_the_measured_velocity_stands_beside_the_predicted_one(
    recording: rr.RecordingStream, read: Callable[[], Drawn], world: World
) -> None:
    answer, states = prediction(), flight()
    awaited = AwaitedImpacts(gravity_W=world.gravity_W)
    awaited.expect(answer, now_ns=STRIKE_NS - 1)
    (found,) = awaited.see("brick", states)
    picture = Picture(recording, world, surface_side=0.5)
    picture.show(answer)
    picture.add_states("brick", states)
    drawn = read()
    measured, predicted = (
        drawn.series(f"{SPEED}{kind}", "Scalars:scalars") for kind in ("measured", "predicted")
    )
    np.testing.assert_array_equal(measured, found.measured_speeds)
    np.testing.assert_array_equal(predicted, found.predicted_speeds)
    stamps = drawn.stamps(f"{SPEED}measured", "Scalars:scalars")
    assert stamps == list(found.stamps_ns)
    assert LATE_S <= 1e-9 * (stamps[0] - STRIKE_NS) < 1e-9 * (stamps[-1] - STRIKE_NS) <= SPAN_S
    (gap,) = drawn.stamps(f"{SPEED}measured", "Clear:is_recursive")  # nothing joins it to the next
    assert gap > stamps[-1]
    arrow = drawn.array("/world/impact/brick/measured_velocity", "Arrows3D:vectors")[0]
    both = drawn.array("/world/impact/brick/velocity", "Arrows3D:vectors")
    scale = np.linalg.norm(both[1]) / np.linalg.norm(answer.impact.state.v_WB_W)
    np.testing.assert_allclose(arrow, scale * found.v_WB_W, rtol=1e-5)
    label = drawn.last("/world/impact/brick/velocity_label", "Points3D:labels")[1]
    assert label == "measured after 2.04 m/s, predicted 1.96 m/s"
    (text,) = drawn.last("/answers/newest", "TextDocument:text")
    assert (
        "**After the impact**: brick velocity measured (0.4, -1.2, 1.6), predicted (0.4, -1.2, 1.5) m/s"
        in text
    )
    assert "they differ by 0.1 m/s" in text


def test_an_answer_that_comes_after_the_states_is_drawn_alike(
    recording: rr.RecordingStream, read: Callable[[], Drawn], world: World
) -> None:
    answer, states = prediction(), flight()
    awaited = AwaitedImpacts(gravity_W=world.gravity_W)
    awaited.see("brick", states)
    awaited.expect(answer, now_ns=STRIKE_NS - 1)
    (found,) = awaited.see(answer.body_name, [])
    picture = Picture(recording, world, surface_side=0.5)
    picture.add_states("brick", states)
    picture.show(answer)
    drawn = read()
    np.testing.assert_array_equal(drawn.series(f"{SPEED}measured", "Scalars:scalars"), found.measured_speeds)
    assert drawn.last("/world/impact/brick/velocity_label", "Points3D:labels")[1].startswith("measured after")
