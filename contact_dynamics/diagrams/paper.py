# SPDX-License-Identifier: Apache-2.0
"""The colours on paper. Those who see no green tell them apart too.

Any two that mean different things in one diagram differ by `palette.LEAST_DIFFERENCE` at least, for usual
eyes, and for deuteranopes after the simulation of Machado, Oliveira and Fernandes (2009). A test computes it.
"""

from __future__ import annotations

from typing import Final

BLACK: Final = "#000000"  # what happens: paths, applied wrenches, totals
BLUE: Final = "#0060b0"  # the first of several: x, contacts that stay fixed, lines on which nothing slides
ORANGE: Final = "#e08000"  # the second: y, accelerations and their centres, lines on which nothing approaches
SKY: Final = "#56b4e9"  # the third: z, contacts that separate
RED: Final = "#b03000"  # forces
YELLOW: Final = "#f0d000"  # contacts that slide
PURPLE: Final = "#a060a0"  # friction cones
GREY: Final = "#999999"  # the body
AXIS: Final = "#d8d8d8"  # lines through zero, grids and walls, which only help to read
SERIES: Final = (BLUE, ORANGE, SKY, BLACK)  # curves in one diagram

MODES: Final = (  # regions of the map of modes. A map of more modes uses them again.
    *("#bbddff", "#aa8800", "#8899bb", "#00cc55", "#ee88ff", "#eeee99", "#226699", "#77ccbb", "#aadd44"),
    *("#778877", "#aa77ff", "#bbff00", "#446633", "#1177ff", "#66eeaa", "#6644bb", "#556677", "#6622ff"),
)

DARK: Final = ("#226699", "#446633", "#1177ff", "#6644bb", "#556677", "#6622ff")
"""Those of them on which words are white."""

SEVERAL: Final = "#ffffff"  # regions of the map in which several modes are consistent
NONE: Final = "#000000"  # regions of the map in which no mode is consistent
MARK: Final = "#b00000"  # the applied wrench on the map, and its way into another mode

LETTERS: Final = {"s": SKY, "l": YELLOW, "r": YELLOW, "c": YELLOW, "f": BLUE}
"""By the letter of a contact's mode."""
