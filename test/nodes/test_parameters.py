# SPDX-License-Identifier: Apache-2.0
"""The commented configuration files beside what the nodes declare, and what a wrong value gets."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from copy import copy
from pathlib import Path
from typing import Any, TypeAlias

import pytest
import rclpy
import yaml
from rclpy.node import Node
from rclpy.parameter import Parameter

from contact_dynamics.monitoring.live import LiveMonitor
from contact_dynamics.nodes import server, visualizer
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.state_sources import ADAPTERS
from contact_dynamics.recording.limits import UNLIMITED
from message_words import says
from nodes.monitor import parameters_file
from running_server import DOMAIN_ID, PATIENCE_S, ROOT, environment, process, wait_for

CONFIG = ROOT / "config"
SERVER_FILE = CONFIG / "server.yaml"
VISUALIZER_FILE = CONFIG / "visualizer.yaml"
MONITOR_FILE = CONFIG / "monitor.yaml"
Verb: TypeAlias = Callable[[list[str]], int]
VERBS = [pytest.param(server.main, id="server"), pytest.param(visualizer.main, id="visualizer")]
OF_ROS = re.compile(r"use_sim_time|start_type_description_service|qos_overrides\..*")
WORDS: dict[str, Any] = {
    "9.80665 along -z": [0.0, 0.0, -9.80665],
    "[0.0]": [0.0],
    "at its origin": [0.0, 0.0, 0.0],
    "at rest": [0.0, 0.0, 0.0],
    "empty": "",
    "false": False,
    "none": [""],
    "no rotation": [0.0, 0.0, 0.0, 1.0],
    "the body's name": "brick",
    "the origin": [0.0, 0.0, 0.0],
    "true": True,
    "up": [0.0, 0.0, 1.0],
}
"""What the comments call a default that is not written as the number or name that it is."""


@pytest.fixture(autouse=True)
def own_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN_ID))
    yield
    rclpy.try_shutdown()  # what a failing test leaves must not fail the next


class Declarations(dict[str, tuple[Any, Any]]):
    """Default and descriptor of each parameter that a node declares while it starts."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__()
        declare = Node.declare_parameter

        def note(node: Node, name: str, value: Any = None, descriptor: Any = None, **options: Any) -> Any:
            self[name] = (value, descriptor)
            return declare(node, name, value, descriptor, **options)

        monkeypatch.setattr(Node, "declare_parameter", note)

    def ours(self) -> dict[str, tuple[Any, Any]]:
        """Those that are not rclpy's own."""
        return {name: declared for name, declared in self.items() if not OF_ROS.fullmatch(name)}


