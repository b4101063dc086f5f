"""The workflows run what the documents say, and name what there is."""

from __future__ import annotations

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
        texts = [row["command"] for row in rows] + [step.get("run", "") for step in job["steps"]]
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
