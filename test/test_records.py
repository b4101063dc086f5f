# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import math
import sys
from dataclasses import dataclass, field, make_dataclass
from decimal import Decimal
from enum import Enum
from typing import NamedTuple
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Surface, World, free_motion
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.impact import planar_impacts
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.toss import toss
from contact_dynamics.validation import FloatArray


class Colour(Enum):
    RED = 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Wordy(Record):
    values: FloatArray = field(default_factory=lambda: np.zeros(3))

    def in_short(self) -> str:
        return " ".join(f"word{k}" for k in range(40))


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


def test_the_gist_of_a_result_is_wrapped_and_never_cut() -> None:
    lines = str(Wordy()).splitlines()
    assert max(map(len, lines)) <= 100
    assert " ".join(" ".join(lines[:-1]).split()) == Wordy().in_short()


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


def test_a_repr_fits_a_line() -> None:
    shown = repr(Outer())
    assert "\n" not in shown
    assert len(shown) <= 100
    assert shown.startswith("Outer(name='brick', vector=[1, 0.333333, nan], table=array of shape (100, 3), ")
    assert shown.endswith(", ...)")
    assert repr(Inner()) == "Inner(colour=RED, long=0.333333)"


def test_a_print_has_a_line_a_field() -> None:
    lines = str(Outer()).splitlines()
    assert lines[0] == "Outer"
    assert any(line.split() == ["name", "'brick'"] for line in lines)
    assert "    [1] Inner(colour=RED, long=0.333333)" in lines


def test_a_print_fits_a_screen_and_counts_what_has_no_room() -> None:
    lines = str(Outer(several=(Inner(),) * 1000)).splitlines()
    assert len(lines) <= 20
    assert any(line.split() == ["several", "1000", "Inner"] for line in lines)
    assert lines[-1].strip() != ""
    assert "... and 989 more" in str(Outer(several=(Inner(),) * 1000))
    assert max(map(len, lines)) <= 100


def test_values_of_its_own_kind_are_counted_and_not_nested() -> None:
    @dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
    class Way(Record):
        others: tuple[Way, ...] = ()

    assert str(Way(others=(Way(), Way()))) == "Way\n  others  2 Way"


def test_more_fields_than_lines_are_named() -> None:
    many = make_dataclass(
        "Many", [(f"f{i}", int, 0) for i in range(40)], bases=(Record,), frozen=True, eq=False, repr=False
    )
    lines = str(many()).splitlines()
    assert len(lines) == 20
    assert lines[-1].startswith("  and f18, f19, ")


def test_rounding_is_shown_as_zero() -> None:
    assert "vector=[1, 0, 0]" in repr(Outer(vector=np.array([1.0, -2e-17, -0.0])))


def test_every_result_of_a_toss_fits() -> None:
    """A cube that is dropped flat has many branch points: at each landing four corners strike at once."""
    cube = Body.box((0.1, 0.1, 0.1), 0.37)
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)
    state = BodyState(p_WB_W=[0, 0, 0.5], q_WB=[0, 0, 0, 1], v_WB_W=[0.3, 0, 0])
    world = World(bodies=(cube,), surfaces=(floor,))
    went = toss(cube, state, world)
    assert went.alternatives == ()
    assert not went.all_followed
    head = str(went).splitlines()[0]
    assert head.startswith("Toss: RESTS at ")
    assert f"{len(went.undecided)} branch points not followed (at {went.undecided[0].seconds:.3g}, " in head
    followed = toss(cube, state, world, max_alternatives=2)
    assert "2 alternatives followed" in str(followed).splitlines()[0]
    assert any(line.split() == ["alternatives", "2", "Toss"] for line in str(followed).splitlines())
    for shown in (went, followed, *went.events, went.state, went.energy, cube, world):
        lines = str(shown).splitlines()
        assert len(lines) <= 20
        assert max(map(len, lines)) <= 100
        assert len(repr(shown)) <= 100


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


def test_a_result_of_many_is_a_table_of_pandas() -> None:
    pytest.importorskip("pandas", reason="pandas of requirements/test.txt is not installed")
    body = Body.box((0.1, 0.2, 0.3), 0.5)
    state = BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0, 0], w_WB_W=[1, 2, 3])
    trajectory = free_motion(body, state).at(np.linspace(0.0, 1.0, 5))
    frame = trajectory.to_frame()
    parts = [f"{name}.{axis}" for name in ("p_WB_W", "q_WB", "v_WB_W", "w_WB_W") for axis in "xyzw"]
    assert list(frame.columns) == ["seconds", *(part for part in parts if part[0] == "q" or part[-1] != "w")]
    np.testing.assert_array_equal(frame["q_WB.w"], trajectory.q_WB[:, 3])
    np.testing.assert_array_equal(frame.set_index("seconds").loc[0.5, "p_WB_W.x"], trajectory.p_WB_W[2, 0])
    impacts = planar_impacts(
        masses=1.0,
        inertias=1.0,
        v=[[0, -1], [1, -1]],
        w=0.0,
        r=[0, -1],
        normals=[0, 1],
        frictions=0.3,
        restitutions=0.5,
    )
    frame = impacts.to_frame()
    assert len(frame) == 2
    np.testing.assert_array_equal(frame["impulses_C.1"], impacts.impulses_C[:, 1])


def test_a_table_without_pandas_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    impacts = planar_impacts(
        masses=1.0, inertias=1.0, v=[0, -1], w=0.0, r=[0, -1], normals=[0, 1], frictions=0.3, restitutions=0.5
    )
    with pytest.raises(NotSupportedError, match=r"to_frame needs pandas: pip install pandas"):
        impacts.to_frame()
