# SPDX-License-Identifier: Apache-2.0
"""Names the parameters that a calibration may change. It imports nothing, since `--help` needs it."""

from __future__ import annotations

from enum import Enum
from typing import Final


class Free(Enum):
    """A group of parameters that can be left free."""

    FRICTION = "friction"  # Coulomb's mu of each surface
    RESTITUTION = "restitution"  # the coefficient e of each surface, under Poisson's law
    CENTER_OF_MASS = "center_of_mass"  # the centre of mass in the body's frame, three coordinates
    INERTIA = "inertia"
    """One factor on the inertia. Flights alone do not determine it; strikes do, relative to the mass."""
    INERTIA_RATIOS = "inertia_ratios"
    """Two factors: those of the moments about y and z relative to x, in the body's axes."""
    ROUNDING = "rounding"  # the radius of the corners, at equal outer faces
    SIZE = "size"  # one factor on the shape, about its middle
    SHAPE_POSITION = "shape_position"
    """The shape's place in the body's frame, which is the offset of the tracked frame."""
    SHAPE_ORIENTATION = "shape_orientation"
    """The shape's turn in the body's frame, a rotation vector: how the tracked frame is turned."""
    SURFACE_HEIGHT = "surface_height"  # the height of each surface along its configured normal
    SURFACE_TILT = "surface_tilt"  # the tilt of each surface, about two axes
    GRAVITY = "gravity"  # gravity as a vector, for each recording by itself


STANDARD: Final = (
    Free.FRICTION,
    Free.RESTITUTION,
    Free.CENTER_OF_MASS,
    Free.INERTIA,
    Free.GRAVITY,
    Free.ROUNDING,
    Free.SURFACE_HEIGHT,
)
"""What is free if nobody says otherwise. Corners of real bodies are round, and a surface's height in the
frame of the tracking is seldom known to a millimetre: if they are not free, both end up in the inertia and
the centre of mass. The rounding of a shape without faces is its radius, and keeps its configured value."""

BY_STRIKES: Final = frozenset({Free.FRICTION, Free.RESTITUTION, Free.INERTIA})  # observable from strikes only

GEOMETRY: Final = (  # observable from the heights of corners at strikes and rests
    Free.ROUNDING,
    Free.SIZE,
    Free.SHAPE_POSITION,
    Free.SHAPE_ORIENTATION,
    Free.SURFACE_HEIGHT,
    Free.SURFACE_TILT,
)
