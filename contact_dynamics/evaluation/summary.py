# SPDX-License-Identifier: Apache-2.0
"""Comparisons of one kind, body, surface, horizon, method and law, put together."""

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
"""Probabilities of the regions in which measured values are counted."""

ERRORS: Final = ("time_error", "position_error", "attitude_error", "velocity_error", "spin_error")
"""The errors of a comparison that are numbers with units: s, m, rad, m/s, rad/s."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Group(Record):
    """What comparisons that are put together have in common.

    Attributes:
        kind: What happened.
        body: The body's name.
        surface: The surface's name; empty for flights.
        several: Whether impacts may be those of several corners.
        horizon: s before the event.
        method: What the predictions were made from.
        law: The law of the impact. It is None where no impact was asked about.
    """

    kind: EventKind
    body: str
    surface: str
    several: bool
    horizon: float
    method: Method
    law: Law | None

    @staticmethod
    def shared(row: Comparison | Group) -> dict[str, Any]:
        """Return these fields by name, of a comparison or a group."""
        return {field.name: getattr(row, field.name) for field in fields(Group)}


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Spread(Record):
    """How one error is distributed.

    Attributes:
        bias: Median of the error with its sign; of an error that is a size, its median.
        median: Median of its size.
        most: Size that 90 % of the errors do not exceed.
        count: How many there are.
    """

    bias: float
    median: float
    most: float
    count: int


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Summary(Group):
    """The comparisons of one group.

    Attributes:
        asked: How many questions there were.
        refused: How many of them had no answer.
        errors: The distribution of each error of `ERRORS` that there is.
        impacts: How many questions about a mode were answered by an impact: by its published velocity the
            body still approached its surface.
        modes_right: Share of the other modes that were right. It is None without any.
        covered: Share of the measured values inside of the regions of `LEVELS`. It is empty
            without covariances.
        covariances: How many predictions had covariances.
    """

    asked: int
    refused: int
    errors: dict[str, Spread]
    impacts: int
    modes_right: float | None
    covered: tuple[float, ...]
    covariances: int


def summarise(rows: Iterable[Comparison]) -> list[Summary]:
    """Return a summary of each group, in the order of kinds, bodies, surfaces, horizons and methods."""
    groups: dict[Group, list[Comparison]] = defaultdict(list)
    for row in rows:
        groups[group_of(row)].append(row)
    return [_summary(group, groups[group]) for group in sorted(groups, key=_place)]


def group_of(row: Comparison) -> Group:
    """Return what a comparison has in common with those that it is put together with."""
    return Group(**Group.shared(row))


def is_inside(row: Comparison, level: float) -> bool | None:
    """Return whether what was measured is inside of the region of that probability, or None without one."""
    from scipy.special import gammaincinv

    if row.distance is None:
        return None
    return bool(row.distance**2 <= 2.0 * gammaincinv(0.5 * row.degrees, level))


def spread_of(errors: Sequence[float]) -> Spread:
    """Return the distribution of errors, one at least."""
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
