"""Classes of messages where ROS is not installed: made of a log's own definitions, under ROS's names.

`msg_adapters` writes responses with the classes that ROS generates of interface files. A log holds the text
of these files. Where ``geometry_msgs.msg`` and its like are missing, modules of that name stand in, with
classes made of the texts. Where ROS is installed, its own classes are used.
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
"""The modules of messages that `msg_adapters` imports."""

_PARTS: Final = ("_Request", "_Response", EVENT_SUFFIX)


def stand_in(definitions: Iterable[tuple[str, str]]) -> None:
    """Let what ROS would bring be imported, made of the types' names and texts.

    Raises:
        NotSupportedError: a type stands in already, with other fields than these.
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
            f"{message_type.__name__}: this log defines it otherwise than the one before; "
            "allowed is to replay each in a process of its own"
        )


class _StandIn(ModuleType):
    """A module of messages; a type that no log has described can be named, but not made."""

    def __getattr__(self, name: str) -> Any:
        """Return the class of a type that is not there."""
        if name.startswith("__"):
            raise AttributeError(name)

        def refuse(_self: object, **_values: object) -> None:
            raise NotSupportedError(f"{self.__name__}.{name}: the log does not describe this type")

        return type(name, (), {"__init__": refuse})


def _is_missing(name: str) -> bool:
    """Tell whether a module is not installed; a folder without code, as in the sources, is no module."""
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
    module.__spec__ = ModuleSpec(name, None)  # without an origin: it does not count as installed
    setattr(parent, name.rpartition(".")[2], module)
    sys.modules[name] = module
    return module
