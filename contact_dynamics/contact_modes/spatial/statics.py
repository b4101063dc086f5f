"""Static questions in space: does a body at rest stay, is it jammed or wedged, which disturbance can it take?

The questions are those of the plane (`planar.statics`), but pyramids inside the friction cones replace them.
So the answer is on the safe side: a body that is said to stay does stay, and the disturbance is one that it
surely takes. If a property holds by less than the pyramids leave out, a part 1 - cos(pi / facets) of
friction, the answer may deny it. The wrenches that contact forces can balance are a polyhedral cone in R^6,
with torques divided by a length. Its facets are the extreme rays of the dual cone.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes.result import BodyStatics, Certainty, ModeVerdict
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.cone import cone_of
from contact_dynamics.contact_modes.spatial.problem import MOST_EDGES, search_of, spatial_case
from contact_dynamics.contact_modes.spatial.round_cones import held_by_round_cones
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_dynamics.tolerances import ACCELERATION_TOLERANCE, ROW_TOLERANCE
from contact_dynamics.validation import check_positive

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.problem import SpatialCase, SpatialContactProblem
    from contact_dynamics.validation import FloatArray


def spatial_statics(problem: SpatialContactProblem, *, margin_length: float | None = None) -> BodyStatics:
    """Return whether and how well a body at rest stays at rest.

    Args:
        problem: The question; its velocities play no part. The first edge of each friction pyramid leans
            against the motion that the contact would begin without contact forces.
        margin_length: m, > 0. A torque is divided by it to be comparable with a force. If it is None, the
            length is the radius of gyration, the root mean square over the axes.

    Raises:
        InvalidFieldError: the length is not > 0.
        UndecidedError: the contacts are so nearly the same that rounding decides the answer.
        TooLargeError: more than `MOST_EDGES` edges, or more contacts than `spatial_contact_modes` accepts.
    """
    body, state, contacts = problem.body, problem.state, problem.contacts
    force, torque, friction_facets = problem.force_W, problem.torque_W, problem.friction_facets
    own = body.mean_radius_of_gyration
    length = own if margin_length is None else check_positive("margin_length", margin_length)
    if len(contacts) * friction_facets > MOST_EDGES:
        found = f"{len(contacts)} contacts of {friction_facets} edges"
        raise TooLargeError("contacts", found, f"at most {MOST_EDGES} edges together")
    arms = contacts.p_WC_W - state.p_WB_W
    start = force / body.mass + np.cross(np.linalg.solve(body.inertia_in_world(state.R_WB), torque), arms)
    pyramids = [
        linearised_cone(normal, float(friction), friction_facets, towards=-away)
        if friction > 0.0
        else normal[None, :]
        for normal, friction, away in zip(contacts.normals_W, contacts.frictions, start, strict=True)
    ]
    target = np.concatenate([force, torque / length])
    room, wedged = _room(_rows(arms, pyramids, length), target)
    smooth, _ = _room(_rows(arms, [normal[None, :] for normal in contacts.normals_W], length), target)
    at_rest = replace(problem, state=replace(state, v_WB_W=np.zeros(3), w_WB_W=np.zeros(3)), sharpen=True)
    balanced = _is_balanced(at_rest)
    equilibrium = Certainty.NO
    if balanced:
        answer = spatial_contact_modes(at_rest)
        alone = answer.verdict == ModeVerdict.UNIQUE and answer.modes[0].motion_unique
        equilibrium = Certainty.CERTAIN if alone else Certainty.POSSIBLE
    return BodyStatics(
        equilibrium=equilibrium,
        jammed=Certainty.NO if smooth >= 0.0 else equilibrium,
        wedged=wedged,
        stable_disturbance=max(0.0, room) if balanced else math.nan,
        margin_length=length,
    )


def _is_balanced(problem: SpatialContactProblem) -> bool:
    """Return whether contact forces within round cones balance the wrench on a body at rest."""
    case = cast("SpatialCase", spatial_case(problem))  # at rest no contact approaches
    held = held_by_round_cones(search_of(case, problem.friction_facets), np.eye(6, 7))
    if held.forces is None and not held.certain:
        raise UndecidedError(
            "contacts: found forces whose balance with the wrench hangs on rounding, allowed are "
            "wrenches that are clearly balanced or clearly not"
        )
    return held.forces is not None


def _rows(arms: FloatArray, pyramids: list[FloatArray], length: float) -> FloatArray:
    """Return unit wrenches, (k, 6), that edge forces balance, torques divided by ``length``."""
    wrenches = [
        np.hstack([-edges, -np.cross(arm, edges) / length]) for arm, edges in zip(arms, pyramids, strict=True)
    ]
    rows = np.vstack([np.zeros((0, 6)), *wrenches])
    unit: FloatArray = rows / np.linalg.norm(rows, axis=1)[:, None]
    return unit


def _room(rows: FloatArray, target: FloatArray) -> tuple[float, bool]:
    """Return how far inside the cone of positive combinations of rows a wrench lies, and if it is wedged.

    The distance is in N, and negative where the wrench lies outside. The contacts are wedged if some
    combination of rows vanishes whose coefficients are not all zero.
    """
    tolerance = max(ACCELERATION_TOLERANCE, ROW_TOLERANCE) * float(np.linalg.norm(target))
    if len(rows) == 0:
        return (0.0 if float(np.linalg.norm(target)) <= tolerance else -1.0), False
    cone = cone_of(rows)
    lines, facets, wedged = cone.lines.T, cone.rays, not bool(cone.strict.all())
    if np.any(np.abs(target @ lines) > tolerance):
        return -1.0, wedged
    heights = facets @ target
    if np.any(heights < -tolerance):
        return -1.0, wedged
    if lines.shape[1] > 0:
        return 0.0, wedged
    return max(0.0, float(heights.min(initial=math.inf))), wedged
