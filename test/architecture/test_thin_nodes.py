# SPDX-License-Identifier: Apache-2.0
"""Nodes keep parameters, subscriptions, clock and log; a question has types all the way to its response."""

from __future__ import annotations

import ast
from pathlib import Path

from architecture.test_chapters import PACKAGE, ROOT, imports_of, relative
from sweeps import each

NODES = sorted((PACKAGE / "nodes").glob("*.py"))
WAY = [
    *sorted((ROOT / "msg_adapters").glob("*.py")),
    *sorted((PACKAGE / "questions").glob("*.py")),
]
"""Where a request goes, and where its answer comes back."""


@each("path", NODES)
def test_nodes_do_no_arithmetic(path: Path) -> None:
    roots = {module.split(".")[0] for module in imports_of(path)}
    assert not roots & {"numpy", "scipy"}, relative(path)


@each("path", WAY)
def test_no_any_on_the_way_of_a_question(path: Path) -> None:
    """Strict mypy follows a request to its response, as far as ROS's own messages have types."""
    names = {
        node.id
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Name)
    }
    assert "Any" not in names, relative(path)
