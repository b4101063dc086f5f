# SPDX-License-Identifier: Apache-2.0
"""How large a load on several bodies may become: by hand, as for one body, and by linear programs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog

import contact_dynamics as cd
from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes import (
    BodiesContactProblem,
    contact_modes,
    largest_acceleration,
    largest_load,
)
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from sweeps import seeds

G = 10.0  # m/s^2
FACETS = 64


def stack(lower: float, upper: float) -> BodiesContactProblem:
    """A box of 1 kg, 0.2 m wide, on one of 2 kg, 0.3 m wide, both 0.1 m high, with friction below each."""
    feet = [[x, y, z] for s, z in ((0.15, 0.0), (0.1, 0.1)) for x in (-s, s) for y in (-s, s)]
    return BodiesContactProblem(
        bodies=[cd.Body.box((0.3, 0.3, 0.1), mass=2.0), cd.Body.box((0.2, 0.2, 0.1), mass=1.0)],
        states=[cd.BodyState(p_WB_W=[0, 0, z], q_WB=[0, 0, 0, 1]) for z in (0.05, 0.15)],
        contacts=cd.ContactSet(p_WC_W=feet, normals_W=[0, 0, 1], frictions=[lower] * 4 + [upper] * 4),
        pairs=[(0, None)] * 4 + [(1, 0)] * 4,
        forces_W=[[0, 0, -2.0 * G], [0, 0, -G]],
    )


@pytest.mark.parametrize(
    ("frictions", "acceleration", "push"),
    [
        ((0.5, 0.3), 0.3 * G, 0.3 * G),  # the upper box slides
        ((0.2, 0.9), 0.2 * G, 3.0 * 0.2 * G),  # both slide as one
        # Both tip as one about the lower edge of the lower box, 0.25 / 3 m below their centre of mass. A push
        # at the middle of the upper box, 0.05 m above its own edge at 0.1 m, tips that one.
        ((3.0, 5.0), 0.15 / (0.25 / 3.0) * G, 0.1 / 0.05 * G),
    ],
)
def test_stacks_by_hand(frictions: tuple[float, float], acceleration: float, push: float) -> None:
    """A factor is exact to 1e-10 of it."""
    problem = stack(*frictions)
    assert largest_acceleration(problem, [1, 0, 0]).factor == pytest.approx(acceleration, rel=1e-10)
    found = largest_load(problem, force_W=[[0, 0, 0], [1, 0, 0]])
    assert found.factor == pytest.approx(push, rel=1e-10)
    rest = "f" * 8
    for share, rests in ((0.999, True), (1.001, False)):
        pushed = replace(problem, forces_W=[[0, 0, -2.0 * G], [share * push, 0, -G]])
        assert (rest in {mode.mode for mode in contact_modes(pushed).modes}) == rests


def test_a_limit_of_normal_forces_counts_for_several_bodies_too() -> None:
    """Four feet of the lower box bear 30 N and a load on the upper one, up to 10 N each."""
    found = largest_load(stack(0.5, 0.5), force_W=[[0, 0, 0], [0, 0, -1]], max_normal_forces=10.0)
    assert found.factor == pytest.approx(4 * 10.0 - 30.0, rel=1e-10)
    assert found.overloaded == (0, 1, 2, 3)


@seeds(range(4), slow=range(4, 100))
def test_one_body_is_as_a_problem_of_one_body(seed: int) -> None:
    """The same sum of cones, so that the factors differ by rounding."""
    draw = np.random.default_rng(seed)
    box = cd.Body.box(draw.uniform(0.1, 0.5, 3), mass=draw.uniform(1.0, 9.0))
    state = cd.BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    feet = box.shape.vertices[box.shape.vertices[:, 2] < 0.0]
    contacts = cd.ContactSet(p_WC_W=feet, normals_W=[0, 0, 1], frictions=draw.uniform(0.1, 1.0))
    weight, load = [0, 0, -G * box.mass_properties.mass], draw.normal(size=(2, 3))
    one = cd.SpatialContactProblem(body=box, state=state, contacts=contacts, force_W=weight)
    same = BodiesContactProblem(
        bodies=[box], states=[state], contacts=contacts, pairs=[(0, None)] * 4, forces_W=[weight]
    )
    alone = largest_load(one, force_W=load[0], torque_W=load[1])
    found = largest_load(same, force_W=[load[0]], torque_W=[load[1]])
    assert found.factor == pytest.approx(alone.factor, rel=1e-9)


def by_a_linear_program(problem: BodiesContactProblem, load: np.ndarray, friction_factor: float) -> float:
    """The largest factor with pyramids in place of cones, whose friction is multiplied by a factor."""
    contacts, columns = problem.contacts, []
    for i, (first, second) in enumerate(problem.pairs):
        edges = linearised_cone(contacts.normals_W[i], friction_factor * contacts.frictions[i], FACETS)
        for edge in np.asarray(edges):
            column = np.zeros((len(problem.bodies), 6))
            for index, sign in ((first, 1.0), (second, -1.0)):
                if index is not None:
                    arm = contacts.p_WC_W[i] - problem.states[index].p_WB_W
                    column[index] += sign * np.concatenate([edge, np.cross(arm, edge)])
            columns.append(column.ravel())
    wrench = np.hstack([problem.forces_W, problem.torques_W]).ravel()
    found = linprog(
        c=[*np.zeros(len(columns)), -1.0],
        A_eq=np.column_stack([*columns, load.ravel()]),
        b_eq=-wrench,
        method="highs",
    )
    return math.inf if found.status == 3 else float(-found.fun)


@seeds(range(6), slow=range(6, 200))
def test_the_factor_is_between_those_of_pyramids_inside_and_outside_of_the_cones(seed: int) -> None:
    draw = np.random.default_rng(seed)
    problem = stack(*draw.uniform(0.1, 1.5, 2).tolist())
    load = draw.normal(size=(2, 6)) * [1.0, 1.0, 1.0, 0.1, 0.1, 0.1]
    found = largest_load(problem, force_W=load[:, :3], torque_W=load[:, 3:]).factor
    inside = by_a_linear_program(problem, load, 1.0)
    outside = by_a_linear_program(problem, load, 1.0 / math.cos(math.pi / FACETS))
    # HiGHS solves linear programs to about 1e-7.
    assert inside * (1.0 - 1e-6) <= found <= outside * (1.0 + 1e-6)


def test_bodies_that_fall_together_do_not_rest() -> None:
    """All their contacts are fixed, while no support bears them."""
    falling = stack(0.5, 0.5)
    pair: dict[str, Any] = {"pairs": falling.pairs[4:], "contacts": falling.contacts.subset(range(4, 8))}
    pressed = replace(falling, forces_W=[[0, 0, -19.0], [0, 0, -11.0]], **pair)
    assert "ffff" in {mode.mode for mode in contact_modes(pressed).modes}
    with pytest.raises(InvalidFieldError, match="a body that stays fixed"):
        largest_load(pressed, force_W=[[0, 0, 0], [1, 0, 0]])


def test_moving_surfaces_are_refused() -> None:
    problem = stack(0.5, 0.5)
    belt = replace(problem.contacts, surface_accelerations_W=[[1, 0, 0]] * 4 + [[0, 0, 0]] * 4)
    with pytest.raises(NotSupportedError, match="largest_load of several bodies"):
        largest_load(replace(problem, contacts=belt), force_W=[[0, 0, 0], [1, 0, 0]])
