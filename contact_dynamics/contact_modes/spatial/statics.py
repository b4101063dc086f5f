# SPDX-License-Identifier: Apache-2.0
"""Static questions in space: does a body at rest stay, is it jammed or wedged?

The questions are those of the plane (`planar.statics`). Round cones decide whether forces balance the wrench,
with and without friction, and whether contacts press against each other (`round_cones`). Such an answer comes
with forces or with a motion that refutes them. Where rounding hides both, the question is undecided: an error
if it is whether the body can rest, and otherwise an answer without that part.

The disturbance that the body can take is found with pyramids inside the friction cones. The wrenches that
their forces can balance are a polyhedral cone in R^6, with torques divided by a length, whose facets are the
extreme rays of the dual cone. So the disturbance is one that the body surely takes. It lies between those of
round cones with the contacts' coefficients of friction and with cos(pi / facets) of these.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes.result import BodyStatics, Certainty, ModeVerdict, check_length
from contact_dynamics.contact_modes.spatial.answer import evidence_of, verdict_of
from contact_dynamics.contact_modes.spatial.cone import cone_of
from contact_dynamics.contact_modes.spatial.problem import (
    FRICTION_FACETS,
    MAX_EDGES,
    search_of,
    spatial_case,
)
from contact_dynamics.contact_modes.spatial.round_cones import held_by_round_cones, wedged_by_round_cones
from contact_dynamics.contact_modes.spatial.wrenches import distinct
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_dynamics.rotations.one import cross_matrix
from contact_dynamics.tolerances import LARGEST_NUMBER

if TYPE_CHECKING:
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
        linearised_cone(normal, min(float(friction), LARGEST_NUMBER), friction_facets, towards=-away)
        if friction > 0.0
        else normal[None, :]
        for normal, friction, away in zip(contacts.normals_W, contacts.holding_frictions, start, strict=True)
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
        modes = evidence_of(case, search, sharpen=True, beside_rest=True)
        alone = verdict_of(modes) == ModeVerdict.UNIQUE and modes.modes[0].motion_unique
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
    """Return how far inside the cone of positive combinations of unit rows, (k, 6), a wrench surely lies, N.

    Rows that nearly agree are one row, which makes the cone smaller if anything. It is 0 where rounding hides
    how far inside the wrench lies. If the body is not ``wedged``, no cone holds every wrench.
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
