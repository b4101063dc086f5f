"""The mass of a shape, which is given as such or as a density."""

from __future__ import annotations

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.validation import check_positive


def mass_of(measure: float, *, mass: float | None, density: float | None) -> float:
    """Return the mass, kg, of a shape of that volume, area or length, from a mass or from a density."""
    if (mass is None) == (density is None):
        raise InvalidFieldError("mass, density", f"{mass}, {density}", "exactly one of the two")
    return check_positive("mass", mass) if density is None else check_positive("density", density) * measure