@pytest.fixture
def declared(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[dict[str, dict[str, Any]]]:
    """What the server declares, and what the others declare besides, with the files as they are."""
    paths = SERVER_FILE, VISUALIZER_FILE, MONITOR_FILE
    files = ["--ros-args", *(word for path in paths for word in ("--params-file", str(path)))]
    # the command line wins over the files, else the visualizer would refuse to draw to nowhere
    rclpy.init(args=[*files, "-p", "log:=false", "-p", f"rrd_path:={tmp_path / 'picture.rrd'}"])
    declarations = Declarations(monkeypatch)
    try:
        server.Server().destroy_node()
        of_server = declarations.ours()
        drawing = visualizer.Visualizer()
        drawing.close()
        drawing.destroy_node()
        of_visualizer = {name: d for name, d in declarations.ours().items() if name not in of_server}
        monitor = LiveMonitor()
        monitor.destroy_node()
        others = of_server.keys() | of_visualizer.keys()
        of_monitor = {name: d for name, d in declarations.ours().items() if name not in others}
        yield {"server": of_server, "visualizer": of_visualizer, "monitor": of_monitor}
    finally:
        rclpy.shutdown()


def values_of(path: Path) -> dict[str, Any]:
    """The parameters that a file sets."""
    (node,) = yaml.safe_load(path.read_text(encoding="utf-8")).values()
    parameters: dict[str, Any] = node["ros__parameters"]
    return parameters


def comments_of(path: Path) -> dict[str, str]:
    """The comment before each parameter: that of its block, and of the next block that begins with '...'."""
    comments: dict[str, str] = {}
    open_block: list[str] = []
    for block in path.read_text(encoding="utf-8").split("\n\n"):
        lines = [line.strip() for line in block.splitlines() if line.strip()]
        text = " ".join(line.lstrip("# ") for line in lines if line.startswith("#"))
        names = [line.partition(":")[0] for line in lines if not line.startswith("#")]
        if names and not lines[0].startswith("#"):
            text = ""
        if not text.startswith("..."):
            open_block = []
        open_block += names
        for name in open_block:
            comments[name] = f"{comments.get(name, '')} {text}".strip()
    return comments


@pytest.mark.parametrize("path", [SERVER_FILE, VISUALIZER_FILE, MONITOR_FILE], ids=lambda path: path.stem)
def test_every_parameter_declared_stands_in_the_file_and_none_else(
    declared: dict[str, dict[str, Any]], path: Path
) -> None:
    assert set(values_of(path)) == set(declared[path.stem])


@pytest.mark.parametrize("path", [SERVER_FILE, VISUALIZER_FILE, MONITOR_FILE], ids=lambda path: path.stem)
def test_every_parameter_has_a_comment_that_says_its_default(
    declared: dict[str, dict[str, Any]], path: Path
) -> None:
    comments = comments_of(path)
    for name, (default, descriptor) in declared[path.stem].items():
        comment = comments[name]
        assert comment, f"{name}: no comment"
        if isinstance(default, Parameter.Type):
            assert "No default" in comment, f"{name}: {comment}"
            continue
        _, found, text = comment.partition("Default: ")
        assert found, f"{name}: no default in {comment!r}"
        word = next((word for word in WORDS if text.startswith(word)), "")
        said = WORDS[word] if word else type(default)(re.split(r"[,;.]?(?: |$)", text)[0])
        assert said == default, f"{name}: the file says {text!r}, declared is {default!r}"
        assert descriptor.read_only == (path.stem == "visualizer")


def test_every_source_of_states_stands_in_the_file() -> None:
    """Topics of the first ones have parameters of their own."""
    told = comments_of(SERVER_FILE)["body.brick.source"].split()
    own = {"odometry", "pose", "pose_twist"}
    assert [name for name in ADAPTERS if name not in own and name not in told] == []


def test_every_topic_that_is_configured_is_subscribed() -> None:
    topics = {
        name: f"/{name.replace('.', '/')}"
        for name in values_of(SERVER_FILE)
        if name.endswith("_topic") and name != "tf_static_topic"  # tf2_msgs has no wheel
    }
    assert len(topics) >= 3
    arguments = [word for name, topic in topics.items() for word in ("-p", f"{name}:={topic}")]
    rclpy.init(args=["--ros-args", "--params-file", str(SERVER_FILE), "-p", "log:=false", *arguments])
    try:
        node = server.Server()
        assert set(topics.values()) <= {each.topic_name for each in node.inbox}
        node.destroy_node()
    finally:
        rclpy.shutdown()


def test_every_parameter_is_described(declared: dict[str, dict[str, Any]]) -> None:
    """`ros2 param describe` shows the description; that of a number says its unit."""
    of_all = {name: one for of_node in declared.values() for name, one in of_node.items()}
    for name, (default, descriptor) in of_all.items():
        assert re.fullmatch(r"[A-Z].{8,}", descriptor.description), name
        if isinstance(default, float) or default is Parameter.Type.DOUBLE:
            assert re.search(r"\b(m|s|kg|Hz|m/s|MB|[Cc]oefficient)\b", descriptor.description), name


Change = Callable[[dict[str, Any]], object]


def put(**changes: Any) -> Change:
    """Return what sets parameters, whose dots are written as two underscores."""
    return lambda values: values.update({name.replace("__", "."): value for name, value in changes.items()})


def brick(**changes: Any) -> Change:
    return put(**{f"body.brick.{name}": value for name, value in changes.items()})


def floor(**changes: Any) -> Change:
    return put(**{f"surface.floor.{name}": value for name, value in changes.items()})


def misspell(name: str, wrong: str) -> Change:
    return lambda values: values.update({wrong: values.pop(name)})


def drop(name: str) -> Change:
    return lambda values: values.pop(name)


def two_bodies_on_one_topic(values: dict[str, Any]) -> None:
    values["bodies"] = ["brick", "plate"]
    for name in ("mass", "inertia", "odometry_topic"):
        values[f"body.plate.{name}"] = copy(values[f"body.brick.{name}"])  # YAML would write an alias


def two_balls(values: dict[str, Any]) -> None:
    """Describe a ball by names that are not ours."""
    values["bodies"] = ["brick", "ball"]
    values |= {"body.ball.mass": 0.1, "body.ball.radius": 0.03, "qos_overrides./x.subscription.depth": 5}


def two_bodies_by_one_source(values: dict[str, Any]) -> None:
    two_bodies_on_one_topic(values)
    for name in ("brick", "plate"):
        values[f"body.{name}.odometry_topic"] = ""
        values |= {f"body.{name}.source": "pose", f"body.{name}.source_topics": ["/poses"]}


NAN, INF = float("nan"), float("inf")
BRICK = [3.5e-4, 8.4e-4, 1.0e-3]
WRONG = [
    (drop("body.brick.mass"), "body.brick.mass is required (Mass, kg.)"),
    (misspell("body.brick.mass", "body.brick.maas"), "body.brick.maas: there ... nearest is body.brick.mass"),
    (two_balls, "body.ball.radius: there is no such parameter; the nearest is body.ball.sphere"),
    (brick(sphere=0.03), "body.brick.sphere must be a list..., got 0.03"),
    (brick(mass="heavy"), "body.brick.mass"),
    (brick(box=["a"]), "body.brick.box must be a list of which each is a number..., got ['a']"),
    (brick(mass=NAN), "body.brick.mass must be ..., got nan"),
    (brick(mass=0.0), "body.brick.mass must be > 0..., got 0.0"),
    (brick(inertia=[*BRICK, 0.0, 0.0]), "body.brick.inertia must be 6..., got 5 numbers"),
    (brick(inertia=[1.0, 1.0, 3.0, 0.0, 0.0, 0.0]), "body.brick.inertia must be "),
    (brick(inertia=[*BRICK, NAN, 0.0, 0.0]), "body.brick.inertia must be "),
    (brick(inertia=0.001), "body.brick.inertia"),
    (brick(center_of_mass=[0.0, 0.1]), "body.brick.center_of_mass must be "),
    (brick(center_of_mass=[0.0, NAN, 0.0]), "body.brick.center_of_mass must be "),
    (brick(box=[0.1, 0.2]), "body.brick.box must be ..., got 2 numbers"),
    (brick(box=[0.1, INF, 0.1]), "body.brick.box[1] must be ..., got inf"),
    (brick(box=[0.1, -0.1, 0.1]), "body.brick.box[1] must be > 0..., got -0.1"),
    (brick(box=[0.0], vertices=[0.1] * 4), "body.brick.vertices must be ..., got 4 numbers"),
    (brick(sphere=[0.1]), "body.brick.sphere must be one..., got a second shape beside box"),
    (brick(box=[0.0], sphere=[-0.1]), "body.brick.sphere[0] must be ..., got -0.1"),
    (brick(box=[0.0], capsule=[0.1]), "body.brick.capsule must be ..., got 1 numbers"),
    (brick(box=[0.0], cylinder=[0.1, -1.0]), "body.brick.cylinder[1] must be ..., got -1.0"),
    (brick(box=[0.0], cone=[0.1, 0.0]), "body.brick.cone[1] must be ..., got 0.0"),
    (brick(rounding=-0.1), "body.brick.rounding"),
    (brick(shape_orientation=[0.0] * 4), "body.brick.shape_orientation must be "),
    (
        brick(inertia=[0.0], box=[0.0]),
        "body.brick.inertia must be six numbers, or the body have a shape (box, sphere, ...), got neither",
    ),
    (
        brick(inertia=[0.0], center_of_mass=[0.0, 0.0, 0.1]),
        "body.brick.center_of_mass must be the origin..., got [0.0, 0.0, 0.1]",
    ),
    (brick(twist_topic="/brick/twist"), "body.brick.twist_topic must be ..., got '/brick/twist'"),
    (brick(source="pose"), "body.brick.source and body.brick.source_topics must be ..., got 'pose' and []"),
    (put(bodies=["brick", "brick"]), "bodies must be different names..., got ['brick', 'brick']"),
    (put(bodies=["brick", ""]), "bodies[1] must be a name of 1 to 256 letters..., got ''"),
    (put(bodies=["brick", "x" * 257]), "bodies[1] must be ..., got 'xxx"),
    (put(surfaces=["floor", " "]), "surfaces[1] must be a name of 1 to 256 letters..., got ' '"),
    (put(world_frame=""), "world_frame must be a name of 1 to 256 letters..., got ''"),
    (brick(frame="brick "), "body.brick.frame must be a name..., got 'brick '"),
    (brick(mass=1e-40), "body.brick.mass must be in [1e-30, 1e+30]..., got 1e-40"),
    (brick(inertia=[1e40] * 3 + [0.0] * 3), "body.brick.inertia must be ..., got 1e+40"),
    (brick(center_of_mass=[1e20, 0.0, 0.0]), "body.brick.center_of_mass must be ..., got 1e+20 m"),
    (brick(shape_position=[1e20, 0.0, 0.0]), "body.brick.shape_position must be ..., got 1e+20 m"),
    (brick(box=[0.1, 1e-20, 0.1]), "body.brick.box[1] must be a length from..., got 1e-20 m"),
    (brick(box=[0.1, 0.1, 1e20]), "body.brick.box[2] must be a length from..., got 1e+20 m"),
    (floor(point=[1e20, 0.0, 0.0]), "surface.floor.point must be at most..., got 1e+20 m"),
    (floor(friction=1e20), "surface.floor.friction must be at most 1e+10..., got 1e+20"),
    (put(gravity=[0.0, 0.0, 1e20]), "gravity must be at most 1e+15..., got 1e+20"),
    (two_bodies_on_one_topic, "body.plate.odometry_topic must be ..., got '/brick/odometry'"),
    (drop("surface.floor.friction"), "surface.floor.friction is required ("),
    (floor(friction=-0.1), "surface.floor.friction must be >= 0..., got -0.1"),
    (floor(restitution=1.5), "surface.floor.restitution must be ..., got 1.5"),
    (floor(velocity=[1.0, 0.0]), "surface.floor.velocity must be ..., got shape (2,)"),
    (floor(velocity=[0.0, 0.0, 1.0]), "surface.floor.velocity must be along the plane..., got"),
    (floor(velocity=[1e20, 0.0, 0.0]), "surface.floor.velocity must be at most..., got 1e+20"),
    (
        floor(velocity=[1.0, 0.0, 0.0], angular_velocity=2.0),
        "surface.floor.velocity must be zero for a turntable",
    ),
    (
        floor(box=[1.0] * 3, angular_velocity=2.0),
        "surface.floor.angular_velocity must be zero for an obstacle",
    ),
    (
        brick(box=[0.0], rounding=0.01),
        "body.brick.rounding must be left out unless there is a shape, got 0.01",
    ),
    (
        brick(box=[0.0], shape_position=[0.0, 0.0, 0.1]),
        "body.brick.shape_position must be left out unless there is a shape",
    ),
    (
        floor(orientation=[0.0, 1.0, 0.0, 0.0]),
        "surface.floor.orientation must be left out unless there is a box or vertices",
    ),
    (
        floor(acceleration_window=0.2),
        "surface.floor.acceleration_window must be left out unless a body carries the plane, got 0.2",
    ),
    (
        floor(box=[1.0] * 3, normal=[1.0, 0.0, 0.0]),
        "surface.floor.normal must be left out for an obstacle",
    ),
    (
        floor(box=[1.0] * 3, lasting_speed=0.5),
        "surface.floor.lasting_speed must be left out for an obstacle, got 0.5",
    ),
    (floor(lasting_factor=-1.0), "surface.floor.lasting_factor must be ..., got -1.0"),
    (floor(lasting_factor=1e20), "surface.floor.lasting_factor must be at..., got 1e+20"),
    (floor(static_friction=-0.1), "surface.floor.static_friction must be at least friction..., got -0.1"),
    (floor(static_friction=1e20), "surface.floor.static_friction must be at most..., got 1e+20"),
    (floor(lasting_speed=-0.1), "surface.floor.lasting_speed must be >= 0..., got -0.1"),
    (floor(normal=[0.0, 0.0, 2.0]), "surface.floor.normal must be ..., got [0.0, 0.0, 2.0] of norm 2"),
    (floor(point=[0.0, 0.0]), "surface.floor.point must be ..., got shape (2,)"),
    (floor(box=[1.0, 1.0]), "surface.floor.box must be ..., got 2 numbers"),
    (floor(vertices=[0.0] * 9), "surface.floor.vertices must be ..., got 1 different corner"),
    (floor(box=[1.0] * 3, orientation=[0.0, 0.0, 0.0, 2.0]), "surface.floor.orientation must be "),
    (put(surfaces=["floor", "floor"]), "surfaces must be different names..., got ['floor', 'floor']"),
    (put(gravity=[0.0, 0.0, NAN]), "gravity must be "),
    (put(gravity=[0.0, -9.81]), "gravity must be ..., got shape (2,)"),
    (put(state_timeout=-1.0), "state_timeout"),
    (put(state_timeout=NAN), "state_timeout must be in [0.001, 1e+06]..., got nan"),
    (put(velocity_tolerance=NAN), "velocity_tolerance must be in [0, 1000]..., got nan"),
    (put(max_states=0), "max_states must be in [1, 1e+07]..., got 0"),
    (put(horizon=INF), "horizon"),
    (put(rate=0.0), "rate"),
    (put(log="perhaps"), "log"),
    (put(log_file_size=1e-7), "log_file_size must be 0 or in [0.065536, 1e+08] MB..., got 1e-07 MB"),
    (put(log_file_duration=0.5), "log_file_duration must be 0 or in [1, 1e+08] s..., got 0.5 s"),
    (put(log_size_limit=1500.0), "log_size_limit must be 0 or in [2000, 1e+08] MB..., got 1500 MB"),
    (put(log_size_limit=1.0, log_file_size=0.0), "log_size_limit must be 0 where log_file_size..., got 1 MB"),
    (put(log=False, log_before_answer=True), "log_before_answer must be false where log is..., got true"),
]


WRONG_FOR_ROS = [
    (
        misspell("body.brick.mass", "body.brick.maas"),
        "body.brick.maas: there is no such parameter; the nearest is body.brick.mass",
    ),
    (put(state_timeout=NAN), "state_timeout must be in [0.001, 1e+06] (Largest age..., got nan"),
    (brick(sphere=0.03), "body.brick.sphere must be a list..., got 0.03"),
    (
        brick(source="pose", source_topics=["/a", "/b"]),
        "body.brick.source_topics must be 1, of geometry_msgs/msg/PoseStamped..., got ['/a', '/b']",
    ),
    (
        brick(source="pose", source_topics=["/brick/odometry"]),
        "body.brick.source_topics[0] must be ..., got '/brick/odometry' for geometry_msgs/msg/PoseStamped",
    ),
    (
        brick(source="tf", source_topics=["/tf"]),
        "must be an interface whose package is installed..., got tf2_msgs/msg/TFMessage",
    ),
    (brick(odometry_topic="/brick odometry"), "body.brick.odometry_topic must be ..., got '/brick odometry'"),
    (
        brick(source="odometry", source_topics=["/brick/odometry"]),
        "body.brick.source_topics[0] must be another topic than that of the..., got '/brick/odometry'",
    ),
    (two_bodies_by_one_source, "body.plate.source_topics[0] must be another topic than..., got '/poses'"),
    (put(log_directory=str(Path(__file__))), "log_directory must be a folder"),
]
"""Two of those above, and what is known once there are topics, types of ROS and a log."""


def test_the_log_may_go_below_the_home_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    log = Log("~/logs", run={}, limits=UNLIMITED, on_problem=pytest.fail, on_notice=pytest.fail)
    assert log.folder is not None
    assert log.folder.parent == tmp_path / "logs"
    log.start()
    log.close()


def test_a_concave_body_is_told_in_the_log(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """An L-bracket. The server ends by itself, since it cannot write a log."""
    outline = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.2, 0.2), (0.2, 1.0), (0.0, 1.0)]
    values = {
        "bodies": ["bracket"],
        "body.bracket.mass": 1.0,
        "body.bracket.inertia": [0.0],
        "body.bracket.vertices": [number for z in (0.0, 0.3) for x, y in outline for number in (x, y, z)],
        "log_directory": str(parameters_file(tmp_path, {})),  # a file
    }
    file = parameters_file(tmp_path, values)
    assert server.main(["--params-file", str(file)]) != 0
    assert "body.bracket.vertices: 2 of 12 corners are in faces of their hull" in capfd.readouterr().err


