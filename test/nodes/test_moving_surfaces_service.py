# SPDX-License-Identifier: Apache-2.0
"""A conveyor belt, a turntable and a cart that brakes over the services, and the log of it replayed."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml

from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictToss, PredictTumbling
from running_server import ROOT, Client, environment, server_and_client

G, MU, U, RATE = 9.80665, 0.4, 1.2, 2.0
WORLD = {
    "bodies": ["parcel", "ball"],
    "body.parcel.mass": 1.0,
    "body.parcel.inertia": [0.0],
    "body.parcel.box": [0.2, 0.2, 0.1],
    "body.ball.mass": 0.1,
    "body.ball.inertia": [0.0],
    "body.ball.sphere": [0.05],
    "surfaces": ["belt", "turntable"],
    "surface.belt.friction": MU,
    "surface.belt.restitution": 0.5,
    "surface.belt.velocity": [U, 0.0, 0.0],
    # A vertical disc at x = -3, about the axis y = 1, z = 2.
    "surface.turntable.point": [-3.0, 1.0, 2.0],
    "surface.turntable.normal": [1.0, 0.0, 0.0],
    "surface.turntable.friction": MU,
    "surface.turntable.restitution": 0.5,
    "surface.turntable.angular_velocity": RATE,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(tmp_path_factory.mktemp("log"))


@pytest.fixture(scope="module")
def client(folder: Path) -> Iterator[Client]:
    path = folder / "world.yaml"
    path.write_text(yaml.safe_dump({"/**": {"ros__parameters": WORLD}}), encoding="utf-8")
    with server_and_client(folder / "logs", params_file=path) as client:
        yield client


def contact_modes(client: Client, *, height: float, speed: float) -> PredictContactMode.Response:
    request = PredictContactMode.Request(body_name="parcel", state_source=1)
    request.state.pose.position.z = height
    request.state.linear_velocity.x = speed
    return client.ask(request)


def test_a_parcel_on_a_belt_slides_until_it_rides_along(client: Client) -> None:
    put_down = contact_modes(client, height=0.05, speed=0.0)
    assert put_down.status == put_down.OK, put_down.message
    (mode,) = put_down.modes
    assert mode.mode == "cccc"
    assert mode.linear_acceleration[0] == pytest.approx(MU * G, rel=1e-12)
    np.testing.assert_allclose(np.reshape(put_down.contact_velocities, (4, 3)), [[-U, 0, 0]] * 4, atol=1e-15)
    np.testing.assert_array_equal(put_down.contacts.surface_velocities, [U, 0, 0] * 4)
    riding = contact_modes(client, height=0.05, speed=U)
    assert [mode.mode for mode in riding.modes] == ["ffff"]


def test_explicit_contacts_on_a_braking_cart_hold_up_to_the_friction(client: Client) -> None:
    for braking, letters in ((0.95 * MU * G, "ffff"), (1.05 * MU * G, "cccc")):
        request = PredictContactMode.Request(body_name="parcel", state_source=1, contact_source=1)
        request.state.pose.position.z = 0.05
        request.state.linear_velocity.x = 2.0
        request.contacts.positions = [0.1, 0.1, 0.0, 0.1, -0.1, 0.0, -0.1, 0.1, 0.0, -0.1, -0.1, 0.0]
        request.contacts.normals = [0.0, 0.0, 1.0] * 4
        request.contacts.frictions = [MU] * 4
        request.contacts.surface_velocities = [2.0, 0.0, 0.0] * 4
        request.contacts.surface_accelerations = [-braking, 0.0, 0.0] * 4
        response = client.ask(request)
        assert response.status == response.OK, response.message
        assert [mode.mode for mode in response.modes] == [letters]
        assert response.modes[0].linear_acceleration[0] == pytest.approx(-min(braking, MU * G), rel=1e-12)


def test_a_ball_that_lands_on_a_belt_gets_topspin(client: Client) -> None:
    request = PredictImpact.Request(body_name="ball", state_source=1)
    request.state.pose.position.z = 0.55
    response = client.ask(request)
    assert response.status == response.OK, response.message
    speed = math.sqrt(2.0 * G * 0.5)
    impulse = 0.1 * 1.5 * speed
    # It sticks if friction can bring the contact of a solid ball to the belt's speed: 2/7 of the mass.
    tangential = min(MU * impulse, 2.0 / 7.0 * 0.1 * U)
    after = response.impact.state_after.linear_velocity
    np.testing.assert_allclose([after.x, after.z], [tangential / 0.1, 0.5 * speed], rtol=1e-12)
    assert response.time_to_contact == pytest.approx(speed / G, rel=1e-12)


def test_the_energy_that_a_belt_adds_is_not_created_by_the_law(client: Client) -> None:
    request = PredictImpact.Request(body_name="parcel", state_source=1)
    request.state.pose.position.z = 0.05
    request.state.linear_velocity.x, request.state.linear_velocity.z = 0.5 * U, -0.5
    response = client.ask(request)
    assert response.status == response.OK, response.message
    assert len(response.contacts.frictions) == 4
    # Friction pulls the parcel along, and adds more energy than restitution loses.
    assert 0.5 * U < response.impact.state_after.linear_velocity.x < U
    assert response.impact.kinetic_energy_after > response.impact.kinetic_energy_before
    assert not response.impact.creates_energy


def test_a_ball_thrown_at_a_turntable_meets_the_speed_there(client: Client) -> None:
    request = PredictContactMode.Request(body_name="ball", state_source=1)
    request.state.pose.position.x, request.state.pose.position.y = -2.95, 1.5
    request.state.pose.position.z = 2.0
    response = client.ask(request)
    assert response.status == response.OK, response.message
    # The disc turns about +x: at y 0.5 m from the axis it moves along z.
    np.testing.assert_allclose(response.contacts.surface_velocities, [0, 0, 0.5 * RATE], atol=1e-15)
    np.testing.assert_allclose(response.contacts.surface_angular_velocities, [RATE, 0, 0], atol=1e-15)
    np.testing.assert_allclose(response.contacts.surface_accelerations, [0, -0.5 * RATE**2, 0], atol=1e-15)


def test_a_flight_ends_at_the_belt(client: Client) -> None:
    request = PredictTumbling.Request(
        body_name="ball", state_source=1, sampling=PredictTumbling.Request.UNTIL_CONTACT
    )
    request.state.pose.position.z = 0.55
    response = client.ask(request)
    assert response.status == response.OK, response.message
    assert response.event_time == pytest.approx(math.sqrt(1.0 / G), rel=1e-12)


def test_a_toss_between_surfaces_that_move_differently_is_refused(client: Client) -> None:
    request = PredictToss.Request(body_name="parcel", state_source=1)
    request.state.pose.position.z = 0.3
    response = client.ask(request)
    assert response.status == response.NOT_SUPPORTED
    assert "surfaces that all move with the same" in response.message
    assert "turntable" in response.message


def test_the_log_is_verified(client: Client, folder: Path) -> None:
    assert contact_modes(client, height=0.05, speed=0.0).status == 0
    (log,) = (folder / "logs").iterdir()
    done = subprocess.run(
        [sys.executable, "-m", "contact_dynamics", "replay", "verify", str(log)],
        cwd=ROOT,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
