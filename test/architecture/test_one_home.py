# SPDX-License-Identifier: Apache-2.0
"""One home for each thing: thresholds in `tolerances.py`, nanoseconds in `constants.py`."""

from __future__ import annotations

import ast
from pathlib import Path

from sweeps import each

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "contact_dynamics"

NOT_PHYSICS = {"questions", "diagrams", "recording", "viewing", "plots", "measured", "nodes", "cases", "demo"}
SOURCES = [*sorted(PACKAGE.rglob("*.py")), *sorted((ROOT / "msg_adapters").glob("*.py"))]
PHYSICS = [
    path
    for path in SOURCES
    if path.is_relative_to(PACKAGE) and path.relative_to(PACKAGE).parts[0] not in NOT_PHYSICS
]

SMALL = 1e-2
"""A written number that is positive and no larger is taken for a threshold."""

ALLOWED = {
    "constants.py": {1e-9},  # a nanosecond
    "numerics/arithmetic.py": {1e-16, 1e-8, 1e-2, 1e-100, 1e-19, 3e-3},  # the digits of each kind of number
}
"""Small numbers that are no thresholds. The list may only become shorter."""


def written_numbers(path: Path) -> set[float]:
    """Return the floats that a file writes out, also as the text of a decimal or a power of two of them."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, float):
            found.add(node.value)
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == "Decimal":
            found.update(float(text.value) for text in node.args if isinstance(text, ast.Constant))
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            try:
                found.add(float(ast.literal_eval(node.left)) ** float(ast.literal_eval(node.right)))
            except ValueError:  # not of two written numbers
                continue
    return found


def relative(path: Path) -> str:
    """What pytest shows."""
    return str(path.relative_to(PACKAGE))


@each("path", [p for p in PHYSICS if p.name != "tolerances.py"])
def test_small_numbers_are_thresholds_and_those_stand_in_one_file(path: Path) -> None:
    small = {number for number in written_numbers(path) if 0.0 < number <= SMALL}
    allowed = ALLOWED.get(relative(path), set())
    assert small == allowed, f"{small - allowed} belong in tolerances.py; no longer here: {allowed - small}"


def test_every_threshold_says_why_and_is_used() -> None:
    tree = ast.parse((PACKAGE / "tolerances.py").read_text(encoding="utf-8"))
    used = {
        node.id
        for path in SOURCES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
    }
    names = []
    for node, follows in zip(tree.body, [*tree.body[1:], None], strict=True):
        if isinstance(node, ast.AnnAssign):
            assert isinstance(node.target, ast.Name)
            assert isinstance(follows, ast.Expr), f"{node.target.id}: no text below it that says why"
            names.append(node.target.id)
    assert len(names) > 70
    assert set(names) <= used, set(names) - used


def test_nanoseconds_and_seconds_meet_in_one_file() -> None:
    for path in SOURCES:
        if path == PACKAGE / "constants.py":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            assert not (isinstance(node, ast.Constant) and node.value in {10**9, 1e9}), str(path)
