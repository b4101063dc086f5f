"""Numbers that others published, read from their data files and asked of the package."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

from contact_dynamics.cases.quantities import QUANTITIES
from contact_dynamics.records import NamedInt, Record


class PublishedVerdict(NamedInt):
    """What comes of comparing a published number with the package's."""

    RIGHT = 0
    """They agree within the tolerance."""
    EXPLAINED = 1
    """They differ, and the data file says why the published number is off."""
    WRONG = 2
    """They differ, and nobody knows why."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PublishedValue(Record):
    """One published number.

    Attributes:
        source: The title of the source.
        where: Where the number stands in the source, or its derivation.
        what: What the number is, with its unit.
        ask: The function of `quantities` that answers it.
        of: Which of that function's answers.
        inputs: What the function takes.
        expected: The published number.
        tolerance: Largest difference that counts as agreement, in its unit.
        explained: Why the published number is off, or empty.
    """

    source: str
    where: str
    what: str
    ask: str
    of: str
    inputs: Mapping[str, Any]
    expected: float
    tolerance: float
    explained: str = ""

    def ours(self) -> float:
        """Return the package's answer."""
        return QUANTITIES[self.ask](self.of, **self.inputs)

    def verdict(self, ours: float) -> PublishedVerdict:
        """Return what comes of comparing the published number with an answer."""
        if abs(ours - self.expected) <= self.tolerance:
            return PublishedVerdict.RIGHT
        return PublishedVerdict.EXPLAINED if self.explained else PublishedVerdict.WRONG


def published_values() -> tuple[PublishedValue, ...]:
    """Return all published numbers, file by file."""
    folder = resources.files("contact_dynamics.cases.published_values")
    files = sorted(
        (file for file in folder.iterdir() if file.name.endswith(".json")), key=lambda file: file.name
    )
    return tuple(
        value for file in files for value in _values_of(json.loads(file.read_text(encoding="utf-8")))
    )


def _values_of(content: Mapping[str, Any]) -> Iterator[PublishedValue]:
    for fields in content["values"]:
        yield PublishedValue(source=content["source"], **fields)
