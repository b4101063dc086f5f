# SPDX-License-Identifier: Apache-2.0
"""`ContactUncertainty` says how well the contacts of a body are known.

The model is a box. Each contact's point, normal and friction may be anywhere within the stated distance from
what the problem says, and each contact may differ in its own way. There is no probability in it: questions
ask what can happen inside the box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import Record
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.validation import check_within

if TYPE_CHECKING:
    from collections.abc import Sequence


Uncertain = float | tuple[float, ...]
"""One number for all contacts, or one for each."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ContactUncertainty(Record):
    """Largest errors of the contacts of a planar or spatial problem.

    Each field is one number for all contacts, or one number per contact in their order.

    Attributes:
        points: m, >= 0, largest distance of the true contact point from the given one.
        normals: rad, from 0 to pi / 2, largest angle between the true normal and the given one.
        frictions: >= 0, largest difference of the coefficients of friction and static friction. True
            coefficients are not negative.

    Raises:
        InvalidFieldError: a number is negative, not finite or exceeds `LARGEST_NUMBER`, an angle is larger
            than pi / 2, or two fields have numbers for different counts of contacts.
    """

    points: Uncertain = 0.0
    normals: Uncertain = 0.0
    frictions: Uncertain = 0.0

    if TYPE_CHECKING:  # what the constructor takes, beside what the fields then hold

        def __init__(
            self,
            *,
            points: float | Sequence[float] = 0.0,
            normals: float | Sequence[float] = 0.0,
            frictions: float | Sequence[float] = 0.0,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Check all fields."""
        for name, largest in _LARGEST.items():
            field, value = f"uncertainty of {name}", getattr(self, name)
            if np.ndim(value) == 0:
                checked: Uncertain = check_within(field, value, 0.0, largest)
            else:
                each = (check_within(f"{field}[{i}]", one, 0.0, largest) for i, one in enumerate(value))
                checked = tuple(each)
            object.__setattr__(self, name, checked)
        counts = {len(value) for value in self._lists}
        if len(counts) > 1:
            found = f"numbers for {' and '.join(map(str, sorted(counts)))} contacts"
            raise InvalidFieldError("uncertainty", found, "one number, or one for each contact")

    @property
    def is_exact(self) -> bool:
        """Return whether all errors are zero."""
        if self is EXACT_CONTACTS:
            return True
        fields = (self.points, self.normals, self.frictions)
        return not any(any(value) if isinstance(value, tuple) else value for value in fields)

    def check_count(self, contacts: int) -> None:
        """Raise `InvalidFieldError` if a field has numbers for another count of contacts."""
        for value in self._lists:
            if len(value) != contacts:
                allowed = f"one number, or one for each of {contacts} contacts"
                raise InvalidFieldError("uncertainty", f"numbers for {len(value)} contacts", allowed)

    def of_each(self, contacts: int) -> list[tuple[float, float, float]]:
        """Return (points, normals, frictions) for each of so many contacts."""
        columns = (
            value if isinstance(value, tuple) else (value,) * contacts
            for value in (self.points, self.normals, self.frictions)
        )
        return list(zip(*columns, strict=True))

    @property
    def _lists(self) -> list[tuple[float, ...]]:
        fields = (self.points, self.normals, self.frictions)
        return [value for value in fields if isinstance(value, tuple)]


_LARGEST: Final = {"points": LARGEST_NUMBER, "normals": 0.5 * math.pi, "frictions": LARGEST_NUMBER}

EXACT_CONTACTS = ContactUncertainty()
"""The contacts are exactly those of the problem."""
