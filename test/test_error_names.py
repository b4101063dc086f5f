# SPDX-License-Identifier: Apache-2.0
"""Errors of functions name the argument as the caller wrote it; those of batches name the row."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from contact_dynamics import contact_modes, impact
from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.plane.types import PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import free_motion
from contact_dynamics.world import Body, Surface, World

NAN = float("nan")
BODY = MassProperties(mass=1.0, I_B=0.1 * np.eye(3))
STATE = BodyState(p_WB_W=np.zeros(3), q_WB=np.eye(4)[3])
CONTACTS = ContactSet(
    p_WC_W=[[0.0, 0.0, -0.5]], normals_W=[[0.0, 0.0, 1.0]], frictions=[0.3], restitutions=[0.5]
)
STRIKES = {"p_WC_W": (0.0, 0.0, -0.5), "normal_W": (0.0, 0.0, 1.0), "friction": 0.3, "restitution": 0.5}


def loaded(function: Callable[..., Any]) -> Callable[..., Any]:
    return lambda **wrong: function(BODY, STATE, CONTACTS, **{"force_W": (0.0, 0.0, -9.8), **wrong})


def problem(**wrong: Any) -> contact_modes.SpatialContactProblem:
    good = {"body": BODY, "state": STATE, "contacts": CONTACTS, "force_W": (0.0, 0.0, -9.8)}
    return contact_modes.SpatialContactProblem(**{**good, **wrong})


PLANAR = {"r": (0.0, -0.5), "normal": (0.0, 1.0), "friction": 0.3}
PLACE = {"p_WB_W": (0.0, 0.0, 1.0), "q_WB": (0.0, 0.0, 0.0, 1.0)}
MOVING = {**PLACE, "v_WB_W": (0.0, 0.0, 0.0), "w_WB_W": (0.0, 0.0, 0.0)}
PLANE = {"p_WS_W": (0.0, 0.0, 0.0), "normal_W": (0.0, 0.0, 1.0)}
FLOOR = {"name": "floor", **PLANE, "friction": 0.3, "restitution": 0.5}
SETS = {"p_WC_W": np.zeros((1, 3)), "normals_W": (0.0, 0.0, 1.0), "frictions": 0.3, "restitutions": 0.5}

CALLS: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "Contact": (lambda **wrong: Contact(**{**STRIKES, **wrong}), ("p_WC_W", "normal_W")),
    "ContactSet": (lambda **wrong: ContactSet(**{**SETS, **wrong}), ("p_WC_W", "normals_W", "frictions")),
    "BodyState": (lambda **wrong: BodyState(**{**MOVING, **wrong}), tuple(MOVING)),
    "MassProperties": (lambda **wrong: MassProperties(mass=1.0, **wrong), ("I_B",)),
    "Surface": (lambda **wrong: Surface(**{**FLOOR, **wrong}), ("p_WS_W", "normal_W")),
    "Body": (lambda **wrong: Body(name="cup", mass_properties=BODY, **wrong), ("p_FB_F",)),
    "World": (World, ("gravity_W",)),
    "PlanarContact": (lambda **wrong: PlanarContact(**{**PLANAR, **wrong}), ("r", "normal")),
    "PlanarVelocity": (lambda **wrong: PlanarVelocity(**{"v": (0.0, 0.0), "w": 0.0, **wrong}), ("v", "w")),
    "PlanarWrench": (lambda **wrong: PlanarWrench(**{"f": (0.0, 0.0), **wrong}), ("f", "moment")),
    "SpatialContactProblem": (problem, ("force_W", "torque_W")),
    "jamming_impact": (loaded(impact.jamming_impact), ("force_W", "torque_W")),
    "free_motion": (lambda **wrong: free_motion(BODY, STATE, **wrong), ("gravity_W",)),
    "impact_sequence_of": (
        lambda **wrong: impact.impact_sequence_of(BODY, STATE, CONTACTS, **wrong),
        ("gravity_W",),
    ),
    "first_contact": (
        lambda **wrong: first_contact(
            free_motion(BODY, STATE),
            np.zeros((1, 3)),
            **{"p_WS_W": np.zeros(3), "normal_W": (0.0, 0.0, 1.0), "horizon": 1.0, **wrong},
        ),
        ("p_WS_W", "normal_W", "horizon"),
    ),
}


WRONG: dict[object, object] = {
    ("ContactSet", "p_WC_W"): [(0.0, NAN, 1.0)],
    ("PlanarContact", "normal"): (0.0, NAN),
    "I_B": [(NAN, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)],
    "frictions": [NAN],
    "q_WB": (0.0, NAN, 0.0, 1.0),
} | dict.fromkeys(("r", "v", "f"), (0.0, NAN)) | dict.fromkeys(("w", "moment", "horizon"), NAN)  # fmt: skip


@pytest.mark.parametrize(
    ("name", "argument"),
    [(name, argument) for name, (_, arguments) in CALLS.items() for argument in arguments],
)
def test_the_argument_is_named_as_it_is_written(name: str, argument: str) -> None:
    with pytest.raises(InvalidFieldError, match=rf"^{argument}(\[0\])? must be .*, got .*nan"):
        CALLS[name][0](**{argument: WRONG.get((name, argument), WRONG.get(argument, (0.0, NAN, 1.0)))})


BATCH = {
    "masses": np.ones(4),
    "inertias": np.ones(4),
    "v": np.tile([0.3, -1.0], (4, 1)),
    "w": np.zeros(4),
    "r": np.tile([0.1, -0.5], (4, 1)),
    "normals": np.tile([0.0, 1.0], (4, 1)),
    "frictions": np.full(4, 0.3),
    "restitutions": np.full(4, 0.5),
}


@pytest.mark.parametrize("field", BATCH)
@pytest.mark.parametrize("value", [NAN, np.inf])
def test_what_is_not_finite_in_a_batch_is_named_with_its_row(field: str, value: float) -> None:
    rows = BATCH[field].copy()
    rows[2] = value
    with pytest.raises(InvalidFieldError, match=rf"^{field}\[2\] must be finite.*, got .*(nan|inf).*"):
        impact.planar_impacts(**{**BATCH, field: rows})


@pytest.mark.parametrize("facets", [2, 8.5, 1_000_000])
def test_facets_are_a_whole_number_within_bounds(facets: float) -> None:
    with pytest.raises(InvalidFieldError, match=rf"^friction_facets must be a whole number.*, got {facets}"):
        problem(friction_facets=facets)
