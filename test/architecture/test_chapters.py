# SPDX-License-Identifier: Apache-2.0
"""The house: chapters in the lectures' order, each importing only what stands above it in the list.

`docs/architecture.md` draws it.  An import counts wherever it stands, also inside a function or where only
the type checker follows it: it is what a reader must know to read the file.
"""

from __future__ import annotations

import ast
import sys
from functools import cache
from pathlib import Path

from sweeps import each

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "contact_dynamics"

CHAPTERS = (
    "errors",
    "constants",
    "tolerances",
    "validation_types",
    "records",
    "version",
    "validation",
    "validation_batches",
    "numerics",
    "rotations",
    "rigid_body",  # lectures 24, 25
    "tumbling",  # lecture 25
    "motion",
    "shapes",
    "world",
    "contact",
    "plane",
    "landing",
    "contact_modes",  # lecture 26
    "impact",  # lecture 27
    "toss",  # all four lectures in one motion
    "questions",
    "diagrams",
    "msg_adapters",
    "recording",
    "viewing",
    "measured",
    "nodes",
    "replay",
    "evaluation",
    "calibration",
    "monitoring",
    "plots",
    "cases",
    "demo",
    "command_line",
    "__main__",
)
WITHOUT_ROS = CHAPTERS[: CHAPTERS.index("msg_adapters")]
SIDE_BY_SIDE = {("impact", "contact_modes")}
"""Chapters of which neither needs the other."""
EXCEPTIONS: frozenset[tuple[str, str]] = frozenset()
"""Imports against the order, file and module.  The list may only become shorter, and it is empty."""


def module_of(path: Path) -> str:
    """Return the dotted name of a file, `contact_dynamics.impact.law`."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def chapter_of(module: str) -> str | None:
    """Return the chapter of a module of ours; None: another's module, or the table of contents."""
    first, *rest = module.split(".")
    if first == "msg_adapters":
        return first
    if first != "contact_dynamics" or not rest or rest[0] == "__init__":
        return None
    return rest[0]


@cache
def imports_of(path: Path) -> frozenset[str]:
    """Return all modules that a file imports, also inside functions and for types."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found.add(inner if is_ours(inner) else node.module)
    return frozenset(found)


def is_ours(module: str) -> bool:
    """Tell whether a dotted name is a file or a folder of this repository's packages."""
    path = ROOT.joinpath(*module.split("."))
    return path.with_suffix(".py").is_file() or (path / "__init__.py").is_file()


SOURCES = sorted([*PACKAGE.rglob("*.py"), *(ROOT / "msg_adapters").rglob("*.py")])
INSIDE = [path for path in SOURCES if chapter_of(module_of(path)) is not None]


def relative(path: Path) -> str:
    """What pytest shows."""
    return str(path.relative_to(ROOT))


def test_every_file_has_a_chapter() -> None:
    chapters = {chapter_of(module_of(path)) for path in INSIDE}
    assert chapters <= set(CHAPTERS), chapters - set(CHAPTERS)
    assert len(INSIDE) > 150


@each("path", INSIDE)
def test_an_import_goes_to_a_chapter_above(path: Path) -> None:
    mine = chapter_of(module_of(path))
    for module in imports_of(path):
        theirs = chapter_of(module)
        if theirs is None or (relative(path), module) in EXCEPTIONS:
            continue
        assert CHAPTERS.index(theirs) <= CHAPTERS.index(mine or ""), f"{relative(path)} imports {module}"
        assert (mine, theirs) not in SIDE_BY_SIDE, f"{relative(path)} imports {module}"


@each("path", INSIDE)
def test_nobody_asks_the_table_of_contents(path: Path) -> None:
    """Inside, names come from the file that defines them. `contact_dynamics` itself is for users."""
    assert "contact_dynamics" not in imports_of(path), relative(path)


@each("path", [p for p in INSIDE if p.name != "__init__.py"])
def test_a_file_does_not_import_its_own_chapters_door(path: Path) -> None:
    package = module_of(path).rpartition(".")[0]
    parts = package.split(".")
    doors = {".".join(parts[:n]) for n in range(2, len(parts) + 1)}
    assert not doors & imports_of(path), f"{relative(path)} imports {doors & imports_of(path)}"


def test_no_files_import_each_other_in_a_circle() -> None:
    arrows = {
        module_of(path): {module for module in imports_of(path) if is_ours(module)}
        for path in SOURCES
        if path.name != "__init__.py"
    }
    done: set[str] = set()

    def follow(module: str, way: list[str]) -> None:
        assert module not in way, " -> ".join([*way[way.index(module) :], module])
        if module in done or module not in arrows:
            return
        for further in sorted(arrows[module]):
            follow(further, [*way, module])
        done.add(module)

    for module in sorted(arrows):
        follow(module, [])


@each("path", [p for p in INSIDE if chapter_of(module_of(p)) in WITHOUT_ROS])
def test_physics_and_questions_import_numpy_scipy_and_themselves_only(path: Path) -> None:
    allowed = {"numpy", "scipy", "contact_dynamics"}
    if path.name == "records.py":
        allowed.add("pandas")  # within `to_frame`, for those who have it
    if relative(path) == "contact_dynamics/shapes/files.py":
        allowed.add("trimesh")  # for those who have meshes in files
    for module in imports_of(path):
        root = module.split(".")[0]
        assert root in allowed or root in sys.stdlib_module_names, f"{relative(path)} imports {module}"
