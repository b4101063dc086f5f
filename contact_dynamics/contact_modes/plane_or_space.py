"""The questions about contact modes. Each takes a problem in the plane or in space.

You state a problem once, as a `PlanarContactProblem` or a `SpatialContactProblem`, and ask it every question.
The files of `planar` and `spatial` answer them, under the same names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.margins import planar_mode_margins
from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
from contact_dynamics.contact_modes.planar.result import PlanarModeAnswer
from contact_dynamics.contact_modes.planar.statics import planar_statics
from contact_dynamics.contact_modes.planar.wrench_sets import planar_wrench_sets
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.margins import spatial_mode_margins
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.contact_modes.spatial.refusals import spatial_refused_modes
from contact_dynamics.contact_modes.spatial.result import SpatialModeAnswer
from contact_dynamics.contact_modes.spatial.statics import spatial_statics
from contact_dynamics.contact_modes.spatial.wrench_sets import spatial_wrench_sets
from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Collection

    from contact_dynamics.contact_modes.planar.margins import PlanarModeMargin
    from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet
    from contact_dynamics.contact_modes.result import BodyStatics, RefusedMode
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

    Raises:
        InvalidFieldError: not a problem.
        TooLargeError: in space, more contacts touch than are answered, or the search takes too many trials.

    Source: lecture 26.
    """
    if isinstance(problem, PlanarContactProblem):
        return planar_contact_modes(problem)
    if isinstance(problem, SpatialContactProblem):
        return spatial_contact_modes(problem)
    raise _not_a_problem(problem)


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

    The margin is the length of the least change of the wrench, in |f|^2 + |torque / length|^2, N. Empty where
    a contact approaches. In space, margins of sticking are short by the part 1 - cos(pi / friction_facets) of
    friction: 8 % with the 8 facets that a problem has by itself, 2 % with 16.

    Args:
        problem: The question.
        answer: To that question, where it is known, to save a search.
        margin_length: m, > 0, makes a torque comparable with a force; None: the radius of gyration, in space
            its root mean square over the axes.

    Raises:
        InvalidFieldError: not a problem, or the length is not > 0.
        TooLargeError: as for `contact_modes`; or, in space, more than 128 edges of all friction pyramids.
    """
    if isinstance(problem, PlanarContactProblem) and not isinstance(answer, SpatialModeAnswer):
        return planar_mode_margins(problem, answer, margin_length=margin_length)
    if isinstance(problem, SpatialContactProblem) and not isinstance(answer, PlanarModeAnswer):
        return spatial_mode_margins(problem, answer, margin_length=margin_length)
    raise _not_a_problem(problem, answer)


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

    In the plane the answer has them. In space, where letters with a way of sliding are too many to list, they
    are the strings of contacting (`c`) and separating (`s`), and take a millisecond each.

    Args:
        problem: The question.
        answer: To that question.
        margin_length: m, > 0, makes a torque comparable with a force where a reason is a distance; None: the
            radius of gyration, root mean square over the axes. Only in space.

    Raises:
        InvalidFieldError: not a problem with its answer, the length is not > 0, or there is one in the plane.
        TooLargeError: as for `contact_modes`.
    """
    if isinstance(problem, PlanarContactProblem) and isinstance(answer, PlanarModeAnswer):
        if margin_length is not None:
            raise InvalidFieldError("margin_length", margin_length, "None in the plane")
        return answer.refused
    if isinstance(problem, SpatialContactProblem) and isinstance(answer, SpatialModeAnswer):
        return spatial_refused_modes(problem, answer, margin_length=margin_length)
    raise _not_a_problem(problem, answer)


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
    """Return the applied wrenches that can bring each mode about: the map of modes, in alphabetical order.

    The problem's own wrench plays no part in the plane; in space it says how the friction pyramids lie. In
    space a mode has a set for each way of sliding, and their number grows as the square or cube of
    `friction_facets`: a box on four feet has 200 to 350 with 4 facets and some 1300 with 8, a millisecond or
    two each. Ask for few modes, or of `dataclasses.replace(problem, friction_facets=4)`.

    Args:
        problem: The question.
        modes: Letters, one a contact, of the modes that are wanted; None: all.

    Raises:
        InvalidFieldError: not a problem, or modes that are not strings of its letters.
        UndecidedError: in space, contacts so nearly the same that rounding decides the sets.
        TooLargeError: in space, too many contacts, edges of friction pyramids, ways of sliding or sets.

    Source: lecture 26, "Force dual for dynamic contact problem" and "Contact modes for wrench in tray".
    """
    if isinstance(problem, PlanarContactProblem):
        return planar_wrench_sets(problem, modes=modes)
    if isinstance(problem, SpatialContactProblem):
        return spatial_wrench_sets(problem, modes=modes)
    raise _not_a_problem(problem)


def statics(
    problem: PlanarContactProblem | SpatialContactProblem, *, margin_length: float | None = None
) -> BodyStatics:
    """Return whether and how well the body stays, taken at rest: equilibrium, jamming, wedging, disturbances.

    Args:
        problem: The question; its velocities play no part.
        margin_length: As for `mode_margins`.

    Raises:
        InvalidFieldError: not a problem, or the length is not > 0.
        UndecidedError: in space, contacts so nearly the same that rounding decides the answer.
        TooLargeError: as for `contact_modes`; or, in space, more than 128 edges of all friction pyramids.
    """
    if isinstance(problem, PlanarContactProblem):
        return planar_statics(problem, margin_length=margin_length)
    if isinstance(problem, SpatialContactProblem):
        return spatial_statics(problem, margin_length=margin_length)
    raise _not_a_problem(problem)


def _not_a_problem(problem: object, answer: object = None) -> InvalidFieldError:
    found = (
        type(problem).__name__ if answer is None else f"{type(problem).__name__} with {type(answer).__name__}"
    )
    return InvalidFieldError(
        "problem", found, "PlanarContactProblem or SpatialContactProblem, with the answer to it"
    )
