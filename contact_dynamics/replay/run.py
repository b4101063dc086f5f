# SPDX-License-Identifier: Apache-2.0
"""The command `contact-dynamics replay`: one function for each mode that needs no ROS."""

from __future__ import annotations

import os
import signal
import sys
import warnings
from collections import Counter
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import ns_after, to_seconds
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.nodes.parameter_file import ParameterFile, values_of
from contact_dynamics.nodes.run_record import LoggedParameters
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError
from contact_dynamics.recording.file_messages import Span
from contact_dynamics.recording.service_calls import service_calls
from contact_dynamics.replay.arguments import (
    INFO,
    PUBLISH,
    TABLE,
    VERIFY,
    VIEW,
    check_read,
    replay_parser,
    stamps_as_logged,
)
from contact_dynamics.replay.events import AskedEvents, LoggedEvents, status_of
from contact_dynamics.replay.progress import Progress
from contact_dynamics.replay.rows import Rows
from contact_dynamics.replay.table_file import open_table
from contact_dynamics.replay.timeline import is_event_of_ours, part_of
from contact_dynamics.replay.verify import AS_LOGGED, report, summary, utc, verify_log

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Sequence

    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.recording.service_calls import ServiceCall
    from contact_dynamics.replay.events import Events

DIFFERENT: Final = 1
"""The exit code if an answer differs, a call cannot be read, a viewer failed, or there is nothing to write or
publish."""

NO_LOG: Final = 2  # the exit code if a file cannot be replayed at all
LACKS: Final = 3  # the exit code if a mode requires a package that is not installed

_KINDS: Final = ("*.mcap*", "*.db3*")


def main(arguments: list[str]) -> int:
    """Run the mode that the arguments name and return the exit code."""
    parser = replay_parser()
    ours, of_ros = _split(arguments)
    given = parser.parse_args(ours)
    check_read(parser, given)
    if of_ros and given.mode != PUBLISH:
        parser.error(f"--ros-args must be used with {PUBLISH}, got {given.mode}")
    if given.mode == PUBLISH and given.rate != 1.0 and not stamps_as_logged(given):
        parser.error(
            f"--rate must be 1 if stamps are shifted to the present, got {given.rate:g}: velocities do not "
            "match stretched stamps. With --clock, stamps are unchanged, for a server with use_sim_time"
        )
    if given.mode == VERIFY:
        if not given.logs:  # argparse would report this before a mistyped option
            parser.error("at least one LOG is required")
        return _verify(given)
    lacking = _lacking(given.mode)
    if lacking:
        return _refused(f"{given.mode} requires {lacking}", LACKS)
    try:
        without_ros = {INFO: _info, TABLE: _table, VIEW: _view}
        if given.mode in without_ros:
            return without_ros[given.mode](given)
        from contact_dynamics.replay.publish import publish  # it needs ROS

        return publish(given, of_ros, span=_span(Path(given.log), given))
    except (ContactDynamicsError, OSError) as error:
        return _refused(str(error), NO_LOG)


def _verify(given: argparse.Namespace) -> int:
    try:
        instead = values_of(None if given.config is None else Path(given.config), given.set)
    except (ContactDynamicsError, OSError) as error:
        return _refused(str(error), NO_LOG)
    worst = 0
    results: list[tuple[str, str]] = []
    logs: list[Path] = []
    for name in given.logs:
        try:
            logs += logs_in(Path(name))
        except OSError as error:  # noqa: PERF203  a folder that may not be read, a name that no file has
            worst = _refused(str(error), NO_LOG)
    for log in logs:
        progress = _progress(log)
        try:
            found = verify_log(log, tolerance=given.tolerance, instead=instead, on_progress=progress.tell)
        except (ContactDynamicsError, OSError) as error:
            progress.end()
            worst = _refused(str(error), NO_LOG)
            results.append((str(log), "cannot be verified"))
            continue
        progress.end()
        print(report(found), flush=True)
        results.append((str(log), AS_LOGGED if found.agrees else "different"))
        worst = max(worst, 0 if found.agrees else DIFFERENT)
    if len(logs) > 1:
        print(summary(results))
    return worst


def _info(given: argparse.Namespace) -> int:
    print("\n\n".join(info(log) for name in given.logs for log in logs_in(Path(name))))
    return 0


def _table(given: argparse.Namespace) -> int:
    worst = 0
    with open_table(None if given.output is None else Path(given.output)) as write:
        for name in given.logs:
            progress = _progress(Path(name))
            count = 0
            try:
                events = _events(Path(name), given)
                for count, row in enumerate(Rows(events, log=name), start=1):
                    write(row)
                    log_time_ns = row["log_time_ns"]
                    progress.tell(log_time_ns if isinstance(log_time_ns, int) else 0, f"{count} rows")
            except (ContactDynamicsError, OSError) as error:
                if len(given.logs) == 1:
                    raise
                worst = _refused(str(error), NO_LOG)
                continue
            finally:
                progress.end()
            _tell(name, f"{count} rows", events)
            if count == 0:
                worst = max(worst, _refused(f"{name}: no rows: {events.why_empty}", DIFFERENT))
    return worst


