# SPDX-License-Identifier: Apache-2.0
"""This file names the restitution laws and what can happen during an impact (Mason, lecture 27).

Compression collects an amount, and restitution returns a share of it. `spatial.path` has for each law a
`RestitutionRule`, which says which amount this is and where restitution ends, on paths that are not known in
advance. In the plane the path is known, and the three ends are closed forms in the middle of one computation
(`planar.routh`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.records import NamedInt
from contact_dynamics.validation_batches import check_rows
from contact_dynamics.validation_types import Expected, check_type

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.validation import FloatArray


class RestitutionLaw(NamedInt):
    """How the coefficient e decides where restitution ends.

    The three laws give the same answer where the path is straight: without friction, or where the contact
    slides in one direction throughout or sticks throughout, as it does for a body that falls without spin.
    They differ where sliding stops or turns.
    """

    POISSON = 0
    """e is the normal impulse of restitution over that of compression (lecture 27, eq. 2; Routh 1860)."""
    NEWTON = 1
    """e is the normal velocity of separation over that of approach (lecture 27, eq. 1). Can create energy
    with friction."""
    ENERGETIC = 2
    """e squared is the work that the normal impulse returns over the work that it took (Stronge 1990)."""


class ImpactOutcome(NamedInt):
    """What the contact did while the impulse grew.

    Stopping counts as during compression where it coincides with the end of compression, and as never where
    it coincides with the end of the impact.
    """

    NO_IMPULSE = 0
    """The contact does not approach, and its sliding does not drive it into compression."""
    SLIDES = 1
    """The contact slides until the end and never stops. A contact that is at rest at first slides at once if
    friction cannot hold it."""
    STICKS_IN_COMPRESSION = 2
    """Sliding stops during compression, and friction holds the contact until the end."""
    STICKS_IN_RESTITUTION = 3
    """Sliding stops during restitution, and friction holds the contact until the end."""
    REVERSES_IN_COMPRESSION = 4
    """Sliding stops during compression. Friction cannot hold the contact, so it slides on in another
    direction, which is back in the plane."""
    REVERSES_IN_RESTITUTION = 5
    """Sliding stops during restitution. Friction cannot hold the contact, so it slides on in another
    direction, which is back in the plane."""
    STICKS_THROUGHOUT = 6
    """The contact does not slide at first, and friction holds it until the end."""

    @property
    def sticks(self) -> bool:
        """Return whether the contact ends the impact without sliding."""
        return self in _STICKING


class PathEvent(NamedInt):
    """What a vertex of the impulse path stands for."""

    START = 0
    """The contact begins: the impulse is zero."""
    SLIDING_STOPS = 1
    """The contact stops sliding. It sticks from here on, or slides on in another direction."""
    COMPRESSION_ENDS = 2
    """The contact does not approach any more."""
    RESTITUTION_ENDS = 3
    """The contact separates: the impulse is complete."""
    SAMPLE = 4
    """A point on a curved part of the path, which only paths in space have."""


_STICKING = frozenset(
    {
        ImpactOutcome.STICKS_THROUGHOUT,
        ImpactOutcome.STICKS_IN_COMPRESSION,
        ImpactOutcome.STICKS_IN_RESTITUTION,
    }
)


def check_law_rows(field: str, value: ArrayLike) -> FloatArray:
    """Return values of `RestitutionLaw`, (N,).

    Each may be given as a member or, in an array of numbers, as the member's value.
    """
    if not (isinstance(value, np.ndarray) and value.dtype.kind in "iuf"):
        several = isinstance(value, (list, tuple, np.ndarray)) and np.ndim(value) > 0
        given: Any = value if several else [value]
        for i, law in enumerate(given):
            if type(law) not in {int, float} and not isinstance(law, np.number):
                check_type(f"{field}[{i}]" if several else field, law, Expected((RestitutionLaw,)))
    known = [float(law) for law in RestitutionLaw]
    allowed = " or ".join(f"{law.name} ({law.value})" for law in RestitutionLaw)
    return check_rows(field, value, (), allowed, lambda x: np.isin(x, known))
