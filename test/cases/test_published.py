# SPDX-License-Identifier: Apache-2.0
"""Numbers that others published."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from contact_dynamics.cases import run
from contact_dynamics.cases.published import PublishedValue, PublishedVerdict, published_values

VALUES = published_values()


@pytest.mark.parametrize("value", VALUES, ids=lambda value: f"{value.where}: {value.what}")
def test_each_is_right_or_explained(value: PublishedValue) -> None:
    ours = value.ours()
    expected = PublishedVerdict.EXPLAINED if value.explained else PublishedVerdict.RIGHT
    assert value.verdict(ours) is expected, ours  # an explanation that nothing needs is wrong, too


def test_each_says_where_it_is_from_and_is_no_twin() -> None:
    assert len(VALUES) >= 100
    assert all(value.where and value.what for value in VALUES)
    assert len({(value.ask, value.of, str(value.inputs)) for value in VALUES}) == len(VALUES)


@pytest.mark.parametrize("value", VALUES[:1] + VALUES[-1:], ids=lambda value: value.what)
def test_another_number_is_wrong(value: PublishedValue) -> None:
    off = replace(value, expected=value.expected + 2.1 * value.tolerance, explained="")
    assert off.verdict(off.ours()) is PublishedVerdict.WRONG
    assert off.verdict(math.nan) is PublishedVerdict.WRONG


def test_the_command_prints_a_verdict_for_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert run.main(["--published"]) == 0
    printed = capsys.readouterr().out
    assert printed.count("  right  ") + printed.count("  explained ") == len(VALUES)
    assert printed.endswith("8 explained, 0 wrong\n")
    assert "[m58286, fs-id1168328277363]" in printed


def test_a_number_that_is_wrong_ends_the_command_with_a_code(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = replace(VALUES[0], expected=2.0)
    monkeypatch.setattr(run, "published_values", lambda: (wrong,))
    assert run.main(["--published"]) == run.NOT_EXACT
    assert capsys.readouterr().out.endswith("0 right, 0 explained, 1 wrong\n")
