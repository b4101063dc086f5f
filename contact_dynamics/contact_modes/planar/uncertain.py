# SPDX-License-Identifier: Apache-2.0
"""This file finds the verdicts that occur if planar contacts are known only to some uncertainty.

The true contacts are somewhere in the box of a `ContactUncertainty`. A verdict is certain if it is proven for
every contact set in the box:

- A mode is consistent everywhere if its forces exist everywhere (`everywhere`).
- No other mode occurs anywhere if linear programs that allow for the whole box have no solution
  (`excluded`).

If there is no proof, contact sets in the box are sampled, and the verdicts that they have are listed. Whether
more verdicts occur is then not known.

There are proofs only for bodies at rest. Each contact's errors are independent of the others', and the body's
mass and the applied wrench are known.

The geometry margins are how far contacts would have to move, turn or change friction for another answer.
"""

from __future__ import annotations

import math
import random
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.geometry_search import geometry_margins_within, verdicts_within
from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.everywhere import holds_everywhere
from contact_dynamics.contact_modes.planar.excluded import no_other_mode
from contact_dynamics.contact_modes.result import ModeVerdict

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.planar.result import PlanarModeAnswer
    from contact_dynamics.contact_modes.result import GeometryMargin, VerdictsWithin
    from contact_dynamics.plane.types import PlanarContact


SAMPLES: Final = 64
"""Contact sets that are tried if there is no proof. Half of them are at corners of the box."""


def planar_verdicts_within(
    problem: PlanarContactProblem, answer: PlanarModeAnswer | None = None
) -> VerdictsWithin:
    """Return the verdicts that occur within the problem's uncertainty.

    Args:
        problem: The question, with its uncertainty.
        answer: The answer to that question, if it is known.
    """
    if answer is None:
        answer = planar_contact_modes(problem)
    return verdicts_within(
        answer,
        problem.uncertainty,
        is_certain=partial(is_certain, problem, answer),
        sampled=partial(sampled, problem),
    )


def is_certain(problem: PlanarContactProblem, answer: PlanarModeAnswer, box: ContactUncertainty) -> bool:
    """Return whether it is proven that the verdict of ``answer`` holds everywhere in a box."""
    at_rest = all(velocity == (0.0, 0.0) for velocity in answer.contact_velocities)
    if not at_rest or not problem.contacts:
        return not problem.contacts
    if answer.verdict == ModeVerdict.INDETERMINATE:
        holding = (mode for mode in answer.modes if holds_everywhere(problem, mode, box))
        return next(holding, None) is not None and next(holding, None) is not None
    if answer.verdict == ModeVerdict.UNIQUE:
        (mode,) = answer.modes
        return holds_everywhere(problem, mode, box) and no_other_mode(problem, mode, box)
    return False


def sampled(problem: PlanarContactProblem, box: ContactUncertainty) -> Iterator[PlanarModeAnswer]:
    """Yield the answers for some contact sets in a box. The same box always gives the same sets."""
    chance = random.Random(0)  # noqa: S311 - a sample, no secret
    box_of_each = box.of_each(len(problem.contacts))
    for index in range(SAMPLES):
        contacts = [
            _moved(contact, of, chance, corner=index % 2 == 0)
            for contact, of in zip(problem.contacts, box_of_each, strict=True)
        ]
        yield planar_contact_modes(replace(problem, contacts=contacts, uncertainty=EXACT_CONTACTS))


def _moved(
    contact: PlanarContact, box: tuple[float, float, float], chance: random.Random, *, corner: bool
) -> PlanarContact:
    def error(size: float) -> float:
        return size * (chance.choice([-1.0, 1.0]) if corner else chance.uniform(-1.0, 1.0))

    points, normals, frictions = box
    turn, way, step = error(normals), chance.uniform(-math.pi, math.pi), abs(error(points))
    (x, y), (n_x, n_y) = contact.r, contact.normal
    c, s = math.cos(turn), math.sin(turn)
    return replace(
        contact,
        r=(x + step * math.cos(way), y + step * math.sin(way)),
        normal=(c * n_x - s * n_y, s * n_x + c * n_y),
        friction=max(0.0, contact.friction + error(frictions)),
    )


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
