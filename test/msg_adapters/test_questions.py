# SPDX-License-Identifier: Apache-2.0
"""Requests become questions: an empty list says nothing."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.motion import WrenchAxes
from contact_dynamics.motion.forces import NO_WRENCH
from contact_dynamics.questions import (
    AtRate,
    AtStamps,
    AtTimes,
    InTime,
    PublishedState,
    UncertainState,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.subject import NEWEST
from contact_dynamics.rigid_body import BodyState
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictToss, PredictTumbling
from msg_adapters.contact_mode import contact_mode_question_from_msg
from msg_adapters.impact import impact_question_from_msg
from msg_adapters.toss import toss_question_from_msg
from msg_adapters.tumbling import tumbling_question_from_msg
from questions.known_world import CUBE, WORLD

FROM_MSG = {
    PredictTumbling: tumbling_question_from_msg,
    PredictImpact: impact_question_from_msg,
    PredictContactMode: contact_mode_question_from_msg,
}


def read(request: Any) -> Any:
    """Return the question of a request."""
    (from_msg,) = (found for service, found in FROM_MSG.items() if isinstance(request, service.Request))
    return from_msg(request, world=WORLD, world_frame="world")


@pytest.mark.parametrize("service", FROM_MSG)
def test_a_request_that_only_names_a_body_leaves_all_else_to_what_is_known(service: Any) -> None:
    about_times = {"times": [0.0]} if service is PredictTumbling else {}
    question = read(service.Request(body_name="cube", **about_times))
    assert question.body is CUBE
    assert question.state is NEWEST
    for name in ("contacts", "horizon", "plane", "gravity_W", "velocity_tolerance", "distance_tolerance"):
        assert getattr(question, name, None) is None


def test_published_states_are_named_by_stamp_and_window() -> None:
    request = PredictTumbling.Request(body_name="cube", fit_window=0.25, times=[0.0])
    assert read(request).state == PublishedState(stamp_ns=None, fit_window=0.25)
    request.state_source = request.STATE_AT_STAMP
    assert read(request).state == PublishedState(stamp_ns=0, fit_window=0.25)
    request.stamp.sec = 3
    assert read(request).state == PublishedState(stamp_ns=3_000_000_000, fit_window=0.25)


@pytest.mark.parametrize(
    ("service", "field", "attribute"),
    [
        (PredictTumbling, "duration", "sampling.duration"),
        (PredictImpact, "horizon", "horizon"),
        (PredictImpact, "velocity_tolerance", "velocity_tolerance"),
        (PredictImpact, "distance_tolerance", "distance_tolerance"),
        (PredictContactMode, "out_of_plane_tolerance", "out_of_plane_tolerance"),
        (PredictContactMode, "velocity_tolerance", "velocity_tolerance"),
        (PredictContactMode, "distance_tolerance", "distance_tolerance"),
    ],
)
def test_zero_is_a_number_and_a_field_left_out_is_none(service: Any, field: str, attribute: str) -> None:
    request = service.Request(body_name="cube")
    if service is PredictTumbling:
        request.sampling = request.AT_RATE
    found = operator.attrgetter(attribute)
    assert found(read(request)) is None
    setattr(request, field, 0.0)
    assert found(read(request)) == 0.0


def test_an_inertia_without_mass_is_not_taken_for_none() -> None:
    request = PredictTumbling.Request(body_name="cube")
    request.inertia.ixx = 0.1
    with pytest.raises(InvalidFieldError, match=r"^inertia\.m must be > 0, got 0"):
        read(request)


def explicit(service: Any) -> Any:
    """Return a request of a service with a state of its own."""
    request = service.Request(body_name="cube", state_source=service.Request.STATE_EXPLICIT)
    if service is PredictTumbling:
        request.times = [0.0]
    return request


def test_each_number_of_an_uncertain_toss_goes_to_its_own_field() -> None:
    request = explicit(PredictToss)
    request.horizon, request.rate, request.max_alternatives = 1.5, 50.0, 3
    request.samples, request.strikes, request.to_rest, request.seed = 40, 4, True, 7
    request.velocity_spread, request.spin_spread, request.height_spread = 0.01, 0.02, 0.03
    request.lasting_factors, request.lasting_factor_stds = [0.8], [0.1]
    asked = toss_question_from_msg(request, world=WORLD, world_frame="world")
    assert (asked.horizon, asked.rate, asked.max_alternatives) == (1.5, 50.0, 3)
    sampling = asked.sampling
    assert (sampling.count, sampling.strikes, sampling.to_rest, sampling.seed) == (40, 4, True, 7)
    spread = sampling.uncertainty
    assert (spread.velocity, spread.spin, spread.height) == (0.01, 0.02, 0.03)
    assert (*spread.lasting_factors, *spread.lasting_factor_stds, *asked.lasting_factors) == (0.8, 0.1, 0.8)


def test_each_error_of_contacts_goes_to_its_own_field() -> None:
    request = explicit(PredictContactMode)
    request.uncertainty_points, request.uncertainty_normals = [0.01], [0.02]
    request.uncertainty_frictions = [0.03]
    box = read(request).uncertainty
    assert [float(np.max(each)) for each in (box.points, box.normals, box.frictions)] == [0.01, 0.02, 0.03]


def test_an_explicit_state_may_be_uncertain() -> None:
    request = explicit(PredictTumbling)
    assert isinstance(read(request).state, BodyState)
    request.state.covariance = np.eye(12).ravel().tolist()
    state = read(request).state
    assert isinstance(state, UncertainState)
    np.testing.assert_array_equal(state.covariance, np.eye(12))


def test_an_inertia_makes_another_body_of_the_known_one() -> None:
    request = explicit(PredictTumbling)
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.inertia.com.x = 0.05
    question = read(request)
    assert question.body.name == "cube"
    assert question.body.mass_properties.mass == 1.0
    np.testing.assert_allclose(question.body.vertices_B[:, 0], CUBE.vertices_B[:, 0] - 0.05, atol=1e-16)
    np.testing.assert_allclose(question.state.p_WB_W, [0.05, 0.0, 0.0], atol=1e-16)
    assert read(request).body is question.body  # who sends an inertia sends it with every request


@pytest.mark.parametrize(
    ("sampling", "kind"), [(0, AtTimes), (1, AtStamps), (2, AtRate), (3, UntilContact), (4, UntilPlane)]
)
def test_samplings(sampling: int, kind: type) -> None:
    request = PredictTumbling.Request(body_name="cube", sampling=sampling)
    if kind is AtTimes:
        request.times = [0.5]
    elif kind is AtStamps:
        request.stamps_ns = [5]
    else:
        request.duration = 1.5
    if kind is UntilPlane:
        request.plane_normal.z = 1.0
    question = read(request)
    assert type(question.sampling) is kind
    if isinstance(question.sampling, AtRate):
        assert (question.sampling.rate, question.sampling.duration) == (None, 1.5)


def test_forces() -> None:
    request = PredictTumbling.Request(body_name="cube", times=[0.0])
    request.gravity = request.GRAVITY_NONE
    request.quadratic_drag = 0.5
    question = read(request)
    assert question.wrench is NO_WRENCH
    np.testing.assert_array_equal(question.gravity_W, np.zeros(3))
    assert question.drag.quadratic == 0.5
    request.applied_wrench.torque.x = 2.0
    request.wrench_in_body_axes = True
    wrench = read(request).wrench
    assert wrench.axes is WrenchAxes.BODY
    np.testing.assert_array_equal(wrench.torque, [2.0, 0.0, 0.0])


def test_laws() -> None:
    request = PredictImpact.Request(body_name="cube", restitution_law=2, several_contacts_law=1)
    question = read(request)
    assert question.restitution_law is RestitutionLaw.ENERGETIC
    assert question.several_contacts_law is SeveralContactsLaw.SIMULTANEOUS
    request = PredictImpact.Request(body_name="cube", several_contacts_law=2, hold_step=0.001)
    assert read(request).several_contacts_law == InTime(hold_step=0.001)


def test_a_second_body_is_there_where_anything_is_said_of_it() -> None:
    assert read(PredictImpact.Request(body_name="cube")).other is None
    request = PredictImpact.Request(body_name="cube", other_body_name="cube")
    request.stamp.nanosec, request.state_source = 7, request.STATE_AT_STAMP
    question = read(request)
    assert question.other is CUBE
    assert question.other_state == PublishedState(stamp_ns=7)
