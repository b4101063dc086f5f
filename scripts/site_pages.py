# SPDX-License-Identifier: Apache-2.0
"""A hook of MkDocs: pages from outside of docs/, links that leave docs/, and the order of all pages.

The documents are written for people who read them in the repository, so they link to sources and to pages
beside docs/. The site gets those pages too, the examples as pages with code, and for the playground the wheel
without the compiled core. A link to another source file becomes its name.
"""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from base64 import b64decode
from itertools import pairwise
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree as ET

from mkdocs.structure.files import File, Files
from mkdocs.structure.nav import Navigation
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
PAGES = {
    "interfaces.md": "contact_dynamics_interfaces/README.md",
    "readme.md": "README.md",
    "changelog.md": "CHANGELOG.rst",
    "contributing.md": "CONTRIBUTING.md",
}
"""The pages of the site that come from elsewhere in the repository."""

CODE = {
    f"code/{path.stem}.md": str(path.relative_to(ROOT))
    for path in (
        *(ROOT / "scripts" / f"{name}.py" for name in ("lecture_figures", "page_figures", "viewer_pictures")),
        ROOT / "benchmarks" / "_reliability.py",
        *sorted((ROOT / "examples").glob("*.py")),
    )
}
"""The pages that show the examples and what draws the pictures, as code."""

NOTEBOOKS = {
    f"notebooks/{path.stem}.md": f"docs/notebooks/{path.name}"
    for path in sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
}
"""The pages that show the notebooks."""

VERSION = ET.parse(ROOT / "package.xml").getroot().findtext("version")
WHEEL = {f"contact_dynamics-{VERSION}-py3-none-any.whl": "setup/plain_wheel.sh"}
"""The wheel that the playground runs, and what builds it."""

SECTION_PAGES = {"guides.md", "reference.md", "explanation.md"}
"""The first pages of sections, which link to every page of theirs."""

LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s:#]+)(#[^)\s]*)?\)")
IMAGE = re.compile(r"(!\[[^\]]*\])\(docs/([^)\s]+)\)")
NUMBER = re.compile(r"\d[\d.]*e-\d+")
CELL = re.compile(r"<td.*?</td>", re.DOTALL)
CODE_IN_CELL = re.compile(r"(?<=<code>)[^<]+")
PARTS = re.compile(r"(?<=[_/.(:])(?!py\b)(?=[a-z])", re.IGNORECASE)
"""The places between the parts of a name."""
MARKER = re.compile(r"<!--/?(?:bench:[\w.]+)?-->")
TITLE = re.compile(r"\A\^+\n(.*)\n\^+\n")
"""The title of a changelog in reStructuredText, which below it is Markdown too."""


INTERFACE_FILES = "interface-files.md"
"""The page with all definitions of the interfaces, which is made of them."""

DEFINITIONS = ("contact_dynamics_interfaces/srv", "contact_dynamics_interfaces/msg")
"""The folders that this page shows."""


def interface_files() -> str:
    """Return the page with each service and each message as its file has it."""
    package = ROOT / "contact_dynamics_interfaces"
    head = "# Every field of the interfaces\n\nROS 2 builds the interfaces from these definitions. "
    head += (
        "Each field has its unit, its frame and what leaving it out means. [Interfaces](interfaces.md) has "
    )
    wrapped = "<style>.md-typeset pre > code { white-space: pre-wrap; }</style>\n"  # the lines are long
    parts = [head + "examples to paste.\n", wrapped]
    for kind, heading in (("srv", "Services"), ("msg", "Messages")):
        parts.append(f"## {heading}\n")
        parts += [
            f"### {path.stem}\n\n```text\n{path.read_text(encoding='utf-8')}```\n"
            for path in sorted((package / kind).glob(f"*.{kind}"))
        ]
    return "\n".join(parts)


def code_page(source: str) -> str:
    """Return a page with a Python file, and a heading for each of its functions and classes."""
    text = (ROOT / source).read_text(encoding="utf-8")
    lines = text.splitlines()
    named = [part for part in ast.parse(text).body if isinstance(part, ast.FunctionDef | ast.ClassDef)]
    begins = [min([part.lineno, *(each.lineno for each in part.decorator_list)]) - 1 for part in named]
    parts = [
        "---\nsearch:\n  exclude: true\n---\n\n",
        f"# {source}\n\n",
        _as_code(lines[: min(begins, default=None)]),
    ]
    for part, begin, end in zip(named, begins, [*begins[1:], None], strict=False):
        parts.append(f"## {part.name} {{ #{part.name} }}\n\n{_as_code(lines[begin:end])}")
    return "".join(parts)


def _as_code(lines: list[str]) -> str:
    code = "\n".join(lines).strip("\n")
    return f"```python\n{code}\n```\n\n"


