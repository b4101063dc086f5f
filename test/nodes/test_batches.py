# SPDX-License-Identifier: Apache-2.0
"""Many states in one call, over DDS: each has the answer of a single call, and one bad row is named."""

from __future__ import annotations

import numpy as np
import pytest

from contact_dynamics_interfaces.msg import BodyState, BodyStates
from contact_dynamics_interfaces.srv import (
    PredictContactMode,
    PredictContactModeBatch,
    PredictImpact,
    PredictImpactBatch,
    PredictTumbling,
    PredictTumblingBatch,
)
from message_words import says
from running_server import Client

COUNT = 30
DRAW = np.random.default_rng(30)
POSITIONS = DRAW.normal(size=(COUNT, 3))
VELOCITIES = DRAW.normal(size=(COUNT, 3)) - [0.0, 0.0, 1.0]
SPINS = 5.0 * DRAW.normal(size=(COUNT, 3))


def states() -> BodyStates:
    """Of a body that is not turned."""
    return BodyStates(
        positions=POSITIONS.ravel().tolist(),
        orientations=[0.0, 0.0, 0.0, 1.0] * COUNT,
        linear_velocities=VELOCITIES.ravel().tolist(),
        angular_velocities=SPINS.ravel().tolist(),
    )


def put_state(request: PredictImpact.Request | PredictTumbling.Request, i: int) -> None:
    request.body_name, request.state_source = "brick", request.STATE_EXPLICIT
    at, v, w = request.state.pose.position, request.state.linear_velocity, request.state.angular_velocity
    at.x, at.y, at.z = POSITIONS[i].tolist()
    v.x, v.y, v.z = VELOCITIES[i].tolist()
    w.x, w.y, w.z = SPINS[i].tolist()


def rows(numbers: object, width: int = 3) -> np.ndarray:
    return np.array(numbers).reshape(-1, width)


def impacts() -> PredictImpactBatch.Request:
    """One point of the body below and beside its centre of mass strikes."""
    return PredictImpactBatch.Request(
        body_name="brick",
        states=states(),
        contact_positions=(POSITIONS - [0.05, 0.03, 0.025]).ravel().tolist(),
        contact_normals=[0.0, 0.0, 1.0],
        frictions=[0.3],
        restitutions=[0.5],
    )


def test_many_impacts_have_the_answers_of_single_calls(client: Client) -> None:
    answer = client.ask(impacts())
    assert answer.status == answer.OK, answer.message
    after, impulses = rows(answer.states_after.linear_velocities), rows(answer.impulses)
    assert {answer.SEPARATES} < set(answer.outcomes)
    for i in range(0, COUNT, 5):
        single = PredictImpact.Request(contact_source=PredictImpact.Request.CONTACTS_EXPLICIT)
        put_state(single, i)
        single.contacts.positions = (POSITIONS[i] - [0.05, 0.03, 0.025]).tolist()
        single.contacts.normals, single.contacts.frictions = [0.0, 0.0, 1.0], [0.3]
        single.contacts.restitutions = [0.5]
        alone = client.ask(single)
        if answer.outcomes[i] == answer.SEPARATES:
            assert alone.status == alone.SEPARATING
            continue
        assert (alone.status, alone.impact.outcome) == (alone.OK, answer.outcomes[i])
        # Levers of 0.06 m are differences of positions up to 3 m: rounding of 1e-15 m, at 5 rad/s.
        np.testing.assert_allclose(impulses[i], alone.impact.impulses, rtol=0.0, atol=1e-13)
        velocity = alone.impact.state_after.linear_velocity
        np.testing.assert_allclose(after[i], [velocity.x, velocity.y, velocity.z], rtol=0.0, atol=1e-12)


def test_many_tumblings_have_the_answers_of_single_calls(client: Client) -> None:
    request = PredictTumblingBatch.Request(body_name="brick", states=states(), times=[0.25])
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    for i in range(0, COUNT, 7):
        single = PredictTumbling.Request(times=[0.25])
        put_state(single, i)
        alone = client.ask(single).trajectory
        np.testing.assert_allclose(rows(answer.states.positions)[i], alone.positions, rtol=0.0, atol=1e-14)
        turned = rows(answer.states.orientations, 4)[i] @ np.array(alone.orientations)
        assert abs(turned) == pytest.approx(1.0, abs=1e-14)


