# SPDX-License-Identifier: Apache-2.0
"""The names under which things are drawn, and the timeline."""

from __future__ import annotations

from typing import Final

import rerun as rr

TIMELINE: Final = "stamp"
"""Name of the timeline. It is in ns since the epoch of the stamps' clock."""

SINCE_START: Final = "time since start"
"""Name of the timeline on which the first stamp is zero."""

ORDER: Final = "order of events"
"""Name of the timeline that counts what was drawn, in the order in which it came."""

SCENE: Final = "world"
SURFACES: Final = "world/surfaces"
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
    """Return the path of a thing below ``parent``. Names may have any characters."""
    return f"{parent}{rr.new_entity_path(list(names))}"


def body_entity(body_name: str) -> str:
    """Return the path of a body's pose. What lies below it moves with the body."""
    return entity("world/bodies", body_name or "unnamed")


def trail_entity(body_name: str) -> str:
    """Return the path of where a body has been."""
    return entity("world/trails", body_name or "unnamed")


def predicted_entity(body_name: str) -> str:
    """Return the path of where a body was predicted to be."""
    return entity(PREDICTED, body_name or "unnamed")


def impact_entity(body_name: str) -> str:
    """Return the path of a body's predicted impact."""
    return entity(IMPACTS, body_name or "unnamed")


def many_entity(body_name: str) -> str:
    """Return the path of the newest answer about many states of a body."""
    return entity(MANY, body_name or "unnamed")


def toss_entity(body_name: str) -> str:
    """Return the path of the newest answer about a toss of a body."""
    return entity(TOSSES, body_name or "unnamed")


def contacts_entity(body_name: str) -> str:
    """Return the path of a body's contact modes."""
    return entity(CONTACTS, body_name or "unnamed")


def poinsot_entity(body_name: str) -> str:
    """Return the path of Poinsot's picture of a body's rotation."""
    return entity(f"{POINSOT}/bodies", body_name or "unnamed")
