# SPDX-License-Identifier: Apache-2.0
"""What texts and the page on the architecture name exists, and the page names every chapter."""

from __future__ import annotations

import ast
import io
import re
import tokenize

from architecture.test_chapters import CHAPTERS, PACKAGE, ROOT
from sweeps import each

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
NAMED = sorted(set(re.findall(r"`([a-z_]+(?:/[a-z_]*)*(?:\.(?:py|yaml))?)`", PAGE)))
PATHS = [name for name in NAMED if "/" in name or "." in name]
ANYWHERE = {"answer.py", "problem.py", "margins.py", "statics.py", "wrench_sets.py", "result.py"} | {
    "one_contact.py",
    "batch.py",
    "body.py",
    "one.py",
    "many.py",
}
"""Names of files that stand in several folders, or in the folder that their row is about."""


@each("path", PATHS)
def test_what_the_page_names_exists(path: str) -> None:
    if path in ANYWHERE:
        assert list(PACKAGE.rglob(path)), path
        return
    parents = [ROOT, PACKAGE, *(PACKAGE / chapter for chapter in ("rigid_body", "impact", "contact_modes"))]
    assert any((parent / path).exists() for parent in parents), path


def test_the_page_names_every_chapter() -> None:
    for chapter in CHAPTERS:
        if not chapter.startswith("__"):
            assert re.search(rf"`{chapter}(/|\.py)?`|`{chapter[:10]}\*?\.py`", PAGE), chapter


def test_the_page_finds_more_than_a_few_paths() -> None:
    assert len(PATHS) > 25


FOLDERS = ("contact_dynamics", "msg_adapters", "benchmarks", "examples", "launch", "scripts")
PYTHON = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))
INTERFACES = sorted((ROOT / "contact_dynamics_interfaces").glob("*/*.[ms]*"))
QUOTED = re.compile(r"(?<!`)`([A-Za-z_]\w*(?:\.\w+)*)`(?!`)")
STRINGS = {tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)}
"""From Python 3.12 on, what stands in an f-string is a token of its own."""


def texts_and_names(source: str) -> tuple[str, set[str]]:
    """The docstrings and comments, and all names and words of other strings."""
    statements = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Expr)]
    docs = {node.lineno: node.value for node in statements if isinstance(node.value, ast.Constant)}
    texts, names = [str(doc.value) for doc in docs.values()], set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            texts.append(token.string)
        elif token.type == tokenize.NAME or (token.type in STRINGS and token.start[0] not in docs):
            names.update(re.findall(r"\w+", token.string))
    return "\n".join(texts), names


def test_what_a_text_names_exists() -> None:
    names = {word for path in INTERFACES for word in re.findall(r"\w+", path.read_text(encoding="utf-8"))}
    told: dict[str, str] = {}
    for path in PYTHON:
        text, found = texts_and_names(path.read_text(encoding="utf-8"))
        names |= found | {part.partition(".")[0] for part in path.parts}
        if path.is_relative_to(ROOT / "contact_dynamics"):
            told |= {name: str(path) for name in QUOTED.findall(text)}
    assert len(told) > 300
    assert {name: path for name, path in told.items() if not names.issuperset(name.split("."))} == {}
