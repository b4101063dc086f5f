"""A free motion is fitted to a short window of published states, so that one noisy velocity does no harm.

Model: a torque-free body in uniform gravity (`contact_dynamics.tumbling`) is seen at n times. There is white
noise in position and orientation, and in the velocities if they are used. The path of the centre of mass is a
linear least-squares problem. The rotation has six unknowns, attitude and angular velocity at the newest
stamp. Gauss's and Newton's method finds them with the exact derivative of the motion (`free_derivative`). It
starts from the angular momentum averaged over all neighbouring pairs of states, since L is constant. If the
last turn alone fits better, as it does for needles, it starts from that.

Not covered: windows in which something touched the body, torque and drag (`integrated_fit`), outliers, noise
that is correlated from state to state, unknown mass properties, half a turn or more between neighbouring
states.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W, seconds_since
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.motion.free_derivative import rotation_derivatives
from contact_dynamics.numerics.gauss_newton import gauss_newton
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.rotations.many import matrices_of, rotation_vectors, turned
from contact_dynamics.tolerances import SMALL_STEP
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion
from contact_dynamics.validation import FloatArray, check_array, check_positive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

FEWEST_STATES: Final = 3
"""Least number of states. Twelve numbers fit two poses exactly, with all their noise."""

MOST_STATES: Final = 2000
"""Largest number of states, which is a window of seconds. More would take too long."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class StateNoise(Record):
    """Standard deviations of published states, of each component, white.

    Attributes:
        position: m, > 0.
        orientation: rad, > 0, of a rotation vector's components.
        linear_velocity: m/s, > 0, or None if published linear velocities are not used.
        angular_velocity: rad/s, > 0, or None if published angular velocities are not used.

    Raises:
        InvalidFieldError: a deviation is not > 0.
    """

    position: float
    orientation: float
    linear_velocity: float | None = None
    angular_velocity: float | None = None

    def __post_init__(self) -> None:
        """Check those that are there."""
        for name in self.__slots__:
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, check_positive(f"{name}_noise", value))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FitResult(Record):
    """The best-fit state at the newest stamp, and how well it fits.

    Attributes:
        state: The fitted state at the newest stamp.
        covariance: (12, 12): position, rotation vector (world, after the attitude), both velocities.
        position_residual: m, root mean square distance of the positions.
        orientation_residual: rad, root mean square angle between the orientations.
        count: Number of states.
        rounds: Number of rounds of Gauss's and Newton's method.
        converged: Whether the last round changed next to nothing.
        position_misses_W: (count, 3), m, the positions less the fitted ones, world axes.
        orientation_misses_W: (count, 3), rad, rotation vectors from the fitted attitudes to those of the
            states, world axes.
        by_gravity: By how much the fitted position (s^2) and velocity (s) change with gravity, each component
            with its own. A fit to positions over a time T has about T^2 / 12 and T / 2. None means that it is
            not known, as under wrenches.
    """

    state: BodyState
    covariance: FloatArray
    position_residual: float
    orientation_residual: float
    count: int
    rounds: int
    converged: bool
    position_misses_W: FloatArray
    orientation_misses_W: FloatArray
    by_gravity: tuple[float, float] | None = None


