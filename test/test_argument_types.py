# SPDX-License-Identifier: Apache-2.0
"""What public functions and records are given has the types and members of their annotations."""

from __future__ import annotations

import importlib
import inspect
import pickle
import re
import sys
from enum import Enum
from typing import Any

import numpy as np
import pytest

import contact_dynamics
from architecture.test_doors import CHAPTERS
from contact_dynamics import (
    Body,
    BodyState,
    ContactDynamicsError,
    ContactSet,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarWrench,
    RestitutionLaw,
    Surface,
    World,
    free_motion,
    impact,
    landing,
    motion,
    questions,
    sampled_toss,
    spatial_impact,
    state_covariance,
    toss,
)
from contact_dynamics.contact_modes import contact_modes
from contact_dynamics.errors import InvalidFieldError, UnknownArgumentError, WrongTypeError
from contact_dynamics.impact import SeveralContactsLaw
from hostile_values import CALLS
from hostile_values.shared import BALL, BOX, CONTACT, CONTACTS, FLOOR, ROD, STATE, TIP, WORLD

TOUCH = PlanarContact(**TIP)
PUSH = PlanarWrench(f=(0.0, -1.0))

WRONG: list[tuple[Any, dict[str, Any], str]] = [
    (
        free_motion,
        {"body": "box", "state": STATE},
        "body must be a Body or its MassProperties, got 'box', a str",
    ),
    (
        spatial_impact,
        {"body": BALL, "state": STATE, "contact": CONTACTS},
        "contact must be a Contact, got a ContactSet, which several_impact takes",
    ),
    (
        impact.several_impact,
        {"body": BALL, "state": STATE, "contacts": [CONTACT]},
        "contacts must be a ContactSet, got a list",
    ),
    (World, {"bodies": BOX}, "bodies must be a sequence of Body, got a Body"),
    (World, {"bodies": {"box": BOX}}, "bodies must be a sequence of Body, got a dict"),
    (World, {"bodies": [BOX, "box"]}, "bodies[1] must be a Body, got 'box', a str"),
    (World, {"surfaces": [BOX]}, "surfaces[0] must be a Surface or an Obstacle, got a Body"),
    (Body, {"name": 3, "mass_properties": BALL}, "name must be a str, got 3, an int"),
    (
        PlanarContactProblem,
        {"body": ROD, "contacts": [TOUCH], "wrench": (0, -1, 0)},
        "wrench must be a PlanarWrench, got a tuple",
    ),
    (
        PlanarContactProblem,
        {"body": ROD, "contacts": TOUCH, "wrench": PUSH},
        "contacts must be a sequence of PlanarContact, got a PlanarContact",
    ),
    (
        contact_modes,
        {"problem": ROD},
        "problem must be a PlanarContactProblem or a SpatialContactProblem or ",
    ),
    (
        impact.spatial_impacts,
        {"bodies": None, "normals_W": 0, "frictions": 0, "restitutions": 0},
        "bodies must be a StrikingBodies, got None",
    ),
    (motion.motion_of, {"body": BALL, "state": STATE, "wrench_of": 3}, "wrench_of must be a function or"),
    (motion.motion_of, {"body": BALL, "state": STATE, "wrench": [1.0]}, "wrench must be a ConstantWrench, "),
    (toss.toss, {"body": BALL, "state": STATE, "world": WORLD}, "body must be a Body, got a MassProperties"),
    (toss.toss, {"body": BOX, "state": STATE, "world": Body}, "world must be a World, got the class Body"),
    (
        questions.ImpactQuestion,
        {"body": BOX, "include_orders": "no"},
        "include_orders must be True or False, got 'no', a str",
    ),
    (questions.Context, {"world": BOX}, "world must be a World, got a Body"),
    (questions.ask, {"question": BOX}, "question must be a TumblingQuestion or an ImpactQuestion or a "),
    (landing.next_landing, {"body": BOX, "state": STATE, "world": FLOOR, "horizon": 1}, "world must be a "),
]
"""Calls, their arguments, and how their errors begin."""


