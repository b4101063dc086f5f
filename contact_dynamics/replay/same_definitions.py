"""Checks that a log's services have the fields that this version reads and writes.

Without ROS, the messages of a log are read by the definitions in the log. The adapters, however, are those of
this version. If a field has another name or type, they cannot read the questions, or they compare answers
that mean something else.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.message_types import message_types
from contact_dynamics.replay.timeline import INTERFACES

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

_PACKAGE: Final = INTERFACES.partition("/")[0] + "/"


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
