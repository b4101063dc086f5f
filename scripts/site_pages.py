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


def on_files(files: Files, config: Any) -> Files:
    """Add the pages from elsewhere."""
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
    if path in elsewhere or path.startswith("docs/"):
        to = elsewhere.get(path, path.removeprefix("docs/"))
        return f"[{text}]({os.path.relpath(to, PurePosixPath(name).parent)}{anchor or ''})"
    return str(text) if (ROOT / path).exists() else link.group()