def pushed_brick(pushes: list[float]) -> PredictContactModeBatch.Request:
    """The brick lies flat and is pushed along x by each of these forces, N."""
    request = PredictContactModeBatch.Request(
        body_name="brick",
        state_source=PredictContactModeBatch.Request.STATE_EXPLICIT,
        forces=[number for push in pushes for number in (push, 0.0, 0.0)],
        include_margins=True,
        problem=PredictContactModeBatch.Request.PLANAR,
    )
    request.state.pose.position.z, request.plane_normal.y = 0.025, -1.0
    return request


@pytest.mark.parametrize("count", [5, 40])  # the server answers the first itself, a worker the second
def test_many_wrenches_have_the_modes_of_single_calls(client: Client, count: int) -> None:
    pushes = np.linspace(0.0, 4.0, count).tolist()
    answer = client.ask(pushed_brick(pushes))
    assert answer.status == answer.OK, answer.message
    assert list(answer.mode_counts) == [1] * count
    assert set(answer.verdicts) == {answer.UNIQUE}
    for i in range(0, count, max(1, count // 4)):
        single = PredictContactMode.Request(body_name="brick", include_margins=True, problem=1)
        single.state_source, single.state = answer_state(pushes[i], single)
        (mode,) = client.ask(single).modes
        assert answer.modes[i] == mode.mode
        assert answer.margins[i] == mode.margin
        assert rows(answer.linear_accelerations)[i].tolist() == list(mode.linear_acceleration)
    # Friction 0.3 holds 1.177 N of 0.4 kg.
    slides = [push for push, mode in zip(pushes, answer.modes, strict=True) if mode == "rrrr"]
    assert min(slides) == min(push for push in pushes if push > 0.3 * 0.4 * 9.80665)


def answer_state(push: float, single: PredictContactMode.Request) -> tuple[int, BodyState]:
    """The state of the brick, in a single request that gets the wrench and the plane too."""
    single.applied_wrench.force.x, single.plane_normal.y = push, -1.0
    single.state.pose.position.z = 0.025
    return single.STATE_EXPLICIT, single.state


def test_many_sets_of_contacts_go_in_one_call(client: Client) -> None:
    """It tips over a foot to the left of its weight or to the right, and stays on both."""
    request = pushed_brick([0.0])
    request.contact_source = request.CONTACTS_EXPLICIT
    left, right = [-0.05, 0.0, 0.0], [0.05, 0.0, 0.0]
    request.contacts.positions = [*left, *right, *left, *right]
    request.contacts.normals = [0.0, 0.0, 1.0] * 4
    request.contacts.frictions, request.contacts.restitutions = [1.0] * 4, [0.0] * 4
    request.contact_counts = [1, 1, 2]
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert list(answer.modes) == ["f", "f", "ff"]
    turns = rows(answer.angular_accelerations)[:, 1]
    assert turns[0] == -turns[1] != 0.0
    assert abs(turns[2]) < 1e-9
    assert list(answer.contact_counts) == [1, 1, 2]
    request.contact_counts = [1, 1]
    refused = client.ask(request)
    assert refused.status == refused.INVALID_FIELD
    assert says(refused.message, "contact_counts must be numbers >= 1 whose sum is 4..., got (1, 1)")


def test_a_row_that_is_not_allowed_is_named(client: Client) -> None:
    request = impacts()
    request.states.orientations[4 * 7 + 3] = 0.5
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert says(answer.message, "states.orientations[7] must be a unit..., got [0.0, 0.0, 0.0, 0.5]")
    request = impacts()
    request.frictions = [0.1, 0.2]
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert says(answer.message, "frictions must be 30, or one for all..., got 2 rows")
    request = impacts()
    request.states.linear_velocities = [0.0] * 4
    assert client.ask(request).message.startswith("states.linear_velocities must be rows of 3, got 4 numbers")
