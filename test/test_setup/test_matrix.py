# SPDX-License-Identifier: Apache-2.0
"""`make test-matrix` runs the physics where there is neither ROS nor rerun nor a tool of `make test`."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

TEST = Path(__file__).parents[1]
SCRIPT = (TEST.parent / "setup" / "matrix.sh").read_text(encoding="utf-8")
BESIDE = {name for line in re.findall(r'^beside="([^"]*)"', SCRIPT, re.MULTILINE) for name in line.split()}
INSTALLED = {"hypothesis", "mcap", "mpmath", "numpy", "pytest", "scipy", "typing_extensions"}
"""What setup/matrix.sh installs."""

OWN = {"benchmarks", "contact_dynamics", *(path.stem for path in TEST.iterdir())} - {
    "running_server",
    *(BESIDE - {"architecture", "viewing"}),
}
"""Helpers of the tests. Those that are left out need ROS, or its messages, or stand in a folder that does."""


def what_it_imports(path: Path) -> set[str]:
    """Return the modules that a file imports when pytest collects it."""
    found = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
    return {name.split(".")[0] for name in found}


BESIDE_AND_HELPER = BESIDE | {"running_server.py"}
FILES = [
    path
    for path in sorted(TEST.rglob("*.py"))
    if path.relative_to(TEST).parts[0] not in BESIDE_AND_HELPER
    and str(path.relative_to(TEST)) not in BESIDE_AND_HELPER
]


def test_most_tests_are_of_the_physics() -> None:
    assert len(FILES) > 100
    assert all(name == "$beside" or (TEST / name).exists() for name in BESIDE)


def test_what_the_matrix_runs_imports_what_it_installs() -> None:
    known = INSTALLED | OWN | set(sys.stdlib_module_names)
    found = {str(path.relative_to(TEST)): what_it_imports(path) - known for path in FILES}
    assert {name: unknown for name, unknown in found.items() if unknown} == {}
