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
    """Law of restitution, which defines the coefficient of restitution e and the end of restitution.

    The three laws give the same result if the impulse path is straight: without friction, or if the contact
    slides in one direction throughout or sticks throughout, as for a body that falls without spin. They
    differ if sliding stops or changes its direction.
    """

    POISSON = 0
    """e is the ratio of the normal impulses in restitution and in compression (lecture 27, eq. 2; Routh
    1860)."""
    NEWTON = 1
    """e is the ratio of the normal velocities of separation and of approach (lecture 27, eq. 1). With
    friction, this law can create energy."""
    ENERGETIC = 2
    """e squared is the ratio of the works of the normal impulse in restitution and in compression (Stronge
    1990)."""


class ImpactOutcome(NamedInt):
    """Motion of the contact during an impact.

    If sliding stops at the end of compression, it counts as stopping in compression. If it would stop at the
    end of the impact, it counts as not stopping.
    """

    NO_IMPULSE = 0
    """The contact does not approach, and its sliding does not drive it into compression."""
    SLIDES = 1
    """The contact slides throughout and does not stop. A contact that is initially at rest begins to slide if
    friction cannot hold it."""
    STICKS_IN_COMPRESSION = 2
    """Sliding stops during compression, and then the contact sticks."""
    STICKS_IN_RESTITUTION = 3
    """Sliding stops during restitution, and then the contact sticks."""
    REVERSES_IN_COMPRESSION = 4
    """Sliding stops during compression. Friction cannot hold the contact, so it slides in another direction,
    in planar problems backwards."""
    REVERSES_IN_RESTITUTION = 5
    """Sliding stops during restitution. Friction cannot hold the contact, so it slides in another direction,
    in planar problems backwards."""
    STICKS_THROUGHOUT = 6
    """The contact is initially at rest, and friction holds it throughout the impact."""

    @property
    def sticks(self) -> bool:
        """Return whether the contact sticks at the end of the impact."""
        return self in _STICKING


class PathEvent(NamedInt):
    """Event at a vertex of the impulse path."""

    START = 0
    """The impact begins, and the impulse is zero."""
    SLIDING_STOPS = 1
    """Sliding stops. Then the contact sticks, or slides in another direction."""
    COMPRESSION_ENDS = 2
    """The contact no longer approaches."""
    RESTITUTION_ENDS = 3
    """The contact separates, and the impulse is complete."""
    SAMPLE = 4
    """A point on a curved part of the path, which occurs only in spatial problems."""


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
