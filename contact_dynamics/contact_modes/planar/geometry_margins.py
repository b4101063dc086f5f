"""How far contacts would have to move, turn or change their friction for another verdict or mode.

For each of the three, boxes of growing size are searched for the largest one in which the answer is proven
(`uncertain.is_certain`), and for the smallest one in which a sample has another answer. The true margin lies
between the two sizes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.uncertain import is_certain, sampled
from contact_dynamics.contact_modes.result import GeometryMargin, ModeVerdict

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.planar.result import PlanarModeAnswer

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
    if answer.verdict == ModeVerdict.IMPACT:
        return ()
    rho = problem.body.radius_of_gyration
    largest_friction = max((contact.friction for contact in problem.contacts), default=0.0)
    return (
        _margin(problem, answer, "points", rho),
        _margin(problem, answer, "normals", 0.5 * math.pi),
        _margin(problem, answer, "frictions", max(1.0, largest_friction)),
    )


def _margin(
    problem: PlanarContactProblem, answer: PlanarModeAnswer, kind: str, largest: float
) -> GeometryMargin:
    sizes = [largest / _STEP**k for k in range(_STEPS, -1, -1)]

    def box(k: int) -> ContactUncertainty:
        return ContactUncertainty(**{kind: sizes[k]})

    def others(k: int) -> list[PlanarModeAnswer]:
        return [one for one in sampled(problem, box(k)) if _says(one) != _says(answer)]

    proven = _first(len(sizes), lambda k: not is_certain(problem, answer, box(k)))
    # The true margin is not below what is proven, so no smaller box needs samples.
    changed = proven + _first(len(sizes) - proven, lambda k: bool(others(proven + k)))
    beyond = others(changed)[0] if changed < len(sizes) else None
    return GeometryMargin(
        kind=kind,
        holds_within=sizes[proven - 1] if proven > 0 else 0.0,
        changes_at=sizes[changed] if beyond else math.inf,
        verdict_beyond=beyond.verdict if beyond else answer.verdict,
        modes_beyond=tuple(mode.mode for mode in beyond.modes) if beyond else (),
    )


def _says(answer: PlanarModeAnswer) -> tuple[ModeVerdict, tuple[str, ...]]:
    """Return the verdict of an answer, and its mode if there is only one."""
    unique = answer.verdict == ModeVerdict.UNIQUE
    return answer.verdict, tuple(mode.mode for mode in answer.modes) if unique else ()


def _first(count: int, happens: Callable[[int], bool]) -> int:
    """Return the first of ``count`` steps at which something happens that goes on to happen, by bisection.

    Returns ``count`` if it does not happen.
    """
    low, high = 0, count
    while low < high:
        middle = (low + high) // 2
        if happens(middle):
            high = middle
        else:
            low = middle + 1
    return low
