# SPDX-License-Identifier: Apache-2.0
"""Parameters of a file and of the command line, without ROS: the same as ROS reads, and mistakes named."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node

from contact_dynamics import questions
from contact_dynamics.nodes import server
from contact_dynamics.nodes.parameter_file import (
    ParameterFile,
    Section,
    check_sections,
    read_sections,
    values_given,
)
from contact_dynamics.nodes.parameter_reader import ConfigurationError, ParameterSource
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.state_sources import state_sources
from contact_dynamics.rigid_body.body import BodyState
from message_words import says
from msg_adapters.transforms import TransformTree

ROOT = Path(__file__).parents[2]
FALL = 0.5 * 9.80665 * 0.3**2  # m, in 0.3 s


def test_the_commented_configuration_is_read_as_it_says() -> None:
    parameters = read_server_parameters(ParameterFile(ROOT / "config" / "server.yaml"))
    (brick,), (floor,) = parameters.world.bodies, parameters.world.surfaces
    assert (brick.name, brick.mass_properties.mass, len(brick.vertices_B)) == ("brick", 0.4, 8)
    assert (floor.name, floor.friction, floor.restitution) == ("floor", 0.3, 0.45)
    assert (floor.lasting_factor, floor.static_friction) == (1.0, None)
    (states,) = parameters.sources
    assert [topic.name for source in states.sources for topic in source.topics] == ["/brick/odometry"]
    assert parameters.defaults.velocity_tolerance == 1e-9


@pytest.mark.parametrize("shape", ["", "    surface.floor.box: [1.0, 1.0, 0.1]\n"])
def test_a_surface_may_have_static_friction(tmp_path: Path, shape: str) -> None:
    file = tmp_path / "server.yaml"
    text = (ROOT / "config" / "server.yaml").read_text(encoding="utf-8")
    text = text.replace("surface.floor.static_friction: 0.0", "surface.floor.static_friction: 0.4")
    file.write_text(text.replace("    surface.floor.box: [0.0]\n", shape), encoding="utf-8")
    (floor,) = read_server_parameters(ParameterFile(file)).world.surfaces
    assert (floor.friction, floor.static_friction) == (0.3, 0.4)


def test_nested_names_are_joined_and_the_nodes_own_values_count_more(tmp_path: Path) -> None:
    file = tmp_path / "server.yaml"
    file.write_text(
        "/**:\n  ros__parameters:\n    bodies: [cup]\n"
        "    body: {cup: {mass: 0.2, inertia: [0.0], sphere: [0.05]}}\n"
        "    horizon: 1.0\ncontact_dynamics:\n  ros__parameters:\n    horizon: 3.0\n",
        encoding="utf-8",
    )
    parameters = read_server_parameters(ParameterFile(file))
    assert parameters.world.body("cup").mass_properties.mass == 0.2
    assert parameters.defaults.horizon == 3.0


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("/**:\n  ros__parameters:\n    horizon: soon\n", "horizon must be ..., got 'soon'"),
        ("/**:\n  ros__parameters:\n    horizon: -1.0\n", "horizon must be in [0, 10000]..., got -1.0"),
        ("/**:\n  ros__parameters:\n    horizon: true\n", "horizon must be ..., got True"),
        ("/**:\n  ros__parameters:\n    bodies: [cup]\n", "body.cup.mass is required ("),
        ("/**: 3\n", "** must have ros__parameters"),
        ("a: b\n", "a must have ros__parameters"),
        ("[]\n", "must have parameters of /**"),
        ("contact_dynamcis:\n  ros__parameters:\n    horizon: 1.0\n", "got only those of /contact_dynamcis"),
        (
            "a/contact_dynamics:\n  ros__parameters:\n    horizon: 1.0\n",
            "must have parameters of /** or /contact_dynamics",
        ),
        (
            "/**:\n  ros__parameters:\n    horizn: 1.0\n",
            "horizn: there is no such parameter; the nearest is horizon",
        ),
        (
            "/**: {ros__parameters: {rate: 1.0}}\ncontact_dynamcis: {ros__parameters: {horizon: 1.0}}\n",
            "the parameters of /contact_dynamcis do not apply to this node, whose name is /contact_dynamics",
        ),
        ("a: [b\n", "no YAML"),
        (
            "/**:\n  ros__parameters:\n    horizon: 1.0\n    rate: 5.0\n    horizon: 2.0\n",
            "server.yaml: horizon must appear once, got lines 3 and 5",
        ),
        (
            "/**:\n  ros__parameters:\n    body.cup.mass: 1.0\n    body: {cup: {mass: 2.0}}\n",
            "body.cup.mass must appear once, got lines 3 and 4",
        ),
        (
            "/**:\n  ros__parameters:\n    body: {cup: {mass: 2.0}}\n    body: {cup: {sphere: [1.0]}}\n",
            "body must appear once, got lines 3 and 4",
        ),
        (
            "/**: {ros__parameters: {a: 1}}\nx: {ros__parameters: {a: 1}}\nx: {ros__parameters: {b: 1}}\n",
            "x must appear once, got lines 2 and 3",
        ),
        (
            '{"/**": {"ros__parameters": {"rate": 1.0,\n"rate": 2.0}}}',
            "rate must appear once, got lines 1 and 2",
        ),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, named: str) -> None:
    file = tmp_path / "server.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError) as caught:
        read_server_parameters(ParameterFile(file))
    assert says(str(caught.value), named)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"nowhere\.yaml: cannot be read"):
        ParameterFile(tmp_path / "nowhere.yaml")


SECTIONS = """
/**: {ros__parameters: {gravity: [0.0, 0.0, -1.0]}}
/*: {ros__parameters: {horizon: 3.0}}
/*/contact_dynamics: {ros__parameters: {rate: 7.0}}
contact_dynamics: {ros__parameters: {state_timeout: 2.0}}
left:
  contact_dynamics: {ros__parameters: {state_history: 9.0}}
