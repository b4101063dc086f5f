# SPDX-License-Identifier: Apache-2.0
"""The size of a shape is bounded, and its mass is given as such or as a density."""

from __future__ import annotations

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import LARGEST_NUMBER
from contact_dynamics.validation import check_within


def check_length(field: str, value: object) -> float:
    """Return a length of a shape, m, between the inverse of `LARGEST_NUMBER` and that number."""
    return check_within(field, value, 1.0 / LARGEST_NUMBER, LARGEST_NUMBER)


def check_length_or_none(field: str, value: object) -> float:
    """Return a length of a shape, m, which may be zero."""
    return check_within(field, value, 0.0, LARGEST_NUMBER)


def mass_of(measure: float, *, mass: float | None, density: float | None) -> float:
    """Return the mass, kg, of a shape of that volume, area or length, from a mass or from a density."""
    if (mass is None) == (density is None):
        found = "neither" if mass is None else "both"
        raise InvalidFieldError("mass or density", found, "given, and not both")
    if density is None:
        return check_within("mass", mass, 1.0 / LARGEST_NUMBER, LARGEST_NUMBER)
    return check_within("density", density, 1.0 / LARGEST_NUMBER, LARGEST_NUMBER) * measure
