# SPDX-License-Identifier: Apache-2.0
"""A question over a real server and the same question in Python: one answer, to the last bit.

That a service passes on what is asked and answered is shown here, for each service and option. What is
right is shown where it is computed.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np
import pytest
import yaml
from nav_msgs.msg import Path as RosPath

from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.questions import Context, ask
from contact_dynamics.questions.services import SERVICES
from contact_dynamics_interfaces import srv
from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import ROOT, Client

Fields: TypeAlias = "dict[str, Any]"

PARAMETERS = read_server_parameters(ParameterFile(ROOT / "config" / "server.yaml"))
CONTEXT = Context(world=PARAMETERS.world, defaults=PARAMETERS.defaults)
*_, TYPED = yaml.safe_load("""
- &rod {inertia: {m: 1.5, com: {x: 0.02, y: -0.01}, ixx: 0.3, iyy: 0.4, izz: 0.5}}
- &brick {body_name: brick}
- &tossed
  header: {stamp: {sec: 12, nanosec: 345678901}}
  pose: {position: {x: 0.1, y: -0.2, z: 1.0}, orientation: {x: 0.5, y: -0.5, z: 0.5, w: 0.5}}
  linear_velocity: {x: 1.0, y: 0.3, z: -0.5}
  angular_velocity: {x: 1.0, y: 6.0, z: 2.0}
- &flies {state_source: 1, state: *tossed}
- &lying {pose: {position: {z: 0.025}}}
- &pushed {<<: *brick, state_source: 1, state: *lying}
- &left {positions: [-0.1, 0.0, 0.5], normals: [0.0, 0.0, 1.0], frictions: [0.5], restitutions: [0.2],
    surface_names: [left]}
- &right {<<: *left, positions: [0.3, 0.1, 0.5], frictions: [0.1], restitutions: [0.8]}
- &feet {positions: [-0.1, 0.0, 0.5, 0.3, 0.1, 0.5], normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
    frictions: [0.5, 0.1], restitutions: [0.2, 0.8], surface_names: [left, left]}
- &on_feet {contact_source: 1, contacts: *feet}
- &on_right {contact_source: 1, contacts: *right}
- &many
  positions: [0.0, 0.0, 1.0, 0.5, 0.0, 1.0]
  orientations: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
  linear_velocities: [0.3, 0.0, -1.0, 0.0, 0.0, 2.0]
  angular_velocities: [0.0, 3.0, 0.0, 0.0, 3.0, 0.0]
- until contact: [PredictTumbling, {<<: [*brick, *flies], sampling: 3}]
  under forces, uncertain: [PredictTumbling, {<<: [*rod, *flies], sampling: 2, rate: 20.0, duration: 0.5,
    applied_wrench: {force: {x: 0.5}, torque: {z: 0.25}}, wrench_in_body_axes: true, linear_drag: 0.1,
    include_covariance: true}]
  until a plane, with curves: [PredictTumbling, {<<: [*rod, *flies], sampling: 4, plane_point: {z: 0.2},
    plane_normal: {z: 1.0}, body_point: {x: 0.1}, curve_points: 7}]
  at stamps, without weight: [PredictTumbling, {<<: [*rod, *flies], sampling: 1, stamps_ns: [12000000000],
    gravity: 1}]
  a landing: [PredictImpact, {<<: [*brick, *flies]}]
  orders: [PredictImpact, {<<: [*rod, *flies, *on_feet], include_orders: true}]
  in time: [PredictImpact, {<<: *brick, state_source: 1, state: {pose: {position: {z: 0.06},
    orientation: {y: 0.16918234906699603, w: 0.9855847669095608}}}, several_contacts_law: 2,
    strike_window: 0.1, hold_step: 0.001}]
  at once: [PredictImpact, {<<: [*brick, *flies], restitution_law: 1, several_contacts_law: 1}]
  in a plane: [PredictImpact, {<<: *rod, state_source: 1, state: {pose: {position: {z: 0.8}},
    linear_velocity: {x: 1.0, z: -2.0}, angular_velocity: {y: 2.0}}, contact_source: 1,
    contacts: {<<: *left, positions: [-0.1, -0.01, 0.5]}, problem: 1, plane_normal: {y: -1.0},
    out_of_plane_tolerance: 0.001}]
  two bodies: [PredictImpact, {<<: [*rod, *flies, *on_right], other_body_name: brick, other_state: [*lying]}]
  probable outcomes: [PredictImpact, {<<: [*rod, *flies, *on_right], include_covariance: true}]
  margins, wrenches, statics: [PredictContactMode, {<<: *pushed, applied_wrench: {force: {x: 0.75}},
    include_margins: true, include_wrenches: true, include_statics: true}]
  in space: [PredictContactMode, {<<: *pushed, applied_wrench: {force: {x: 1.0, y: 1.0}},
    include_margins: true, include_wrenches: true, friction_facets: 4}]
  on a cart that brakes: [PredictContactMode, {<<: *pushed, contact_source: 1, contacts: {<<: *feet,
    surface_velocities: [2.0, 0.0, 0.0, 2.0, 0.0, 0.0],
    surface_accelerations: [-9.0, 0.0, 0.0, -9.0, 0.0, 0.0]}, problem: 2}]
  with static friction: [PredictContactMode, {<<: *pushed, contact_source: 1,
    contacts: {<<: *feet, static_frictions: [0.6, 0.2]}, problem: 2}]
  settled by an impact: [PredictContactMode, {<<: [*rod, *flies, *on_feet], problem: 2, include_impact: true}]
  uncertain contacts: [PredictContactMode, {<<: [*rod, *on_right], state_source: 1,
    state: {pose: {position: {z: 0.8}}}, problem: 2, uncertainty_frictions: [0.1],
    include_geometry_margins: true}]
  a toss: [PredictToss, {<<: [*brick, *flies], samples: 5, seed: 3, max_alternatives: 1}]
  many impacts: [PredictImpactBatch, {<<: *brick, states: *many, contact_normals: [0.0, 0.0, 1.0],
    contact_positions: [0.05, 0.0, 0.98, 0.5, 0.0, 0.98], frictions: [0.3], restitutions: [0.5]}]
  many tumblings: [PredictTumblingBatch, {<<: *brick, states: *many, times: [0.25, 0.5]}]
  many contact modes: [PredictContactModeBatch, {<<: *pushed, include_margins: true,
    forces: [0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 2.0, 0.0, 0.0]}]
  contact modes of bodies: [PredictBodiesContactMode, {state_source: 1, states: [
    {pose: {position: {z: 0.06}}, header: {stamp: {sec: 3}}, body_name: rod}, {<<: *lying, body_name: brick}],
    inertias: [{m: 1.5, com: {x: 0.02, y: -0.01}, ixx: 0.3, iyy: 0.4, izz: 0.5}, {}], contacts: {
    positions: [0.05, 0.0, 0.0, -0.05, 0.03, 0.0, -0.05, -0.03, 0.0, 0.01, 0.0, 0.05],
    normals: [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0], frictions: [0.5, 0.4, 0.3, 0.2]},
    contact_bodies: [1, 1, 1, 0], other_bodies: [-1, -1, -1, 1],
    applied_wrenches: [{force: {x: 4.0}}, {torque: {z: 0.01}}], velocity_tolerance: 0.000001}]
