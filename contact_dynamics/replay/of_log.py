"""A log's own record configures the server that answers its questions again."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

from contact_dynamics.nodes import parameter_event
from contact_dynamics.nodes.run_record import PARAMETERS, LoggedParameters
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError
from contact_dynamics.replay.configuration import ChangedRun
from contact_dynamics.replay.same_definitions import check_definitions
from contact_dynamics.replay.stand_ins import stand_in
from contact_dynamics.replay.timeline import INTERFACES

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from contact_dynamics.replay.again import ServerAgain


def server_of_log(
    path: Path, *, instead: Mapping[str, Any] | None = None
) -> tuple[dict[str, str], ServerAgain]:
    """Return the record of a log's run, and a server that is configured by it.

    Args:
        path: The log.
        instead: Values of parameters that count instead of those in the record.

    Raises:
        NotALogError: it is no log, or none of the server.
        ConfigurationError: its record of the run lacks a parameter, or has one that is not allowed.
        NotSupportedError: the log's services have other fields than this version's; or ROS is not installed,
            and another log in this process gave a message other fields.
    """
    log = BagReader(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # told when the log is read
        definitions = log.definitions()
        damage = f" ({log.damage})" if log.damage else ""
        run = log.run()
        damage = f" ({log.damage})" if log.damage else damage
        is_later = log.run_is_later and next(log.messages({parameter_event.TOPIC}), None) is not None
    events = [name for name in definitions if name.startswith(INTERFACES) and name.endswith(EVENT_SUFFIX)]
    if not events:
        known = ", ".join(sorted(definitions)) or "none"
        raise NotALogError(
            f"{path}: not a log of the server: no service of it in the log's types ({known}){damage}"
        )
    if PARAMETERS not in run and "world_frame" not in run:
        raise NotALogError(
            f"{path}: not a log of the server: no record of how its run was configured{damage}"
        )
    if is_later:
        raise NotALogError(
            f"{path}: no record of how its run was configured at its beginning: "
            f"what is left of it is from after a change{damage}"
        )
    check_definitions(path, definitions, run.get("version"))
    stand_in(definitions.items())
    from contact_dynamics.replay.again import ServerAgain  # here, for it imports what now stands in for ROS

    return run, ServerAgain(ChangedRun(run, instead) if instead else LoggedParameters(run))
