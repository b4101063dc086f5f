# SPDX-License-Identifier: Apache-2.0
"""Every measured number in a document is that of `benchmarks/measured.json`, and stands between its marks."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest

from benchmarks import _quotes as quotes
from running_server import ROOT

PAGES = [str(path.relative_to(ROOT)) for path in quotes.documents()]
UNITS = "ns|us|µs|ms|s|min|h|Hz|kHz|MHz|GHz|m|mm|cm|nm|rad|°|deg|m/s|rad/s|N|bytes|KiB|MiB|KB|MB|GB|%|times"
NUMBER = re.compile(
    rf"(?<![\w./-])\d[\d.,]*(?:e-?\d+)?(?:(?: to | and )\d[\d.,]*(?:e-?\d+)?)? ?(?:{UNITS})(?![\w⁻²³/*·])"
)
VAGUE = re.compile(
    r"\b(?:tenths?|hundredths?|thousandths?|(?:few|some|two|a) (?:nano|micro|milli)?seconds?) of an? \w+"
    r"|(?:few|some|two|several|tens of) (?:nano|micro|milli)seconds"
)

NOT_MEASURED: dict[
    str, list[str]
] = {  # what is set, derived, told of the world, or held by a test of its own
    "README.md": ["100 s", "RK4 at 1 ms"],
    "docs/certainty.md": [
        "at most 1e-9 m",
        "99.9 % confidence",
        "At most 2 % of the verdicts",
        "1e-2 rad in",
        "contain 50 % and 90 % of",
    ],
    "docs/diagnostics.md": ["or for 3 s", "For 10 s, responses"],
    "docs/performance.md": ["poses at 1 kHz", "after 100 s", "step 1 ms"],
    "docs/calibrate.md": [
        "the true values in 85 to 95 %",
        "More than 5 % of the tosses",
        "a 90 % interval extends over",
        "| 90 % intervals that contain the reference",
    ],  # test_calibrate, whose slow part counts
    "docs/cases.md": ["distance after 10 s"],  # what is asked
    "docs/contact-modes.md": ["At 60 N", "At 110 N", "floor at 75°", "at the 99.9 % confidence"],
    "docs/contacts.md": ["0.001 m for motion capture"],
    "docs/faq.md": ["1e-6 m"],
    "docs/limits.md": [
        "at least 1e-6 m",
        "the server dead after 4 s",
        "92 % to 100 %",
        "1e16 rad",
        "exceeds 0.1 rad",
        "by at most 8 % with the default",
        "by at most 2 % with 16",
        "distance is at most 1e-5 m",
        "at most 1e-4 times the distance",
    ],
    "docs/evaluate.md": [  # what is set, as tolerances, levels and defaults, and a line of the report
        "predicted 20 ms in advance",
        "a median error of 0.162 ms in time and 0.344 mm",
        "at least 47 ms",
        "plus 0.5 mm and 5 mrad",
        "at most 15 mm",  # LANDING_GAP, IMPACT_SPAN, SHARP_VELOCITY, MODE_SPAN, MODE_SPEED and TOUCHING_GAP
        "at most 40 ms",
        "at most 0.15 m/s",
        "Duration: 50 ms",
        "at most 20 mm/s",
        "at most 3 mm",
        "at least 10 % of the distance",
        "the last 100 ms",
        "50, 90 and 95 % prediction regions",
        "near 50, 90 and 95 %",
        "95 % confidence interval",
    ],
    "docs/lectures.md": ["an angle of 75°"],  # the lecture's rod
    "docs/log.md": [
        "at least 1 MB is free",
        "up to 1 s",
        "next 10 s",
        "the last 100 ms",
        "about 100 ms of messages",
        "64 MiB",
        "240 Hz",
    ],
    "docs/notation.md": ["−90°"],
    "docs/quick-start-ros.md": ["slide at 4.9 N"],  # half its weight
    "docs/replay.md": ["the next 50 ms", "occurs within 50 ms", "every 0.1 s", "the preceding 0.1 s"],
    "docs/several-contacts.md": ["some milliseconds apart", "within 1 cm", "default 0.05 s"],
    "docs/tumbling.md": [
        "a rotation by 190° yields the same pose as a rotation by 170° in the opposite direction",
        "ideal values of 50 % and 90 %",
        "position, 50 % region | position, 90 % region",
        "attitude, 50 % region | attitude, 90 % region",
        "5e-15 rad",  # tumbling/test_accuracy
        "0.1 rad",
        "last 0.1 s",
    ],
    "docs/toss.md": [
        "contain 50 % or 90 % of its samples",
        "per step (1e-7 m and m/s by default)",  # PHASE_ERROR
        "at most 0.2 ms",
        "less than 0.1 mm",  # SAMPLED_SETTLING_HEIGHT
        "less than 20 ms in the median",  # test/toss/test_laid_flat.py
        "ideal values are 50 % and 90 %",
        "inside the 50 % region",
        "inside the 90 % region",
        "a 90 % confidence interval",
    ],
    "contact_dynamics_interfaces/README.md": [
        "as 50 and 90 % prediction regions",
        "inside the 50 or 90 % prediction region",
        "pushed with 2 N",
        "pushed with 0.6 N",
        "with 0.5, 1 and 1.5 N",
        "last 0.1 s",
        "some milliseconds before",
        "(0.001 s)",
        "0.1 rad",
    ],
    "docs/monitor.md": [
        "states at least 20 ms before it",
        "0.5 mm and 5 mrad for errors",
        "inside the 99 % prediction region",
        "regions of 50 and 90 %",
        "restitution to 12 % and friction to 11 %",  # of simulated impacts, as are the rows of the table
        "20 % above or below",
        "40 % above it",
        "40 % below it",
        "0.25 to 0.45 s after it occurred",
    ],
}


def prose(page: str) -> str:
    """A document without its code, and without what stands between marks."""
    text = re.sub(
        r"^```.*?^```", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE
    )
    return re.sub(r"`[^`\n]*`", "", quotes.MARKED.sub("", text))


def test_every_quoted_number_is_the_one_of_the_file() -> None:
    numbers = quotes.texts(quotes.read())
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        marks = {match[1]: match[2] for match in quotes.MARKED.finditer(text)}
        assert len(marks) <= text.count("<!--/-->") == text.count("<!--bench:"), page
        assert marks.items() <= numbers.items(), page
        # The same number twice in one document, too.
        assert quotes.rewritten(text, numbers) == text, page


def test_no_measured_number_stands_outside_marks() -> None:
    for page in PAGES:
        text = " ".join(prose(page).split())
        for phrase in NOT_MEASURED.get(page, []):
            assert phrase in text, page
            text = text.replace(phrase, "")
        if page == "README.md":  # a package index shows it as it is, so it has no marks
            for number in quotes.texts(quotes.read()).values():
                text = text.replace(f" {number} ", " ")
        assert NUMBER.findall(text) + VAGUE.findall(text) == [], page


@pytest.mark.parametrize(
    "text", ["0.19 m/s", "2 to 15 ms", "takes 3.5 µs,", "1.14 m/s |", "0.2°", "some tenths of a second"]
)
def test_what_looks_measured_is_seen(text: str) -> None:
    assert NUMBER.search(text) or VAGUE.search(text)


def test_the_file_says_how_its_numbers_came_about() -> None:
    measured = quotes.read()
    names = {path.stem for path in (ROOT / "benchmarks").glob("*.py") if not path.stem.startswith("_")}
    assert set(measured) <= names
    for name, one in measured.items():
        assert one["command"] == f"python -m benchmarks {name}"
        assert re.fullmatch(r"\d{4}-\d\d-\d\d", one["date"])
        assert re.fullmatch(r"\d+ cores( at [\d.]+ GHz)? \(\w+\)", one["machine"])
        assert {"python", "numpy", "scipy"} <= set(one["versions"])
        assert all(number.split(".")[0] == name for number in one["numbers"])


@pytest.fixture
def own_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a document and a file of numbers of its own."""
    (tmp_path / "README.md").write_text(
        "takes <!--bench:flights.time-->9 s<!--/-->, off by <!--bench:flights.error-->?<!--/-->\n",
        encoding="utf-8",
    )
    monkeypatch.setattr(quotes, "ROOT", tmp_path)
    monkeypatch.setattr(quotes, "FILE", tmp_path / "measured.json")
    monkeypatch.setattr(quotes, "_offered", {})
    return tmp_path


