# SPDX-License-Identifier: Apache-2.0
"""The marks of a diagram by their names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from contact_dynamics.diagrams.marks import Diagram, Mark


def marks_of(diagram: Diagram | Iterable[Mark]) -> dict[str, Any]:
    """The marks by their names."""
    marks = diagram.marks if isinstance(diagram, Diagram) else diagram
    return {mark.name: mark for mark in marks}
