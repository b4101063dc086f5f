# SPDX-License-Identifier: Apache-2.0
"""Finds a message type's definition (its full text in ROS's notation and its hash) by the ament prefixes.

A log is self-describing: for each type it contains the `.msg` text, followed by the text of each type that it
uses (MCAP's encoding ``ros2msg``: a line of 80 ``=``, a line ``MSG: package/Type``, the text). The texts are
in ``share/<package>/{msg,srv}/`` of the folders in ``AMENT_PREFIX_PATH``, and of this Python's own prefix,
where packages from wheels are. No ROS library is needed.

The event type of a service, ``package/srv/Name_Event``, has no file. Its text is made here from the `.srv`,
as a message with the fields ``info``, ``request``, ``response``. Most readers can decode this form. rosbag2
itself writes the `.srv` text, which only rosbag2 understands.

SQLite bags from before ROS 2 Iron contain only the names of their types. `standard_definition` has the texts
for the types of published states, which have not changed since ROS 2 began.

Not covered: types defined by `.idl` alone (no such type is logged here), actions.
"""

from __future__ import annotations

import json
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

EVENT_SUFFIX: Final = "_Event"

_TYPE_NAME: Final = re.compile(r"([a-z][a-z0-9_]*)/(msg|srv)/([A-Z][A-Za-z0-9]*)(_Event)?")
# Type, bounds, and the start of the name: lower case in a field, upper case in a constant.
_FIELD: Final = re.compile(r"\s*([A-Za-z]\w*(?:/[A-Za-z]\w*)?)(?:<=\d+)?(?:\[[^\]]*\])?\s+[a-z]")
_SRV_SEPARATOR: Final = re.compile(r"^---[ \t]*\r?$", re.MULTILINE)
_SEPARATOR: Final = "=" * 80
_PRIMITIVES: Final = frozenset(
    {"bool", "byte", "char", "float32", "float64", "string", "wstring"}
    | {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}
)
_STAMP_FIRST: Final = frozenset({"std_msgs/Header", "builtin_interfaces/Time"})


@dataclass(frozen=True, slots=True, kw_only=True)
class TypeDefinition:
    """One message type as a log describes it."""

    type_name: str  # "package/msg/Name" or "package/srv/Name_Event"
    text: str  # its fields, then each type that it uses, in MCAP's ros2msg form
    type_hash: str  # "RIHS01_..." of REP 2011; empty if there is no .json beside the text
    begins_with_stamp: bool  # whether the first field is a std_msgs/Header or a time

    @property
    def is_service_event(self) -> bool:
        """Whether messages of this type are the requests and responses of a service."""
        return self.type_name.endswith(EVENT_SUFFIX)


def ament_prefixes() -> tuple[Path, ...]:
    """Return the installation prefixes to search: those of ``AMENT_PREFIX_PATH``, then this Python's own."""
    listed = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return tuple(Path(entry) for entry in [*listed, sys.prefix] if entry)


def find_definition(type_name: str, *, prefixes: Sequence[Path] | None = None) -> TypeDefinition:
    """Return the definition of ``package/msg/Name`` or ``package/srv/Name_Event``.

    Raise `InvalidFieldError` if the name has another form, or no prefix has the type or a type that it uses.
    """
    match = _TYPE_NAME.fullmatch(type_name)
    if match is None or (match[2] == "srv") != (match[4] is not None):
        raise InvalidFieldError("type_name", type_name, "'package/msg/Name' or 'package/srv/Name_Event'")
    package, folder, name = match[1], match[2], match[3]
    shares = _Shares(ament_prefixes() if prefixes is None else prefixes)
    if folder == "srv":
        root, sections = _service_event(shares, package, name)
    else:
        root, sections = shares.read(package, f"msg/{name}.msg"), {}
    for text in [root, *sections.values()]:
        _add_dependencies(shares, package, text, sections)
    parts = [root, *(f"{_SEPARATOR}\nMSG: {dependency}\n{text}" for dependency, text in sections.items())]
    return TypeDefinition(
        type_name=type_name,
        text="\n".join(part.rstrip("\n") + "\n" for part in parts),
        type_hash=shares.type_hash(package, f"{folder}/{name}.json", type_name),
        begins_with_stamp=next(iter(_field_types(root, package)), "") in _STAMP_FIRST,
    )


