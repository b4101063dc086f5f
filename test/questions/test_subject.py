# SPDX-License-Identifier: Apache-2.0
"""Which body and state a question is about: said, published, fitted, or with another mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, MassProperties
from contact_dynamics.errors import (
    InvalidFieldError,
    NoStateError,
    NotInFlightError,
    StaleStateError,
    UnknownBodyError,
)
from contact_dynamics.motion import ConstantWrench, Drag, Method
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.questions import (
    AtTimes,
    ContactModeQuestion,
    Context,
    PublishedState,
    StateStore,
    TumblingQuestion,
    UncertainState,
    ask,
    tumbling,
)
from contact_dynamics.questions.subject import changed_body, subject_of
from contact_dynamics.rotations.many import matrices_of
from questions.known_world import CUBE, GRAVITY, MASS, SIDE, WORLD, state

MS = 1_000_000  # ns
V0 = 2.0  # m/s


def rising(stamp_ns: int) -> BodyState:
    """Return the cube, tossed upwards at stamp 0, turning about z."""
    t = 1e-9 * stamp_ns
    return BodyState(
        p_WB_W=[0.0, 0.0, 1.0 + V0 * t - 0.5 * GRAVITY * t * t],
        q_WB=[0.0, 0.0, np.sin(1.5 * t), np.cos(1.5 * t)],
        v_WB_W=[0.0, 0.0, V0 - GRAVITY * t],
        w_WB_W=[0.0, 0.0, 3.0],
        stamp_ns=stamp_ns,
    )


def watching(*stamps_ns: int, now_ns: int | None = None) -> Context:
    """Return what is known after states of the cube were published."""
    states = StateStore(history=10.0, timeout=0.5)
    for stamp_ns in stamps_ns:
        states.add("cube", rising(stamp_ns))
    return Context(world=WORLD, states=states, now_ns=None if now_ns is None else lambda: now_ns)


def test_the_newest_state_is_taken_unless_another_is_asked_for() -> None:
    known = watching(0, 10 * MS, 20 * MS)
    assert subject_of("cube", PublishedState(), known).state.stamp_ns == 20 * MS
    assert subject_of("cube", PublishedState(stamp_ns=10 * MS), known).state.stamp_ns == 10 * MS
    assert subject_of(CUBE, PublishedState(stamp_ns=0), known).state.stamp_ns == 0


def check_rising(found: BodyState, stamp_ns: int) -> None:
    """The state is that of the toss; it is in closed form there, and a few operations on numbers near 1."""
    then = rising(stamp_ns)
    assert found.stamp_ns == stamp_ns
    for name in ("p_WB_W", "q_WB", "v_WB_W", "w_WB_W"):
        np.testing.assert_allclose(getattr(found, name), getattr(then, name), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("stamp_ns", [1, 7 * MS, 399 * MS, 400 * MS - 1])
def test_a_state_of_a_flight_is_interpolated_exactly(stamp_ns: int) -> None:
    """The parabola is a cubic too, and a steady spin turns about a fixed axis."""
    known = watching(0, 400 * MS)
    check_rising(subject_of("cube", PublishedState(stamp_ns=stamp_ns), known).state, stamp_ns)


def test_a_stamp_in_the_future_follows_the_free_motion() -> None:
    known = watching(0, 10 * MS, now_ns=20 * MS)
    check_rising(subject_of("cube", PublishedState(stamp_ns=300 * MS), known).state, 300 * MS)
    with pytest.raises(
        InvalidFieldError, match=r"stamp must be at most 2.*, got 2\.5 s after the latest state"
    ):
        subject_of("cube", PublishedState(stamp_ns=2510 * MS), known)
    with pytest.raises(StaleStateError, match=r"got 0\.600 s"):
        subject_of("cube", PublishedState(stamp_ns=700 * MS), watching(0, now_ns=600 * MS))


def test_a_body_in_contact_does_not_fall_after_its_latest_state() -> None:
    """Free motion would be an impact after 10 microseconds, and a cube in the floor after a millisecond."""
    lying, ahead = replace(state(0.5 * SIDE), stamp_ns=10 * MS), PublishedState(stamp_ns=15 * MS)
    known = replace(watching(), world=WORLD)
    known.states.add("cube", lying)
    found = subject_of("cube", ahead, known).state
    assert found.to_dict() == replace(lying, stamp_ns=15 * MS).to_dict()
    assert [mode.mode for mode in ask(ContactModeQuestion(body="cube", state=ahead), known).modes] == ["ffff"]
    known.states.add("cube", replace(lying.with_velocities([0.1, 0, 0], [0, 0, 0]), stamp_ns=11 * MS))
    with pytest.raises(
        InvalidFieldError, match=r"^stamp must be .* unless the body flies or rests, got 0.004 s"
    ):
        subject_of("cube", ahead, known)
    known.states.add("cube", replace(lying.with_velocities([0, 0, 0.1], [0, 0, 0]), stamp_ns=12 * MS))
    risen = 0.5 * SIDE + 0.1 * 0.003 - 0.5 * GRAVITY * 0.003**2
    assert subject_of("cube", ahead, known).state.p_WB_W[2] == pytest.approx(risen, abs=1e-12)


def test_a_measured_body_at_rest_does_not_fall_after_its_latest_state() -> None:
    chance, ahead = np.random.default_rng(8), PublishedState(stamp_ns=40 * MS)
    noise = np.repeat([2e-4, 2e-3, 0.02, 0.05], 3)  # m, rad, m/s, rad/s
    for k in range(20):
        error = noise * chance.normal(size=12)
        measured = BodyState(
            p_WB_W=np.array([0.0, 0.0, 0.5 * SIDE]) + error[:3],
            q_WB=[*(0.5 * error[3:6]), np.sqrt(1.0 - 0.25 * error[3:6] @ error[3:6])],
            v_WB_W=error[6:9],
            w_WB_W=error[9:],
            stamp_ns=(10 + k) * MS,
        )
        known = watching()
        known.states.add("cube", UncertainState(state=measured, covariance=np.diag(noise**2)))
        assert [mode.mode for mode in ask(ContactModeQuestion(body="cube", state=ahead), known).modes] == [
            "ffff"
        ]
    sliding = measured.with_velocities([0.3, 0.0, 0.0], [0.0, 0.0, 0.0])
    known.states.add("cube", UncertainState(state=sliding, covariance=np.diag(noise**2)))
    with pytest.raises(InvalidFieldError, match=r"^stamp must be .* unless the body flies or rests, got 0"):
        subject_of("cube", ahead, known)
    flying = UncertainState(state=replace(rising(10 * MS), stamp_ns=30 * MS), covariance=np.diag(noise**2))
    known.states.add("cube", flying)
    fallen = flying.state.v_WB_W[2] - GRAVITY * 0.01
    assert subject_of("cube", ahead, known).state.v_WB_W[2] == pytest.approx(fallen, abs=1e-12)


def test_a_stamp_in_a_gap_is_refused_and_that_of_a_state_is_not() -> None:
    """In half a second without states the body may have struck something."""
    known = watching(0, 600 * MS, now_ns=5000 * MS)
    with pytest.raises(
        StaleStateError, match=r"the states before and after it must be at most 0\.5 s apart .*, got 0\.600 s"
    ):
        subject_of("cube", PublishedState(stamp_ns=300 * MS), known)
    assert subject_of("cube", PublishedState(stamp_ns=600 * MS), known).state.stamp_ns == 600 * MS
    with pytest.raises(NoStateError, match="the oldest stored state is at 0 ns"):
        subject_of("cube", PublishedState(stamp_ns=-1), known)


def test_a_fit_to_the_states_before_a_stamp_is_followed_to_it() -> None:
    known = watching(*range(0, 200 * MS, 10 * MS))
    subject = subject_of("cube", PublishedState(stamp_ns=155 * MS, fit_window=0.1), known)
    assert subject.fit is not None
    assert subject.fit.count == 11  # of 50 to 150 ms
    assert subject.state.stamp_ns == 155 * MS
    np.testing.assert_allclose(subject.state.p_WB_W, rising(155 * MS).p_WB_W, rtol=0.0, atol=1e-10)
    assert subject.covariance is not None
    at_last = subject_of("cube", PublishedState(stamp_ns=150 * MS, fit_window=0.1), known).covariance
    assert at_last is not None
    assert subject.covariance[0, 0] > at_last[0, 0], "it grows on the way"


def test_a_state_says_how_it_changes_with_gravity() -> None:
    """As the same question has it in a world with another gravity."""
    known, pull = watching(*range(0, 200 * MS, 10 * MS)), np.array([0.2, -0.1, 0.3])
    heavier = replace(known, world=replace(known.world, gravity_W=known.world.gravity_W + pull))
    for source in (
        PublishedState(),
        PublishedState(stamp_ns=220 * MS),
        PublishedState(fit_window=0.1),
        PublishedState(stamp_ns=155 * MS, fit_window=0.1),
    ):
        one, other = (subject_of("cube", source, each) for each in (known, heavier))
        place, rate = one.by_gravity
        np.testing.assert_allclose(other.state.p_WB_W - one.state.p_WB_W, place * pull, atol=1e-12)
        np.testing.assert_allclose(other.state.v_WB_W - one.state.v_WB_W, rate * pull, atol=1e-12)
    assert subject_of("cube", PublishedState(), known).by_gravity == (0.0, 0.0)


def test_a_load_is_interpolated_about_its_own_centre_of_mass() -> None:
    """The centre moves beside the frame's origin, whose own path is no parabola."""
    offset = np.array([0.05, 0.0, 0.0])
    loaded = changed_body(CUBE, MassProperties(mass=3.0, I_B=0.1 * np.eye(3)), offset)
    found = subject_of(loaded, PublishedState(stamp_ns=5 * MS), watching(0, 10 * MS)).state
    then = subject_of(loaded, PublishedState(), watching(5 * MS)).state
    # A circle of radius 0.05 m, on which the centre turns by 0.03 rad: r a^4 / 384 is 1e-10 m.
    np.testing.assert_allclose(found.p_WB_W, then.p_WB_W, rtol=0.0, atol=2e-10)


