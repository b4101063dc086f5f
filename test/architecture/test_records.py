# SPDX-License-Identifier: Apache-2.0
"""`help()` and editors show what every field of a value is, because the class's docstring says it."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import re

import pytest

from architecture.test_chapters import INSIDE, WITHOUT_ROS, chapter_of, module_of
from contact_dynamics.records import Record


def records() -> list[type[Record]]:
    """Every public value of the physics and of the questions."""
    found = []
    for path in INSIDE:
        if chapter_of(module_of(path)) not in WITHOUT_ROS:
            continue
        module = importlib.import_module(module_of(path))
        for name, owner in vars(module).items():
            ours = inspect.isclass(owner) and owner.__module__ == module.__name__ and not name.startswith("_")
            if ours and issubclass(owner, Record) and dataclasses.is_dataclass(owner):
                found.append(owner)
    return found


@pytest.mark.parametrize("owner", records(), ids=lambda owner: owner.__name__)
def test_every_field_is_in_the_docstring(owner: type[Record]) -> None:
    described = set()
    for base in (one for one in owner.__mro__ if dataclasses.is_dataclass(one)):  # which define fields
        text = inspect.cleandoc(vars(base).get("__doc__") or "")
        section = text.partition("Attributes:\n")[2].partition("\n\n")[0]
        described |= set(re.findall(r"^    (\w+): \S", section, re.MULTILINE))
    fields = {field.name for field in dataclasses.fields(owner) if not field.name.startswith("_")}  # type: ignore[arg-type]
    assert described == fields, f"missing {fields - described}, unknown {described - fields}"


@pytest.mark.parametrize("owner", records(), ids=lambda owner: owner.__name__)
def test_a_value_shows_itself_by_the_common_way(owner: type[Record]) -> None:
    assert owner.__repr__ is Record.__repr__


def test_there_are_many_values() -> None:
    assert len(records()) > 60
