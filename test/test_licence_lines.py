# SPDX-License-Identifier: Apache-2.0
"""Each source file names the licence in its first two lines."""

from __future__ import annotations

from architecture.test_chapters import ROOT

FOLDERS = "benchmarks cmake contact_dynamics contact_dynamics_interfaces docs examples executables launch"
FOLDERS += " msg_adapters scripts setup test"
KINDS = {".cmake", ".cpp", ".css", ".js", ".msg", ".pxd", ".py", ".sh", ".srv"}
LINE = "SPDX-License-Identifier: Apache-2.0"


def test_each_source_file_names_the_licence() -> None:
    found = [path for folder in FOLDERS.split() for path in (ROOT / folder).rglob("*")]
    files = [path for path in found if path.suffix in KINDS]
    assert len(files) > 600
    assert [path for path in files if LINE not in path.read_text("utf-8")[:200]] == []
