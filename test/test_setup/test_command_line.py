"""The command line where only `pip install .` was run: no ROS, no rerun."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics.command_line import VERBS
from contact_dynamics.nodes.arguments import SERVER_PARAMETERS, VISUALIZER_PARAMETERS

ROOT = Path(__file__).parents[2]
BROUGHT = ("numpy", "numpy.libs", "scipy", "scipy.libs", "mcap", "lz4", "zstandard", "typing_extensions.py")
OPTIONS = {
    "demo": ["--toss", "--view", "--output", "--quiet"],
    "evaluate": ["--against", "--dask", "--results", "--rerun", "RECORDING"],
    "plot": ["--output", "--format", "--most", "LOG"],
    "recover": ["--out", "LOG"],
    "replay": ["verify", "table", "view", "publish", "LOG"],
    "server": ["--params-file", "--ros-args", *SERVER_PARAMETERS],
    "toss_publisher": ["--toss", "--listeners"],
    "visualizer": ["--params-file", "--ros-args", *VISUALIZER_PARAMETERS],
}


class WithoutRos:
    """A Python that finds what `pip install .` brings, and nothing else."""

    def __init__(self, folder: Path) -> None:
        installed = Path(np.__file__).parents[1]
        for name in BROUGHT:
            if (installed / name).exists():
                (folder / name).symlink_to(installed / name)
        self._environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)])}

    def __call__(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run the command line."""
        return subprocess.run(
            [sys.executable, "-S", "-m", "contact_dynamics", *arguments],  # -S: no site-packages
            cwd=ROOT,
            env=self._environment,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )


@pytest.fixture
def without_ros(tmp_path: Path) -> WithoutRos:
    """The command line where ROS and rerun are missing."""
    return WithoutRos(tmp_path)


def test_every_verb_has_its_options_here() -> None:
    assert set(OPTIONS) == set(VERBS)


@pytest.mark.parametrize("verb", VERBS)
def test_help_names_the_options(without_ros: WithoutRos, verb: str) -> None:
    answer = without_ros(verb, "--help")
    assert answer.returncode == 0, answer.stderr
    assert [option for option in OPTIONS[verb] if option not in answer.stdout] == []


@pytest.mark.parametrize("verb", VERBS)
def test_a_mistyped_option_is_named_first(without_ros: WithoutRos, verb: str) -> None:
    answer = without_ros(verb, "--nonsense")
    assert answer.returncode == 2
    assert "--nonsense" in answer.stderr


@pytest.mark.parametrize("verb", [name for name, verb in VERBS.items() if "rclpy" in verb.needs])
def test_what_is_missing_is_named_with_what_brings_it(without_ros: WithoutRos, verb: str) -> None:
    answer = without_ros(verb)
    assert answer.returncode == 3
    assert f"contact-dynamics {verb} needs" in answer.stderr
    assert "rclpy" in answer.stderr
    assert "contact_dynamics_interfaces" in answer.stderr
    assert "make setup" in answer.stderr
    assert ("[view]" in answer.stderr) == (verb in {"demo", "visualizer"})
