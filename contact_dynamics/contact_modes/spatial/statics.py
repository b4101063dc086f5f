# SPDX-License-Identifier: Apache-2.0
"""Static questions in space: does a body at rest stay, is it jammed or wedged, and how much can it bear?

The questions are those of the plane (`planar.statics`). Round cones decide whether forces balance the wrench,
with and without friction, and whether contacts press against each other (`round_cones`). Such an answer comes
with forces or with a motion that refutes them. Where rounding hides both, the question is undecided: an error
if it is whether the body can rest, and otherwise an answer without that part.

The disturbance that the body can take is found with pyramids inside the friction cones. The wrenches that
their forces can balance are a polyhedral cone in R^6, with torques divided by a length, whose facets are the
extreme rays of the dual cone. So the disturbance is one that the body surely takes. It lies between those of
round cones with the contacts' coefficients of friction and with cos(pi / facets) of these.

The largest load in one direction is that of round cones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes.letters import STICKS, mode_in_words
from contact_dynamics.contact_modes.result import BodyStatics, Certainty, ModeVerdict, check_length
from contact_dynamics.contact_modes.spatial.answer import modes_of_case, spatial_contact_modes
from contact_dynamics.contact_modes.spatial.cone import cone_of
from contact_dynamics.contact_modes.spatial.problem import (
    FRICTION_FACETS,
    MAX_EDGES,
    search_of,
    spatial_case,
)
from contact_dynamics.contact_modes.spatial.round_cones import held_by_round_cones, wedged_by_round_cones
from contact_dynamics.contact_modes.spatial.wrenches import RoundSum, distinct
from contact_dynamics.errors import InvalidFieldError, TooLargeError, UndecidedError
from contact_dynamics.numerics.vectors import tangents
from contact_dynamics.records import Record
from contact_dynamics.rotations.one import cross_matrix
from contact_dynamics.tolerances import ANY_LOAD, NEXT_TO_A_LIMIT, ONLY_REST_WITHIN, SAME_FACTOR
from contact_dynamics.validation import check_vector3

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from contact_dynamics.contact_modes.result import SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase, SpatialContactProblem
    from contact_dynamics.contact_modes.spatial.round_cones import Held
    from contact_dynamics.validation import FloatArray


def spatial_statics(problem: SpatialContactProblem, *, margin_length: float | None = None) -> BodyStatics:
    """Return whether and how well a body at rest stays at rest (`plane_or_space.statics`).

    The first edge of each friction pyramid leans against the motion that the contact would begin without
    contact forces.
    """
    body, state, contacts = problem.body, problem.state, problem.contacts
    force, torque, friction_facets = problem.force_W, problem.torque_W, problem.friction_facets
    length = check_length(margin_length, body.mean_radius_of_gyration)
    if len(contacts) * friction_facets > MAX_EDGES:
        found = f"{len(contacts)} contacts of {friction_facets} edges"
        raise TooLargeError("contacts", found, f"at most {MAX_EDGES} edges together")
    arms = contacts.p_WC_W - state.p_WB_W
    start = force / body.mass + np.cross(np.linalg.solve(body.inertia_in_world(state.R_WB), torque), arms)
    pyramids = [
        linearised_cone(normal, float(friction), friction_facets, towards=-away)
        if friction > 0.0
        else normal[None, :]
        for normal, friction, away in zip(contacts.normals_W, contacts.frictions, start, strict=True)
    ]
    at_rest = replace(problem, state=replace(state, v_WB_W=np.zeros(3), w_WB_W=np.zeros(3)), sharpen=True)
    case = cast("SpatialCase", spatial_case(at_rest))  # at rest no contact approaches
    search = search_of(case, FRICTION_FACETS)
    wedged = _known(wedged_by_round_cones(search))
    equilibrium, jammed, room = Certainty.NO, Certainty.NO, math.nan
    held = _known(held_by_round_cones(search, np.eye(6, 7)))
    if held is None:
        raise UndecidedError(
            "contacts must be clearly balanced with the wrench, or clearly not, got forces whose balance "
            "hangs on rounding"
        )
    if held:
        answer = modes_of_case(at_rest, case, search, beside_rest=True)
        alone = answer.verdict == ModeVerdict.UNIQUE and answer.modes[0].motion_unique
        equilibrium = Certainty.CERTAIN if alone else Certainty.POSSIBLE
        smooth = _known(held_by_round_cones(search, np.eye(6, 7), smooth=True))
        jammed = {True: Certainty.NO, False: equilibrium, None: Certainty.UNKNOWN}[smooth]
        target = np.concatenate([force, torque / length])
        room = _room(_rows(arms, pyramids, length), target, wedged=wedged is True)
    return BodyStatics(
        equilibrium=equilibrium, jammed=jammed, wedged=wedged, stable_disturbance=room, margin_length=length
    )


def _known(held: Held) -> bool | None:
    """Return whether there are forces, or None if rounding decides."""
    return None if held.forces is None and not held.certain else held.forces is not None


def _rows(arms: FloatArray, pyramids: list[FloatArray], length: float) -> FloatArray:
    """Return unit wrenches, (k, 6), that edge forces balance, torques divided by ``length``."""
    wrenches = [
        np.hstack([-edges, edges @ cross_matrix(arm) / length])
        for arm, edges in zip(arms, pyramids, strict=True)
    ]
    rows = np.vstack([np.zeros((0, 6)), *wrenches])
    unit: FloatArray = rows / np.linalg.norm(rows, axis=1)[:, None]
    return unit


def _room(rows: FloatArray, target: FloatArray, *, wedged: bool) -> float:
    """Return how far inside the cone of positive combinations of rows a wrench surely lies, N.

    Rows that nearly agree are one row, which makes the cone smaller if anything. It is 0 where rounding hides
    how far inside the wrench lies.

    Args:
        rows: (k, 6), unit.
        target: (6,), the wrench.
        wedged: Whether contact forces can balance each other, without which no cone holds every wrench.
    """
    if len(rows) == 0:
        return 0.0
    try:
        cone = cone_of(distinct(rows))
    except UndecidedError:
        return 0.0
    if len(cone.lines) or (len(cone.rays) == 0 and not wedged):
        return 0.0
    return max(0.0, float((cone.rays @ target).min(initial=math.inf)))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class LargestLoad(Record):
    """How much of a load a body at rest bears, as factors of that load.

    Attributes:
        factor: Up to this factor rest is consistent, >= 0. It is infinite if rest is consistent under any.
        only_rest: Up to this factor rest is the only consistent mode, <= ``factor``. If it is less, it was
            found by halving, to 1 %, and a mode that comes and goes again below it is not looked for. It is 0
            if rest is not alone without the load.
        verdict_beyond: The verdict just beyond ``factor``, or UNIQUE if it is infinite.
        modes_beyond: The modes that are consistent just beyond it.
    """

    factor: float
    only_rest: float
    verdict_beyond: ModeVerdict
    modes_beyond: tuple[str, ...]

    def in_short(self) -> str:
        """Return how much it bears, and what then follows."""
        if math.isinf(self.factor):
            return "LargestLoad: it stays fixed under any multiple of the load"
        then = " or ".join(map(mode_in_words, self.modes_beyond)) or "no mode is consistent"
        fixed = f"it stays fixed up to {self.factor:.3g} times the load"
        if self.only_rest < self.factor:  # beyond it another mode is consistent too
            surely = f"it surely stays fixed up to {self.only_rest:.3g}"
            fixed = f"{surely} and may up to {self.factor:.3g} times the load"
        return f"LargestLoad: {fixed}, then {then}"


def largest_load(
    problem: SpatialContactProblem,
    *,
    force_W: ArrayLike = (0.0, 0.0, 0.0),
    torque_W: ArrayLike = (0.0, 0.0, 0.0),
    at_W: ArrayLike | None = None,
) -> LargestLoad:
    """Return how much of a load a body bears besides the problem's own wrench before it moves.

    With a load of 1 N, the factors are newtons; with m times 1 m/s^2, they are the deceleration of a truck in
    m/s^2. Friction cones are round, and ``factor`` is exact to about 1e-10. A flush rim is eight contacts, so
    that a cup may seem to tip at 92 % of the true load.

    Args:
        problem: The problem, with the wrench without the load, such as the weight alone. Rest is consistent.
        force_W: (3,), N, of the load, world axes.
        torque_W: (3,), N m, of the load about the centre of mass, besides that of the force, world axes.
        at_W: (3,), m, where the force acts, world axes, or None for the centre of mass.

    Raises:
        InvalidFieldError: rest is not consistent without the load, or the load is zero or not finite.
    """
    force, torque = check_vector3("force_W", force_W), check_vector3("torque_W", torque_W)
    if at_W is not None:
        torque = torque + np.cross(check_vector3("at_W", at_W) - problem.state.p_WB_W, force)
    load = np.concatenate([force, torque])
    if not load.any():
        raise InvalidFieldError("force_W", "no load", "a load, or torque_W")
    rest = STICKS * len(problem.contacts)

    def answer(factor: float) -> SpatialModeAnswer:
        wrench_W = problem.wrench_W + factor * load
        return spatial_contact_modes(replace(problem, force_W=wrench_W[:3], torque_W=wrench_W[3:]))

    def rests_alone(factor: float) -> bool:
        found = answer(factor)
        return found.verdict == ModeVerdict.UNIQUE and found.modes[0].mode == rest

    without = answer(0.0)
    if rest not in {mode.mode for mode in without.modes}:
        raise InvalidFieldError(
            "problem", without.in_short(), "one of a body that stays fixed without the load"
        )
    factor = _largest_factor(problem, load)
    if math.isinf(factor):
        far = ANY_LOAD * max(1.0, float(np.linalg.norm(problem.wrench_W) / np.linalg.norm(load)))
        alone = math.inf if rests_alone(far) else _last(rests_alone, far)
        return LargestLoad(factor=factor, only_rest=alone, verdict_beyond=ModeVerdict.UNIQUE, modes_beyond=())
    after, inside = answer(factor * (1.0 + NEXT_TO_A_LIMIT)), factor * (1.0 - NEXT_TO_A_LIMIT)
    return LargestLoad(
        factor=factor,
        only_rest=factor if rests_alone(inside) else _last(rests_alone, inside),
        verdict_beyond=after.verdict,
        modes_beyond=tuple(mode.mode for mode in after.modes),
    )


def _largest_factor(problem: SpatialContactProblem, load: FloatArray) -> float:
    """Return up to which factor of a load, (6,), forces within the round cones hold a body at rest.

    A wrench that they do not hold is separated from all that they hold by a plane. Where the plane meets the
    ray of the loads, the next wrench is tried, which is nearer to the last one that they hold, until they do.
    """
    length = problem.body.mean_radius_of_gyration
    scale = np.array([1.0, 1.0, 1.0, length, length, length])
    contacts = problem.contacts
    arms = contacts.p_WC_W - problem.state.p_WB_W
    along = np.array([tangents((x, y, z)) for x, y, z in contacts.normals_W.tolist()])

    def wrenches(forces_W: FloatArray) -> FloatArray:
        found: FloatArray = np.hstack([forces_W, np.cross(arms, forces_W)]) / scale
        return found

    frictions = contacts.frictions[:, None]
    held = RoundSum(
        rays=np.zeros((0, 6)),
        axes=wrenches(contacts.normals_W),
        leans=np.stack([wrenches(frictions * along[:, 0]), wrenches(frictions * along[:, 1])], axis=1),
    )
    applied, load = problem.wrench_W / scale, load / scale
    rest = held.rest(-load)
    factor = math.inf
    while rest.any():
        nearer = -float(rest @ applied) / float(rest @ load)
        if not nearer < factor * (1.0 - SAME_FACTOR):
            break
        factor = nearer
        rest = held.rest(-applied - factor * load)
    return factor


def _last(holds: Callable[[float], bool], beyond: float) -> float:
    """Return a factor below ``beyond`` up to which something holds, by halving, or 0 if it does not at 0."""
    if not holds(0.0):
        return 0.0
    inside = 0.0
    while beyond - inside > ONLY_REST_WITHIN * beyond:
        middle = 0.5 * (inside + beyond)
        if holds(middle):
            inside = middle
        else:
            beyond = middle
    return inside
