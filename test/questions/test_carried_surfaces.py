# SPDX-License-Identifier: Apache-2.0
"""Questions about a body on a plane that another body carries."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from contact_dynamics.contact import find_contacts
from contact_dynamics.contact_modes import ModeVerdict, SpatialContactProblem, contact_modes
from contact_dynamics.errors import InvalidFieldError, NoStateError, StaleStateError
from contact_dynamics.questions import (
    CarriedSurface,
    ContactModeQuestion,
    Context,
    Defaults,
    ImpactQuestion,
    Problem,
    PublishedState,
    StateStore,
    TossQuestion,
    TossSampling,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    ask,
)
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import quaternions_of, turned
from contact_dynamics.world import Body, Surface, World

G: Final = 9.80665
FRICTION: Final = 0.3
PERIOD_NS: Final = 10_000_000
BEGIN_NS: Final = 1_000_000_000
TRAY: Final = Body.box((0.4, 0.4, 0.02), mass=1.0, name="tray")
CUP: Final = Body.box((0.06, 0.06, 0.1), mass=0.3, name="cup")
TOP: Final = Surface(
    name="top", p_WS_W=[0.0, 0.0, 0.01], normal_W=[0.0, 0.0, 1.0], friction=FRICTION, restitution=0.5
)


class Motion:
    """The exact motion of a tray: constant acceleration, m/s^2, and a constant angular velocity, rad/s."""

    def __init__(
        self, a: tuple[float, float, float] = (0.0, 0.0, 0.0), w: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> None:
        self.a_W, self.w_W = np.array(a), np.array(w)

    def state(self, t: float, r_B: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> BodyState:
        """Return the state of a body fixed to the tray, with its centre at ``r_B``, m."""
        q = quaternions_of(t * self.w_W[None])[0]
        middle = BodyState(p_WB_W=np.zeros(3), q_WB=q, v_WB_W=np.zeros(3), w_WB_W=self.w_W)
        r_W = middle.R_WB @ np.array(r_B)
        return BodyState(
            p_WB_W=np.array([0.1, 0.2, 1.0]) + 0.5 * t * t * self.a_W + r_W,
            q_WB=q,
            v_WB_W=t * self.a_W + np.cross(self.w_W, r_W),
            w_WB_W=self.w_W,
            stamp_ns=BEGIN_NS + round(1e9 * t),
        )

    def published(self, count: int = 11) -> StateStore:
        """Return a store with states every 10 ms."""
        states = StateStore(history=5.0, timeout=0.5)
        for k in range(count):
            states.add("tray", self.state(0.01 * k))
        return states


def context(states: StateStore, surface: CarriedSurface | None = None, **options: float) -> Context:
    return Context(
        world=World(bodies=(TRAY, CUP)),
        states=states,
        carried=(surface or CarriedSurface(body_name="tray", surface=TOP),),
        defaults=Defaults(**options),
    )


def modes_of_cup(known: Context, state: BodyState) -> tuple[ModeVerdict, set[str], tuple[str, ...]]:
    answer = ask(ContactModeQuestion(body="cup", state=state), known)
    return answer.verdict, {letter for mode in answer.modes for letter in mode.mode}, answer.warnings


@pytest.mark.parametrize("share", [0.5, 0.999, 1.001, 2.0])
def test_a_cup_slides_once_the_tray_accelerates_by_more_than_friction_times_gravity(share: float) -> None:
    motion = Motion(a=(share * FRICTION * G, 0.0, 0.0))
    verdict, letters, warnings = modes_of_cup(
        context(motion.published()), motion.state(0.1, (0.05, 0.0, 0.06))
    )
    assert verdict is ModeVerdict.UNIQUE
    assert letters == ({"f"} if share < 1.0 else {"c"})
    assert not warnings


@pytest.mark.parametrize("share", [0.9, 0.999, 1.001, 1.1])
def test_a_cup_on_a_turning_tray_is_held_up_to_the_radius_of_friction(share: float) -> None:
    w = 6.0
    motion = Motion(w=(0.0, 0.0, w))
    radius = share * FRICTION * G / w**2
    verdict, letters, _ = modes_of_cup(context(motion.published()), motion.state(0.07, (radius, 0.0, 0.06)))
    assert verdict is ModeVerdict.UNIQUE
    assert letters == ({"f"} if share < 1.0 else {"c"})


@pytest.mark.parametrize(("degrees", "letter"), [(16.6, "f"), (16.8, "r")])
def test_a_cup_slides_on_a_tray_that_is_tilted_by_more_than_the_friction_angle(
    degrees: float, letter: str
) -> None:
    q = [0.0, math.sin(0.5 * math.radians(degrees)), 0.0, math.cos(0.5 * math.radians(degrees))]
    still = {"q_WB": q, "v_WB_W": np.zeros(3), "w_WB_W": np.zeros(3)}
    tray = BodyState(p_WB_W=np.zeros(3), **still, stamp_ns=BEGIN_NS)
    states = StateStore(history=5.0, timeout=0.5)
    states.add("tray", tray)
    cup = BodyState(p_WB_W=tray.R_WB @ [0.0, 0.0, 0.06], **still, stamp_ns=BEGIN_NS)
    still_tray = CarriedSurface(body_name="tray", surface=TOP, acceleration_window=0.0)
    verdict, letters, warnings = modes_of_cup(context(states, still_tray), cup)
    assert (verdict, letters, warnings) == (ModeVerdict.UNIQUE, {letter}, ())


def test_between_two_states_the_modes_are_those_of_the_exact_motion() -> None:
    motion = Motion(a=(1.0, -0.5, 0.3), w=(0.4, -0.2, 1.5))
    t, r_B = 0.0537, (0.05, -0.02, 0.06)
    cup = motion.state(t, r_B)
    tray = motion.state(t)
    r_W = tray.R_WB @ TOP.p_WS_W
    exact = Surface(
        name="top",
        p_WS_W=tray.p_WB_W + r_W,
        normal_W=tray.R_WB @ TOP.normal_W,
        friction=FRICTION,
        restitution=0.5,
        v_WS_W=tray.v_WB_W + np.cross(tray.w_WB_W, r_W),
        w_WS_W=tray.w_WB_W,
        a_WS_W=motion.a_W + np.cross(tray.w_WB_W, np.cross(tray.w_WB_W, r_W)),
    )
    world = World(bodies=(CUP,), surfaces=(exact,))
    expected = contact_modes(
        SpatialContactProblem(
            body=CUP.mass_properties,
            state=cup,
            contacts=find_contacts(CUP, cup, world, distance_tolerance=1e-6),
            force_W=CUP.mass_properties.mass * world.gravity_W,
        )
    )
    found = ask(ContactModeQuestion(body="cup", state=cup), context(motion.published()))
    assert [mode.mode for mode in found.modes] == [mode.mode for mode in expected.modes]
    # Interpolation of a rotation at a constant rate is exact, and that of the position has the error
    # r a^4 / 384 with a = 0.016 rad, far below this tolerance.
    forces = [mode.contact_forces_W for mode in found.modes]
    assert np.allclose(forces, [mode.contact_forces_W for mode in expected.modes], rtol=0.0, atol=1e-7)


def test_after_the_latest_state_the_motion_continues_and_the_answer_says_for_how_long() -> None:
    motion = Motion(a=(0.9 * FRICTION * G, 0.0, 0.0), w=(0.0, 0.0, 0.5))
    cup = motion.state(0.15, (0.01, 0.0, 0.06))
    verdict, letters, warnings = modes_of_cup(context(motion.published()), cup)
    assert (verdict, letters) == (ModeVerdict.UNIQUE, {"f"})
    assert warnings == ("surface 'top': the latest state of 'tray' is 50 ms older than the question's state",)
    with pytest.raises(StaleStateError, match=r"at most 0\.04 s .* \(max_extrapolation\), got 0\.050 s"):
        modes_of_cup(context(motion.published(), max_extrapolation=0.04), cup)


@pytest.mark.parametrize("period", [1, 3, 5])
@pytest.mark.parametrize(("share", "letter"), [(0.95, "f"), (1.05, "c")])
def test_accelerations_are_estimated_from_three_states_if_they_are_published_slowly(
    period: int, share: float, letter: str
) -> None:
    """At 100, 33 and 20 Hz."""
    motion = Motion(a=(share * FRICTION * G, 0.0, 0.0))
    states = StateStore(history=5.0, timeout=0.5)
    for k in range(0, 20, period):
        states.add("tray", motion.state(0.01 * k))
    verdict, letters, warnings = modes_of_cup(context(states), motion.state(0.145, (0.05, 0.0, 0.06)))
    assert (verdict, letters, warnings) == (ModeVerdict.UNIQUE, {letter}, ())


NOISE: Final = np.repeat([5e-4, 2e-3, 5e-3, 0.02], 3)  # m, rad, m/s and rad/s along each axis


def measured(state: BodyState, chance: np.random.Generator) -> UncertainState:
    error = NOISE * chance.normal(size=12)
    drawn = BodyState(
        p_WB_W=state.p_WB_W + error[:3],
        q_WB=turned(state.q_WB[None], error[None, 3:6])[0],
        v_WB_W=state.v_WB_W + error[6:9],
        w_WB_W=state.w_WB_W + error[9:],
        stamp_ns=state.stamp_ns,
    )
    return UncertainState(state=drawn, covariance=np.diag(NOISE**2))


def known_with_noise(motion: Motion, chance: np.random.Generator) -> Context:
    states = StateStore(history=5.0, timeout=0.5)
    for k in range(21):
        states.add("tray", measured(motion.state(0.01 * k), chance))
    surface = CarriedSurface(body_name="tray", surface=TOP, acceleration_window=0.2)
    return Context(world=World(bodies=(TRAY, CUP)), states=states, carried=(surface,))


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_a_cup_at_rest_on_a_tray_rests_though_both_are_measured_with_noise(share: float) -> None:
    """One in a thousand draws may fail. Without the tray's noise, one in eight does."""
    chance, motion = np.random.default_rng(5), Motion(a=(share * FRICTION * G, 0.0, 0.0))
    wrong = 0
    for _ in range(50):
        known = known_with_noise(motion, chance)
        question = ContactModeQuestion(
            body="cup", state=measured(motion.state(0.2, (0.05, 0.0, 0.06)), chance), problem=Problem.SPATIAL
        )
        answer = ask(question, known)
        rests = answer.verdict is ModeVerdict.UNIQUE and answer.modes[0].mode == "ffff"
        batch = ask(
            ManyContactModesQuestion(asked=question, forces_W=[[0, 0, 0]], torques_W=[[0, 0, 0]]), known
        )
        assert batch.verdicts[0] == answer.verdict
        wrong += not rests
    assert wrong == 0