def fit_free_motion(
    body: MassProperties,
    states: Sequence[BodyState],
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    noise: StateNoise | None = None,
) -> FitResult:
    """Return the free motion that fits ``states``, in order of time, best.

    If ``noise`` is given, the covariance follows from it, and the fit uses the velocities for which it has a
    deviation. Otherwise the fit uses poses alone, and the covariance follows from their residuals.

    Raises:
        InvalidFieldError: there are fewer than `FEWEST_STATES` states, their stamps do not ascend, the window
            is so long that neighbours of the motion part beyond the range of doubles, or gravity is not
            three finite numbers.
        TooLargeError: more than `MOST_STATES` states.
    """
    if len(states) < FEWEST_STATES:
        raise InvalidFieldError("states", f"{len(states)} states", f"at least {FEWEST_STATES}")
    if len(states) > MOST_STATES:
        raise TooLargeError("states", f"{len(states)} states", f"at most {MOST_STATES}")
    newest = states[-1].stamp_ns
    since_newest = [state.stamp_ns - newest for state in states]
    for earlier, later in itertools.pairwise(since_newest):
        if earlier >= later:
            raise InvalidFieldError("states", f"stamps {later - earlier} ns apart", "> 0")
    seconds = seconds_since(0, since_newest)
    gravity = check_array("gravity_W", gravity_W, (3,))
    place = _fit_place(states, seconds, gravity, noise)
    spin = _fit_rotation(body, states, seconds, noise)
    covariance = np.zeros((12, 12))
    at_place, at_spin = np.r_[0:3, 6:9], np.r_[3:6, 9:12]
    covariance[np.ix_(at_place, at_place)] = np.kron(place.covariance, np.eye(3))
    covariance[np.ix_(at_spin, at_spin)] = spin.covariance
    q_WB, w_WB_W = spin.motion.state.q_WB, spin.motion.state.w_WB_W
    return FitResult(
        state=BodyState(p_WB_W=place.p_W, q_WB=q_WB, v_WB_W=place.v_W, w_WB_W=w_WB_W, stamp_ns=newest),
        covariance=covariance,
        by_gravity=place.by_gravity,
        position_residual=place.residual,
        orientation_residual=spin.residual,
        count=len(states),
        rounds=spin.rounds,
        converged=spin.converged,
        position_misses_W=place.misses_W,
        orientation_misses_W=spin.misses_W,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    p_W: FloatArray
    v_W: FloatArray
    covariance: FloatArray  # (2, 2), of a coordinate and its rate
    by_gravity: tuple[float, float]  # s^2, s
    residual: float
    misses_W: FloatArray  # (n, 3), m


def _fit_place(
    states: Sequence[BodyState], seconds: FloatArray, gravity: FloatArray, noise: StateNoise | None
) -> _Place:
    """Fit the parabola p + v t + g t^2 / 2, in coordinates that start at the newest position."""
    origin = states[-1].p_WB_W
    positions = np.array([state.p_WB_W for state in states]) - origin
    fallen = positions - 0.5 * np.square(seconds)[:, None] * gravity
    span = -float(seconds[0])
    design = np.column_stack([np.ones_like(seconds), seconds / span])
    weight = 1.0 if noise is None else 1.0 / noise.position
    # the last column is the change of all values with a component of gravity
    values = weight * np.column_stack([fallen, -0.5 * np.square(seconds)])
    design = weight * design
    if noise is not None and noise.linear_velocity is not None:
        velocities = np.array([state.v_WB_W for state in states]) - seconds[:, None] * gravity
        velocities = np.column_stack([velocities, -seconds])
        slopes = np.column_stack([np.zeros_like(seconds), np.full_like(seconds, 1.0 / span)])
        design = np.vstack([design, slopes / noise.linear_velocity])
        values = np.vstack([values, velocities / noise.linear_velocity])
    orthogonal, triangle = np.linalg.qr(design)
    inverse = np.linalg.inv(triangle)
    solution = inverse @ (orthogonal.T @ values)
    by_gravity = (float(solution[0, 3]), float(solution[1, 3]) / span)
    solution = solution[:, :3]
    misses = fallen - solution[0] - (seconds / span)[:, None] * solution[1]
    total = float(np.square(misses).sum())
    scale = np.diag([1.0, 1.0 / span])
    variance = total / (3 * len(seconds) - 6) if noise is None else 1.0
    return _Place(
        p_W=origin + solution[0],
        v_W=solution[1] / span,
        covariance=variance * scale @ inverse @ inverse.T @ scale,
        by_gravity=by_gravity,
        residual=math.sqrt(total / len(seconds)),
        misses_W=misses,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Rotation:
    motion: FreeMotion
    covariance: FloatArray  # (6, 6)
    residual: float
    misses_W: FloatArray  # (n, 3), rad
    rounds: int
    converged: bool


def _fit_rotation(
    body: MassProperties, states: Sequence[BodyState], seconds: FloatArray, noise: StateNoise | None
) -> _Rotation:
    measured = np.array([state.q_WB for state in states])
    rates = np.array([state.w_WB_W for state in states])
    by_q = 1.0 if noise is None else 1.0 / noise.orientation
    by_w = 0.0 if noise is None or noise.angular_velocity is None else 1.0 / noise.angular_velocity

    def misses(motion: FreeMotion) -> FloatArray:
        then = motion.at(seconds)
        weighted = (by_q * rotation_vectors(measured, then.q_WB)).ravel()
        return np.concatenate([weighted, (by_w * (rates - then.w_WB_W)).ravel()]) if by_w else weighted

    def derivatives(motion: FreeMotion) -> FloatArray:
        each = rotation_derivatives(motion, seconds)
        if not np.isfinite(each).all():
            raise InvalidFieldError(
                "states", f"{-seconds[0]:g} s", "a window over which the motion is predictable"
            )
        design = by_q * each[:, :3].reshape(-1, 6)
        return np.vstack([design, by_w * each[:, 3:].reshape(-1, 6)]) if by_w else design

    def moved(motion: FreeMotion, step: FloatArray) -> FreeMotion:
        q_WB = turned(motion.state.q_WB[None], step[None, :3])[0]
        return _motion_from(body, q_WB, motion.state.w_WB_W + step[3:])

    starts = [
        _motion_from(body, measured[-1], rate)
        for rate in (_averaged_rate(body, measured, seconds), _last_rate(measured, seconds))
    ]
    start = min(starts, key=lambda motion: float(np.square(misses(motion)).sum()))
    attitudes = 3 * len(seconds)
    negligible = np.full(2 * attitudes if by_w else attitudes, math.inf)
    negligible[:attitudes] = by_q * SMALL_STEP
    fit = gauss_newton(
        start, misses_of=misses, derivatives_of=derivatives, moved=moved, negligible=negligible
    )
    turns = fit.misses[:attitudes].reshape(-1, 3) / by_q
    total = float(np.square(fit.misses[:attitudes]).sum()) / by_q**2
    variance = total / (attitudes - 6) if noise is None else 1.0
    covariance = variance * fit.inverse @ fit.inverse.T
    return _Rotation(fit.model, covariance, math.sqrt(total / len(seconds)), turns, fit.rounds, fit.converged)


def _motion_from(body: MassProperties, q_WB: FloatArray, w_WB_W: FloatArray) -> FreeMotion:
    """Return a motion with this rotation and a resting centre of mass, whose path is fitted separately."""
    state = BodyState(p_WB_W=np.zeros(3), q_WB=q_WB, v_WB_W=np.zeros(3), w_WB_W=w_WB_W)
    return free_motion(body, state, gravity_W=np.zeros(3), precision=Precision.DOUBLE)


def _averaged_rate(body: MassProperties, q: FloatArray, seconds: FloatArray) -> FloatArray:
    """Return the angular velocity, (3,), at the newest state for L averaged over all neighbouring pairs.

    Between neighbours a body turns about almost one axis: w is the turn over the time, at the attitude
    halfway. The weights, squares of the time, are those of the noise of orientations.
    """
    turns = rotation_vectors(q[1:], q[:-1])
    between = np.diff(seconds)
    halfway = matrices_of(turned(q[:-1], 0.5 * turns))
    L = np.einsum("nij,jk,nlk,nl->ni", halfway, body.I_B, halfway, turns * between[:, None])
    R = matrices_of(q[-1:])[0]
    rate: FloatArray = R @ np.linalg.solve(body.I_B, R.T @ (L.sum(axis=0) / (between @ between)))
    return rate


def _last_rate(q: FloatArray, seconds: FloatArray) -> FloatArray:
    """Return the angular velocity, (3,), of the last turn.

    It is noisier than the rate from L. A needle is the exception, because the spin about its own axis is the
    smallest part of L.
    """
    rate: FloatArray = rotation_vectors(q[-1:], q[-2:-1])[0] / (seconds[-1] - seconds[-2])
    return rate
