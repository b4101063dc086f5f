# SPDX-License-Identifier: Apache-2.0
"""The same questions of a problem in the plane and in space."""

import dataclasses

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    Certainty,
    ModeVerdict,
    PlanarContactProblem,
    SpatialContactProblem,
    contact_modes,
    mode_margins,
    refused_modes,
    statics,
    wrench_sets,
)
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import planar_problem, spatial_problem
from oracles.contact_mode_cases import draw, rounded

FEET = [PlanarContact(r=(x, -0.1), normal=(0.0, 1.0), friction=0.5) for x in (-0.2, 0.2)]
PLANAR = PlanarContactProblem(
    body=PlanarBody(mass=2.0, inertia=0.033), contacts=FEET, wrench=PlanarWrench(f=(0.0, -19.6))
)
SPATIAL = spatial_problem(
    MassProperties(mass=2.0, I_B=np.diag([0.02, 0.033, 0.04])),
    BodyState(p_WB_W=[0.0, 0.0, 0.1], q_WB=[0.0, 0.0, 0.0, 1.0]),
    ContactSet(
        p_WC_W=[[x, y, 0.0] for x in (-0.2, 0.2) for y in (-0.1, 0.1)],
        normals_W=[0.0, 0.0, 1.0],
        frictions=0.5,
    ),
    [0.0, 0.0, -19.6],
    friction_facets=4,
)


@pytest.mark.parametrize("problem", [PLANAR, SPATIAL], ids=["plane", "space"])
def test_one_problem_takes_every_question(problem: PlanarContactProblem | SpatialContactProblem) -> None:
    answer = contact_modes(problem)
    assert answer.verdict == ModeVerdict.UNIQUE
    fixed = "f" * len(problem.contacts)
    assert [mode.mode for mode in answer.modes] == [fixed]
    (margin,) = mode_margins(problem, answer)
    assert (margin.mode, margin.margin > 0.0) == (fixed, True)
    words = f"every contact stays fixed up to a change of {margin.margin:.3g} N, then "
    assert str(margin).startswith(f"{type(margin).__name__}: {words}")
    assert "s" * len(problem.contacts) in [one.mode for one in refused_modes(problem, answer)]
    assert [one.mode for one in wrench_sets(problem, modes=[fixed])] == [fixed]
    assert statics(problem).equilibrium == Certainty.CERTAIN


def test_a_known_answer_saves_a_search_and_changes_nothing_in_the_plane() -> None:
    """Also where contacts coincide, which the answer takes together and the margins do not."""
    for seed in range(100):
        body, velocity, contacts, wrench = rounded(draw(seed, most_contacts=4))
        contacts = [*contacts, *contacts[: seed % 3]]
        problem = planar_problem(body, velocity, contacts, wrench)
        assert mode_margins(problem, contact_modes(problem)) == mode_margins(problem)


@pytest.mark.parametrize("push", [0.0, 12.0])
def test_a_known_answer_saves_a_search_and_changes_nothing_in_space(push: float) -> None:
    problem = dataclasses.replace(SPATIAL, force_W=[push, 0.1 * push, -19.6])
    for one, other in zip(mode_margins(problem, contact_modes(problem)), mode_margins(problem), strict=True):
        for field in dataclasses.fields(one):
            np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name))


def test_an_answer_belongs_to_its_problem() -> None:
    flat, deep = contact_modes(PLANAR), contact_modes(SPATIAL)
    with pytest.raises(
        InvalidFieldError, match=r"answer must .* PlanarContactProblem, got SpatialModeAnswer"
    ):
        mode_margins(PLANAR, deep)  # type: ignore[call-overload]
    with pytest.raises(
        InvalidFieldError, match=r"answer must .* SpatialContactProblem, got PlanarModeAnswer"
    ):
        refused_modes(SPATIAL, flat)  # type: ignore[call-overload]
    with pytest.raises(InvalidFieldError, match=r"^problem must be .*, got a PlanarBody$"):
        statics(PLANAR.body)  # type: ignore[arg-type]
    with pytest.raises(InvalidFieldError, match="margin_length"):
        refused_modes(PLANAR, flat, margin_length=1.0)  # type: ignore[call-overload]


def test_too_many_planar_contacts_are_refused() -> None:
    with pytest.raises(TooLargeError, match="at most 1000"):
        dataclasses.replace(PLANAR, contacts=FEET * 501)


@pytest.mark.parametrize(("problem", "mode"), [(PLANAR, "fc"), (PLANAR, "f"), (SPATIAL, "ffrr")])
def test_modes_that_are_no_strings_of_letters_are_refused(
    problem: PlanarContactProblem | SpatialContactProblem, mode: str
) -> None:
    with pytest.raises(InvalidFieldError, match="modes must"):
        wrench_sets(problem, modes=[mode])
