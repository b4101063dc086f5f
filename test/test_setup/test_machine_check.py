# SPDX-License-Identifier: Apache-2.0
"""What is said on a machine that lacks something, before anything is installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from test_setup.programs import SETUP, run, script


def pretender(folder: Path, name: str, pretence: str) -> Path:
    """A Python of which something is not so: it runs `pretence` before what it is asked."""
    return script(folder / name, f'exec "{sys.executable}" -c "{pretence}\n$2"')


def check(python: Path | str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Ask the script about this machine and a Python."""
    return run(SETUP / "check_machine.sh", python, env=os.environ | environment)


def test_missing_compilers_are_named_together(tmp_path: Path) -> None:
    answer = check(sys.executable, CC=str(tmp_path / "cc"), CXX=str(tmp_path / "c++"))
    assert answer.returncode == 1
    assert "no working C compiler" in answer.stderr
    assert "no working C++ compiler" in answer.stderr
    assert "sudo apt install build-essential" in answer.stderr
    assert "sudo dnf install gcc gcc-c++" in answer.stderr


@pytest.mark.parametrize(
    ("pretence", "complaint"),
    [
        ("import sys, sysconfig; sys.version_info = (3, 9, 1)", "3.10 to 3.14 are supported"),
        ("import sys, sysconfig; sys.version_info = (3, 15, 0)", "3.10 to 3.14 are supported"),
        ("import sys; sys.modules['ensurepip'] = None", "-venv"),
        ("import sysconfig; sysconfig.get_path = lambda name: '/nowhere'", "-dev"),
        ("import platform; platform.libc_ver = lambda: ('musl', '1.2')", "glibc 2.28"),
        ("import platform; platform.libc_ver = lambda: ('glibc', '2.17')", "glibc 2.28"),
        ("import sysconfig as s; s.get_config_var = lambda name: 1", "with its lock"),
        ("raise SystemExit(1)", "does not run"),
    ],
)
def test_a_python_that_does_not_serve_is_refused(tmp_path: Path, pretence: str, complaint: str) -> None:
    answer = check(pretender(tmp_path, "python", pretence))
    assert answer.returncode == 1
    assert complaint in answer.stderr
    assert "Nothing was installed" in answer.stderr


def test_headers_of_which_some_are_missing_are_named(tmp_path: Path) -> None:
    (tmp_path / "Python.h").write_text('#include "elsewhere/pyconfig.h"\n', encoding="utf-8")
    answer = check(
        pretender(tmp_path, "python", f"import sysconfig; sysconfig.get_path = lambda name: '{tmp_path}'")
    )
    assert answer.returncode == 1
    assert "header files" in answer.stderr
    assert "-dev" in answer.stderr


def test_what_a_shim_says_is_shown(tmp_path: Path) -> None:
    shim = script(tmp_path / "python3.12", "echo 'pyenv: python3.12: command not found' >&2; exit 127")
    answer = check(shim)
    assert answer.returncode == 1
    assert f"{shim} does not run, and says:" in answer.stderr
    assert "pyenv: python3.12: command not found" in answer.stderr


def test_another_platform_is_refused(tmp_path: Path) -> None:
    script(tmp_path / "uname", '[ "$1" = -s ] && echo Darwin || echo arm64')
    answer = check(sys.executable, PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert answer.returncode == 1
    assert "Darwin on arm64" in answer.stderr


class Maker:
    """make_venv.sh on a machine that passes the check, with a Python that makes environments by copying."""

    def __init__(self, folder: Path) -> None:
        self.venv = folder / "venv"
        self._folder = folder
        script(folder / "setup" / "check_machine.sh", "exit 0")
        shutil.copy(SETUP / "make_venv.sh", folder / "setup")

    def python(self, minor: int) -> Path:
        """A Python that says that it is 3.`minor`, and whose venv module copies it."""
        return script(
            self._folder / f"python3.{minor}",
            f'if [ "$1" = -m ]; then mkdir -p "$3/bin" && cp "$0" "$3/bin/python"; else echo 3.{minor}; fi',
        )

    def __call__(self, *python: Path) -> subprocess.CompletedProcess[str]:
        """Run the script, with the Python that was asked for by name, if one was."""
        return run(self._folder / "setup" / "make_venv.sh", self.venv, *python)


@pytest.fixture
def maker(tmp_path: Path) -> Maker:
    """A place for environments."""
    return Maker(tmp_path)


def test_an_environment_is_made_once(maker: Maker) -> None:
    assert "Making" in maker(maker.python(12)).stdout
    made = (maker.venv / ".made" / "python").stat().st_mtime_ns
    for again in ([maker.python(12)], []):
        assert maker(*again).stdout == ""
    assert (maker.venv / ".made" / "python").stat().st_mtime_ns == made


def test_an_environment_reached_through_a_link_is_not_made_anew(maker: Maker, tmp_path: Path) -> None:
    maker(maker.python(12))
    link = tmp_path / "a link"
    link.symlink_to(maker.venv.parent)
    maker.venv = link / maker.venv.name
    assert maker(maker.python(12)).stdout == ""


def test_an_environment_of_another_python_than_asked_is_made_anew(maker: Maker) -> None:
    maker(maker.python(12))
    (maker.venv / "leftover").touch()
    assert "with Python 3.11" in maker(maker.python(11)).stdout
    assert not (maker.venv / "leftover").exists()


def test_an_environment_whose_python_is_gone_is_made_anew(maker: Maker) -> None:
    maker(maker.python(12))
    script(maker.venv / "bin" / "python", "exit 1")
    assert "anew" in maker(maker.python(12)).stdout


def test_a_moved_environment_is_made_anew(maker: Maker) -> None:
    maker(maker.python(12))
    maker.venv = maker.venv.rename(maker.venv.with_name("moved"))
    assert "anew" in maker(maker.python(12)).stdout


def test_an_environment_of_somebody_else_is_left_alone(maker: Maker) -> None:
    (maker.venv / "work").mkdir(parents=True)
    answer = maker(maker.python(12))
    assert answer.returncode == 1
    assert "was not made by this Makefile" in answer.stderr
    assert (maker.venv / "work").exists()