@pytest.mark.parametrize(("call", "arguments", "text"), WRONG)
def test_a_wrong_type_is_an_error_that_names_it(call: Any, arguments: dict[str, Any], text: str) -> None:
    with pytest.raises(WrongTypeError) as raised:
        call(**arguments)
    assert str(raised.value).startswith(text)
    assert isinstance(raised.value, ContactDynamicsError)
    assert isinstance(raised.value, TypeError)
    again = pickle.loads(pickle.dumps(raised.value))  # noqa: S301  our own
    assert (type(again), str(again)) == (WrongTypeError, str(raised.value))


def test_an_argument_is_checked_by_place_and_by_name() -> None:
    words = re.escape("got a MassProperties, which Body(name=..., mass_properties=it, shape=...) takes")
    with pytest.raises(WrongTypeError, match=f"^state must be a BodyState, {words}$"):
        free_motion(BALL, BALL)
    with pytest.raises(WrongTypeError, match=f"^state must be a BodyState, {words}$"):
        free_motion(BALL, state=BALL)
    with pytest.raises(WrongTypeError, match=f"^body must be a Body, {words}$"):
        landing.next_landing(BALL, STATE, WORLD)


GUESSES: list[tuple[Any, dict[str, Any], str]] = [
    (Body, {"name": "cup", "mass": 1.0}, "Body has no argument 'mass', did you mean mass_properties (Ma"),
    (BodyState, {"position": (0, 0, 1)}, "BodyState has no argument 'position', did you mean p_WB_W ("),
    (BodyState, {"velocity": (0, 0, 1)}, "BodyState has no argument 'velocity', did you mean v_WB_W ("),
    (
        Surface,
        {"name": "floor", "normal": (0, 0, 1)},
        "Surface has no argument 'normal', did you mean normal_W (",
    ),
    (ContactSet, {"normal": (0, 0, 1)}, "ContactSet has no argument 'normal', did you mean normals_W ("),
    (World, {"gravity": 9.81}, "World has no argument 'gravity', did you mean gravity_W ((3,), m/s^2"),
    (
        free_motion,
        {"body": BOX, "gravty_W": 0},
        "free_motion has no argument 'gravty_W', did you mean gravity_W ((3,), m/s^2, world axes)?",
    ),
    (
        sampled_toss,
        {"samples": 9},
        (
            "sampled_toss has no argument 'samples', did you mean count "
            "(Number of samples, from 1 to `MAX_SAMPLES`)?"
        ),
    ),
    (
        World,
        {"obstacles": ()},
        "World has no argument 'obstacles', did you mean surfaces (Infinite planes, and ob",
    ),
    (
        Surface,
        {"kinetic_friction": 0.3},
        "Surface has no argument 'kinetic_friction', did you mean friction (Co",
    ),
    (World, {"colour": "red"}, "World has no argument 'colour'. It has bodies, surfaces, gravity_W"),
    (Body.box, {"size": (1, 1, 1), "weight": 1}, "Body.box has no argument 'weight'. It has size, mass, "),
    (
        state_covariance,
        {"linear_velocity": 0.1},
        "state_covariance has no argument 'linear_velocity', did you mean velocity (m/s",
    ),
    (
        state_covariance,
        {"attitude": 0.1},
        "state_covariance has no argument 'attitude', did you mean rotation (rad, >= 0, of a small rotation",
    ),
    (
        Surface,
        {"name": "floor", "friction": 0.3, "normal_W": (0, 0, 1)},
        "Surface requires p_WS_W ((3,), m, a point of the surface, world), restitution (Coefficient of ",
    ),
]
"""Calls with a guessed name, and how the error begins that names the right one."""


@pytest.mark.parametrize(("call", "arguments", "text"), GUESSES)
def test_a_guessed_name_is_an_error_that_names_the_right_one(
    call: Any, arguments: dict[str, Any], text: str
) -> None:
    with pytest.raises(TypeError) as raised:
        call(**arguments)
    assert str(raised.value).startswith(text)
    assert isinstance(raised.value, ContactDynamicsError)


@pytest.mark.parametrize(
    ("arguments", "by_name", "got"),
    [
        ((0.1, 0.1, 0.1), {"mass": 1.0}, "3 arguments by place, and mass by name too"),
        (((0.1, 0.1, 0.1), 1.0, 800.0), {}, "3 arguments by place"),
    ],
)
def test_too_many_arguments_by_place_are_an_error_that_names_those_allowed(
    arguments: tuple[Any, ...], by_name: dict[str, Any], got: str
) -> None:
    with pytest.raises(TypeError) as raised:
        Body.box(*arguments, **by_name)
    allowed = "It takes size, mass in this order, and by name only density, name"
    assert str(raised.value) == f"Body.box got {got}. {allowed}"


