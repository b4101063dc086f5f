"""The marks of a diagram by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contact_dynamics.diagrams.marks import Diagram


def marks_of(diagram: Diagram) -> dict[str, Any]:
    """The marks by their names."""
    return {mark.name: mark for mark in diagram.marks}
