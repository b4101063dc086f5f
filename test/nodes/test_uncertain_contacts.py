# SPDX-License-Identifier: Apache-2.0
"""Contacts that are known only to some uncertainty, asked about over the service."""

from __future__ import annotations

import math

import pytest

from contact_dynamics_interfaces.srv import PredictContactMode
from message_words import says
from running_server import Client

WEIGHT = 9.80665
FRICTION = 0.5
CORNERS = [(0.1, 0.0), (-0.05, 0.0866), (-0.05, -0.0866)]


def tripod(push: float) -> PredictContactMode.Request:
    request = PredictContactMode.Request()
    request.inertia.m = 1.0
    request.inertia.ixx = request.inertia.iyy = 0.0043
    request.inertia.izz = 0.0053
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.state.pose.position.z = 0.1
    request.contacts.positions = [number for x, y in CORNERS for number in (x, y, 0.0)]
    request.contacts.normals = [0.0, 0.0, 1.0] * 3
    request.contacts.frictions = [FRICTION] * 3
    request.contacts.restitutions = [0.0] * 3
    request.applied_wrench.force.x = push
    return request


def test_a_tripod_surely_stays_within_a_tenth_of_a_milliradian(client: Client) -> None:
    request = tripod(3.0)
    request.uncertainty_normals, request.uncertainty_frictions = [1e-4], [1e-2, 1e-2, 1e-3]
    answer = client.ask(request)
    assert (answer.status, answer.problem) == (answer.OK, request.SPATIAL)
    assert list(answer.verdicts_within) == [answer.UNIQUE]
    assert list(answer.modes_within) == ["fff"]
    assert (answer.within_certain, answer.within_samples) == (True, 0)
    assert list(answer.uncertainty_points) == []
    assert list(answer.uncertainty_frictions) == [1e-2, 1e-2, 1e-3]


def test_friction_that_may_be_too_little_leaves_it_open_whether_it_slides(client: Client) -> None:
    request = tripod(3.0)
    request.problem, request.uncertainty_frictions = request.SPATIAL, [0.4]
    answer = client.ask(request)
    assert answer.verdict == answer.UNIQUE
    assert not answer.within_certain
    assert answer.within_samples > 0
    assert {"fff", "ccc"} <= set(answer.modes_within)


def test_nothing_is_said_about_contacts_that_are_known_exactly(client: Client) -> None:
    answer = client.ask(tripod(3.0))
    assert answer.status == answer.OK
    assert not answer.verdicts_within
    assert not answer.modes_within
    assert not answer.geometry_margins
    assert (answer.within_certain, answer.within_samples) == (False, 0)


def test_margins_in_the_geometry_bracket_where_it_slips(client: Client) -> None:
    """A ball that is pushed rolls if mu m g exceeds the push by I / (I + m r^2)."""
    push, radius = 3.0, 0.1
    request = tripod(push)
    request.contacts.positions, request.contacts.normals = [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]
    request.contacts.frictions, request.contacts.restitutions = [FRICTION], [0.0]
    request.include_geometry_margins = True
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert "got uncertain points or normals" in answer.out_of_plane_reason
    points, normals, frictions = answer.geometry_margins
    assert [one.kind for one in (points, normals, frictions)] == ["points", "normals", "frictions"]
    assert 0.0 < normals.holds_within <= normals.changes_at < math.pi / 2.0
    inertia = request.inertia.iyy
    lost = FRICTION - push * inertia / (inertia + radius**2) / WEIGHT
    assert 0.0 < frictions.holds_within <= lost <= frictions.changes_at
    assert list(frictions.modes_beyond) == ["c"]


@pytest.mark.parametrize(
    ("field", "values", "words"),
    [
        ("uncertainty_points", [-1e-3], "uncertainty_points must be ..., got -0.001"),
        ("uncertainty_normals", [2.0], "uncertainty_normals must be ..., got 2.0"),
        ("uncertainty_frictions", [0.1, math.nan, 0.1], "uncertainty_frictions[1] must be ..., got nan"),
        ("uncertainty_points", [1e-3, 1e-3], "must be one number, or one for each of 3 contacts"),
    ],
)
def test_what_is_no_uncertainty_is_refused_by_the_name_of_its_field(
    client: Client, field: str, values: list[float], words: str
) -> None:
    request = tripod(3.0)
    setattr(request, field, values)
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert says(answer.message, words)


def test_many_uncertain_contacts_are_too_many(client: Client) -> None:
    request = tripod(0.0)
    request.contacts.positions = [number for i in range(17) for number in (0.01 * i, 0.001 * i * i, 0.0)]
    request.contacts.normals = [0.0, 0.0, 1.0] * 17
    request.contacts.frictions, request.contacts.restitutions = [0.5] * 17, [0.0] * 17
    request.uncertainty_normals = [1e-6]
    answer = client.ask(request)
    assert answer.status == answer.TOO_LARGE
    assert "17 contacts" in answer.message
