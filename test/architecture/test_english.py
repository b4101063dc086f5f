# SPDX-License-Identifier: Apache-2.0
"""Habits of our texts that are hard to read, as far as a program can see them, and what texts name.

No text begins with "Of", and none says "likewise": both say nothing without the text before them. No text has
a telegram such as "None: not asked for" in the place of a sentence. What a docstring or a comment of the
package names in backticks exists. Ruff sees to the first word of functions' docstrings (D401).
"""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from architecture.test_chapters import ROOT
from sweeps import each

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
DANGLING = re.compile(r"[Oo]f\b|[Ll]ikewise\b")
LIKEWISE = re.compile(r"\b[Ll]ikewise\b")
TELEGRAM = re.compile(
    r"(?:^|[.;] |\()((?:None|Zero|Empty|True|False|NaN|Infinite|Nothing|none|zero|empty)(?: or \w+)?: )",
    re.MULTILINE,
)
"""A value and a colon where a sentence begins. Fields are documented as `name: text`, by no such name."""
STRINGS = {tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)}
"""From Python 3.12 on, what stands in an f-string is a token of its own."""
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


@cache
def texts_of(path: Path) -> list[str]:
    source = path.read_text(encoding="utf-8")
    return list(texts_of_python(source) if path.suffix == ".py" else texts_of_comments(source))


@each("path", [*PYTHON, *COMMENTED])
def test_no_text_begins_with_a_dangling_word(path: Path) -> None:
    assert [text.splitlines()[0] for text in texts_of(path) if DANGLING.match(text)] == []


@each("path", [*PYTHON, *COMMENTED])
def test_no_text_is_a_telegram(path: Path) -> None:
    texts = texts_of(path)
    assert [found for text in texts for found in (*TELEGRAM.findall(text), *LIKEWISE.findall(text))] == []


@pytest.mark.parametrize("text", ["m. None: no limit.", "How many. Zero or less: all.", "A set (None: all)."])
def test_a_telegram_is_seen(text: str) -> None:
    assert TELEGRAM.search(text)


@pytest.mark.parametrize("text", ["None means no limit.", "Whether it holds: then it ends.", "x or None."])
def test_a_sentence_is_no_telegram(text: str) -> None:
    assert not TELEGRAM.search(text)


@pytest.mark.parametrize(
    "source",
    [
        '"""Of contacts."""',
        'X = 1\n"""Likewise."""',
        "# Of the body.",
        "x = 1  # of the body",
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
            elif token.type in STRINGS and token.start[0] not in texts:
                found.update(re.findall(r"\w+", token.string))
    return found


@each("path", PACKAGE)
def test_what_a_text_names_exists(path: Path, names: set[str]) -> None:
    texts = " ".join(texts_of(path))
    assert [name for name in NAMED.findall(texts) if not names.issuperset(name.split("."))] == []
