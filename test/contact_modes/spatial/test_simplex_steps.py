# SPDX-License-Identifier: Apache-2.0
"""The compiled steps of the dual simplex give the same bits as NumPy's, and as the Python they come from."""

from __future__ import annotations

import importlib.util
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from contact_dynamics.contact_modes.spatial import dual_simplex, simplex_steps
from contact_dynamics.contact_modes.spatial.dual_simplex import Program

COUNT = 20
LARGEST = 50


def plain_steps() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "plain_steps", Path(dual_simplex.__file__).with_name("simplex_steps.py")
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def bits(kind: type[np.floating]) -> list[object]:
    """Return what drawn programs find, with edge forces that nearly coincide in every other one."""
    rng = np.random.default_rng(7)
    found: list[object] = []
    for i in range(COUNT):
        edges, rows = (int(size) for size in rng.integers(4, LARGEST, size=2))
        motion, named = rng.normal(size=(6, edges + 1)), rng.normal(size=(rows, 7))
        if i % 2:
            motion[:, 1] = motion[:, 0] + 1e-5 * motion[:, 1]
        stated = Program.stated(motion.astype(kind), named.astype(kind), range(edges, edges + rows))
        program = stated.renamed(list(range(edges)), int(rng.integers(4)))
        found += [program.solve(), program.doubtful, program.shares(edges).tolist(), program.motion.tolist()]
    return found


def test_the_suite_runs_with_the_compiled_steps() -> None:
    assert (simplex_steps.__file__ or "").endswith(EXTENSION_SUFFIXES[0])


@pytest.mark.parametrize("kind", [np.float64, np.longdouble])
def test_compiled_and_plain_give_the_same_bits(
    monkeypatch: pytest.MonkeyPatch, kind: type[np.floating]
) -> None:
    compiled = bits(kind)
    assert {True, False} <= {each for each in compiled if isinstance(each, bool)}
    monkeypatch.setattr(dual_simplex, "simplex_steps", plain_steps())
    assert bits(kind) == compiled
    monkeypatch.setattr(dual_simplex, "_COMPILED", False)
    assert bits(kind) == compiled