def test_fields_by_place_are_an_error_that_names_the_fields() -> None:
    words = r"only by name, such as p_WB_W=\.\.\., got 2 by place\. It has p_WB_W, q_WB, v"
    with pytest.raises(UnknownArgumentError, match=words):
        BodyState([0, 0, 0], [0, 0, 0, 1])  # type: ignore[call-arg,misc]


@pytest.mark.parametrize(
    ("record", "guess", "meant"),
    [
        (BOX, "mass", "mass_properties.mass"),
        (BALL, "inertia", "I_B"),
        (STATE, "position", "p_WB_W"),
        (STATE, "p_WB", "p_WB_W"),
        (World(bodies=[BOX]), "gravity", "gravity_W"),
        (World(bodies=[BOX]), "name", "bodies[0].name"),
        (free_motion(BOX, STATE).at([0.0]), "times", "seconds"),
    ],
)
def test_a_guessed_attribute_is_an_error_that_names_the_right_one(
    record: Any, guess: str, meant: str
) -> None:
    words = rf"no attribute '{guess}', did you mean {re.escape(meant)}\? It has "
    with pytest.raises(AttributeError, match=words):
        getattr(record, guess)
    assert not hasattr(record, "nothing_of_that_kind")
    assert not hasattr(record, "_private")


def test_a_guessed_name_of_a_chapter_or_a_member_is_an_error_that_names_the_right_one() -> None:
    with pytest.raises(AttributeError, match=r": it is contact_dynamics\.toss\.TossUncertainty"):
        _ = contact_dynamics.TossUncertainty
    with pytest.raises(AttributeError, match=r"did you mean Body\?"):
        _ = contact_dynamics.Bodi
    with pytest.raises(AttributeError, match=r"'STRONGE'\. It has POISSON, NEWTON, ENERGETIC"):
        _ = RestitutionLaw.STRONGE  # type: ignore[attr-defined]


def test_the_error_of_a_mass_names_what_takes_one() -> None:
    with pytest.raises(TypeError, match=r"Body\.box, Body\.sphere"):
        Body(name="cup", mass=1.0)  # type: ignore[call-arg]


@pytest.mark.parametrize("call", [Body, Body.of, Body.box])
def test_the_error_of_parts_names_what_takes_them(call: Any) -> None:
    with pytest.raises(
        UnknownArgumentError, match=r"no argument 'parts'.*; Body\.union makes one body of sev"
    ):
        call(parts=[BOX])


def test_the_field_that_was_meant_is_named() -> None:
    motion = free_motion(BOX, STATE)
    with pytest.raises(
        WrongTypeError, match=r"^state must be a BodyState, got a FreeMotion, whose state is one$"
    ):
        free_motion(BOX, motion)


def test_a_sequence_may_be_any_and_becomes_a_tuple() -> None:
    bodies = [BOX]
    for given in (bodies, {"box": BOX}.values(), (one for one in bodies), np.array(bodies)):
        assert World(bodies=given).bodies == (BOX,)
    world = World(bodies=bodies)
    bodies.append(BOX)
    assert len(world.bodies) == 1


def test_subclasses_and_numpys_booleans_are_of_the_type() -> None:
    class Cup(Body):
        pass

    cup = Cup(name=np.str_("cup"), mass_properties=BALL)
    assert World(bodies=[cup]).body("cup") is cup
    assert questions.ImpactQuestion(body=cup, include_orders=np.True_).include_orders


def public_functions() -> dict[str, Any]:
    """Return all functions of the chapters' pages."""
    pages = {chapter: importlib.import_module(f"contact_dynamics.{chapter}") for chapter in CHAPTERS}
    found = {
        f"{chapter}.{name}": getattr(page, name) for chapter, page in pages.items() for name in page.__all__
    }
    return {name: thing for name, thing in found.items() if inspect.isfunction(thing)}


