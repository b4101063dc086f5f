# SPDX-License-Identifier: Apache-2.0
"""What the page on the architecture names exists, and it names every chapter."""

from __future__ import annotations

import re

from architecture.test_chapters import CHAPTERS, PACKAGE, ROOT
from sweeps import each

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
NAMED = sorted(set(re.findall(r"`([a-z_]+(?:/[a-z_]*)*(?:\.(?:py|yaml))?)`", PAGE)))
PATHS = [name for name in NAMED if "/" in name or "." in name]
ANYWHERE = {"answer.py", "problem.py", "margins.py", "statics.py", "wrench_sets.py", "result.py"} | {
    "one_contact.py",
    "batch.py",
    "body.py",
    "one.py",
    "many.py",
}
"""Names of files that stand in several folders, or in the folder that their row is about."""


@each("path", PATHS)
def test_what_the_page_names_exists(path: str) -> None:
    if path in ANYWHERE:
        assert list(PACKAGE.rglob(path)), path
        return
    parents = [ROOT, PACKAGE, *(PACKAGE / chapter for chapter in ("rigid_body", "impact", "contact_modes"))]
    assert any((parent / path).exists() for parent in parents), path


def test_the_page_names_every_chapter() -> None:
    for chapter in CHAPTERS:
        if not chapter.startswith("__"):
            assert re.search(rf"`{chapter}(/|\.py)?`|`{chapter[:10]}\*?\.py`", PAGE), chapter


def test_the_page_finds_more_than_a_few_paths() -> None:
    assert len(PATHS) > 25
