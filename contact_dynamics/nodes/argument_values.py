# SPDX-License-Identifier: Apache-2.0
"""The values that ROS's arguments give to parameters, and of which type ROS reads each.

Where a file gives a parameter a value of one type and `-p` another of a type that ROS looks at later, ROS
keeps that of the file and says nothing: `-p log:=0` beside `log: true` goes on logging. So the types of these
values are looked at here. This file imports no ROS.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.nodes.parameter_sections import Section, absolute

if TYPE_CHECKING:
    from collections.abc import Sequence

_GIVEN: Final = re.compile(r"(?:([^:=]+):)?([^:=]+):=(.*)", re.DOTALL)
_BOOLEAN: Final = re.compile(
    r"[yYnN]|yes|Yes|YES|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF"
)
_WHOLE: Final = re.compile(r"[-+]?(0[xX][0-9a-fA-F]+|[0-9]+)")
_NUMBER: Final = re.compile(
    r"[-+]?(([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?|\.?(nan|NaN|NAN|inf|Inf|INF))"
)
IN_WORDS: Final = {
    bool: "true or false",
    int: "a whole number",
    float: "a number with a point, such as 1.0",
    str: "a text",
    list: "a list with an entry, such as [1.0]",
}
"""The types of parameters, in the words of an error."""


def values_given(arguments: Sequence[str], full_name: str) -> dict[str, str]:
    """Return the texts of the parameters that ROS's arguments give to a node of this full name."""
    found: dict[str, str] = {}
    for flag, text in pairwise(arguments):
        match = _GIVEN.fullmatch(text) if flag in {"-p", "--param"} else None
        if match is not None and (match[1] is None or Section(absolute(match[1]), {}).is_for(full_name)):
            found[match[2]] = match[3].strip()
    return found


def what_is_wrong(text: str, wanted: type[Any]) -> str:
    """Return what a parameter's text would have to be, or nothing where it is of the type that is wanted."""
    return "" if text == "" or _type_of(text) is wanted else IN_WORDS[wanted]


def _type_of(text: str) -> type[Any] | None:
    """Return the type that ROS makes of a text. A list without an entry has none, and ROS ignores it."""
    if text.startswith("["):
        return list if text.strip("[] ") else None
    for pattern, kind in ((_BOOLEAN, bool), (_WHOLE, int), (_NUMBER, float)):
        if pattern.fullmatch(text):
            return kind
    return str
