# SPDX-License-Identifier: Apache-2.0
"""Reads the states of a log's bodies and their arrival times, without ROS."""

from __future__ import annotations

import warnings
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import to_ns
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError, NotSupportedError
from contact_dynamics.evaluation.asking import Informed
from contact_dynamics.evaluation.recording import Recording
from contact_dynamics.measured.motion import StateColumns, motions_of
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameters import ServerParameters, read_server_parameters
from contact_dynamics.nodes.run_record import PARAMETERS, LoggedParameters
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.cdr import decode_columns, decode_without_ros
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError
from contact_dynamics.replay.of_log import stand_in

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.nodes.state_sources import StateSource
    from contact_dynamics.recording.bag_reader import LoggedMessage

_OURS: Final = "contact_dynamics_interfaces/"

_TOGETHER: Final = 4096
"""Number of messages of a topic that are decoded together, 15 times as fast as one by one."""

ONE_CLOCK_S: Final = 1.0
"""Largest median difference of arrival times and stamps at which both are taken to be of one clock, s.
Clocks synchronised by NTP differ by far less, and simulated time differs by years."""


def parameters_of(source: ParameterSource) -> tuple[ServerParameters, Informed]:
    """Return the server's parameters, and the part of them with which predictions are made.

    Raise `ConfigurationError` if a parameter is missing or not allowed, and `NotSupportedError` if a surface
    moves with a body.
    """
    parameters = read_server_parameters(source)
    return parameters, informed_by(parameters)


def informed_by(parameters: ServerParameters) -> Informed:
    """Return the part of a server's parameters with which predictions are made.

    Raise `NotSupportedError` if a surface moves with a body, which the search for events does not follow.
    """
    if parameters.carried:
        names = ", ".join(f"{each.surface.name!r} on {each.body_name!r}" for each in parameters.carried)
        message = f"surfaces must be at rest where predictions are compared with measurements, got {names}"
        raise NotSupportedError(message)
    return Informed(
        world=parameters.world, defaults=parameters.defaults, state_timeout=parameters.state_timeout
    )


def recording_of_log(path: Path, *, config: Path | None = None, only: Collection[str] = ()) -> Recording:
    """Return the states of a log's bodies, and the configuration of its server.

    The path is a bag folder, or one file of a bag. The parameter file ``config`` replaces the log's own
    record. Only the states of the bodies ``only`` are read, or all if it is empty.

    Raises:
        NotALogError: the path is not a log, or the log contains no configuration and ``config`` is None.
        ConfigurationError: a parameter is missing, or has a value that is not allowed.
        InvalidFieldError: the log contains no state of a configured body.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # reported in the result
        log = BagReader(path)
        parameters, informed = parameters_of(_configuration(log, path, config))
        found = _states(log, parameters, only)
    world = parameters.world
    motions = [motion for each in world.bodies for motion in motions_of(each, world, found[each.name])]
    if not only and not any(map(len, found.values())):
        bodies = ", ".join(found) or "none"
        raise InvalidFieldError(
            str(path), "no state of a configured body", f"states of one of them: {bodies}"
        )
    return Recording(motions=tuple(motions), informed=informed, damage=log.damage or "")


def bodies_of_log(path: Path, *, config: Path | None = None) -> list[str]:
    """Return the names of the bodies in ``config``, or else in a log's own configuration.

    The errors are those of `recording_of_log`.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)
        parameters, _ = parameters_of(_configuration(BagReader(path), path, config))
    return [body.name for body in parameters.world.bodies]


def _configuration(log: BagReader, path: Path, config: Path | None) -> ParameterSource:
    if config is not None:
        return ParameterFile(config)
    run = log.run()
    if PARAMETERS not in run:
        raise NotALogError(
            f"{path}: --config is required, since the log has no record of its run's configuration"
            f"{f' ({log.damage})' if log.damage else ''}"
        )
    return LoggedParameters(run)


def _states(log: BagReader, parameters: ServerParameters, only: Collection[str]) -> dict[str, StateColumns]:
    """Return the states of all or some bodies with their arrival times, ns on the clock of the stamps.

    If the log was written with another clock, as in simulated time, the stamps are the arrival times.
    """
    stand_in((name, text) for name, text in log.definitions().items() if not name.startswith(_OURS))
    from contact_dynamics.nodes.state_sources import state_sources  # imports the stand-ins for ROS
    from msg_adapters.transforms import TransformTree

    found = {body.name: StateColumns() for body in parameters.world.bodies}
    sources = {
        each.full_name: replace(each, readers=wanted)
        for each in state_sources(parameters, static=TransformTree())
        if (wanted := tuple(one for one in each.readers if not only or one.body_name in {*only, ""}))
    }
    topics = Counter(reader.body_name for each in sources.values() for reader in each.readers)
    waiting: dict[str, list[LoggedMessage]] = {
        name: []
        for name, each in sources.items()
        if each.rows is not None and topics[each.readers[0].body_name] == 1
    }
    for message in log.messages(sources.keys()):
        source = sources[message.topic]
        if message.topic in waiting:
            waiting[message.topic].append(message)
            if len(waiting[message.topic]) == _TOGETHER:
                _read_together(waiting[message.topic], source, found)
            continue
        if source.is_latched:  # a transform between frames, which applies to later messages
            for name, messages in waiting.items():
                _read_together(messages, sources[name], found)
        _read(message, source, found)
    for name, messages in waiting.items():
        _read_together(messages, sources[name], found)
    for states in filter(len, found.values()):
        delays_ns = states.arrivals_ns - states.stamps_ns.astype(np.float64)
        if abs(float(np.median(delays_ns))) > to_ns(ONE_CLOCK_S):
            states.know_at_stamps()
    return found


def _read(message: LoggedMessage, source: StateSource, found: dict[str, StateColumns]) -> None:
    """Add the states in a message."""
    for body_name, state_from in source.readers:
        with suppress(ContactDynamicsError):  # the server rejected it too
            known = state_from(decode_without_ros(message))
            if known is not None:
                found[body_name].add(known, message.log_time_ns)


def _read_together(
    messages: list[LoggedMessage], source: StateSource, found: dict[str, StateColumns]
) -> None:
    """Add the states in messages of one body, with the same result as `_read`, and clear the list."""
    if not messages or source.rows is None:
        return
    alike, rows = np.zeros(len(messages), dtype=np.bool_), None
    with suppress(ContactDynamicsError):  # the first message is invalid
        as_one, places = decode_columns(messages)
        rows = source.rows(as_one) if len(places) else None
        if rows is not None:
            alike[places[rows.are_all]] = True
    done = 0
    for run in np.split(np.arange(len(messages)), np.flatnonzero(np.diff(alike)) + 1):
        if rows is None or not alike[run[0]]:
            for i in run.tolist():
                _read(messages[i], source, found)
            continue
        part = np.flatnonzero(rows.are_all)[done : done + len(run)]
        done += len(run)
        arrivals_ns = [messages[i].log_time_ns for i in run.tolist()]
        found[source.readers[0].body_name].extend(rows.stamps_ns[part], rows.numbers[part], arrivals_ns)
    messages.clear()
