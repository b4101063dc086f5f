# SPDX-License-Identifier: Apache-2.0
"""Calls compose: what one returns is what the next takes, and a `Body` does where mass properties do."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from architecture.test_doors import CHAPTERS
from contact_dynamics import (
    Body,
    BodyState,
    RestitutionLaw,
    SpatialContactProblem,
    Surface,
    World,
    find_contacts,
    free_motion,
    impact,
    inertia,
    motion,
    motion_of,
    next_landing,
    plane,
    rigid_body,
    sampled_toss,
    several_impact,
    shapes,
    spatial_impact,
)
from contact_dynamics.constants import HORIZON
from contact_dynamics.records import Record

SIZE = (0.15, 0.09, 0.05)
BRICK = Body.of("brick", inertia.box(SIZE, mass=0.4), shape_F=shapes.box(SIZE))
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)
WORLD = World(bodies=(BRICK,), surfaces=(FLOOR,))
FALLING = BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1], v_WB_W=[1.5, 0, -1.0], w_WB_W=[0, 2.0, 0])
LANDED = BodyState(p_WB_W=[0, 0, 0.025], q_WB=[0, 0, 0, 1], v_WB_W=[0.5, 0, -1.0])
BELOW = BodyState(p_WB_W=[0, 0, -0.025], q_WB=[0, 0, 0, 1])
CONTACTS = find_contacts(BRICK, LANDED, WORLD)
WEIGHT: dict[str, Any] = {"force_W": [0.0, 0.0, -3.9], "torque_W": [0.0, 0.0, 0.0]}
LATER = BodyState(
    p_WB_W=[0.15, 0, 0.15],
    q_WB=[0, 0.1, 0, 0.99498744],
    v_WB_W=[1.5, 0, -2],
    w_WB_W=[0, 2, 0],
    stamp_ns=10**8,
)
LAST = free_motion(BRICK, LATER).state_at(0.1)
CALLS: dict[str, Callable[[Any], Any]] = {
    "momentum": lambda body: rigid_body.momentum(body, FALLING),
    "angular_momentum": lambda body: rigid_body.angular_momentum(body, FALLING),
    "kinetic_energy": lambda body: rigid_body.kinetic_energy(body, FALLING),
    "rotational_energy": lambda body: rigid_body.rotational_energy(body, FALLING),
    "free_motion": lambda body: free_motion(body, FALLING).state_at(0.1),
    "motion_of": lambda body: motion_of(body, FALLING).motion.state_at(0.1),
    "forced_motion": lambda body: motion.forced_motion(body, FALLING, drag=motion.Drag(linear=0.1)).state_at(
        0.1
    ),
    "fit_free_motion": lambda body: motion.fit_free_motion(body, [FALLING, LATER, LAST]).state,
    "fit_motion": lambda body: motion.fit_motion(body, [FALLING, LATER, LAST]).state,
    "propagate_covariance": lambda body: motion.propagate_covariance(body, FALLING, np.eye(12), [0.1]),
    "best_plane": lambda body: plane.best_plane(body, LANDED, CONTACTS, **WEIGHT),
    "project_onto_plane": lambda body: plane.project_onto_plane(
        body, LANDED, CONTACTS, plane=plane.best_plane(BRICK, LANDED, CONTACTS, **WEIGHT), **WEIGHT
    ),
    "bodies_impact": lambda body: impact.bodies_impact([body], [LANDED], CONTACTS, [(0, None)] * 4).states[0],
    "impact_sequence_of": lambda body: impact.impact_sequence_of(body, LANDED, CONTACTS).state,
    "jamming_impact": lambda body: impact.jamming_impact(body, LANDED, CONTACTS, **WEIGHT),
    "settling_impact": lambda body: impact.settling_impact(
        body, LANDED, CONTACTS, is_settled=lambda _: True, **WEIGHT
    ),
    "outcomes_at_once": lambda body: impact.outcomes_at_once(body, LANDED, CONTACTS, max_orders=2),
    "outcomes_over_orders": lambda body: impact.outcomes_over_orders(body, LANDED, CONTACTS, max_orders=2),
    "outcomes_over_interleavings": lambda body: impact.outcomes_over_interleavings(
        body, LANDED, CONTACTS, samples=2
    ),
    "several_impact": lambda body: several_impact(body, LANDED, CONTACTS),
    "spatial_impact": lambda body: spatial_impact(body, LANDED, CONTACTS[0]),
    "spatial_pair_impact": lambda body: impact.spatial_pair_impact(body, LANDED, body, BELOW, CONTACTS[0]),
    "spatial_impact_distribution": lambda body: impact.spatial_impact_distribution(
        body, LANDED, CONTACTS[0], covariance=1e-4 * np.eye(12), samples=4
    ),
    "SpatialContactProblem": lambda body: SpatialContactProblem(
        body=body, state=LANDED, contacts=CONTACTS, force_W=WEIGHT["force_W"]
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_a_body_does_where_its_mass_properties_do(name: str) -> None:
    by_body, by_mass = CALLS[name](BRICK), CALLS[name](BRICK.mass_properties)
    if isinstance(by_body, Record):
        assert by_body.to_dict() == by_mass.to_dict()
    else:
        np.testing.assert_array_equal(by_body, by_mass)


def test_no_call_is_left_out() -> None:
    takes_either = {
        name
        for chapter in CHAPTERS
        for name, call in vars(importlib.import_module(f"contact_dynamics.{chapter}")).items()
        if inspect.isfunction(call)
        and any(
            "HasMassProperties" in str(one.annotation) for one in inspect.signature(call).parameters.values()
        )
    }
    assert takes_either == CALLS.keys() - {"SpatialContactProblem"}


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
    assert found == {"first_contact", "next_landing", "sampled_toss", "toss"}


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
