# SPDX-License-Identifier: Apache-2.0
"""The visualizer as a process of its own, its parameters, and the configuration that it follows."""

from __future__ import annotations

import select
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import rclpy
from nav_msgs.msg import Odometry
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.context import Context
from rclpy.parameter import Parameter

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    from contact_dynamics.nodes.visualizer import Visualizer
    from viewing.drawn import read_drawn

from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.replay.run import main as replay
from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import DOMAIN_ID, PATIENCE_S, ROOT, process, server_and_client, wait_for

if TYPE_CHECKING:
    from pathlib import Path

from nodes.visualizer_bench import CONFIGURATION, body_state, odometry


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "one of rrd_path, spawn, serve and connect is required"),
        ({"spawn": True, "serve": True}, "only one of .* must be set, got spawn and serve"),
        ({"serve": True, "connect": "rerun+http://127.0.0.1:1/proxy"}, "serve and connect"),
        ({"rrd_path": 3}, "rrd_path"),
        ({"rrd_path": "a.rrd", "port": 0}, "port"),
        ({"rrd_path": "a.rrd", "surface_side": -1.0}, "surface_side"),
        ({"rrd_path": "a.rrd", "predictions": 0}, "predictions"),
        ({"rrd_path": "a.rrd", "rrd_file_size": -1}, "rrd_file_size"),
        ({"rrd_path": "a.rrd", "rrd_max_files": -1}, "rrd_max_files"),
        ({"serve": True, "viewer_memory": "much"}, "viewer_memory must be .*, got 'much'"),
        ({"serve": True, "web_port": 65536}, "web_port"),
    ],
)
def test_parameters_that_are_not_allowed_are_named(values: dict[str, Any], words: str) -> None:
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN_ID)
    try:
        overrides = [Parameter(name, value=value) for name, value in {**CONFIGURATION, **values}.items()]
        with pytest.raises(ConfigurationError, match=words):
            Visualizer(context=context, parameter_overrides=overrides)
    finally:
        rclpy.shutdown(context=context)


def visualizer_with(**parameters: object) -> tuple[str, ...]:
    """Return the arguments of a visualizer of the world that the project's file configures."""
    assigned = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    return ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", *assigned)


def test_a_file_that_cannot_be_written_ends_the_process_with_its_name(tmp_path: Path) -> None:
    path = tmp_path / "nowhere" / "a.rrd"
    with process("visualizer", *visualizer_with(rrd_path=path), ready="nowhere/a.rrd") as started:
        assert started.wait(PATIENCE_S) == 2


def height_of_the_table(path: Path) -> float:
    """Where a picture has the surface that came while it was drawn, before states came or after."""
    drawn = read_drawn(path)
    patch = max(path for path, _ in drawn.values if path.startswith("/world/surfaces/table/patch"))
    return float(drawn.array(patch, "Mesh3D:vertex_positions")[0, 2])


def flight() -> PredictTumbling.Request:
    request = PredictTumbling.Request(body_name="brick", state=body_state())
    request.state_source, request.sampling = request.STATE_EXPLICIT, request.AT_RATE
    request.rate, request.duration = 100.0, 0.25
    return request


def test_the_picture_has_a_servers_answers_and_follows_its_configuration(tmp_path: Path) -> None:
    path = tmp_path / "drawn.rrd"
    arguments = (
        "--params-file",
        str(ROOT / "config" / "server.yaml"),
        "--ros-args",
        "-p",
        f"rrd_path:={path}",
    )
    with server_and_client(tmp_path) as client:
        with process("visualizer", *arguments, ready="ready") as visualizer:
            states = client.publisher(Odometry, "/brick/odometry")
            client.spin_until(lambda: states.get_subscription_count() == 2)
            for _ in range(10):
                states.publish(odometry(client.node.get_clock().now().nanoseconds, 0.0))
            setter = client.node.create_client(
                SetParametersAtomically, "/contact_dynamics/set_parameters_atomically"
            )
            assert setter.wait_for_service(PATIENCE_S)
            tables = {"surfaces": ["floor", "table"], "surface.table.point": [0.0, 0.0, 0.5]}
            tables |= {"surface.table.friction": 0.1, "surface.table.restitution": 0.1}

            def configure(values: dict[str, Any]) -> None:
                parameters = [
                    Parameter(name, value=value).to_parameter_msg() for name, value in values.items()
                ]
                future = setter.call_async(SetParametersAtomically.Request(parameters=parameters))
                client.spin_until(future.done)
                assert future.result().result.successful

            def is_drawn() -> bool:
                """Set them again as long as the visualizer does not hear the server's parameter events."""
                configure(tables)
                assert visualizer.stdout is not None
                readable = select.select([visualizer.stdout], [], [], 2.0)[0]
                return bool(readable) and "brick, floor, table" in visualizer.stdout.readline()

            client.spin_until(is_drawn)
            configure(tables)  # nothing new
            configure({"max_states": 1000})  # nothing that is drawn
            configure({"surface.table.point": [0.0, 0.0, 0.75]})
            wait_for(visualizer, "brick, floor, table")
            # What comes after all events of the changes stands in the next line.
            configure({"surfaces": ["floor"]})
            assert wait_for(visualizer, "configured with now").endswith("now: brick, floor\n")
            answer = client.ask(flight())
            assert answer.status == answer.OK, answer.message
            # Events from before the two processes have found each other are lost: ask until one is drawn.
            client.spin_until(lambda: client.ask(flight()) and b"brick/newest_end" in path.read_bytes())
        assert visualizer.returncode == 0
        strip = read_drawn(path).array("/world/predicted/brick/path", "LineStrips3D:strips")[0]
        np.testing.assert_allclose(strip, np.array(answer.trajectory.positions).reshape(-1, 3), atol=1e-6)
        assert height_of_the_table(path) == 0.75
        log = next(each for each in tmp_path.iterdir() if each.is_dir())
    again = tmp_path / "again.rrd"
    assert replay(["view", str(log), "--rrd", str(again)]) == 0
    assert height_of_the_table(again) == 0.75
