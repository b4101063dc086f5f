# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, free_motion
from contact_dynamics.diagrams.poinsot import ellipsoid_net
from contact_dynamics.questions import TumblingAnswer
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tumbling import FreeMotion
from contact_dynamics.tumbling.poinsot_construction import poinsot, rolling_curves
from contact_dynamics.viewing.in_view import count_of_flight, draw_poinsot, draw_rolling
from contact_dynamics.viewing.picture import Picture
from viewing.answers import tumbling_answer
from viewing.drawn import Canvas, read_drawn
from viewing.known import BODY, STATE, WORLD

PATH = "/poinsot/bodies/brick"


def answer_of(motion: FreeMotion) -> TumblingAnswer:
    """The motion for 0.1 s, with the curves of its rotation."""
    return tumbling_answer(
        motion.state, motion.at([0.0, 0.1]), poinsot=poinsot(motion), curves=rolling_curves(motion, 50)
    )


def test_the_net_lies_on_the_ellipsoid() -> None:
    semi_axes = np.array([3.0, 2.0, 0.5])
    points = np.vstack(ellipsoid_net(semi_axes))
    np.testing.assert_allclose(np.sum((points / semi_axes) ** 2, axis=1), 1.0, rtol=1e-12)


def test_the_ellipsoid_touches_the_plane_where_the_angular_velocity_ends(canvas: Canvas) -> None:
    motion = free_motion(BODY.mass_properties, STATE, gravity_W=(0.0, 0.0, 0.0))
    constants = poinsot(motion)
    curves = rolling_curves(motion, 50)
    states = [motion.state_at(seconds) for seconds in curves.seconds.tolist()]
    draw_poinsot(canvas.stream, "brick", constants, curves)
    draw_rolling(canvas.stream, "brick", sorted(states, key=lambda state: state.stamp_ns))
    draw_rolling(canvas.stream, "brick", [])
    drawn = canvas.read()
    view = drawn.array(PATH, "Transform3D:mat3x3")[0].reshape(3, 3).T  # stored by columns
    np.testing.assert_allclose(view @ view.T * constants.ellipsoid_semi_axes.max() ** 2, np.eye(3), atol=1e-5)
    down = view @ constants.L_W
    np.testing.assert_allclose(down / np.linalg.norm(down), [0.0, 0.0, -1.0], atol=1e-6)
    polhode = drawn.array(f"{PATH}/body/polhode", "LineStrips3D:strips")[0]
    turns = drawn.series(f"{PATH}/body", "Transform3D:quaternion")
    rates = drawn.series(f"{PATH}/angular_velocity", "Arrows3D:vectors")
    net = np.vstack(drawn.array(f"{PATH}/body/ellipsoid", "LineStrips3D:strips"))
    size = float(np.linalg.norm(rates, axis=1).max())
    for i, (turn, rate) in enumerate(zip(turns, rates, strict=True)):
        # float32 vectors carry 1e-7 of their size
        np.testing.assert_allclose(rotation_matrix(turn) @ polhode[i], rate, atol=1e-6 * size)
        heights = net @ rotation_matrix(turn).T @ view[2]
        assert heights.min() >= view[2] @ rate - 1e-6  # all of the ellipsoid is above the plane
    assert view[2] @ rates[0] == pytest.approx(view[2] @ rates[-1], abs=1e-6)


def flight_with_an_impact(body: Body, state: BodyState) -> tuple[list[BodyState], list[BodyState]]:
    """Twenty states of a flight, and twenty after something struck it."""
    times = np.linspace(0.0, 0.2, 21)[1:].tolist()
    before = [free_motion(body.mass_properties, state).state_at(seconds) for seconds in times]
    struck = replace(before[-1], w_WB_W=before[-1].w_WB_W + np.array([0.0, 6.0, 3.0]))
    after = [free_motion(body.mass_properties, struck).state_at(seconds) for seconds in times]
    return before, after


def test_states_belong_to_a_flight_until_its_angular_momentum_is_gone() -> None:
    picture = poinsot(free_motion(BODY.mass_properties, STATE))
    before, after = flight_with_an_impact(BODY, STATE)
    noisy = [replace(one, w_WB_W=1.05 * one.w_WB_W) for one in before]
    assert count_of_flight(picture, noisy) == len(noisy)
    assert count_of_flight(picture, before + after) == len(before)
    assert count_of_flight(picture, []) == 0


def test_an_impact_takes_the_ellipsoid_away_until_the_next_prediction(canvas: Canvas, tmp_path: Path) -> None:
    """Read back as a viewer looks: what is there at each stamp."""
    before, after = flight_with_an_impact(BODY, STATE)
    picture = Picture(canvas.stream, WORLD, surface_side=2.0)
    picture.add_states("brick", [STATE])
    picture.show(answer_of(free_motion(BODY.mass_properties, STATE)))
    picture.add_states("brick", before[:10])
    picture.add_states("brick", before[10:] + after[:5])
    picture.add_states("brick", after[5:10])
    picture.show(answer_of(free_motion(BODY.mass_properties, after[9])))
    picture.add_states("brick", after[10:])
    canvas.stream.disconnect()
    drawn = read_drawn(tmp_path / "drawn.rrd")
    turned = drawn.stamps(f"{PATH}/body", "Transform3D:quaternion")
    of_flights = [STATE, *before, after[9], *after[10:]]
    assert turned == [one.stamp_ns for one in of_flights]
    assert drawn.stamps(f"{PATH}/angular_velocity", "Arrows3D:vectors") == turned
    for name in ("body/ellipsoid", "body/polhode", "herpolhode", "plane/grid"):
        stamps = drawn.stamps(f"{PATH}/{name}", "LineStrips3D:strips")
        assert stamps == [STATE.stamp_ns, after[9].stamp_ns]
    assert drawn.values[PATH, "Clear:is_recursive"] == [(after[0].stamp_ns, [True])]
