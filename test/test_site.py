# SPDX-License-Identifier: Apache-2.0
"""The site of the documents: every page is in its menu, and every link leads somewhere."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

from running_server import ROOT

PAGES_FROM_ELSEWHERE = {
    "../contact_dynamics_interfaces/README.md": "interfaces.md",
    "../contact_dynamics_interfaces/srv": "interface-files.md",
    "../README.md": "readme.md",
    "../CHANGELOG.rst": "changelog.md",
    "../CONTRIBUTING.md": "contributing.md",
}
SECTION_PAGES = ("guides.md", "reference.md", "explanation.md")
MENU = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
MOST_LINKS = 15


def test_the_menu_is_short_and_every_page_is_in_it_or_on_the_first_page_of_a_section() -> None:
    listed = re.findall(r": (\S+\.md)$", MENU, re.MULTILINE)
    assert len(listed) == len(set(listed)) <= MOST_LINKS
    assert set(SECTION_PAGES) <= set(listed)
    texts = [(ROOT / "docs" / page).read_text(encoding="utf-8") for page in SECTION_PAGES]
    targets = {target for text in texts for target in re.findall(r"\]\(([^)\s:#]+)", text)}
    linked = {PAGES_FROM_ELSEWHERE.get(target, target) for target in targets}
    folder = ROOT / "docs"
    written = {
        str(path.relative_to(folder)) for kind in ("md", "ipynb") for path in folder.rglob(f"*.{kind}")
    }
    assert written | {*PAGES_FROM_ELSEWHERE.values()} == {*listed, *linked}


def test_links_lead_somewhere_in_a_clone_too() -> None:
    for page in (ROOT / "docs").rglob("*.md"):
        targets = re.findall(r"\]\((?!https?:)([^)\s#]+)", page.read_text(encoding="utf-8"))
        missing = [target for target in targets if not (page.parent / target).exists()]
        assert missing == [], page


def test_the_reference_has_every_chapter_that_users_call() -> None:
    from contact_dynamics import __all__ as names

    chapters = {name for name in names if (ROOT / "contact_dynamics" / name).is_dir()}
    assert chapters
    assert chapters <= {path.stem for path in (ROOT / "docs" / "api").glob("*.md")}


def build_site(folder: Path) -> None:
    """MkDocs is strict here: a link or an anchor that leads nowhere is an error, in docstrings too."""
    pytest.importorskip("mkdocs", reason="NOT RUN: the site, because MkDocs is not installed")
    pytest.importorskip("mkdocstrings", reason="NOT RUN: the site, because mkdocstrings is not installed")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert built.returncode == 0, built.stdout + built.stderr


@pytest.mark.slow  # the workflow of the documents builds it, as strictly, for every change
def test_the_site_is_built_without_a_complaint(tmp_path: Path) -> None:
    build_site(tmp_path)
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
    # A name in a narrow column is broken between its parts.
    assert "<code>predict_<wbr>contact_<wbr>mode</code>" in readme
    # The definitions of the interfaces stand on a page of their own, to which their names link.
    definitions = (tmp_path / "interface-files.html").read_text(encoding="utf-8")
    for path in (ROOT / "contact_dynamics_interfaces").glob("*/*.[ms]*"):
        assert f'id="{path.stem.lower()}"' in definitions
        assert f'href="interface-files.html#{path.stem.lower()}"' in (tmp_path / "interfaces.html").read_text(
            encoding="utf-8"
        )
    # The playground names what it loads. The scripts of the page take the addresses from there.
    playground = (tmp_path / "playground.html").read_text(encoding="utf-8")
    (wheel,) = tmp_path.glob("*.whl")
    assert f'href="{wheel.name}"' in playground
    assert 'src="playground.js"' in playground
    assert (tmp_path / "playground_worker.js").is_file()
    # No page loads anything from elsewhere by itself.
    for page in tmp_path.rglob("*.html"):
        loaded = re.findall(r"<(?:script|img|link)[^>]* (?:src|href)=\"([^\"]*)", page.read_text("utf-8"))
        assert loaded
        assert not [address for address in loaded if address.startswith(("http", "//"))], page


BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
PYODIDE = re.compile(r"https://cdn\.jsdelivr\.net/pyodide/v[\d.]+/full/")


def test_the_playground_begins_with_the_readmes_example_and_shows_what_each_prints() -> None:
    """That they print it is tested with the code of all documents."""
    first, *others = BLOCK.findall((ROOT / "docs" / "playground.md").read_text(encoding="utf-8"))
    readme = BLOCK.search((ROOT / "README.md").read_text(encoding="utf-8"))
    assert readme
    assert first == readme[1]
    assert len(others) == 5
    assert all("#> " in block for block in others)


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """A server of a folder's files, by its address."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(SimpleHTTPRequestHandler, directory=str(folder)))
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/"
    finally:
        server.shutdown()
        server.server_close()


@pytest.mark.slow
def test_the_playground_prints_in_a_browser_what_it_shows(tmp_path: Path) -> None:
    """In headless Chromium, with Pyodide from its host or, without a network, from the folder PYODIDE."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="NOT RUN: Selenium is not installed")
    waiting = pytest.importorskip("selenium.webdriver.support.ui")
    driver = shutil.which("chromedriver")
    if driver is None:
        pytest.skip("NOT RUN: the playground in a browser, because chromedriver is not installed")
    build_site(tmp_path)
    page = tmp_path / "playground.html"
    if "PYODIDE" in os.environ:
        (tmp_path / "pyodide" / "v0").mkdir(parents=True)
        (tmp_path / "pyodide" / "v0" / "full").symlink_to(os.environ["PYODIDE"])
        page.write_text(PYODIDE.sub("/pyodide/v0/full/", page.read_text("utf-8")), encoding="utf-8")
    options = webdriver.ChromeOptions()
    for each in ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking"):
        options.add_argument(each)
    with served(tmp_path) as address:
        browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
        try:
            browser.get(address + page.name)
            examples = browser.find_elements("class name", "playground")
            assert len(examples) == 6
            for example in examples:
                run = example.find_element("tag name", "button")
                run.click()
                waiting.WebDriverWait(browser, 300).until(lambda _, run=run: run.text == "Run")
                status = example.find_element("css selector", "[role=status]")
                assert status.text.startswith("Done after"), status.text
                code = example.find_element("tag name", "textarea").get_property("value")
                printed = example.find_element("tag name", "pre").get_property("textContent")
                assert all(line in printed for line in re.findall(r"#> (.*)", code)), printed
        finally:
            browser.quit()
