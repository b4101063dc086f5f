# SPDX-License-Identifier: Apache-2.0
"""An evaluation as text for a terminal."""

from __future__ import annotations

import math
from collections import Counter
from itertools import groupby
from typing import TYPE_CHECKING, Final

from contact_dynamics.evaluation.settings import Method
from contact_dynamics.evaluation.summary import LEVELS, Summary, spread_of, summarise
from contact_dynamics.measured.events import EventKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.evaluation.result import Evaluation
    from contact_dynamics.evaluation.significance import Change

UNITS: Final = {
    "time_error": ("time, ms", 1e3),
    "position_error": ("place, mm", 1e3),
    "attitude_error": ("attitude, deg", math.degrees(1.0)),
    "velocity_error": ("velocity, m/s", 1.0),
    "spin_error": ("spin, rad/s", 1.0),
    "wrong_mode": ("wrong modes", 1.0),
}
"""How each error is named and by what it is multiplied for people to read."""

COLUMNS: Final = {
    EventKind.FLIGHT: ("position_error", "attitude_error"),
    EventKind.LANDING: ("time_error", "position_error", "attitude_error"),
    EventKind.IMPACT: ("velocity_error", "spin_error"),
    EventKind.REST: (),
    EventKind.SLIDING: (),
}
"""The errors that tables and plots show of each kind of event."""

TITLES: Final = {
    EventKind.FLIGHT: "flights: where is the body near the flight's end?",
    EventKind.LANDING: "first contacts: when, where and how does it land?",
    EventKind.IMPACT: "impacts of one corner: which velocities does it have afterwards?",
    EventKind.REST: "rests: which contact mode?",
    EventKind.SLIDING: "slides: which contact mode?",
}

SEVERAL: Final = "impacts of several corners, or longer ones: which velocities does it have afterwards?"
"""The title of impacts whose outcome depends on which corners strike, and when."""

SIGNIFICANT: Final = 0.05
"""Probability below which a change is marked."""

MAX_PROBLEMS: Final = 20
"""Bad recordings that are named one by one; the JSON has them all."""

_WIDE: Final = 22


def report(evaluation: Evaluation) -> str:
    """Return the tables of an evaluation, and what could not be evaluated."""
    done = [result for result in evaluation.results if not result.problem]
    events = Counter(event.kind for result in done for event in result.events)
    found = ", ".join(f"{events[kind]} {kind.value}" for kind in EventKind if events[kind]) or "none"
    lines = [
        (
            f"{_recordings(len(done))}, {sum(result.states for result in done)} states, "
            f"{sum(result.seconds for result in done):.1f} s of motion; {evaluation.configuration}"
        ),
        f"events: {found}",
        *_gaps(evaluation),
    ]
    rows = [row for result in done for row in result.comparisons]
    if any(row.distance is not None for row in rows):
        lines.append("inside: share of measured values, %, in the regions predicted with these probabilities")
    for (kind, body, surface, several), grouped in groupby(
        summarise(rows), key=lambda each: (each.kind, each.body, each.surface, each.several)
    ):
        where, summaries = f"{body} on {surface}" if surface else body, list(grouped)
        title = SEVERAL if several else TITLES[kind]
        lines += ["", f"{title}  ({where})", *_table(kind, summaries), *_conclusion(summaries)]
    lines += _problems(evaluation)
    return "\n".join(lines)


def report_changes(found: Sequence[Change], *, names: tuple[str, str]) -> str:
    """Return the table of what changed from the evaluation of the first name to that of the second."""
    shown = [
        each
        for each in found
        if each.method is not Method.NO_IMPACT and each.error in ("wrong_mode", *COLUMNS[each.kind])
    ]
    lines = ["", f"from A, {names[0]}, to B, {names[1]}: mean errors of the same events"]
    if not shown:
        return "\n".join([*lines, "  no event that both have answered"])
    lines.append(f"  {'':43}{'error':>15}{'events':>8}{'A':>10}{'B':>10}{'95 % of B - A':>22}{'p':>9}")
    for each in shown:
        name, factor = UNITS[each.error]
        interval = f"{factor * each.low:.3g} to {factor * each.high:.3g}"
        chance = f"{each.probability:.2g}"
        mark = " *" if each.probability < SIGNIFICANT else ""
        what = f"{each.kind.value}, {1e3 * each.horizon:.0f} ms, {_method(each)}"
        lines.append(
            f"  {what:43}{name:>15}{each.pairs:>8}{factor * each.first:>10.3g}{factor * each.second:>10.3g}"
            f"{interval:>22}{chance:>9}{mark}"
        )
    units = sorted({each.units for each in shown})
    lines.append(
        f"  p: Wilcoxon's signed-rank test over {' or '.join(units)}, adjusted for the number of lines "
        f"by Holm; * below {SIGNIFICANT:g}"
    )
    return "\n".join(lines)


