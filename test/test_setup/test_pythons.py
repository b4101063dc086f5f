# SPDX-License-Identifier: Apache-2.0
"""Which Pythons the matrix and continuous integration find: those that run, wherever they are."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from test_setup.programs import SETUP, run, script

VERSION = "{}.{}".format(*sys.version_info[:2])


def found(**environment: str) -> tuple[dict[str, str], str]:
    """The program of each version, and what is said of the others."""
    answer = run(SETUP / "pythons.sh", env=environment, check=True)
    return dict(line.split("\t") for line in answer.stdout.splitlines()), answer.stderr


@pytest.fixture
def real() -> str:
    """What runs the Python of this suite."""
    return f'exec "{sys.executable}" "$@"'


@pytest.mark.parametrize(
    ("place", "setting"),
    [
        ("on path", "PATH"),
        ("pyenv/versions/{version}.1/bin", "PYENV_ROOT"),
        ("home/.pyenv/versions/{version}.1/bin", ""),
        ("uv/cpython-{version}.2-linux-x86_64-gnu/bin", "UV_PYTHON_INSTALL_DIR"),
        ("home/.local/share/uv/python/cpython-{version}.2-linux-x86_64-gnu/bin", ""),
    ],
)
def test_a_python_is_found_behind_a_shim_that_does_not_run(
    tmp_path: Path, real: str, place: str, setting: str
) -> None:
    shim = script(tmp_path / "shims" / f"python{VERSION}", "echo 'pyenv: command not found' >&2; exit 127")
    folder = tmp_path / place.format(version=VERSION)
    python = script(folder / f"python{VERSION}", real)
    environment = {"PATH": f"{shim.parent}:/usr/bin:/bin", "HOME": str(tmp_path / "home")}
    if setting == "PATH":
        environment["PATH"] = f"{shim.parent}:{folder}:/usr/bin:/bin"
    elif setting:
        environment[setting] = str(tmp_path / place.split("/", maxsplit=1)[0])
    programs, _ = found(**environment)
    usual = {f"/usr/bin/python{VERSION}", f"/bin/python{VERSION}"}
    assert programs[VERSION] == str(python) or (setting != "PATH" and programs[VERSION] in usual)


def test_a_shim_that_does_not_run_is_no_python(tmp_path: Path) -> None:
    for minor in range(10, 15):
        script(tmp_path / f"3.{minor}" / f"python3.{minor}", "exit 127")
    shims = ":".join(str(tmp_path / f"3.{minor}") for minor in range(10, 15))
    programs, missing = found(PATH=f"{shims}:/usr/bin:/bin", HOME=str(tmp_path))
    assert not [path for path in programs.values() if path.startswith(str(tmp_path))]
    for minor in range(10, 15):
        assert (f"3.{minor}" in programs) != (f"NOT AT HAND: Python 3.{minor}" in missing)


def test_a_python_of_another_version_than_its_name_says_is_not_taken(tmp_path: Path, real: str) -> None:
    other = "3.10" if VERSION != "3.10" else "3.11"
    script(tmp_path / "bin" / f"python{other}", real)
    programs, _ = found(PATH=f"{tmp_path}/bin:/usr/bin:/bin", HOME=str(tmp_path))
    assert not programs.get(other, "").startswith(str(tmp_path))