def test_an_old_state_is_refused_only_by_a_clock() -> None:
    late = 600 * MS
    with pytest.raises(StaleStateError, match=r"must be at most 0\.5 s old .*, got 0\.600 s"):
        subject_of("cube", PublishedState(), watching(0, now_ns=late))
    assert subject_of("cube", PublishedState(), watching(0, now_ns=late - 200 * MS)).state.stamp_ns == 0
    assert subject_of("cube", PublishedState(), watching(0)).state.stamp_ns == 0


def test_a_fit_is_of_a_flight_under_the_forces_asked_for() -> None:
    """The cube rises steadily: without weight, or held by a force, against its drag too."""
    states = StateStore(history=10.0, timeout=0.5)
    for k in range(12):
        states.add("cube", state(1.0 + 0.02 * k, v=(0.0, 0.0, 2.0), stamp_ns=10 * k * MS))
    known = Context(world=WORLD, states=states)
    asked = TumblingQuestion(
        body="cube", state=PublishedState(fit_window=0.115), sampling=AtTimes(times=[0.0])
    )
    weight = MASS * GRAVITY
    with pytest.raises(NotInFlightError, match="got 12 states of a body that does not fall"):
        tumbling.answer(asked, known)
    for change, method in (
        ({"gravity_W": np.zeros(3)}, Method.CLOSED_FORM),
        ({"wrench": ConstantWrench(force=[0, 0, weight])}, Method.CLOSED_FORM),
        (
            {"wrench": ConstantWrench(force=[0, 0, weight + 0.2 * 2.0]), "drag": Drag(linear=0.2)},
            Method.INTEGRATED,
        ),
    ):
        found = tumbling.answer(replace(asked, **change), known)
        assert found.fit is not None
        assert (found.method, found.fit.count) == (method, 12)
        assert found.fit.position_residual < 1e-8
        assert found.state.v_WB_W[2] == pytest.approx(2.0, abs=1e-6)


