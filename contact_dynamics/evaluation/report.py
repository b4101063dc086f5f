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
    "position_error": ("position, mm", 1e3),
    "attitude_error": ("attitude, deg", math.degrees(1.0)),
    "velocity_error": ("velocity, m/s", 1.0),
    "spin_error": ("spin, rad/s", 1.0),
    "wrong_mode": ("wrong modes", 1.0),
}
"""Label of each error with its displayed unit, and the factor from SI units."""

COLUMNS: Final = {
    EventKind.FLIGHT: ("position_error", "attitude_error"),
    EventKind.LANDING: ("time_error", "position_error", "attitude_error"),
    EventKind.IMPACT: ("velocity_error", "spin_error"),
    EventKind.REST: (),
    EventKind.SLIDING: (),
}
"""Errors in tables and plots, by kind of event."""

TITLES: Final = {
    EventKind.FLIGHT: "flights: pose near the end of the flight",
    EventKind.LANDING: "first contacts: time and pose",
    EventKind.IMPACT: "impacts of a single corner: velocities after the impact",
    EventKind.REST: "rests: contact mode",
    EventKind.SLIDING: "slides: contact mode",
}

SEVERAL: Final = "impacts of several corners, or longer ones: velocities after the impact"
"""Title for impacts whose outcome depends on which corners strike, and when."""

SIGNIFICANT: Final = 0.05  # p-value below which a change is marked
MAX_PROBLEMS: Final = 20  # Largest number of listed recordings with problems. The JSON contains all.

_WIDE: Final = 22


def report(evaluation: Evaluation) -> str:
    """Return the tables of an evaluation, and the recordings that could not be evaluated."""
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
    if events and not rows:
        lines.append("no predictions: no event is preceded by states over one of the horizons")
    if any(row.distance is not None for row in rows):
        lines.append("inside: share of measured values inside the 50, 90 and 95 % prediction regions, %")
    for (kind, body, surface, several), grouped in groupby(
        summarise(rows), key=lambda each: (each.kind, each.body, each.surface, each.several)
    ):
        where, summaries = f"{body} on {surface}" if surface else body, list(grouped)
        title = SEVERAL if several else TITLES[kind]
        lines += ["", f"{title}  ({where})", *_table(kind, summaries), *_conclusion(summaries)]
    lines += _problems(evaluation)
    return "\n".join(lines)


def report_changes(found: Sequence[Change], *, names: tuple[str, str]) -> str:
    """Return the table of changes from a first evaluation to a second one, with the names of both."""
    shown = [
        each
        for each in found
        if each.method is not Method.NO_IMPACT and each.error in ("wrong_mode", *COLUMNS[each.kind])
    ]
    lines = ["", f"mean errors of the same events, A: {names[0]}, B: {names[1]}"]
    if not shown:
        return "\n".join([*lines, "  no event was predicted in both"])
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
        f"  p: Wilcoxon's signed-rank test over {' or '.join(units)}, corrected for multiple comparisons by "
        f"Holm's method; * below {SIGNIFICANT:g}"
    )
    return "\n".join(lines)


def _gaps(evaluation: Evaluation) -> Iterator[str]:
    """Yield the measured gap of each body to its surface at first contact, which should be zero."""
    gaps: dict[tuple[str, str], list[float]] = {}
    for result in evaluation.results:
        for event in result.events:
            if event.kind is EventKind.LANDING and event.gap is not None:
                gaps.setdefault((event.body, event.surface), []).append(event.gap)
    for (body, surface), found in gaps.items():
        spread = spread_of(found)
        yield (
            f"{body} above {surface} at first contact: median {1e3 * spread.bias:.2f} mm, "
            f"90 % within {1e3 * spread.most:.2f} mm (measured; ideally 0)"
        )


def _table(kind: EventKind, summaries: Sequence[Summary]) -> Iterator[str]:
    columns = COLUMNS[kind]
    if not columns:
        yield f"  {'horizon, ms':>11}  {'requests':>8}{'rejected':>10}{'impact':>8}{'correct, %':>12}"
        for each in summaries:
            correct = "" if each.modes_right is None else f"{100.0 * each.modes_right:.0f}"
            counts = f"{each.asked:>8}{each.refused:>10}{each.impacts:>8}"
            yield f"  {1e3 * each.horizon:>11.0f}  {counts}{correct:>12}"
        return
    heads = "".join(f"{UNITS[name][0]:>{_WIDE}}" for name in columns)
    inside = "/".join(f"{100.0 * level:.0f}" for level in LEVELS)
    counts = f"{'requests':>8}{'rejected':>10}"
    yield f"  {'horizon, ms':>11}  {'method':<12}{counts}{heads}{f'inside {inside}, %':>20}"
    yield f"  {'':>11}  {'':<12}{'':>8}{'':>10}{''.join(f'{_heads(name):>{_WIDE}}' for name in columns)}"
    for each in summaries:
        cells = "".join(f"{_cell(each, name):>{_WIDE}}" for name in columns)
        covered = "/".join(f"{100.0 * share:.0f}" for share in each.covered)
        yield (
            f"  {1e3 * each.horizon:>11.0f}  {_method(each):<12}{each.asked:>8}{each.refused:>10}"
            f"{cells}{covered:>20}"
        )


def _conclusion(summaries: Sequence[Summary]) -> Iterator[str]:
    """Yield the conclusions from a table about laws or contact modes, in words."""
    worst = max(summaries, key=lambda each: each.impacts / each.asked)
    if worst.impacts:
        yield (
            f"  {worst.impacts} of {worst.asked} requests {1e3 * worst.horizon:.0f} ms in advance returned "
            "an impact: the published velocity still approached the surface. They do not count as correct or "
            "incorrect contact modes"
        )
    nearest = [each for each in summaries if each.horizon == summaries[0].horizon and each.errors]
    without = [each for each in nearest if each.method is Method.NO_IMPACT]
    laws = [each for each in nearest if each.method is Method.FIT and each.law is not None]
    if without and laws:
        best = min(laws, key=lambda each: each.errors["velocity_error"].median)
        yield (
            f"  with the configured coefficients, {_method(best)} has the smallest median error: "
            f"{best.errors['velocity_error'].median:.2g} m/s of a median velocity change of "
            f"{without[0].errors['velocity_error'].median:.2g} m/s"
        )
    if summaries[0].several:
        yield (
            "  here, the error also depends on which corners hit, and when: compare laws and coefficients on "
            "impacts of a single corner"
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