def _gaps(evaluation: Evaluation) -> Iterator[str]:
    """Yield how high each body was measured when its flights ended, which should be zero."""
    gaps: dict[tuple[str, str], list[float]] = {}
    for result in evaluation.results:
        for event in result.events:
            if event.kind is EventKind.LANDING and event.gap is not None:
                gaps.setdefault((event.body, event.surface), []).append(event.gap)
    for (body, surface), found in gaps.items():
        spread = spread_of(found)
        yield (
            f"{body} above {surface} at first contact: median {1e3 * spread.bias:.2f} mm, "
            f"90 % within {1e3 * spread.most:.2f} mm (measured; zero were ideal)"
        )


def _table(kind: EventKind, summaries: Sequence[Summary]) -> Iterator[str]:
    columns = COLUMNS[kind]
    if not columns:
        yield f"  {'ms before':>9}  {'asked':>6}{'refused':>9}{'right':>8}"
        for each in summaries:
            right = "" if each.modes_right is None else f"{100.0 * each.modes_right:.0f} %"
            yield f"  {1e3 * each.horizon:>9.0f}  {each.asked:>6}{each.refused:>9}{right:>8}"
        return
    heads = "".join(f"{UNITS[name][0]:>{_WIDE}}" for name in columns)
    inside = "/".join(f"{100.0 * level:.0f}" for level in LEVELS)
    yield f"  {'ms before':>9}  {'from':<18}{'asked':>6}{'refused':>9}{heads}{f'inside {inside} %':>20}"
    yield f"  {'':>9}  {'':<18}{'':>6}{'':>9}{''.join(f'{_heads(name):>{_WIDE}}' for name in columns)}"
    for each in summaries:
        cells = "".join(f"{_cell(each, name):>{_WIDE}}" for name in columns)
        covered = "/".join(f"{100.0 * share:.0f}" for share in each.covered)
        yield (
            f"  {1e3 * each.horizon:>9.0f}  {_method(each):<18}{each.asked:>6}{each.refused:>9}"
            f"{cells}{covered:>20}"
        )


def _conclusion(summaries: Sequence[Summary]) -> Iterator[str]:
    """Yield what the table of impacts says about the laws, in words."""
    nearest = [each for each in summaries if each.horizon == summaries[0].horizon and each.errors]
    without = [each for each in nearest if each.method is Method.NO_IMPACT]
    laws = [each for each in nearest if each.method is Method.FIT and each.law is not None]
    if without and laws:
        best = min(laws, key=lambda each: each.errors["velocity_error"].median)
        yield (
            f"  with the configured coefficients, {_method(best)} is best: of a change of velocity of "
            f"{without[0].errors['velocity_error'].median:.2g} m/s in the median, it leaves "
            f"{best.errors['velocity_error'].median:.2g} m/s unpredicted"
        )
    if summaries[0].several:
        yield (
            "  which corners strike here, and when, decides as much as the law: judge laws and coefficients "
            "by impacts of one corner"
        )


def _heads(name: str) -> str:
    return "bias   median  90 %" if name == "time_error" else "median   90 %"


def _cell(summary: Summary, name: str) -> str:
    spread = summary.errors.get(name)
    if spread is None:
        return ""
    factor = UNITS[name][1]
    cell = f"{factor * spread.median:7.3g} {factor * spread.most:6.3g}"
    return f"{factor * spread.bias:+.2g} {cell}" if name == "time_error" else cell


def _method(each: Summary | Change) -> str:
    if each.method is Method.FIT:
        return "fit" if each.law is None else each.law.value
    return f"({each.method.value})"


def _named(source: str, problem: str) -> str:
    return problem if problem.startswith(f"{source}: ") else f"{source}: {problem}"


def _recordings(count: int) -> str:
    return f"{count} recording{'' if count == 1 else 's'}"


def _problems(evaluation: Evaluation) -> list[str]:
    bad = [result for result in evaluation.results if result.problem]
    lines = [f"  {_named(result.source, result.problem)}" for result in bad[:MAX_PROBLEMS]]
    if len(bad) > MAX_PROBLEMS:
        lines.append(f"  and {len(bad) - MAX_PROBLEMS} more")
    damaged = [result for result in evaluation.results if result.damage]
    lines += [f"  {result.damage}" for result in damaged[:MAX_PROBLEMS]]
    if len(damaged) > MAX_PROBLEMS:
        lines.append(f"  and {len(damaged) - MAX_PROBLEMS} more damaged recordings")
    if not lines:
        return []
    return ["", f"not evaluated: {_recordings(len(bad))}; damaged: {len(damaged)}", *lines]