def spinning(rate: float, per_second: float, *, published: float) -> Context:
    """Return what is known after ten states of the cube, which turns about z and rests otherwise."""
    states = StateStore(history=10.0, timeout=0.5)
    for k in range(10):
        half = 0.5 * rate * k / per_second
        states.add(
            "cube",
            BodyState(
                p_WB_W=[0.0, 0.0, -0.5 * GRAVITY * (k / per_second) ** 2],
                q_WB=[0.0, 0.0, np.sin(half), np.cos(half)],
                v_WB_W=[0.0, 0.0, -GRAVITY * k / per_second],
                w_WB_W=[0.0, 0.0, published],
                stamp_ns=round(1e9 * k / per_second),
            ),
        )
    return Context(world=WORLD, states=states)


@pytest.mark.parametrize(("rate", "per_second"), [(100.0, 30.0), (400.0, 120.0)])
def test_a_fit_and_a_state_between_two_turn_as_published(rate: float, per_second: float) -> None:
    """Each turns by 191 degrees from state to state."""
    known = spinning(rate, per_second, published=rate)
    fitted = subject_of("cube", PublishedState(fit_window=1.0), known).state
    np.testing.assert_allclose(fitted.w_WB_W, [0.0, 0.0, rate], rtol=0.0, atol=1e-3)
    stamp_ns = round(8.5e9 / per_second)
    between = subject_of("cube", PublishedState(stamp_ns=stamp_ns), known).state
    half = 0.5 * rate * stamp_ns * 1e-9
    assert abs(between.q_WB @ [0.0, 0.0, np.sin(half), np.cos(half)]) == pytest.approx(1.0, abs=1e-12)


