"""The map of modes over applied wrenches, and the margins of a given wrench (Mason, lecture 26)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import judge_all
from contact_dynamics.contact_modes.planar.problem import contact_velocities, planar_case
from contact_dynamics.contact_modes.planar.result import ModeVerdict, verdict_on
from contact_dynamics.contact_modes.planar.wrench_sets import (
    PlanarWrenchSet,
    WrenchHalfSpace,
    planar_wrench_set,
)
from contact_dynamics.plane.types import PlanarVelocity, PlanarWrench
from contact_dynamics.tolerances import ACCELERATION_TOLERANCE, BEYOND_MARGIN, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_not_negative, check_positive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact_modes.planar.problem import PlanarCase
    from contact_dynamics.plane.types import PlanarBody, PlanarContact

_AT_REST: Final = PlanarVelocity(v=(0.0, 0.0), w=0.0)
_NO_WRENCH: Final = PlanarWrench(f=(0.0, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarModeMargin:
    """How far an applied wrench is from leaving one of its consistent modes, and where it would go."""

    mode: str  # one letter a contact
    margin: float  # N, length of the least change in |f|^2 + (moment / length)^2; infinite: none does
    length: float  # m, of that metric
    change: PlanarWrench  # the least change itself; zero where there is none
    verdict_beyond: ModeVerdict  # just behind the boundary; the present one where there is none
    modes_beyond: tuple[str, ...]  # the consistent modes there


def planar_mode_map(
    body: PlanarBody,
    contacts: Sequence[PlanarContact],
    *,
    velocity: PlanarVelocity = _AT_REST,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> tuple[PlanarWrenchSet, ...]:
    """Return the applied wrenches of every kinematically possible mode, in alphabetical order.

    Empty where a contact approaches, or where none touches.

    Raises:
        InvalidFieldError: the tolerance is negative.
        TooLargeError: more contacts than `planar_contact_modes` accepts.

    Source: lecture 26, "Force dual for dynamic contact problem" and "Contact modes for wrench in tray".
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    case = _touching_problem(body, velocity, contacts, _NO_WRENCH, tolerance)
    if case is None:
        return ()
    return tuple(planar_wrench_set(case, mode, cell) for mode, cell in sorted(kinematic_cells(case).items()))


def planar_mode_margins(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contacts: Sequence[PlanarContact],
    wrench: PlanarWrench,
    *,
    margin_length: float | None = None,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    acceleration_tolerance: float = ACCELERATION_TOLERANCE,
) -> tuple[PlanarModeMargin, ...]:
    """Return the margin of ``wrench`` in each of its consistent modes, in the order of their answer.

    Args:
        body: Mass and angular inertia.
        velocity: Of the body.
        contacts: As for `planar_contact_modes`.
        wrench: Applied to the body besides its contact forces, gravity included.
        margin_length: m, > 0, makes a moment comparable with a force; None: the radius of gyration.
        velocity_tolerance: m/s, >= 0. A component of a contact's velocity within it counts as zero.
        acceleration_tolerance: Relative to the applied wrench and the centripetal terms, >= 0: forces and
            accelerations whose sign a change by that part turns count as zero.

    Raises:
        InvalidFieldError: a tolerance is negative, or the length is not > 0.
        TooLargeError: more contacts than `planar_contact_modes` accepts.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    accuracy = check_not_negative("acceleration_tolerance", acceleration_tolerance)
    length = (
        body.radius_of_gyration if margin_length is None else check_positive("margin_length", margin_length)
    )
    case = _touching_problem(body, velocity, contacts, wrench, tolerance)
    if case is None:
        return ()
    cells = kinematic_cells(case)
    consistent, _ = judge_all(case, cells, accuracy)
    present = tuple(mode.mode for mode in consistent)
    if len(contacts) == 1:
        present = tuple(sorted(present, key="slrf".index))  # the order in which `single` tries them
    found = []
    for mode in present:
        margin, side = _nearest(planar_wrench_set(case, mode, cells[mode]), wrench, length)
        if side is None:
            found.append(
                PlanarModeMargin(
                    mode=mode,
                    margin=math.inf,
                    length=length,
                    change=_NO_WRENCH,
                    verdict_beyond=verdict_on(tuple(consistent)),
                    modes_beyond=present,
                )
            )
            continue
        way = side.outward(length)
        step = margin + BEYOND_MARGIN * max(margin, math.hypot(*wrench.f, wrench.moment / length))
        beyond = _stepped(wrench, step, way)
        there, _ = judge_all(case._replace(w=(*beyond.f, beyond.moment / case.rho)), cells, accuracy)
        found.append(
            PlanarModeMargin(
                mode=mode,
                margin=margin,
                length=length,
                change=_stepped(_NO_WRENCH, margin, way),
                verdict_beyond=verdict_on(tuple(there)),
                modes_beyond=tuple(one.mode for one in there),
            )
        )
    return tuple(found)


def _nearest(
    wrenches: PlanarWrenchSet, wrench: PlanarWrench, length: float
) -> tuple[float, WrenchHalfSpace | None]:
    """Return the distance to the nearest boundary and that boundary; a consistent wrench is inside."""
    if not wrenches.half_spaces:
        return math.inf, None
    side = min(wrenches.half_spaces, key=lambda half_space: half_space.depth(wrench, length))
    return max(0.0, side.depth(wrench, length)), side


def _stepped(wrench: PlanarWrench, step: float, way: PlanarWrench) -> PlanarWrench:
    return PlanarWrench(
        f=(wrench.f[0] + step * way.f[0], wrench.f[1] + step * way.f[1]),
        moment=wrench.moment + step * way.moment,
    )


def _touching_problem(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contacts: Sequence[PlanarContact],
    wrench: PlanarWrench,
    tolerance: float,
) -> PlanarCase | None:
    """Return the problem of the contacts that touch; None: none does, or one approaches."""
    velocities = contact_velocities(velocity, contacts, tolerance)
    if any(v_n < 0.0 for _, v_n in velocities) or all(v_n > 0.0 for _, v_n in velocities):
        return None
    return planar_case(body, velocity, contacts, velocities, wrench, velocity_tolerance=tolerance)