def _view(given: argparse.Namespace) -> int:
    from contact_dynamics.replay.view import draw  # rerun takes a second to import
    from contact_dynamics.viewing.sinks import Sinks, ViewerMode

    chosen = [
        mode for mode, on in ((ViewerMode.SERVE, given.serve), (ViewerMode.CONNECT, given.connect)) if on
    ]
    if given.spawn or not (chosen or given.rrd):
        chosen = [ViewerMode.SPAWN]
    sinks = Sinks(
        rrd_path=given.rrd,
        viewer=chosen[0] if chosen else ViewerMode.NONE,
        port=given.port,
        url=given.connect,
    )
    path = Path(given.log)
    events = _events(path, given)
    progress = _progress(path)
    if given.serve:  # both SIGTERM and Ctrl-C close the sinks
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    drawn = draw(str(path), events, sinks, surface_side=given.surface_side, progress=progress)
    progress.end()
    _tell(str(path), f"drew {drawn.states} states and {drawn.answers} responses", events)
    if not drawn.took_all:
        sys.stdout.flush()
        os._exit(DIFFERENT)  # a normal exit would wait for a viewer that hangs
    return DIFFERENT if drawn.viewer_failed else 0


def logs_in(path: Path) -> list[Path]:
    """Return a log, or the logs whose folders are in a folder at any depth, by name."""
    if not path.is_dir() or _is_bag(path):
        return [path]
    return list(_logs_below(path)) or [path]


def _logs_below(path: Path) -> Iterator[Path]:
    for folder in sorted(inner for inner in path.iterdir() if inner.is_dir()):
        if _is_bag(folder):
            yield folder
        elif not folder.is_symlink():  # links can be circular
            yield from _logs_below(folder)


def _is_bag(folder: Path) -> bool:
    return any(next(folder.glob(kind), None) is not None for kind in _KINDS)


def _events(path: Path, given: argparse.Namespace) -> Events:
    span = _span(path, given)
    if given.config is None and not given.ask:
        return LoggedEvents(path, span=span)
    source: ParameterSource
    if given.config is not None:
        source = ParameterFile(Path(given.config), given.topics)
    elif run := BagReader(path).run():
        source = LoggedParameters(run)
    else:
        raise NotALogError(f"{path}: the log does not contain a configuration; specify one with --config")
    return AskedEvents(
        path,
        source,
        names=given.ask,
        bodies=given.body,
        every=given.every,
        fit_window=given.fit_window,
        span=span,
    )


def _span(path: Path, given: argparse.Namespace) -> Span:
    """Return the part of a log between --start and --end, which are relative to its beginning.

    Raise `InvalidFieldError`, with the log's length, if this part is empty.
    """
    if given.start == 0.0 and given.end is None:
        return Span()
    log = BagReader(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # reported when the log is read
        start_ns, _ = log.extent()
        span = Span()
        if given.start > 0.0:
            span = span._replace(start_ns=ns_after(start_ns, given.start))
        if given.end is not None:
            span = span._replace(end_ns=ns_after(start_ns, given.end))
        if next(log.messages(**span._asdict()), None) is None:
            # A log that was cut short has no index, so its end is unknown.
            end_ns = max((message.log_time_ns for message in log.messages()), default=start_ns)
            end = "its end" if given.end is None else f"{given.end:g} s"
            lasts = f"{to_seconds(end_ns - start_ns):.9g} s (log_time {start_ns} to {end_ns} ns)"
            raise InvalidFieldError(
                "--start and --end", f"{given.start:g} s to {end}", f"a part of {path}, which lasts {lasts}"
            )
    return span


def _progress(path: Path) -> Progress:
    start_ns = end_ns = 0
    if sys.stderr.isatty():
        with suppress(ContactDynamicsError, OSError):  # damage is reported when the log is read
            start_ns, end_ns = BagReader(path).extent()
    return Progress(str(path), begin=start_ns, end=end_ns)


def _tell(name: str, what: str, events: Events) -> None:
    print(f"{name}: {what}", file=sys.stderr)
    for topic, refused in events.refused.items():
        print(
            f"  {topic}: {refused.count} messages are not states; reason of the first: {refused.reason}",
            file=sys.stderr,
        )
    if events.damage is not None:
        print(f"  {events.damage}", file=sys.stderr)


def _refused(reason: str, code: int) -> int:
    print(f"contact-dynamics replay: {reason}", file=sys.stderr)
    return code


def _lacking(mode: str) -> str:
    if mode == VIEW and find_spec("rerun") is None:
        return "rerun: pip install '.[view]'"
    if mode == PUBLISH and find_spec("rclpy") is None:
        return "ROS 2 Jazzy: source it, or run `make setup` in a clone (see README.md)"
    return ""


def _split(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return our arguments, and ROS's from `--ros-args` on."""
    given = list(arguments)
    at = given.index("--ros-args") if "--ros-args" in given else len(given)
    return given[:at], given[at:]


BYTES_PER_MB = 1e6


def info(path: Path) -> str:
    """Return the contents of a log as text for a terminal. Each message is read once.

    Raise `NotALogError` if there is no log at the path.
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
        warnings.simplefilter("ignore", DamagedLogWarning)  # reported below
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
    lines += _aligned(("topic", "type", "messages"), topics)
    statuses = sorted({status for _, status in calls}, key=lambda status: (status != "OK", status))
    services = sorted({service for service, _ in calls})
    counts = [(service, *(str(calls[service, status]) for status in statuses)) for service in services]
    lines += _aligned(("service", *statuses), counts)
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


def _aligned(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
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
