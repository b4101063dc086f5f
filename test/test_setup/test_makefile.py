# SPDX-License-Identifier: Apache-2.0
"""What `make` does a second time: nothing, unless an input changed, and then what depends on it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUILD = "build"

# Stands for setup/make_venv.sh, with an environment whose programs only write down what they were asked for.
MAKE_VENV = """#!/bin/sh
[ -e "$1/.made/python" ] && exit 0
mkdir -p "$1/bin" "$1/lib" "$1/.made"
cat >"$1/bin/python" <<END
#!/bin/sh
echo "\\$*" >>"$PWD/calls"
END
cat >"$1/bin/contact-dynamics" <<END
#!/bin/sh
echo "contact-dynamics \\$*" >>"$PWD/calls"
env >"$PWD/environment"
END
chmod +x "$1/bin/python" "$1/bin/contact-dynamics"
touch "$1/.made/python"
"""


class Checkout:
    """A copy of what the Makefile looks at, with programs that only write down that they were called."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.output = ""
        for name in ("requirements", "cmake", "resource", "executables"):
            shutil.copytree(ROOT / name, folder / name)
        for name in ("Makefile", "setup.py", "package.xml", "pyproject.toml"):
            shutil.copy(ROOT / name, folder)
        (folder / "setup").mkdir()
        for name in ("setup/install.sh", "setup/clean.sh"):
            shutil.copy(ROOT / name, folder / "setup")
        for name in ("config/server.yaml", "launch/server.launch.py"):
            self.write(name)
        for name in ("CMakeLists.txt", "package.xml", "msg/One.msg", "msg/Two.msg", "srv/Ask.srv"):
            self.write(f"contact_dynamics_interfaces/{name}")
        self.write("setup/make_venv.sh", MAKE_VENV).chmod(0o755)
        self.write("setup/build_interfaces.sh", f"#!/bin/sh\necho {BUILD} >>calls").chmod(0o755)
        # As in a checkout that has lain for a while: nothing is newer than what make is going to make.
        self.age(folder.rglob("*"), seconds=100)

    def age(self, paths: Iterable[Path], *, seconds: float) -> None:
        """Make files older, all to one time."""
        then = time.time() - seconds
        for path in paths:
            os.utime(path, (then, then))

    def write(self, name: str, text: str = "") -> Path:
        """Write one file of the checkout."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def make(self, *arguments: str, **environment: str) -> list[str]:
        """Run make, and return the steps that did something, each by what it called."""
        calls = self.folder / "calls"
        calls.unlink(missing_ok=True)
        self.output = subprocess.run(
            ["make", *arguments],
            cwd=self.folder,
            # Not those of a make that runs this test.
            env={name: value for name, value in os.environ.items() if "MAKE" not in name} | environment,
            stdout=subprocess.PIPE,
            text=True,
            check=True,
            timeout=300,
        ).stdout
        return calls.read_text(encoding="utf-8").splitlines() if calls.exists() else []


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    """A checkout in which `make setup` was run, in a folder whose name a shell would take apart."""
    folder = tmp_path / "Bob's work (new) & more"
    folder.mkdir()
    made = Checkout(folder)
    assert len(made.make("setup")) == 3
    # What a test changes is then newer by more than a clock tick.
    made.age((folder / ".venv" / ".made").iterdir(), seconds=50)
    return made


def kinds(steps: list[str]) -> list[str]:
    """What each step was: the wheels, the interfaces or the package."""
    names = {"jazzy.txt": "wheels", "--editable": "package", "test.txt": "test", BUILD: "interfaces"}
    return [next(name for key, name in names.items() if key in step) for step in steps]


def test_the_second_call_does_nothing(checkout: Checkout) -> None:
    assert checkout.make("setup") == []


@pytest.mark.parametrize(
    ("changed", "steps"),
    [
        ("contact_dynamics_interfaces/msg/One.msg", ["interfaces"]),
        ("contact_dynamics_interfaces/msg/New.msg", ["interfaces"]),
        ("contact_dynamics_interfaces/srv/Ask.srv", ["interfaces"]),
        ("contact_dynamics_interfaces/CMakeLists.txt", ["interfaces"]),
        ("cmake/wheel_paths.cmake", ["interfaces"]),
        ("package.xml", ["package"]),
        ("setup.py", ["package"]),
        ("config/another.yaml", ["package"]),
        ("requirements/core.txt", ["interfaces", "package", "wheels"]),
        ("requirements/constraints.txt", ["interfaces", "package", "wheels"]),
        ("requirements/bench.txt", []),
    ],
)
def test_a_change_is_followed_by_what_depends_on_it(
    checkout: Checkout, changed: str, steps: list[str]
) -> None:
    checkout.write(changed, "changed")
    assert sorted(kinds(checkout.make("setup"))) == steps
    assert checkout.make("setup") == []


@pytest.mark.parametrize(("minor", "checked"), [(10, False), (11, True), (14, True)])
def test_types_are_checked_where_numpys_own_serve(checkout: Checkout, minor: int, *, checked: bool) -> None:
    pretence = f"import sys; sys.version_info = (3, {minor}, 1)"
    for program, text in (
        ("python", f'[ "$1" != -c ] || exec "{sys.executable}" -c "{pretence}\n$2"'),
        ("mypy", "echo mypy >>calls"),
    ):
        checkout.write(f".venv/bin/{program}", f"#!/bin/sh\n{text}\n").chmod(0o755)
    assert checkout.make("types") == ["mypy"] * checked
    assert ("NOT CHECKED: the types" in checkout.output) is not checked


def test_an_interface_that_goes_is_noticed(checkout: Checkout) -> None:
    (checkout.folder / "contact_dynamics_interfaces" / "msg" / "Two.msg").unlink()
    assert kinds(checkout.make("setup")) == ["interfaces"]


def test_an_interface_that_changes_while_it_is_built_is_built_again(checkout: Checkout) -> None:
    interface = "contact_dynamics_interfaces/srv/Ask.srv"
    script = "setup/build_interfaces.sh"
    checkout.write(script, f"#!/bin/sh\necho {BUILD} >>calls\nsleep 0.1\necho new >{interface}\nsleep 0.1")
    checkout.write(interface, "changed")
    assert kinds(checkout.make("setup")) == ["interfaces"]
    checkout.write(script, f"#!/bin/sh\necho {BUILD} >>calls")
    checkout.age([checkout.folder / script], seconds=100)
    assert kinds(checkout.make("setup")) == ["interfaces"]
    assert checkout.make("setup") == []


def test_a_step_that_failed_is_done_again(checkout: Checkout) -> None:
    checkout.write("setup/build_interfaces.sh", "#!/bin/sh\nexit 1")
    with pytest.raises(subprocess.CalledProcessError):
        checkout.make("setup")
    checkout.write("setup/build_interfaces.sh", f"#!/bin/sh\necho {BUILD} >>calls")
    assert kinds(checkout.make("setup")) == ["interfaces"]


def test_what_ros_looks_for_is_linked_into_the_environment(checkout: Checkout) -> None:
    prefix = checkout.folder / ".venv"
    assert (prefix / "share/ament_index/resource_index/packages/contact_dynamics").exists()
    for name in ("package.xml", "config/server.yaml", "launch/server.launch.py"):
        assert (prefix / "share/contact_dynamics" / name).samefile(checkout.folder / name)
    assert os.access(prefix / "lib/contact_dynamics/server", os.X_OK)


def test_the_demo_gets_what_was_asked_for(checkout: Checkout) -> None:
    assert checkout.make("demo") == ["contact-dynamics demo"]
    asked = checkout.make("demo", "VIEW=1", "TOSS=a toss.csv")
    assert asked == ["contact-dynamics demo --view --toss a toss.csv"]


def test_a_sourced_ros_stays_outside(checkout: Checkout) -> None:
    names = ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
    checkout.make("demo", **dict.fromkeys(names, "/opt/ros/jazzy"))
    inside = (checkout.folder / "environment").read_text(encoding="utf-8")
    assert not re.search(f"^({'|'.join(names)})=", inside, flags=re.MULTILINE)


def test_an_environment_with_a_space_in_its_name_is_refused(checkout: Checkout) -> None:
    with pytest.raises(subprocess.CalledProcessError):
        checkout.make("setup", "VENV=my env")


def test_clean_removes_what_make_made(checkout: Checkout) -> None:
    checkout.make("setup", "VENV=.venv-3.13")
    for name in (
        ".pytest_cache/CACHEDIR.TAG",
        "contact_dynamics.egg-info/PKG-INFO",
        "demo_output/2026-11-22_10-00-00/parameters.yaml",
        "demo_output/2026-11-22_10-00-00/toss_publisher.txt",
    ):
        checkout.write(name)
    checkout.make("clean")
    for name in (".venv", ".pytest_cache", "contact_dynamics.egg-info", "demo_output"):
        assert not (checkout.folder / name).exists(), name
    assert (checkout.folder / ".venv-3.13").exists()
    checkout.make("clean", "VENV=.venv-3.13")
    assert not (checkout.folder / ".venv-3.13").exists()


@pytest.mark.parametrize(
    "name",
    [
        "build/work.txt",
        "install/setup.bash",
        "log/latest_build",
        "other.egg-info/PKG-INFO",
        "demo_output/mine.txt",
        "demo_output/2026-11-22_10-00-00/mine.txt",
        "an environment/bin/python",
    ],
)
def test_clean_leaves_what_make_did_not_make(checkout: Checkout, name: str) -> None:
    mine = checkout.write(name, "mine")
    checkout.make("clean")
    assert mine.read_text(encoding="utf-8") == "mine"


def test_clean_leaves_an_environment_that_make_did_not_make(checkout: Checkout) -> None:
    mine = checkout.write("my_env/bin/python", "mine")
    checkout.make("clean", "VENV=my_env")
    assert mine.exists()
    assert "my_env stays: it was not made by this Makefile" in checkout.output


def test_help_explains_every_command(checkout: Checkout) -> None:
    checkout.make()
    explained = re.findall(r"^  make ([-\w]+) +\w", checkout.output, flags=re.MULTILINE)
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    phony = re.search(r"^\.PHONY: (.*)$", makefile, flags=re.MULTILINE)
    assert phony
    assert set(explained) == set(phony[1].split()) - {"venv", "FORCE"}