def test_writing_puts_what_was_offered_into_file_and_documents(own_file: Path) -> None:
    quotes.quote("flights.time", [0.01534, 0.0021], "ms")
    quotes.quote("flights.error", 5.04e-17, "rad", digits=1)
    assert quotes.write("flights") == set()
    quotes.write_documents()
    numbers: dict[str, Any] = json.loads((own_file / "measured.json").read_text())["flights"]["numbers"]
    assert numbers["flights.time"] == {"value": [0.0021, 0.015], "unit": "ms"}
    text = (own_file / "README.md").read_text(encoding="utf-8")
    assert "takes <!--bench:flights.time-->0.0021 to 0.015 ms<!--/-->" in text
    assert "off by <!--bench:flights.error-->5e-17 rad<!--/-->" in text


def test_nothing_is_written_while_a_quoted_number_is_lacking(own_file: Path) -> None:
    """Where a peer is not installed, or the recordings are not at hand."""
    quotes.quote("flights.time", 0.0021, "ms")
    assert quotes.write("flights") == {"flights.error"}
    assert not (own_file / "measured.json").exists()


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [(265.0, "ms", "265 ms"), (0.2, "°", "0.2°"), ([2.0, 15.0], "ms", "2 to 15 ms"), (1.4, "", "1.4")],
)
def test_numbers_are_written_as_documents_write_them(value: float, unit: str, text: str) -> None:
    assert quotes.text_of({"value": value, "unit": unit}) == text


def test_the_picture_of_the_shares_of_tosses_is_current(tmp_path: Path) -> None:
    """`python -m benchmarks --documents` draws it anew."""
    pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")
    from benchmarks._reliability import FILE, reliability_figure
    from contact_dynamics.plots import save_figure

    again = tmp_path / FILE.name
    save_figure(reliability_figure(), again)
    words = [
        [text.text for text in ET.parse(path).getroot().iter("{http://www.w3.org/2000/svg}text")]
        for path in (FILE, again)
    ]
    assert words[0] == words[1]
    assert f"{quotes.read()['tosses']['numbers']['tosses.1.place.half']['value']:g} %" in words[0]
