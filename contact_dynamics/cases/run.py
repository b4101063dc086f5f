"""The command `contact-dynamics cases` asks questions whose exact answers are known, and prints a table."""

from __future__ import annotations

import sys
from typing import Final

from contact_dynamics.cases.arguments import cases_parser
from contact_dynamics.cases.every_case import CASES
from contact_dynamics.cases.peer import mujoco_version
from contact_dynamics.cases.published import PublishedVerdict, published_values
from contact_dynamics.cases.report import asked, heading, published_row, row

NOT_EXACT: Final = 1
"""This exit code says that an answer differs from the exact one by more than its tolerance."""


def main(arguments: list[str]) -> int:
    """Ask the cases, print the table and return the exit code."""
    parser = cases_parser()
    given = parser.parse_args(arguments)
    unknown = [name for name in given.names if name not in CASES]
    if unknown:
        parser.error(f"NAME must be one of {', '.join(CASES)}, got {', '.join(unknown)}")
    if given.published:
        return _compare_published()
    names = given.names or list(CASES)
    if given.list:
        for name in names:
            print(f"{name:18} {CASES[name].title}")
        return 0
    version = "" if given.without_mujoco else mujoco_version()
    simulate = bool(version)
    absent = "not asked" if given.without_mujoco else "not installed"
    results = []
    for name in names:
        print(heading(CASES[name], f"MuJoCo {version}".rstrip()), flush=True)
        for setting in CASES[name].settings:
            one = asked(name, CASES[name], setting, simulate=simulate)
            results.append(one)
            print(row(one, no_mujoco=absent), flush=True)
        print()
    right = sum(one.is_right for one in results)
    print(f"{right} of {len(results)} answers are exact within their tolerances")
    if not simulate and not given.without_mujoco:
        print("MuJoCo is not installed, so its answers are missing: pip install mujoco", file=sys.stderr)
    return 0 if right == len(results) else NOT_EXACT


def _compare_published() -> int:
    counts = dict.fromkeys(PublishedVerdict, 0)
    source = ""
    for value in published_values():
        if value.source != source:
            source = value.source
            print(f"{source}\n{'published':>14} {'ours':>14} {'tolerance':>10}")
        ours = value.ours()
        verdict = value.verdict(ours)
        counts[verdict] += 1
        print(published_row(value, ours, verdict))
    print(", ".join(f"{count} {verdict.name.lower()}" for verdict, count in counts.items()))
    return NOT_EXACT if counts[PublishedVerdict.WRONG] else 0
