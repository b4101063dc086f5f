# SPDX-License-Identifier: Apache-2.0
"""The verdicts that occur if contacts in space are known only to some uncertainty.

The true contacts are somewhere in the box of a `ContactUncertainty`. A verdict is certain if it is proven for
every contact set in the box:

- UNIQUE is certain if linear programs that allow for the whole box exclude every other mode (`excluded`). A
  body at rest always has a consistent mode, so this one is left.
- INDETERMINATE is certain if two modes hold everywhere (`holds_for_all`).

There are proofs only for bodies at rest with at most `MAX_PROVEN_CONTACTS`. Each contact's errors are
independent of the others', and the body's mass and the applied wrench are known. Four feet that slide
together have no proof, since they do so only if they lie exactly in a plane.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.result import BodyStatics, ModeVerdict
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.excluded import bounded_body, no_other_mode
from contact_dynamics.contact_modes.spatial.problem import SpatialCase, spatial_case
from contact_dynamics.contact_modes.spatial.statics import spatial_statics
from contact_dynamics.contact_modes.uncertain import Boxes, holds_for_all
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.vectors import tangents_towards

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact_modes.result import SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.validation import FloatArray


SAMPLES: Final = 64
"""Contact sets that are tried if there is no proof. Half of them are at the border of the box, and in half of
these all contacts are off the same way."""

MAX_PROVEN_CONTACTS: Final = 4
"""The largest number of contacts that proofs are tried for. The programs grow exponentially with them."""


_STEP: Final = 2.0
"""Each size is at most this factor from the next. A finer step takes more proofs, of up to seconds each."""

_SAMPLES: Final = 16
"""Contact sets that are tried for each size. Each takes some 10 ms."""

_STEPS: Final = 26
"""Sizes below the largest, which so reach down to 1.5e-8 of it."""


def spatial_boxes(problem: SpatialContactProblem, answer: SpatialModeAnswer) -> Boxes[SpatialModeAnswer]:
    """Return what is known of the answers in boxes around the contacts of a problem."""
    return Boxes(
        answer,
        is_certain=partial(is_certain, problem, answer),
        sampled=partial(sampled, problem),
        radius_of_gyration=problem.body.mean_radius_of_gyration,
        frictions=problem.contacts.frictions.tolist(),
        step=_STEP,
        steps=_STEPS,
        samples=_SAMPLES,
    )


def is_certain(problem: SpatialContactProblem, answer: SpatialModeAnswer, box: ContactUncertainty) -> bool:
    """Return whether it is proven that the verdict of ``answer`` holds everywhere in a box."""
    n = len(problem.contacts)
    if n == 0:
        return True
    case = spatial_case(problem)
    if not isinstance(case, SpatialCase) or n > MAX_PROVEN_CONTACTS:
        return False
    if not case.motion.at_rest or len(case.touching) < n or case.sliding.any():
        return False
    modes = dict.fromkeys(mode.mode for mode in answer.modes)
    if answer.verdict == ModeVerdict.INDETERMINATE:
        holding = (mode for mode in modes if holds_everywhere(problem, mode, box))
        return next(holding, None) is not None and next(holding, None) is not None
    return answer.verdict == ModeVerdict.UNIQUE and no_other_mode(problem, answer.modes[0].mode, box)


def sampled(problem: SpatialContactProblem, box: ContactUncertainty) -> Iterator[SpatialModeAnswer]:
    """Yield the answers for some contact sets in a box. The same box always gives the same sets."""
    chance = np.random.default_rng(0)
    for index in range(SAMPLES):
        moved = _moved(problem, box, chance, corner=index % 2 == 0, together=index % 4 == 0)
        with suppress(TooLargeError):
            yield spatial_contact_modes(moved)


def _moved(
    problem: SpatialContactProblem,
    box: ContactUncertainty,
    chance: np.random.Generator,
    *,
    corner: bool,
    together: bool,
) -> SpatialContactProblem:
    """Return a problem in the box, at its border or inside, with all contacts off the same way or not."""
    contacts = problem.contacts
    points, normals = contacts.p_WC_W.copy(), contacts.normals_W.copy()
    frictions = contacts.frictions.copy()
    way, lean, sign = chance.normal(size=3), chance.normal(size=3), chance.choice([-1.0, 1.0])
    for i, sizes in enumerate(box.of_each(len(contacts))):
        step, turn, less = sizes * (np.ones(3) if corner else chance.uniform(0.0, 1.0, 3))
        if not together:
            way, lean, sign = chance.normal(size=3), chance.normal(size=3), chance.choice([-1.0, 1.0])
        points[i] += step * way / np.linalg.norm(way)
        tangent, _ = tangents_towards(normals[i], lean)
        normals[i] = math.cos(turn) * normals[i] + math.sin(turn) * tangent
        frictions[i] = max(0.0, frictions[i] + sign * less)
    moved = replace(contacts, p_WC_W=points, normals_W=normals, frictions=frictions)
    return replace(problem, contacts=moved, uncertainty=EXACT_CONTACTS)


def holds_everywhere(problem: SpatialContactProblem, mode: str, box: ContactUncertainty) -> bool:
    """Return whether it is proven that a consistent mode is consistent everywhere in a box.

    The body is at rest, and all contacts touch it. Nothing is proven of contacts that slide.
    """
    body = bounded_body(problem, box)
    least = np.array([one.min_friction for one in body.contacts])

    def statics() -> BodyStatics:
        return spatial_statics(replace(problem, contacts=replace(problem.contacts, frictions=least)))

    def edges() -> tuple[FloatArray, FloatArray]:
        wrenches, costs = [], []
        for one in body.contacts:
            forces = linearised_cone(np.array([1.0, 0.0, 0.0]), one.min_friction, problem.friction_facets)
            wrenches.append(forces @ one.rows)
            costs.append(math.hypot(one.errors[0, 0], one.errors[0, -1]) * np.linalg.norm(forces, axis=1))
        return np.vstack(wrenches), np.concatenate(costs)

    return holds_for_all(body, mode, statics=statics, edges=edges)
