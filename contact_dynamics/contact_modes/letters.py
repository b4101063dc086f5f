"""The letters of contact modes (Mason, lecture 26): what one contact does, in the plane as in space.

A mode is a string with one letter for each contact, in the contacts' order, such as "ffs". In the plane a
contact slides left or right. In space it slides in any direction (`STAYS`), and the answer has the direction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Collection

Letter: TypeAlias = Literal["s", "l", "r", "f", "c"]

SEPARATES: Final = "s"
SLIDES_LEFT: Final = "l"
"""Along the tangent, which is the normal turned by -90 degrees, backwards; in the plane."""
SLIDES_RIGHT: Final = "r"
"""Along the tangent; in the plane."""
STICKS: Final = "f"
"""Fixed."""
STAYS: Final = "c"
"""In contact. In space: it slides, where mechanics tells sliding from sticking; else either of them."""

PLANAR_LETTERS: Final = (SEPARATES, SLIDES_LEFT, SLIDES_RIGHT, STICKS)
SPATIAL_LETTERS: Final = (SEPARATES, STICKS, STAYS)


def check_modes(modes: Collection[str], count: int, letters: tuple[Letter, ...]) -> None:
    """Raise `InvalidFieldError` for the first mode that is not a string of ``count`` such ``letters``."""
    for mode in modes:
        if len(mode) != count or set(mode) - set(letters):
            allowed = f"{count} letters of {', '.join(letters[:-1])} and {letters[-1]}"
            raise InvalidFieldError("modes", mode, allowed)
