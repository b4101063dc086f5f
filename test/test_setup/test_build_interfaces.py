# SPDX-License-Identifier: Apache-2.0
"""What setup/build_interfaces.sh says while the compilers work, and when they fail."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from test_setup.programs import ROOT, SETUP, run, script


def build(folder: Path, building: str) -> subprocess.CompletedProcess[str]:
    """Run the script with a shell text in place of what cmake does when it builds."""
    programs = folder / "programs"
    venv = folder / "an environment"
    venv.mkdir()
    for name in ("cmake", "ninja"):
        script(
            programs / name,
            f'case $1 in --version) echo "version 3.28";; --build) {building};; '
            '--install) : >"$2/install_manifest.txt";; esac',
        )
    environment = {"PATH": f"{programs}:{os.environ['PATH']}", "PROGRESS_PERIOD_S": "0.2"}
    return run(SETUP / "build_interfaces.sh", venv, env=os.environ | environment)


def test_a_long_build_shows_that_it_lives(tmp_path: Path) -> None:
    answer = build(tmp_path, "echo '[3/126] Building CXX object'; sleep 1")
    assert answer.returncode == 0, answer.stderr
    assert "  step 3 of 126\n" in answer.stdout


def test_a_build_that_fails_shows_the_compilers_words(tmp_path: Path) -> None:
    answer = build(tmp_path, "echo 'fatal error: no such header'; exit 1")
    assert answer.returncode == 1
    assert "fatal error: no such header" in answer.stderr
    assert str(tmp_path / "an environment" / "build") in answer.stderr


@pytest.mark.slow  # the real compilers, twice
@pytest.mark.skipif(
    not (Path(sys.prefix) / "share" / "rosidl_default_generators").is_dir(),
    reason="NOT RUN: the build, because this environment has no rosidl generators",
)
def test_a_folder_that_a_shell_would_take_apart_builds_and_is_cleared(tmp_path: Path) -> None:
    """With the real generators. One message is enough, because what breaks is the folder's name."""
    folder = tmp_path / "Bob's work (new) & more"
    package = folder / "contact_dynamics_interfaces"
    for name in ("setup", "cmake"):
        shutil.copytree(ROOT / name, folder / name)
    (package / "msg").mkdir(parents=True)
    for name in ("CMakeLists.txt", "package.xml"):
        shutil.copy(ROOT / "contact_dynamics_interfaces" / name, package)
    shutil.copy(ROOT / "LICENSE", folder)
    (package / "msg" / "First.msg").write_text("float64 value\n", encoding="utf-8")
    venv = folder / ".venv"
    libraries = Path("lib", f"python{sys.version_info[0]}.{sys.version_info[1]}", "site-packages")
    links_to_all_but_ours(
        Path(sys.prefix), venv, inside=("bin", "include", "lib", libraries.parent, libraries, "share")
    )
    shutil.copytree(Path(sys.prefix) / "share" / "ament_index", venv / "share" / "ament_index")

    def installed() -> set[str]:
        answer = run(folder / "setup" / "build_interfaces.sh", venv)
        assert answer.returncode == 0, answer.stderr
        return {
            each.stem
            for each in (venv / libraries / "contact_dynamics_interfaces" / "msg").glob("_[a-z]*.py")
        }

    assert installed() == {"_first"}
    (package / "msg" / "First.msg").rename(package / "msg" / "Second.msg")
    assert installed() == {"_second"}
    run(venv / "bin" / "python", folder / "setup" / "interfaces_wheel.py", tmp_path, check=True)
    (wheel,) = tmp_path.glob("contact_dynamics_interfaces-*.whl")
    with zipfile.ZipFile(wheel) as packed:
        names = packed.namelist()
        metadata = packed.read(next(name for name in names if name.endswith("/METADATA"))).decode()
    assert len(names) == len(set(names))
    for expected in (
        "contact_dynamics_interfaces/msg/_second.py",
        "contact_dynamics_interfaces/contact_dynamics_interfaces_s__rosidl_typesupport_fastrtps_c.so",
        "data/lib/libcontact_dynamics_interfaces__rosidl_typesupport_fastrtps_c.so",
        "data/share/ament_index/resource_index/packages/contact_dynamics_interfaces",
        "data/share/contact_dynamics_interfaces/msg/Second.json",
    ):
        assert any(name.endswith(expected) for name in names), expected
    # Those name folders of this machine.
    assert not {".h", ".hpp", ".cmake", ".sh"} & {Path(name).suffix for name in names}
    assert "Requires-Dist: ros-geometry-msgs==" in metadata


def links_to_all_but_ours(environment: Path, view: Path, inside: tuple[Path | str, ...]) -> None:
    """Make an environment of links to another. What is built goes into the folders inside, which are real."""
    real = {Path(), *map(Path, inside)}
    for folder in sorted(real):
        (view / folder).mkdir()
        for each in (environment / folder).iterdir():
            name = folder / each.name
            if (
                name not in real
                and each.name not in ("ament_index", "build")
                and "contact_dynamics" not in each.name
            ):
                (view / name).symlink_to(each)
