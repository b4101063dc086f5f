"""What setup/build_interfaces.sh says while the compilers work, and when they fail."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

BUILD = Path(__file__).parents[2] / "setup" / "build_interfaces.sh"


def build(folder: Path, building: str) -> subprocess.CompletedProcess[str]:
    """Run the script with a shell text in place of what cmake does when it builds."""
    programs = folder / "programs"
    venv = folder / "an environment"
    for each in (programs, venv):
        each.mkdir()
    for name in ("cmake", "ninja"):
        program = programs / name
        program.write_text(
            f'#!/bin/sh\ncase $1 in --version) echo "version 3.28";; --build) {building};; esac\n',
            encoding="utf-8",
        )
        program.chmod(0o755)
    environment = {"PATH": f"{programs}:{os.environ['PATH']}", "PROGRESS_PERIOD_S": "0.2"}
    return subprocess.run(
        [BUILD, venv], env=os.environ | environment, capture_output=True, text=True, timeout=60, check=False
    )


def test_a_long_build_shows_that_it_lives(tmp_path: Path) -> None:
    answer = build(tmp_path, "echo '[3/126] Building CXX object'; sleep 1")
    assert answer.returncode == 0, answer.stderr
    assert "  step 3 of 126\n" in answer.stdout


def test_a_build_that_fails_shows_the_compilers_words(tmp_path: Path) -> None:
    answer = build(tmp_path, "echo 'fatal error: no such header'; exit 1")
    assert answer.returncode == 1
    assert "fatal error: no such header" in answer.stderr
    assert str(tmp_path / "an environment" / "build") in answer.stderr
