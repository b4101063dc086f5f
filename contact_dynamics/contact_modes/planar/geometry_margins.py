"""This file says how far planar contacts would have to move, turn or change friction for another answer."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.geometry_search import geometry_margins_within
from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.uncertain import is_certain, sampled

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.planar.result import PlanarModeAnswer
    from contact_dynamics.contact_modes.result import GeometryMargin

_STEP: Final = 1.5
"""Each size is at most this factor from the next."""

_STEPS: Final = 48
"""Sizes below the largest, which so reach down to 3.5e-9 of it."""


def planar_geometry_margins(
    problem: PlanarContactProblem, answer: PlanarModeAnswer | None = None
) -> tuple[GeometryMargin, ...]:
    """Return the margins of the answer in points, normals and frictions, in this order.

    In each of them only that one is off, for all contacts at once and for each in its own way. There are no
    margins if a contact approaches.

    Args:
        problem: The question. Its own uncertainty plays no part.
        answer: The answer to that question, if it is known.
    """
    if answer is None:
        answer = planar_contact_modes(problem)
    return geometry_margins_within(
        answer,
        radius_of_gyration=problem.body.radius_of_gyration,
        frictions=[contact.friction for contact in problem.contacts],
        step=_STEP,
        steps=_STEPS,
        is_certain=partial(is_certain, problem, answer),
        sampled=partial(sampled, problem),
    )
