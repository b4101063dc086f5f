# SPDX-License-Identifier: Apache-2.0
"""How an impact changes the kinetic energy, and whether the law of restitution created energy.

The change of kinetic energy is the impulse times the mean of the contact's velocities before and after. The
difference of the bodies' energies gives it too, but it loses the digits of a small change.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, TypeVar

from contact_dynamics.records import Record, Rows
from contact_dynamics.tolerances import ENERGY_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

Real = TypeVar("Real", float, "FloatArray")
"""A float, or an array, (N,), with an element for each case. Sums and products round equally in both."""


def energy_change(impulse: Sequence[Real], before: Sequence[Real], after: Sequence[Real]) -> Real:
    """Return the change of kinetic energy, J, by an impulse, N s, at one contact.

    All are by components along the same axes, each a number, or an array with an element for each case. The
    contact's velocities before and afterwards, m/s, are relative to what it touches.
    """
    return 0.5 * _inner(impulse, [v + w for v, w in zip(before, after, strict=True)])


def law_created(impulse: Sequence[Real], before: Sequence[Real], after: Sequence[Real]) -> Any:
    """Return whether an impulse gave energy: a bool, or an array of them. The arguments are as above."""
    sizes = [abs(v) + abs(w) for v, w in zip(before, after, strict=True)]
    return created(energy_change(impulse, before, after), _inner([abs(i) for i in impulse], sizes))


class OneEnergy(Record):
    """The energy of one impact, for results that know what happened at their contact."""

    __slots__ = ()

    @property
    def energy_change(self) -> float:
        """Return the change of kinetic energy, J: the impulse times the contact's mean velocity.

        The work of a moving surface, the impulse times its velocity, is not part of it.
        """
        return energy_change(*self._at_contact())

    @property
    def creates_energy(self) -> bool:
        """Return whether the impact increased the energy by more than rounding error. Only Newton's can."""
        return bool(law_created(*self._at_contact()))

    @abstractmethod
    def _at_contact(self) -> tuple[Sequence[float], ...]:
        """Return the impulse and the velocities before and afterwards, each by components."""


class ManyEnergies(Rows):
    """The energies of many impacts, for results that know what happened at their contacts."""

    __slots__ = ()

    @property
    def energy_changes(self) -> FloatArray:
        """Return the changes of kinetic energy, (N,), J."""
        return energy_change(*self._at_contacts())

    @property
    def creates_energy(self) -> NDArray[np.bool_]:
        """Return which impacts gain energy by their law, (N,), beyond rounding. Only Newton's can do that."""
        found: NDArray[np.bool_] = law_created(*self._at_contacts())
        return found

    @abstractmethod
    def _at_contacts(self) -> tuple[list[FloatArray], ...]:
        """Return the impulses and the velocities before and afterwards, each by components, (N,)."""


def created(change: Real, exchanged: Real) -> Any:
    """Return whether a change of energy, J, is more than the rounding of the energy that was exchanged, J.

    At one contact, the impulse exchanges its work. At several contacts, impulses in turn give energy and take
    it again, so there the kinetic energy before the impact counts as exchanged.
    """
    return change > ENERGY_TOLERANCE * exchanged


def _inner(a: Sequence[Real], b: Sequence[Real]) -> Real:
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total = total + x * y
    return total
