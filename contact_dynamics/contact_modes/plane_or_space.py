# SPDX-License-Identifier: Apache-2.0
"""These functions ask about contact modes. Each takes a problem in the plane or in space.

You state a problem once, as a `PlanarContactProblem` or a `SpatialContactProblem`, and ask it every question.
The files of `planar` and `spatial` answer them, under the same names.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, overload

from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
from contact_dynamics.contact_modes.planar.statics import planar_statics
from contact_dynamics.contact_modes.planar.uncertain import planar_boxes
from contact_dynamics.contact_modes.planar.wrench_sets import planar_mode_margins, planar_wrench_sets
from contact_dynamics.contact_modes.result import PlanarModeAnswer, SpatialModeAnswer
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.margins import spatial_mode_margins, spatial_refused_modes
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.contact_modes.spatial.statics import spatial_statics
from contact_dynamics.contact_modes.spatial.uncertain import spatial_boxes
from contact_dynamics.contact_modes.spatial.wrench_sets import spatial_wrench_sets
from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Collection

    from contact_dynamics.contact_modes.planar.wrench_sets import PlanarModeMargin, PlanarWrenchSet
    from contact_dynamics.contact_modes.result import BodyStatics, GeometryMargin, RefusedMode
    from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
    from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet


@overload
def contact_modes(problem: PlanarContactProblem) -> PlanarModeAnswer: ...
@overload
def contact_modes(problem: SpatialContactProblem) -> SpatialModeAnswer: ...
def contact_modes(
    problem: PlanarContactProblem | SpatialContactProblem,
) -> PlanarModeAnswer | SpatialModeAnswer:
    """Return the verdict on a contact set and all consistent modes, with accelerations and forces.

    Args:
        problem: The question, such as SpatialContactProblem.of(body, state, world, force_W=push).

    Raises:
        TooLargeError: the problem is in space, and more contacts touch than are answered, or the search takes
            too many trials.

    Source: lecture 26.
    """
    if isinstance(problem, PlanarContactProblem):
        answer = planar_contact_modes(problem)
        if problem.uncertainty.is_exact:
            return answer
        return replace(answer, within=planar_boxes(problem, answer).verdicts_within(problem.uncertainty))
    in_space = spatial_contact_modes(problem)
    if problem.uncertainty.is_exact:
        return in_space
    return replace(in_space, within=spatial_boxes(problem, in_space).verdicts_within(problem.uncertainty))


@overload
def mode_margins(
    problem: PlanarContactProblem,
    answer: PlanarModeAnswer | None = None,
    *,
    margin_length: float | None = None,
) -> tuple[PlanarModeMargin, ...]: ...
@overload
def mode_margins(
    problem: SpatialContactProblem,
    answer: SpatialModeAnswer | None = None,
    *,
    margin_length: float | None = None,
) -> tuple[SpatialModeMargin, ...]: ...
def mode_margins(
    problem: PlanarContactProblem | SpatialContactProblem,
    answer: PlanarModeAnswer | SpatialModeAnswer | None = None,
    *,
    margin_length: float | None = None,
) -> tuple[PlanarModeMargin, ...] | tuple[SpatialModeMargin, ...]:
    """Return how far the applied wrench is from leaving each of its consistent modes, in their order.

    The margin is the size of the least change of the wrench that leaves the mode, N, where the size is the
    root of |f|^2 + |torque / length|^2. No margin is returned if a contact approaches. In space, margins are
    those of round cones, and NaN for some modes in which contacts begin to slide (`spatial_mode_margins`).

    Args:
        problem: The question.
        answer: The answer to that question, if it is known. It saves a search.
        margin_length: m, > 0. It makes a torque comparable with a force. If it is None, it is the radius of
            gyration, and in space the root mean square of the radii about the axes.

    Raises:
        InvalidFieldError: ``answer`` is of another kind of problem, or the length is not > 0.
        UndecidedError: contacts in space are so nearly the same that rounding decides the boundaries.
        TooLargeError: as for `contact_modes`.
    """
    if isinstance(problem, PlanarContactProblem) and not isinstance(answer, SpatialModeAnswer):
        return planar_mode_margins(problem, answer, margin_length=margin_length)
    if isinstance(problem, SpatialContactProblem) and not isinstance(answer, PlanarModeAnswer):
        return spatial_mode_margins(problem, answer, margin_length=margin_length)
    raise _other_answer(problem, answer)


@overload
def refused_modes(problem: PlanarContactProblem, answer: PlanarModeAnswer) -> tuple[RefusedMode, ...]: ...
@overload
def refused_modes(
    problem: SpatialContactProblem, answer: SpatialModeAnswer, *, margin_length: float | None = None
) -> tuple[RefusedMode, ...]: ...
def refused_modes(
    problem: PlanarContactProblem | SpatialContactProblem,
    answer: PlanarModeAnswer | SpatialModeAnswer,
    *,
    margin_length: float | None = None,
) -> tuple[RefusedMode, ...]:
    """Return the modes that kinematics allows and mechanics refuses, each with the first reason found.

    In the plane the answer has them already. In space there are too many letters with a way of sliding to
    list. The modes are then strings of contacting (`c`) and separating (`s`), and each takes a millisecond.

    Args:
        problem: The question.
        answer: The answer to that question.
        margin_length: m, > 0. It makes a torque comparable with a force where the reason is a distance. If it
            is None, it is the root mean square of the radii of gyration about the axes. Only in space.

    Raises:
        InvalidFieldError: ``answer`` is of another kind of problem, the length is not > 0, or a length is
            given in the plane.
        TooLargeError: as for `contact_modes`.
    """
    if isinstance(problem, PlanarContactProblem) and isinstance(answer, PlanarModeAnswer):
        if margin_length is not None:
            raise InvalidFieldError("margin_length", margin_length, "None in the plane")
        return answer.refused
    if isinstance(problem, SpatialContactProblem) and isinstance(answer, SpatialModeAnswer):
        return spatial_refused_modes(problem, answer, margin_length=margin_length)
    raise _other_answer(problem, answer)


@overload
def wrench_sets(
    problem: PlanarContactProblem, *, modes: Collection[str] | None = None
) -> tuple[PlanarWrenchSet, ...]: ...
@overload
def wrench_sets(
    problem: SpatialContactProblem, *, modes: Collection[str] | None = None
) -> tuple[SpatialWrenchSet, ...]: ...
def wrench_sets(
    problem: PlanarContactProblem | SpatialContactProblem, *, modes: Collection[str] | None = None
) -> tuple[PlanarWrenchSet, ...] | tuple[SpatialWrenchSet, ...]:
    """Return the applied wrenches that can bring each mode about, in alphabetical order of the modes.

    Together the sets are the map of modes. In the plane the problem's own wrench plays no part. In space it
    says how the friction pyramids lie. There a mode has a set for each way of sliding, and their number grows
    with the square or cube of `friction_facets`. A box on four feet has 200 to 350 sets with 4 facets and
    some 1300 with 8, and each takes a millisecond or two. You save time if you ask for few modes, or with
    `dataclasses.replace(problem, friction_facets=4)`.

    Args:
        problem: The question.
        modes: The modes that are wanted, with one letter for each contact. If it is None, all are returned.

    Raises:
        InvalidFieldError: a mode is not a string of its letters.
        UndecidedError: contacts in space are so nearly the same that rounding decides the sets.
        TooLargeError: A problem in space has too many contacts, edges of friction pyramids, ways of sliding
            or sets.

    Source: lecture 26, "Force dual for dynamic contact problem" and "Contact modes for wrench in tray".
    """
    if isinstance(problem, PlanarContactProblem):
        return planar_wrench_sets(problem, modes=modes)
    return spatial_wrench_sets(problem, modes=modes)


@overload
def geometry_margins(
    problem: PlanarContactProblem, answer: PlanarModeAnswer | None = None
) -> tuple[GeometryMargin, ...]: ...
@overload
def geometry_margins(
    problem: SpatialContactProblem, answer: SpatialModeAnswer | None = None
) -> tuple[GeometryMargin, ...]: ...
def geometry_margins(
    problem: PlanarContactProblem | SpatialContactProblem,
    answer: PlanarModeAnswer | SpatialModeAnswer | None = None,
) -> tuple[GeometryMargin, ...]:
    """Return how far points, normals and frictions would have to be off for another verdict or UNIQUE mode.

    Each margin is given from both sides: within one size the answer is proven, and at another size contacts
    were found that have another answer. There are proofs for bodies at rest, in space on at most four
    contacts. All margins take about a second for two contacts in the plane or three in space, and several
    for four. There are no margins if a contact approaches.

    Args:
        problem: The question. Its own uncertainty plays no part.
        answer: The answer to that question, if it is known. It saves a search.

    Raises:
        InvalidFieldError: ``answer`` is of another kind of problem.
        TooLargeError: as for `contact_modes`.
    """
    if isinstance(problem, PlanarContactProblem) and not isinstance(answer, SpatialModeAnswer):
        found = planar_contact_modes(problem) if answer is None else answer
        return planar_boxes(problem, found).margins()
    if isinstance(problem, SpatialContactProblem) and not isinstance(answer, PlanarModeAnswer):
        in_space = spatial_contact_modes(problem) if answer is None else answer
        return spatial_boxes(problem, in_space).margins()
    raise _other_answer(problem, answer)


def statics(
    problem: PlanarContactProblem | SpatialContactProblem, *, margin_length: float | None = None
) -> BodyStatics:
    """Return whether the body stays if it is at rest, and how well.

    Args:
        problem: The question. Its velocities play no part.
        margin_length: As for `mode_margins`.

    Raises:
        InvalidFieldError: the length is not > 0.
        UndecidedError: contacts are so nearly the same that rounding decides the answer.
        TooLargeError: as for `contact_modes`, or the friction pyramids in space have more than 128 edges.
    """
    if isinstance(problem, PlanarContactProblem):
        return planar_statics(problem, margin_length=margin_length)
    return spatial_statics(problem, margin_length=margin_length)


def _other_answer(problem: object, answer: object) -> InvalidFieldError:
    return InvalidFieldError("answer", type(answer).__name__, f"the answer to the {type(problem).__name__}")
