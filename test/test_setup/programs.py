# SPDX-License-Identifier: Apache-2.0
"""Runs programs, and writes those that stand for others."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).parents[2]
SETUP = ROOT / "setup"


def run(
    *command: str | Path, cwd: Path | None = None, env: Mapping[str, str] | None = None, check: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run a program, with what it prints as text."""
    return subprocess.run(command, cwd=cwd, env=env, check=check, capture_output=True, text=True, timeout=300)


def script(path: Path, text: str) -> Path:
    """An executable shell script."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
    path.chmod(0o755)
    return path
