# SPDX-License-Identifier: Apache-2.0
"""A question over a real server and the same question in Python: one answer, to the last bit.

That a service passes on what is asked and answered is shown here, for each service and option. What is
right is shown where it is computed.
"""

from __future__ import annotations

import math
import re
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np
import pytest
from nav_msgs.msg import Path as RosPath

from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.questions import Context, ask
from contact_dynamics.questions.services import SERVICES
from contact_dynamics_interfaces.srv import (
    PredictBodiesContactMode,
    PredictContactMode,
    PredictContactModeBatch,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
    PredictTumblingBatch,
)
from running_server import ROOT, Client

Fields: TypeAlias = "dict[str, Any]"

PARAMETERS = read_server_parameters(ParameterFile(ROOT / "config" / "server.yaml"))
CONTEXT = Context(world=PARAMETERS.world, defaults=PARAMETERS.defaults)
ROD: Fields = {"inertia": {"m": 1.5, "com": {"x": 0.02, "y": -0.01}, "ixx": 0.3, "iyy": 0.4, "izz": 0.5}}
TOSSED: Fields = {
    "header": {"stamp": {"sec": 12, "nanosec": 345_678_901}},
    "pose": {
        "position": {"x": 0.1, "y": -0.2, "z": 1.0},
        "orientation": {"x": 0.5, "y": -0.5, "z": 0.5, "w": 0.5},
    },
    "linear_velocity": {"x": 1.0, "y": 0.3, "z": -0.5},
    "angular_velocity": {"x": 1.0, "y": 6.0, "z": 2.0},
}
UNCERTAIN = {**TOSSED, "covariance": np.diag(np.repeat([1e-6, 1e-5, 1e-4, 1e-3], 3)).ravel().tolist()}


def lying(z: float, **fields: Any) -> Fields:
    return {"pose": {"position": {"z": z}}, **fields}


