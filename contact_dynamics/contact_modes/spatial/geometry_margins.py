"""This file says how far contacts in space would have to move, turn or change friction for another answer."""

from __future__ import annotations

from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.geometry_search import geometry_margins_within
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.uncertain import is_certain, sampled

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.result import GeometryMargin
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.result import SpatialModeAnswer

_STEP: Final = 2.0
"""Each size is at most this factor from the next. A finer step takes more proofs, of up to seconds each."""

_SAMPLES: Final = 16
"""Contact sets that are tried for each size. Each takes some 10 ms."""

_STEPS: Final = 26
"""Sizes below the largest, which so reach down to 1.5e-8 of it."""


def spatial_geometry_margins(
    problem: SpatialContactProblem, answer: SpatialModeAnswer | None = None
) -> tuple[GeometryMargin, ...]:
    """Return the margins of the answer in points, normals and frictions, in this order.

    In each of them only that one is off, for all contacts at once and for each in its own way. There are no
    margins if a contact approaches.

    Args:
        problem: The question. Its own uncertainty plays no part.
        answer: The answer to that question, if it is known.

    Raises:
        TooLargeError: as for `spatial_contact_modes`.
    """
    if answer is None:
        answer = spatial_contact_modes(problem)
    return geometry_margins_within(
        answer,
        radius_of_gyration=problem.body.mean_radius_of_gyration,
        frictions=problem.contacts.frictions.tolist(),
        step=_STEP,
        steps=_STEPS,
        is_certain=partial(is_certain, problem, answer),
        sampled=lambda box: islice(sampled(problem, box), _SAMPLES),
    )
