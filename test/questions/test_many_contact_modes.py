# SPDX-License-Identifier: Apache-2.0
"""Many candidates at once have the answers of as many single questions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, ContactSet
from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError, NoContactError, TooLargeError
from contact_dynamics.questions import ContactModeQuestion, Context, ask
from contact_dynamics.questions.context import Problem
from contact_dynamics.questions.many_contact_modes import (
    MAX_CANDIDATES,
    ManyContactModesAnswer,
    ManyContactModesQuestion,
)
from questions.known_world import CUBE, WORLD

KNOWN = Context(world=WORLD)
LYING = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1])
ON_FLOOR = ContactModeQuestion(body="cube", state=LYING, distance_tolerance=1e-6)


def candidates(count: int = 18) -> tuple[np.ndarray, np.ndarray]:
    """Pushes in and out of a plane, up and down, that lift, slide, tip and hold a cube."""
    draw = np.random.default_rng(12)
    forces = draw.normal(size=(count, 3)) * [8.0, 8.0, 16.0]
    forces[::3, 1] = 0.0
    torques = 0.8 * draw.normal(size=(count, 3))
    torques[::3, (0, 2)] = 0.0
    return forces, torques


def check_as_single(found: ManyContactModesAnswer, i: int, question: ContactModeQuestion) -> None:
    """Assert that candidate i has the answer of a single question, to the last bit."""
    alone = ask(question, KNOWN)
    assert (found.verdicts[i], found.problems[i]) == (alone.verdict, alone.problem)
    end = int(found.mode_counts[: i + 1].sum())
    rows = slice(end - int(found.mode_counts[i]), end)
    assert found.modes[rows] == tuple(mode.mode for mode in alone.modes)
    for name in ("acceleration_W", "angular_acceleration_W"):
        expected = np.array([getattr(mode, name) for mode in alone.modes]).reshape(-1, 3)
        whole = found.accelerations_W if name == "acceleration_W" else found.angular_accelerations_W
        np.testing.assert_array_equal(whole[rows], expected)
    if found.margins is not None:
        np.testing.assert_array_equal(found.margins[rows], [each.margin for each in alone.margins or ()])


def test_many_wrenches_are_as_many_single_questions() -> None:
    forces, torques = candidates()
    found = ask(ManyContactModesQuestion(asked=ON_FLOOR, forces_W=forces, torques_W=torques), KNOWN)
    assert {Problem.PLANAR, Problem.SPATIAL} == {Problem(each) for each in found.problems}
    assert len(set(found.modes)) > 4
    for i in range(len(forces)):
        check_as_single(found, i, replace(ON_FLOOR, force_W=forces[i], torque_W=torques[i]))
    assert len(found.contacts) == 4


def test_margins_come_where_they_are_asked_for() -> None:
    forces, torques = (rows[::3] for rows in candidates())
    asked = replace(ON_FLOOR, include_margins=True)
    found = ask(ManyContactModesQuestion(asked=asked, forces_W=forces, torques_W=torques), KNOWN)
    assert found.margins is not None
    for i in range(len(forces)):
        check_as_single(found, i, replace(asked, force_W=forces[i], torque_W=torques[i]))


def test_many_sets_of_contacts_are_as_many_single_questions() -> None:
    """A cube that is held at two, three or four of its feet, in turn: some of them let it tip."""
    feet = ask(ON_FLOOR, KNOWN).contacts
    chosen = [(0, 1), (0, 1, 2), (2, 3), (0, 1, 2, 3)]
    together = feet.subset([i for each in chosen for i in each])
    question = ManyContactModesQuestion(
        asked=replace(ON_FLOOR, contacts=together),
        forces_W=np.array([[0.5, 0.0, 0.0]]),
        torques_W=np.zeros((1, 3)),
        contact_counts=[len(each) for each in chosen],
    )
    found = ask(question, KNOWN)
    assert len(found.verdicts) == len(chosen)
    assert found.verdicts.tolist() == [ModeVerdict.UNIQUE] * 4
    assert found.modes[0] != found.modes[3]
    for i, each in enumerate(chosen):
        single = replace(ON_FLOOR, contacts=feet.subset(each), force_W=np.array([0.5, 0.0, 0.0]))
        check_as_single(found, i, single)


def test_no_candidate_is_answered() -> None:
    question = ManyContactModesQuestion(asked=ON_FLOOR, forces_W=np.zeros((0, 3)), torques_W=np.zeros((0, 3)))
    found = ask(question, KNOWN)
    assert len(found.verdicts) == len(found.modes) == 0
    assert found.accelerations_W.shape == (0, 3)


def test_a_candidate_that_is_not_allowed_is_named() -> None:
    forces = np.zeros((3, 3))
    forces[2, 1] = 1.0
    asked = replace(ON_FLOOR, problem=Problem.PLANAR, plane=None)
    question = ManyContactModesQuestion(asked=asked, forces_W=forces, torques_W=forces)
    with pytest.raises(ContactDynamicsError, match="candidate 2: "):
        ask(question, KNOWN)
    flying = replace(ON_FLOOR, state=replace(LYING, p_WB_W=[0, 0, 1]))
    with pytest.raises(NoContactError, match="contacts: no point of 'cube'"):
        ask(ManyContactModesQuestion(asked=flying, forces_W=forces, torques_W=forces), KNOWN)


@pytest.mark.parametrize(
    ("counts", "rows", "words"),
    [
        ((1, 2), 2, r"contact_counts must be numbers >= 1 whose sum is 4.*, got \(1, 2\)"),
        ((0, 4), 2, r"contact_counts must be .*, got \(0, 4\)"),
        ((2, 2), 3, "forces_W must be 2, one for each set of contacts, or one for all.*, got 3 rows"),
    ],
)
def test_counts_that_do_not_fit_are_refused(counts: tuple[int, ...], rows: int, words: str) -> None:
    four = ContactSet(p_WC_W=np.zeros((4, 3)), normals_W=[[0, 0, 1]] * 4, frictions=np.ones(4))
    asked = replace(ON_FLOOR, contacts=four)
    zeros = np.zeros((rows, 3))
    with pytest.raises(InvalidFieldError, match=words):
        ManyContactModesQuestion(asked=asked, forces_W=zeros, torques_W=zeros, contact_counts=counts)


@pytest.mark.parametrize(
    "option",
    [
        {"force_W": [1.0, 0.0, 0.0]},
        {"torque_W": [0.0, 0.0, 1.0]},
        {"friction_facets": 16},
        {"include_wrenches": True},
        {"include_statics": True},
        {"include_impact": True},
        {"include_probabilities": True},
        {"include_geometry_margins": True},
        {"uncertainty": ContactUncertainty(points=1e-3)},
    ],
    ids=lambda option: next(iter(option)),
)
def test_an_option_that_would_be_ignored_is_an_error_that_names_it(option: dict[str, Any]) -> None:
    (name,) = option
    with pytest.raises(InvalidFieldError, match=rf"asked\.{name} must be"):
        ManyContactModesQuestion(
            asked=replace(ON_FLOOR, **option), forces_W=[[1, 0, 0]], torques_W=[[0, 0, 0]]
        )


def test_arrays_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InvalidFieldError, match=r"torques_W must be .*, got shape"):
        ManyContactModesQuestion(asked=ON_FLOOR, forces_W=np.zeros((2, 3)), torques_W=np.zeros((3, 3)))
    many = np.zeros((MAX_CANDIDATES + 1, 3))
    with pytest.raises(TooLargeError, match=r"forces_W must be at most 1000.*, got 1001 candidates"):
        ManyContactModesQuestion(asked=ON_FLOOR, forces_W=many, torques_W=many)


def test_a_described_body_needs_no_name() -> None:
    asked = replace(ON_FLOOR, body=Body(name="", mass_properties=CUBE.mass_properties), contacts=None)
    with pytest.raises(NoContactError, match="has no shape"):
        ask(ManyContactModesQuestion(asked=asked, forces_W=[[1, 0, 0]], torques_W=[[0, 0, 0]]))
