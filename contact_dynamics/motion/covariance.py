# SPDX-License-Identifier: Apache-2.0
"""Propagates the covariance of a body's state along a free or a forced motion.

Covariances are (12, 12), in the order position (m), rotation vector (rad, world axes, a small rotation
applied after the attitude: R_true = Exp(theta) R), linear velocity (m/s), angular velocity (rad/s, world
axes). There are two methods. The first takes the exact derivative J of the motion, C(t) = J C J^T. It is
cheap, and right as long as the body's possible states stay close together. The second draws many states from
C and computes the motion of each.

The orientation of a tumbling body becomes unpredictable: its deviation grows with time, and exponentially
near the middle axis. A linear covariance grows without bounds, although an orientation is at most unknown.
Both methods therefore report from which time on small rotations do not describe it
(`CarriedCovariance.trusted`).

Sampled deviations are relative to the motion of the given state, with which callers predict, and include its
bias. The samples are drawn in opposite pairs and scaled to have exactly the given covariance, so that both
methods agree to rounding if the motion is linear.

Not covered: uncertain mass properties and process noise. `contact_dynamics.tumbling.flips` computes the
uncertainty of the times of flips.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.motion.free_derivative import state_derivatives
from contact_dynamics.motion.integrated import ForcedMotion
from contact_dynamics.motion.integrated_derivative import forced_state_derivatives
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties
from contact_dynamics.rotations.many import rotation_vectors, turned
from contact_dynamics.tolerances import LARGEST_NUMBER, NEGATIVE_VARIANCE_TOLERANCE
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion
from contact_dynamics.tumbling.poinsot_construction import polhode_period
from contact_dynamics.validation import FloatArray, check_array, check_magnitude, check_whole
from contact_dynamics.validation_batches import check_covariance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

TRUSTED_DEVIATION: Final = 0.1
"""Largest trusted standard deviation of orientation, rad. Linearisation leaves out squares of deviations. At
this limit, compared with samples, they are less than 1 % of the largest deviation, and up to a third of the
variance in directions in which neighbours hardly part."""

PROBES: Final = 64
"""Number of times on the way at which growth is checked, over one period of the polhode. Over a part of it
there are as many fewer, but two at least."""

MAX_SAMPLES: Final = 100_000
"""Largest number of draws. Each is a motion of its own, and takes some 0.1 ms."""

FEWEST_SAMPLES: Final = 50
"""Least number of draws. Scaling them by their own covariance, (12, 12), needs more than 12 pairs."""


class PropagationMethod(enum.Enum):
    """Method by which a covariance is propagated."""

    LINEARISED = "linearised"
    SAMPLED = "sampled"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CarriedCovariance(Record):
    """Covariance of a body's state at n times.

    Attributes:
        seconds: (n,), s after the stamp of the initial state.
        covariances: (n, 12, 12), in the order of this module, with NaN where a number overflows.
        orientation_deviations: (n,), rad, largest standard deviation of the orientation about any axis.
        trusted: (n,), whether that deviation has remained below TRUSTED_DEVIATION since time 0.
        method: Method of propagation.
    """

    seconds: FloatArray
    covariances: FloatArray
    orientation_deviations: FloatArray
    trusted: NDArray[np.bool_]
    method: PropagationMethod


def propagate_covariance(
    body: HasMassProperties,
    state: BodyState,
    covariance: ArrayLike,
    times: ArrayLike,
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    gravity_covariance_W: ArrayLike | None = None,
    by_gravity: tuple[float, float] = (0.0, 0.0),
    method: PropagationMethod = PropagationMethod.LINEARISED,
) -> CarriedCovariance:
    """Return the covariance at times (n,), s after the state's stamp and of either sign.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: State at the stamp.
        covariance: (12, 12), covariance of the state, in the order of `state_derivatives`.
        times: (n,), s.
        gravity_W: (3,), m/s^2, world axes.
        gravity_covariance_W: (3, 3), m^2/s^4, covariance of gravity in world axes, whose tilt may differ from
            recording to recording. If None, gravity is exact.
        by_gravity: s^2 and s, derivatives of the estimated position and velocity with respect to gravity, as
            in `FitResult.by_gravity`.
        method: Method of propagation.

    Raises:
        InvalidFieldError: a matrix is not a covariance (see `check_covariance`), the times are not a flat
            list of finite numbers, or gravity is not three finite numbers.
    """
    motion = free_motion(body, state, gravity_W=gravity_W)
    carried = covariance_along(motion, covariance, times, method=method)
    if gravity_covariance_W is None:
        return carried
    pull = check_covariance("gravity_covariance_W", gravity_covariance_W, 3)
    place, rate = check_magnitude("by_gravity", check_array("by_gravity", by_gravity, (2,)))
    seconds = carried.seconds
    fallen = np.zeros((len(seconds), 12, 3))
    fallen[:, 0:3] = (place + seconds * (rate + 0.5 * seconds))[:, None, None] * np.eye(3)
    fallen[:, 6:9] = (rate + seconds)[:, None, None] * np.eye(3)
    return replace(carried, covariances=carried.covariances + fallen @ pull @ fallen.transpose(0, 2, 1))


def covariance_along(
    motion: FreeMotion | ForcedMotion,
    covariance: ArrayLike,
    times: ArrayLike,
    *,
    method: PropagationMethod = PropagationMethod.LINEARISED,
    samples: int = 400,
    seed: int = 0,
) -> CarriedCovariance:
    """Return the covariance of the state along a given motion, as `propagate_covariance` does.

    The covariance refers to fixed times, and does not contain the standard deviation of the time of an event
    such as a landing. ``samples`` and ``seed`` have an effect only if the covariance is sampled.

    Raises:
        InvalidFieldError: `propagate_covariance` rejects an argument, or the number of samples is not from
            `FEWEST_SAMPLES` to `MAX_SAMPLES`.
    """
    start = check_covariance("covariance", covariance)
    farthest = motion.farthest if isinstance(motion, FreeMotion) else LARGEST_NUMBER
    seconds = check_magnitude("times", check_array("times", times, (None,)), farthest)
    probes = _probes(motion, seconds)
    if method is PropagationMethod.LINEARISED:
        everywhere = _linearised(motion, start, np.concatenate([seconds, probes]))
        covariances, on_the_way = (
            everywhere[: len(seconds)],
            orientation_deviations(everywhere[len(seconds) :]),
        )
    else:
        samples = check_whole("samples", samples, FEWEST_SAMPLES, MAX_SAMPLES)
        draws = _draws(start, samples, check_whole("seed", seed, 0))
        covariances = _sampled(motion, start, seconds, draws=draws)
        on_the_way = orientation_deviations(_linearised(motion, start, probes))
    deviations = orientation_deviations(covariances)
    return CarriedCovariance(
        seconds=seconds,
        covariances=covariances,
        orientation_deviations=deviations,
        trusted=_trusted(np.concatenate([seconds, probes]), np.concatenate([deviations, on_the_way]))[
            : len(seconds)
        ],
        method=method,
    )


def _linearised(motion: FreeMotion | ForcedMotion, start: FloatArray, seconds: FloatArray) -> FloatArray:
    if isinstance(motion, ForcedMotion):
        J = forced_state_derivatives(motion, seconds)
    else:
        J = state_derivatives(motion, seconds)
    return _symmetric(J @ start @ J.transpose(0, 2, 1))


def _draws(start: FloatArray, samples: int, seed: int) -> FloatArray:
    """Return deviations of the state, (m, 12), in opposite pairs, whose mean square is ``start``."""
    scale = np.sqrt(start.diagonal())
    scale[scale == 0.0] = 1.0
    variances, directions = np.linalg.eigh(start / np.outer(scale, scale))
    matter = variances > NEGATIVE_VARIANCE_TOLERANCE
    root = scale[:, None] * directions[:, matter] * np.sqrt(variances[matter])
    normal = np.random.default_rng(seed).standard_normal((samples // 2, int(matter.sum())))
    lower = np.linalg.cholesky(normal.T @ normal / len(normal))
    unit = np.linalg.solve(lower, normal.T).T
    half: FloatArray = unit @ root.T
    return np.concatenate([half, -half])


def _sampled(
    motion: FreeMotion | ForcedMotion, start: FloatArray, seconds: FloatArray, *, draws: FloatArray
) -> FloatArray:
    """Return the mean squares of deviations from ``motion``, (n, 12, 12)."""
    state, center = motion.state, motion.at(seconds)
    attitudes = turned(np.tile(state.q_WB, (len(draws), 1)), draws[:, 3:6])
    covariances = np.zeros((len(seconds), *start.shape))
    for draw, q_WB in zip(draws, attitudes, strict=True):
        other = BodyState(
            p_WB_W=state.p_WB_W + draw[:3],
            q_WB=q_WB,
            v_WB_W=state.v_WB_W + draw[6:9],
            w_WB_W=state.w_WB_W + draw[9:],
        )
        then = _from_state(motion, other).at(seconds)
        deviation = np.hstack(
            [
                then.p_WB_W - center.p_WB_W,
                rotation_vectors(then.q_WB, center.q_WB),
                then.v_WB_W - center.v_WB_W,
                then.w_WB_W - center.w_WB_W,
            ]
        )
        covariances += deviation[:, :, None] * deviation[:, None, :]
    return covariances / len(draws)


def _from_state(motion: FreeMotion | ForcedMotion, state: BodyState) -> FreeMotion | ForcedMotion:
    if isinstance(motion, ForcedMotion):
        return motion.from_state(state)
    return free_motion(motion.body, state, gravity_W=motion.gravity_W, precision=Precision.DOUBLE)


def _probes(motion: FreeMotion | ForcedMotion, seconds: FloatArray) -> FloatArray:
    """Return times up to ``seconds``: those of the integrator, or in closed form those of one period.

    The growth of each period is the same, and adds up.
    """
    ends = float(seconds.max(initial=0.0)), float(seconds.min(initial=0.0))
    if isinstance(motion, ForcedMotion):
        return np.concatenate([motion.steps_to(end) for end in ends])
    period = polhode_period(motion.rotation)
    if not math.isfinite(period):
        return np.concatenate([np.zeros(1), *(np.linspace(0.0, end, PROBES) for end in ends if end)])
    ends = min(ends[0], period), max(ends[1], -period)
    spaced = (np.linspace(0.0, end, max(math.ceil(abs(end) / period * PROBES), 2)) for end in ends if end)
    return np.concatenate([np.zeros(1), *spaced])


def orientation_deviations(covariances: FloatArray) -> FloatArray:
    """Return the largest standard deviations of orientation, (n,), rad, of covariances, (n, 12, 12).

    They are infinite where they exceed the range of doubles.
    """
    finite = np.isfinite(covariances).all(axis=(1, 2))
    deviations = np.full(len(covariances), math.inf)
    variances = np.linalg.eigvalsh(covariances[finite, 3:6, 3:6])[:, 2]
    deviations[finite] = np.sqrt(np.maximum(variances, 0.0))
    return deviations


def _trusted(seconds: FloatArray, deviations: FloatArray) -> NDArray[np.bool_]:
    """Return whether deviations, (n,), have remained below the limit since time 0."""
    lost = deviations > TRUSTED_DEVIATION
    first = float(seconds[lost & (seconds >= 0.0)].min(initial=math.inf))
    last = float(seconds[lost & (seconds <= 0.0)].max(initial=-math.inf))
    trusted: NDArray[np.bool_] = (seconds < first) & (seconds > last)
    return trusted


def _symmetric(matrices: FloatArray) -> FloatArray:
    halved: FloatArray = 0.5 * (matrices + np.swapaxes(matrices, -1, -2))
    return halved