@pytest.mark.parametrize(("change", "words"), WRONG, ids=[words.partition(":")[0] for _, words in WRONG])
def test_a_wrong_value_is_named(tmp_path: Path, change: Change, words: str) -> None:
    values = values_of(SERVER_FILE)
    change(values)
    with pytest.raises(ConfigurationError) as caught:
        read_server_parameters(ParameterFile(parameters_file(tmp_path, values)))
    assert says(str(caught.value), words)


@pytest.mark.parametrize(("change", "words"), WRONG_FOR_ROS)
def test_a_wrong_value_ends_the_server_and_is_named(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], change: Change, words: str
) -> None:
    values = {**values_of(SERVER_FILE), "log_directory": str(tmp_path)}
    change(values)
    assert server.main(["--params-file", str(parameters_file(tmp_path, values))]) == 2
    printed = capfd.readouterr().err
    assert says(printed, words)
    assert "Traceback" not in printed
    assert not list(tmp_path.glob("contact_dynamics_*")), "a log that holds nothing"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "one of rrd_path, spawn, serve and connect is required"),
        (["-p", "serve:=maybe"], "serve"),
        (["-p", "rrd_path:=a.rrd", "-p", "body.brick.mass:=-1.0"], "body.brick.mass must be ..., got -1.0"),
    ],
)
def test_a_wrong_value_ends_the_visualizer_and_is_named(
    capfd: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    given = ["--params-file", str(SERVER_FILE), "--ros-args", *arguments]
    assert visualizer.main(given) == 2
    assert says(capfd.readouterr().err, words)


def test_a_file_that_cannot_be_read_is_named(capfd: pytest.CaptureFixture[str]) -> None:
    assert server.main(["--params-file", str(ROOT / "README.md")]) == 2
    assert str(ROOT / "README.md") in capfd.readouterr().err
    with pytest.raises(SystemExit):
        server.main(["--params-file", str(ROOT / "missing.yaml")])
    assert f"{ROOT / 'missing.yaml'}: no such file" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mesh", "mesh: there is no such parameter; the nearest is"),
        ("velocity_tolerence", "the nearest is velocity_tolerance"),
        ("body.brick.odometry_topc", "the nearest is body.brick.odometry_topic"),
        ("body.brick.mesh", "body.brick.mesh: there is no such parameter"),
        ("surface.floor.fricton", "the nearest is surface.floor.friction"),
        ("body.cube.mass", "must be about one of the names in bodies ['brick'], got body 'cube'"),
        (
            "surface.table.friction",
            "must be about one of the names in surfaces ['floor'], got surface 'table'",
        ),
    ],
)
@pytest.mark.parametrize("verb", VERBS)
def test_a_node_refuses_an_unknown_parameter_of_its_file(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], verb: Verb, name: str, words: str
) -> None:
    path = parameters_file(tmp_path, {**values_of(SERVER_FILE), "log": False, name: 0.1})
    more = [] if verb is server.main else ["--ros-args", "-p", f"rrd_path:={tmp_path / 'picture.rrd'}"]
    assert verb(["--params-file", str(path), *more]) == 2
    printed = capfd.readouterr().err
    assert says(printed, words)
    assert name in printed
    assert not (tmp_path / "picture.rrd").exists()


