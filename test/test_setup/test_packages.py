# SPDX-License-Identifier: Apache-2.0
"""Both packages as ROS sees them: found by colcon, of one version, with every dependency declared."""

from __future__ import annotations

import ast
import os
import re
import shutil
import sys
import tarfile
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from catkin_pkg.changelog import CHANGELOG_FILENAME, Changelog, populate_changelog_from_rst
from catkin_pkg.package_version import get_forthcoming_label, rename_section
from catkin_pkg.packages import find_packages

from contact_dynamics.command_line import VERBS
from test_setup.programs import ROOT, SETUP, run

MANIFESTS = (ROOT / "package.xml", ROOT / "contact_dynamics_interfaces" / "package.xml")
OWN = {"contact_dynamics", "msg_adapters", "benchmarks", *(path.stem for path in (ROOT / "test").iterdir())}

# Where a rosdep key is not called what is imported; None: there is no key, and pip installs it.
KEYS = {
    "catkin_pkg": "python3-catkin-pkg-modules",
    "colcon_core": "python3-colcon-common-extensions",
    "dask": None,
    "hypothesis": "python3-hypothesis",
    "lz4": "mcap-ros2-support",  # the mcap library needs it, and zstandard
    "matplotlib": None,
    "mcap": "mcap-ros2-support",
    "mcap_ros2": "mcap-ros2-support",
    "mpmath": None,
    "mypy": "python3-mypy",
    "numpy": "python3-numpy",
    "pandas": None,  # `to_frame` uses it where it is installed
    "pyarrow": None,
    "pytest": "python3-pytest",
    "rerun": None,
    "rerun_bindings": None,  # comes with rerun
    "argcomplete": "python3-argcomplete",
    "rosbags": "python3-rosbags-pip",
    "scipy": "python3-scipy",
    "trimesh": None,  # files of meshes are read where it is installed
    "typing_extensions": "python3-typing-extensions",
    "yaml": "python3-yaml",
    "zstandard": "mcap-ros2-support",
}

ONLY_IN_PIP = {"mcap-ros2-support", "python3-rosbags-pip"}
"""Keys whose packages ROS's build farm does not have."""

EVALUATION = ("dask", "matplotlib", "pyarrow")
"""What the options of `contact-dynamics evaluate` need, each the one that says so."""


@cache
def imported(folder: str) -> tuple[set[str], set[str]]:
    """The modules from elsewhere that a folder's Python imports, and those that its tests can do without."""
    needed, optional = set(), set()
    for path in (ROOT / folder).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                needed |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
                needed.add(node.module)
            elif isinstance(node, ast.Call) and ast.unparse(node.func) == "pytest.importorskip":
                optional |= {str(name.value) for name in node.args if isinstance(name, ast.Constant)}
    known = sys.stdlib_module_names | OWN
    return {name.split(".")[0] for name in needed} - known, {name.split(".")[0] for name in optional} - known


def keys(modules: set[str]) -> set[str]:
    """The rosdep keys that stand for modules."""
    return {key for key in (KEYS.get(module, module) for module in modules) if key}


def declared(tag: str) -> set[str]:
    """The dependencies of one kind in package.xml."""
    return {element.text or "" for element in ET.parse(MANIFESTS[0]).getroot().findall(tag)}


def test_package_xml_declares_what_the_packages_import_and_nothing_else() -> None:
    needed = set().union(*(imported(folder)[0] for folder in ("contact_dynamics", "msg_adapters", "launch")))
    assert keys(needed) == declared("exec_depend")


def test_package_xml_declares_what_the_tests_import_beside_and_nothing_else() -> None:
    needed, optional = imported("test")
    run = declared("exec_depend")
    # This file starts colcon as a program.
    assert keys(needed | {"colcon_core"}) - run <= declared("test_depend")
    assert declared("test_depend") <= keys(needed | optional | {"colcon_core"}) - run


def test_what_has_no_rosdep_key_is_named_beside_the_keys() -> None:
    text = MANIFESTS[0].read_text(encoding="utf-8")
    needed = set().union(*(imported(folder)[0] for folder in ("contact_dynamics", "test")))
    assert {module for module in needed if KEYS.get(module, module) is None} == {
        *("mpmath", "pandas", "rerun", "rerun_bindings", "trimesh"),
        *EVALUATION,
    }
    assert "rerun-sdk" in text
    assert "requirements/evaluate.txt" in text
    listed = (ROOT / "requirements" / "evaluate.txt").read_text(encoding="utf-8")
    assert all(module in listed for module in EVALUATION)
    assert "pip install mpmath" in text


def test_both_packages_have_one_version_and_one_maintainer() -> None:
    roots = [ET.parse(path).getroot() for path in MANIFESTS]
    versions = {root.findtext("version") for root in roots}
    emails = {element.get("email") for root in roots for element in root.findall("maintainer")}
    assert len(versions) == 1
    assert len(emails) == 1
    # colcon silently takes a package whose maintainer has no valid address for plain Python.
    assert re.fullmatch(r"[-\w.%+]+@[-\w.]+\.[a-zA-Z]{2,}", emails.pop() or "")


