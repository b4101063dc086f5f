# SPDX-License-Identifier: Apache-2.0
"""The command line where only `pip install .` was run: no ROS, no rerun."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics.command_line import BROKEN_PIPE, INTERRUPTED, VERBS, main
from contact_dynamics.nodes.other_parameters import MONITOR_PARAMETERS, VISUALIZER_PARAMETERS
from contact_dynamics.nodes.parameters import described_server_parameters
from contact_dynamics.recording import BagWriter
from test_setup.programs import ROOT, run

BROUGHT = ("numpy", "numpy.libs", "scipy", "scipy.libs", "mcap", "lz4", "zstandard", "typing_extensions.py")
OPTIONS = {
    "cases": ["--list", "--published", "--without-mujoco", "NAME"],
    "block_publisher": ["pushed_block", "tray", "--height", "--tilt", "--seconds"],
    "commentator": ["thrown_box", "pushed_block", "tray", "--server"],
    "demo": ["--toss", "--view", "--output", "--quiet"],
    "calibrate": ["--free", "--no-trajectories", "--yaml", "RECORDING"],
    "evaluate": ["--against", "--dask", "--results", "--rerun", "RECORDING"],
    "live_monitor": ["--params-file", "--ros-args", *MONITOR_PARAMETERS],
    "monitor": ["--config", "--calibration", "--json", "RECORDING"],
    "plot": ["--output", "--format", "--max-responses", "LOG"],
    "recover": ["--output", "LOG"],
    "replay": ["verify", "info", "table", "view", "publish", "LOG"],
    "server": ["--params-file", "--ros-args", *(each.name for each in described_server_parameters())],
    "toss_publisher": ["--toss", "--listeners"],
    "visualizer": ["--params-file", "--ros-args", *VISUALIZER_PARAMETERS],
}

EACH_VERB = """
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout
from contact_dynamics.command_line import VERBS, main

told = {}
for verb in VERBS:
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            code = main([verb, *(word.format(verb) for word in sys.argv[1:])])
        except SystemExit as ended:
            code = ended.code
    told[verb] = code, out.getvalue(), err.getvalue()
print(json.dumps(told))
"""
"""Call every verb in one process, each with the arguments of this program."""


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
        return self.run("-m", "contact_dynamics", *arguments)

    def each_verb(self, *arguments: str) -> dict[str, tuple[int, str, str]]:
        """What each verb returns and prints, given these arguments, in which {} is its name."""
        told: dict[str, tuple[int, str, str]] = json.loads(self.run("-c", EACH_VERB, *arguments).stdout)
        assert list(told) == list(VERBS)
        return told

    def run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run Python."""
        return run(sys.executable, "-S", *arguments, cwd=ROOT, env=self._environment)  # -S: no site-packages


@pytest.fixture
def without_ros(tmp_path: Path) -> WithoutRos:
    """The command line where ROS and rerun are missing."""
    return WithoutRos(tmp_path)


def test_every_verb_has_its_options_here() -> None:
    assert set(OPTIONS) == set(VERBS)


def test_help_names_the_options(without_ros: WithoutRos) -> None:
    for verb, (code, printed, errors) in without_ros.each_verb("--help").items():
        assert code == 0, errors
        assert printed.startswith(f"usage: contact-dynamics {verb} ")
        assert [option for option in OPTIONS[verb] if option not in printed] == []


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["relpay", "log"], "there is no verb 'relpay'; did you mean 'replay'?"),
        (["toss-publisher"], "there is no verb 'toss-publisher'; did you mean 'toss_publisher'?"),
        (["table", "log"], "there is no verb 'table'; did you mean 'replay table'?"),
        (["replay", "tabel", "log"], "there is no mode and no log 'tabel'; did you mean 'table'?"),
        (["replay", "draw", "log"], "no log 'draw'; the modes are verify, info, table, view, publish"),
        (["xyz"], "there is no verb 'xyz'; the verbs are demo, server, visualizer, replay"),
        (
            ["server", "--horizon", "2.0"],
            "horizon is a parameter of ROS, which is set by --ros-args -p horizon:=2.0",
        ),
        (
            ["server", "--world-frame=map"],
            "world_frame is a parameter of ROS, which is set by --ros-args -p world_frame:=map",
        ),
        (["server", "-p", "horizon:=2.0"], "-p must follow --ros-args: --ros-args -p horizon:=2.0"),
        (
            ["visualizer", "--spawn"],
            "spawn is a parameter of ROS, which is set by --ros-args -p spawn:=VALUE",
        ),
        (["server", "--params-file", "nope.yaml"], "--params-file nope.yaml: no such file"),
        (["server", "--ros-args", "--params-file", "nope.yaml"], "--params-file nope.yaml: no such file"),
        (["plot", "--rate", "5"], "unrecognized arguments: --rate"),
    ],
)
def test_what_is_mistyped_gets_what_is_meant(
    capsys: pytest.CaptureFixture[str], typed: list[str], words: str
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(typed)
    assert ended.value.code == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "offered"),
    [("contact-dynamics rep", ["replay"]), ("contact-dynamics replay table --ou", ["--output"])],
)
def test_a_shell_can_complete_verbs_and_options(tmp_path: Path, line: str, offered: list[str]) -> None:
    told = tmp_path / "told"
    asked = {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(told),
        "_ARGCOMPLETE_IFS": "\n",
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
    }
    run(sys.executable, "-m", "contact_dynamics", cwd=ROOT, env={**os.environ, **asked}, check=True)
    assert [word.strip() for word in told.read_text().split("\n")] == offered


