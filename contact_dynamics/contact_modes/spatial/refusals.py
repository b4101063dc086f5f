# SPDX-License-Identifier: Apache-2.0
"""Why mechanics refuses contacting and separating strings of a body in space that kinematics allows.

A string of letters s (separates) and c (stays, sticking or sliding) is refused if no mode of it is
consistent. Where nothing that stays has friction to choose, the forces that it needs are known, and so is
what contradicts it: a contact pulls, or one that should separate penetrates. Otherwise the reason is how far
the applied wrench is from those under which some forces inside the friction cones let the contacts stay and
separate like that: the least change in |f|^2 + |torque / length|^2. Which way friction acts is left open,
so that no smaller change brings the string about, and a larger one may be needed.

Where a string is consistent, this file does not say why it sticks rather than slides, or slides one way
rather than another. Where loads are shared, the reason would differ from one sharing to the next.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_modes.letters import STAYS, STICKS
from contact_dynamics.contact_modes.result import Refusal, RefusedMode
from contact_dynamics.contact_modes.spatial.kinematic import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.problem import (
    FRICTION_FACETS,
    SpatialCase,
    search_of,
    spatial_case,
)
from contact_dynamics.contact_modes.spatial.wrenches import (
    HEIGHT_WEIGHT,
    Way,
    with_round_cones,
    wrench_generators,
)
from contact_dynamics.tolerances import NO_DISTANCE, ROW_TOLERANCE
from contact_dynamics.validation import check_size

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.result import SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray


def spatial_refused_modes(
    problem: SpatialContactProblem, answer: SpatialModeAnswer, *, margin_length: float | None = None
) -> tuple[RefusedMode, ...]:
    """Return each contacting and separating string without a consistent mode, in alphabetical order, and why.

    Where the forces are known, the refusal is `PENETRATES` or `PULLS` of a contact. Otherwise it is
    `NO_SOLUTION`, with the distance, N, of the applied wrench from those that can bring the string about. It
    is `WRONG_MOTION` with amount 0 where forces in the friction cones could do so, but would not oppose the
    sliding that they cause.

    There are none where a contact approaches. Each string takes a millisecond.

    Args:
        problem: The question.
        answer: The answer to that question.
        margin_length: m, > 0. A torque is divided by it to be comparable with a force. If it is None, the
            length is the radius of gyration, the root mean square over the axes.

    Raises:
        InvalidFieldError: the length is not > 0.
        TooLargeError: more contacts than `spatial_contact_modes` accepts.
    """
    body, tolerance = problem.body, problem.velocity_tolerance
    own = body.mean_radius_of_gyration
    length = own if margin_length is None else check_size("margin_length", margin_length)
    case = spatial_case(problem)
    if not isinstance(case, SpatialCase):
        return ()
    search = search_of(case, FRICTION_FACETS)
    possible = [*(mode.mode for mode in answer.modes), *answer.undecided_modes]
    consistent = {letters.replace(STICKS, STAYS) for letters in possible}
    metric = np.array([1.0, 1.0, 1.0, length, length, length])
    return tuple(
        _known(case, search, string) or _short(case, search, string, metric)
        for string in spatial_kinematic_modes(problem.state, problem.contacts, velocity_tolerance=tolerance)
        if string not in consistent
    )


def _known(case: SpatialCase, search: Search, string: str) -> RefusedMode | None:
    """Return the refusal where the forces are known, or None where they are not."""
    motion, touching = case.motion, case.touching.tolist()
    staying = [k for k, i in enumerate(touching) if string[i] == STAYS]
    if any(len(search.pyramids[k].edges) > 1 for k in staying):
        return None
    normals = np.array([one.normal @ one.point for one in search.touching]).reshape(-1, 7)
    edges = np.zeros((3 * len(touching), len(staying)))
    for column, k in enumerate(staying):
        edges[3 * k : 3 * k + 3, column] = search.pyramids[k].edges[0]
    # Normal accelerations of those that stay, for unit normal forces, and without any.
    caused = normals[:, :6] @ search.of_forces @ edges
    without = normals[:, :6] @ search.motion[:, -1] + normals[:, 6]
    forces = np.zeros(0)
    if staying:
        sizes = np.linalg.svd(caused[staying], compute_uv=False)
        if sizes[-1] <= ROW_TOLERANCE * sizes[0]:
            return None
        forces = np.linalg.solve(caused[staying], -without[staying])
        if forces.min() < 0.0:
            amount = float(forces.min()) * motion.scale
            at = touching[staying[int(forces.argmin())]]
            return RefusedMode(mode=string, refusal=Refusal.PULLS, contact=at, amount=amount)
    normal = without + caused @ forces
    separating = [k for k in range(len(touching)) if k not in staying]
    lowest = min(separating, key=lambda k: float(normal[k]), default=None)
    if lowest is None:
        return None
    amount = min(0.0, float(normal[lowest]) * motion.scale)
    return RefusedMode(mode=string, refusal=Refusal.PENETRATES, contact=touching[lowest], amount=amount)


def _short(case: SpatialCase, search: Search, string: str, metric: FloatArray) -> RefusedMode:
    """Return the refusal with the distance of the wrench from those that can bring the string about."""
    ways = [Way(string[i], -1) for i in case.touching.tolist()]
    generators = wrench_generators(case, search, ways, metric)
    unit = case.motion.mass * case.motion.scale  # N; wrenches are divided by it
    target = np.append(case.motion.wrench / metric / unit, 1.0)
    round_ones = [
        k
        for k, (way, one) in enumerate(zip(ways, search.pyramids, strict=True))
        if way.letter == STAYS and one.frame is not None
    ]
    every = with_round_cones(case, search, generators, round_ones, metric)
    target[6] = HEIGHT_WEIGHT if every.rays[:, 6].any() else 0.0
    left = float(np.linalg.norm(every.rest(target)))
    if left <= NO_DISTANCE * float(np.linalg.norm(target[:6])):
        return RefusedMode(mode=string, refusal=Refusal.WRONG_MOTION, contact=-1, amount=0.0)
    return RefusedMode(mode=string, refusal=Refusal.NO_SOLUTION, contact=-1, amount=left * unit)
