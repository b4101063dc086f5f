# SPDX-License-Identifier: Apache-2.0
"""Recomputes the response to every logged request, with the logged states, and reports the differences."""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import dataclass, replace
from dataclasses import field as attribute
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.nodes.run_record import versions_here
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.recording.message_types import PRIMITIVES, PYTHON_TYPES, Field, Message
from contact_dynamics.recording.service_calls import ServiceCall
from contact_dynamics.replay.of_log import server_of_log
from contact_dynamics.replay.timeline import in_order, part_of
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from contact_dynamics.replay.again import ServerAgain

_PUBLISHERS: Final = re.compile(r" \(\d+ publishers?\)")
"""The number of publishers in a message, which is not in the log, and not compared either."""

_LONGEST_VALUE: Final = 120  # characters; a response can contain pages of text

_QUATERNION: Final = "geometry_msgs/Quaternion"
_QUATERNIONS: Final = "orientations"  # how the names of lists of quaternions end, row-major (n, 4)

MEASURED: Final = frozenset({"computation_time"})
"""Fields of a response that describe the computation, not its result. They are not compared."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """One field in which two responses differ."""

    field: str  # path of the field within the response, as in "modes[2].margin"
    logged: object  # its value in the log, or the name of that value if it has one
    recomputed: object  # its recomputed value, or its name
    # The difference relative to the larger of the two, or to 1 if both are smaller. For quaternions it is
    # that of the attitudes, which q and -q share. It is infinite if the values are not numbers, if one of
    # them is not finite, or if arrays have unequal lengths.
    size: float
    is_length: bool = False  # whether it is the number of elements of an array

    @property
    def rank(self) -> tuple[bool, bool, bool, float]:
        """Sort key: fields, then elements of arrays, then lengths; the largest differences first.

        Fields and elements whose difference does not show in 6 digits come last in their group.
        """
        is_hidden = _rounded(self.logged) == _rounded(self.recomputed)
        return self.is_length, is_hidden, self.field.endswith("]"), -self.size


def in_words(difference: Difference) -> str:
    """Return a difference as a line. Numbers have 6 digits, or all of them if these are the same."""
    one, other = _rounded(difference.logged), _rounded(difference.recomputed)
    if one == other:
        one, other = repr(difference.logged), repr(difference.recomputed)
    return f"{difference.field}: logged {one}, recomputed {other}"


def _rounded(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else repr(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}..."


def differences(logged: Message, recomputed: object, *, path: str = "") -> Iterator[Difference]:
    """Yield each field of a logged message whose value in another message is not bitwise equal."""
    for field in logged.FIELDS:
        if not path and field.name in MEASURED:
            continue
        name = f"{path}.{field.name}" if path else field.name
        ours = getattr(logged, field.name)
        if not hasattr(recomputed, field.name):
            yield Difference(field=name, logged=ours, recomputed="no such field", size=math.inf)
            continue
        theirs = getattr(recomputed, field.name)
        if not field.is_array:
            yield from _of_one(field, name, ours, theirs)
        elif field.type_name in PRIMITIVES:
            yield from _of_numbers(field, name, ours, theirs)
        elif len(ours) != len(theirs):
            yield _of_lengths(name, len(ours), len(theirs))
        else:
            for index, (one, other) in enumerate(zip(ours, theirs, strict=True)):
                yield from _of_one(field, f"{name}[{index}]", one, other)


def _of_one(field: Field, name: str, ours: Any, theirs: Any) -> Iterator[Difference]:
    if field.type_name in PRIMITIVES:
        yield from _of_numbers(field, name, [ours], [theirs], is_array=False)
    elif field.type_name == "string":
        if _PUBLISHERS.sub("", ours) != _PUBLISHERS.sub("", theirs):
            yield Difference(field=name, logged=ours, recomputed=theirs, size=math.inf)
    elif field.type_name == _QUATERNION:
        sign = _signs(*([[getattr(each, part) for part in "xyzw"]] for each in (ours, theirs)))[0]
        for each in differences(ours, theirs, path=name):
            yield replace(each, size=_size(each.logged, sign * each.recomputed))  # type: ignore[arg-type]
    else:
        yield from differences(ours, theirs, path=name)


def _signs(ours: Any, theirs: Any) -> NDArray[np.float64]:
    """Return -1 for each pair of quaternions, (n, 4), in opposite halves, since q and -q are one attitude."""
    return np.where(np.einsum("ni,ni->n", ours, theirs) < 0.0, -1.0, 1.0)


def _of_numbers(
    field: Field, name: str, ours: Any, theirs: Any, *, is_array: bool = True
) -> Iterator[Difference]:
    if len(ours) != len(theirs):
        yield _of_lengths(name, len(ours), len(theirs))
        return
    code = PRIMITIVES[field.type_name]
    one, other = np.array(ours, dtype=code), np.array(theirs, dtype=code)
    if one.tobytes() == other.tobytes():
        return
    to_python = PYTHON_TYPES[field.type_name]
    signs = np.ones(len(one))
    if field.name.endswith(_QUATERNIONS) and len(one) % 4 == 0:
        signs = np.repeat(_signs(one.reshape(-1, 4), other.reshape(-1, 4)), 4)
    for index in range(len(one)):
        x, y = to_python(one[index]), to_python(other[index])
        if one[index].tobytes() == other[index].tobytes() or (math.isnan(x) and math.isnan(y)):
            continue
        where = f"{name}[{index}]" if is_array else name
        size = _size(x, float(signs[index]) * y) if to_python is float else math.inf
        logged, recomputed = field.names.get(x, x), field.names.get(y, y)
        yield Difference(field=where, logged=logged, recomputed=recomputed, size=size)


def _of_lengths(name: str, ours: int, theirs: int) -> Difference:
    return Difference(
        field=f"number of {name}", logged=ours, recomputed=theirs, size=math.inf, is_length=True
    )


def _size(x: float, y: float) -> float:
    """Return the distance of two numbers relative to the larger one, or to 1 if both are smaller."""
    if not (math.isfinite(x) and math.isfinite(y)):
        return math.inf
    return abs(x - y) / max(1.0, abs(x), abs(y))


MAX_TOLD: Final = 10  # number of requests whose differences are kept, those with the largest ones
BY_LOAD: Final = ("BUSY", "TIMEOUT")  # the status codes of responses that depend on the load of the machine
MAX_FIELDS_TOLD: Final = 5  # number of fields kept for one response, those that differ most


@dataclass(slots=True, kw_only=True)
class ServiceTally:
    """Counts of the requests to one service, by the comparison of their responses."""

    questions: int = 0  # requests that were answered again
    equal: int = 0  # responses that are bitwise equal to the logged ones
    within: int = 0  # responses that differ within the tolerance
    different: int = 0  # responses that differ by more than the tolerance
    # Responses that used other states than the logged ones, and are not compared. Only `replay publish` has
    # such.
    other_state: int = 0
    # Requests without a response in the log, or with BUSY or TIMEOUT, which depend on the load of the
    # machine. They are not repeated.
    unanswered: int = 0
    unreadable: int = 0  # calls whose request is missing, or that cannot be decoded


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherAnswer:
    """A request whose response differs from the logged one."""

    service: str  # the service's name with its leading slash
    number: int  # number of the request among those to this service, from 1
    # When it arrived, ns since the epoch, by the machine's clock: the ``log_time`` of its event.
    asked_ns: int
    differences: tuple[Difference, ...]  # the fields that differ most, in the order of `Difference.rank`
    # Number of later requests to this service with the same differences, to the digits shown.
    repeated: int = 0


@dataclass(slots=True, kw_only=True)
class Verification:
    """The result of one log's replay."""

    path: Path  # path of the log
    tolerance: float  # allowed difference, relative to the larger number, or to 1 if both are smaller
    versions: dict[str, str]  # versions of the libraries that wrote the log, by name
    versions_now: dict[str, str]  # versions of the libraries that recomputed the responses, by name
    # Values of parameters that replaced those in the log, by name.
    instead: dict[str, Any] = attribute(default_factory=dict)
    services: dict[str, ServiceTally] = attribute(default_factory=dict)  # tallies by the service's name
    # The requests whose responses differ most, in the order of their first differences.
    others: list[OtherAnswer] = attribute(default_factory=list)
    unreadable: str | None = None  # the first reason why a call could not be read, or None if all could
    damage: str | None = None  # a description of the damaged parts of the log, or None if there are none
    lost_bytes: int = 0  # number of unreadable bytes of the log

    @property
    def agrees(self) -> bool:
        """Whether all readable requests have the same responses as in the log, within the tolerance."""
        return not any(tally.different or tally.unreadable for tally in self.services.values())


