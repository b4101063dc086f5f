# SPDX-License-Identifier: Apache-2.0
"""The notebooks run from beginning to end, and print what is stored in them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from running_server import ROOT

nbformat = pytest.importorskip(
    "nbformat", reason="NOT RUN: nbclient of requirements/test.txt is not installed"
)
nbclient = pytest.importorskip(
    "nbclient", reason="NOT RUN: nbclient of requirements/test.txt is not installed"
)
pytest.importorskip("ipykernel", reason="NOT RUN: ipykernel of requirements/test.txt is not installed")

FOLDER = ROOT / "docs" / "notebooks"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_prints_what_it_shows(path: Path) -> None:
    stored = nbformat.read(path, as_version=4)
    run = nbclient.NotebookClient(nbformat.read(path, as_version=4), timeout=60).execute()
    assert outputs(run) == outputs(stored)


def outputs(notebook: Any) -> list[tuple[str, list[str]]]:
    """Return what each cell has printed, and the kinds of its other outputs: pictures differ by version.

    A busy machine sends what a cell prints in several parts, and Matplotlib warns while it caches fonts.
    """
    return [
        (
            "".join(output.text for output in cell.outputs if output.get("name") == "stdout"),
            [output.output_type for output in cell.outputs if output.output_type != "stream"],
        )
        for cell in notebook.cells
        if cell.cell_type == "code"
    ]
