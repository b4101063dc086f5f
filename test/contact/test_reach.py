# SPDX-License-Identifier: Apache-2.0
"""A contact that a body cannot have, mostly since its state is of another time, is warned of."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

from contact_dynamics import (
    Body,
    BodyState,
    SpatialContactProblem,
    Surface,
    World,
    next_landing,
    several_impact,
    spatial_impact,
)
from contact_dynamics.errors import FarContactWarning
from contact_dynamics.impact import spatial_pair_impact

CRATE = Body.box((0.4, 0.3, 0.6), mass=20.0, name="crate")
BALL = Body.sphere(0.1, mass=1.0, name="ball")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=0.3)
WORLD = World(bodies=(CRATE, BALL), surfaces=(FLOOR,))
THROWN = BodyState(p_WB_W=[0, 0, 2], q_WB=[0, 0.6, 0, 0.8], v_WB_W=[1, 0, -1])


def calls(body: Body, state: BodyState, contacts: Any) -> list[Any]:
    """What takes a contact that is given."""
    struck = BodyState(p_WB_W=contacts.p_WC_W[0] - [0, 0, 0.1], q_WB=[0, 0, 0, 1])
    return [
        lambda: spatial_impact(body, state, contacts[0]),
        lambda: several_impact(body, state, contacts),
        lambda: spatial_pair_impact(body, state, BALL, struck, contacts[0]),
        lambda: SpatialContactProblem(body=body, state=state, contacts=contacts, force_W=[0, 0, -9.81]),
    ]


@pytest.mark.parametrize("body", [CRATE, BALL], ids=["crate", "ball"])
def test_the_state_of_the_throw_with_the_contact_of_the_landing(body: Body) -> None:
    landing = next_landing(body, THROWN, WORLD)
    assert landing is not None
    for call in calls(body, THROWN, landing.contacts):
        with pytest.warns(FarContactWarning, match=rf"a contact is [\d.]+ m .* of '{body.name}'") as told:
            call()
        assert told[0].filename == __file__


@pytest.mark.parametrize("body", [CRATE, BALL], ids=["crate", "ball"])
def test_a_contact_within_reach_is_not_warned_of(body: Body) -> None:
    landing = next_landing(body, THROWN, WORLD)
    assert landing is not None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for call in calls(body, landing.state, landing.contacts):
            call()


def test_without_a_shape_nothing_is_out_of_reach() -> None:
    landing = next_landing(CRATE, THROWN, WORLD)
    assert landing is not None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        alone = spatial_impact(CRATE.mass_properties, THROWN, landing.contacts[0])
    with pytest.warns(FarContactWarning):
        assert np.array_equal(spatial_impact(CRATE, THROWN, landing.contacts[0]).impulse_W, alone.impulse_W)
