# SPDX-License-Identifier: Apache-2.0
"""The names of drawn entities, and the timelines."""

from __future__ import annotations

from typing import Final

import rerun as rr

TIMELINE: Final = "stamp"  # name of the timeline. It is in ns since the epoch of the stamps' clock.
SINCE_START: Final = "time since start"  # name of the timeline on which the first stamp is zero

ORDER: Final = "order of events"
"""Name of the timeline with the number of each drawing, in their order."""

SCENE: Final = "world"
SURFACES: Final = "world/surfaces"
BODIES: Final = "world/bodies"  # everything below a body moves with it
TRAILS: Final = "world/trails"
PREDICTED: Final = "world/predicted"
IMPACTS: Final = "world/impact"
CONTACTS: Final = "world/contacts"
TOSSES: Final = "world/toss"
MANY: Final = "world/many"
IMPULSE_SPACE: Final = "impulse_space"
IMPULSE_SPACE_IN_3D: Final = "impulse_space_in_3d"
MODE_MAP: Final = "mode_map"
FORCE_DUAL: Final = "force_dual"
PLANAR_MODES: Final = "planar_modes"
POINSOT: Final = "poinsot"
POINSOT_BODIES: Final = "poinsot/bodies"
POINSOT_WORDS: Final = "poinsot/words"
HEIGHT: Final = "height"
SPEED: Final = "speed"
ENERGY: Final = "energy"
MOMENTUM: Final = "momentum"
ANGULAR_MOMENTUM: Final = "angular_momentum"
ANGULAR_VELOCITY: Final = "angular_velocity"
WHOSE: Final = "whose_energy"
ERROR: Final = "error"
ANSWERS: Final = "answers"
ANSWER_LOG: Final = "answers/log"
NEWEST_ANSWERS: Final = "answers/newest"
SUMMARY: Final = "answers/summary"
LEGEND: Final = "legend"


def entity(parent: str, *names: str) -> str:
    """Return the path of an entity below ``parent``. Names may have any characters, or none."""
    return f"{parent}{rr.new_entity_path([name or 'unnamed' for name in names])}"
