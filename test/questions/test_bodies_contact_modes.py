# SPDX-License-Identifier: Apache-2.0
"""Questions about several bodies: the sources of their states, the applied wrenches, and rejected requests.

That the modes are right is shown in `contact_modes/spatial/test_several_bodies.py`.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Inertia

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import BodiesContactProblem, contact_modes
from contact_dynamics.errors import (
    ContactDynamicsError,
    InvalidFieldError,
    NoContactError,
    NoStateError,
    StaleStateError,
    TooLargeError,
    UnknownBodyError,
)
from contact_dynamics.questions import (
    BodiesContactModeQuestion,
    Context,
    ImpactQuestion,
    PublishedState,
    StateStore,
    UncertainState,
    ask,
)
from contact_dynamics.questions.bodies_contact_modes import MAX_BODIES
from contact_dynamics.questions.effort import excerpt
from contact_dynamics.questions.services import service_of
from contact_dynamics.questions.subject import NEWEST
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.world import Body, World
from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg
from contact_dynamics_interfaces.srv import PredictBodiesContactMode
from message_values.shared import same

LOWER = Body.box((0.3, 0.3, 0.1), mass=2.0, name="lower")
UPPER = Body.box((0.2, 0.2, 0.1), mass=1.0, name="upper")
WORLD = World(bodies=(LOWER, UPPER), gravity_W=[0, 0, -10.0])
STATES = tuple(BodyState(p_WB_W=[0, 0, z], q_WB=[0, 0, 0, 1], stamp_ns=10**9) for z in (0.05, 0.15))
FEET = [[x, y, z] for s, z in ((0.15, 0.0), (0.1, 0.1)) for x in (-s, s) for y in (-s, s)]
CONTACTS = ContactSet(p_WC_W=FEET, normals_W=[0, 0, 1], frictions=[0.5] * 4 + [0.3] * 4)
PAIRS = ((0, None),) * 4 + ((1, 0),) * 4
STACK: dict[str, Any] = {"bodies": ["lower", "upper"], "contacts": CONTACTS, "pairs": PAIRS}
PUSHED = BodiesContactModeQuestion(**STACK, states=STATES, forces_W=[[0, 0, 0], [4.0, 0, 0]])


def published(*states: tuple[str, BodyState]) -> StateStore:
    """The states as they are kept after they came over topics."""
    store = StateStore(history=5.0, timeout=0.5)
    for name, state in states:
        store.add(name, state, now_ns=state.stamp_ns)
    return store


def test_a_push_on_the_upper_of_two_makes_it_slide_as_the_physics_says() -> None:
    """Friction bears 0.3 * 10 N of 4 N, so that the upper body of 1 kg has 1 m/s^2; rounding of sums of N."""
    found = ask(PUSHED, Context(world=WORLD))
    assert (found.verdict.name, [mode.mode for mode in found.modes]) == ("UNIQUE", ["ffffcccc"])
    np.testing.assert_allclose(found.modes[0].accelerations_W, [[0, 0, 0], [1, 0, 0]], atol=1e-12)
    problem = BodiesContactProblem(
        bodies=[LOWER, UPPER],
        states=STATES,
        contacts=CONTACTS,
        pairs=PAIRS,
        forces_W=[[0, 0, -20.0], [4.0, 0, -10.0]],
    )
    assert same(found.modes, contact_modes(problem).modes)
    assert (found.body_name, found.stamp_ns) == ("lower, upper", 10**9)
    assert service_of(found).in_words(found)[0] == "has one consistent mode: ffffcccc"


def test_a_contact_that_approaches_is_told() -> None:
    falling = BodyState(p_WB_W=[0, 0, 0.15], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -0.1])
    found = ask(BodiesContactModeQuestion(**STACK, states=[STATES[0], falling]), Context(world=WORLD))
    assert (found.verdict.name, found.approaching) == ("IMPACT", (4, 5, 6, 7))
    assert service_of(found).in_words(found)[-1] == "contact 8 approaches"


def test_states_are_those_that_each_body_published() -> None:
    states = published(("lower", STATES[0]), ("upper", STATES[1]))
    newest = BodiesContactModeQuestion(**STACK, forces_W=PUSHED.forces_W)
    context = Context(world=WORLD, states=states, now_ns=lambda: 10**9)
    assert same(ask(newest, context), ask(PUSHED, context))
    assert same(ask(newest, excerpt(newest, context)), ask(PUSHED, context))
    late = Context(world=WORLD, states=states, now_ns=lambda: 3 * 10**9)
    with pytest.raises(StaleStateError, match="lower"):
        ask(newest, late)
    with pytest.raises(NoStateError, match="upper"):
        ask(newest, Context(world=WORLD, states=published(("lower", STATES[0])), now_ns=lambda: 10**9))


@pytest.mark.parametrize(("source", "ms"), [(PublishedState(stamp_ns=180 * 10**6), 180), (NEWEST, 200)])
def test_all_bodies_are_seen_at_the_same_time(source: PublishedState, ms: int) -> None:
    """The stack is carried along at 0.2 m/s, and the states of the two bodies come in turn."""

    def at(body: int, ms: int) -> BodyState:
        place = np.add(STATES[body].p_WB_W, [0.2e-3 * ms, 0, 0])
        return BodyState(p_WB_W=place, q_WB=[0, 0, 0, 1], v_WB_W=[0.2, 0, 0], stamp_ns=ms * 10**6)

    states = published(*((WORLD.bodies[i].name, at(i, ms + 50 * i)) for ms in (100, 200) for i in (0, 1)))
    question, whole = (
        BodiesContactModeQuestion(**STACK, states=[source, source]),
        Context(world=WORLD, states=states),
    )
    found = ask(question, whole)
    for i, body in enumerate(found.bodies):
        # An interpolated place of less than a metre is accurate to rounding.
        np.testing.assert_allclose(body.state.p_WB_W, at(i, ms).p_WB_W, atol=1e-12)
        assert body.state.stamp_ns == ms * 10**6
    assert same(ask(question, excerpt(question, whole)), found)


def test_one_published_body_is_not_two() -> None:
    """Two bodies of one kind have one name, and then explicit states."""
    states = published(("lower", STATES[0]))
    on_top = ContactSet(p_WC_W=[[0, 0, 0.1]], normals_W=[0, 0, 1], frictions=0.5, restitutions=0.0)
    twice = BodiesContactModeQuestion(bodies=["lower", LOWER], contacts=on_top, pairs=[(0, 1)])
    hit = ImpactQuestion(body="lower", other="lower", contacts=on_top)
    for question in (twice, hit):
        with pytest.raises(InvalidFieldError, match=r"^body_name must be different, or have explicit states"):
            ask(question, Context(world=WORLD, states=states))
    above = replace(STATES[0], p_WB_W=[0, 0, 0.15])
    ask(replace(twice, states=(above, STATES[0])), Context(world=WORLD))


def test_without_gravity_nothing_presses() -> None:
    found = ask(BodiesContactModeQuestion(**STACK, states=STATES, gravity_W=[0, 0, 0]), Context(world=WORLD))
    assert not found.modes[0].contact_forces_W.any()


NOISE = np.repeat([1e-4, 1e-3, 0.01, 0.05], 3)  # m, rad, m/s and rad/s along each axis


def measured(state: BodyState, chance: np.random.Generator) -> UncertainState:
    """The pose is exact, since the contacts are explicit."""
    v_W, w_W = (NOISE[6:] * chance.normal(size=6)).reshape(2, 3)
    noisy = state.with_velocities(state.v_WB_W + v_W, state.w_WB_W + w_W)
    return UncertainState(state=noisy, covariance=np.diag(NOISE**2))


def test_a_measured_stack_at_rest_rests_within_its_noise() -> None:
    """Of 200 draws, one in a thousand may fail. Without the covariances no draw is at rest."""
    chance, known = np.random.default_rng(4), Context(world=WORLD)
    for _ in range(200):
        states = [measured(state, chance) for state in STATES]
        found = ask(BodiesContactModeQuestion(**STACK, states=states), known)
        assert [mode.mode for mode in found.modes] == ["ffffffff"]
        assert found.warnings == ()
    exact = [state.state for state in states]
    assert ask(BodiesContactModeQuestion(**STACK, states=exact), known).verdict.name != "UNIQUE"


def test_a_stack_that_slides_is_not_at_rest_within_its_noise_and_says_that_it_is_as_measured() -> None:
    chance, known = np.random.default_rng(4), Context(world=WORLD)
    moving = (STATES[0], STATES[1].with_velocities([0.2, 0.0, 0.0], [0.0, 0.0, 0.0]))
    found = ask(BodiesContactModeQuestion(**STACK, states=[measured(each, chance) for each in moving]), known)
    assert "ffffffff" not in {mode.mode for mode in found.modes}
    (warning,) = found.warnings
    assert warning.startswith("the velocities are those measured, since their noise does not explain them")
    # Exact states of which one has a covariance are taken as they are.
    states = [UncertainState(state=STATES[0], covariance=np.diag(NOISE**2)), moving[1]]
    slides = ask(BodiesContactModeQuestion(**STACK, states=states), known)
    assert same(slides.modes, ask(BodiesContactModeQuestion(**STACK, states=moving), known).modes)


def test_a_contact_off_the_shape_of_either_body_has_a_warning_with_its_number() -> None:
    points = [*FEET[:7], [0.1, 0.1, 1.1]]
    moved = ContactSet(p_WC_W=points, normals_W=[0, 0, 1], frictions=0.5)
    found = ask(BodiesContactModeQuestion(**STACK | {"contacts": moved}, states=STATES), Context(world=WORLD))
    assert found.warnings == (
        "contact 7 is 1 m outside of the shape of 'lower'",
        "contact 7 is 0.9 m outside of the shape of 'upper'",
    )


@pytest.mark.parametrize(
    ("changed", "error", "words"),
    [
        ({"bodies": ["lower", "cup"]}, UnknownBodyError, "'cup'"),
        ({"bodies": [LOWER] * (MAX_BODIES + 1)}, TooLargeError, "33 bodies"),
        ({"states": STATES[:1]}, InvalidFieldError, "states must be 2, one for each body, got 1 states"),
        ({"pairs": PAIRS[:3]}, InvalidFieldError, "pairs must be 8"),
        ({"pairs": ((0, 2), *PAIRS[1:])}, InvalidFieldError, "pairs[0] must be two different indices"),
        ({"forces_W": [[0, 0, 0], [0, 0, 1e30]]}, InvalidFieldError, "body 1: force_W must be at most"),
        ({"velocity_tolerance": -1.0}, InvalidFieldError, "velocity_tolerance must be >= 0"),
        (
            {"contacts": ContactSet(p_WC_W=np.zeros((0, 3)), normals_W=np.zeros((0, 3)), frictions=[])}
            | {"pairs": ()},
            NoContactError,
            "contacts must be at least one",
        ),
        (
            {"states": [STATES[0], BodyState(p_WB_W=[0, 0, 1e16], q_WB=[0, 0, 0, 1])]},
            InvalidFieldError,
            "body 1: p_WB_W must be at most",
        ),
    ],
)
def test_what_is_not_allowed_is_named(
    changed: dict[str, Any], error: type[ContactDynamicsError], words: str
) -> None:
    with pytest.raises(error, match=re.escape(words)):
        ask(BodiesContactModeQuestion(**{**STACK, "states": STATES, **changed}), Context(world=WORLD))


def asked() -> PredictBodiesContactMode.Request:
    """The stack, as a client asks about it."""
    request = PredictBodiesContactMode.Request(state_source=1)
    request.states = [BodyStateMsg(body_name="lower"), BodyStateMsg(body_name="upper")]
    request.states[0].pose.position.z, request.states[1].pose.position.z = 0.05, 0.15
    request.contacts.positions = np.ravel(FEET).tolist()
    request.contacts.normals, request.contacts.frictions = [0.0, 0.0, 1.0] * 8, [0.5] * 8
    request.contact_bodies, request.other_bodies = [0] * 4 + [1] * 4, [-1] * 4 + [0] * 4
    return request


def question_of(request: PredictBodiesContactMode.Request) -> Any:
    service = service_of(PUSHED)
    return service.question_of(request, world=WORLD, world_frame="world")


def test_indices_in_a_request_are_those_of_pairs() -> None:
    assert question_of(asked()).pairs == PAIRS


TWICE = [BodyStateMsg(body_name="lower"), BodyStateMsg(body_name="lower")]


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"states": TWICE}, "states[1].body_name must be a name that no other body has"),
        ({"states": [BodyStateMsg()]}, "states[0].body_name must be a name that no other body has"),
        ({"state_source": 0}, "states[0].pose.position.z must be left out unless state_source is STATE_"),
        ({"inertias": [Inertia()]}, "inertias must be 2, one for each state, or none, got 1 elements"),
        ({"contact_bodies": [0] * 7}, "contact_bodies must be 8, one for each contact, got 7 indices"),
        ({"contact_bodies": [0] * 4 + [1, 1, 1, 2]}, "contact_bodies[7] must be an index of states, below 2"),
        ({"other_bodies": [-1] * 7 + [2]}, "other_bodies[7] must be another index of states"),
        ({"other_bodies": [-1] * 7 + [-2]}, "other_bodies[7] must be another index of states"),
        ({"other_bodies": [-1] * 7 + [1]}, "other_bodies[7] must be another index of states"),
    ],
)
def test_what_a_request_may_not_say_is_named(fields: dict[str, Any], words: str) -> None:
    request = asked()
    for name, value in fields.items():
        setattr(request, name, value)
    with pytest.raises(InvalidFieldError, match=re.escape(words)):
        question_of(request)


def test_the_surface_of_a_body_has_no_motion_of_its_own() -> None:
    request = asked()
    request.contacts.surface_velocities = [0.0] * 23 + [0.1]
    with pytest.raises(InvalidFieldError, match=r"^contacts.surface_velocities\[7\] must be zero between"):
        question_of(request)


def test_states_of_different_times_are_a_warning() -> None:
    later = replace(STATES[1], stamp_ns=10**9 + 8_000_000)
    found = ask(replace(PUSHED, states=(STATES[0], later)), Context(world=WORLD))
    assert found.warnings == ("the states differ in time by 8 ms, which matters if the bodies move",)
    assert not ask(PUSHED, Context(world=WORLD)).warnings
