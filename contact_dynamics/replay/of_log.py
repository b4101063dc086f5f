# SPDX-License-Identifier: Apache-2.0
"""A log's own record configures the server that answers its questions again.

Without ROS, the messages of a log are read by the definitions in the log. The adapters, however, are those of
this version. If a field has another name or type, they cannot read the questions, or they compare answers
that mean something else. Such a log is rejected.
"""

from __future__ import annotations

import hashlib
import warnings
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.nodes.run_record import CHANGES, PARAMETERS, LoggedParameters
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError
from contact_dynamics.recording.message_types import message_types
from contact_dynamics.replay.stand_ins import stand_in
from contact_dynamics.replay.timeline import INTERFACES

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from contact_dynamics.replay.again import ServerAgain

_PACKAGE: Final = INTERFACES.partition("/")[0] + "/"


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
        is_later = log.run_is_later and next(log.messages({CHANGES}), None) is not None
    events = [name for name in definitions if name.startswith(INTERFACES) and name.endswith(EVENT_SUFFIX)]
    if not events:
        known = ", ".join(sorted(definitions)) or "none"
        raise NotALogError(
            f"{path}: not a log of the server: no service of it in the log's types ({known}){damage}"
        )
    if PARAMETERS not in run and "world_frame" not in run:
        raise NotALogError(
            f"{path}: not a log of the server: it does not contain the server's configuration{damage}"
        )
    if is_later:
        raise NotALogError(
            f"{path}: the configuration at the beginning of the log is missing: "
            f"what is left of it is from after a change{damage}"
        )
    check_definitions(path, definitions, run.get("version"))
    stand_in(definitions.items())
    from contact_dynamics.replay.again import ServerAgain  # here, for it imports what now stands in for ROS

    return run, ServerAgain(LoggedParameters(run, instead))


def digest(event_type: str, definition: str) -> str:
    """Return a digest of the fields of a service, of their order, names and types. Comments do not count.

    Args:
        event_type: "package/srv/Name_Event".
        definition: Its text, as a log holds it.
    """
    types = message_types(event_type, definition)
    lines = [
        f"{name} {field.type_name}{[field.count] if field.is_array else ''} {field.name}"
        for name, message_type in sorted(types.items())
        if name.startswith(_PACKAGE)
        for field in message_type.FIELDS
    ]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def check_definitions(path: Path, definitions: Mapping[str, str], version: str | None) -> None:
    """Refuse a log whose services are defined otherwise than those of this version.

    Args:
        path: The log.
        definitions: The texts of its types.
        version: The version of this package that wrote it, as far as it says so.

    Raises:
        NotSupportedError: there is such a service, or one that this version does not have. The message names
            it, and the version that wrote the log.
    """
    known = {f"{INTERFACES}{service.type_name}{EVENT_SUFFIX}": service.digest for service in SERVICES}
    differing = [
        name.removeprefix(INTERFACES).removesuffix(EVENT_SUFFIX)
        for name, text in definitions.items()
        if name.startswith(INTERFACES)
        and name.endswith(EVENT_SUFFIX)
        and digest(name, text) != known.get(name)
    ]
    if differing:
        raise NotSupportedError(
            f"{path}: fields of {', '.join(differing)} must be those of this version, got others: the "
            f"log was written by another version of contact_dynamics ({version or 'not recorded'}); replay "
            "it with that one"
        )