TILTED: Fields = {
    "pose": {"position": {"z": 0.06}, "orientation": {"y": math.sin(0.17), "w": math.cos(0.17)}}
}
LEFT: Fields = {
    "positions": [-0.1, 0.0, 0.5],
    "normals": [0.0, 0.0, 1.0],
    "frictions": [0.5],
    "restitutions": [0.2],
    "surface_names": ["left"],
}
RIGHT: Fields = {**LEFT, "positions": [0.3, 0.1, 0.5], "frictions": [0.1], "restitutions": [0.8]}
FEET: Fields = {name: LEFT[name] + RIGHT[name] for name in LEFT}
MANY: Fields = {
    "positions": [0.0, 0.0, 1.0, 0.5, 0.0, 1.0],
    "orientations": [0.0, 0.0, 0.0, 1.0] * 2,
    "linear_velocities": [0.3, 0.0, -1.0, 0.0, 0.0, 2.0],
    "angular_velocities": [0.0, 3.0, 0.0] * 2,
}
BRICK: Fields = {"body_name": "brick"}
PUSHED: Fields = {**BRICK, "state_source": 1, "state": lying(0.025)}
FLIES: Fields = {"state_source": 1, "state": TOSSED}
REQUESTS: dict[str, tuple[Any, Fields]] = {
    "until contact": (PredictTumbling, {**BRICK, **FLIES, "sampling": 3}),
    "under forces, uncertain": (
        PredictTumbling,
        {
            **ROD,
            "state_source": 1,
            "state": UNCERTAIN,
            "sampling": 2,
            "rate": 20.0,
            "duration": 0.5,
            "applied_wrench": {"force": {"x": 0.5}, "torque": {"z": 0.25}},
            "wrench_in_body_axes": True,
            "linear_drag": 0.1,
            "include_covariance": True,
        },
    ),
    "until a plane, with curves": (
        PredictTumbling,
        {
            **ROD,
            **FLIES,
            "sampling": 4,
            "plane_point": {"z": 0.2},
            "plane_normal": {"z": 1.0},
            "body_point": {"x": 0.1},
            "curve_points": 7,
        },
    ),
    "at stamps, without weight": (
        PredictTumbling,
        {**ROD, **FLIES, "sampling": 1, "stamps_ns": [12_000_000_000], "gravity": 1},
    ),
    "a landing": (PredictImpact, {**BRICK, **FLIES}),
    "orders": (
        PredictImpact,
        {**ROD, **FLIES, "contact_source": 1, "contacts": FEET, "include_orders": True},
    ),
    "in time": (
        PredictImpact,
        {
            **BRICK,
            "state_source": 1,
            "state": TILTED,
            "several_contacts_law": 2,
            "strike_window": 0.1,
            "hold_step": 0.001,
        },
    ),
    "at once": (PredictImpact, {**BRICK, **FLIES, "restitution_law": 1, "several_contacts_law": 1}),
    "in a plane": (
        PredictImpact,
        {
            **ROD,
            "state_source": 1,
            "state": lying(0.8, linear_velocity={"x": 1.0, "z": -2.0}, angular_velocity={"y": 2.0}),
            "contact_source": 1,
            "contacts": {**LEFT, "positions": [-0.1, -0.01, 0.5]},
            "problem": 1,
            "plane_normal": {"y": -1.0},
            "out_of_plane_tolerance": 1e-3,
        },
    ),
    "two bodies": (
        PredictImpact,
        {
            **ROD,
            **FLIES,
            "other_body_name": "brick",
            "other_state": [lying(0.025)],
            "contact_source": 1,
            "contacts": RIGHT,
        },
    ),
    "probable outcomes": (
        PredictImpact,
        {
            **ROD,
            "state_source": 1,
            "state": UNCERTAIN,
            "contact_source": 1,
            "contacts": RIGHT,
            "include_covariance": True,
        },
    ),
    "margins, wrenches, statics": (
        PredictContactMode,
        {
            **PUSHED,
            "applied_wrench": {"force": {"x": 0.75}},
            "include_margins": True,
            "include_wrenches": True,
            "include_statics": True,
        },
    ),
    "in space": (
        PredictContactMode,
        {
            **PUSHED,
            "applied_wrench": {"force": {"x": 1.0, "y": 1.0}},
            "include_margins": True,
            "include_wrenches": True,
            "friction_facets": 4,
        },
    ),
    "on a cart that brakes": (
        PredictContactMode,
        {
            **PUSHED,
            "contact_source": 1,
            "contacts": {
                **FEET,
                "surface_velocities": [2.0, 0.0, 0.0] * 2,
                "surface_accelerations": [-9.0, 0.0, 0.0] * 2,
            },
            "problem": 2,
        },
    ),
    "settled by an impact": (
        PredictContactMode,
        {**ROD, **FLIES, "contact_source": 1, "contacts": FEET, "problem": 2, "include_impact": True},
    ),
    "uncertain contacts": (
        PredictContactMode,
        {
            **ROD,
            "state_source": 1,
            "state": lying(0.8),
            "contact_source": 1,
            "contacts": RIGHT,
            "problem": 2,
            "uncertainty_frictions": [0.1],
            "include_geometry_margins": True,
        },
    ),
    "a toss": (
        PredictToss,
        {**BRICK, "state_source": 1, "state": UNCERTAIN, "samples": 5, "seed": 3, "max_alternatives": 1},
    ),
    "many impacts": (
        PredictImpactBatch,
        {
            **BRICK,
            "states": MANY,
            "contact_positions": [0.05, 0.0, 0.98, 0.5, 0.0, 0.98],
            "contact_normals": [0.0, 0.0, 1.0],
            "frictions": [0.3],
            "restitutions": [0.5],
        },
    ),
    "many tumblings": (PredictTumblingBatch, {**BRICK, "states": MANY, "times": [0.25, 0.5]}),
    "many contact modes": (
        PredictContactModeBatch,
        {**PUSHED, "forces": [0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 2.0, 0.0, 0.0], "include_margins": True},
    ),
    "contact modes of bodies": (
        PredictBodiesContactMode,
        {
            "state_source": 1,
            "states": [
                {"pose": {"position": {"z": 0.06}}, "header": {"stamp": {"sec": 3}}, "body_name": "rod"},
                {"pose": {"position": {"z": 0.025}}, "body_name": "brick"},
            ],
            "inertias": [ROD["inertia"], {}],
            "contacts": {
                "positions": [0.05, 0.0, 0.0, -0.05, 0.03, 0.0, -0.05, -0.03, 0.0, 0.01, 0.0, 0.05],
                "normals": [0.0, 0.0, 1.0] * 4,
                "frictions": [0.5, 0.4, 0.3, 0.2],
            },
            "contact_bodies": [1, 1, 1, 0],
            "other_bodies": [-1, -1, -1, 1],
            "applied_wrenches": [{"force": {"x": 4.0}}, {"torque": {"z": 0.01}}],
            "velocity_tolerance": 1e-6,
        },
    ),
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
