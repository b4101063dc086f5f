# SPDX-License-Identifier: Apache-2.0
"""One version number: from a source tree, and from an installed wheel."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import scipy

import contact_dynamics
from test_setup.programs import ROOT, run

ASK = "import contact_dynamics; print(contact_dynamics.__version__)"


def stated() -> str:
    text = ET.parse(ROOT / "package.xml").getroot().findtext("version")
    assert text
    return text


def ask(folder: Path) -> subprocess.CompletedProcess[str]:
    """Import the package from a folder alone, without what is installed besides the standard library."""
    libraries = {str(Path(module.__file__ or "").parents[1]) for module in (np, scipy)}
    program = f"import sys; sys.path[:0] = {[str(folder), *libraries]!r}; {ASK}"
    return run(sys.executable, "-I", "-c", program, cwd=folder)


def test_a_source_tree_knows_its_version() -> None:
    assert contact_dynamics.__version__ == stated()


def test_installed_metadata_tells_the_version(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "contact_dynamics", tmp_path / "contact_dynamics")
    metadata = tmp_path / "contact_dynamics-7.8.9.dist-info" / "METADATA"
    metadata.parent.mkdir()
    metadata.write_text("Metadata-Version: 2.1\nName: contact_dynamics\nVersion: 7.8.9\n", encoding="utf-8")
    assert ask(tmp_path).stdout == "7.8.9\n"


def test_another_packages_manifest_is_not_taken(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "contact_dynamics", tmp_path / "contact_dynamics")
    (tmp_path / "package.xml").write_text(
        "<package><name>other</name><version>3.2.1</version></package>", encoding="utf-8"
    )
    assert "3.2.1" not in ask(tmp_path).stdout


def test_both_packages_say_that_they_are_typed() -> None:
    assert (ROOT / "contact_dynamics" / "py.typed").is_file()
    assert (ROOT / "msg_adapters" / "py.typed").is_file()
