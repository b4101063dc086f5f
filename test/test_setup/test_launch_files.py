# SPDX-License-Identifier: Apache-2.0
"""The launch files, read by the genuine `launch` where that is installed."""

from __future__ import annotations

import importlib
import os
import sys
from pathlib import Path
from typing import Any

import pytest

launch = pytest.importorskip("launch")
pytest.importorskip("launch_ros")

from running_server import ROOT  # noqa: E402

FILES = sorted((ROOT / "launch").glob("*.launch.py"))
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"


@pytest.fixture(autouse=True)
def prefix(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the package is installed; a sourced workspace has set it already."""
    if "AMENT_PREFIX_PATH" not in os.environ:
        monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix)


def description_of(path: Path) -> Any:
    sources = importlib.import_module("launch.launch_description_sources")
    return sources.get_launch_description_from_python_launch_file(str(path))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_argument_has_a_default_and_says_what_it_is(path: Path) -> None:
    arguments = description_of(path).get_launch_arguments()
    assert arguments
    for argument in arguments:
        assert argument.description, argument.name
        assert argument.default_value is not None, argument.name


@pytest.mark.parametrize("name", ["namespace", "params_file"])
def test_an_argument_of_which_each_server_has_its_own_value_is_rejected(
    caplog: pytest.LogCaptureFixture, name: str
) -> None:
    service = launch.LaunchService()
    service.context.launch_configurations[name] = "zzz"
    service.include_launch_description(description_of(ROOT / "launch" / "two_servers.launch.py"))
    assert service.run() == 1
    assert f"{name} must not be given, since each server has its own, got 'zzz'" in caplog.text


@pytest.mark.parametrize(
    ("before", "asked", "after"),
    [(None, None, "LOCALHOST"), ("SUBNET", None, "SUBNET"), ("LOCALHOST", "SUBNET", "SUBNET")],
)
def test_the_server_is_found_on_this_machine_unless_something_else_is_asked(
    monkeypatch: pytest.MonkeyPatch, before: str | None, asked: str | None, after: str
) -> None:
    launch_ros = importlib.import_module("launch_ros.actions")
    if before is None:
        monkeypatch.delenv(RANGE)
    else:
        monkeypatch.setenv(RANGE, before)
    service = launch.LaunchService()
    if asked is not None:
        service.context.launch_configurations["discovery_range"] = asked
    found = description_of(ROOT / "launch" / "server.launch.py")
    nodes = [action for action in found.entities if isinstance(action, launch_ros.Node)]
    for action in found.entities:
        if action not in nodes:
            action.execute(service.context)
    assert os.environ.get(RANGE) == before  # of whoever includes this file
    for node in nodes:
        given = {
            "".join(part.perform(service.context) for part in name): "".join(
                part.perform(service.context) for part in value
            )
            for name, value in node.additional_env
        }
        assert given == {RANGE: after}
