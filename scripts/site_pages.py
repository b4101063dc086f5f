"""A hook of MkDocs: pages that stand outside of docs/, and links that leave docs/.

The documents are written for people who read them in the repository, so they link to sources and to pages
beside docs/. The site gets those pages too. A link to a source file becomes its name, because the site has no
sources.
"""

from __future__ import annotations

import os
import re
from pathlib import Path, PurePosixPath
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
PAGES = {
    "interfaces.md": "contact_dynamics_interfaces/README.md",
    "readme.md": "README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
}
"""The pages of the site that come from elsewhere in the repository."""

LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s:#]+)(#[^)\s]*)?\)")
IMAGE = re.compile(r"(!\[[^\]]*\])\(docs/([^)\s]+)\)")
MARKER = re.compile(r"<!--/?(?:bench:[\w.]+)?-->")


INTERFACE_FILES = "interface-files.md"
"""The page with all definitions of the interfaces, which is made of them."""


def interface_files() -> str:
    """Return the page with each service and each message as its file has it."""
    package = ROOT / "contact_dynamics_interfaces"
    head = "# Every field of the interfaces\n\nROS 2 builds the interfaces from these definitions. "
    head += (
        "Each field has its unit, its frame and what an empty value means. [Interfaces](interfaces.md) has "
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


def on_files(files: Files, config: Any) -> Files:
    """Add the pages from elsewhere."""
    files.append(File.generated(config, INTERFACE_FILES, content=interface_files()))
    for name, source in PAGES.items():
        text = (ROOT / source).read_text(encoding="utf-8")
        files.append(File.generated(config, name, content=IMAGE.sub(r"\1(\2)", text)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Point links to where the site has their target, and leave out those that it does not have."""
    name = page.file.src_uri
    source = PurePosixPath(PAGES.get(name, f"docs/{name}"))
    return MARKER.sub("", LINK.sub(lambda link: link_on_site(link, name, source), markdown))


def link_on_site(link: re.Match[str], name: str, source: PurePosixPath) -> str:
    """Return the link as the page of that name needs it. What leads nowhere stays, and MkDocs complains."""
    text, target, anchor = link.groups()
    path = os.path.normpath(source.parent / target)
    elsewhere = {of: page for page, of in PAGES.items()}
    definition = re.fullmatch(r"contact_dynamics_interfaces/(?:srv|msg)/(\w+)\.(?:srv|msg)", path)
    if definition and (ROOT / path).is_file():
        to = os.path.relpath(INTERFACE_FILES, PurePosixPath(name).parent)
        return f"[{text}]({to}#{definition[1].lower()})"
    if path in elsewhere or path.startswith("docs/"):
        to = elsewhere.get(path, path.removeprefix("docs/"))
        return f"[{text}]({os.path.relpath(to, PurePosixPath(name).parent)}{anchor or ''})"
    return str(text) if (ROOT / path).exists() else link.group()
