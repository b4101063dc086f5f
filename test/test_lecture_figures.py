# SPDX-License-Identifier: Apache-2.0
"""The figures of the documents are those that the scripts in scripts/ draw."""

from __future__ import annotations

import importlib.util
import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")

from contact_dynamics.plots import save_figure
from running_server import ROOT

SCRIPTS = {"lecture_figures": ROOT / "docs" / "lectures", "page_figures": ROOT / "docs" / "figures"}
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
PIXEL = 0.05  # of 1/72 inch: another processor rounds otherwise, and nobody sees it


@cache
def script(name: str) -> ModuleType:
    found = importlib.util.spec_from_file_location(name, ROOT / "scripts" / f"{name}.py")
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


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_pages_show_every_figure(name: str) -> None:
    folder = SCRIPTS[name]
    pages = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    shown = set(re.findall(rf"!\[[^\]]+\]\((?:\.\./)?{folder.name}/(\w+)\.svg\)", pages))
    assert shown == set(script(name).FIGURES)
    assert {path.stem for path in folder.iterdir()} == shown


@pytest.mark.parametrize(
    ("name", "path"),
    [(name, path) for name, folder in SCRIPTS.items() for path in sorted(folder.glob("*.svg"))],
    ids=lambda each: each.stem if isinstance(each, Path) else "",
)
def test_a_figure_is_current(name: str, path: Path, tmp_path: Path) -> None:
    again = tmp_path / path.name
    save_figure(script(name).FIGURES[path.stem](), again)
    words, places, made = drawn_of(path)
    new_words, new_places, new_made = drawn_of(again)
    assert new_words == words
    if new_made == made:  # another version sets the same curves elsewhere on the page
        np.testing.assert_allclose(new_places, places, atol=PIXEL)
