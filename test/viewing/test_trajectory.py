from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.shape import convex_shape
from contact_dynamics.motion.covariance import CarriedCovariance, PropagationMethod, orientation_deviations
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tumbling import free_motion
from contact_dynamics.viewing.trajectory import (
    DEVIATIONS,
    MAX_OUTLINES,
    MAX_PATH_POINTS,
    draw_trajectory,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray
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
    end = drawn.array(f"{PREDICTED}/newest_end", "Transform3D:translation")[0]
    np.testing.assert_allclose(end, trajectory.p_WB_W[-1], atol=1e-6)
    turned = drawn.array(f"{PREDICTED}/newest_end", "Transform3D:quaternion")[0]
    np.testing.assert_allclose(turned, trajectory.q_WB[-1], atol=1e-6)
    outlines = drawn.array(f"{PREDICTED}/outlines", "LineStrips3D:strips").reshape(-1, 24, 3)
    ends = drawn.array(f"{PREDICTED}/end", "LineStrips3D:strips").reshape(-1, 24, 3)
    np.testing.assert_allclose(ends[0].mean(axis=0), trajectory.p_WB_W[-1], atol=1e-6)
    assert len(outlines) > 0
    for outline in (*outlines, *ends):
        sample = int(np.linalg.norm(trajectory.p_WB_W - outline.mean(axis=0), axis=1).argmin())
        turned_vertices = Rotation.from_quat(trajectory.q_WB[sample]).apply(body.vertices_B.copy())
        corners = trajectory.p_WB_W[sample] + turned_vertices
        distances = np.linalg.norm(outline[:, None] - corners, axis=2).min(axis=1)
        np.testing.assert_allclose(distances, 0.0, atol=1e-6)


def carried_along(trajectory: Trajectory, covariances: FloatArray, trusted: np.ndarray) -> CarriedCovariance:
    return CarriedCovariance(
        seconds=trajectory.seconds,
        covariances=covariances,
        orientation_deviations=orientation_deviations(covariances),
        trusted=trusted,
        method=PropagationMethod.LINEARISED,
    )


def test_ellipsoids_have_two_deviations_along_the_axes_of_the_covariance(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, trajectory: Trajectory
) -> None:
    axes = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()
    deviations = np.array([0.01, 0.02, 0.05])
    covariance = axes @ np.diag(deviations**2) @ axes.T
    growing = np.zeros((len(trajectory), 12, 12))
    growing[:, :3, :3] = covariance * np.linspace(0.0, 1.0, len(trajectory))[:, None, None]
    trusted = np.array([True] * (len(trajectory) - 1) + [False])
    carried = carried_along(trajectory, growing, trusted)
    draw_trajectory(recording, "brick", convex_shape(body.vertices_B), trajectory, covariance=carried)
    drawn = read()
    path = f"{PREDICTED}/uncertainty"
    np.testing.assert_allclose(
        drawn.array(path, "Ellipsoids3D:centers")[-1], trajectory.p_WB_W[-1], atol=1e-6
    )
    half_axes = drawn.array(path, "Ellipsoids3D:half_sizes")[-1]
    np.testing.assert_allclose(np.sort(half_axes), DEVIATIONS * deviations, rtol=1e-5)
    R = Rotation.from_quat(drawn.array(path, "Ellipsoids3D:quaternions")[-1]).as_matrix()
    found = R @ np.diag((half_axes / DEVIATIONS) ** 2) @ R.T
    np.testing.assert_allclose(found, covariance, atol=1e-7)
    first, *_, last = drawn.last(path, "Ellipsoids3D:colors")
    assert (first.to_bytes(4, "big"), last.to_bytes(4, "big")) == (
        bytes(palette.PREDICTED),
        bytes(palette.UNDECIDED),
    )


def test_what_no_double_holds_is_not_drawn(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, trajectory: Trajectory
) -> None:
    n = len(trajectory)
    unknown = carried_along(trajectory, np.full((n, 12, 12), np.nan), np.zeros(n, dtype=bool))
    draw_trajectory(recording, "brick", convex_shape(body.vertices_B), trajectory, covariance=unknown)
    assert read().last(f"{PREDICTED}/uncertainty", "Ellipsoids3D:centers") == []


@pytest.mark.parametrize("samples", [1, 2, 3, 50 * MAX_PATH_POINTS + 7])
def test_any_number_of_samples_keeps_both_ends(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, state: BodyState, samples: int
) -> None:
    trajectory = free_motion(body.mass_properties, state).at(np.linspace(0.0, 0.5, samples))
    draw_trajectory(recording, "brick", convex_shape(body.vertices_B), trajectory)
    path = read().array(f"{PREDICTED}/path", "LineStrips3D:strips")[0]
    assert len(path) == min(samples, MAX_PATH_POINTS)
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
    assert drawn.last(f"{PREDICTED}/end", "LineStrips3D:strips") == []


@pytest.mark.parametrize(("speed", "count"), [(0.0, 0), (1.0, 0), (10.0, 2), (1000.0, MAX_OUTLINES)])
def test_a_longer_path_has_more_outlines(
    recording: rr.RecordingStream, read: Callable[[], Drawn], *, body: Body, speed: float, count: int
) -> None:
    """The time is 0.05 s, and the box is 0.182 m from corner to corner."""
    start = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
        v_WB_W=np.array([speed, 0, 0]),
        w_WB_W=np.zeros(3),
    )
    flight = free_motion(body.mass_properties, start, gravity_W=np.zeros(3)).at(np.linspace(0.0, 0.05, 50))
    draw_trajectory(recording, "brick", convex_shape(body.vertices_B), flight)
    drawn = read()
    assert len(drawn.last(f"{PREDICTED}/outlines", "LineStrips3D:strips")) == 12 * count
    assert len(drawn.last(f"{PREDICTED}/end", "LineStrips3D:strips")) == 12 * (speed > 0.0)
    assert ((f"{PREDICTED}/newest_end/faces", "Mesh3D:vertex_positions") in drawn.values) == (speed > 0.0)