def _service_event(shares: _Shares, package: str, name: str) -> tuple[str, dict[str, str]]:
    request_text, response_text = _SRV_SEPARATOR.split(shares.read(package, f"srv/{name}.srv"), maxsplit=1)
    request, response = f"{package}/{name}_Request", f"{package}/{name}_Response"
    root = f"service_msgs/ServiceEventInfo info\n{request}[<=1] request\n{response}[<=1] response\n"
    return root, {request: request_text, response: response_text.lstrip("\n")}


def _add_dependencies(shares: _Shares, package: str, text: str, sections: dict[str, str]) -> None:
    """Add to ``sections`` each type that ``text`` uses and that is not there yet, and the types these use."""
    for dependency in _field_types(text, package):
        if "/" in dependency and dependency not in sections:
            owner, name = dependency.split("/")
            sections[dependency] = shares.read(owner, f"msg/{name}.msg")
            _add_dependencies(shares, owner, sections[dependency], sections)


def _field_types(text: str, package: str) -> Iterable[str]:
    """Yield the type of each field: a primitive's name, or ``package/Type``."""
    for line in text.splitlines():
        match = _FIELD.match(line)
        if match is not None:
            name = match[1]
            yield name if name in _PRIMITIVES or "/" in name else f"{package}/{name}"


class _Shares:
    """The ``share`` folders of the prefixes, nearest first."""

    def __init__(self, prefixes: Sequence[Path]) -> None:
        self._prefixes = prefixes

    def read(self, package: str, file: str) -> str:
        path = self._find(package, file)
        if path is None:
            searched = os.pathsep.join(str(prefix) for prefix in self._prefixes)
            raise InvalidFieldError(
                "type_name", f"{package}/{file}", f"a file under share/ of one of {searched}"
            )
        return path.read_text(encoding="utf-8")

    def type_hash(self, package: str, file: str, type_name: str) -> str:
        path = self._find(package, file)
        if path is None:
            return ""
        hashes = json.loads(path.read_text(encoding="utf-8"))["type_hashes"]
        return next((str(entry["hash_string"]) for entry in hashes if entry["type_name"] == type_name), "")

    def _find(self, package: str, file: str) -> Path | None:
        candidates = (prefix / "share" / package / file for prefix in self._prefixes)
        return next((path for path in candidates if path.is_file()), None)


_TEXTS: Final = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Pose": "Point position\nQuaternion orientation\n",
    "geometry_msgs/Twist": "Vector3 linear\nVector3 angular\n",
    "geometry_msgs/PoseWithCovariance": "Pose pose\nfloat64[36] covariance\n",
    "geometry_msgs/TwistWithCovariance": "Twist twist\nfloat64[36] covariance\n",
    "geometry_msgs/PoseStamped": "std_msgs/Header header\nPose pose\n",
    "geometry_msgs/TwistStamped": "std_msgs/Header header\nTwist twist\n",
    "nav_msgs/Odometry": (
        "std_msgs/Header header\nstring child_frame_id\n"
        "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"
    ),
    "rosgraph_msgs/Clock": "builtin_interfaces/Time clock\n",
}


def standard_definition(type_name: str) -> str:
    """Return the text of "package/msg/Name" in MCAP's ros2msg form, or an empty one for an unknown type."""
    name = type_name.replace("/msg/", "/")
    return _DEFINITIONS.get(name, "")


_DEFINITIONS: Final = {
    name: "".join(
        [text, *(f"{_SEPARATOR}\nMSG: {other}\n{part}" for other, part in _TEXTS.items() if other != name)]
    )
    for name, text in _TEXTS.items()
}