def test_a_cup_that_slides_on_a_tray_is_not_at_rest_within_the_noise_of_both() -> None:
    chance, motion = np.random.default_rng(6), Motion()
    known = known_with_noise(motion, chance)
    sliding = motion.state(0.2, (0.05, 0.0, 0.06)).with_velocities([0.1, 0.0, 0.0], [0.0, 0.0, 0.0])
    answer = ask(ContactModeQuestion(body="cup", state=measured(sliding, chance)), known)
    assert {letter for mode in answer.modes for letter in mode.mode} == {"c"}


def test_a_sampled_toss_says_that_it_leaves_out_the_noise_of_the_carrier() -> None:
    chance, motion = np.random.default_rng(7), Motion()
    above = motion.state(0.2, (0.05, 0.0, 0.3))
    known = known_with_noise(motion, chance)
    (plane,) = known.carried
    still = StateStore(history=5.0, timeout=0.5)
    still.add("tray", UncertainState(state=motion.state(0.2), covariance=np.diag(NOISE**2)))
    known = replace(known, states=still, carried=(replace(plane, acceleration_window=0.0),))
    question = TossQuestion(body="cup", state=above, sampling=TossSampling(count=10))
    assert ask(question, known).warnings == (
        "the distribution leaves out the noise of 'tray', which carries a surface",
    )
    assert ask(replace(question, sampling=None), known).warnings == ()


