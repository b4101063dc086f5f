# SPDX-License-Identifier: Apache-2.0
"""Questions about tumbling, asked in Python, beside the parabola and steady spin."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError, NoContactError, TooLargeError, UnknownBodyError
from contact_dynamics.motion import ConstantWrench, Drag, Method, WrenchAxes
from contact_dynamics.questions import (
    AtRate,
    AtStamps,
    AtTimes,
    EventKind,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.context import Context
from contact_dynamics.questions.tumbling import MAX_CURVE_POINTS, answer
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.shapes import Obstacle
from contact_dynamics.tumbling import Regime
from contact_dynamics.world import Body, World, box_vertices
from questions.known_world import CONTEXT, CUBE, GRAVITY, MASS, MOMENT, SIDE, state

ROUNDING = 1e-12  # a few operations on numbers of order 1 to 10
TOSSED = state(v=(1.0, -0.5, 2.0), w=(0.0, 0.0, 3.0), stamp_ns=5_000_000_000)


def test_a_body_and_a_state_are_enough() -> None:
    """Without context: on the parabola, turning steadily, at 100 Hz for 2 s."""
    found = answer(TumblingQuestion(body=CUBE, state=TOSSED))
    t = found.trajectory.seconds
    np.testing.assert_allclose(t, np.arange(201) / 100.0, rtol=0.0, atol=ROUNDING)
    fallen = 1.0 + 2.0 * t - 0.5 * GRAVITY * t * t
    np.testing.assert_allclose(found.trajectory.p_WB_W[:, 2], fallen, rtol=0.0, atol=2e-11)
    half = 0.5 * 3.0 * t
    turned = np.column_stack([0 * t, 0 * t, np.sin(half), np.cos(half)])
    np.testing.assert_allclose(found.trajectory.q_WB, turned, rtol=0.0, atol=ROUNDING)
    assert found.method is Method.CLOSED_FORM
    assert found.poinsot is not None
    assert found.poinsot.regime is Regime.SPHERICAL
    assert found.poinsot.rotational_energy == pytest.approx(0.5 * MOMENT * 9.0)
    assert (found.event, found.covariance, found.fit, found.curves) == (None, None, None, None)
    assert (found.body_name, found.state) == ("cube", TOSSED)


def test_a_flight_through_the_floor_is_a_warning_that_names_the_first_sample_in_it() -> None:
    """The cube of 0.2 m falls level, so it touches the floor when its centre is 0.1 m above."""
    falling = state(0.5)
    touches = math.sqrt(2.0 * (0.5 - 0.5 * SIDE) / GRAVITY)
    for times, warned in (([0.0, 0.99 * touches], False), ([0.0, 0.99 * touches, 1.01 * touches, 1.0], True)):
        found = answer(TumblingQuestion(body="cube", state=falling, sampling=AtTimes(times=times)), CONTEXT)
        if warned:
            deep = 0.5 * GRAVITY * (1.01**2 - 1.0) * touches**2
            (warning,) = found.warnings
            assert warning == (
                f"free flight ignores surfaces: at sample 2 'cube' would be {deep:.3g} m deep in 'floor'"
            )
        else:
            assert found.warnings == ()


@pytest.mark.parametrize(("aside", "warned"), [(0.0, True), (0.199, True), (0.201, False)])
def test_a_flight_through_an_obstacle_is_a_warning(aside: float, warned: bool) -> None:  # noqa: FBT001
    """The cube of 0.2 m falls past a box of the same size, or through it from 0.2 m above its top."""
    corners = box_vertices((SIDE, SIDE, SIDE)) + np.array([aside, 0.0, 0.0])
    box = Obstacle(name="box", vertices_W=corners, friction=0.3, restitution=0.0)
    known = Context(world=World(bodies=(CUBE,), surfaces=(box,)))
    times = np.linspace(0.0, 1.0, 101)
    found = answer(TumblingQuestion(body="cube", state=state(0.4), sampling=AtTimes(times=times)), known)
    if not warned:
        assert found.warnings == ()
        return
    (warning,) = found.warnings
    first = int(np.argmax(0.5 * GRAVITY * times**2 > 0.2))
    assert warning.startswith(f"free flight ignores surfaces: at sample {first} 'cube' would be ")
    deep = min(0.5 * GRAVITY * times[first] ** 2 - 0.2, SIDE - aside)
    assert warning.endswith(f"{deep:.3g} m deep in 'box'")


def test_a_flight_beside_an_obstacle_in_a_notch_is_no_warning() -> None:
    """The convex hull of a hook is in a bar below its plate. Its parts are so only 0.2 m further down."""
    plate, leg = Body.box((0.3, 0.1, 0.05), density=1e3), Body.box((0.05, 0.1, 0.2), density=1e3)
    hook = Body.union([plate.placed([0.15, 0, 0.225]), leg.placed([0.025, 0, 0.1])], name="hook")
    corners = box_vertices((0.1, 0.5, 0.1)) + np.array([0.15, 0.0, 0.0])
    bar = Obstacle(name="bar", vertices_W=corners, friction=0.3, restitution=0.2)
    at_rest = BodyState(p_WB_W=hook.p_FB_F + np.array([0.0, 0.0, 0.05]), q_WB=[0.0, 0.0, 0.0, 1.0])
    known = Context(world=World(bodies=(hook,), surfaces=(bar,)))
    for last, warnings in ((0.2, 0), (0.21, 1)):  # it falls by 0.2 m in 0.202 s
        times = AtTimes(times=np.linspace(0.0, last, 21))
        found = answer(TumblingQuestion(body="hook", state=at_rest, sampling=times), known)
        assert len(found.warnings) == warnings


def test_stamps_reach_into_the_past() -> None:
    found = answer(
        TumblingQuestion(body=CUBE, state=TOSSED, sampling=AtStamps(stamps_ns=[4_900_000_000, 5_000_000_000]))
    )
    np.testing.assert_array_equal(found.trajectory.seconds, [-0.1, 0.0])
    before = 1.0 - 0.2 - 0.5 * GRAVITY * 0.01
    assert found.trajectory.p_WB_W[0, 2] == pytest.approx(before, abs=ROUNDING)


def test_it_ends_where_a_corner_meets_the_floor() -> None:
    """The lower face of a cube that does not turn falls by what its centre is above half a side."""
    question = TumblingQuestion(body="cube", state=state(), sampling=UntilContact(rate=10.0, duration=1.0))
    found = answer(question, CONTEXT)
    seconds = math.sqrt(2.0 * (1.0 - 0.5 * SIDE) / GRAVITY)
    assert found.event is not None
    assert (found.event.kind, found.event.surface) == (EventKind.CONTACT, "floor")
    assert found.event.seconds == pytest.approx(seconds, abs=ROUNDING)
    assert found.event.velocity_W[2] == pytest.approx(-GRAVITY * seconds, abs=1e-11)
    assert found.trajectory.seconds[-1] == found.event.seconds


def test_a_point_reaches_a_plane_from_the_side_of_its_normal() -> None:
    """Thrown up past a height, it reaches it on the way down, or on the way up if the normal points down."""
    lowest = [0, 0, -0.5 * SIDE]
    sampling = UntilPlane(
        plane_point=[0, 0, 1.5 - 0.5 * SIDE], plane_normal=[0, 0, 1], body_point=lowest, duration=3.0
    )
    up = TumblingQuestion(body=CUBE, state=state(v=(0.0, 0.0, 5.0)), sampling=sampling)
    root = math.sqrt(5.0**2 - 2.0 * GRAVITY * 0.5)
    for normal, seconds in (([0, 0, 1], (5.0 + root) / GRAVITY), ([0, 0, -1], (5.0 - root) / GRAVITY)):
        event = answer(replace(up, sampling=replace(sampling, plane_normal=normal))).event
        assert event is not None
        assert (event.kind, event.surface) == (EventKind.PLANE_REACHED, "")
        assert event.seconds == pytest.approx(seconds, abs=ROUNDING)
    with pytest.raises(
        InvalidFieldError, match=r"plane_normal must be .* 0\.5 m behind the plane and moves away"
    ):
        answer(replace(up, state=state(v=(0.0, 0.0, -1.0))))


def test_a_torque_spins_it_up_and_leaves_no_poinsot() -> None:
    """About a fixed axis in the body the angular velocity grows by N t / I."""
    torque = 0.01
    question = TumblingQuestion(
        body=CUBE,
        state=TOSSED,
        wrench=ConstantWrench(torque=[0, 0, torque], axes=WrenchAxes.BODY),
        sampling=AtTimes(times=[0.5]),
        curve_points=5,
    )
    found = answer(question)
    assert found.method is Method.INTEGRATED
    assert (found.poinsot, found.flips, found.curves) == (None, None, None)
    assert found.trajectory.w_WB_W[0, 2] == pytest.approx(3.0 + 0.5 * torque / MOMENT, abs=1e-10)


def test_linear_drag_slows_it_down() -> None:
    """Without gravity v(t) = v0 exp(-k t / m)."""
    k = 0.3
    question = TumblingQuestion(
        body=CUBE, state=TOSSED, gravity_W=[0, 0, 0], drag=Drag(linear=k), sampling=AtTimes(times=[1.0])
    )
    found = answer(question)
    expected = TOSSED.v_WB_W * math.exp(-k / MASS)
    np.testing.assert_allclose(found.trajectory.v_WB_W[0], expected, rtol=0.0, atol=1e-11)
    assert found.poinsot is not None  # nothing turns it


def test_a_covariance_grows_with_the_square_of_time() -> None:
    """Position: var(p) + t^2 var(v), where the two are independent."""
    covariance = np.diag([1e-6] * 3 + [1e-8] * 3 + [4e-4] * 3 + [1e-8] * 3)
    question = TumblingQuestion(
        body=CUBE,
        state=UncertainState(state=TOSSED, covariance=covariance),
        sampling=AtTimes(times=[0.0, 0.5]),
        include_covariance=True,
    )
    found = answer(question)
    assert found.covariance is not None
    assert found.covariance.covariances[1, 0, 0] == pytest.approx(1e-6 + 0.25 * 4e-4, rel=1e-9)
    assert found.covariance.trusted.all()
    with pytest.raises(InvalidFieldError, match=r"state\.covariance must be .*, got none"):
        answer(TumblingQuestion(body=CUBE, state=TOSSED, include_covariance=True))


def test_curves_have_as_many_points_as_asked_for() -> None:
    found = answer(TumblingQuestion(body=CUBE, state=TOSSED, curve_points=4))
    assert found.curves is not None
    assert found.curves.polhode_B.shape == (4, 3)
    with pytest.raises(TooLargeError, match=r"curve_points must be .*, got 10001"):
        TumblingQuestion(body=CUBE, curve_points=MAX_CURVE_POINTS + 1)


@pytest.mark.parametrize(
    ("question", "error", "words"),
    [
        (TumblingQuestion(body="dog", state=TOSSED), UnknownBodyError, "got 'dog'"),
        (
            TumblingQuestion(
                body=CUBE, state=TOSSED, drag=Drag(linear=1.0), sampling=AtRate(duration=1000.0)
            ),
            InvalidFieldError,
            "must be at most 100 under torque or drag.*, got .*turns of the body ahead",
        ),
        (
            TumblingQuestion(body=CUBE, state=TOSSED, sampling=AtRate(rate=1e6)),
            TooLargeError,
            "rate . duration must be .*, got 2000000 samples",
        ),
    ],
)
def test_what_is_not_allowed_is_named(question: TumblingQuestion, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        answer(question)


def test_a_body_without_a_shape_meets_no_surface() -> None:
    bare = CUBE.__class__(name="bare", mass_properties=CUBE.mass_properties)
    with pytest.raises(NoContactError, match="must have `vertices_B` or a `shape`"):
        answer(TumblingQuestion(body=bare, state=TOSSED, sampling=UntilContact()))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: AtTimes(times=[0.0, 0.2, 0.1]), r"times\[2\] must be .*, got 0.1 s before times\[1\]"),
        (lambda: AtTimes(times=[]), "times must be at least one time.*, got none"),
        (lambda: AtStamps(stamps_ns=[]), "stamps_ns must be at least one stamp.*, got none"),
        (
            lambda: AtStamps(stamps_ns=[2_000_000_000, 0]),
            r"stamps_ns\[1\] must be .*, got 2 s before stamps_ns\[0\]",
        ),
    ],
)
def test_times_without_sense_are_refused(make: Callable[[], object], words: str) -> None:
    with pytest.raises(InvalidFieldError, match=words):
        make()


@pytest.mark.parametrize("make", [lambda n: AtTimes(times=range(n)), lambda n: AtStamps(stamps_ns=range(n))])
def test_too_many_samples_are_refused(make: Callable[[int], object]) -> None:
    make(20_000)
    with pytest.raises(TooLargeError, match="got 20001 samples"):
        make(20_001)
