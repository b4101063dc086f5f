"""The figures of docs/lectures.md are those that `python scripts/lecture_figures.py` draws."""

from __future__ import annotations

import importlib.util
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")

from contact_dynamics.plots import save_figure
from running_server import ROOT

FOLDER = ROOT / "docs" / "lectures"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
PIXEL = 0.05  # of 1/72 inch: another processor rounds otherwise, and nobody sees it


@pytest.fixture(scope="module")
def script() -> ModuleType:
    found = importlib.util.spec_from_file_location("lecture_figures", ROOT / "scripts" / "lecture_figures.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def drawn_of(path: Path) -> tuple[list[str], np.ndarray, str]:
    """The words of a picture, the places of its named curves, and what drew it."""
    root = ET.parse(path).getroot()
    words = [text.text or "" for text in root.iter("{http://www.w3.org/2000/svg}text")]
    places = [
        float(number)
        for part in root.iter("{http://www.w3.org/2000/svg}path")
        if "clip-path" in part.attrib
        for number in NUMBER.findall(part.attrib["d"])
    ]
    made = re.search(r"Matplotlib v[\d.]+", path.read_text(encoding="utf-8"))
    assert made is not None
    return words, np.array(places), made.group()


def test_the_page_shows_every_figure(script: ModuleType) -> None:
    page = (ROOT / "docs" / "lectures.md").read_text(encoding="utf-8")
    shown = re.findall(r"\(lectures/(\w+)\.svg\)", page)
    assert sorted(shown) == sorted(script.FIGURES)
    assert {path.stem for path in FOLDER.iterdir()} == set(shown)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.svg")), ids=lambda path: path.stem)
def test_a_figure_is_current(path: Path, script: ModuleType, tmp_path: Path) -> None:
    again = tmp_path / path.name
    save_figure(script.FIGURES[path.stem](), again)
    words, places, made = drawn_of(path)
    new_words, new_places, new_made = drawn_of(again)
    assert new_words == words
    if new_made == made:  # another version sets the same curves elsewhere on the page
        np.testing.assert_allclose(new_places, places, atol=PIXEL)
