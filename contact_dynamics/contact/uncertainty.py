"""How well the contacts of a body are known.

The model is a box. Each contact's point, normal and friction may be anywhere within the stated distance from
what the problem says, and each contact may differ in its own way. There is no probability in it: questions
ask what can happen inside the box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact_dynamics.records import Record
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.validation import check_within


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ContactUncertainty(Record):
    """How far the true contacts may be from those of a problem, in the plane or in space.

    Attributes:
        points: m, >= 0, the largest distance from a contact's point to its true place.
        normals: rad, from 0 to pi / 2, the largest angle between a contact's normal and the true one.
        frictions: >= 0, the largest difference of a coefficient of friction. No true coefficient is negative.

    Raises:
        InvalidFieldError: a number is negative, not finite or beyond `LARGEST_NUMBER`, or the angle is larger
            than pi / 2.
    """

    points: float = 0.0
    normals: float = 0.0
    frictions: float = 0.0

    def __post_init__(self) -> None:
        """Check all fields."""
        points = check_within("uncertainty of points", self.points, 0.0, LARGEST_NUMBER)
        object.__setattr__(self, "points", points)
        normals = check_within("uncertainty of normals", self.normals, 0.0, 0.5 * math.pi)
        object.__setattr__(self, "normals", normals)
        frictions = check_within("uncertainty of frictions", self.frictions, 0.0, LARGEST_NUMBER)
        object.__setattr__(self, "frictions", frictions)

    @property
    def is_exact(self) -> bool:
        """Return whether the contacts are exactly those of the problem."""
        return self.points == self.normals == self.frictions == 0.0


EXACT_CONTACTS = ContactUncertainty()
"""The contacts are exactly those of the problem."""
