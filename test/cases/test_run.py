# SPDX-License-Identifier: Apache-2.0
"""`contact-dynamics cases`."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from contact_dynamics.cases import CASES, arguments, run
from contact_dynamics.cases.engine import OURS, Engine
from contact_dynamics.cases.published import PublishedValue, PublishedVerdict, published_values
from message_words import says


def test_it_prints_the_exact_answer_and_ours(capsys: pytest.CaptureFixture[str]) -> None:
    assert run.main(["--without-mujoco", "bounce", "free_fall"]) == 0
    printed = capsys.readouterr().out
    assert "0.75                 0.75           0.75      not asked  exact" in printed
    assert "3 of 3 answers are exact within their tolerances" in printed


def test_an_answer_that_is_not_exact_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = replace(CASES["free_fall"], exact=lambda seconds: -4.9 * seconds**2)
    monkeypatch.setitem(run.CASES, "free_fall", wrong)
    assert run.main(["--without-mujoco", "free_fall"]) == run.NOT_EXACT
    printed = capsys.readouterr().out
    assert "WRONG" in printed
    assert "0 of 1 answers are exact" in printed


def test_another_engine_has_a_column_and_an_option(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    peer = Engine(name="Peer", package="numpy", module=OURS.module)
    for module in (arguments, run):
        monkeypatch.setattr(module, "PEERS", (peer, replace(peer, name="Other", package="not_installed")))
    assert run.main(["free_fall"]) == 0
    printed = capsys.readouterr()
    assert f"Peer {peer.version}".rjust(14) + " " * 10 + "Other\n" in printed.out
    assert "-4.90332       -4.90332         -4.903  not installed  exact" in printed.out
    assert says(printed.err, "Other is not installed... pip install not_installed")
    assert run.main(["free_fall", "--without-numpy", "--without-not_installed"]) == 0
    printed = capsys.readouterr()
    assert "-4.90332      not asked      not asked  exact" in printed.out
    assert printed.err == ""


def test_the_list_asks_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert run.main(["--list"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == len(CASES)
    assert printed[0].startswith("creeping_capsule ")


def test_an_unknown_name_is_refused_with_those_that_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        run.main(["ladders"])
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert says(told, "must be one of creeping_capsule..., got ladders")


@pytest.mark.parametrize(
    ("value", "tolerance", "text"),
    [(-4e-16, 1e-14, "0"), (1.0964e-8, 1e-14, "1.0964e-08"), (2.5, 0.0, "2.5")],
)
def test_rounding_is_not_shown(value: float, tolerance: float, text: str) -> None:
    assert run.shown(value, tolerance) == text


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