def test_a_check_leaves_no_trace() -> None:
    """Help, signatures, and references between processes are as without a check."""
    for name, function in public_functions().items():
        inner = inspect.unwrap(function)
        assert (function.__name__, function.__doc__) == (inner.__name__, inner.__doc__), name
        assert inspect.signature(function) == inspect.signature(inner), name
        assert pickle.loads(pickle.dumps(function)) is function, name  # noqa: S301  our own
        assert getattr(sys.modules[inner.__module__], inner.__name__) is inner, name


def test_what_is_wrong_in_another_way_is_still_told_as_before() -> None:
    with pytest.raises(InvalidFieldError, match=r"^normal_W must be a unit vector"):
        Surface(**{**FLOOR, "normal_W": [0, 0, 2]})
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'contact'"):
        spatial_impact(BALL, STATE)
    assert isinstance(ContactSet.of([CONTACT]), ContactSet)
    assert isinstance(PlanarBody(mass=1, inertia=True), PlanarBody)


IMPACTS = CALLS["spatial_impacts"][1]


def choices() -> list[tuple[str, str, type[Enum]]]:
    """Return the public calls with their arguments that are of an enumeration, or of rows of one."""
    found: list[tuple[str, str, type[Enum]]] = []
    for name, (call, _) in CALLS.items():
        inner = inspect.unwrap(getattr(call, "__func__", call))
        for argument, text in inspect.get_annotations(inner).items():
            kind = vars(inspect.getmodule(inner)).get(text)
            if argument == "restitution_laws" and name.endswith("_impacts"):
                kind = RestitutionLaw
            if argument != "return" and inspect.isclass(kind) and issubclass(kind, Enum):
                found.append((name, argument, kind))
    return found


@pytest.mark.parametrize(("name", "argument", "kind"), choices())
def test_members_are_taken_and_all_else_is_refused_by_name(
    name: str, argument: str, kind: type[Enum]
) -> None:
    call, arguments = CALLS[name]
    for member in kind:
        call(**{**arguments, argument: member})
    other = SeveralContactsLaw.SIMULTANEOUS if kind is RestitutionLaw else RestitutionLaw.NEWTON
    for wrong, shown in (
        ("newton", "'newton'"),
        (None, "None"),
        (True, "True"),
        (other, f"{type(other).__name__}.{other.name}"),
    ):
        with pytest.raises(WrongTypeError) as raised:
            call(**{**arguments, argument: wrong})
        text = str(raised.value)
        assert text.startswith(f"{argument} must be ")
        assert f", got {shown}" in text
        assert all(member.name in text for member in kind)
    with pytest.raises(InvalidFieldError, match=rf"^{argument}(\[0\])? must be .* got 7"):
        call(**{**arguments, argument: 7})


def test_choices_are_found_in_every_chapter() -> None:
    kinds = {kind.__name__ for _, _, kind in choices()}
    assert {"Precision", "WrenchAxes", "PropagationMethod", "SeveralContactsLaw", "Problem"} < kinds
    assert len(choices()) > 25


@pytest.mark.parametrize(
    ("laws", "row"),
    [
        ([RestitutionLaw.NEWTON, "newton"], 1),
        ([RestitutionLaw.NEWTON, SeveralContactsLaw.SIMULTANEOUS], 1),
        (np.array(["poisson"]), 0),
        (np.array([0.0, 1.0, float(len(RestitutionLaw))]), 2),
        ([None], 0),
    ],
)
def test_a_list_of_laws_names_the_row(laws: Any, row: int) -> None:
    with pytest.raises(InvalidFieldError, match=rf"^restitution_laws\[{row}\](:| must be).*NEWTON"):
        impact.spatial_impacts(**IMPACTS, restitution_laws=laws)


def test_a_list_of_laws_may_hold_members_or_values() -> None:
    by_member = impact.spatial_impacts(
        **IMPACTS, restitution_laws=[RestitutionLaw.NEWTON, RestitutionLaw.POISSON]
    )
    by_value = impact.spatial_impacts(**IMPACTS, restitution_laws=np.array([1, 0]))
    assert by_member.restitution_laws.tolist() == by_value.restitution_laws.tolist() == [1, 0]
    assert np.array_equal(by_member.impulses_W, by_value.impulses_W)