def nothing_yet(
    path: Path, run: Mapping[str, str], *, tolerance: float, instead: Mapping[str, Any] | None = None
) -> Verification:
    """Return the result of a log's replay before the first response; ``run`` is the log's record."""
    here = versions_here()
    return Verification(
        path=path,
        tolerance=tolerance,
        versions={name: run[name] for name in here if name in run},
        versions_now=here,
        instead=dict(instead or {}),
    )


def verify_log(
    path: Path,
    *,
    tolerance: float = 0.0,
    instead: Mapping[str, Any] | None = None,
    on_progress: Callable[[int, str], object] | None = None,
) -> Verification:
    """Recompute the response to every request of a log, and compare it with the logged one field by field.

    Fields that describe the computation (`MEASURED`) are not compared.

    Args:
        path: a log of the server, as its folder or as an ``.mcap`` file.
        tolerance: >= 0. How much a number may differ, relative to the larger one, or to 1 if both are
            smaller; quaternions are compared with the sign that fits. With zero every bit counts.
        instead: values of parameters, by name, that replace those in the log, to compute the responses that
            they would have given.
        on_progress: a function that is called after each message, with its log time, ns, and a description of
            what was read so far.

    Raises:
        NotALogError: the path is not a log of the server.
        ConfigurationError: its record of the run lacks a parameter, or has one that is not allowed.
        NotSupportedError: the log's services differ in their fields from this version's; or ROS is not
            installed, and another log in this process defined a message with different fields.
    """
    check_not_negative("tolerance", tolerance)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # the result contains the damage
        run, server = server_of_log(path, instead=instead)
        found = nothing_yet(path, run, tolerance=tolerance, instead=instead)
        log, again = BagReader(path), BagReader(path)
        states = questions = 0
        for each in in_order(log, again, server.topics):
            if isinstance(each, ServiceCall):
                questions += 1
                _ask(each, server, found)
            else:
                states += 1
                server.receive(each)
                if on_progress is not None:
                    on_progress(each.log_time_ns, f"{states} states, {questions} requests")
        found.damage = log.damage
        found.lost_bytes = sum(loss.end - loss.begin for loss in log.losses)
    return found