def test_too_few_states_for_an_acceleration_are_an_error() -> None:
    motion = Motion()
    cup = motion.state(0.01, (0.0, 0.0, 0.06))
    with pytest.raises(NoStateError, match=r"at least 3 states of 'tray' are required .* got 2 "):
        modes_of_cup(context(motion.published(2)), cup)
    uniform = CarriedSurface(body_name="tray", surface=TOP, acceleration_window=0.0)
    _, letters, warnings = modes_of_cup(context(motion.published(2), uniform), cup)
    assert (letters, warnings) == ({"f"}, ())
    with pytest.raises(NoStateError, match="'tray'"):
        modes_of_cup(context(motion.published(0)), cup)


def test_a_ball_meets_a_tray_that_rises_and_bounces_from_it() -> None:
    ball = Body.sphere(0.02, mass=0.1, name="ball")
    states = StateStore(history=5.0, timeout=0.5)
    tray_v, drop = 0.5, 0.3
    still = {"q_WB": [0.0, 0.0, 0.0, 1.0], "w_WB_W": np.zeros(3)}
    for k in range(5):
        p, v = [0.0, 0.0, tray_v * 0.01 * k], [0.0, 0.0, tray_v]
        states.add("tray", BodyState(p_WB_W=p, v_WB_W=v, **still, stamp_ns=BEGIN_NS + k * PERIOD_NS))
    height = tray_v * 0.04 + 0.01 + 0.02 + drop
    falling = BodyState(
        p_WB_W=[0.0, 0.0, height], v_WB_W=np.zeros(3), **still, stamp_ns=BEGIN_NS + 4 * PERIOD_NS
    )
    states.add("ball", falling)
    known = Context(
        world=World(bodies=(TRAY, ball)),
        states=states,
        carried=(CarriedSurface(body_name="tray", surface=TOP),),
    )
    impact = ask(ImpactQuestion(body="ball"), known)
    # drop - g t^2 / 2 = v t
    t = (-tray_v + math.sqrt(tray_v**2 + 2.0 * G * drop)) / G
    assert impact.seconds_to_contact == pytest.approx(t, abs=1e-9)
    assert impact.contacts.surfaces == ("top",)
    after = impact.impact.states[0].v_WB_W[2]
    assert after == pytest.approx(tray_v + 0.5 * (G * t + tray_v), abs=1e-9)
    event = ask(TumblingQuestion(body="ball", sampling=UntilContact()), known).event
    assert event is not None
    assert event.seconds == pytest.approx(t, abs=1e-9)


