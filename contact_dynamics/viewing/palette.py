"""The colours and their meanings, which are the same everywhere: red, green, blue and opacity, 0 to 255."""

from __future__ import annotations

import colorsys
from typing import Final, TypeAlias

Color: TypeAlias = tuple[int, int, int, int]

MEASURED: Final[Color] = (120, 170, 215, 255)
"""Blue grey is for what was measured: the body, its trail, its height and speed."""

MEASURED_EDGE: Final[Color] = (35, 60, 85, 255)
"""Edges of the body."""

PREDICTED: Final[Color] = (255, 160, 40, 255)
"""Orange: where the body was predicted to be."""

IMPACT: Final[Color] = (240, 60, 70, 255)
"""Red: the body at a predicted impact, and the impulse on it."""

BEFORE_IMPACT: Final[Color] = (190, 180, 120, 255)
"""Pale yellow: the velocity before an impact."""

AFTER_IMPACT: Final[Color] = (255, 225, 60, 255)
"""Bright yellow: the velocity after it."""

FRICTION_CONE: Final[Color] = (190, 120, 235, 90)
"""Translucent violet: the forces and impulses that friction allows."""

NORMAL: Final[Color] = (230, 230, 230, 255)
"""White: contact normals."""

SEPARATE: Final[Color] = (90, 205, 235, 255)
"""Cyan: a contact that separates (`s`)."""

SLIDE: Final[Color] = (235, 95, 200, 255)
"""Pink: a contact that slides (`l`, `r`, in space `c`)."""

FIXED: Final[Color] = (95, 210, 105, 255)
"""Green: a contact that stays fixed (`f`)."""

UNDECIDED: Final[Color] = (255, 255, 255, 255)
"""White: a contact whose letter differs between the consistent modes, or that has none."""

NO_MODE: Final[Color] = (0, 0, 0, 255)
"""Black, in the map of modes: wrenches under which no mode is consistent."""

SURFACE: Final[Color] = (150, 160, 150, 70)
"""Translucent grey: a surface of the world."""

SURFACE_GRID: Final[Color] = (170, 180, 170, 70)
"""Lines on it, 0.1 m apart, or on a large surface 1 m, 10 m and so on."""

STICKING_LINE: Final[Color] = (95, 210, 105, 255)
"""Green, in impulse space: impulses after which the contact does not slide."""

COMPRESSION_LINE: Final[Color] = (90, 205, 235, 255)
"""Cyan, in impulse space: impulses after which the contact does not approach."""

POLHODE: Final[Color] = (255, 160, 40, 255)
"""Orange: where the angular velocity goes on the inertia ellipsoid."""

HERPOLHODE: Final[Color] = (95, 210, 105, 255)
"""Green: where it goes on the invariable plane."""

BACKGROUND: Final[Color] = (24, 27, 32, 255)
"""Behind the 3D view and impulse space."""

LETTER_COLORS: Final[dict[str, Color]] = {"s": SEPARATE, "l": SLIDE, "r": SLIDE, "c": SLIDE, "f": FIXED}
"""By the letter of a contact's mode."""


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