def _ask(call: ServiceCall, server: ServerAgain, found: Verification) -> None:
    """Recompute one response and compare it with the logged one."""
    tally = found.services.setdefault(call.service, ServiceTally())
    if call.response_event is None:
        tally.unanswered += 1
        return
    if call.request_event is None:
        _unreadable(found, tally, "the log contains a response without its request")
        return
    try:
        request = part_of(call.request_event, "request")
        logged = part_of(call.response_event, "response")
        make_response = type(logged)
    except InvalidFieldError as error:
        _unreadable(found, tally, str(error))
        return
    if logged.status in {getattr(logged, name, None) for name in BY_LOAD}:
        tally.unanswered += 1
        return
    tally.questions += 1
    # The time on the node's clock when the request arrived.
    asked_ns = call.request_event.publish_time_ns
    recomputed = server.answer(call.service_type, request, make_response, asked_ns=asked_ns)
    note_difference(
        found, call.service, differences(logged, recomputed), asked_ns=call.request_event.log_time_ns
    )


def note_difference(
    found: Verification, service: str, differing: Iterable[Difference], *, asked_ns: int
) -> None:
    """Count a response by its difference from the logged one."""
    tally = found.services[service]
    same, told = _beyond(differing, found.tolerance)
    if told:
        tally.different += 1
        shown = [in_words(each) for each in told]
        for i, other in enumerate(found.others):
            if other.service == service and [in_words(each) for each in other.differences] == shown:
                found.others[i] = replace(other, repeated=other.repeated + 1)
                return
        other = OtherAnswer(
            service=service, number=tally.questions, asked_ns=asked_ns, differences=tuple(told)
        )
        found.others = sorted([*found.others, other], key=lambda each: each.differences[0].rank)[:MAX_TOLD]
    elif same:
        tally.equal += 1
    else:
        tally.within += 1


