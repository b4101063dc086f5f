# SPDX-License-Identifier: Apache-2.0
"""The letters of contact modes (Mason, lecture 26). A letter describes the motion of one contact.

A mode is a string with one letter for each contact, in the contacts' order, such as "ffs". In the plane a
contact slides left or right. In space it slides in any direction, its letter is `STAYS`, and the answer gives
the direction.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Collection

Letter: TypeAlias = Literal["s", "l", "r", "f", "c"]

SEPARATES: Final = "s"
SLIDES_LEFT: Final = "l"
"""The contact slides against its tangent, which is the normal turned by -90 degrees. Only in the plane."""
SLIDES_RIGHT: Final = "r"
"""The contact slides along its tangent. Only in the plane."""
STICKS: Final = "f"
"""The contact stays, and its point of the body does not slide."""
STAYS: Final = "c"
"""The contact stays. Only in space. A mode with forces has this letter for contacts that slide. A mode of
kinematics alone has it for contacts that slide or stick."""

PLANAR_LETTERS: Final = (SEPARATES, SLIDES_LEFT, SLIDES_RIGHT, STICKS)
SPATIAL_LETTERS: Final = (SEPARATES, STICKS, STAYS)

LETTERS: Final[dict[str, tuple[str, str]]] = {
    SEPARATES: ("separates", "separate"),
    SLIDES_LEFT: ("slides left", "slide left"),
    SLIDES_RIGHT: ("slides right", "slide right"),
    STICKS: ("stays fixed", "stay fixed"),
    STAYS: ("slides", "slide"),
}
"""The verbs for one contact and for several, in a mode with forces."""

_ALTOGETHER: Final = {SEPARATES: "leaves"}
"""The verbs for a body that differ from those for its contacts."""


def mode_in_words(mode: str, *, turns: bool | None = None) -> str:
    """Return a description of a mode with forces: the body's motion, or the number of contacts by letter.

    A body whose contacts all stick may turn, about one finger or about the line through two. The letters do
    not determine this: ``turns`` is whether it turns, or None if this is unknown.

    Raises:
        InvalidFieldError: a letter is not one of a contact mode.
    """
    if set(mode) - set(LETTERS):
        raise InvalidFieldError("mode", mode, f"letters of {', '.join(LETTERS)}")
    kinds = {letter: mode.count(letter) for letter in LETTERS if letter in mode}
    if set(kinds) == {STICKS} and turns is not False:
        words = f"{len(mode)} contact{'s' * (len(mode) > 1)} {LETTERS[STICKS][len(mode) > 1]}"
        return f"it turns ({words})" if turns else "every contact stays fixed"
    if len(kinds) <= 1:
        return next((f"it {_ALTOGETHER.get(kind, LETTERS[kind][0])}" for kind in kinds), "nothing touches it")
    (first, most), *others = kinds.items()
    words = f"{most} contact{'s' * (most > 1)} {LETTERS[first][most > 1]}"
    words += "".join(f", {count} {LETTERS[kind][count > 1]}" for kind, count in others)
    # A rigid body with one fixed contact can only turn about it.
    return f"it tips ({words})" if set(kinds) == {SEPARATES, STICKS} else words


def margin_in_words(mode: str, margin: float, modes_beyond: Collection[str], unknown: str = "") -> str:
    """Return a description of a mode, the change of the wrench that ends it, N, and the modes that follow.

    ``unknown`` is the reason for a margin that is NaN.
    """
    if not math.isfinite(margin):
        why = f"its margin is unknown: {unknown}".removesuffix(": ")
        ends = why if math.isnan(margin) else "no change of the wrench ends that"
        return f"{mode_in_words(mode)}, and {ends}"
    then = " or ".join(map(mode_in_words, modes_beyond)) or "no mode is consistent"
    return f"{mode_in_words(mode)} up to a change of {margin:.3g} N, then {then}"


def check_modes(modes: Collection[str], count: int, letters: tuple[Letter, ...]) -> None:
    """Raise `InvalidFieldError` for the first mode that is not a string of ``count`` of these ``letters``."""
    for mode in modes:
        if len(mode) != count or set(mode) - set(letters):
            allowed = f"{count} letters of {', '.join(letters[:-1])} and {letters[-1]}"
            raise InvalidFieldError("modes", mode, allowed)
