# SPDX-License-Identifier: Apache-2.0
"""Workflows and containers run what the documents say, and name what there is."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]
WORKFLOWS = {
    path.stem: yaml.safe_load(path.read_text(encoding="utf-8"))
    for path in sorted((ROOT / ".github" / "workflows").glob("*.yml"))
}


def commands(workflow: dict[str, Any]) -> list[str]:
    """All lines that a workflow's jobs run, also those in a matrix."""
    found = []
    for job in workflow["jobs"].values():
        rows = job.get("strategy", {}).get("matrix", {}).get("include", ())
        texts = [row.get("command", "") for row in rows]
        texts += [step.get("run", "") for step in job["steps"]]
        found += [line.strip() for text in texts for line in text.splitlines()]
    return found


def test_the_ros_workflow_runs_the_readmes_commands_word_for_word() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    section = readme.partition("## Use it over ROS 2")[2].partition("\n## ")[0]
    lines = [
        line.strip()
        for block in re.findall(r"```sh\n(.*?)```", section, re.DOTALL)
        for line in block.splitlines()
    ]
    assert len(lines) > 4
    run = commands(WORKFLOWS["ros"])
    assert [line for line in lines if line not in run] == []


@pytest.mark.parametrize("name", WORKFLOWS)
def test_what_a_workflow_calls_exists(name: str) -> None:
    text = "\n".join(commands(WORKFLOWS[name]))
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    called = {word for words in re.findall(r"\bmake((?: [a-z-]+)+)", text) for word in words.split()}
    assert called <= targets
    paths = re.findall(r"\b(?:test|setup|requirements|examples)/[\w./-]+", text)
    assert [path for path in paths if not (ROOT / path).exists()] == []


@pytest.mark.parametrize(("workflow", "job"), [("tests", "tests"), ("wheels", "wheels")])
def test_every_python_of_the_package_is_run(workflow: str, job: str) -> None:
    pythons = WORKFLOWS[workflow]["jobs"][job]["strategy"]["matrix"]["python"]
    assert " ".join(pythons) in (ROOT / "setup" / "pythons.sh").read_text(encoding="utf-8")
    assert len(pythons) == 5


def test_the_container_is_built_as_the_quick_start_says() -> None:
    page = (ROOT / "docs" / "quick-start-ros.md").read_text(encoding="utf-8")
    (paths,) = re.findall(r"^rosdep install (--from-paths src .*)$", page, re.MULTILINE)
    (build,) = re.findall(r"^colcon build --base-paths .*$", page, re.MULTILINE)
    dockerfile = (ROOT / "docker" / "Dockerfile").read_text(encoding="utf-8")
    assert dockerfile.count(paths) == 2
    assert build in dockerfile
    developed = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text(encoding="utf-8"))[
        "build"
    ]
    assert (ROOT / ".devcontainer" / developed["dockerfile"]).samefile(ROOT / "docker" / "Dockerfile")
    assert f" AS {developed['target']}\n" in dockerfile


def test_pixi_has_what_the_library_needs() -> None:
    listed = re.findall(r"^([\w-]+) = ", (ROOT / "pixi.toml").read_text(encoding="utf-8"), re.MULTILINE)
    needed = re.findall(
        r"^[\w-]+", (ROOT / "requirements" / "core.txt").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert {name.lower() for name in needed} <= set(listed)
