"""Names of the restitution laws and of what can happen during an impact (Mason, lecture 27)."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.validation import check_choice
from contact_dynamics.validation_batches import check_rows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.validation import FloatArray


class RestitutionLaw(IntEnum):
    """How the coefficient e decides where restitution ends."""

    POISSON = 0
    """e is the normal impulse of restitution over that of compression (lecture 27, eq. 2; Routh 1860)."""
    NEWTON = 1
    """e is the normal velocity of separation over that of approach (lecture 27, eq. 1). Can create energy
    with friction."""
    ENERGETIC = 2
    """e squared is the work that the normal impulse returns over the work that it took (Stronge 1990)."""


class ImpactOutcome(IntEnum):
    """What the contact did while the impulse grew.

    Stopping counts as during compression where it coincides with the end of compression, and as never where
    it coincides with the end of the impact.
    """

    NO_IMPULSE = 0
    """The contact does not approach, and its sliding does not drive it into compression."""
    SLIDES = 1
    """It slides until the end without having stopped; from rest, it slides at once, because friction cannot
    hold it."""
    STICKS_IN_COMPRESSION = 2
    """Sliding stops during compression, and friction holds the contact until the end."""
    STICKS_IN_RESTITUTION = 3
    """Sliding stops during restitution, and friction holds the contact until the end."""
    REVERSES_IN_COMPRESSION = 4
    """Sliding stops during compression; friction cannot hold the contact, which slides on another way (in the
    plane: back)."""
    REVERSES_IN_RESTITUTION = 5
    """Sliding stops during restitution; friction cannot hold the contact, which slides on another way (in the
    plane: back)."""
    STICKS_THROUGHOUT = 6
    """It does not slide at first, and friction holds it until the end."""

    @property
    def sticks(self) -> bool:
        """Return whether the contact ends the impact without sliding."""
        return self in _STICKING


class PathEvent(IntEnum):
    """What a vertex of the impulse path stands for."""

    START = 0
    SLIDING_STOPS = 1
    COMPRESSION_ENDS = 2
    RESTITUTION_ENDS = 3
    SAMPLE = 4
    """A point on a curved part (space)."""


_STICKING = frozenset(
    {
        ImpactOutcome.STICKS_THROUGHOUT,
        ImpactOutcome.STICKS_IN_COMPRESSION,
        ImpactOutcome.STICKS_IN_RESTITUTION,
    }
)


def check_law_rows(field: str, value: ArrayLike) -> FloatArray:
    """Return values of `RestitutionLaw`, (N,); each may be a member or, in an array of numbers, its value."""
    if not (isinstance(value, np.ndarray) and value.dtype.kind in "iuf"):
        several = isinstance(value, (list, tuple, np.ndarray)) and np.ndim(value) > 0
        given: Any = value if several else [value]
        for i, law in enumerate(given):
            if type(law) not in {int, float} and not isinstance(law, np.number):
                check_choice(f"{field}[{i}]" if several else field, law, RestitutionLaw)
    known = [float(law) for law in RestitutionLaw]
    allowed = " or ".join(f"{law.name} ({law.value})" for law in RestitutionLaw)
    return check_rows(field, value, (), allowed, lambda x: np.isin(x, known))
