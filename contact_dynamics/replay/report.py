# SPDX-License-Identifier: Apache-2.0
"""Writes the result of a replay as text for a terminal."""

from __future__ import annotations

from datetime import datetime, timezone
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import NS_PER_S

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.replay.verify import OtherAnswer, Verification

AS_LOGGED: Final = "as logged"
"""What comes of a log whose answers are all the same today."""

_LONGEST_VALUE: Final = 120  # characters, since a message that an answer carries can be pages long


def report(found: Verification) -> str:
    """Return the table of one log, the answers that differ most, and what could not be read."""
    lines = [str(found.path)]
    changed = [
        f"{name} {text} (here {found.versions_now[name]})"
        for name, text in found.versions.items()
        if found.versions_now[name] != text
    ]
    if changed:
        lines.append(f"  written with {', '.join(changed)}: the last bits may differ (see --tolerance)")
    if found.instead:
        values = ", ".join(f"{name} {value}" for name, value in found.instead.items())
        lines.append(f"  with other parameters than logged: {values}")
    lines += _table(found)
    for other in found.others:
        lines += _other(other)
    untold = sum(tally.different for tally in found.services.values()) - len(found.others)
    if untold > 0:
        lines.append(f"  and {untold} more questions with smaller differences")
    lines += _gaps(found)
    return "\n".join(lines)


def summary(results: Sequence[tuple[str, str]]) -> str:
    """Return a table of several logs: the name of each, and what came of it."""
    width = max(len(name) for name, _ in results)
    good = sum(result == AS_LOGGED for _, result in results)
    lines = [f"  {name:{width}}  {result}" for name, result in results]
    return "\n".join([f"{good} of {len(results)} logs are answered as logged", *lines])


def utc(stamp_ns: int) -> str:
    """Return a time in ns since the epoch as date and time of day."""
    when = datetime.fromtimestamp(stamp_ns // NS_PER_S, timezone.utc)
    return f"{when:%Y-%m-%d %H:%M:%S}.{stamp_ns % NS_PER_S:09d} UTC"


def _table(found: Verification) -> list[str]:
    if not found.services:
        return ["  no questions"]
    within = f"within {found.tolerance:g}" if found.tolerance > 0.0 else ""
    heads = ["questions", "identical", *([within] if within else []), "different"]
    width = max(len(name) for name in found.services)
    lines = [f"  {'service':{width}}  {'  '.join(heads)}"]
    for name, tally in found.services.items():
        counts = [tally.questions, tally.equal, *([tally.within] if within else []), tally.different]
        cells = "  ".join(f"{count:>{len(head)}}" for count, head in zip(counts, heads, strict=True))
        lines.append(f"  {name:{width}}  {cells}")
    return lines


def _other(other: OtherAnswer) -> list[str]:
    fields = [
        f"    {each.field}: logged {_short(each.logged)}, recomputed {_short(each.recomputed)}"
        for each in other.differences
    ]
    asked = f"asked {utc(other.asked_ns)} (log_time {other.asked_ns})"
    return [f"  {other.service}, question {other.number}, {asked}:", *fields]


def _gaps(found: Verification) -> list[str]:
    lines = []
    other_state = sum(tally.other_state for tally in found.services.values())
    if other_state:
        lines.append(
            f"  {other_state} answers used other states than the logged ones, or none, and are not compared: "
            "DDS does not preserve the order of a state and a question"
        )
    unanswered = sum(tally.unanswered for tally in found.services.values())
    unreadable = sum(tally.unreadable for tally in found.services.values())
    if unanswered:
        lines.append(f"  not repeated, because the log contains no answer, or BUSY or TIMEOUT: {unanswered}")
    if unreadable:
        lines.append(f"  {unreadable} calls could not be read; the first: {found.unreadable}")
    if found.damage is not None:
        lines.append(f"  {found.damage}")
    if found.lost_bytes:
        lines.append(
            "  what was read is compared above; an answer can differ where a state that it used is lost"
        )
    return lines


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}..."
