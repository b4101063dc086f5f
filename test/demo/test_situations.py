# SPDX-License-Identifier: Apache-2.0
"""The examples as they are launched: server, publisher and commentator, each a process, and what is told."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from contact_dynamics.demo.arguments import PUSHED_BLOCK, THROWN_BOX, TRAY
from running_server import ROOT, environment, process

PATIENCE_S = 60.0


def told(situation: str, config: str, *arguments: str, all_of: tuple[str, ...]) -> str:
    """What the commentator prints until the states end; the publisher's arguments follow its name.

    It is shown again, at most four times, until the commentator tells all of this in this order: where a
    machine stalls for a moment, the states of that moment pass without a comment.
    """
    for _ in range(5):
        printed = _told(situation, config, *arguments)
        if are_in_order(printed, all_of):
            break
    return printed


def _told(situation: str, config: str, *arguments: str) -> str:
    parameters = ("--ros-args", "--params-file", str(ROOT / "config" / config))
    command = [sys.executable, "-m", "contact_dynamics", "commentator", situation, *parameters]
    with process("server", *parameters, "-p", "log:=false", ready="ready"):
        commentator = subprocess.Popen(
            command, cwd=ROOT, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        try:
            with process(*arguments, *(parameters if arguments[0] == "block_publisher" else ())):
                printed, _ = commentator.communicate(timeout=PATIENCE_S)
        finally:
            commentator.kill()
            commentator.wait()
    assert commentator.returncode == 0, printed
    return printed


def are_in_order(printed: str, words: tuple[str, ...]) -> bool:
    return re.search(".*".join(re.escape(each) for each in words), printed, re.DOTALL) is not None


SLIDES = ("it stays fixed", "N, then it slides right", "it slides right", "it stays fixed")


@pytest.fixture(scope="module")
def slid() -> str:
    return told(
        PUSHED_BLOCK, "pushed_block.yaml", "block_publisher", PUSHED_BLOCK, "--rate", "5", "--seconds", "4",
        all_of=SLIDES,
    )  # fmt: skip


def test_a_block_that_is_pushed_stays_slides_and_stays(slid: str) -> None:
    assert are_in_order(slid, SLIDES), slid


def test_it_slides_from_the_push_on_that_friction_can_hold(slid: str) -> None:
    """The states come from springs, which choose no mode, and the modes from the server."""
    pushes = [float(push) for push in re.findall(r"pushed with ([1-9]\.\d\d) N: it slides right", slid)]
    stays = [float(push) for push in re.findall(r"pushed with (\d\.\d\d) N: it stays fixed", slid)]
    # Of 1 kg with friction 0.5. Up to 5 mm/s count as rest, which the block reaches in 45 ms at 5 N/s.
    assert min(pushes) > 0.5 * 9.80665 - 0.01
    assert max(stays) < 0.5 * 9.80665 + 0.25


@pytest.mark.slow
def test_a_block_that_is_pushed_high_tips() -> None:
    tips = ("it stays fixed", "N, then it tips (2 contacts separate, 2 stay fixed)")
    printed = told(
        PUSHED_BLOCK, "pushed_block.yaml", "block_publisher", PUSHED_BLOCK,
        "--height", "0.15", "--rate", "2", "--seconds", "5", all_of=tips,
    )  # fmt: skip
    assert are_in_order(printed, tips), printed
    # It has fallen onto its side, where it is pushed no more and stands wider.
    assert "N, then it slides left" in printed.splitlines()[-1]


def test_a_block_slides_on_a_tray_that_tilts_until_it_meets_the_rim() -> None:
    meets = ("it stays fixed", ": it slides right", "it stays fixed", "4 contacts separate, 4 slide left")
    printed = told(
        TRAY, "tray.yaml", "block_publisher", TRAY, "--degrees-per-second", "12", "--seconds", "4",
        all_of=meets,
    )  # fmt: skip
    assert are_in_order(printed, meets), printed
    # atan 0.3 = 16.7 degrees.
    tilts = [float(tilt) for tilt in re.findall(r"by ([ .\d]+) degrees: it slides right", printed)]
    assert min(tilts) > 16.6


@pytest.mark.slow
def test_a_box_that_is_thrown_lands_and_lies() -> None:
    lands = ("it lands in", "s on floor, where it", "and leaves with (", "it touches: it stays fixed")
    printed = told(THROWN_BOX, "server.yaml", "toss_publisher", "--listeners", "2", all_of=lands)
    assert are_in_order(printed, lands), printed