def notebook_page(source: str) -> tuple[str, dict[str, bytes]]:
    """Return a notebook as a page, and its pictures by their names."""
    path = ROOT / source
    parts, pictures = [], {}
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
        for output in cell.get("outputs", []):
            if "text" in output:
                parts.append(f"```text\n{''.join(output['text'])}```")
            elif "image/png" in output["data"]:
                name = f"{path.stem}-{len(pictures)}.png"
                pictures[name] = b64decode("".join(output["data"]["image/png"]))
                parts.append(f"![What the code above draws]({name})")
    parts.insert(1, f'<a href="{path.name}" download>Download this notebook</a>')
    return "\n\n".join(parts), pictures


def plain_wheel(name: str) -> bytes:
    """Return the wheel without the compiled core."""
    with TemporaryDirectory() as folder:
        subprocess.run([ROOT / WHEEL[name], sys.executable, folder], check=True)
        return (Path(folder) / name).read_bytes()


def on_files(files: Files, config: Any) -> Files:
    """Add the pages from elsewhere."""
    files.append(File.generated(config, INTERFACE_FILES, content=interface_files()))
    for name, source in CODE.items():
        files.append(File.generated(config, name, content=code_page(source)))
    for name, source in NOTEBOOKS.items():
        page, pictures = notebook_page(source)
        files.append(File.generated(config, name, content=page))
        for picture, content in pictures.items():
            files.append(File.generated(config, f"notebooks/{picture}", content=content))
    for name in WHEEL:
        files.append(File.generated(config, name, content=plain_wheel(name)))
    for name, source in PAGES.items():
        text = TITLE.sub(r"# \1\n", (ROOT / source).read_text(encoding="utf-8"))
        files.append(File.generated(config, name, content=IMAGE.sub(r"\1(\2)", text)))
    return files


def on_nav(nav: Navigation, files: Files, **_: Any) -> Navigation:
    """Put each page that is not in the menu into the section whose first page links to it.

    The links to the previous and the next page go through all of them.
    """
    chain: list[Page] = []
    for section in nav.items:
        listed = [child for child in section.children or [] if isinstance(child, Page)]
        first = listed[0].file
        linked = LINK.findall(first.content_string) if first.src_uri in SECTION_PAGES else []
        paths = (os.path.normpath(f"docs/{target}") for _, target, _ in linked)
        found = [files.get_file_from_path(page_of(path) or path) for path in paths]
        pages = [file.page for file in found if file is not None and file.page is not None]
        for page in [listed[0], *pages, *listed[1:]]:
            page.parent = page.parent or section
            if page.parent is section and page not in chain:
                chain.append(page)
    for before, after in pairwise(chain):
        before.next_page, after.previous_page = after, before
    return nav


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Point links to where the site has their target, and leave out those that it does not have."""
    name = page.file.src_uri
    source = PurePosixPath(PAGES.get(name, f"docs/{name}"))
    return MARKER.sub("", LINK.sub(lambda link: link_on_site(link, name, source), markdown))


def on_page_content(html: str, **_: Any) -> str:
    """Mark in tables where a line may end in code, and numbers in which browsers would end it at a hyphen."""

    def marked(cell: re.Match[str]) -> str:
        text = CODE_IN_CELL.sub(lambda code: PARTS.sub("<wbr>", code[0]), cell[0])
        return NUMBER.sub(r'<span class="number">\g<0></span>', text)

    return CELL.sub(marked, html)


def page_of(path: str) -> str | None:
    """Return the page of the site that shows a file of the repository, or None if there is none."""
    elsewhere = {of: page for page, of in (PAGES | CODE | NOTEBOOKS | WHEEL).items()}
    elsewhere |= dict.fromkeys(DEFINITIONS, INTERFACE_FILES)
    return elsewhere.get(path, path.removeprefix("docs/") if path.startswith("docs/") else None)


def link_on_site(link: re.Match[str], name: str, source: PurePosixPath) -> str:
    """Return the link as the page of that name needs it. What leads nowhere stays, and MkDocs complains."""
    text, target, anchor = link.groups()
    path = os.path.normpath(source.parent / target)
    definition = re.fullmatch(r"contact_dynamics_interfaces/(?:srv|msg)/(\w+)\.(?:srv|msg)", path)
    if definition and (ROOT / path).is_file():
        definitions = os.path.relpath(INTERFACE_FILES, PurePosixPath(name).parent)
        return f"[{text}]({definitions}#{definition[1].lower()})"
    to = page_of(path)
    if to is not None:
        return f"[{text}]({os.path.relpath(to, PurePosixPath(name).parent)}{anchor or ''})"
    return str(text) if (ROOT / path).exists() else link.group()