def test_a_fit_to_states_that_leave_the_turns_open_is_an_error() -> None:
    known = spinning(400.0, 120.0, published=0.0)
    words = r"fit_window must be states with .*, got states that do not show how many turns .*\(354.* 400"
    with pytest.raises(InvalidFieldError, match=words):
        subject_of("cube", PublishedState(fit_window=1.0), known)


def test_a_fit_to_states_without_velocities_takes_less_than_a_third_of_a_turn() -> None:
    known = spinning(20.0, 120.0, published=0.0)
    fitted = subject_of("cube", PublishedState(fit_window=1.0), known).state
    np.testing.assert_allclose(fitted.w_WB_W, [0.0, 0.0, 20.0], rtol=0.0, atol=1e-5)
    with pytest.raises(InvalidFieldError, match="do not show how many turns"):
        subject_of("cube", PublishedState(fit_window=1.0), spinning(20.0, 120.0, published=500.0))


def test_a_fit_to_states_of_another_motion_is_an_error() -> None:
    """Turned by a radian in the middle of the window, as by a blow that the velocities do not show."""
    states = StateStore(history=10.0, timeout=0.5)
    for k in range(10):
        state = rising(10 * k * MS)
        half = 0.5 * (k > 4)
        states.add("cube", replace(state, q_WB=[np.sin(half), 0.0, 0.0, np.cos(half)]))
    with pytest.raises(
        InvalidFieldError, match=r"fit_window must be .*, got one whose 10 states the fitted flight misses"
    ):
        subject_of("cube", PublishedState(fit_window=1.0), Context(world=WORLD, states=states))


def test_a_load_moves_the_centre_of_mass_and_leaves_the_body_where_it_is() -> None:
    """Its frame stays, so that the new centre is beside the old one, and moves with the body's turning."""
    offset = np.array([0.05, 0.0, 0.0])
    loaded = changed_body(CUBE, MassProperties(mass=3.0, I_B=0.1 * np.eye(3)), offset)
    assert loaded.name == "cube"
    np.testing.assert_allclose(loaded.vertices_B + offset, CUBE.vertices_B, rtol=0.0, atol=1e-15)
    then = rising(20 * MS)
    found = subject_of(loaded, PublishedState(), watching(20 * MS)).state
    lever = matrices_of(then.q_WB[None])[0] @ offset
    np.testing.assert_allclose(found.p_WB_W, then.p_WB_W + lever, rtol=0.0, atol=1e-15)
    expected = then.v_WB_W + np.cross(then.w_WB_W, lever)
    np.testing.assert_allclose(found.v_WB_W, expected, rtol=0.0, atol=1e-15)


