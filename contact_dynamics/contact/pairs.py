# SPDX-License-Identifier: Apache-2.0
"""Contacts between several bodies: each has the pair of bodies that touch there, or a body and the world."""

from __future__ import annotations

import operator
from collections.abc import Sized
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from contact_dynamics.constants import seconds_between
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.vectors import point_jacobians
from contact_dynamics.tolerances import STATES_APART

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

Pairs: TypeAlias = "Sequence[tuple[int, int | None]]"
"""For each contact, the body into which its normal points, and the other body, or None for the world."""


class BodyName(str):
    """The name of a body that a contact of two bodies has in the place of a surface's (`next_meeting`)."""

    __slots__ = ()


def check_with_world(field: str, surfaces: Iterable[str]) -> None:
    """Reject contacts with a second body where the world, which does not yield, is the other side.

    Raises:
        InvalidFieldError: a name is that of a body.
    """
    for name in surfaces:
        if isinstance(name, BodyName):
            raise InvalidFieldError(
                field,
                f"one with the body {name!r}",
                "with the world",
                "bodies_impact and BodiesContactProblem take both bodies",
            )


def seconds_apart(states: Sequence[BodyState]) -> float:
    """Return the largest difference between the stamps of states, s. A stamp of 0 means none."""
    stamps = [state.stamp_ns for state in states if state.stamp_ns]
    return seconds_between(min(stamps), max(stamps)) if stamps else 0.0


def check_one_time(states: Sequence[BodyState], field: str) -> None:
    """Reject states of several bodies whose stamps differ by more than `STATES_APART`.

    Raises:
        InvalidFieldError: they do.
    """
    apart = seconds_apart(states)
    if apart > STATES_APART:
        raise InvalidFieldError(
            field,
            f"stamps that differ by {apart:.6g} s",
            "of the same time as the other",
            "free_motion(body, state).state_at(seconds) is the state at another time",
        )


def check_pairs(bodies: int, states: Sequence[object], contacts: ContactSet, pairs: Pairs) -> None:
    """Refuse lists of different length, pairs of other bodies, and contacts that differ from their pairs.

    Raises:
        InvalidFieldError: one of these.
    """
    if len(states) != bodies:
        raise InvalidFieldError("states", f"{len(states)} states", f"{bodies}, one for each body")
    if not isinstance(pairs, Sized) or len(pairs) != len(contacts):
        raise InvalidFieldError("pairs", pairs, f"{len(contacts)}, one for each contact")
    for i, pair in enumerate(pairs):
        allowed = f"two different indices below {bodies}, or None as the second for the world"
        try:
            first, second = pair
            others = () if second is None else (second,)
            known = all(0 <= operator.index(one) < bodies for one in (first, *others))
        except (TypeError, ValueError):
            raise InvalidFieldError(f"pairs[{i}]", pair, allowed) from None
        if not known or first == second:
            raise InvalidFieldError(f"pairs[{i}]", (first, second), allowed)
    named = zip(contacts.surfaces, pairs, strict=False)  # there may be no names
    check_with_world("contacts", [name for name, (_, second) in named if second is None])
    between = [i for i, (_, second) in enumerate(pairs) if second is not None]
    for field in contacts.SURFACE_MOTION:
        motion = getattr(contacts, field)
        for i in between if motion is not None else ():
            if motion[i].any():
                allowed = f"zero between bodies {pairs[i]}, since only surfaces of the world move"
                raise InvalidFieldError(f"contacts.{field}[{i}]", motion[i].tolist(), allowed)


def pair_jacobians(states: Sequence[BodyState], points_W: FloatArray, pairs: Pairs) -> FloatArray:
    """Return the matrix, (n, 3, 6 k), from the velocities of k bodies to those of contact points.

    Velocities, or accelerations, are v then w of each body. At the points, (n, 3), m, those of the first body
    of each pair are relative to the other.
    """
    jacobians = np.zeros((len(points_W), 3, 6 * len(states)))
    for i, pair in enumerate(pairs):
        for index, sign in zip(pair, (1.0, -1.0), strict=True):
            if index is not None:
                arm = points_W[i] - states[index].p_WB_W
                jacobians[i, :, 6 * index : 6 * index + 6] = sign * point_jacobians(arm[None])[0]
    return jacobians
