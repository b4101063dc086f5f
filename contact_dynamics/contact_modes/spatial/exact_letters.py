"""Forces of given letters with Coulomb's round cones, by Newton's method from forces that are close.

A contact that sticks has three unknown components of force, and its acceleration vanishes. A contact that
slides has two unknowns, its normal force and the direction of its friction. Its normal acceleration vanishes,
and friction opposes the sliding. So there are as many equations as unknowns. In the end the solution is
checked to have the letters, so that a mode that is found is a mode to rounding.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.tolerances import LETTERS_ON_CONE, LETTERS_REGULAR, LETTERS_SETTLED, STRICT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_MOST_STEPS: Final = 25
"""The largest number of Newton's steps. From forces that are close, some five are enough."""

_MOST_SWAPPED: Final = 5
"""The largest number of contacts that are tried sticking and sliding. Each of them doubles the number of
letters."""


def letters_near(search: Search, letters: str) -> Iterator[str]:
    """Yield letters in which the contacts that stay and have friction stick or slide in any combination."""
    swapped = [i for i, one in enumerate(search.touching) if letters[i] != SEPARATES and one.friction > 0.0]
    if len(swapped) > _MOST_SWAPPED:
        yield letters
        return
    for chosen in itertools.product((STAYS, STICKS), repeat=len(swapped)):
        found = list(letters)
        for i, letter in zip(swapped, chosen, strict=True):
            found[i] = letter
        yield "".join(found)


def forces_with_letters(search: Search, letters: str, forces: FloatArray) -> FloatArray | None:
    """Return forces, (n, 3), of touching contacts at rest that have the letters, or None if none were found.

    Args:
        search: The case.
        letters: s, c or f for each touching contact.
        forces: (n, 3), close to those that are sought, in the units of the motion.
    """
    system = _System(search, letters)
    unknowns = system.start(forces)
    if len(unknowns) == 0:
        return None
    for _ in range(_MOST_STEPS):
        missed, slopes = system.at(unknowns)
        sizes = np.linalg.norm(slopes, axis=0)
        sizes[sizes == 0.0] = 1.0
        left, spread, right = np.linalg.svd(slopes / sizes)
        if not spread[-1] > LETTERS_REGULAR * spread[0]:
            return None
        step = (right.T @ ((left.T @ missed) / spread)) / sizes
        unknowns = unknowns - step
        if not np.all(np.isfinite(unknowns)):
            return None
        if float(np.abs(missed).max()) <= LETTERS_SETTLED:
            break
    else:
        return None
    found = system.forces(unknowns)
    return found if system.has_letters(found) else None


class _System:
    """The equations of some letters."""

    def __init__(self, search: Search, letters: str) -> None:
        self._search, self._letters = search, letters
        self._frames = [
            np.zeros((2, 3)) if pyramid.frame is None else np.array(pyramid.frame)
            for pyramid in search.pyramids
        ]

    def start(self, forces: FloatArray) -> FloatArray:
        """Return the unknowns that are nearest to given forces."""
        found: list[float] = []
        for i, letter in enumerate(self._letters):
            contact = self._search.touching[i]
            if letter == STICKS:
                found += forces[i].tolist()
            elif letter != SEPARATES:
                found.append(float(forces[i] @ contact.normal))
                if contact.friction > 0.0:
                    x, y = self._frames[i] @ forces[i]
                    found.append(math.atan2(-y, -x))
        return np.array(found)

    def at(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return by how much the equations are missed, (k,), and the derivatives of that, (k, k)."""
        forces, changes = self._forces_and_changes(unknowns)
        motion = self._motion(forces)
        of_unknowns = self._search.of_forces @ changes
        missed, slopes = [], []
        at = 0
        for i, letter in enumerate(self._letters):
            contact = self._search.touching[i]
            point, moved = contact.point @ motion, contact.point[:, :6] @ of_unknowns
            if letter == STICKS:
                missed += point.tolist()
                slopes += list(moved)
                at += 3
            elif letter != SEPARATES:
                missed.append(float(contact.normal @ point))
                slopes.append(contact.normal @ moved)
                at += 1
                if contact.friction > 0.0:
                    x, y = math.cos(unknowns[at]), math.sin(unknowns[at])
                    one, two = self._frames[i]
                    across = x * two - y * one
                    missed.append(float(across @ point))
                    slope = across @ moved
                    slope[at] -= float((x * one + y * two) @ point)
                    slopes.append(slope)
                    at += 1
        return np.array(missed), np.array(slopes)

    def forces(self, unknowns: FloatArray) -> FloatArray:
        """Return the contact forces, (n, 3)."""
        return self._forces_and_changes(unknowns)[0]

    def has_letters(self, forces: FloatArray) -> bool:
        """Return whether contacts do under these forces what the letters say."""
        motion = self._motion(forces)
        for contact, letter, force in zip(self._search.touching, self._letters, forces, strict=True):
            point = contact.point @ motion
            pressing = float(contact.normal @ force)
            if letter == SEPARATES:
                if not contact.normal @ point > STRICT:
                    return False
            elif not pressing >= 0.0:
                return False
            elif letter == STICKS:
                across = float(np.linalg.norm(force - pressing * contact.normal))
                if across > contact.friction * pressing * (1.0 + LETTERS_ON_CONE):
                    return False
            elif contact.friction > 0.0:
                friction = force - pressing * contact.normal
                if not -float(friction @ point) > STRICT * float(np.linalg.norm(friction)):
                    return False
        return True

    def _motion(self, forces: FloatArray) -> FloatArray:
        return np.append(self._search.motion[:, -1] + self._search.of_forces @ forces.ravel(), 1.0)

    def _forces_and_changes(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        forces = np.zeros((len(self._letters), 3))
        changes = np.zeros((3 * len(self._letters), len(unknowns)))
        at = 0
        for i, letter in enumerate(self._letters):
            contact, own = self._search.touching[i], slice(3 * i, 3 * i + 3)
            if letter == STICKS:
                forces[i] = unknowns[at : at + 3]
                changes[own, at : at + 3] = np.eye(3)
                at += 3
            elif letter != SEPARATES:
                edge = contact.normal
                if contact.friction > 0.0:
                    x, y = math.cos(unknowns[at + 1]), math.sin(unknowns[at + 1])
                    one, two = self._frames[i]
                    edge = edge - contact.friction * (x * one + y * two)
                    changes[own, at + 1] = unknowns[at] * contact.friction * (y * one - x * two)
                forces[i] = unknowns[at] * edge
                changes[own, at] = edge
                at += 1 if contact.friction == 0.0 else 2
        return forces, changes
