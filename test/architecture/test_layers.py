# SPDX-License-Identifier: Apache-2.0
"""The physics knows nothing of ROS, and adapters know messages only.  `test_chapters` has the order."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from architecture.test_chapters import PACKAGE, ROOT, WITHOUT_ROS, imports_of, relative
from sweeps import each

ROS = {
    "rclpy",
    "rcl_interfaces",
    "geometry_msgs",
    "nav_msgs",
    "std_msgs",
    "builtin_interfaces",
    "service_msgs",
    "contact_dynamics_interfaces",
    "launch",
    "launch_ros",
    "ament_index_python",
}


LIBRARY = sorted(
    path
    for path in PACKAGE.rglob("*.py")
    if path.relative_to(PACKAGE).with_suffix("").parts[0] in WITHOUT_ROS
)
"""The files of the physics, of questions, and of what both stand on."""

IMPORT_PATH = re.compile(r"[\w.]+:[\w.]+")
WORDS_OF_ROS = re.compile(
    r"~/|header\.|\b(parameters?|topics?|services?|requests?|configured|server|node)\b"
    r"|\b(STATE|CONTACTS|GRAVITY|AT|UNTIL)_[A-Z]+|SEQUENTIAL_IN_TIME|_source\b"
)


@each("path", sorted((ROOT / "msg_adapters").glob("*.py")))
def test_adapters_know_messages_and_no_middleware(path: Path) -> None:
    assert not {module for module in imports_of(path) if module.split(".")[0] == "rclpy"}, relative(path)


def test_physics_imports_without_ros(tmp_path: Path) -> None:
    """With every ROS package made unimportable, the physics and its table of contents import."""
    blocked = "".join(f"sys.modules[{name!r}] = None\n" for name in sorted(ROS))
    use = "import contact_dynamics\nfor name in contact_dynamics.__all__: getattr(contact_dynamics, name)\n"
    code = f"import sys\n{blocked}{use}"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert result.returncode == 0, result.stderr


def words_said(source: str) -> list[str]:
    """All strings of a file but its docstrings and import paths: what its errors and answers say."""
    tree = ast.parse(source)
    documents = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and node not in documents
        and not IMPORT_PATH.fullmatch(node.value)
    ]


@each("path", LIBRARY)
def test_errors_of_the_library_are_not_in_the_words_of_ros(path: Path) -> None:
    """Who asks in Python has no service, no request and no parameter to look for."""
    said = words_said(path.read_text(encoding="utf-8"))
    assert [text for text in said if WORDS_OF_ROS.search(text)] == []


@pytest.mark.parametrize("text", ["(parameter state_timeout)", "~/predict_impact says", "STATE_EXPLICIT (1)"])
def test_a_word_of_ros_is_seen(text: str) -> None:
    assert WORDS_OF_ROS.search(text)