def test_the_carrying_body_does_not_touch_its_own_surface() -> None:
    falling = Motion(a=(0.0, 0.0, -G)).published()
    known = context(falling)
    assert ask(TumblingQuestion(body="tray", sampling=UntilContact(duration=0.2)), known).event is None


def test_a_question_without_detected_contacts_requires_no_state_of_the_tray() -> None:
    empty = context(StateStore(history=5.0, timeout=0.5))
    cup = Motion().state(0.0, (0.0, 0.0, 0.5))
    floor = Surface(name="floor", p_WS_W=[0, 0, 1.01], normal_W=[0, 0, 1], friction=1.0, restitution=0.0)
    standing = Motion().state(0.0, (0.0, 0.0, 0.06))
    contacts = find_contacts(CUP, standing, World(surfaces=(floor,)), distance_tolerance=1e-6)
    assert ask(TumblingQuestion(body="cup", state=cup), empty).event is None
    assert ask(ContactModeQuestion(body="cup", state=cup, contacts=contacts), empty).modes
    with pytest.raises(NoStateError):
        ask(TossQuestion(body="cup", state=cup), empty)


def test_a_tilting_tray_and_an_unsupported_toss_are_errors() -> None:
    moving = Surface(
        name="belt", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=1, restitution=0, v_WS_W=[1, 0, 0]
    )
    with pytest.raises(InvalidFieldError, match="at rest in the frame of its body"):
        CarriedSurface(body_name="tray", surface=moving)
    motion = Motion(w=(0.0, 1.0, 0.0))
    known = context(motion.published())
    known.states.add("cup", motion.state(0.1, (0.0, 0.0, 0.3)))
    with pytest.raises(Exception, match="must turn about its normal only"):
        ask(ImpactQuestion(body="cup", state=PublishedState()), known)
