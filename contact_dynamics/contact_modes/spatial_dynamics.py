"""Contact modes of a body in space that are consistent with mechanics: separate, stick, or slide which way.

Model: as in the plane (lecture 26), with Coulomb's round cone. A contact that moves slides in a known
direction and has its exact friction. For one at rest the cone is a pyramid with a stated number of edges, the
first of which opposes the tangential acceleration that the contact would have without any contact force. On
the pyramid friction does the most it can against the sliding: a contact that slides within the sector
opposite to an edge has its force on that edge, one that slides on a sector's border has it on the side
between two edges. Letters are s (separates), f (sticks) and c (stays and slides); the sector or border
belongs to the mode.

The letters of all contacts are tried in groups that are split further and further (separates or stays; sticks
or slides; within which arc), each trial one linear program in the forces of all contacts. A group may do
whatever one of its letters may, so that dead ends are seen early and no consistent mode is missed. A contact
without friction is one letter, sliding or not.

Does not cover: refused modes (there are many), margins.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.contact_modes.spatial_letters import Trial, any_letter
from contact_dynamics.contact_modes.spatial_result import SpatialMode, SpatialModeAnswer
from contact_dynamics.errors import TooLargeError
from contact_dynamics.friction import linearised_cone
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import check_array, check_not_negative

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.contact import ContactSet
    from contact_dynamics.rigid_body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MOST_DYNAMIC_CONTACTS: Final = 12
"""Longest list of touching contacts accepted: each has two letters and two an edge, tried one after
another."""

FRICTION_FACETS: Final = 8
"""Edges of a friction pyramid where nothing else is asked for: it holds at least 92 % of the round cone's."""

_STRICT: Final = 1e-6
"""Relative to the largest acceleration: what an inequality must have to hold strictly. The linear programs
are solved to 1e-9."""

_MILDER: Final = 0.1
"""How much less an arc must hold than its letters, whose rows are differences of unit ones."""


class _Problem(NamedTuple):
    edges: FloatArray  # (3 n, K), N, contact forces of unit edge forces
    trials: list[Trial]  # for each contact, all its letters together
    motion: FloatArray  # (6, K), acceleration of the body for unit edge forces


