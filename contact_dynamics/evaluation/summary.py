# SPDX-License-Identifier: Apache-2.0
"""Groups comparisons by kind of event, body, surface, horizon, method and law, and summarises each group."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.evaluation.settings import Law, Method
from contact_dynamics.measured.events import EventKind
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.evaluation.comparison import Comparison

LEVELS: Final = (0.5, 0.9, 0.95)
"""Probabilities of the prediction regions in which measured values are counted."""

ERRORS: Final = ("time_error", "position_error", "attitude_error", "velocity_error", "spin_error")
"""The errors of a comparison that are numbers with units: s, m, rad, m/s, rad/s."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Group(Record):
    """The fields that all comparisons of a group share."""

    kind: EventKind
    body: str  # name of the body
    surface: str  # name of the surface; empty for flights
    several: bool  # True if several corners may have struck
    horizon: float  # look-ahead time, s
    method: Method  # source of the predictions' initial states
    law: Law | None  # impact law, or None if the predictions contain no impact

    @staticmethod
    def shared(row: Comparison | Group) -> dict[str, Any]:
        """Return the group's fields of a comparison or a group, by name."""
        return {field.name: getattr(row, field.name) for field in fields(Group)}


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Spread(Record):
    """The distribution of one error."""

    bias: float  # median of the signed error, which equals ``median`` for an error >= 0
    median: float  # median of the absolute error
    most: float  # 90 % quantile of the absolute error
    count: int  # number of errors


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Summary(Group):
    """The comparisons of one group."""

    asked: int  # number of requests
    refused: int  # number of rejected requests
    errors: dict[str, Spread]  # distribution of each error in `ERRORS` that occurs
    # Number of contact mode requests that returned an impact, because the published velocity still approached
    # the surface
    impacts: int
    modes_right: float | None  # share of the other contact modes that were correct, or None without any
    # Share of measured values inside each region of `LEVELS`; empty without covariances
    covered: tuple[float, ...]
    covariances: int  # number of predictions with a covariance


def summarise(rows: Iterable[Comparison]) -> list[Summary]:
    """Return a summary of each group, in the order of kinds, bodies, surfaces, horizons and methods."""
    groups: dict[Group, list[Comparison]] = defaultdict(list)
    for row in rows:
        groups[group_of(row)].append(row)
    return [_summary(group, groups[group]) for group in sorted(groups, key=_place)]


def group_of(row: Comparison) -> Group:
    """Return the group of a comparison."""
    return Group(**Group.shared(row))


def is_inside(row: Comparison, level: float) -> bool | None:
    """Return whether the measured value is inside the region of this probability, or None if unknown."""
    from scipy.special import gammaincinv

    if row.distance is None:
        return None
    return bool(row.distance**2 <= 2.0 * gammaincinv(0.5 * row.degrees, level))


def spread_of(errors: Sequence[float]) -> Spread:
    """Return the distribution of at least one error."""
    sizes = np.abs(errors)
    return Spread(
        bias=float(np.median(errors)),
        median=float(np.median(sizes)),
        most=float(np.quantile(sizes, 0.9)),
        count=len(errors),
    )


def _summary(group: Group, rows: Sequence[Comparison]) -> Summary:
    errors = {}
    for name in ERRORS:
        found = [error for row in rows if (error := getattr(row, name)) is not None]
        if found:
            errors[name] = spread_of(found)
    answered = [row for row in rows if row.mode_is_right is not None]
    modes = [bool(row.mode_is_right) for row in answered if row.predicted_mode != ModeVerdict.IMPACT.name]
    known = [row for row in rows if row.distance is not None]
    return Summary(
        **Group.shared(group),
        asked=len(rows),
        refused=sum(bool(row.refused) for row in rows),
        errors=errors,
        impacts=len(answered) - len(modes),
        modes_right=sum(modes) / len(modes) if modes else None,
        covered=tuple(sum(bool(is_inside(row, level)) for row in known) / len(known) for level in LEVELS)
        if known
        else (),
        covariances=len(known),
    )


def _place(group: Group) -> tuple[int, str, str, bool, float, int, int]:
    kinds, methods, laws = list(EventKind), list(Method), [None, *Law]
    return (
        kinds.index(group.kind),
        group.body,
        group.surface,
        group.several,
        group.horizon,
        methods.index(group.method),
        laws.index(group.law),
    )