@pytest.mark.parametrize("verb", VERBS)
def test_a_node_refuses_a_file_whose_node_is_misspelled(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], verb: Verb
) -> None:
    path = tmp_path / "stack.yaml"
    sections = {name: {"ros__parameters": {"horizon": 1.0}} for name in ("controller", "contact_dynamcis")}
    path.write_text(yaml.safe_dump(sections), encoding="utf-8")
    assert verb(["--params-file", str(path)]) == 2
    printed = capfd.readouterr().err
    assert says(
        printed, f"{path} must have parameters of ..., got only those of /contact_dynamcis and of /controller"
    )
    assert "/contact_dynamcis is the nearest name" in printed


def test_a_section_that_misses_the_server_by_a_letter_is_warned_of(tmp_path: Path) -> None:
    path = tmp_path / "stack.yaml"
    sections = {name: {"ros__parameters": {"log": False}} for name in ("/**", "contact_dynamcis")}
    path.write_text(yaml.safe_dump(sections), encoding="utf-8")
    arguments = ("--params-file", str(path), "--ros-args", "-p", "contact_dynamic:horizon:=1.0")
    with process("server", *arguments) as started:
        printed = wait_for(started, "ready")
    assert "the parameters of /contact_dynamcis do not apply to this node" in printed
    assert "-p: the parameters of /contact_dynamic do not apply to this node" in printed