def spatial_contact_modes(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    force_W: ArrayLike,
    torque_W: ArrayLike = (0.0, 0.0, 0.0),
    friction_facets: int = FRICTION_FACETS,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> SpatialModeAnswer:
    """Return the verdict on a contact set in space and all consistent modes.

    Args:
        body: Mass and angular inertia.
        state: Of the body, with its origin at the centre of mass.
        contacts: Points of the body on flats of the world; at most `MOST_DYNAMIC_CONTACTS` of them touching.
        force_W: (3,), N, applied to the body besides its contact forces, gravity included, world axes.
        torque_W: (3,), N m, applied about the centre of mass, world axes.
        friction_facets: Edges of the pyramid that stands for a friction cone at rest, >= 3.
        velocity_tolerance: m/s, >= 0. A component of a contact's velocity within it counts as zero, and so
            does
            an angular velocity that moves no contact relative to the centre of mass by more than that.

    Raises:
        InvalidFieldError: a wrench that is not finite, a negative tolerance, too few facets.
        TooLargeError: more contacts touch than `MOST_DYNAMIC_CONTACTS`.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    force = check_array("force", force_W, (3,))
    torque = check_array("torque", torque_W, (3,))
    r_W = contacts.p_WC_W - state.p_WB_W
    velocities = state.velocity_of_point(contacts.p_WC_W)
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    approaching = tuple(int(i) for i in np.flatnonzero(v_n < -tolerance))
    modes: list[SpatialMode] = []
    if not approaching:
        if int((v_n <= tolerance).sum()) > MOST_DYNAMIC_CONTACTS:
            raise TooLargeError("contacts", f"{len(v_n)} contacts", f"at most {MOST_DYNAMIC_CONTACTS}")
        sliding = velocities - v_n[:, None] * contacts.normals_W
        sliding[np.linalg.norm(sliding, axis=1) <= tolerance] = 0.0
        w = state.w_WB_W
        if len(r_W) > 0 and np.linalg.norm(w) * np.linalg.norm(r_W, axis=1).max() <= tolerance:
            w = np.zeros(3)
        modes = list(
            _consistent_modes(
                _Motion(
                    body.mass,
                    body.inertia_in_world(state.R_WB),
                    r_W=r_W,
                    w_W=w,
                    wrench_W=np.concatenate([force, torque]),
                ),
                contacts,
                sliding,
                v_n > tolerance,
                friction_facets,
            )
        )
    verdict = ModeVerdict.UNIQUE if len(modes) == 1 else ModeVerdict.INDETERMINATE
    if not modes:
        verdict = ModeVerdict.IMPACT if approaching else ModeVerdict.INCONSISTENT
    return SpatialModeAnswer(
        verdict=verdict,
        modes=tuple(modes),
        approaching=approaching,
        velocity_tolerance=tolerance,
        friction_facets=friction_facets,
    )


class _Motion:
    """Accelerations of the body and of its contact points as affine functions of the contact forces."""

    def __init__(
        self, mass: float, inertia: FloatArray, *, r_W: FloatArray, w_W: FloatArray, wrench_W: FloatArray
    ) -> None:
        n = len(r_W)
        # J maps (a, alpha) to the accelerations of the contact points, its transpose forces to wrenches.
        J = np.zeros((3 * n, 6))
        for i, (x, y, z) in enumerate(r_W):
            J[3 * i : 3 * i + 3, :3] = np.eye(3)
            J[3 * i : 3 * i + 3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
        inverse = np.zeros((6, 6))
        inverse[:3, :3] = np.eye(3) / mass
        inverse[3:, 3:] = np.linalg.inv(inertia)
        self.mass = mass
        self.of_forces = inverse @ J.T  # (6, 3 n)
        self.free = inverse @ (wrench_W - np.concatenate([np.zeros(3), np.cross(w_W, inertia @ w_W)]))
        self.points_of_forces = J @ self.of_forces
        self.points_free = J @ self.free + np.cross(w_W, np.cross(w_W, r_W)).ravel()
        # Everything is divided by the largest acceleration, so that one tolerance serves.
        largest = max(float(np.abs(self.points_free).max(initial=0.0)), float(np.abs(self.free[:3]).max()))
        self.scale = largest if largest > 0.0 else 1.0


def _consistent_modes(
    motion: _Motion, contacts: ContactSet, sliding: FloatArray, leaving: NDArray[np.bool_], facets: int
) -> Iterator[SpatialMode]:
    """Yield the consistent modes: groups of letters are split, the largest first, while they may hold."""
    problem = _stated(motion, contacts, sliding, leaving, facets)
    waiting = [(problem.trials, [0] * len(problem.trials))]
    while waiting:
        trials, depths = waiting.pop()
        undecided = [i for i, trial in enumerate(trials) if trial.parts]
        if not undecided:
            yield _evidence(motion, problem, trials, contacts, sliding)
            continue
        at = min(undecided, key=lambda i: depths[i])
        for part in reversed(trials[at].parts):
            narrower = [*trials[:at], part, *trials[at + 1 :]]
            if _can_hold(narrower):
                waiting.append((narrower, [depth + (i == at) for i, depth in enumerate(depths)]))


def _stated(
    motion: _Motion, contacts: ContactSet, sliding: FloatArray, leaving: NDArray[np.bool_], facets: int
) -> _Problem:
    """Lay out the edge forces of all contacts and what each letter asks of them."""
    pyramids = []
    for i, normal in enumerate(contacts.normals_W):
        friction = float(contacts.frictions[i])
        speed = float(np.linalg.norm(sliding[i]))
        if leaving[i]:
            pyramids.append(np.zeros((0, 3)))
        elif friction == 0.0:
            pyramids.append(normal[None, :])
        elif speed > 0.0:
            pyramids.append((normal - friction * sliding[i] / speed)[None, :])
        else:
            free = motion.points_free[3 * i : 3 * i + 3]
            pyramids.append(linearised_cone(normal, friction, facets, towards=-free))
    counts = [len(pyramid) for pyramid in pyramids]
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(int)
    total = int(starts[-1])
    edges = np.zeros((3 * len(counts), total))
    for i, pyramid in enumerate(pyramids):
        edges[3 * i : 3 * i + 3, starts[i] : starts[i + 1]] = pyramid.T
    edges *= motion.mass  # an edge force of 1 accelerates the free body at about the scale
    points = np.column_stack([motion.points_of_forces @ edges, motion.points_free / motion.scale])
    trials = []
    for i, pyramid in enumerate(pyramids):
        own = list(range(starts[i], starts[i + 1]))
        point = points[3 * i : 3 * i + 3]
        normal = contacts.normals_W[i] @ point
        if leaving[i]:
            nothing = np.zeros((0, total + 1))
            trials.append(Trial("s", own, nothing, nothing, []))
        else:
            trials.append(any_letter(pyramid - contacts.normals_W[i], own, normal, point))
    return _Problem(edges * motion.scale, trials, motion.of_forces @ edges * motion.scale)


def _can_hold(trials: list[Trial]) -> bool:
    """Return whether some forces satisfy all trials, those that are letters strictly."""
    count = trials[0].zero.shape[1] - 1
    found = _program(trials, np.zeros(count), maximise_slack=True)
    return found is not None and found[-1] > _STRICT


def _strictness(trial: Trial) -> FloatArray:
    """Return how much of the slack each row must have: a letter's all, an arc's first, since it slides."""
    strict = np.ones(len(trial.positive))
    if trial.parts:
        strict[1 if trial.letter else 0 :] = 0.0
        strict *= _MILDER
    return strict


def _program(trials: list[Trial], objective: FloatArray, *, maximise_slack: bool) -> FloatArray | None:
    """Minimise ``objective`` over the edge forces, or maximise the slack, at most 1, that comes last.

    None: no forces at all, or no minimum.
    """
    from scipy.optimize import linprog

    nothing = np.zeros((0, len(objective) + 1))
    zero = np.vstack([nothing, *(trial.zero for trial in trials)])
    lower = np.vstack([nothing, *(trial.positive for trial in trials)])
    strict = [np.zeros(0), *(_strictness(trial) for trial in trials)]
    bounds: list[tuple[float, float | None]] = [(0.0, None)] * len(objective)
    for trial in trials:
        for edge in trial.silent:
            bounds[edge] = (0.0, 0.0)
    bounds.append((0.0, 1.0) if maximise_slack else (0.0, 0.0))
    found = linprog(
        np.append(objective, -1.0 if maximise_slack else 0.0),
        A_ub=np.hstack([-lower[:, :-1], np.concatenate(strict)[:, None]]),
        b_ub=lower[:, -1],
        A_eq=np.hstack([zero[:, :-1], np.zeros((len(zero), 1))]),
        b_eq=-zero[:, -1],
        bounds=bounds,
        method="highs",
        options={"primal_feasibility_tolerance": 1e-9, "dual_feasibility_tolerance": 1e-9},
    )
    solution: FloatArray | None = found.x if found.status == 0 else None
    return solution


def _evidence(
    motion: _Motion, problem: _Problem, chosen: list[Trial], contacts: ContactSet, sliding: FloatArray
) -> SpatialMode:
    count = problem.edges.shape[1]
    found = _program(chosen, np.zeros(count), maximise_slack=True)
    shares = found[:-1] if found is not None else np.zeros(count)
    forces = problem.edges @ shares
    body = motion.free + motion.of_forces @ forces
    points = (motion.points_free + motion.points_of_forces @ forces).reshape(-1, 3)
    across = points - np.sum(points * contacts.normals_W, axis=1)[:, None] * contacts.normals_W
    letters = []
    directions = np.zeros_like(points)
    for i, trial in enumerate(chosen):
        way = sliding[i] if np.any(sliding[i]) else across[i]
        size = float(np.linalg.norm(way))
        # Without friction one letter stands for both, and the acceleration says which it is.
        rests = trial.letter == "c" and not np.any(sliding[i]) and size <= _STRICT * motion.scale
        letters.append("f" if rests else trial.letter)
        if letters[-1] == "c":
            directions[i] = way / size
    forces_unique = _is_unique(chosen, np.eye(count))
    return SpatialMode(
        mode="".join(letters),
        acceleration_W=body[:3],
        angular_acceleration_W=body[3:],
        contact_forces_W=forces.reshape(-1, 3),
        contact_accelerations_W=points,
        tangential_directions_W=directions,
        forces_unique=forces_unique,
        motion_unique=forces_unique or _is_unique(chosen, problem.motion / motion.scale),
    )


def _is_unique(chosen: list[Trial], quantities: FloatArray) -> bool:
    """Return whether ``quantities``, (k, K), of the edge forces are the same for all that the mode allows.

    One combination of them, drawn once and for all, is made as small and as large as it can be.
    """
    mixed = np.random.default_rng(26).normal(size=len(quantities)) @ quantities
    ends = []
    for sign in (1.0, -1.0):
        found = _program(chosen, sign * mixed, maximise_slack=False)
        if found is None:
            return False
        ends.append(float(mixed @ found[:-1]))
    return abs(ends[1] - ends[0]) <= _STRICT * (1.0 + abs(ends[0]))
