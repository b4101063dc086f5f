from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from decimal import Decimal
from enum import Enum
from typing import NamedTuple
from xml.etree import ElementTree as ET

import numpy as np

from contact_dynamics.records import NamedInt, Record
from contact_dynamics.validation import FloatArray


class Colour(Enum):
    RED = 1


class Pair(NamedTuple):
    one: float
    two: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Inner(Record):
    colour: Colour = Colour.RED
    long: Decimal = Decimal("0.3333333333333333333333333333333333333333")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Outer(Record):
    name: str = "brick"
    vector: FloatArray = field(default_factory=lambda: np.array([1.0, 1.0 / 3.0, math.nan]))
    table: FloatArray = field(default_factory=lambda: np.zeros((100, 3)))
    inner: Inner = field(default_factory=Inner)
    several: tuple[Inner, ...] = field(default_factory=lambda: (Inner(), Inner()))
    pair: Pair = field(default_factory=lambda: Pair(1.0, math.inf))
    missing: float | None = None


def test_json_takes_the_dict_and_gives_the_numbers_back() -> None:
    plain = Outer().to_dict()
    again = json.loads(json.dumps(plain, allow_nan=False))
    assert again == plain
    assert again["inner"]["colour"] == "RED"
    assert again["vector"][1] == 1.0 / 3.0
    assert math.isnan(float(again["vector"][2]))
    assert again["pair"] == {"one": 1.0, "two": "inf"}
    assert again["several"][1]["long"] == 1.0 / 3.0
    assert again["missing"] is None


def test_a_repr_is_one_short_line() -> None:
    shown = repr(Outer())
    assert "\n" not in shown
    assert len(shown) < 400
    assert "colour=RED" in shown
    assert "0.333333" in shown
    assert "0.33333333" not in shown
    assert "array of shape (100, 3)" in shown


def test_a_print_has_a_line_a_field() -> None:
    lines = str(Outer()).splitlines()
    assert lines[0] == "Outer"
    assert any(line.split() == ["name", "'brick'"] for line in lines)
    assert "    [1] Inner(colour=RED, long=0.333333)" in lines


def test_a_long_value_in_a_list_has_a_line_a_field() -> None:
    @dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
    class Sets(Record):
        all_of_them: tuple[Outer, ...] = (Outer(),)

    assert "  [0] Outer" in str(Sets())
    assert "      name     'brick'" in str(Sets())


def test_functions_and_private_fields_are_not_shown() -> None:
    @dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
    class Hidden(Record):
        _inside: int = 1
        law: object = math.sin
        series: float = field(default=1.0, repr=False)
        shown: int = 2

    assert Hidden().to_dict() == {"shown": 2}


class Law(NamedInt):
    POISSON = 0


def test_an_enumeration_prints_as_its_name() -> None:
    assert str(Law.POISSON) == f"{Law.POISSON}" == "POISSON"
    assert f"{Law.POISSON:>9}" == "  POISSON"
    assert Law.POISSON == 0


def test_a_notebook_shows_a_table_of_the_fields() -> None:
    outer = Outer(name="<brick>", several=(Inner(),) * 12)
    shown = outer._repr_html_()
    assert "<brick>" not in shown
    assert "&lt;brick&gt;" in shown
    root = ET.fromstring(shown)  # tags close
    assert [row[0].text for row in root if row.tag == "tr"] == list(outer.to_dict())
    cells = {row[0].text: row[1] for row in root if row.tag == "tr"}
    assert cells["vector"].text == "[1, 0.333333, nan]"
    assert cells["table"].text == "array of shape (100, 3)"
    summary, table = cells["inner"][0]
    assert summary.text == "Inner"
    assert "".join(table.itertext()).startswith("InnercolourREDlong0.333333")
    assert len(cells["several"].findall("details/table")) == 9
    assert "and 3 more" in shown