def test_the_server_takes_a_file_that_configures_the_visualizer_too(tmp_path: Path) -> None:
    values = {**values_of(SERVER_FILE), **values_of(VISUALIZER_FILE), "log": False, "use_sim_time": True}
    with process("server", "--params-file", str(parameters_file(tmp_path, values)), ready="ready"):
        pass


def test_ros_logs_elsewhere_where_home_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / "home"
    home.touch()  # not even root can make a folder in a file
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.delenv("ROS_LOG_DIR", raising=False)
    monkeypatch.delenv("ROS_HOME", raising=False)
    with process("server", "--ros-args", "-p", "log:=false") as started:
        printed = wait_for(started, "ready")
    assert f"because {home}/.ros/log cannot be written" in printed
    (folder,) = re.findall(r"ROS's log files go to (\S+),", printed)
    assert list(Path(folder).iterdir())


QOS = "qos_overrides./brick/odometry.subscription"


@pytest.mark.filterwarnings("ignore:A zero depth")  # of rclpy, which takes it all the same
@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("log:=0", "log must be true or false..., got 0"),
        ("workers:=0.5", "workers must be a whole number..., got 0.5"),
        ("horizon:=soon", "horizon must be a number..., got 'soon'"),
        ("bodies:=[]", "bodies must be a list..., got '[]'"),
        ("use_sim_time:=7", "'use_sim_time' to '7' of type 'INTEGER', expecting type 'BOOL'"),
        (f"{QOS}.reliability:=perhaps", f"{QOS}: "),
        (f"{QOS}.depth:=0", "depth must be a whole number > 0..., got 0"),
        (f"{QOS}.reliabilty:=best_effort", f"there is no such parameter; the nearest is {QOS}.reliability"),
        (
            f"{QOS.replace('odometry', 'odometri')}.reliability:=best_effort",
            f"there is no such parameter; the nearest is {QOS}.reliability",
        ),
        (f"{QOS}.durability:=volatile", f"{QOS}.durability: there is no such parameter"),
        (
            f"{QOS.replace('subscription', 'publisher')}.depth:=3",
            "/brick/odometry.publisher.depth: there is no such parameter",
        ),
    ],
)
def test_a_value_of_the_command_line_is_taken_or_refused_but_never_ignored(
    capfd: pytest.CaptureFixture[str], given: str, words: str
) -> None:
    """Beside a file that has the parameter, ROS ignores a value of another type: `log:=0` went on logging."""
    arguments = ["--params-file", str(SERVER_FILE), "--ros-args", "-p", "log:=false", "-p", given]
    assert server.main(arguments) == 2
    printed = capfd.readouterr().err
    assert says(printed, words)
    assert "Traceback" not in printed


def test_the_process_ends_with_2_and_one_line() -> None:
    wrong = ["--params-file", str(SERVER_FILE), "--ros-args", "-p", "body.brick.mass:=-1.0"]
    done = subprocess.run(
        [sys.executable, "-m", "contact_dynamics", "server", *wrong],
        cwd=ROOT,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.returncode == 2
    assert says(done.stderr, "body.brick.mass must be > 0..., got -1.0")
    assert len(done.stderr.splitlines()) == 2  # the first is that the server starts
