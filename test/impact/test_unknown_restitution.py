# SPDX-License-Identifier: Apache-2.0
"""An impact needs restitutions, and says so. Contact modes do not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from contact_dynamics import (
    Body,
    BodyState,
    Contact,
    ContactSet,
    MassProperties,
    PlanarBody,
    PlanarContact,
    PlanarVelocity,
    SpatialContactProblem,
    World,
)
from contact_dynamics.contact_modes import contact_modes
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import (
    bodies_impact,
    impact_sequence,
    jamming_impact,
    outcomes_over_interleavings,
    outcomes_over_orders,
    planar_impact,
    response_impact,
    several_impact,
    spatial_impact,
    spatial_impact_distribution,
    spatial_pair_impact,
)
from contact_dynamics.questions import ContactModeQuestion, ImpactQuestion
from contact_dynamics.questions import contact_modes as modes_questions
from contact_dynamics.questions import impact as impact_questions

BODY = MassProperties(mass=1.0, I_B=np.diag([0.1, 0.1, 0.1]))
FALLING = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -1])
RESTING = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1])
POINT = Contact(p_WC_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3)
FEET = ContactSet(p_WC_W=[[-0.1, 0, 0], [0.1, 0, 0]], normals_W=[0, 0, 1], frictions=0.3)
CUBE = Body(name="cube", mass_properties=BODY)
IN_PLANE = PlanarBody(mass=1.0, inertia=0.1), PlanarVelocity(v=(0.0, -1.0), w=0.0)
FOOT = PlanarContact(r=(0.0, -0.1), normal=(0.0, 1.0), friction=0.3)

IMPACTS: dict[str, Callable[[], object]] = {
    "planar": lambda: planar_impact(*IN_PLANE, FOOT),
    "spatial": lambda: spatial_impact(BODY, FALLING, POINT),
    "mechanism": lambda: response_impact(np.eye(3), [0, 0, -1], POINT),
    "pair": lambda: spatial_pair_impact(BODY, FALLING, BODY, RESTING, POINT),
    "several": lambda: several_impact(BODY, FALLING, FEET),
    "bodies": lambda: bodies_impact([BODY], [FALLING], FEET, [(0, None)] * 2),
    "orders": lambda: outcomes_over_orders(BODY, FALLING, FEET),
    "interleavings": lambda: outcomes_over_interleavings(BODY, FALLING, FEET),
    "jamming": lambda: jamming_impact(BODY, RESTING, FEET, force_W=[0, 0, -1]),
    "in time": lambda: impact_sequence(CUBE, FALLING, World(), contacts=FEET),
    "distribution": lambda: spatial_impact_distribution(BODY, FALLING, POINT, covariance=1e-6 * np.eye(12)),
    "question": lambda: impact_questions.answer(ImpactQuestion(body=CUBE, state=FALLING, contacts=FEET)),
    "modes that want an impact": lambda: modes_questions.answer(
        ContactModeQuestion(body=CUBE, state=FALLING, contacts=FEET, include_impact=True)
    ),
}


@pytest.mark.parametrize("name", IMPACTS)
def test_an_impact_without_restitutions_is_an_error(name: str) -> None:
    with pytest.raises(InvalidFieldError, match=r"restitutions? must be in \[0, 1\].*, got none"):
        IMPACTS[name]()


def test_contact_modes_need_none() -> None:
    problem = SpatialContactProblem(body=BODY, state=RESTING, contacts=FEET, force_W=[0, 0, -9.8])
    assert [mode.mode for mode in contact_modes(problem).modes] == ["ff"]
    question = ContactModeQuestion(body=CUBE, state=RESTING, contacts=FEET)
    assert modes_questions.answer(question).contacts.restitutions is None


def test_a_set_of_some_that_are_known_is_refused() -> None:
    with pytest.raises(InvalidFieldError, match=r"restitution must be .*, got none at some contacts"):
        ContactSet.of([POINT, Contact(p_WC_W=[1, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5)])
