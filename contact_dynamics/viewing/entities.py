"""The names under which things are drawn, and the timeline."""

from __future__ import annotations

from typing import Final

import rerun as rr

TIMELINE: Final = "stamp"
"""Name of the timeline. It is in ns since the epoch of the stamps' clock."""

SCENE: Final = "world"
SURFACES: Final = "world/surfaces"
IMPULSE_SPACE: Final = "impulse_space"
MODE_MAP: Final = "mode_map"
FORCE_DUAL: Final = "force_dual"
PLANAR_MODES: Final = "planar_modes"
PLANAR_SCENE: Final = "planar_scene"
POINSOT: Final = "poinsot"
HEIGHT: Final = "height"
SPEED: Final = "speed"
ANSWERS: Final = "answers"
ANSWER_LOG: Final = "answers/log"
NEWEST_ANSWERS: Final = "answers/newest"
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
    return entity("world/predicted", body_name or "unnamed")


def impact_entity(body_name: str) -> str:
    """Return the path of a body's predicted impact."""
    return entity("world/impact", body_name or "unnamed")


def contacts_entity(body_name: str) -> str:
    """Return the path of a body's contact modes."""
    return entity("world/contacts", body_name or "unnamed")


def poinsot_entity(body_name: str) -> str:
    """Return the path of Poinsot's picture of a body's rotation."""
    return entity(POINSOT, body_name or "unnamed")
