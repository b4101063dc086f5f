from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.tumbling import free_motion
from contact_dynamics.viewing.shape import convex_shape
from contact_dynamics.viewing.trajectory import MOST_PATH_POINTS, OUTLINES, draw_trajectory

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.world import Body
    from viewing.drawn import Drawn

PREDICTED = "/world/predicted/brick"


def test_path_outlines_and_end_are_those_of_the_trajectory(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, trajectory: Trajectory
) -> None:
    draw_trajectory(recording, "brick", convex_shape(body.vertices_B), trajectory)
    drawn = read()
    path = drawn.array(f"{PREDICTED}/path", "LineStrips3D:strips")[0]
    np.testing.assert_allclose(path, trajectory.p_WB_W, atol=1e-6)
    end = drawn.array(f"{PREDICTED}/end", "Transform3D:translation")[0]
    np.testing.assert_allclose(end, trajectory.p_WB_W[-1], atol=1e-6)
    turned = drawn.array(f"{PREDICTED}/end", "Transform3D:quaternion")[0]
    np.testing.assert_allclose(turned, trajectory.q_WB[-1], atol=1e-6)
    outlines = drawn.array(f"{PREDICTED}/outlines", "LineStrips3D:strips").reshape(OUTLINES, 24, 3)
    for outline in outlines:
        sample = int(np.linalg.norm(trajectory.p_WB_W - outline.mean(axis=0), axis=1).argmin())
        turned_vertices = Rotation.from_quat(trajectory.q_WB[sample]).apply(body.vertices_B.copy())
        corners = trajectory.p_WB_W[sample] + turned_vertices
        distances = np.linalg.norm(outline[:, None] - corners, axis=2).min(axis=1)
        np.testing.assert_allclose(distances, 0.0, atol=1e-6)


@pytest.mark.parametrize("samples", [1, 2, 3, 50 * MOST_PATH_POINTS + 7])
def test_any_number_of_samples_keeps_both_ends(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, state: BodyState, samples: int
) -> None:
    trajectory = free_motion(body.mass_properties, state).at(np.linspace(0.0, 0.5, samples))
    draw_trajectory(recording, "brick", convex_shape(body.vertices_B), trajectory)
    path = read().array(f"{PREDICTED}/path", "LineStrips3D:strips")[0]
    assert len(path) == min(samples, MOST_PATH_POINTS)
    np.testing.assert_allclose(path[[0, -1]], trajectory.p_WB_W[[0, -1]], atol=1e-6)


def test_an_empty_trajectory_takes_away_the_former(
    recording: rr.RecordingStream,
    read: Callable[[], Drawn],
    body: Body,
    state: BodyState,
    trajectory: Trajectory,
) -> None:
    shape = convex_shape(body.vertices_B)
    draw_trajectory(recording, "brick", shape, trajectory)
    draw_trajectory(recording, "brick", shape, free_motion(body.mass_properties, state).at([]))
    assert read().last(PREDICTED, "Clear:is_recursive") == [True]


def test_a_body_without_shape_has_a_path_all_the_same(
    recording: rr.RecordingStream, read: Callable[[], Drawn], trajectory: Trajectory
) -> None:
    draw_trajectory(recording, "brick", convex_shape(np.zeros((0, 3))), trajectory)
    drawn = read()
    assert f"{PREDICTED}/path" in drawn.entities
    assert f"{PREDICTED}/end/faces" not in drawn.entities