def test_a_state_that_is_said_needs_no_knowledge() -> None:
    nothing = Context()
    assert subject_of(CUBE, state(), nothing).covariance is None
    uncertain = UncertainState(state=state(), covariance=np.eye(12))
    np.testing.assert_array_equal(subject_of(CUBE, uncertain, nothing).covariance, np.eye(12))


def test_what_is_not_known_is_named() -> None:
    known = watching()
    with pytest.raises(NoStateError, match="no state of 'cube': none has been received yet"):
        subject_of("cube", PublishedState(), known)
    with pytest.raises(UnknownBodyError, match=r"must be one of the known bodies .'cube'., got 'dog'"):
        subject_of("dog", state(), known)
    with pytest.raises(InvalidFieldError, match=r"body_name must be .*, got nothing"):
        subject_of(Body(name="", mass_properties=CUBE.mass_properties), PublishedState(), known)


def test_a_state_from_the_future_never_becomes_the_newest() -> None:
    """Kept, it would be answered with until the clock came to it."""
    states = StateStore(history=10.0, timeout=0.5, future_tolerance=0.1)
    states.add("cube", rising(0), now_ns=0)
    states.add("cube", rising(100 * MS), now_ns=0)
    with pytest.raises(InvalidFieldError, match=r"stamp must be at most.*, got 0\.101 s ahead of the clock"):
        states.add("cube", rising(101 * MS), now_ns=0)
    assert states.newest("cube", now_ns=0).stamp_ns == 100 * MS


def test_a_state_that_nobody_has_stamped_is_rejected_unless_the_clock_has_only_begun() -> None:
    states = StateStore(history=10.0, timeout=0.5)
    states.add("cube", rising(0), now_ns=500 * MS)
    with pytest.raises(InvalidFieldError, match=r"stamp must be the time of the state, got 0$"):
        states.add("cube", rising(0), now_ns=501 * MS)


def test_states_that_the_clock_falls_behind_are_forgotten() -> None:
    """It was set back, or it had not begun when they came."""
    hour_ns = 3600 * 1000 * MS
    states = StateStore(history=10.0, timeout=0.5, future_tolerance=0.1)
    states.add("cube", rising(hour_ns))
    states.add("cube", rising(1 * MS), now_ns=1 * MS)
    assert states.newest("cube", now_ns=1 * MS).stamp_ns == 1 * MS
    states = StateStore(history=10.0, timeout=0.5, future_tolerance=0.1)
    states.add("cube", rising(hour_ns))
    with pytest.raises(NoStateError):
        states.newest("cube", now_ns=0)


def test_a_fit_that_is_kept_is_that_of_the_same_body_states_and_gravity() -> None:
    """Asked in turn, so that each fit is kept while the others are asked for."""
    known = watching(*range(0, 100 * MS, 10 * MS))
    floating = replace(known, world=replace(WORLD, gravity_W=np.array([0.0, 0.0, -8.0])))
    light = replace(CUBE, mass_properties=MassProperties(mass=0.5, I_B=np.diag([1e-3, 2e-3, 2.5e-3])))
    for _ in range(2):
        for body, context in (("cube", known), ("cube", floating), (light, known)):
            for stamp_ns in (90 * MS, 80 * MS):
                source = PublishedState(fit_window=0.05, stamp_ns=stamp_ns)
                found = subject_of(body, source, context)
                states = [rising(each) for each in range(stamp_ns - 50 * MS, stamp_ns + 1, 10 * MS)]
                expected = fit_free_motion(
                    found.body.mass_properties, states, gravity_W=context.world.gravity_W
                )
                np.testing.assert_array_equal(found.state.p_WB_W, expected.state.p_WB_W)
                np.testing.assert_array_equal(found.state.w_WB_W, expected.state.w_WB_W)
                np.testing.assert_array_equal(found.covariance, expected.covariance)
