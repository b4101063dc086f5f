# SPDX-License-Identifier: Apache-2.0
"""These functions ask about contact modes. Each takes a problem in the plane or in space.

You state a problem once, as a `PlanarContactProblem` or a `SpatialContactProblem`, and ask it every question.
The files of `planar` and `spatial` answer them, under the same names. Of several bodies
(`BodiesContactProblem`) and of a mechanism (`ResponseContactProblem`) only the modes are available.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, overload

from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
from contact_dynamics.contact_modes.planar.statics import planar_statics
from contact_dynamics.contact_modes.planar.uncertain import planar_boxes
from contact_dynamics.contact_modes.planar.wrench_sets import planar_mode_margins, planar_wrench_sets
from contact_dynamics.contact_modes.result import (
    BodiesModeAnswer,
    PlanarModeAnswer,
    ResponseModeAnswer,
    SpatialModeAnswer,
)
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.margins import spatial_mode_margins, spatial_refused_modes
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.contact_modes.spatial.response import (
    BodiesContactProblem,
    ResponseContactProblem,
    bodies_contact_modes,
    response_contact_modes,
)
from contact_dynamics.contact_modes.spatial.statics import spatial_statics
from contact_dynamics.contact_modes.spatial.uncertain import spatial_boxes
from contact_dynamics.contact_modes.spatial.wrench_sets import spatial_wrench_sets
from contact_dynamics.contact_modes.surface_frame import (
    check_as_one,
    planar_frame,
    seen_in_plane,
    seen_in_space,
    spatial_frame,
)
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
@overload
def contact_modes(problem: BodiesContactProblem) -> BodiesModeAnswer: ...
@overload
def contact_modes(problem: ResponseContactProblem) -> ResponseModeAnswer: ...
def contact_modes(
    problem: PlanarContactProblem | SpatialContactProblem | BodiesContactProblem | ResponseContactProblem,
) -> PlanarModeAnswer | SpatialModeAnswer | ResponseModeAnswer:
    """Return the verdict on a contact problem and all consistent modes.

    A mode has one letter per contact: s separates, f is fixed (sticks), l and r slide left and right
    (planar), c slides (spatial). Each mode contains its accelerations and contact forces. A contact with the
    letter f has static friction, and others, also those that begin to slide, have kinetic friction.

    Args:
        problem: The contact problem, such as SpatialContactProblem.of(body, state, world, force_W=push). It
            may also be that of several bodies, or of a mechanism.

    Raises:
        TooLargeError: a spatial problem has too many touching contacts, or the search takes too many trials.
        UndecidedError: lengths, masses or moments differ so much that rounding error prevents a decision.
        NotSupportedError: surfaces move differently in a planar problem (`surface_frame`), or in a spatial
            problem with uncertain contacts.

    Examples:
        >>> import contact_dynamics as cd
        >>> crate = cd.Body.box((0.4, 0.3, 0.6), mass=20.0)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=0.0
        ... )
        >>> at_rest = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1])
        >>> world = cd.World(surfaces=(floor,))
        >>> problem = cd.SpatialContactProblem.of(
        ...     crate, at_rest, world, force_W=[70, 0, 0], at_W=[-0.2, 0, 0.6]
        ... )
        >>> answer = cd.contact_modes(problem)
        >>> print(answer.verdict.name, [mode.mode for mode in answer.modes])
        UNIQUE ['ssff']

    Source: lecture 26.
    """
    if isinstance(problem, PlanarContactProblem):
        frame = planar_frame(problem)
        seen = problem if frame is None else frame.problem
        answer = planar_contact_modes(seen)
        if not problem.uncertainty.is_exact:
            within = planar_boxes(seen, answer).verdicts_within(problem.uncertainty)
            answer = replace(answer, within=within)
        return answer if frame is None else frame.answer_in_world(answer, problem)
    if isinstance(problem, BodiesContactProblem):
        return bodies_contact_modes(problem)
    if isinstance(problem, ResponseContactProblem):
        return response_contact_modes(problem)
    in_frame = spatial_frame(problem)
    there = problem if in_frame is None else in_frame.problem
    in_space = spatial_contact_modes(there)
    if not problem.uncertainty.is_exact:
        check_as_one(there, "uncertain contacts")
        verdicts = spatial_boxes(there, in_space).verdicts_within(problem.uncertainty)
        in_space = replace(in_space, within=verdicts)
    return in_space if in_frame is None else in_frame.answer_in_world(in_space, problem)


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
    """Return the margin of each consistent mode, in the order of the modes.

    The margin is the size of the smallest change of the wrench that leaves the mode, N: the root of |f|^2 +
    |torque / length|^2. The list is empty if a contact approaches. Spatial margins are those of round
    friction cones, and NaN for some modes in which contacts begin to slide (`spatial_mode_margins`).

    Args:
        problem: The contact problem.
        answer: Answer to that problem, if available. It saves a search.
        margin_length: m, > 0. Length that makes torque comparable with force. If it is None, it is the radius
            of gyration; for spatial problems, the root mean square of the radii about the axes.

    Raises:
        InvalidFieldError: ``answer`` belongs to another kind of problem, or the length is not > 0.
        UndecidedError: spatial contacts are so nearly equal that rounding error prevents a decision.
        TooLargeError, NotSupportedError: as for `contact_modes`.

    Examples:
        >>> import contact_dynamics as cd
        >>> crate = cd.Body.box((0.4, 0.3, 0.6), mass=20.0)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=0.0
        ... )
        >>> at_rest = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1])
        >>> problem = cd.SpatialContactProblem.of(
        ...     crate, at_rest, cd.World(surfaces=(floor,)), force_W=[50, 0, 0]
        ... )
        >>> (margin,) = cd.mode_margins(problem)
        >>> print(f"{margin.mode} ends at a change of {margin.margin:.1f} N, then {margin.modes_beyond}")
        ffff ends at a change of 43.0 N, then ('cccc',)
    """
    if isinstance(problem, PlanarContactProblem) and not isinstance(answer, SpatialModeAnswer):
        return planar_mode_margins(seen_in_plane(problem), answer, margin_length=margin_length)
    if isinstance(problem, SpatialContactProblem) and not isinstance(answer, PlanarModeAnswer):
        return spatial_mode_margins(seen_in_space(problem), answer, margin_length=margin_length)
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
    """Return the kinematically possible modes that are not consistent, each with the first reason found.

    The answer to a planar problem already contains them. For spatial problems, there are too many sliding
    directions to list; the modes are then strings of `c` (stays closed) and `s` (separates), each of which
    takes a millisecond.

    Args:
        problem: The contact problem.
        answer: Answer to that problem.
        margin_length: m, > 0, spatial problems only. Length that makes torque comparable with force if the
            reason is a distance. If it is None, it is the root mean square of the radii of gyration about the
            axes.

    Raises:
        InvalidFieldError: ``answer`` belongs to another kind of problem, the length is not > 0, or a length
            is given for a planar problem.
        TooLargeError: as for `contact_modes`.
    """
    if isinstance(problem, PlanarContactProblem) and isinstance(answer, PlanarModeAnswer):
        if margin_length is not None:
            raise InvalidFieldError("margin_length", margin_length, "None in the plane")
        return answer.refused
    if isinstance(problem, SpatialContactProblem) and isinstance(answer, SpatialModeAnswer):
        return spatial_refused_modes(seen_in_space(problem), answer, margin_length=margin_length)
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
    """Return the applied wrenches that can cause each mode, in alphabetical order of the modes.

    Together, the sets form the map of modes. The wrench of a planar problem has no effect. That of a spatial
    one determines the orientation of the friction pyramids; a mode has one set for each combination of
    sliding directions, and the number of sets grows with the square or cube of `friction_facets`. A box on
    four feet has 200 to 350 sets with 4 facets and about 1300 with 8, and each set takes a millisecond or
    two. To save time, request few modes, or use `dataclasses.replace(problem, friction_facets=4)`.

    Args:
        problem: The contact problem.
        modes: Requested modes, with one letter for each contact. If it is None, all are returned.

    Raises:
        InvalidFieldError: a mode is not a string of valid letters.
        UndecidedError: spatial contacts are so nearly equal that rounding error prevents a decision.
        TooLargeError: a spatial problem has too many contacts, edges of friction pyramids, combinations of
            sliding directions, or sets.

    Source: lecture 26, "Force dual for dynamic contact problem" and "Contact modes for wrench in tray".
    """
    if isinstance(problem, PlanarContactProblem):
        in_plane = planar_frame(problem)
        if in_plane is None:
            return planar_wrench_sets(problem, modes=modes)
        return in_plane.sets_in_world(planar_wrench_sets(in_plane.problem, modes=modes))
    frame = spatial_frame(problem)
    if frame is None:
        return spatial_wrench_sets(problem, modes=modes)
    return frame.sets_in_world(spatial_wrench_sets(frame.problem, modes=modes))


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
    """Return the smallest errors of points, normals and friction that change the verdict or UNIQUE mode.

    Each margin has two bounds: the answer is proven for errors up to one size, and contacts with a different
    answer were found at another size. Proofs require bodies at rest and, in spatial problems, at most four
    contacts. All margins take about a second for two planar or three spatial contacts, and several seconds
    for four. The list is empty if a contact approaches.

    Args:
        problem: The contact problem. Its own uncertainty has no effect.
        answer: Answer to that problem, if available. It saves a search.

    Raises:
        InvalidFieldError: ``answer`` belongs to another kind of problem.
        TooLargeError: as for `contact_modes`.
        NotSupportedError: surfaces do not move as one rigid body.
    """
    if isinstance(problem, PlanarContactProblem) and not isinstance(answer, SpatialModeAnswer):
        problem = seen_in_plane(problem)
        found = planar_contact_modes(problem) if answer is None else answer
        return planar_boxes(problem, found).margins()
    if isinstance(problem, SpatialContactProblem) and not isinstance(answer, PlanarModeAnswer):
        problem = seen_in_space(problem, as_one="geometry_margins")
        in_space = spatial_contact_modes(problem) if answer is None else answer
        return spatial_boxes(problem, in_space).margins()
    raise _other_answer(problem, answer)


def statics(
    problem: PlanarContactProblem | SpatialContactProblem, *, margin_length: float | None = None
) -> BodyStatics:
    """Return whether the body stays at rest, with the size of the disturbance that it withstands.

    On surfaces that move, rest is relative to them, under what inertia adds to the wrench. Static friction
    holds the body; the equilibrium is CERTAIN if kinetic friction does not allow it to begin to slide.

    Args:
        problem: The contact problem. Its velocities have no effect: the body is treated as at rest.
        margin_length: As for `mode_margins`.

    Raises:
        InvalidFieldError: the length is not > 0.
        UndecidedError: contacts are so nearly equal that rounding error prevents a decision.
        TooLargeError: as for `contact_modes`, or spatial friction pyramids have more than 128 edges in total.
        NotSupportedError: surfaces do not move as one rigid body.

    Examples:
        >>> import contact_dynamics as cd
        >>> crate = cd.Body.box((0.4, 0.3, 0.6), mass=20.0)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.5, restitution=0.0
        ... )
        >>> at_rest = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1])
        >>> problem = cd.SpatialContactProblem.of(crate, at_rest, cd.World(surfaces=(floor,)))
        >>> balance = cd.statics(problem)
        >>> print(balance.equilibrium.name, f"{balance.stable_disturbance:.0f} N")
        CERTAIN 76 N
    """
    if isinstance(problem, PlanarContactProblem):
        return planar_statics(seen_in_plane(problem, resting=True), margin_length=margin_length)
    seen = seen_in_space(problem, as_one="statics", resting=True)
    return spatial_statics(seen, margin_length=margin_length)


def _other_answer(problem: object, answer: object) -> InvalidFieldError:
    return InvalidFieldError("answer", type(answer).__name__, f"the answer to the {type(problem).__name__}")
