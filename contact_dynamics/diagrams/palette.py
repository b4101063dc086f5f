# SPDX-License-Identifier: Apache-2.0
"""The colours and their meanings, which are the same everywhere: red, green, blue and opacity, 0 to 255.

Those who see no green tell apart any two that mean different things in the scene. They differ by
`LEAST_DIFFERENCE` at least, for usual eyes, and for deuteranopes after the simulation of Machado, Oliveira
and Fernandes (2009). A test computes it. The colours were found by a random search near those that one
expects.
"""

from __future__ import annotations

import colorsys
from functools import cache
from typing import Final, NamedTuple, TypeAlias

Color: TypeAlias = tuple[int, int, int, int]

LEAST_DIFFERENCE: Final = 20.0
"""Difference of two colours, CIE 1976 ΔE*ab. Adjacent patches are distinguishable from about 2, and thin
lines far apart need about ten times that."""

WORD_CONTRAST: Final = 7.0
"""Least contrast of a word with the background, as WCAG 2.2 asks for at its level AAA."""

MEASURED: Final[Color] = (94, 152, 198, 255)
"""Blue grey is for what was measured: the body, its trail, its height and speed."""

MEASURED_EDGE: Final[Color] = (35, 60, 85, 255)  # edges of the body
PREDICTED: Final[Color] = (255, 160, 40, 255)  # orange: where the body was predicted to be
IMPACT: Final[Color] = (218, 36, 51, 255)  # red: the body at a predicted impact, and the impulse on it
BEFORE_IMPACT: Final[Color] = (172, 160, 109, 255)  # pale yellow: the velocity before an impact
AFTER_IMPACT: Final[Color] = (255, 255, 76, 255)  # bright yellow: the velocity after it

FRICTION_CONE: Final[Color] = (138, 87, 200, 110)
"""Translucent violet: the forces and impulses that friction allows."""

NORMAL: Final[Color] = (255, 255, 255, 255)  # white: contact normals
SEPARATE: Final[Color] = (84, 225, 251, 255)  # cyan: a contact that separates (`s`)
SLIDE: Final[Color] = (245, 144, 197, 255)  # pink: a contact that slides (`l`, `r`, in space `c`)
FIXED: Final[Color] = (31, 131, 90, 255)  # green: a contact that stays fixed (`f`)

UNDECIDED: Final[Color] = (255, 255, 255, 255)
"""White: a contact whose letter differs between the consistent modes, or that has none."""

NO_MODE: Final[Color] = (0, 0, 0, 255)
"""Black, in the map of modes: wrenches under which no mode is consistent."""

SURFACE: Final[Color] = (150, 160, 150, 70)  # translucent grey: a surface of the world

SURFACE_GRID: Final[Color] = (170, 180, 170, 70)
"""Lines on it, 0.1 m apart, or on a large surface 1 m, 10 m and so on."""

STICKING_LINE: Final[Color] = FIXED
"""Green, in impulse space: impulses after which the contact does not slide."""

COMPRESSION_LINE: Final[Color] = SEPARATE
"""Cyan, in impulse space: impulses after which the contact does not approach."""

POLHODE: Final[Color] = PREDICTED  # orange: where the angular velocity goes on the inertia ellipsoid
HERPOLHODE: Final[Color] = FIXED  # green: where it goes on the invariable plane
BACKGROUND: Final[Color] = (24, 27, 32, 255)  # behind the 3D view and impulse space

LETTER_COLORS: Final[dict[str, Color]] = {"s": SEPARATE, "l": SLIDE, "r": SLIDE, "c": SLIDE, "f": FIXED}
"""By the letter of a contact's mode."""


BODIES: Final[tuple[Color, ...]] = (
    MEASURED,
    *((141, 179, 103, 255), (46, 179, 255, 255), (103, 255, 160, 255), (122, 65, 27, 255)),
    *((65, 217, 160, 255), (122, 217, 84, 255), (179, 141, 160, 255), (122, 122, 84, 255)),
    *((46, 141, 255, 255), (179, 8, 198, 255), (141, 8, 236, 255), (179, 8, 122, 255)),
    *((8, 65, 160, 255), (65, 84, 65, 255), (179, 198, 255, 255), (8, 103, 141, 255)),
    *((141, 236, 236, 255), (27, 27, 236, 255), (236, 255, 236, 255)),
)
"""Bodies of a world, in its order. More of them use these again. Any two differ by `LEAST_DIFFERENCE`, and so
do they from predictions and impacts."""


def body_color(index: int) -> Color:
    """Return the colour of a body of a world by its place there."""
    return BODIES[index % len(BODIES)]


@cache
def readable(color: Color) -> Color:
    """Return the colour, as much lighter as a word needs to have `WORD_CONTRAST` before the background."""
    share = 0.0
    while contrast(lighter := _lightened(color, share), BACKGROUND) < WORD_CONTRAST:
        share += 0.05
    return lighter


def contrast(one: Color, other: Color) -> float:
    """Return the contrast of two opaque colours as WCAG 2 defines it, 1 to 21."""
    low, high = sorted(_luminance(color) for color in (one, other))
    return (high + 0.05) / (low + 0.05)


def _lightened(color: Color, share: float) -> Color:
    red, green, blue = (round(part + share * (255 - part)) for part in color[:3])
    return (red, green, blue, 255)


def _luminance(color: Color) -> float:
    """Return the relative luminance of an opaque colour, 0 to 1, after IEC 61966-2-1."""
    linear = [
        value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
        for value in (part / 255 for part in color[:3])
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def translucent(color: Color, opacity: float) -> Color:
    """Return the colour with that opacity, 0 to 1."""
    red, green, blue, _ = color
    return (red, green, blue, round(255 * opacity))


def mode_color(mode: str, index: int) -> Color:
    """Return the colour of a mode's region in the map of modes, ``index`` being its place among all modes.

    A body that stays fixed has the colour of a fixed contact, one that leaves that of a separating one. The
    other hues are a golden section of the circle apart, so that neighbours in the list differ.
    """
    if set(mode) <= {"f"}:
        return FIXED
    if set(mode) <= {"s"}:
        return SEPARATE
    hue = (0.62 + index * 0.618034) % 1.0
    lightness = 0.48 + 0.1 * (index % 3)
    red, green, blue = colorsys.hls_to_rgb(hue, lightness, 0.55)
    return (round(255 * red), round(255 * green), round(255 * blue), 255)


class Paint(NamedTuple):
    """A colour with one meaning."""

    dark: Color  # on the dark background of the viewer
    paper: str  # on paper, as Matplotlib writes it