def _beyond(found: Iterable[Difference], tolerance: float) -> tuple[bool, list[Difference]]:
    """Return whether there is no difference at all, and the first ones beyond the tolerance."""
    listed = list(found)
    told = [each for each in listed if tolerance == 0.0 or each.size > tolerance]
    return not listed, sorted(told, key=lambda each: each.rank)[:MAX_FIELDS_TOLD]


def _unreadable(found: Verification, tally: ServiceTally, reason: str) -> None:
    tally.unreadable += 1
    found.unreadable = found.unreadable or reason


AS_LOGGED: Final = "as logged"  # the result of a log whose responses have not changed


def report(found: Verification) -> str:
    """Return the table of one log, the responses that differ most, and a description of unreadable parts."""
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
    told = sum(1 + other.repeated for other in found.others)
    untold = sum(tally.different for tally in found.services.values()) - told
    if untold > 0:
        lines.append(f"  and {untold} more requests with smaller differences")
    lines += _gaps(found)
    return "\n".join(lines)


def summary(results: Sequence[tuple[str, str]]) -> str:
    """Return a table of several logs: the name of each, and its result."""
    width = max(len(name) for name, _ in results)
    good = sum(result == AS_LOGGED for _, result in results)
    lines = [f"  {name:{width}}  {result}" for name, result in results]
    return "\n".join([f"{good} of {len(results)} logs have unchanged responses", *lines])


def utc(stamp_ns: int) -> str:
    """Return a time in ns since the epoch as date and time of day."""
    when = datetime.fromtimestamp(stamp_ns // NS_PER_S, timezone.utc)
    return f"{when:%Y-%m-%d %H:%M:%S}.{stamp_ns % NS_PER_S:09d} UTC"


def _table(found: Verification) -> list[str]:
    if not found.services:
        return ["  no requests"]
    within = f"within {found.tolerance:g}" if found.tolerance > 0.0 else ""
    heads = ["requests", "identical", *([within] if within else []), "different"]
    width = max(len(name) for name in found.services)
    lines = [f"  {'service':{width}}  {'  '.join(heads)}"]
    for name, tally in found.services.items():
        counts = [tally.questions, tally.equal, *([tally.within] if within else []), tally.different]
        cells = "  ".join(f"{count:>{len(head)}}" for count, head in zip(counts, heads, strict=True))
        lines.append(f"  {name:{width}}  {cells}")
    return lines


def _other(other: OtherAnswer) -> list[str]:
    fields = [f"    {in_words(each)}" for each in other.differences]
    if other.repeated:
        fields.append(f"    the same in {other.repeated} further request{'s'[: other.repeated > 1]}")
    received = f"received {utc(other.asked_ns)} (log_time {other.asked_ns})"
    return [f"  {other.service}, request {other.number}, {received}:", *fields]


def _gaps(found: Verification) -> list[str]:
    lines = []
    other_state = sum(tally.other_state for tally in found.services.values())
    if other_state:
        lines.append(
            f"  {other_state} responses used other states than the logged ones, and are not compared: "
            "DDS does not preserve the order of a state and a request"
        )
    unanswered = sum(tally.unanswered for tally in found.services.values())
    unreadable = sum(tally.unreadable for tally in found.services.values())
    if unanswered:
        lines.append(f"  not repeated (no logged response, or BUSY or TIMEOUT): {unanswered}")
    if unreadable:
        lines.append(f"  {unreadable} calls could not be read; the first: {found.unreadable}")
    if found.damage is not None:
        lines.append(f"  {found.damage}")
    if found.lost_bytes:
        lines.append(
            "  the readable part is compared above; a response can differ if a state that it used is lost"
        )
    return lines
