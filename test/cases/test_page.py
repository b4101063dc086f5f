# SPDX-License-Identifier: Apache-2.0
"""The page of the cases is what `python scripts/cases_page.py` writes."""

from __future__ import annotations

import importlib.util
from types import ModuleType

import pytest

from contact_dynamics.cases import CASES
from running_server import ROOT


@pytest.fixture(scope="module")
def script() -> ModuleType:
    found = importlib.util.spec_from_file_location("cases_page", ROOT / "scripts" / "cases_page.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_the_page_is_current(script: ModuleType) -> None:
    assert script.PAGE.read_text(encoding="utf-8") == script.page()


def test_the_page_has_every_case_with_a_number_of_mujoco(script: ModuleType) -> None:
    text = script.PAGE.read_text(encoding="utf-8")
    for name, case in CASES.items():
        assert f"\n## {case.title}\n" in text
        assert f"<!--bench:cases.{name}.{len(case.settings) - 1}-->" in text
    assert "-->?<!--" not in text
