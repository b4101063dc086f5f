# SPDX-License-Identifier: Apache-2.0
"""Configures a server from the record of the run in a log, to recompute its responses.

Without ROS, the messages of a log are read by the definitions in the log. `msg_adapters` imports the classes
that ROS generates from interface files. If ``geometry_msgs.msg`` and the like are missing, modules of the
same names are made here, with classes made from the definitions. If ROS is installed, its own classes are
used.

The adapters, however, are those of this version. If a field has another name or type, they cannot read the
requests, or would compare responses with different meanings. Such a log is rejected.
"""

from __future__ import annotations

import hashlib
import sys
import warnings
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.nodes.run_record import CHANGES, PARAMETERS, LoggedParameters
from contact_dynamics.questions.services import SERVICES
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError
from contact_dynamics.recording.message_types import Message, message_types
from contact_dynamics.replay.timeline import INTERFACES, MONITOR_EVENT

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from contact_dynamics.replay.again import ServerAgain

_PACKAGE: Final = INTERFACES.partition("/")[0] + "/"


def server_of_log(
    path: Path, *, instead: Mapping[str, Any] | None = None
) -> tuple[dict[str, str], ServerAgain]:
    """Return the record of a log's run, and a server configured by it.

    The values ``instead`` replace parameters of the record, by name.

    Raises:
        NotALogError: it is not a log of the server.
        ConfigurationError: its record of the run lacks a parameter, or has an invalid one.
        NotSupportedError: the log's services differ in their fields from this version's; or ROS is not
            installed, and another log in this process defined a message with different fields.
    """
    log = BagReader(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)  # reported when the log is read
        definitions = log.definitions()
        damage = f" ({log.damage})" if log.damage else ""
        run = log.run()
        damage = f" ({log.damage})" if log.damage else damage
        is_later = log.run_is_later and next(log.messages({CHANGES}), None) is not None
    events = [name for name in definitions if name.startswith(INTERFACES) and name.endswith(EVENT_SUFFIX)]
    if not events and MONITOR_EVENT not in definitions:
        known = ", ".join(sorted(definitions)) or "none"
        raise NotALogError(
            f"{path}: not a log of the server: no service of it in the log's types ({known}){damage}"
        )
    if PARAMETERS not in run:
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
    from contact_dynamics.replay.again import ServerAgain  # imports what `stand_in` has made

    return run, ServerAgain(LoggedParameters(run, instead))


def digest(event_type: str, definition: str) -> str:
    """Return a digest of the order, names and types of a service event's fields, without comments."""
    types = message_types(event_type, definition)
    lines = [
        f"{name} {field.type_name}{[field.count] if field.is_array else ''} {field.name}"
        for name, message_type in sorted(types.items())
        if name.startswith(_PACKAGE)
        for field in message_type.FIELDS
    ]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def check_definitions(path: Path, definitions: Mapping[str, str], version: str | None) -> None:
    """Reject a log, written by ``version``, whose services differ in their definitions from this version's.

    Raise `NotSupportedError` with their names and the version.
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
            f"server of the log was of another version of contact_dynamics ({version or 'not recorded'}), or "
            "its interfaces were not built after their last change (make setup); replay the log with the "
            "code that wrote it"
        )


_PACKAGES: Final = (  # `msg_adapters` imports messages from these modules
    "builtin_interfaces.msg",
    "contact_dynamics_interfaces.msg",
    "contact_dynamics_interfaces.srv",
    "geometry_msgs.msg",
    "nav_msgs.msg",
)

_PARTS: Final = ("_Request", "_Response", EVENT_SUFFIX)


def stand_in(definitions: Iterable[tuple[str, str]]) -> None:
    """Make missing message modules importable, from pairs of a type's name and its definition.

    Raise `NotSupportedError` if a type of this name was defined before, with different fields.
    """
    modules = {name: _module(name) for name in _PACKAGES if _is_missing(name)}
    for type_name, text in definitions:
        for full_name, message_type in message_types(type_name, text).items():
            package, _, name = full_name.partition("/")
            part = next((part for part in _PARTS if name.endswith(part)), "")
            module = modules.get(f"{package}.{'srv' if part else 'msg'}")
            if module is not None:
                _put(module, name, part, message_type)


def _put(module: ModuleType, name: str, part: str, message_type: type[Message]) -> None:
    owner: Any = module
    if part:
        name = name.removesuffix(part)
        owner = module.__dict__.setdefault(name, type(name, (), {}))
        name = part[1:]
    stands = vars(owner).get(name)
    if stands is None:
        setattr(owner, name, message_type)
    elif stands.FIELDS != message_type.FIELDS:
        raise NotSupportedError(
            f"{message_type.__name__}: logs replayed together must have the same fields, got other fields "
            "than in the log before; replay each log in a process of its own"
        )


class _StandIn(ModuleType):
    """A module of messages. Types that no log has defined can be imported, but not instantiated."""

    def __getattr__(self, name: str) -> Any:
        """Return a class that cannot be instantiated, for a type that no log has defined."""
        if name.startswith("__"):
            raise AttributeError(name)

        def refuse(_self: object, **_values: object) -> None:
            raise NotSupportedError(f"{self.__name__}.{name}: the log does not describe this type")

        return type(name, (), {"__init__": refuse})


def _is_missing(name: str) -> bool:
    """Return whether a module is not installed; a folder without code, as in the sources, is no module."""
    if isinstance(sys.modules.get(name), _StandIn):
        return True
    try:
        spec = find_spec(name)
    except (ModuleNotFoundError, ValueError):
        return True
    return spec is None or spec.origin is None


def _module(name: str) -> ModuleType:
    found = sys.modules.get(name)
    if found is not None:
        return found
    package = name.partition(".")[0]
    parent = sys.modules.setdefault(package, ModuleType(package))
    module = _StandIn(name)
    module.__spec__ = ModuleSpec(name, None)  # it has no origin, so it does not count as installed
    setattr(parent, name.rpartition(".")[2], module)
    sys.modules[name] = module
    return module
