"""How far an applied wrench in space is from leaving its contact modes, and into which ones it would.

The applied wrenches of a mode (`wrenches`) are a polyhedron in R^6, and its facets are the extreme rays of
the dual cone. The margin is the distance to the nearest facet in a stated metric, as in the plane.

Where contacts stick, pyramids inside the round cones replace these. So the margin is never larger than the
true one, and falls short of it by what at most the part 1 - cos(pi / facets) of friction contributes. Where
all contacts that stay slide already, the margin is exact. Where contacts at rest begin to slide, their
directions depend on the wrench, and the wrenches of the mode are a union of polyhedra (`margins_of_sliding`).
There the margin is right to that part of friction, and NaN where it is not known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes.result import ModeVerdict, verdict_on
from contact_dynamics.contact_modes.spatial.answer import Considered, considered, found_by
from contact_dynamics.contact_modes.spatial.exact_modes import letters_of
from contact_dynamics.contact_modes.spatial.margins_of_sliding import begin_to_slide, union_margin
from contact_dynamics.contact_modes.spatial.problem import (
    SpatialCase,
    search_of,
    search_of_few_edges,
    spatial_case,
)
from contact_dynamics.contact_modes.spatial.wrenches import Way, supports, wrench_generators
from contact_dynamics.records import Record
from contact_dynamics.tolerances import BEYOND_MARGIN, ON_BOUNDARY, ROW_TOLERANCE
from contact_dynamics.validation import check_size

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.result import SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialModeMargin(Record):
    """How far an applied wrench in space is from leaving one of its modes, and where it would go.

    Attributes:
        mode: One letter for each contact.
        margin: N, the size of the least change that leaves the mode, in |f|^2 + |torque / length|^2. It is
            infinite where no change does that, and NaN where it is unknown.
        length: m, the length in that metric.
        change_W: (6,), N and N m, the least change itself, world axes; zero where there is none.
        verdict_beyond: The verdict just behind the boundary, or the present one where there is no boundary.
            It is that of friction pyramids, and may depend on the number of facets.
        modes_beyond: The letters of the consistent modes there, each once.
    """

    mode: str
    margin: float
    length: float
    change_W: FloatArray
    verdict_beyond: ModeVerdict
    modes_beyond: tuple[str, ...]


def spatial_mode_margins(
    problem: SpatialContactProblem,
    answer: SpatialModeAnswer | None = None,
    *,
    margin_length: float | None = None,
) -> tuple[SpatialModeMargin, ...]:
    """Return the margin of the wrench in each of its consistent modes, in the order of their answer.

    There are none where a contact approaches.

    Args:
        problem: The question. With more facets, a margin of sticking is closer to that of the round cones.
        answer: The answer to that question, if it is known.
        margin_length: m, > 0. A torque is divided by it to be comparable with a force. If it is None, the
            length is the radius of gyration, the root mean square over the axes.

    Raises:
        InvalidFieldError: the length is not > 0.
        TooLargeError: as for `spatial_contact_modes`, or more than `MAX_EDGES` edges of all pyramids.
    """
    body, wrench, friction_facets = problem.body, problem.wrench_W, problem.friction_facets
    own = body.mean_radius_of_gyration
    length = own if margin_length is None else check_size("margin_length", margin_length)
    one = considered(problem)
    if not isinstance(one, Considered):
        return ()
    case, within = one.case, one.within
    search = search_of_few_edges(case, friction_facets)
    metric = np.array([1.0, 1.0, 1.0, length, length, length])
    present = None if answer is None or not problem.sharpen else tuple(one.mode for one in answer.modes)
    margins = []
    for mode in one.found.modes:
        letters, beyond = letters_of(mode, case, search), None
        if begin_to_slide(search, letters):
            margin, way, beyond = union_margin(case, search, letters, metric, friction_facets)
        else:
            margin, way = _nearest(case, search, letters, metric)
        if beyond is None and math.isfinite(margin):
            beyond = _beyond(problem, mode.mode, margin, way, metric, within=within)
        if beyond is None:
            beyond = _modes_under(problem, within, wrench) if present is None else present
        margins.append(
            SpatialModeMargin(
                mode=mode.mode,
                margin=margin,
                length=length,
                change_W=margin * way * metric if math.isfinite(margin) else np.zeros(6),
                verdict_beyond=verdict_on(beyond),
                modes_beyond=tuple(dict.fromkeys(beyond)),
            )
        )
    return tuple(margins)


def _beyond(
    problem: SpatialContactProblem,
    mode: str,
    margin: float,
    way: FloatArray,
    metric: FloatArray,
    *,
    within: float,
) -> tuple[str, ...]:
    """Return the modes just behind the boundary that lies ``margin``, N, away, ``way`` in the metric."""
    size = float(np.linalg.norm(problem.wrench_W / metric))
    # A pyramid that turns as the wrench changes may hold a little longer, up to what the round cone holds.
    rest = (1.0 / math.cos(math.pi / problem.friction_facets) - 1.0) * size
    found: tuple[str, ...] = ()
    for further in (0.0, rest):
        step = margin + further + BEYOND_MARGIN * max(margin, size)
        found = _modes_under(problem, within, problem.wrench_W + step * way * metric)
        if mode not in found:
            break
    return found


def _modes_under(problem: SpatialContactProblem, within: float, wrench_W: FloatArray) -> tuple[str, ...]:
    """Return the modes that another wrench brings about with friction pyramids, which the margin uses too."""
    other = replace(problem, force_W=wrench_W[:3], torque_W=wrench_W[3:])
    case = spatial_case(other, within=within)
    if not isinstance(case, SpatialCase):
        return ()
    found = found_by(case, search_of(case, problem.friction_facets), sharpen=True)
    return tuple(mode.mode for mode in found)


def _nearest(case: SpatialCase, search: Search, letters: str, metric: FloatArray) -> tuple[float, FloatArray]:
    """Return the distance, N, to the mode's nearest boundary and the direction to it, (6,), in the metric.

    The distance is NaN if the pyramids do not hold the mode.
    """
    motion = case.motion
    unit = motion.mass * motion.scale  # N; wrenches are divided by it, and torques by the length
    ways = [Way(letter, -1) for letter in letters]
    positive, zero = supports(wrench_generators(case, search, ways, metric))
    target = np.append(motion.wrench / metric / unit, 1.0)
    zero, positive = (rows[np.linalg.norm(rows[:, :6], axis=1) > ROW_TOLERANCE] for rows in (zero, positive))
    if len(zero):
        return 0.0, zero[0, :6] / float(np.linalg.norm(zero[0, :6]))
    if len(positive) == 0:
        return math.inf, np.zeros(6)
    sizes = np.linalg.norm(positive[:, :6], axis=1)
    depths = positive @ target / sizes
    nearest = int(depths.argmin())
    if depths[nearest] < -ON_BOUNDARY:
        return math.nan, np.zeros(6)
    return max(0.0, float(depths[nearest])) * unit, -positive[nearest, :6] / sizes[nearest]
