# SPDX-License-Identifier: Apache-2.0
"""The contents of a log, or of any other bag: its time span, bodies, topics, and requests by their status."""

from __future__ import annotations

import warnings
from collections import Counter
from typing import TYPE_CHECKING

from contact_dynamics.constants import to_seconds
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.nodes.run_record import LoggedParameters
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.recording.service_calls import service_calls
from contact_dynamics.replay.logged import status_of
from contact_dynamics.replay.report import utc
from contact_dynamics.replay.timeline import is_event_of_ours, part_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.recording.service_calls import ServiceCall

BYTES_PER_MB = 1e6


def info(path: Path) -> str:
    """Return the contents of a log as text for a terminal. Each message is read once.

    Raises:
        NotALogError: there is no log at the path.
    """
    log = BagReader(path)
    messages: Counter[tuple[str, str]] = Counter()
    calls: Counter[tuple[str, str]] = Counter()
    stamps: list[int] = []

    def counted() -> Iterator[LoggedMessage]:
        for message in log.messages():
            stamps[:] = [min([message.log_time_ns, *stamps]), max([message.log_time_ns, *stamps])]
            if is_event_of_ours(message):
                yield message
            else:
                messages[message.topic, message.type_name] += 1

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # told below
        run = log.run()
        for call in service_calls(counted()):
            calls[call.service, _status(call)] += 1
    files = f"{len(log.paths)} file{'s'[: len(log.paths) > 1]}, {log.size / BYTES_PER_MB:.3g} MB"
    lines = [str(path), f"  {files}, written by contact_dynamics {run['version']}" if run else f"  {files}"]
    if stamps:
        lines.append(f"  {utc(stamps[0])} to {utc(stamps[-1])}, {to_seconds(stamps[-1] - stamps[0]):.3f} s")
    parameters = LoggedParameters(run)
    if run:
        names = {kind: ", ".join(parameters.value(kind, [], "")) for kind in ("bodies", "surfaces")}
        lines += [f"  {kind}: {listed or 'none'}" for kind, listed in names.items()]
    topics = [(topic, kind, str(count)) for (topic, kind), count in sorted(messages.items())]
    lines += _table(("topic", "type", "messages"), topics)
    statuses = sorted({status for _, status in calls}, key=lambda status: (status != "OK", status))
    services = sorted({service for service, _ in calls})
    counts = [(service, *(str(calls[service, status]) for status in statuses)) for service in services]
    lines += _table(("service", *statuses), counts)
    if log.damage is not None:
        lines.append(f"  {log.damage}")
    return "\n".join(lines)


def _status(call: ServiceCall) -> str:
    if call.response_event is None:
        return "no response"
    try:
        return status_of(part_of(call.response_event, "response"))
    except InvalidFieldError:  # introspection was set to metadata
        return "without contents"


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table, if it has rows, after an empty line. Numbers are aligned to the right."""
    if not rows:
        return []
    columns = list(zip(heads, *rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    texts = [
        [cell.rjust(width) if column[1].isdigit() else cell.ljust(width) for cell in column]
        for column, width in zip(columns, widths, strict=True)
    ]
    return ["", *(f"  {'  '.join(cells).rstrip()}" for cells in zip(*texts, strict=True))]
