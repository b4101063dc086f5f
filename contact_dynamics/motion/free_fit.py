# SPDX-License-Identifier: Apache-2.0
"""Fits a free motion to a short window of published states, to avoid the noise of a single velocity.

Model: a torque-free body in uniform gravity (`contact_dynamics.tumbling`) is measured at n times, with the
noise of `state_noise`. The path of the centre of mass is a linear least-squares problem. The rotation has six
unknowns, attitude and angular velocity at the newest stamp, which the Gauss-Newton method finds with the
exact derivatives of the motion (`free_derivative`). It starts from the angular momentum, which is constant,
averaged over all neighbouring pairs of states, or if that is far off, from the last turn or the published
velocities, whichever fits best. `whole_turns` determines the number of whole turns between the states, and
`velocity_jump` detects an impact within the window, which no free motion fits.

Not covered: contacts that change the velocity slowly, torque and drag (`integrated_fit`), outliers, unknown
mass properties, and what `whole_turns` does not cover.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W, seconds_since
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.motion.flight_check import is_held, velocity_jump
from contact_dynamics.motion.free_derivative import derivatives_along
from contact_dynamics.motion.state_noise import (
    StateNoise,
    average_covariance,
    scaled,
    variance_factor,
    whitened,
)
from contact_dynamics.motion.whole_turns import (
    MAX_NOISE_RATIO,
    MAX_ORIENTATION_RESIDUAL,
    Chosen,
    Window,
    chosen_motion,
    turns_near,
)
from contact_dynamics.numerics.gauss_newton import Fit, gauss_newton
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
from contact_dynamics.rotations.many import matrices_of, rotation_vectors, turned
from contact_dynamics.tolerances import SMALL_STEP
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion
from contact_dynamics.validation import FloatArray, check_array, check_magnitude

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import ArrayLike

FEWEST_STATES: Final = 3
"""Minimum number of states. Twelve unknowns would fit two poses exactly, including their noise."""

MAX_STATES: Final = 2000
"""Maximum number of states, a window of seconds. More would take too long."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FitResult(Record):
    """Fitted state at the latest stamp, with the quality of the fit.

    Attributes:
        state: Fitted state at the latest stamp.
        covariance: (12, 12), covariance of position, rotation vector (world, applied after the attitude),
            linear and angular velocity.
        position_residual: m, root-mean-square distance of the positions.
        orientation_residual: rad, root-mean-square angle between the orientations.
        count: Number of states.
        rounds: Number of iterations of the Gauss-Newton method.
        converged: Whether the last iteration changed next to nothing, and the residuals are consistent with
            the noise: their root mean square is at most three given deviations or, without a given noise, the
            orientation residual is at most 0.1 rad. It is false if the velocity jumps, or if the body does
            not fall freely.
        position_misses_W: (count, 3), m, positions minus fitted positions, world axes.
        orientation_misses_W: (count, 3), rad, rotation vectors from the fitted attitudes to those of the
            states, world axes.
        by_gravity: Derivatives of the fitted position (s^2) and velocity (s) with respect to gravity, in each
            component. A fit to positions over a time T has about T^2 / 12 and T / 2. None means that they are
            unknown, as under wrenches.
        turns_known: Whether the published angular velocities exclude motions with a different number of whole
            turns between states. They do if their errors are less than a third of a turn per interval.
            Without angular velocities, or if all are zero although the body rotates, the fit assumes the
            fewest turns that are consistent with the states, and other numbers of turns are possible.
        alternatives: Other states at the latest stamp whose motions fit equally well. ``state`` and its
            covariance are meaningless if one of them may be true.
        velocity_jump: Time of a jump of the velocity, as in an impact, s relative to the latest stamp, < 0.
            None if the positions show no jump.
        falls: Whether the positions accelerate as in flight, at least by half of gravity. It is false if the
            body rests, slides or is carried.
        noise: The given noise, whose standard deviations of poses are those of this window: residuals update
            them if the degrees of freedom are finite. None if no noise was given.
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
    turns_known: bool = True
    alternatives: tuple[BodyState, ...] = ()
    velocity_jump: float | None = None
    falls: bool = True
    noise: StateNoise | None = None


def fit_free_motion(
    body: HasMassProperties,
    states: Sequence[BodyState],
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    noise: StateNoise | None = None,
) -> FitResult:
    """Return the best fit of a free motion to ``states``, which are in the order of time.

    If ``noise`` is given, the covariance follows from it, and the fit uses those velocities for which the
    noise contains a deviation. Otherwise, the fit uses poses alone, and the covariance is an average over
    correlation times of their noise, weighted by the residuals (`state_noise`). In both cases, published
    angular velocities determine the number of whole turns between states. If neither they nor the poses
    determine it, `FitResult.turns_known` is false.

    Raises:
        InvalidFieldError: there are fewer than `FEWEST_STATES` states, their stamps are not ascending, the
            window is so long that neighbouring motions diverge beyond the range of doubles, or gravity is not
            three finite numbers.
        TooLargeError: there are more than `MAX_STATES` states.
    """
    body = body.mass_properties
    if len(states) < FEWEST_STATES:
        raise InvalidFieldError("states", f"{len(states)} states", f"at least {FEWEST_STATES} states")
    if len(states) > MAX_STATES:
        raise TooLargeError("states", f"{len(states)} states", f"at most {MAX_STATES}")
    newest = states[-1].stamp_ns
    since_newest = [state.stamp_ns - newest for state in states]
    for earlier, later in itertools.pairwise(since_newest):
        if earlier >= later:
            raise InvalidFieldError("states", f"stamps {later - earlier} ns apart", "more than 0 ns apart")
    seconds = seconds_since(0, since_newest)
    gravity = check_magnitude("gravity_W", check_array("gravity_W", gravity_W, (3,)))
    place = _fit_place(states, seconds, gravity, noise)
    jump = velocity_jump(seconds, place.misses_W)
    falls = not is_held(seconds, place.misses_W, gravity)
    flies = jump is None and falls
    spin = _fit_rotation(body, states, noise, search=flies)
    covariance = np.zeros((12, 12))
    at_place, at_spin = np.r_[0:3, 6:9], np.r_[3:6, 9:12]
    covariance[np.ix_(at_place, at_place)] = np.kron(place.covariance, np.eye(3))
    covariance[np.ix_(at_spin, at_spin)] = spin.covariance
    state, *alternatives = (
        BodyState(p_WB_W=place.p_W, q_WB=each.q_WB, v_WB_W=place.v_W, w_WB_W=each.w_WB_W, stamp_ns=newest)
        for each in (spin.motion.state, *spin.alternatives)
    )
    return FitResult(
        state=state,
        covariance=covariance,
        by_gravity=place.by_gravity,
        position_residual=place.residual,
        orientation_residual=spin.residual,
        count=len(states),
        rounds=spin.rounds,
        converged=spin.converged and place.fits_noise and flies,
        velocity_jump=jump,
        falls=falls,
        noise=None if noise is None else scaled(noise, place.factor, spin.factor),
        turns_known=spin.turns_known,
        alternatives=tuple(alternatives),
        position_misses_W=place.misses_W,
        orientation_misses_W=spin.misses_W,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    p_W: FloatArray
    v_W: FloatArray
    covariance: FloatArray  # (2, 2), of a coordinate and its rate
    factor: float  # of the given variances
    by_gravity: tuple[float, float]  # s^2, s
    residual: float
    misses_W: FloatArray  # (n, 3), m
    fits_noise: bool


def _fit_place(
    states: Sequence[BodyState], seconds: FloatArray, gravity: FloatArray, noise: StateNoise | None
) -> _Place:
    """Fit the parabola p + v t + g t^2 / 2, in coordinates that start at the newest position."""
    origin = states[-1].p_WB_W
    positions = np.array([state.p_WB_W for state in states]) - origin
    fallen = positions - 0.5 * np.square(seconds)[:, None] * gravity
    span = -float(seconds[0])
    powers = np.column_stack([np.ones_like(seconds), seconds / span])
    # the last column is the change of all values with a component of gravity
    values = np.column_stack([fallen, -0.5 * np.square(seconds)])
    design = powers
    if noise is not None:
        design = whitened(powers, seconds, noise.position_time) / noise.position
        values = whitened(values, seconds, noise.position_time) / noise.position
    if noise is not None and noise.linear_velocity is not None:
        velocities = np.array([state.v_WB_W for state in states]) - seconds[:, None] * gravity
        velocities = np.column_stack([velocities, -seconds])
        slopes = np.column_stack([np.zeros_like(seconds), np.full_like(seconds, 1.0 / span)])
        design = np.vstack([design, slopes / noise.linear_velocity])
        values = np.vstack([values, velocities / noise.linear_velocity])
    orthogonal, triangle = np.linalg.qr(design)
    inverse = np.linalg.inv(triangle)
    solution = inverse @ (orthogonal.T @ values)
    cost, free = float(np.square(values - design @ solution)[:, :3].sum()), 3 * (len(values) - 2)
    by_gravity = (float(solution[0, 3]), float(solution[1, 3]) / span)
    solution = solution[:, :3]
    misses = fallen - powers @ solution
    factor = 1.0
    if noise is None:
        covariance = average_covariance(powers[:, None], misses[:, None], seconds)
    else:
        factor = variance_factor(noise, cost, free)
        covariance = factor * inverse @ inverse.T
    scale = np.diag([1.0, 1.0 / span])
    return _Place(
        p_W=origin + solution[0],
        v_W=solution[1] / span,
        covariance=scale @ covariance @ scale,
        factor=factor,
        by_gravity=by_gravity,
        residual=math.sqrt(float(np.square(misses).sum()) / len(seconds)),
        misses_W=misses,
        fits_noise=noise is None or cost <= MAX_NOISE_RATIO**2 * free,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Rotation:
    motion: FreeMotion
    covariance: FloatArray  # (6, 6)
    factor: float  # of the given variances
    residual: float
    misses_W: FloatArray  # (n, 3), rad
    rounds: int
    converged: bool
    turns_known: bool
    alternatives: tuple[BodyState, ...]


def _fit_rotation(
    body: MassProperties,
    states: Sequence[BodyState],
    noise: StateNoise | None,
    *,
    search: bool,
) -> _Rotation:
    """Fit the rotation. Other numbers of turns are tried only if ``search`` is true."""
    window = _Turning(body, states, noise)
    seconds = window.seconds
    if search:
        chosen = chosen_motion(window, _start(window), window.starts())
    else:
        only = window.fitted(_start(window), len(seconds))
        chosen = Chosen(only, converged=False, turns_known=False, alternatives=())
    fit = chosen.fit
    turns = window.turns(fit.model, len(seconds))
    factor = 1.0
    if noise is None:
        design = window.derivatives(fit.model, len(seconds)).reshape(-1, 3, 6)
        covariance = average_covariance(design, turns[:, :, None], seconds)
    else:
        factor = variance_factor(noise, float(fit.misses @ fit.misses), len(fit.misses) - 6)
        covariance = factor * fit.inverse @ fit.inverse.T
    return _Rotation(
        motion=fit.model,
        covariance=covariance,
        factor=factor,
        residual=math.sqrt(float(np.square(turns).sum()) / len(seconds)),
        misses_W=turns,
        rounds=fit.rounds,
        converged=chosen.converged,
        turns_known=chosen.turns_known,
        alternatives=chosen.alternatives,
    )


def _start(window: _Turning) -> FreeMotion:
    """Return the first start that is close enough to all attitudes, or the closest one."""
    count, best, least = len(window.seconds), None, math.inf
    for motion in window.starts():
        misses = window.misses(motion, count)
        if best is None or float(misses @ misses) < least:
            best, least = motion, float(misses @ misses)
        if float(np.square(window.turns(motion, count)).sum()) <= MAX_ORIENTATION_RESIDUAL**2 * count:
            return motion
    assert best is not None  # noqa: S101  for the type checker: there is always a start
    return best


class _Turning(Window[FreeMotion]):
    """Published attitudes and angular velocities, with the methods that fit a rotation to them."""

    unknowns = 6

    def __init__(self, body: MassProperties, states: Sequence[BodyState], noise: StateNoise | None) -> None:
        super().__init__(body, states)
        self.by_q = 1.0 if noise is None else 1.0 / noise.orientation
        self.by_w = 0.0 if noise is None or noise.angular_velocity is None else 1.0 / noise.angular_velocity
        self.time = 0.0 if noise is None else noise.orientation_time
        self.noise_is_known = noise is not None
        self.rates_weigh = self.by_w > 0.0

    def turns(self, motion: FreeMotion, count: int) -> FloatArray:
        """Return the rotation vectors, (count, 3), from computed to the last measured attitudes."""
        return rotation_vectors(self.q[-count:], self.at(motion, count).q_WB)

    def misses(self, motion: FreeMotion, count: int) -> FloatArray:
        """Return the whitened residuals of the last ``count`` states: of all attitudes, and then of rates."""
        weighted = self._white(self.turns(motion, count)).ravel()
        if not self.by_w:
            return weighted
        off = self.w[-count:] - self.at(motion, count).w_WB_W
        return np.concatenate([weighted, (self.by_w * off).ravel()])

    def _white(self, rows: FloatArray) -> FloatArray:
        return self.by_q * whitened(rows, self.seconds[-len(rows) :], self.time)

    def derivatives(self, motion: FreeMotion, count: int) -> FloatArray:
        """Return the derivatives of the computed quantities in the residuals, (m, 6)."""
        each = derivatives_along(motion, self.at(motion, count))
        if not np.isfinite(each).all():
            raise InvalidFieldError(
                "states", f"{-self.seconds[-count]:g} s", "a window over which the motion is predictable"
            )
        design = self._white(each[:, :3]).reshape(-1, 6)
        return np.vstack([design, self.by_w * each[:, 3:].reshape(-1, 6)]) if self.by_w else design

    def fitted(self, start: FreeMotion, count: int) -> Fit[FreeMotion]:
        """Return the fit to the last ``count`` states."""
        negligible = np.full((6 if self.by_w else 3) * count, math.inf)
        negligible[: 3 * count] = self.by_q * SMALL_STEP
        return gauss_newton(
            start,
            misses_of=lambda motion: self.misses(motion, count),
            derivatives_of=lambda motion: self.derivatives(motion, count),
            moved=self._moved,
            negligible=negligible,
        )

    def _moved(self, motion: FreeMotion, step: FloatArray) -> FreeMotion:
        q_WB = turned(motion.state.q_WB[None], step[None, :3])[0]
        return self._motion(q_WB, motion.state.w_WB_W + step[3:])

    def with_rate(self, model: FreeMotion, rate: FloatArray) -> FreeMotion:
        """Return the motion with another angular velocity at the newest state."""
        return self._motion(model.state.q_WB, rate)

    def _motion(self, q_WB: FloatArray, w_WB_W: FloatArray) -> FreeMotion:
        """Return a motion with a resting centre of mass, whose path is fitted separately."""
        state = BodyState(p_WB_W=np.zeros(3), q_WB=q_WB, v_WB_W=np.zeros(3), w_WB_W=w_WB_W)
        return free_motion(self.body, state, gravity_W=np.zeros(3), precision=Precision.DOUBLE)

    def starts(self) -> Iterator[FreeMotion]:
        """Yield motions through the newest attitude, with several estimates of the angular velocity.

        Between neighbouring states, a body turns about nearly one axis, and w is the turn divided by the
        time, at the attitude halfway. The average of L over all neighbours, weighted by the squares of the
        times, is the least noisy estimate, except for a needle, whose spin about its own axis is the smallest
        part of L; its last turn is better. If a body turns by half a turn or more between neighbours, only
        published velocities are close.
        """
        q, between = self.q, np.diff(self.seconds)
        expected = 0.5 * (self.w[1:] + self.w[:-1]) * between[:, None]
        turns, rest = turns_near(q[1:], q[:-1], expected)
        halfway = matrices_of(turned(q[:-1], 0.5 * turns))
        turns = turns + rest
        of_turns = self._momenta(halfway, turns * between[:, None]).sum(axis=0) / (between @ between)
        yield self._motion(q[-1], self._rate(of_turns))
        yield self._motion(q[-1], turns[-1] / between[-1])
        if self.w.any():
            momenta = self._momenta(matrices_of(q), self.w)
            for momentum in (momenta.mean(axis=0), *momenta[-4:]):
                yield self._motion(q[-1], self._rate(momentum))

    def _momenta(self, R: FloatArray, w: FloatArray) -> FloatArray:
        momenta: FloatArray = np.einsum("nij,jk,nlk,nl->ni", R, self.body.I_B, R, w)
        return momenta

    def _rate(self, L: FloatArray) -> FloatArray:
        """Return the angular velocity at the newest state for an angular momentum."""
        R = matrices_of(self.q[-1:])[0]
        rate: FloatArray = R @ np.linalg.solve(self.body.I_B, R.T @ L)
        return rate
