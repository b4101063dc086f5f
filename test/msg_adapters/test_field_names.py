# SPDX-License-Identifier: Apache-2.0
"""Errors name the fields of messages to who sent a message, and arguments to who called a function."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError, NoContactError, TooLargeError
from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.field_names import renamed
from msg_adapters.status import report_error


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        ("q_WB", "orientation"),
        ("q_WB[3]", "orientation[3]"),
        ("candidate 3: contacts.p_WC_W[1]", "candidate 3: contacts.positions[1]"),
        ("p_WC_W", "contacts.positions"),
        ("friction", "friction"),
        ("file_seconds", "file_seconds"),
        ("state.q_WB", "state.q_WB"),  # somebody's own field of that name
    ],
)
def test_a_field_has_the_name_of_messages(ours: str, theirs: str) -> None:
    error = renamed(TooLargeError(ours, 3.0, "less"))
    assert type(error) is TooLargeError
    assert (error.field, error.found, error.allowed) == (theirs, 3.0, "less")


def test_an_error_that_names_no_field_stays() -> None:
    error = NoContactError("nothing touches q_WB")
    assert renamed(error) is error


def test_a_response_names_the_field_of_the_request() -> None:
    response = PredictImpact.Response()
    report_error(response, InvalidFieldError("w_WB_W", [np.inf], "finite"))
    assert response.message == "angular_velocity must be finite, got [inf]"


@pytest.mark.parametrize("side", ["body", "surface"])
def test_curvatures_are_named_by_their_side(side: str) -> None:
    msg = ContactSetMsg(positions=[0.0] * 3, normals=[0.0, 0.0, 1.0], frictions=[0.3], restitutions=[0.0])
    msg.kinds = [ContactSetMsg.CURVED]
    for name, curvature in {"body": 1.0, "surface": 0.0, side: np.nan}.items():
        setattr(msg, f"{name}_curvatures", [curvature])
    with pytest.raises(InvalidFieldError, match=rf"^contacts\.{side}_curvatures must be .*, got \[nan\]"):
        contacts_from_msg(msg)
