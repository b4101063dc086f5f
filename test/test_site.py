"""The site of the documents: every page is in its menu, and every link leads somewhere."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from running_server import ROOT

PAGES_FROM_ELSEWHERE = {"interfaces.md", "readme.md", "changelog.md", "contributing.md", "interface-files.md"}
SECTION_PAGES = ("guides.md", "reference.md", "explanation.md")
MENU = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
MOST_LINKS = 15


def test_the_menu_is_short_and_every_page_is_in_it_or_on_the_first_page_of_a_section() -> None:
    listed = re.findall(r": (\S+\.md)$", MENU, re.MULTILINE)
    assert len(listed) == len(set(listed)) <= MOST_LINKS
    assert set(SECTION_PAGES) <= set(listed)
    texts = [(ROOT / "docs" / page).read_text(encoding="utf-8") for page in SECTION_PAGES]
    linked = {target for text in texts for target in re.findall(r"\]\(([\w/-]+\.(?:md|ipynb))", text)}
    folder = ROOT / "docs"
    written = {
        str(path.relative_to(folder)) for kind in ("md", "ipynb") for path in folder.rglob(f"*.{kind}")
    }
    assert written | PAGES_FROM_ELSEWHERE == {*listed, *linked}


def test_the_reference_has_every_chapter_that_users_call() -> None:
    from contact_dynamics import __all__ as names

    chapters = {name for name in names if (ROOT / "contact_dynamics" / name).is_dir()}
    assert chapters
    assert chapters <= {path.stem for path in (ROOT / "docs" / "api").glob("*.md")}


def test_the_site_is_built_without_a_complaint(tmp_path: Path) -> None:
    """MkDocs is strict here: a link or an anchor that leads nowhere is an error, in docstrings too."""
    pytest.importorskip("mkdocs", reason="NOT RUN: the site, because MkDocs is not installed")
    pytest.importorskip("mkdocstrings", reason="NOT RUN: the site, because mkdocstrings is not installed")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert built.returncode == 0, built.stdout + built.stderr
    reference = (tmp_path / "api" / "tumbling.html").read_text(encoding="utf-8")
    assert "contact_dynamics.tumbling.free_motion" in reference
    assert "elliptic" not in reference  # a private file
    found = (tmp_path / "search" / "search_index.json").read_text(encoding="utf-8")
    assert all(word in found for word in ("URDF", "Jupyter", "Docker", "Humble"))
    # Pages that are not in the menu have a page before and after them, and notebooks have their pictures.
    assert 'rel="next"' in (tmp_path / "impact.html").read_text(encoding="utf-8")
    assert (tmp_path / "notebooks" / "bounce-and-rest-0.png").is_file()
    # The gallery links to the code that made each picture.
    code = (tmp_path / "code" / "lecture_figures.html").read_text(encoding="utf-8")
    gallery = (tmp_path / "gallery.html").read_text(encoding="utf-8")
    assert 'href="code/lecture_figures.html#polhodes"' in gallery
    assert 'id="polhodes"' in code
    # Markers of numbers from the benchmarks stay in the sources, and links to sources become names.
    readme = (tmp_path / "readme.html").read_text(encoding="utf-8")
    assert "bench:" not in readme
    assert "config/server.yaml</code></a>" not in readme
    # The definitions of the interfaces stand on a page of their own, to which their names link.
    definitions = (tmp_path / "interface-files.html").read_text(encoding="utf-8")
    for path in (ROOT / "contact_dynamics_interfaces").glob("*/*.[ms]*"):
        assert f'id="{path.stem.lower()}"' in definitions
        assert f'href="interface-files.html#{path.stem.lower()}"' in (tmp_path / "interfaces.html").read_text(
            encoding="utf-8"
        )
