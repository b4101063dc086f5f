# SPDX-License-Identifier: Apache-2.0
"""Drawings go to a file and are read back; whatever rerun finds wrong raises."""

from __future__ import annotations

import socket
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    import rerun as rr

from contact_dynamics.viewing.viewer_process import LOCAL
from viewing.drawn import Canvas


@pytest.fixture(autouse=True)
def strict() -> Iterator[None]:
    rr.set_strict_mode(True)
    yield
    rr.set_strict_mode(False)


@pytest.fixture
def free_port() -> int:
    """A port of this machine at which nothing listens."""
    with socket.socket() as probe:
        probe.bind((LOCAL, 0))
        port: int = probe.getsockname()[1]
        return port


@pytest.fixture
def silent_viewer() -> Iterator[int]:
    """A port where something listens and never answers."""
    with socket.socket() as listener:
        listener.bind((LOCAL, 0))
        listener.listen()
        yield listener.getsockname()[1]


@pytest.fixture
def canvas(tmp_path: Path) -> Canvas:
    """A recording into a file, at one stamp."""
    return Canvas(tmp_path / "drawn.rrd")
