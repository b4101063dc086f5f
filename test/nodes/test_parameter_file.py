"""The server's parameters out of a file, without ROS: the same as ROS reads, and mistakes named."""

from __future__ import annotations

from pathlib import Path

import pytest

from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameters import ConfigurationError, read_server_parameters

ROOT = Path(__file__).parents[2]


def test_the_commented_configuration_is_read_as_it_says() -> None:
    parameters = read_server_parameters(ParameterFile(ROOT / "config" / "server.yaml"))
    (brick,), (floor,) = parameters.world.bodies, parameters.world.surfaces
    assert (brick.name, brick.mass_properties.mass, len(brick.vertices_B)) == ("brick", 0.4, 8)
    assert (floor.name, floor.friction, floor.restitution) == ("floor", 0.3, 0.45)
    (states,) = parameters.sources
    assert [topic.name for source in states.sources for topic in source.topics] == ["/brick/odometry"]
    assert parameters.defaults.velocity_tolerance == 1e-9


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
        ("/**:\n  ros__parameters:\n    horizon: soon\n", "horizon: found 'soon'"),
        ("/**:\n  ros__parameters:\n    horizon: -1.0\n", "horizon: found -1.0, allowed is 0 to 10000"),
        ("/**:\n  ros__parameters:\n    horizon: true\n", "horizon: found True"),
        ("/**:\n  ros__parameters:\n    bodies: [cup]\n", "body.cup.mass: found None"),
        ("/**: 3\n", "found no ros__parameters"),
        ("a: b\n", "found no parameters"),
        ("a: [b\n", "no YAML"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, named: str) -> None:
    file = tmp_path / "server.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError) as caught:
        read_server_parameters(ParameterFile(file))
    assert named in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"nowhere\.yaml: cannot be read"):
        ParameterFile(tmp_path / "nowhere.yaml")
