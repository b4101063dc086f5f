# SPDX-License-Identifier: Apache-2.0
"""What was measured: poses, trails and curves, and the velocity after an impact beside the predicted one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import rerun as rr
from scipy.spatial.transform import Rotation

from contact_dynamics import Body, BodyState, free_motion
from contact_dynamics.diagrams.after_impact import LATE_S, SPAN_S, AwaitedImpacts
from contact_dynamics.validation import FloatArray
from contact_dynamics.viewing.columns import pose_columns, scalar_columns, strip_columns, strips_2d, strips_3d
from contact_dynamics.viewing.measured import curves_of, draw_prediction_at, draw_states, style_series
from contact_dynamics.viewing.picture import Picture
from diagrams.test_after_impact import STRIKE_NS, prediction
from diagrams.test_after_impact import flight as struck_flight
from viewing.drawn import STAMP_NS, Canvas
from viewing.known import BODY, STATE, TRAJECTORY, WORLD

UP = np.array([0.0, 0.0, 1.0])
ODD_NS = 4_166_667  # 240 Hz, to a whole ns


def flight(body: Body, state: BodyState, count: int) -> list[BodyState]:
    motion = free_motion(body.mass_properties, state)
    return [motion.state_at(i * ODD_NS * 1e-9) for i in range(count)]


def test_states_are_drawn_at_their_stamps_to_the_nanosecond(canvas: Canvas) -> None:
    states = flight(BODY, STATE, 7)
    draw_states(canvas.stream, "brick", states[:4], before=None, up_W=UP)
    draw_states(canvas.stream, "brick", states[4:], before=states[3], up_W=UP)
    drawn = canvas.read()
    pose = "/world/bodies/brick"
    expected = [STAMP_NS + i * ODD_NS for i in range(7)]
    assert drawn.stamps(pose, "Transform3D:translation") == expected
    positions = np.array([s.p_WB_W for s in states])
    np.testing.assert_allclose(drawn.series(pose, "Transform3D:translation"), positions, rtol=1e-6)
    orientations = np.array([s.q_WB for s in states])
    np.testing.assert_allclose(drawn.series(pose, "Transform3D:quaternion"), orientations, atol=1e-6)
    heights = drawn.series("/height/brick/measured", "Scalars:scalars")
    speeds = drawn.series("/speed/brick/measured", "Scalars:scalars")
    np.testing.assert_array_equal(heights, positions[:, 2])
    np.testing.assert_allclose(speeds, [np.linalg.norm(s.v_WB_W) for s in states], rtol=1e-15)


def test_the_trail_goes_on_where_the_last_batch_ended(canvas: Canvas) -> None:
    states = flight(BODY, STATE, 6)
    draw_states(canvas.stream, "brick", states[:3], before=None, up_W=UP)
    draw_states(canvas.stream, "brick", states[3:], before=states[2], up_W=UP)
    segments = canvas.read().series("/world/trails/brick", "LineStrips3D:strips")
    assert segments.shape == (6, 2, 3)
    np.testing.assert_array_equal(segments[1:, 0], segments[:-1, 1])


def test_the_trail_has_a_gap_where_the_body_was_put_elsewhere(canvas: Canvas) -> None:
    """As a simulation does that begins anew; a state in between that got lost is no gap."""
    states = flight(BODY, STATE, 9)
    elsewhere = [replace(s, p_WB_W=s.p_WB_W + 0.3 * UP) for s in states[5:]]
    draw_states(canvas.stream, "brick", states[:3], before=None, up_W=UP)
    draw_states(canvas.stream, "brick", [states[4], *elsewhere], before=states[2], up_W=UP)
    segments = canvas.read().series("/world/trails/brick", "LineStrips3D:strips")
    lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    assert np.flatnonzero(lengths == 0.0).tolist() == [0, 4]
    np.testing.assert_allclose(segments[3, 0], states[2].p_WB_W, rtol=1e-6)


@pytest.mark.parametrize("back_s", [0.6, 10.0, 1000.0])
def test_the_trail_has_a_gap_where_the_clock_was_set_back(canvas: Canvas, back_s: float) -> None:
    anew = replace(STATE, p_WB_W=STATE.p_WB_W + UP, stamp_ns=STAMP_NS - round(1e9 * back_s))
    draw_states(canvas.stream, "brick", [anew], before=STATE, up_W=UP)
    ((begin, end),) = canvas.read().series("/world/trails/brick", "LineStrips3D:strips")
    np.testing.assert_array_equal(begin, end)


def test_height_counts_against_gravity(canvas: Canvas) -> None:
    draw_states(canvas.stream, "brick", [STATE], before=None, up_W=np.array([0.0, -1.0, 0.0]))
    assert canvas.read().last("/height/brick/measured", "Scalars:scalars") == [-STATE.p_WB_W[1]]


def test_a_prediction_is_drawn_where_it_reaches_and_nowhere_else(canvas: Canvas) -> None:
    ends_ns = STAMP_NS + 400_000_000
    stamps = [STAMP_NS - 1, STAMP_NS, STAMP_NS + 123_456_789, ends_ns, ends_ns + 1_000, ends_ns + 2_000]
    measured = [replace(STATE, stamp_ns=stamp_ns) for stamp_ns in stamps]
    curves = curves_of(TRAJECTORY, up_W=UP)
    draw_prediction_at(
        canvas.stream, "brick", measured, trajectory=TRAJECTORY, curves=curves, begin_ns=STAMP_NS
    )
    drawn = canvas.read()
    assert drawn.stamps("/height/brick/predicted", "Scalars:scalars")[:3] == stamps[1:4]
    seconds = np.array([0.0, 0.123456789, 0.4])
    falling = STATE.p_WB_W[2] + seconds * (STATE.v_WB_W[2] - 0.5 * 9.80665 * seconds)
    heights = [value[0] for _, value in drawn.values["/height/brick/predicted", "Scalars:scalars"][:3]]
    # Straight lines between samples 10 ms apart leave a parabola by at most g dt^2 / 8.
    np.testing.assert_allclose(heights, falling, atol=9.80665 * 0.01**2 / 8.0 + 1e-12)
    cleared = drawn.values["/height/brick/predicted", "Clear:is_recursive"]
    assert [stamp for stamp, _ in cleared] == [stamps[4]]
    places = [np.interp(each, TRAJECTORY.seconds, axis) for each in seconds for axis in TRAJECTORY.p_WB_W.T]
    apart = np.linalg.norm(np.reshape(places, (3, 3)) - STATE.p_WB_W, axis=1)
    errors = [value[0] for _, value in drawn.values["/error/brick", "Scalars:scalars"][:3]]
    np.testing.assert_allclose(errors, apart, atol=1e-12)


def test_energy_and_momenta_are_those_of_the_states(canvas: Canvas) -> None:
    """In free flight energy and angular momentum stay, and the momentum gains m g t."""
    states, known, gravity_W = flight(BODY, STATE, 50), BODY.mass_properties, np.array([0.0, 0.0, -9.80665])
    draw_states(canvas.stream, "brick", states, before=None, up_W=UP, body=known, gravity_W=gravity_W)
    drawn = canvas.read()
    energy, momentum, angular_momentum, spin = (
        drawn.series(f"/{quantity}/brick/measured", "Scalars:scalars")
        for quantity in ("energy", "momentum", "angular_momentum", "angular_velocity")
    )
    R_WB = Rotation.from_quat(STATE.q_WB).as_matrix()
    L_W = R_WB @ known.I_B @ R_WB.T @ STATE.w_WB_W
    kinetic = 0.5 * known.mass * STATE.v_WB_W @ STATE.v_WB_W + 0.5 * STATE.w_WB_W @ L_W
    np.testing.assert_allclose(energy, kinetic + known.mass * 9.80665 * STATE.p_WB_W[2], rtol=1e-12)
    np.testing.assert_allclose(angular_momentum, np.linalg.norm(L_W), rtol=1e-12)
    np.testing.assert_allclose(spin, [np.linalg.norm(each.w_WB_W) for each in states], rtol=1e-12)
    assert np.ptp(spin) > 0.01 * spin[0]  # it changes where the angular momentum does not
    seconds = 1e-9 * ODD_NS * np.arange(50)
    expected = known.mass * (STATE.v_WB_W + seconds[:, None] * gravity_W)
    np.testing.assert_allclose(momentum, np.linalg.norm(expected, axis=1), rtol=1e-12)


def test_what_is_not_known_has_no_energy(canvas: Canvas) -> None:
    draw_states(canvas.stream, "brick", [STATE], before=None, up_W=UP)
    assert "/energy/brick/measured" not in canvas.read().entities


def test_a_prediction_without_samples_draws_nothing(canvas: Canvas) -> None:
    empty = free_motion(BODY.mass_properties, STATE).at([])
    draw_prediction_at(canvas.stream, "brick", [STATE], trajectory=empty, curves={}, begin_ns=STAMP_NS)
    assert "/height/brick/predicted" not in canvas.read().entities


def test_curves_are_named_by_body(canvas: Canvas) -> None:
    style_series(canvas.stream, "brick")
    assert canvas.read().last("/speed/brick/predicted", "SeriesLines:names") == ["brick predicted"]


SPEED = "/speed/brick/after\\ impact\\,\\ "


def test_the_measured_velocity_stands_beside_the_predicted_one(canvas: Canvas) -> None:
    answer, states = prediction(), struck_flight()
    awaited = AwaitedImpacts(gravity_W=WORLD.gravity_W)
    awaited.expect(answer, now_ns=STRIKE_NS - 1)
    (found,) = awaited.see("brick", states)
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    picture.show(answer)
    picture.add_states("brick", states)
    drawn = canvas.read()
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


def test_an_answer_that_comes_after_the_states_is_drawn_alike(canvas: Canvas) -> None:
    answer, states = prediction(), struck_flight()
    awaited = AwaitedImpacts(gravity_W=WORLD.gravity_W)
    awaited.see("brick", states)
    awaited.expect(answer, now_ns=STRIKE_NS - 1)
    (found,) = awaited.see(answer.body_name, [])
    picture = Picture(canvas.stream, WORLD, surface_side=0.5)
    picture.add_states("brick", states)
    picture.show(answer)
    drawn = canvas.read()
    np.testing.assert_array_equal(drawn.series(f"{SPEED}measured", "Scalars:scalars"), found.measured_speeds)
    assert drawn.last("/world/impact/brick/velocity_label", "Points3D:labels")[1].startswith("measured after")


RNG = np.random.default_rng(5)

POINTS, TURNS, PAIRS = RNG.random((5, 3)), RNG.random((5, 4)), RNG.random((5, 2, 3))


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (scalar_columns(POINTS[:, 0]), rr.Scalars.columns(scalars=POINTS[:, 0])),
        (pose_columns(POINTS, TURNS), rr.Transform3D.columns(translation=POINTS, quaternion=TURNS)),
        (strip_columns(PAIRS), rr.LineStrips3D.columns(strips=list(PAIRS))),
    ],
    ids=["scalars", "poses", "strips"],
)
def test_columns(made: list[rr.ComponentColumn], expected: rr.ComponentColumnList) -> None:
    for ours, theirs in zip(made, expected, strict=True):
        assert ours.component_descriptor() == theirs.component_descriptor()
        assert ours.as_arrow_array().equals(theirs.as_arrow_array())


@pytest.mark.parametrize("counts", [(), (2,), (3, 2, 7)], ids=str)
def test_strips(counts: tuple[int, ...]) -> None:
    flat: list[FloatArray] = [RNG.random((count, 2)) for count in counts]
    spatial: list[FloatArray] = [RNG.random((count, 3)) for count in counts]
    assert strips_2d(flat).equals(rr.components.LineStrip2DBatch(flat).as_arrow_array())
    assert strips_3d(spatial).equals(rr.components.LineStrip3DBatch(spatial).as_arrow_array())
