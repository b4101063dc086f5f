# SPDX-License-Identifier: Apache-2.0
"""The examples and the README's code run, and print what they say."""

from __future__ import annotations

import codeop
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from running_server import ROOT, environment, process

EXAMPLES = {
    "tumbling_t_handle.py": "about_minor_axis",
    "scenes.py": "grip of 6.0 N: ffffffff\ngrip of 4.0 N: cccccccc",
    "sliding_rod.py": "sliding left under gravity: inconsistent",
    "next_landing.py": "impulse",
    "poinsot.py": "about_major_axis",
    "impulse_space.py": "r = (1, -2): reverses in compression",
    "landing_on_corners.py": "ms: corner 1",
    "newtons_cradle.py": "0.000  0.000  0.000  0.000  1.000 m/s",
    "diagrams_on_paper.py": "rsrs, ",
    "tossed_cube.py": "  1. corner 0 strikes: 100%, in 0.21",
    "tray.py": "mode rsrs with a margin",
    "wheel_over_an_edge.py": "1.6 m/s on its edge : s, presses with 0.000 N",
}


RUNNER = """
import atexit, os, runpy, sys
import contact_dynamics, scipy.optimize, scipy.spatial.transform
for name in contact_dynamics.__all__:
    getattr(contact_dynamics, name)  # imports its chapter
for line in sys.stdin:
    script, folder = line.rstrip().split(os.pathsep)
    child = os.fork()
    if not child:
        os.chdir(folder)
        for stream, name in enumerate(("/dev/null", "stdout", "stderr")):
            os.dup2(os.open(name, os.O_CREAT | os.O_RDWR | os.O_TRUNC), stream)
        sys.path[0] = os.path.dirname(script)
        sys.argv = [script]
        runpy.run_path(script, run_name="__main__")
        atexit._run_exitfuncs()
        sys.stdout.flush()
        os._exit(0)  # to take all imports down would take 0.2 s
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
"""Runs each script in a fork of its own, so that Python imports the package only once."""


@pytest.fixture(scope="module")
def runner() -> Iterator[subprocess.Popen[str]]:
    rerun = ["-W", "ignore::DeprecationWarning"]  # of Python 3.10, at rerun's import
    command = [sys.executable, "-W", "error", *rerun, "-c", RUNNER]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment()
    ) as started:
        yield started


def run(runner: subprocess.Popen[str], script: Path, folder: Path) -> str:
    """Run a script in a folder, and return what it prints."""
    assert runner.stdin
    assert runner.stdout
    runner.stdin.write(f"{script}{os.pathsep}{folder}\n")
    runner.stdin.flush()
    status = runner.stdout.readline()
    assert status == "0\n", (folder / "stderr").read_text(encoding="utf-8")
    return (folder / "stdout").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", EXAMPLES)
def test_example(name: str, runner: subprocess.Popen[str], tmp_path: Path) -> None:
    assert EXAMPLES[name] in run(runner, ROOT / "examples" / name, tmp_path)


def test_no_example_is_left_out() -> None:
    assert {path.name for path in (ROOT / "examples").glob("*.py")} == {*EXAMPLES, "ask_the_server.py"}


def test_asking_the_server() -> None:
    arguments = ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "log:=false")
    with process("server", *arguments, ready="ready"):
        script = ROOT / "examples" / "ask_the_server.py"
        command = [
            sys.executable,
            str(script),
        ]  # without -W error: rclpy's own warnings are not the example's
        result = subprocess.run(
            command, capture_output=True, text=True, check=False, env=environment(), timeout=300
        )
    assert result.returncode == 0, result.stderr
    assert "orientation x y z w" in result.stdout


BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
NEEDS_A_LOG = {"docs/log.md", "docs/replay.md"}
PAGES = [
    name
    for path in sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
    if BLOCK.search(path.read_text(encoding="utf-8"))
    and (name := str(path.relative_to(ROOT))) not in NEEDS_A_LOG
]


def test_the_documents_have_code() -> None:
    assert {"README.md", "docs/tumbling.md", "docs/tutorials/catch.md"} < set(PAGES)


@pytest.mark.parametrize("page", PAGES)
def test_the_code_in_the_documents(page: str, runner: subprocess.Popen[str], tmp_path: Path) -> None:
    blocks = BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
    for block in blocks:
        script = tmp_path / "block.py"
        script.write_text(block, encoding="utf-8")
        printed = run(runner, script, tmp_path)
        for expected in re.findall(r"#> (.*)", block):
            assert expected in printed


def test_the_code_in_the_documents_can_be_pasted_into_a_prompt() -> None:
    """Python's prompt ends a loop or a function at an empty line, and up to 3.12 nowhere else."""
    for page in PAGES:
        for block in BLOCK.findall((ROOT / page).read_text(encoding="utf-8")):
            pending: list[str] = []
            for line in [*block.splitlines(), ""]:
                pending.append(line)
                if codeop.compile_command("\n".join(pending)) is not None:
                    pending = []
            assert not "".join(pending).strip(), page
