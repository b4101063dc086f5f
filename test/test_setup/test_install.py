# SPDX-License-Identifier: Apache-2.0
"""What setup/install.sh says while pip works, and when it fails."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from test_setup.programs import SETUP, run, script


def environment_with(folder: Path, python: str) -> Path:
    """A folder in which the script takes a shell text for Python."""
    venv = folder / "an environment"
    (venv / ".made").mkdir(parents=True)
    script(venv / "bin" / "python", python)
    return venv


def install(venv: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the script."""
    return run(SETUP / "install.sh", venv, *arguments, env=os.environ | environment)


def test_no_network_is_said_plainly(tmp_path: Path) -> None:
    nobody = "http://127.0.0.1:9/simple"
    answer = install(
        environment_with(tmp_path, f'exec "{sys.executable}" "$@"'),
        "nonesuch",
        PIP_CONFIG_FILE=os.devnull,
        PIP_INDEX_URL=nobody,
        PIP_FIND_LINKS="/nonexistent",
        PIP_RETRIES="1",
    )
    assert answer.returncode == 1
    assert f"A package index could not be reached: {nobody}" in answer.stderr
    assert "the reason: Connection refused" in answer.stderr
    assert "https_proxy" in answer.stderr
    assert "is ignored" not in answer.stderr


def test_what_pip_refuses_is_shown_without_its_noise(tmp_path: Path) -> None:
    noise = "WARNING: Location '/wheels' is ignored: it is either a non-existing path or lacks a scheme."
    flood = f'i=0; while [ $i -lt 99 ]; do echo "{noise}"; i=$((i + 1)); done'
    answer = install(environment_with(tmp_path, f"{flood}\necho 'ERROR: no such wheel'; exit 1"), "nonesuch")
    assert answer.returncode == 1
    assert "ERROR: no such wheel" in answer.stderr
    assert "is ignored" not in answer.stderr


def test_a_full_disk_is_named(tmp_path: Path) -> None:
    text = "echo 'ERROR: Could not install packages: [Errno 28] No space left on device'; exit 1"
    assert "The disk is full" in install(environment_with(tmp_path, text), "nonesuch").stderr


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("Collecting numpy>=1.26", "1 packages downloaded, now numpy>=1.26"),
        ("  Building editable for contact_dynamics: started", "building the package and its compiled core"),
        ("Looking in indexes: https://example.org/simple", "starting pip"),
        ("WARNING: Retrying (Retry(total=4)) after connection broken", "no response from the network"),
        ("Installing collected packages: numpy", "unpacking: "),
    ],
)
def test_a_long_installation_shows_that_it_lives(tmp_path: Path, line: str, said: str) -> None:
    answer = install(
        environment_with(tmp_path, f"echo '{line}'; sleep 0.8"), "numpy", PROGRESS_PERIOD_S="0.2"
    )
    assert answer.returncode == 0
    assert said in answer.stdout
    assert answer.stderr == ""