@pytest.mark.filterwarnings("ignore:nodes.Node.traverse:DeprecationWarning")  # which catkin_pkg calls
@pytest.mark.parametrize("manifest", MANIFESTS, ids=lambda path: path.parent.name)
def test_each_package_has_a_changelog_that_a_release_can_read(manifest: Path) -> None:
    text = (manifest.parent / CHANGELOG_FILENAME).read_text(encoding="utf-8")
    version = ET.parse(manifest).findtext("version")
    if label := get_forthcoming_label(text):
        # As catkin_prepare_release does.
        text = rename_section(text, label, f"{version} (2000-01-01)")
    changelog = Changelog()
    populate_changelog_from_rst(changelog, text)
    newest, _, changes = next(changelog.foreach_version(reverse=True))
    assert newest == version
    assert changes


def test_setup_py_takes_the_version_from_package_xml() -> None:
    assert described("version") == [ET.parse(MANIFESTS[0]).getroot().findtext("version")]


def described(*fields: str) -> list[str]:
    """What setup.py says of some fields of the metadata, line by line."""
    command = [sys.executable, "setup.py", "-q", *(f"--{field}" for field in fields)]
    return run(*command, cwd=ROOT, check=True).stdout.splitlines()


def test_the_metadata_describe_the_package_and_invent_nobody() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "\n".join(described("long-description")).strip() == readme.strip()
    assert "<!--" not in readme
    pythons = [f"Programming Language :: Python :: 3.{minor}" for minor in range(10, 15)]
    assert set(pythons) <= set(described("classifiers"))
    assert described("maintainer", "maintainer-email", "author", "author-email", "url") == ["None"] * 5
    # .invalid is reserved: such an address reaches nobody (RFC 2606).
    emails = [ET.parse(path).getroot().find("maintainer").get("email") for path in MANIFESTS]
    assert all(email.endswith(".invalid") for email in emails)


@pytest.mark.parametrize(
    ("plain", "suffixes"),
    [("1", {".py", ".pxd"}), pytest.param("", {".py", ".pxd", ".so"}, marks=pytest.mark.slow)],
)
def test_an_sdist_holds_the_project_and_installs(tmp_path: Path, plain: str, suffixes: set[str]) -> None:
    """To compile the core takes a minute. What it is compiled from is what `make setup` compiles."""
    listed = run("git", "ls-files", "--cached", "--others", "--exclude-standard", cwd=ROOT)
    if listed.returncode:
        pytest.skip("NOT RUN: what git has cannot be compared with, because this is no clone")
    files = {name for name in listed.stdout.splitlines() if (ROOT / name).exists()}
    checkout = tmp_path / "a checkout"
    for name in files:
        (checkout / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, checkout / name)
    run(sys.executable, "setup.py", "-q", "sdist", "--formats=gztar", cwd=checkout, check=True)
    (archive,) = (checkout / "dist").iterdir()
    with tarfile.open(archive) as packed:
        assert files - {name.partition("/")[2] for name in packed.getnames()} == set()
        metadata = packed.extractfile(f"{packed.getnames()[0]}/PKG-INFO")
        assert metadata is not None
        # The server without its interfaces, or with those of another version, would not start.
        version = re.escape(ET.parse(MANIFESTS[0]).findtext("version") or "")
        pin = rf'^Requires-Dist: contact_dynamics_interfaces=={version}; extra == "jazzy"$'
        assert re.search(pin, metadata.read().decode(), re.MULTILINE)
    installed = tmp_path / "installed"
    install = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation"]
    install += ["--no-index", "--no-compile", "--target", str(installed), str(archive)]
    done = run(*install, env={**os.environ, "CONTACT_DYNAMICS_PLAIN": plain})
    assert done.returncode == 0, done.stderr
    program = "import contact_dynamics.command_line as c; print(c.__file__); c.main(['--help'])"
    found = {**os.environ, "PYTHONPATH": str(installed)}
    answer = run(sys.executable, "-c", program, cwd=tmp_path, env=found)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.startswith(str(installed))
    assert "usage: contact-dynamics" in answer.stdout
    assert (installed / "contact_dynamics" / "measured" / "tosses" / "brick.csv").exists()
    assert (installed / "share" / "contact_dynamics" / "config" / "server.yaml").exists()
    core = (installed / "contact_dynamics" / "impact" / "spatial").glob("path.*")
    assert {file.suffix for file in core} == suffixes


