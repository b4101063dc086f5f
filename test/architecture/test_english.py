"""How texts in the sources begin, and what they name.

No text begins with "Of" or "Likewise", which says nothing without the text before it. What a docstring or a
comment of the package names in backticks exists.
"""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

from architecture.test_chapters import ROOT

FOLDERS = ("contact_dynamics", "msg_adapters", "benchmarks", "examples", "launch", "scripts")
PYTHON = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))
COMMENTED = sorted(
    path
    for pattern in (
        "contact_dynamics_interfaces/*/*.msg",
        "contact_dynamics_interfaces/*/*.srv",
        "config/*.yaml",
    )
    for path in ROOT.glob(pattern)
)
INTERFACES = sorted((ROOT / "contact_dynamics_interfaces").glob("*/*.[ms]*"))
PACKAGE = [path for path in PYTHON if "contact_dynamics" in path.relative_to(ROOT).parts[:1]]
NAMED = re.compile(r"(?<!`)`([A-Za-z_]\w*(?:\.\w+)*)`(?!`)")
DANGLING = re.compile(r"(Of|Likewise)\b")
FIELD = re.compile(r"^\s+\w+: (.*)$", re.MULTILINE)
"""An entry of an `Attributes` or `Args` section."""


def comment_blocks(lines: list[tuple[int, str]]) -> Iterator[str]:
    """The first line of each comment that does not continue the line above it."""
    for (before, _), (number, text) in zip([(-1, ""), *lines], lines, strict=False):
        if number != before + 1:
            yield text


def texts_of_python(source: str) -> Iterator[str]:
    """Docstrings, also those of constants, the entries of their sections, and comments."""
    for node in ast.walk(ast.parse(source)):
        if (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            yield node.value.value
            yield from FIELD.findall(node.value.value)
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    comments = [
        (token.start[0], token.string.lstrip("# ")) for token in tokens if token.type == tokenize.COMMENT
    ]
    yield from comment_blocks(comments)


def texts_of_comments(source: str) -> Iterator[str]:
    """Comments of a file whose comments begin with `#`."""
    lines = list(enumerate(source.splitlines()))
    yield from comment_blocks([(i, line.split("#", 1)[1].lstrip("# ")) for i, line in lines if "#" in line])


@pytest.mark.parametrize("path", [*PYTHON, *COMMENTED], ids=lambda path: str(path.relative_to(ROOT)))
def test_no_text_begins_with_a_dangling_word(path: Path) -> None:
    source = path.read_text(encoding="utf-8")
    texts = texts_of_python(source) if path.suffix == ".py" else texts_of_comments(source)
    assert [text.splitlines()[0] for text in texts if DANGLING.match(text)] == []


@pytest.mark.parametrize(
    "source",
    [
        '"""Of contacts."""',
        'X = 1\n"""Likewise."""',
        "# Of the body.",
        '"""A.\n\n    Attributes:\n        a: Of b.\n"""',
    ],
)
def test_a_dangling_word_is_seen(source: str) -> None:
    assert any(DANGLING.match(text) for text in texts_of_python(source))


def test_words_that_only_begin_alike_and_later_lines_are_fine() -> None:
    assert not any(DANGLING.match(text) for text in texts_of_python("# Offsets are\n# Of use.\n"))


def is_text(node: ast.AST) -> bool:
    """Whether a statement is a docstring, of whatever it may be."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


@pytest.fixture(scope="module")
def names() -> set[str]:
    """All names and all words of strings in the code, without its docstrings and comments, and its files."""
    found = {word for path in INTERFACES for word in re.findall(r"\w+", path.read_text(encoding="utf-8"))}
    for path in PYTHON:
        source = path.read_text(encoding="utf-8")
        texts = {node.lineno for node in ast.walk(ast.parse(source)) if is_text(node)}
        found |= {part.partition(".")[0] for part in path.parts}
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            if token.type == tokenize.NAME:
                found.add(token.string)
            elif token.type == tokenize.STRING and token.start[0] not in texts:
                found.update(re.findall(r"\w+", token.string))
    return found


@pytest.mark.parametrize("path", PACKAGE, ids=lambda path: str(path.relative_to(ROOT)))
def test_what_a_text_names_exists(path: Path, names: set[str]) -> None:
    texts = " ".join(texts_of_python(path.read_text(encoding="utf-8")))
    assert [name for name in NAMED.findall(texts) if not names.issuperset(name.split("."))] == []