""")
for uncertain in ("under forces, uncertain", "probable outcomes", "a toss"):
    covariance = np.diag(np.repeat([1e-6, 1e-5, 1e-4, 1e-3], 3)).ravel().tolist()
    TYPED[uncertain][1]["state"] = TYPED[uncertain][1]["state"] | {"covariance": covariance}
REQUESTS: dict[str, tuple[Any, Fields]] = {
    name: (getattr(srv, one), said) for name, (one, said) in TYPED.items()
}


def filled(msg: Any, fields: Fields) -> Any:
    """Fill a message with the fields that are given, and return it."""
    types = msg.get_fields_and_field_types()
    for name, value in fields.items():
        if isinstance(value, dict):
            filled(getattr(msg, name), value)
        elif types[name].startswith("sequence<") and "/" in types[name]:
            package, _, kind = re.split(r"[<>,]", types[name])[1].partition("/")
            made = getattr(import_module(f"{package}.msg"), kind)
            setattr(msg, name, [filled(made(), each) for each in value])
        else:
            setattr(msg, name, value)
    return msg


def contents(msg: Any) -> Any:
    """Return all that a message says, numbers as they are, without the time that it took."""
    if hasattr(msg, "get_fields_and_field_types"):
        names = [name for name in msg.get_fields_and_field_types() if name != "computation_time"]
        return {name: contents(getattr(msg, name)) for name in names}
    if isinstance(msg, str | bool | int):
        return msg
    if isinstance(msg, float):
        return msg.hex()
    return [contents(each) for each in (msg.tolist() if hasattr(msg, "tolist") else msg)]


def test_every_service_is_asked() -> None:
    assert {asked for asked, _ in REQUESTS.values()} == {each.service_type for each in SERVICES}


@pytest.mark.parametrize("name", REQUESTS)
def test_a_server_answers_as_python_does(client: Client, name: str) -> None:
    asked, fields = REQUESTS[name]
    (service,) = (each for each in SERVICES if each.service_type is asked)
    request = filled(asked.Request(), fields)
    answer = ask(service.question_of(request, world=CONTEXT.world, world_frame="world"), CONTEXT)
    here: Any = service.answer_to_msg(answer, world_frame="world", into=asked.Response())
    response = client.ask(request)
    assert response.status == response.OK, response.message
    assert contents(response) == contents(here)


def test_a_path_for_rviz_is_published_while_somebody_listens(client: Client) -> None:
    paths: list[RosPath] = []
    topic = "/contact_dynamics/predicted_path"
    subscription = client.node.create_subscription(RosPath, topic, paths.append, 1)
    request = PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
    request.gravity, request.state.linear_velocity.x = request.GRAVITY_NONE, 1.0
    request.state.angular_velocity.z = 2.0
    request.sampling, request.rate, request.duration = request.AT_RATE, 1000.0, 1.0

    def heard() -> bool:
        client.ask(request)
        return bool(paths)

    client.spin_until(heard)
    client.node.destroy_subscription(subscription)
    path = paths[0]
    assert path.header.frame_id == "world"
    assert 2 < len(path.poses) <= 200
    assert [path.poses[0].pose.position.x, path.poses[-1].pose.position.x] == [0.0, 1.0]
    assert path.poses[-1].header.stamp.sec == 1
    assert path.poses[-1].pose.orientation.z == pytest.approx(np.sin(1.0), abs=1e-14)
