# SPDX-License-Identifier: Apache-2.0
"""Calls compose: what one returns is what the next takes, and a `Body` does where mass properties do."""

from __future__ import annotations

import importlib
import inspect
from typing import Any

import numpy as np
import pytest

from architecture.test_doors import CHAPTERS
from contact_dynamics import (
    Body,
    BodyState,
    RestitutionLaw,
    Surface,
    World,
    find_contacts,
    impact,
    inertia,
    next_landing,
    sampled_toss,
    shapes,
    spatial_impact,
)
from contact_dynamics.constants import HORIZON
from contact_dynamics.records import Record
from hostile_values import CALLS

SIZE = (0.15, 0.09, 0.05)
BRICK = Body.of("brick", inertia.box(SIZE, mass=0.4), shape_F=shapes.box(SIZE))
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)
WORLD = World(bodies=(BRICK,), surfaces=(FLOOR,))
FALLING = BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1], v_WB_W=[1.5, 0, -1.0], w_WB_W=[0, 2.0, 0])
LANDED = BodyState(p_WB_W=[0, 0, 0.025], q_WB=[0, 0, 0, 1], v_WB_W=[0.5, 0, -1.0])
CONTACTS = find_contacts(BRICK, LANDED, WORLD)


def takers() -> dict[str, list[str]]:
    """Return the public calls that take a body or its mass properties, with the arguments that do."""
    found = {"SpatialContactProblem": ["body"]}
    for name, (call, _) in CALLS.items():
        parameters = inspect.signature(call).parameters.values()
        if names := [one.name for one in parameters if "HasMassProperties" in str(one.annotation)]:
            found[name] = names
    return found


@pytest.mark.filterwarnings("ignore::contact_dynamics.errors.FarContactWarning")
@pytest.mark.parametrize("name", takers())
def test_a_body_does_where_its_mass_properties_do(name: str) -> None:
    call, arguments = CALLS[name]

    def answer(body: object) -> Any:
        given = {one: [body] if one == "bodies" else body for one in takers()[name]}
        found = call(**{**arguments, **given})
        return getattr(found, "motion", found)

    by_body, by_mass = answer(BRICK), answer(BRICK.mass_properties)
    if hasattr(by_body, "state_at"):
        by_body, by_mass = by_body.state_at(0.1), by_mass.state_at(0.1)
    if isinstance(by_body, Record):
        assert by_body.to_dict() == by_mass.to_dict()
    else:
        np.testing.assert_array_equal(by_body, by_mass)


def test_no_call_takes_mass_properties_alone() -> None:
    for chapter in CHAPTERS:
        for name, call in vars(importlib.import_module(f"contact_dynamics.{chapter}")).items():
            if inspect.isfunction(call):
                for one in inspect.signature(call).parameters.values():
                    assert one.name not in {"body", "other"} or one.annotation != "MassProperties", name


def test_a_flight_leads_to_its_impact_without_unpacking() -> None:
    landing = next_landing(BRICK, FALLING, WORLD, horizon=1.0)
    assert landing is not None
    after = spatial_impact(BRICK, landing.state, landing.contacts[0])
    assert after.state.v_WB_W[2] > landing.state.v_WB_W[2]


def test_the_horizon_and_the_law_have_one_name_and_one_default() -> None:
    found = set()
    for chapter in CHAPTERS:
        for name, call in vars(importlib.import_module(f"contact_dynamics.{chapter}")).items():
            if inspect.isfunction(call):
                parameters = inspect.signature(call).parameters
                assert not {"law", "until", "duration"} & parameters.keys(), name
                if "horizon" in parameters:
                    assert parameters["horizon"].default == HORIZON, name
                    found.add(name)
                if "restitution_law" in parameters:
                    assert parameters["restitution_law"].default is RestitutionLaw.POISSON, name
    assert found == {"first_contact", "next_landing", "next_meeting", "sampled_toss", "toss"}


def test_a_sampled_toss_says_which_face_is_on_top_and_how_sure_that_is() -> None:
    die = Body.box((0.016, 0.016, 0.016), 0.005, name="die")
    low = BodyState(p_WB_W=[0, 0, 0.01], q_WB=[0, 1, 0, 0])
    told = sampled_toss(die, low, WORLD, count=50, to_rest=True, covariance=1e-8 * np.eye(12))
    assert told.faces_on_top == ("-z",)  # turned by half a turn about y
    assert told.standard_error(0.5) == pytest.approx(0.5 / np.sqrt(50))
    assert told.standard_error(told.face_probabilities[0]) == 0.0
    spread = impact.spatial_impact_distribution(
        BRICK, LANDED, CONTACTS[0], covariance=np.eye(12), samples=100
    )
    shares = spread.probabilities
    np.testing.assert_allclose(spread.standard_errors, np.sqrt(shares * (1 - shares) / 100))


def test_lengths_go_by_place() -> None:
    by_name = shapes.box(size=SIZE).vertices
    for given in (shapes.box(*SIZE), shapes.box(SIZE), shapes.box(list(SIZE))):
        np.testing.assert_array_equal(given.vertices, by_name)
    np.testing.assert_array_equal(inertia.box(*SIZE, mass=1).I_B, inertia.box(size=SIZE, mass=1).I_B)
    assert shapes.sphere(0.1).rounding == 0.1
    assert shapes.cylinder(0.1, 0.4).rims[1].center == (0.0, 0.0, 0.2)
    assert shapes.rounded(shapes.sphere(0.1), 0.2).rounding == pytest.approx(0.3)
    with pytest.raises(ValueError, match=r"size.*shape \(3,\)"):
        shapes.box(0.1)
