# SPDX-License-Identifier: Apache-2.0
"""A configured body that is a link of a URDF: it is the library's, and the log does without the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import Parameter

from contact_dynamics import Body
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.srv import PredictImpact
from nodes.monitor import parameters_file
from running_server import PATIENCE_S, Client, process

SIZES = {"box": 'size="0.1 0.2 0.3"', "cylinder": 'radius="0.1" length="0.3"', "sphere": 'radius="0.1"'}
FLOOR = {"surfaces": ["floor"], "surface.floor.friction": 0.3, "surface.floor.restitution": 0.5}


def urdf(*shapes: str) -> str:
    """A robot with a link of 2 kg, whose collision shapes are turned and moved."""
    collisions = "".join(
        f'<collision><origin xyz="0.01 {0.1 * k} 0.03" rpy="0.1 0.2 0.3"/>'
        f"<geometry><{shape} {SIZES[shape]}/></geometry></collision>"
        for k, shape in enumerate(shapes)
    )
    return (
        '<robot name="arm"><link name="base"/><link name="part"><inertial><mass value="2"/>'
        '<origin xyz="0.01 0.05 0.02" rpy="0.3 0 0.1"/>'
        '<inertia ixx="0.02" iyy="0.015" izz="0.01" ixy="0.001" ixz="0" iyz="0"/></inertial>'
        f"{collisions}</link></robot>"
    )


HAMMER = {
    "mass": 0.6,
    "inertia": [0.004, 0.004, 0.001, 0.0, 0.0, 0.0],
    "head.box": [0.1, 0.03, 0.03],
    "head.shape_position": [0.0, 0.0, 0.165],
    "handle.box": [0.02, 0.02, 0.3],
}


def written(folder: Path, **values: Any) -> Path:
    parameters = {"bodies": ["part"], **FLOOR} | {f"body.part.{key}": value for key, value in values.items()}
    return parameters_file(folder, parameters)


@pytest.mark.parametrize(
    "shapes", [(), ("box",), ("cylinder",), ("sphere",), ("box", "cylinder", "sphere")], ids="+".join
)
@pytest.mark.parametrize("given", ["file", "text"])
def test_a_configured_link_is_the_body_that_the_library_reads(
    shapes: tuple[str, ...], given: str, tmp_path: Path
) -> None:
    text = urdf(*shapes)
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    path = written(tmp_path, urdf=str(tmp_path / "arm.urdf") if given == "file" else text, link="part")
    (found,) = read_server_parameters(ParameterFile(path)).world.bodies
    expected = Body.from_urdf(text, "part")
    assert found.mass_properties.mass == expected.mass_properties.mass
    np.testing.assert_array_equal(found.mass_properties.I_B, expected.mass_properties.I_B)
    np.testing.assert_array_equal(found.p_FB_F, expected.p_FB_F)
    assert len(found.shape.convex_parts) == max(len(shapes), 1)
    for part, other in zip(found.shape.convex_parts, expected.shape.convex_parts, strict=True):
        # The quaternion of the shape is made unit once more.
        np.testing.assert_allclose(part.vertices, other.vertices, rtol=0, atol=1e-15)
        assert len(part.rims) == len(other.rims)
        assert part.rounding == other.rounding


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"urdf": urdf("box"), "mass": 1.0}, "body.part.mass must be left out, since "),
        ({"urdf": urdf("box"), "link": "base"}, "body.part.urdf: link must be one of those with a mass"),
        ({"urdf": "missing.urdf"}, "body.part.urdf: source must be a file that can be read"),
        ({"urdf": 1.0}, "body.part.urdf and link must be texts, got 1.0"),
        ({**HAMMER, "parts": ["head", "handle"], "inertia": [0.0]}, "body.part.inertia must be six numbers"),
        ({**HAMMER, "parts": ["head"]}, "body.part.handle.box: there is no such parameter"),
        ({**HAMMER, "parts": ["head", "handle", "grip"]}, "body.part.grip must have a shape"),
        ({**HAMMER, "parts": ["head", "handle"], "head.mass": 1.0}, "body.part.head.mass: there is no such"),
        ({"mass": 1.0, "box": [1.0, 1.0, 1.0], "parts": 5}, "body.part.parts must be a list"),
        (
            {"link": "part", "mass": 1.0, "sphere": [0.1]},
            "body.part.link must be given when ",
        ),
    ],
)
def test_what_is_wrong_with_a_link_is_named(values: dict[str, Any], words: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=words):
        read_server_parameters(ParameterFile(written(tmp_path, **values)))


def test_a_configured_body_of_parts_is_their_union(tmp_path: Path) -> None:
    path = written(tmp_path, **HAMMER, parts=["head", "handle"], center_of_mass=[0.0, 0.0, 0.1])
    (found,) = read_server_parameters(ParameterFile(path)).world.bodies
    heights = [(part.vertices[:, 2].min(), part.vertices[:, 2].max()) for part in found.shape.parts]
    np.testing.assert_allclose(heights, [[0.05, 0.08], [-0.25, 0.05]], atol=1e-16)


def test_the_log_of_a_link_does_without_its_file(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(urdf("box", "cylinder", "sphere"), encoding="utf-8")
    path = written(tmp_path, urdf=str(file))
    settings = ("--ros-args", "-p", f"log_directory:={tmp_path}")
    with process("server", "--params-file", str(path), *settings, ready="ready") as server:
        file.unlink()
        client = Client()
        try:
            request = PredictImpact.Request(
                body_name="part", horizon=2.0, state_source=PredictImpact.Request.STATE_EXPLICIT
            )
            request.state.pose.position.z, request.state.pose.orientation.w = 1.0, 1.0
            assert client.ask(request).status == 0
            getter = client.node.create_client(GetParameters, "/contact_dynamics/get_parameters")
            assert getter.wait_for_service(PATIENCE_S)
            names = ["body.part.mass", "body.part.urdf", "body.part.part_0.box"]
            future = getter.call_async(GetParameters.Request(names=names))
            client.spin_until(future.done)
            mass, text, sides = future.result().values
            assert (mass.double_value, text.string_value) == (2.0, "")
            assert list(sides.double_array_value) == [0.1, 0.2, 0.3]
            setter = client.node.create_client(SetParameters, "/contact_dynamics/set_parameters")
            other = Parameter("body.part.urdf", value="other.urdf").to_parameter_msg()
            future = setter.call_async(SetParameters.Request(parameters=[other]))
            client.spin_until(future.done)
            (result,) = future.result().results
            assert "must be given when the server starts" in result.reason
        finally:
            client.close()
        server.terminate()
        server.wait(PATIENCE_S)
    (folder,) = (each for each in tmp_path.iterdir() if each.is_dir())
    report = verify_log(folder)
    assert report.agrees
    assert sum(tally.equal for tally in report.services.values()) == 1
