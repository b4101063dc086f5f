# SPDX-License-Identifier: Apache-2.0
"""Asks every logged question again, with the states that were logged, and compares the answers."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.nodes.run_record import versions_here
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.recording.service_calls import ServiceCall
from contact_dynamics.replay.compare import Difference, differences
from contact_dynamics.replay.of_log import server_of_log
from contact_dynamics.replay.timeline import in_order, part_of
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path

    from contact_dynamics.replay.again import ServerAgain

MAX_TOLD: Final = 10
"""The differences of this many questions are kept, those of the largest ones."""

BY_LOAD: Final = ("BUSY", "TIMEOUT")
"""The status codes of responses that depend on the load of the machine."""

MAX_FIELDS_TOLD: Final = 5
"""This many fields of one answer are kept, those that differ most."""


@dataclass(slots=True, kw_only=True)
class ServiceTally:
    """Counts of the questions to one service, by how their answers compare.

    Attributes:
        questions: Questions that were asked again.
        equal: Answers that are as in the log to the last bit.
        within: Other answers, none of which differs by more than the tolerance.
        different: Answers that differ by more than the tolerance.
        other_state: Answers that used other states than the logged ones, and are not compared. There are none
            where the states of the log are at hand, as here.
        unanswered: Questions without an answer in the log, or with BUSY or TIMEOUT, which depend on the load
            of the machine. They were not asked again.
        unreadable: Calls whose question is missing, or that cannot be decoded.
    """

    questions: int = 0
    equal: int = 0
    within: int = 0
    different: int = 0
    other_state: int = 0
    unanswered: int = 0
    unreadable: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherAnswer:
    """A question whose answer differs from the logged one.

    Attributes:
        service: The service's name with its leading slash.
        number: Number of the question among those to this service, from 1.
        asked_ns: When it came, ns since the epoch, by the machine's clock. It is the ``log_time`` of its
            event.
        differences: The fields that differ most, the largest difference first.
    """

    service: str
    number: int
    asked_ns: int
    differences: tuple[Difference, ...]


@dataclass(slots=True, kw_only=True)
class Verification:
    """The result of one log's replay.

    Attributes:
        path: Path of the log.
        tolerance: How much a number may differ, relative to the larger one, or to 1 if both are smaller.
        versions: Versions of the libraries that wrote the log, by name.
        versions_now: Versions of the libraries that answered again, by name.
        instead: Values of parameters that counted instead of those in the log, by name.
        services: Tallies by the service's name.
        others: The questions whose answers differ most, the largest difference first.
        unreadable: The first reason why a call could not be read, or None if all could.
        damage: The damaged parts of the log, in words, or None if all was whole.
        lost_bytes: How many bytes of the log could not be read.
    """

    path: Path
    tolerance: float
    versions: dict[str, str]
    versions_now: dict[str, str]
    instead: dict[str, Any] = field(default_factory=dict)
    services: dict[str, ServiceTally] = field(default_factory=dict)
    others: list[OtherAnswer] = field(default_factory=list)
    unreadable: str | None = None
    damage: str | None = None
    lost_bytes: int = 0

    @property
    def agrees(self) -> bool:
        """Whether every question that could be read is answered as in the log, within the tolerance."""
        return not any(tally.different or tally.unreadable for tally in self.services.values())


def verify_log(
    path: Path,
    *,
    tolerance: float = 0.0,
    instead: Mapping[str, Any] | None = None,
    on_progress: Callable[[int, str], object] | None = None,
) -> Verification:
    """Ask every question of a log again and compare the answers field by field.

    Fields that tell how an answer was made (`compare.MEASURED`) are left out.

    Args:
        path: a log of the server, as its folder or as an ``.mcap`` file.
        tolerance: >= 0. How much a number may differ, relative to the larger one, or to 1 if both are
            smaller. With zero every bit counts.
        instead: values of parameters that count instead of those in the log, by name: what would have been
            answered with them?
        on_progress: a function that is called after each message, with its log time, ns, and with what was
            read so far, in words.

    Raises:
        NotALogError: the path has no log, or a log of something else than the server.
        ConfigurationError: its record of the run lacks a parameter, or has one that is not allowed.
        NotSupportedError: the log's services have other fields than this version's, or ROS is not installed,
            and another log in this process gave a message other fields.
    """
    check_not_negative("tolerance", tolerance)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # the result says it
        run, server = server_of_log(path, instead=instead)
        found = Verification(
            path=path,
            tolerance=tolerance,
            versions={name: run[name] for name in versions_here() if name in run},
            versions_now=versions_here(),
            instead=dict(instead or {}),
        )
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
                    on_progress(each.log_time_ns, f"{states} states, {questions} questions")
        found.damage = log.damage
        found.lost_bytes = sum(loss.end - loss.begin for loss in log.losses)
    return found


def _ask(call: ServiceCall, server: ServerAgain, found: Verification) -> None:
    """Ask one question again and note how the answers compare."""
    tally = found.services.setdefault(call.service, ServiceTally())
    if call.response_event is None:
        tally.unanswered += 1
        return
    if call.request_event is None:
        _unreadable(found, tally, "the log has an answer without its question")
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
    # The node's clock told this time when the question came.
    asked_ns = call.request_event.publish_time_ns
    recomputed = server.answer(call.service_type, request, make_response, asked_ns=asked_ns)
    note_difference(
        found,
        call.service,
        differences(logged, recomputed),
        asked_ns=call.request_event.log_time_ns,
    )


def note_difference(
    found: Verification, service: str, differing: Iterable[Difference], *, asked_ns: int
) -> None:
    """Note how an answer compares with the logged one, by the fields in which they differ."""
    tally = found.services[service]
    same, told = _beyond(differing, found.tolerance)
    if told:
        tally.different += 1
        other = OtherAnswer(
            service=service, number=tally.questions, asked_ns=asked_ns, differences=tuple(told)
        )
        found.others = sorted([*found.others, other], key=lambda each: -each.differences[0].size)[:MAX_TOLD]
    elif same:
        tally.equal += 1
    else:
        tally.within += 1


def _beyond(found: Iterable[Difference], tolerance: float) -> tuple[bool, list[Difference]]:
    """Return whether there is no difference at all, and the largest ones beyond the tolerance."""
    listed = list(found)
    told = [each for each in listed if tolerance == 0.0 or each.size > tolerance]
    return not listed, sorted(told, key=lambda each: -each.size)[:MAX_FIELDS_TOLD]


def _unreadable(found: Verification, tally: ServiceTally, reason: str) -> None:
    tally.unreadable += 1
    found.unreadable = found.unreadable or reason
