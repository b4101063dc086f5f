# SPDX-License-Identifier: Apache-2.0
"""Refuses parameters that are given and that nobody reads. ROS would ignore them."""

from __future__ import annotations

import difflib
import re
from typing import TYPE_CHECKING, Final

from contact_dynamics.nodes.parameter_reader import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable

_OF_ROS: Final = re.compile(r"use_sim_time|start_type_description_service")
_QOS: Final = "qos_overrides"
_POLICIES: Final = ("history", "depth", "reliability")
"""What ROS lets parameters override of a subscription, unless a node asks for more."""
_LIKELY: Final = 0.7
"""Similarity from which on a name counts as a misspelled one, by `difflib`. One letter in four makes 0.75."""
_MEANT: Final = {"radius": "sphere", "size": "box", "com": "center_of_mass", "mu": "friction"}
"""Names that others have for a parameter, with ours."""
_LISTED_BY: Final = {"body": "bodies", "surface": "surfaces"}


def is_of_ros(name: str) -> bool:
    """Tell whether a parameter is one that ROS gives every node."""
    return _OF_ROS.fullmatch(name) is not None or name.startswith(f"{_QOS}.")


def qos_overrides_of(topics: Iterable[str]) -> set[str]:
    """Return the parameters that override the quality of service of subscriptions to topics."""
    return {f"{_QOS}.{topic}.subscription.{policy}" for topic in topics for policy in _POLICIES}


def refuse_unknown(
    given: Iterable[str],
    known: Collection[str],
    listed: Callable[[str], Iterable[str]],
    early: Collection[str] | None = None,
) -> None:
    """Refuse names of parameters that are not known.

    Args:
        given: the names.
        known: those that somebody reads, with `qos_overrides_of` the topics.
        listed: returns what the parameter of a name lists, `bodies` or `surfaces`.
        early: the names of all parameters, where an error has left some unread. Topics are not known then,
            and overrides of their quality of service are not refused.

    Raises:
        ConfigurationError: some are unknown. The message names each, with the most similar known one.
    """
    is_allowed = _OF_ROS.fullmatch if early is None else is_of_ros
    known = {*known, *(early or ())}
    unknown = sorted(name for name in given if name not in known and not is_allowed(name))
    if unknown:
        raise ConfigurationError("\n".join(_unknown(name, known, listed) for name in unknown))


def likely_misspelling(missing: str, given: Iterable[str]) -> str:
    """Return words about a given name that is probably meant by the missing one, or nothing."""
    group, _, last = missing.rpartition(".")
    beside = [name.rpartition(".")[2] for name in given if name.rpartition(".")[0] == group]
    close = difflib.get_close_matches(last, beside, n=1, cutoff=_LIKELY)
    return f" Given is {group}.{close[0]}, which may be misspelled." if close else ""


def _unknown(name: str, known: Collection[str], listed: Callable[[str], Iterable[str]]) -> str:
    kind, _, rest = name.partition(".")
    listing = _LISTED_BY.get(kind)
    if listing and rest:
        own_name = rest.rpartition(".")[0] or rest
        allowed = list(listed(listing))
        if own_name not in allowed:
            return f"{name} must be about one of the names in {listing} {allowed}, got {kind} {own_name!r}"
    group, _, last = name.rpartition(".")
    meant = f"{group}.{_MEANT.get(last, '')}"
    nearest = meant if meant in known else difflib.get_close_matches(name, known, n=1, cutoff=0.0)[0]
    return f"{name}: there is no such parameter; the nearest is {nearest}"
