# SPDX-License-Identifier: Apache-2.0
"""Round bodies and a table with edges over the services, as a user configures them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml

from contact_dynamics_interfaces.msg import ContactSet
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from running_server import Client, server_and_client

G = 9.80665
WORLD = {
    "bodies": ["ball", "can", "brick"],
    "body.ball.mass": 2.0,
    "body.ball.inertia": [0.0],
    "body.ball.sphere": [0.25],
    "body.can.mass": 1.0,
    "body.can.inertia": [0.0],
    "body.can.cylinder": [0.1, 0.3],
    "body.brick.mass": 1.0,
    "body.brick.inertia": [0.0],
    "body.brick.box": [0.4, 0.2, 0.1],
    "surfaces": ["floor", "table"],
    "surface.floor.point": [0.0, 0.0, -1.0],
    "surface.floor.friction": 0.5,
    "surface.floor.restitution": 0.0,
    "surface.table.point": [5.0, 0.0, 0.0],
    "surface.table.vertices": [-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0],
    "surface.table.friction": 0.5,
    "surface.table.restitution": 0.0,
}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = Path(tmp_path_factory.mktemp("log"))
    path = folder / "world.yaml"
    path.write_text(yaml.safe_dump({"/**": {"ros__parameters": WORLD}}), encoding="utf-8")
    with server_and_client(folder, params_file=path) as client:
        yield client


def test_a_ball_that_rolls_on_the_floor_carries_its_weight_and_no_more(client: Client) -> None:
    request = PredictContactMode.Request(body_name="ball", state_source=1)
    request.plane_normal.y = -1.0
    request.state.pose.position.z = -0.75
    request.state.linear_velocity.x = 2.0
    request.state.angular_velocity.y = 8.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert [mode.mode for mode in answer.modes] == ["f"]
    np.testing.assert_allclose(answer.modes[0].contact_forces, [0.0, 0.0, 2.0 * G], atol=1e-9)
    assert list(answer.contacts.kinds) == [ContactSet.CURVED]
    assert list(answer.contacts.body_curvatures) == [4.0]


def test_so_does_one_whose_contact_is_sent_with_its_curvature(client: Client) -> None:
    request = PredictContactMode.Request(body_name="ball", state_source=1, contact_source=1)
    request.plane_normal.y = -1.0
    request.state.linear_velocity.x = 2.0
    request.state.angular_velocity.y = 8.0
    request.contacts.positions = [0.0, 0.0, -0.25]
    request.contacts.normals = [0.0, 0.0, 1.0]
    request.contacts.frictions, request.contacts.restitutions = [0.5], [0.0]
    for kind, force in ((ContactSet.CURVED, 2.0 * G), (ContactSet.POINT_ON_FLAT, None)):
        request.contacts.kinds = [kind]
        request.contacts.body_curvatures, request.contacts.surface_curvatures = [4.0], [0.0]
        answer = client.ask(request)
        assert answer.status == answer.OK, answer.message
        (mode,) = answer.modes
        if force is None:
            assert mode.mode == "s"  # a corner below its centre would be thrown up: 16 m/s^2
        else:
            assert mode.contact_forces[2] == pytest.approx(force, abs=1e-9)


def test_a_can_falls_on_its_side(client: Client) -> None:
    request = PredictTumbling.Request(body_name="can", state_source=1)
    request.state.pose.orientation.x = request.state.pose.orientation.w = math.sqrt(0.5)
    request.state.pose.position.z = -0.9 + 0.5 * G * 0.4**2
    request.sampling, request.rate = request.UNTIL_CONTACT, 100.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert (answer.event, answer.event_surface) == (answer.CONTACT, "floor")
    assert answer.event_time == pytest.approx(0.4, abs=1e-12)


def test_a_brick_lands_half_over_the_edge_of_the_table_or_falls_past_it(client: Client) -> None:
    request = PredictImpact.Request(body_name="brick", state_source=1)
    request.state.pose.position.x, request.state.pose.position.z = 6.0, 0.05 + 0.5 * G * 0.3**2
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert list(answer.contacts.surface_names) == ["table"] * 4
    assert sorted(answer.contacts.kinds) == [ContactSet.POINT_ON_FLAT] * 2 + [ContactSet.CURVED] * 2
    request.state.pose.position.x = 6.3
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert list(answer.contacts.surface_names) == ["floor"] * 4
