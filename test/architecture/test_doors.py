# SPDX-License-Identifier: Apache-2.0
"""What users see: a first page, and chapters that say what is in them."""

from __future__ import annotations

import ast
import importlib
import inspect
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import contact_dynamics
from contact_dynamics.shapes import convex
from sweeps import each

CHAPTERS = (
    "rigid_body",
    "rigid_body.inertia",
    "tumbling",
    "motion",
    "shapes",
    "contact",
    "plane",
    "landing",
    "contact_modes",
    "impact",
    "toss",
    "questions",
)
MAX_ON_THE_FIRST_PAGE = 40
"""The functions of the table of questions in docs/api.md, the types that they take, and few others."""


def door(chapter: str) -> ModuleType:
    return importlib.import_module(f"contact_dynamics.{chapter}")


def test_the_first_page_is_short() -> None:

    first = [
        name
        for name in contact_dynamics.__all__
        if not isinstance(getattr(contact_dynamics, name), ModuleType)
    ]
    assert len(first) <= MAX_ON_THE_FIRST_PAGE
    chapters = {chapter.rpartition(".")[2] for chapter in CHAPTERS}
    assert {*first, *chapters} == set(contact_dynamics.__all__)


@each("chapter", ["", *CHAPTERS])
def test_completion_shows_what_is_for_users(chapter: str) -> None:
    module = door(chapter) if chapter else contact_dynamics
    assert set(dir(module)) - {"__version__"} == set(module.__all__)
    assert all(hasattr(module, name) for name in module.__all__)


@each("chapter", CHAPTERS)
def test_no_name_hides_a_file(chapter: str) -> None:
    """`import contact_dynamics.x.y as m` gives the file, not a function of its name."""
    module = door(chapter)
    folder = Path(module.__file__ or "").parent
    files = {path.stem for path in folder.glob("*.py")} | {path.parent.name for path in folder.glob("*/*.py")}
    for name in files & set(vars(module)) - {"__init__"}:
        assert isinstance(getattr(module, name), ModuleType), name


@each("chapter", CHAPTERS)
def test_a_chapters_page_names_its_files(chapter: str) -> None:
    """Every file and folder of it stands in its docstring, and nothing that is no longer there."""
    module = door(chapter)
    folder = Path(module.__file__ or "").parent
    page = ast.get_docstring(ast.parse(Path(module.__file__ or "").read_text(encoding="utf-8"))) or ""
    for path in folder.iterdir():
        if path.stem not in {"__init__", "__pycache__"} and (path.suffix == ".py" or path.is_dir()):
            assert f"`{path.stem}`" in page, f"{chapter}: {path.stem}"


def test_a_name_means_one_thing() -> None:
    """What two pages show is the same object, but for shapes: a box of mass, and the shape of a box."""
    seen: dict[str, object] = {}
    for chapter in CHAPTERS:
        module = door(chapter)
        for name in module.__all__:
            if chapter != "shapes":
                assert seen.setdefault(name, getattr(module, name)) is getattr(module, name), name
    # A chapter that is called as its function of the same name is not that function.
    chapters = {chapter.rpartition(".")[2] for chapter in CHAPTERS}
    for name in set(contact_dynamics.__all__) - chapters:
        assert seen.get(name, getattr(contact_dynamics, name)) is getattr(contact_dynamics, name), name


def test_a_chapter_with_a_function_of_its_name_is_called_as_it() -> None:
    """Both spellings work, and everything else of the chapter is still there."""
    for chapter in CHAPTERS:
        module = door(chapter)
        function = vars(module).get(chapter)
        if inspect.isfunction(function):
            assert chapter in {"contact_modes", "toss"}
            called = getattr(contact_dynamics, chapter)
            assert inspect.signature(called) == inspect.signature(function)
            gist, more = inspect.getdoc(function).split("\n\n", 1)
            call = f"{chapter}{inspect.signature(function)}".replace("'", "")
            help_text, _, others = inspect.getdoc(called).partition(" Other public names are:\n")
            assert help_text.startswith(f"{gist}\n\n{call}\n\n{more}\n\n"), "help shows the call first"
            assert "The modules under PACKAGE CONTENTS are internal." in help_text
            assert others.replace("\n", " ").split(", ") == [n for n in module.__all__ if n != chapter]
            assert sys.modules[f"contact_dynamics.{chapter}"] is called
            with pytest.raises(TypeError, match=r"^(body|problem) must be a "):
                called(*["no question"] * sum(one.default is one.empty for one in _parameters(function)))
        else:
            assert not callable(module), chapter


def _parameters(function: Any) -> Iterable[inspect.Parameter]:
    return inspect.signature(function).parameters.values()


def test_every_shape_stands_on_its_chapters_page() -> None:
    """A function that makes a shape is found by who looks for it where all others are."""
    makers = {
        name
        for name, made in vars(convex).items()
        if not name.startswith("_") and inspect.isfunction(made) and made.__module__ == convex.__name__
    }
    assert {"box", "rounded", "sphere"} <= makers
    assert makers <= {*door("shapes").__all__}


def test_the_whole_library_is_imported_without_scipy() -> None:
    """Its import takes longer than all of ours."""
    code = "import sys, contact_dynamics; sys.exit('scipy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_server_begins_without_what_few_of_its_services_need() -> None:
    """It imports contact modes and tosses when it already answers, which they would delay by a fifth."""
    code = "import sys, contact_dynamics.nodes.server; "
    code += "sys.exit(any(f'contact_dynamics.{each}' in sys.modules for each in ('contact_modes', 'toss')))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
