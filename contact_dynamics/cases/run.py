# SPDX-License-Identifier: Apache-2.0
"""The command `contact-dynamics cases`: all engines' answers beside the exact ones, or published numbers."""

from __future__ import annotations

import math
import sys
from collections import Counter
from typing import Final

from contact_dynamics.cases.arguments import cases_parser
from contact_dynamics.cases.catalog import CASES
from contact_dynamics.cases.engine import OURS, PEERS, Engine
from contact_dynamics.cases.published import PublishedValue, PublishedVerdict, published_values

NOT_EXACT: Final = 1
"""This exit code says that an answer differs from the exact one by more than its tolerance."""

DIGITS: Final = 6  # significant digits of a number in the table


def main(arguments: list[str]) -> int:
    """Solve the cases, print the table and return the exit code."""
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
    skipped = [peer for peer in PEERS if getattr(given, f"without_{peer.package}")]
    versions = {peer: "" if peer in skipped else peer.version for peer in PEERS}
    exact = [row for name in names for row in _solve(name, versions, skipped)]
    print(f"{sum(exact)} of {len(exact)} answers are exact within their tolerances")
    for peer, version in versions.items():
        if not version and peer not in skipped:
            missing = f"{peer.name} is not installed, so its answers are missing: pip install {peer.package}"
            print(missing, file=sys.stderr)
    return 0 if all(exact) else NOT_EXACT


def _solve(name: str, versions: dict[Engine, str], skipped: list[Engine]) -> list[bool]:
    """Print the table of a case, and return for each row whether this package's answer is exact."""
    case, verdicts = CASES[name], []
    titles = ["exact", OURS.name, *(f"{peer.name} {version}".rstrip() for peer, version in versions.items())]
    print(
        f"{case.title}\n  {case.quantity}: {case.formula}\n  {case.setting}\n  {'':10} {_cells(titles)}",
        flush=True,
    )
    for setting in case.settings:
        exact, ours = case.exact(setting), OURS.answer(name, setting)
        verdicts.append(abs(ours - exact) <= case.tolerance)
        cells = [shown(exact, case.tolerance), shown(ours, case.tolerance)]
        for peer, version in versions.items():
            absent = "not asked" if peer in skipped else "not installed"
            cells.append(f"{peer.answer(name, setting):.4g}" if version else absent)
        verdict = "exact" if verdicts[-1] else "WRONG"
        print(f"  {setting:<10g} {_cells(cells)}  {verdict}", flush=True)
    print()
    return verdicts


def _cells(texts: list[str]) -> str:
    return " ".join(f"{text:>14}" for text in texts)


def shown(value: float, tolerance: float = 0.0) -> str:
    """Return a number with a few digits. What is below the tolerance is rounding, and is not shown."""
    if tolerance > 0.0:
        value = round(value, -math.floor(math.log10(tolerance)))
    return f"{value + 0.0:.{DIGITS}g}"


def published_row(value: PublishedValue, ours: float, verdict: PublishedVerdict) -> str:
    """Return one line about a published number, with a second one if the difference has an explanation."""
    explained = f"\n{'':42}{value.explained}" if verdict is PublishedVerdict.EXPLAINED else ""
    numbers = f"{value.expected:>14.{DIGITS}g} {ours:>14.{DIGITS}g} {value.tolerance:>10.2g}"
    return f"{numbers}  {verdict.name.lower():9} {value.what} [{value.where}]{explained}"


def _compare_published() -> int:
    counts: Counter[PublishedVerdict] = Counter()
    source = ""
    for value in published_values():
        if value.source != source:
            source = value.source
            print(f"{source}\n{'published':>14} {'ours':>14} {'tolerance':>10}")
        ours = value.ours()
        verdict = value.verdict(ours)
        counts[verdict] += 1
        print(published_row(value, ours, verdict))
    print(", ".join(f"{counts[verdict]} {verdict.name.lower()}" for verdict in PublishedVerdict))
    return NOT_EXACT if counts[PublishedVerdict.WRONG] else 0
