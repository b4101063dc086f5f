# SPDX-License-Identifier: Apache-2.0
"""This file says what one contact that is known only to some uncertainty may do.

A contact separates, sticks, or slides in a direction of some arc. Each of these is an `UncertainWay`. Its
motions satisfy linear inequalities, and its forces lie in a cone of few edges. An empty letter stands for
every way.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.tolerances import SAME_ARCS

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.bounds import BoundedContact
    from contact_dynamics.validation import FloatArray

_ARCS: Final = 3
"""The arcs that the directions of a contact are divided into at first. With four, a box on four feet takes a
fifth more linear programs, and with eight three times as many."""

_EDGES: Final = 16
"""Edges of the pyramid that holds a round cone. It has 2 % more friction than the cone."""


class UncertainWay(NamedTuple):
    """What one contact does.

    Attributes:
        letter: Its letter. It is empty where any is allowed.
        first: rad, where the arc of its sliding begins, in the contact's frame.
        width: rad, the width of that arc.
    """

    letter: str
    first: float = 0.0
    width: float = 0.0

    @property
    def halves(self) -> tuple[UncertainWay, UncertainWay]:
        """Return the two halves of the arc."""
        half = 0.5 * self.width
        return self._replace(width=half), self._replace(first=self.first + half, width=half)

    def obeys(self, other: UncertainWay, lines: int) -> bool:
        """Return whether true motions of this way satisfy the first ``lines`` inequalities of another.

        The first says that the contact does not penetrate, which is so in every way. The second says that it
        does not separate. The others are about its sliding, and a contact that sticks satisfies those of
        every arc.
        """
        if lines <= 1:
            return True
        if lines == 2 or self.letter == STICKS:
            return self.letter in {STICKS, STAYS}
        inside = self.first - other.first
        return (
            self.letter == other.letter == STAYS
            and inside >= -SAME_ARCS
            and inside + self.width <= other.width + SAME_ARCS
        )


ANY: Final = UncertainWay("")
_WIDEST: Final = 2.0 * math.pi / _ARCS
WAYS: Final = (
    UncertainWay(SEPARATES),
    UncertainWay(STICKS),
    *(UncertainWay(STAYS, k * _WIDEST, _WIDEST) for k in range(_ARCS)),
)
"""All that a contact can do."""


class UncertainWays:
    """The motions and forces of all ways of some contacts. Each is computed once."""

    __slots__ = ("_contacts", "_forces", "_lines")

    def __init__(self, contacts: list[BoundedContact]) -> None:
        """Take the contacts."""
        self._contacts = contacts
        self._forces: dict[tuple[int, UncertainWay], tuple[FloatArray, FloatArray]] = {}
        self._lines: dict[tuple[int, UncertainWay], FloatArray] = {}

    def lines(self, i: int, way: UncertainWay) -> FloatArray:
        """Return rows, (k, 6), that are not positive on the motions that a way allows.

        Each is a combination of the contact's nominal rows with coefficients of length 1.
        """
        if (i, way) not in self._lines:
            self._lines[i, way] = _lines(self._contacts[i], way)
        return self._lines[i, way]

    def forces(self, i: int, way: UncertainWay) -> tuple[FloatArray, FloatArray]:
        """Return wrenches, (k, 6), of size 1 of edge forces that hold all forces, and their errors."""
        if (i, way) not in self._forces:
            contact, edges = self._contacts[i], _edges(self._contacts[i], way)
            rows = edges @ contact.rows
            lengths = np.linalg.norm(rows, axis=1)[:, None]
            sizes = np.linalg.norm(edges, axis=1)[:, None]
            self._forces[i, way] = rows / lengths, sizes * contact.errors / lengths
        return self._forces[i, way]


def _lines(contact: BoundedContact, way: UncertainWay) -> FloatArray:
    normal, one, two = contact.rows
    lines = [-normal]
    if way.letter == STICKS:
        lines += [normal, one, -one, two, -two]
    elif way.letter == STAYS:
        lines.append(normal)
        for angle, sense in ((way.first, 1.0), (way.first + way.width, -1.0)):
            lines.append(sense * (math.sin(angle) * one - math.cos(angle) * two))
    return np.array(lines)


def _edges(contact: BoundedContact, way: UncertainWay) -> FloatArray:
    """Return edges, (k, 3), of a cone in the contact's frame that holds all forces of a way."""
    least, most = contact.min_friction, contact.max_friction
    if way.letter == SEPARATES:
        return np.zeros((0, 3))
    if way.letter == STAYS:  # its force is opposite to its sliding
        half = 0.5 * way.width
        angles = way.first + math.pi + half * np.array([0.0, 1.0, 2.0, 0.0, 2.0])
        radii = np.array([most, most / math.cos(half), most, least, least])
    else:
        angles = np.linspace(0.0, 2.0 * math.pi, _EDGES, endpoint=False)
        radii = np.full(_EDGES, most / math.cos(math.pi / _EDGES))
    edges: FloatArray = np.column_stack(
        [np.ones_like(angles), radii * np.cos(angles), radii * np.sin(angles)]
    )
    return edges