def colcon_list(folder: Path, *options: str) -> list[str]:
    """The lines that `colcon list` prints in a folder, where it leaves no log."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("COLCON_")}
    program = "from colcon_core.command import main; raise SystemExit(main())"
    environment["COLCON_LOG_PATH"] = os.devnull
    command = (sys.executable, "-c", program, "list", *options)
    return run(*command, cwd=folder, env=environment, check=True).stdout.splitlines()


def test_colcon_finds_both_packages_from_the_root() -> None:
    before = set(ROOT.glob("log*"))
    assert [line.split("\t") for line in colcon_list(ROOT)] == [
        ["contact_dynamics", ".", "(ros.ament_python)"],
        ["contact_dynamics_interfaces", "contact_dynamics_interfaces", "(ros.ament_cmake)"],
    ]
    # `make clean` leaves that folder alone, because it may be a user's.
    assert set(ROOT.glob("log*")) == before


def test_both_packages_of_a_release_are_found_and_need_nothing_that_pip_alone_has(tmp_path: Path) -> None:
    done = run(SETUP / "release_trees.sh", tmp_path)
    if "not a git repository" in done.stderr:
        pytest.skip("NOT RUN: a release is made of the last commit, and this is no clone")
    assert done.returncode == 0, done.stderr
    packages = find_packages(tmp_path)
    assert set(packages) == {"contact_dynamics", "contact_dynamics_interfaces"}
    for name, package in packages.items():
        assert all((tmp_path / name / text.file).exists() for text in package.licenses)
        needed = {each.name for each in (*package.exec_depends, *package.test_depends)}
        whole = {"contact_dynamics": declared("exec_depend") | declared("test_depend")}.get(name, needed)
        assert whole - needed <= ONLY_IN_PIP
        assert needed.isdisjoint(ONLY_IN_PIP)


def paths_of_quick_start(command: str) -> list[list[str]]:
    """The folders that the quick start names in each line that begins so."""
    page = (ROOT / "docs" / "quick-start-ros.md").read_text(encoding="utf-8")
    lines = re.findall(rf"^{command} ([^-\n]*)", page, re.MULTILINE)
    return [line.split() for line in lines]


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A workspace with the project in src/."""
    for manifest in MANIFESTS:
        copy = tmp_path / "src" / "contact_dynamics" / manifest.relative_to(ROOT)
        copy.parent.mkdir(parents=True)
        shutil.copy(manifest, copy)
    return tmp_path


def test_rosdep_finds_both_packages_in_the_folders_that_the_quick_start_names(workspace: Path) -> None:
    named = paths_of_quick_start("rosdep install --from-paths")
    assert len(named) == 2
    for folder, paths in zip((workspace, workspace / "src" / "contact_dynamics"), named, strict=True):
        # What rosdep asks; it looks no further below a folder that is a package.
        found = [package.name for path in paths for package in find_packages(folder / path).values()]
        assert sorted(found) == ["contact_dynamics", "contact_dynamics_interfaces"], paths


def test_colcon_finds_both_packages_from_the_root_of_a_workspace(workspace: Path) -> None:
    (paths,) = paths_of_quick_start("colcon build --base-paths")
    found = colcon_list(workspace, "--names-only", "--base-paths", *paths)
    assert found == ["contact_dynamics", "contact_dynamics_interfaces"]


def test_every_ros_wheel_is_pinned_where_what_it_pulls_in_is() -> None:
    constraints = set((ROOT / "requirements" / "constraints.txt").read_text(encoding="utf-8").split("\n"))
    pins = set()
    for kind in ("jazzy", "build"):
        lines = (ROOT / "requirements" / f"{kind}.txt").read_text(encoding="utf-8").splitlines()
        pins |= {re.sub(r"\[\w+\]", "", line) for line in lines if line.startswith(("ros-", "catkin"))}
    assert pins
    assert pins <= constraints


def test_ros2_run_finds_an_executable_for_each_verb() -> None:
    """They are one file, which runs the verb that it is called by."""
    executables = list((ROOT / "executables").iterdir())
    assert {path.name for path in executables} == set(VERBS)
    assert all(os.access(path, os.X_OK) for path in executables)
    assert {path.resolve() for path in executables} == {ROOT / "executables" / "server"}
    path = {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    answer = run(sys.executable, ROOT / "executables" / "replay", "--help", env=os.environ | path)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.startswith("usage: contact-dynamics replay ")


def test_launch_files_start_executables_that_there_are() -> None:
    for path in (ROOT / "launch").glob("*.launch.py"):
        started = re.findall(r'executable="(\w+)"', path.read_text(encoding="utf-8"))
        assert set(started) <= set(VERBS), path.name
        included = re.findall(r'"launch" / "([\w.]+)"', path.read_text(encoding="utf-8"))
        configured = re.findall(r'"([\w.]+\.yaml)"', path.read_text(encoding="utf-8"))
        assert all((ROOT / "launch" / name).exists() for name in included), path.name
        assert all((ROOT / "config" / name).exists() for name in configured), path.name
        assert started or included, path.name
