# SPDX-License-Identifier: Apache-2.0
"""The page of public names is what the chapters offer, in both directions."""

from __future__ import annotations

import doctest
import enum
import importlib
import inspect
import re
import subprocess
import sys
from dataclasses import fields, is_dataclass
from types import ModuleType

import pytest

import contact_dynamics
from architecture.test_doors import CHAPTERS
from contact_dynamics.records import Record
from running_server import ROOT

PAGE = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
SECTIONS = dict(
    re.findall(r"^## `contact_dynamics\.([\w.]+)`\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE)
)
ROW = re.compile(r"^\| `(\w+)(\([^`]*\))?` \| (.*) \|$", re.MULTILINE)
OFFERED = ("world", *CHAPTERS, "plots", "viewing")


def offered(chapter: str) -> dict[str, object]:
    module = importlib.import_module(f"contact_dynamics.{chapter}")
    found = {name: getattr(module, name) for name in module.__all__}
    return {name: value for name, value in found.items() if not isinstance(value, ModuleType)}


def needed(call: object) -> str:
    """The arguments without a default, those that go by name with an equals sign."""
    assert callable(call)
    parameters = [one for one in inspect.signature(call).parameters.values() if one.default is one.empty]
    return ", ".join(f"{one.name}=" if one.kind is one.KEYWORD_ONLY else one.name for one in parameters)


def test_the_page_has_a_section_for_each_chapter() -> None:
    assert set(SECTIONS) == set(OFFERED)


@pytest.mark.parametrize("chapter", OFFERED)
def test_the_page_has_every_name_and_no_other(chapter: str) -> None:
    names = [name for name, _, _ in ROW.findall(SECTIONS[chapter])]
    assert sorted(names) == sorted(offered(chapter))


@pytest.mark.parametrize("chapter", OFFERED)
def test_calls_fields_and_members_are_those_of_the_code(chapter: str) -> None:
    rows = {name: (arguments, text) for name, arguments, text in ROW.findall(SECTIONS[chapter])}
    for name, value in offered(chapter).items():
        arguments, text = rows[name]
        listed = re.findall(r"`(\w+)`", text)
        if inspect.isfunction(value):
            assert arguments == f"({needed(value)})", name
        elif isinstance(value, enum.EnumMeta):
            assert listed == [one.name for one in value], name  # type: ignore[attr-defined]
        elif inspect.isclass(value) and (is_dataclass(value) or issubclass(value, tuple)):
            shown = [one.name for one in fields(value) if one.repr] if is_dataclass(value) else value._fields  # type: ignore[attr-defined]
            assert listed == [one for one in shown if one[0] != "_"], name
            assert re.findall(r"`\.(\w+(?:\(\))?)`", text) == members(value), name


def members(kind: type) -> list[str]:
    """The properties and methods of a class besides those of `Record`, methods with brackets."""
    found = [
        one for each in kind.__mro__ if each not in {object, Record, tuple} for one in vars(each).items()
    ]
    own = {
        name if isinstance(value, property) else f"{name}()"
        for name, value in found
        if isinstance(value, property | classmethod | staticmethod) or inspect.isfunction(value)
        if name[0] != "_" and not hasattr(Record, name)
    }
    return sorted(own)


def test_the_quick_start_has_the_table_of_questions() -> None:
    table = re.findall(r"^\| question \| call \|\n.*?(?=^\n)", PAGE, re.DOTALL | re.MULTILINE)
    assert len(table) == 1
    assert table[0] in (ROOT / "docs" / "quick-start-python.md").read_text(encoding="utf-8")
    for word in ("wall", "truck", "domino", "coin", "billiard", "die", "fingers", "tray"):
        assert word in table[0]
    for name in re.findall(r"(?:`|= )(\w+)\(", table[0]):
        assert re.search(rf"^\| `{name}\(", PAGE, re.MULTILINE), name
        assert name in contact_dynamics.__all__


@pytest.mark.parametrize(
    ("code", "most"),
    [
        ("import contact_dynamics", 5),
        ("from contact_dynamics import Body, BodyState, World", 60),
        (
            "import contact_dynamics as cd; cd.toss; assert callable(cd.toss) and callable(cd.contact_modes)",
            400,
        ),
        ("import contact_dynamics.toss; import contact_dynamics as cd; assert callable(cd.toss)", 400),
    ],
)
def test_chapters_are_imported_when_they_are_asked_for(code: str, most: int) -> None:
    count = "import sys; print(sum(name.startswith('contact_dynamics') for name in sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; {count}"], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert int(done.stdout) <= most


def test_all_that_the_front_page_lists_is_there() -> None:
    for name in dir(contact_dynamics):
        assert getattr(contact_dynamics, name) is not None
    with pytest.raises(AttributeError, match="has no attribute 'bounce'"):
        contact_dynamics.bounce  # noqa: B018


def test_examples_in_help_print_what_they_say() -> None:
    texts = {
        f"{value.__module__}.{name}": inspect.getdoc(value) or ""
        for chapter in OFFERED
        for name, value in offered(chapter).items()
        if callable(value) and value.__module__.startswith("contact_dynamics")
    }
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner(verbose=False)
    for name, text in texts.items():
        runner.run(parser.get_doctest(text, {}, name, None, None))
    assert runner.tries > 50
    assert runner.failures == 0