"""


@pytest.mark.parametrize("namespace", ["", "/left", "/left/arm"])
def test_a_node_gets_the_sections_that_ros_gives_it(tmp_path: Path, namespace: str) -> None:
    file = tmp_path / "server.yaml"
    file.write_text(SECTIONS, encoding="utf-8")
    context = Context()
    rclpy.init(args=["--ros-args", "--params-file", str(file)], context=context)
    node = Node("contact_dynamics", namespace=namespace, context=context)
    given_by_ros = set(node._parameter_overrides)
    node.destroy_node()
    rclpy.shutdown(context=context)
    sections = read_sections(file)
    given = {
        name for each in sections if each.is_for(f"{namespace}/contact_dynamics") for name in each.values
    }
    assert given == given_by_ros
    assert check_sections(file, sections, f"{namespace}/contact_dynamics") == ""


@pytest.mark.parametrize(
    ("other", "is_told"),
    [
        ("contact_dynamcis", True),
        ("contact_dynamics_", False),
        ("contact_dynamics_2", False),
        ("contact_dynamics_left", False),
        ("contact_dynamic", True),
        ("right/contact_dynamics", False),
        ("contact_dynamics_visualizer", False),
        ("controller_manager", False),
    ],
)
def test_only_a_name_that_is_nearly_the_nodes_is_told(other: str, *, is_told: bool) -> None:
    sections = [Section("/**", {}), Section(f"/{other}", {})]
    told = check_sections(Path("stack.yaml"), sections, "/contact_dynamics")
    assert (f"/{other}" in told) == is_told


def test_what_others_have_twice_is_theirs(tmp_path: Path) -> None:
    """A file of a whole stack: the names of sections differ, and the same parameter may be in several."""
    file = tmp_path / "stack.yaml"
    file.write_text(
        "/**: {ros__parameters: {horizon: 1.0}}\ncontact_dynamics: {ros__parameters: {horizon: 3.0}}\n"
        "controller: {ros__parameters: {gain: 1.0, gain: 2.0}}\n",
        encoding="utf-8",
    )
    assert read_server_parameters(ParameterFile(file)).defaults.horizon == 3.0


def test_a_server_refuses_a_file_with_a_parameter_twice(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """ROS reads the file by itself, and would take the last."""
    file = tmp_path / "server.yaml"
    file.write_text("/**:\n  ros__parameters:\n    log: false\n    log: true\n", encoding="utf-8")
    assert server.main(["--params-file", str(file), "--ros-args", "-p", f"log_directory:={tmp_path}"]) == 2
    assert says(capfd.readouterr().err, f"{file}: log must appear once, got lines 3 and 4")
    assert not list(tmp_path.glob("contact_dynamics_*"))


def test_two_bodies_of_one_frame_on_one_topic_are_refused() -> None:
    """Both would have the states of whichever the messages mean."""
    known = {"mass": 1.0, "inertia": [1.0, 1.0, 1.0, 0.0, 0.0, 0.0], "frame": "cup", "source": "tf"}
    values = {f"body.{body}.{name}": value for body in ("a", "b") for name, value in known.items()}
    topics = {f"body.{body}.source_topics": ["/tf"] for body in ("a", "b")}
    parameters = read_server_parameters(ParameterSource({"bodies": ["a", "b"], **values, **topics}))
    with pytest.raises(
        ConfigurationError, match=r"body\.b\.frame must be another frame than that of body\.a.*, got 'cup'"
    ):
        state_sources(parameters, static=TransformTree())


def test_a_belt_and_a_turntable_move_as_configured() -> None:
    values = {
        f"surface.{name}.{key}": 0.5 for name in ("belt", "disc") for key in ("friction", "restitution")
    }
    values |= {"surface.belt.velocity": [1.2, 0.0, 0.0]}
    values |= {"surface.disc.normal": [1.0, 0.0, 0.0], "surface.disc.angular_velocity": 2.0}
    belt, disc = read_server_parameters(
        ParameterSource({"bodies": [""], "surfaces": ["belt", "disc"], **values})
    ).world.surfaces
    assert [belt.v_WS_W.tolist(), belt.w_WS_W.tolist()] == [[1.2, 0.0, 0.0], [0.0] * 3]
    assert [disc.v_WS_W.tolist(), disc.w_WS_W.tolist()] == [[0.0] * 3, [2.0, 0.0, 0.0]]


SHAPES = {
    "bodies": ["ball", "can", "brick"],
    **{f"body.{name}.mass": 1.0 for name in ("ball", "can", "brick")},
    **{f"body.{name}.inertia": [0.0] for name in ("ball", "can", "brick")},
    "body.ball.sphere": [0.25],
    "body.can.cylinder": [0.1, 0.3],
    "body.brick.box": [0.4, 0.2, 0.1],
    "surfaces": ["floor", "table"],
    "surface.floor.point": [0.0, 0.0, -1.0],
    "surface.table.point": [5.0, 0.0, 0.0],
    "surface.table.vertices": [-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0],
    **{f"surface.{name}.friction": 0.5 for name in ("floor", "table")},
    **{f"surface.{name}.restitution": 0.0 for name in ("floor", "table")},
}
ACROSS = [math.sqrt(0.5), 0, 0, math.sqrt(0.5)]


@pytest.mark.parametrize(
    ("name", "state", "lands_on"),
    [
        ("ball", {"p_WB_W": [0, 0, -0.75 + FALL]}, ("floor",)),
        ("can", {"p_WB_W": [0, 0, -0.9 + FALL], "q_WB": ACROSS}, ("floor",) * 2),
        ("brick", {"p_WB_W": [6.0, 0, 0.05 + FALL]}, ("table",) * 4),  # half over its edge
        ("brick", {"p_WB_W": [6.3, 0, -0.95 + FALL]}, ("floor",) * 4),  # past it
    ],
)
def test_configured_shapes_land_on_configured_surfaces(
    name: str, state: dict[str, Any], lands_on: tuple[str, ...]
) -> None:
    known = questions.Context(world=read_server_parameters(ParameterSource(SHAPES)).world)
    nothing = {"q_WB": [0, 0, 0, 1], "v_WB_W": [0, 0, 0], "w_WB_W": [0, 0, 0]}
    landing = questions.ask(
        questions.ImpactQuestion(body=name, state=BodyState(**{**nothing, **state})), known
    )
    # A contact begins up to 1e-9 m from a surface, the distance_tolerance, and they meet with 2.9 m/s.
    assert landing.seconds_to_contact == pytest.approx(0.3, abs=1e-9)
    assert landing.contacts.surfaces == lands_on


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True),
        ("no", False),
        ("-3", -3),
        ("3.", 3.0),
        ("1e3", 1000.0),
        ("1.5E-3", 0.0015),
        ("/brick/odometry", "/brick/odometry"),
        ("'3'", "3"),
        ("3 m", "3 m"),
        ("", ""),
        ("2026-11-27", "2026-11-27"),
        ("[1.0, 2]", [1.0, 2]),
        ("[a, b]", ["a", "b"]),
        ("[ ]", "[ ]"),
        ("{a: 1}", "{a: 1}"),
    ],
)
def test_a_text_is_read_as_yaml_has_it(text: str, value: Any) -> None:
    (found,) = values_given(["--ros-args", "-p", f"a:={text}"], "/server").values()
    assert (type(found), found) == (type(value), value)


def test_the_last_value_for_the_node_counts() -> None:
    arguments = ["--ros-args", "-p", "a:=1", "--param", "a:=2", "-p", "other:a:=3", "-p", "server:b:=4"]
    assert values_given(arguments, "/server") == {"a": 2, "b": 4}
