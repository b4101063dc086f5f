# SPDX-License-Identifier: Apache-2.0
"""The wheel without the compiled core: it installs where nothing compiles, and computes the same numbers."""

from __future__ import annotations

import re
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
import scipy

from test_setup.programs import ROOT, SETUP, run

LIBRARIES = {str(Path(module.__file__ or "").parents[1]) for module in (np, scipy)}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel that setup/plain_wheel.sh builds."""
    folder = tmp_path_factory.mktemp("plain wheel")
    run(SETUP / "plain_wheel.sh", sys.executable, folder, check=True)
    (built,) = folder.iterdir()
    return built


def test_it_is_for_every_platform_and_holds_nothing_compiled(wheel: Path) -> None:
    assert wheel.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as packed:
        suffixes = {Path(name).suffix for name in packed.namelist()}
    assert {".py", ".pxd"} <= suffixes
    assert not {".so", ".c", ".pyc"} & suffixes


def test_it_prints_what_the_readme_shows(wheel: Path, tmp_path: Path) -> None:
    install = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-index", "--no-compile"]
    run(*install, "--target", tmp_path, wheel, check=True)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    example = re.search(r"```python\n(.*?)```", readme, re.DOTALL)
    assert example
    # Only what is installed there, with NumPy and SciPy beside it.
    program = (
        f"import sys; sys.path[:0] = {[str(tmp_path), *LIBRARIES]!r}\n{example[1]}\nprint(cd.__file__)\n"
        "print(sorted({name.partition('.')[0] for name in sys.modules} & {'rclpy', 'mcap', 'rerun'}))"
    )
    answer = run(sys.executable, "-I", "-c", program, cwd=tmp_path)
    assert answer.returncode == 0, answer.stderr
    *printed, file, others = answer.stdout.splitlines()
    assert printed == re.findall(r"#> (.*)", example[1])
    assert file.startswith(str(tmp_path))
    assert others == "[]"
