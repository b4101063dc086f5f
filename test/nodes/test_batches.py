"""Many states in one call, over DDS: each has the answer of a single call, and one bad row is named."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics_interfaces.msg import BodyStates
from contact_dynamics_interfaces.srv import (
    PredictImpact,
    PredictImpactBatch,
    PredictTumbling,
    PredictTumblingBatch,
)
from running_server import Client, server_and_client

COUNT = 30
DRAW = np.random.default_rng(30)
POSITIONS = DRAW.normal(size=(COUNT, 3))
VELOCITIES = DRAW.normal(size=(COUNT, 3)) - [0.0, 0.0, 1.0]
SPINS = 5.0 * DRAW.normal(size=(COUNT, 3))


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with server_and_client(Path(tmp_path_factory.mktemp("log"))) as client:
        yield client


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


def test_a_row_that_is_not_allowed_is_named(client: Client) -> None:
    request = impacts()
    request.states.orientations[4 * 7 + 3] = 0.5
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert answer.message.startswith("states.orientations[7]: found [0.0, 0.0, 0.0, 0.5], allowed is a unit")
    request = impacts()
    request.frictions = [0.1, 0.2]
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert answer.message.startswith("frictions: found 2 rows, allowed is 30, or one for all")
    request = impacts()
    request.states.linear_velocities = [0.0] * 4
    assert client.ask(request).message.startswith(
        "states.linear_velocities: found 4 numbers, allowed is rows of 3"
    )
