# SPDX-License-Identifier: Apache-2.0
"""Margins say how far an applied wrench is from leaving its contact modes (Mason, lecture 26)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.letters import SEPARATES
from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import judge_all
from contact_dynamics.contact_modes.planar.problem import accuracy_of, check_length, touching_case
from contact_dynamics.contact_modes.planar.wrench_sets import (
    PlanarWrenchSet,
    WrenchHalfSpace,
    wrench_set_of,
)
from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.plane.types import PlanarWrench
from contact_dynamics.records import Record
from contact_dynamics.tolerances import BEYOND_MARGIN

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
    from contact_dynamics.contact_modes.planar.result import PlanarModeAnswer
    from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet, WrenchHalfSpace

_NO_WRENCH: Final = PlanarWrench(f=(0.0, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarModeMargin(Record):
    """How far an applied wrench is from leaving one of its consistent modes, and where it would go.

    Attributes:
        mode: The mode, with one letter for each contact.
        margin: N, the size of the least change that leaves the mode, in the metric |f|^2 + (moment /
            length)^2. It is infinite if no change does.
        length: m, the length in that metric.
        change: The least change itself, or zero if no change leaves the mode.
        verdict_beyond: The verdict where the wrench has changed by `BEYOND_MARGIN` more than that, or the
            present one if there is no boundary. It holds further on only up to the next boundary.
        modes_beyond: The consistent modes there.
    """

    mode: str
    margin: float
    length: float
    change: PlanarWrench
    verdict_beyond: ModeVerdict
    modes_beyond: tuple[str, ...]


def planar_mode_margins(
    problem: PlanarContactProblem,
    answer: PlanarModeAnswer | None = None,
    *,
    margin_length: float | None = None,
) -> tuple[PlanarModeMargin, ...]:
    """Return the margin of the wrench in each of its consistent modes, in the order of their answer.

    If all contacts separate already, no wrench changes the mode, and its margin is infinite. No margin is
    returned if a contact approaches.

    Args:
        problem: The question.
        answer: The answer to that question, if it is known. It saves a search.
        margin_length: m, > 0. It makes a moment comparable with a force. If it is None, it is the radius of
            gyration.

    Raises:
        InvalidFieldError: the length is not > 0.
    """
    body, wrench, accuracy = problem.body, problem.wrench, accuracy_of(problem)
    length = check_length(margin_length, body)
    case = touching_case(problem)
    if case is None:
        return _of_free_motion(problem, length)
    cells = kinematic_cells(case)
    if answer is None:
        answer = planar_contact_modes(problem)
    consistent = answer.modes
    present = tuple(mode.mode for mode in consistent)
    found = []
    for mode in present:
        margin, side = _nearest(wrench_set_of(case, mode, cells[mode]), wrench, length)
        if side is None:
            found.append(
                PlanarModeMargin(
                    mode=mode,
                    margin=math.inf,
                    length=length,
                    change=_NO_WRENCH,
                    verdict_beyond=answer.verdict,
                    modes_beyond=present,
                )
            )
            continue
        way = side.outward(length)
        step = margin + BEYOND_MARGIN * max(margin, math.hypot(*wrench.f, wrench.moment / length))
        beyond = _stepped(wrench, step, way)
        there = judge_all(case._replace(w=(*beyond.f, beyond.moment / case.rho)), cells, accuracy)
        found.append(
            PlanarModeMargin(
                mode=mode,
                margin=margin,
                length=length,
                change=_stepped(_NO_WRENCH, margin, way),
                verdict_beyond=there.verdict,
                modes_beyond=tuple(one.mode for one in there.consistent),
            )
        )
    return tuple(found)


def _of_free_motion(problem: PlanarContactProblem, length: float) -> tuple[PlanarModeMargin, ...]:
    """Return the infinite margin of a body without a touching contact, or () if a contact approaches."""
    if any(v_n < 0.0 for _, v_n in problem.contact_velocities()):
        return ()
    mode = SEPARATES * len(problem.contacts)
    return (
        PlanarModeMargin(
            mode=mode,
            margin=math.inf,
            length=length,
            change=_NO_WRENCH,
            verdict_beyond=ModeVerdict.UNIQUE,
            modes_beyond=(mode,),
        ),
    )


def _nearest(
    wrenches: PlanarWrenchSet, wrench: PlanarWrench, length: float
) -> tuple[float, WrenchHalfSpace | None]:
    """Return the distance from a wrench in a set to the nearest boundary of the set, and that boundary.

    A consistent wrench that rounding has put outside has the distance zero. If the set has no boundary, the
    distance is infinite and the boundary is None.
    """
    if not wrenches.half_spaces:
        return math.inf, None
    side = min(wrenches.half_spaces, key=lambda half_space: half_space.depth(wrench, length))
    return max(0.0, side.depth(wrench, length)), side


def _stepped(wrench: PlanarWrench, step: float, way: PlanarWrench) -> PlanarWrench:
    return PlanarWrench(
        f=(wrench.f[0] + step * way.f[0], wrench.f[1] + step * way.f[1]),
        moment=wrench.moment + step * way.moment,
    )
