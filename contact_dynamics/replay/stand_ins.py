# SPDX-License-Identifier: Apache-2.0
"""Makes classes of messages from a log's own definitions, for machines where ROS is not installed.

`msg_adapters` imports the classes that ROS generates from interface files. A log holds the text of these
files. If ``geometry_msgs.msg`` and the like are missing, modules of the same names are made here, with
classes made from the texts. If ROS is installed, its own classes are used.
"""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.message_types import Message, message_types

if TYPE_CHECKING:
    from collections.abc import Iterable

_PACKAGES: Final = (
    "builtin_interfaces.msg",
    "contact_dynamics_interfaces.msg",
    "contact_dynamics_interfaces.srv",
    "geometry_msgs.msg",
    "nav_msgs.msg",
)
"""`msg_adapters` imports messages from these modules."""

_PARTS: Final = ("_Request", "_Response", EVENT_SUFFIX)


def stand_in(definitions: Iterable[tuple[str, str]]) -> None:
    """Make the missing modules of messages importable, from pairs of a type's name and its text.

    Raises:
        NotSupportedError: a type of this name was made before, with other fields.
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
    """A module of messages. A type that no log has described can be imported, but not instantiated."""

    def __getattr__(self, name: str) -> Any:
        """Return a class that cannot be instantiated, for a type that no log has described."""
        if name.startswith("__"):
            raise AttributeError(name)

        def refuse(_self: object, **_values: object) -> None:
            raise NotSupportedError(f"{self.__name__}.{name}: the log does not describe this type")

        return type(name, (), {"__init__": refuse})


def _is_missing(name: str) -> bool:
    """Return whether a module is not installed. A folder without code, as in the sources, does not count."""
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