def test_a_mistyped_option_is_named_first(without_ros: WithoutRos) -> None:
    for verb, (code, _, errors) in without_ros.each_verb("--no-{}").items():
        assert code == 2, verb
        assert f"--no-{verb}" in errors


def test_what_is_missing_is_named_with_what_brings_it(without_ros: WithoutRos) -> None:
    told = without_ros.each_verb()
    for verb in (name for name, verb in VERBS.items() if "rclpy" in verb.needs):
        code, _, errors = told[verb]
        assert code == 3, verb
        assert f"contact-dynamics {verb} requires" in errors
        assert all(words in errors for words in ("rclpy", "contact_dynamics_interfaces", "make setup"))
        assert ("[view]" in errors) == (verb in {"demo", "visualizer"})


def test_cases_are_asked_where_mujoco_is_missing(without_ros: WithoutRos) -> None:
    answer = without_ros("cases", "free_fall")
    assert answer.returncode == 0, answer.stderr
    assert "not installed" in answer.stdout
    assert "pip install mujoco" in answer.stderr
    assert "1 of 1 answers are exact" in answer.stdout


def test_an_interrupted_verb_ends_without_a_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_arguments: list[str]) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("contact_dynamics.cases.run.main", interrupted)
    assert main(["cases"]) == INTERRUPTED
    assert capsys.readouterr().err == "\nstopped\n"


@pytest.mark.parametrize("arguments", [("--help",), ("cases", "--list"), ("replay", "info", "FOLDER")])
def test_a_reader_of_the_output_that_goes_ends_a_verb_without_a_word(
    tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    """As `head` does: here nobody reads."""
    with BagWriter(tmp_path / "log", run={}) as writer:
        writer.add_topic("/pose", "geometry_msgs/msg/PoseStamped")
    command = [str(tmp_path) if word == "FOLDER" else word for word in arguments]
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-m", "contact_dynamics", *command],
        stdout=write,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(write)
    assert (done.stderr, done.returncode) == ("", BROKEN_PIPE)


def test_the_quick_start_names_every_verb() -> None:
    page = (ROOT / "docs" / "quick-start-ros.md").read_text(encoding="utf-8")
    named = page.split("has the subcommands ")[1].split("--help")[0]
    assert [verb for verb in VERBS if f"{verb}`" not in named] == []


def test_help_does_not_warn_of_an_outdated_core(without_ros: WithoutRos) -> None:
    """Commands do, even those that end with an error."""
    outdated = """
import sys
from contact_dynamics.numerics import compiled
compiled.checksum = lambda source: -1
from contact_dynamics.command_line import main
sys.exit(main(sys.argv[1:]))
"""
    told = without_ros.run("-c", outdated, "replay", "--help")
    assert (told.returncode, told.stderr) == (0, "")
    assert "plain Python" in without_ros.run("-c", outdated, "replay", "verify", "none").stderr


def test_verbs_use_one_thread_of_linear_algebra_unless_more_are_asked_for() -> None:
    """The threads of NumPy's matrices wait for each other on a busy machine."""
    program = (
        "import os\nfrom contact_dynamics.command_line import main\n"
        "main(['plot', '--output', 'x', 'no.mcap'])\n"
        "import numpy as np\nnp.linalg.svd(np.eye(200))\nprint(len(os.listdir('/proc/self/task')))"
    )
    if (os.cpu_count() or 1) < 2:
        pytest.skip("one core: NumPy has no further threads")

    def threads(**asked: str) -> int:
        given = {key: value for key, value in os.environ.items() if not key.endswith("_NUM_THREADS")}
        done = run(sys.executable, "-c", program, cwd=ROOT, env={**given, **asked}, check=True)
        return int(done.stdout.splitlines()[-1])

    assert threads() == 1
    assert threads(OPENBLAS_NUM_THREADS="2") == 2
