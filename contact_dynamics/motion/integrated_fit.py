# SPDX-License-Identifier: Apache-2.0
"""Fits a motion under torque and drag to a short window of published states.

Model: a body moves under gravity, a constant wrench, drag and a user's function (`motion.integrated`), and is
measured at n times with the noise of `state_noise`. All twelve numbers of the newest state are estimated
together, because a force that rotates with the body couples path and attitude. The Gauss-Newton method uses
the derivatives of the integrated motion (`contact_dynamics.motion.integrated_derivative`), and starts from
the free motion that fits best. `whole_turns` determines the number of whole turns between the states.

Not covered: unknown forces, outliers, contacts that change the velocity slowly, unknown mass properties, and
what `whole_turns` does not cover.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.motion.flight_check import is_held, velocity_jump
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH, ConstantWrench, Drag
from contact_dynamics.motion.free_fit import MAX_STATES, FitResult, fit_free_motion
from contact_dynamics.motion.integrated import MAX_STEPS, ForcedMotion, forced_motion, turns_or_drags
from contact_dynamics.motion.integrated_derivative import forced_state_derivatives
from contact_dynamics.motion.state_noise import (
    StateNoise,
    average_covariance,
    scaled,
    variance_factor,
    whitened,
)
from contact_dynamics.motion.whole_turns import Window, chosen_motion
from contact_dynamics.numerics.gauss_newton import Fit, gauss_newton
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
from contact_dynamics.rotations.many import rotation_vectors, turned
from contact_dynamics.tolerances import LEAST_NOISE, SMALL_STEP
from contact_dynamics.validation import FloatArray, check_array, check_magnitude

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.motion.forces import WrenchFunction

PASSES: Final = 3
"""Number of passes for unknown noise, whose size is estimated from residuals. Those of the free motion may be
too large, those of the first pass are nearly correct, and the covariance uses those of the second."""


def fit_motion(
    body: HasMassProperties,
    states: Sequence[BodyState],
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    wrench: ConstantWrench = NO_WRENCH,
    drag: Drag = NO_DRAG,
    wrench_of: WrenchFunction | None = None,
    noise: StateNoise | None = None,
    max_steps: int = MAX_STEPS,
) -> FitResult:
    """Return the best fit of a motion under given forces to ``states``, which are in the order of time.

    If `contact_dynamics.motion_of` uses the closed form, this is `fit_free_motion`. The seconds of
    ``wrench_of`` are relative to the newest state, and ``max_steps`` is as in `forced_motion`. If ``noise``
    is given, the covariance follows from it, and the fit uses those velocities for which the noise contains a
    deviation. Otherwise, the fit uses poses alone, and the covariance is an average over correlation times,
    which positions and orientations then share (`state_noise`).

    Raises:
        InvalidFieldError, TooLargeError: as for `fit_free_motion` and `forced_motion`, and if the motion
            grows without bounds into the past within the window.
    """
    body = body.mass_properties
    gravity = check_magnitude("gravity_W", check_array("gravity_W", gravity_W, (3,)))
    if not turns_or_drags(wrench, drag, wrench_of):
        return fit_free_motion(body, states, gravity_W=gravity + wrench.force / body.mass, noise=noise)
    free = fit_free_motion(body, states, gravity_W=gravity, noise=noise)
    motion = forced_motion(
        body,
        free.state,
        gravity_W=gravity,
        wrench=wrench,
        drag=drag,
        wrench_of=wrench_of,
        max_steps=max_steps,
    )
    position, orientation = free.position_residual, free.orientation_residual
    window = _Seen(
        body, states, noise or _noise_of(position, orientation, len(states)), noise_is_known=noise is not None
    )
    others = [*free.alternatives, replace(free.state, w_WB_W=states[-1].w_WB_W)]
    chosen = chosen_motion(window, motion, [motion.from_state(state) for state in others])
    fit, converged = chosen.fit, chosen.converged
    for _ in range(0 if noise else PASSES - 1):
        position, orientation = window.residuals(fit.model)
        window = _Seen(body, states, _noise_of(position, orientation, len(states)), noise_is_known=False)
        fit = window.fitted(fit.model, len(states))
        converged = converged and fit.converged
    position, orientation = window.residuals(fit.model)
    misses = window.misses(fit.model)
    factor = 1.0
    if noise is None:
        covariance = average_covariance(
            window.derivatives(fit.model), fit.misses.reshape(len(states), -1, 1), window.seconds
        )
    else:
        factor = variance_factor(noise, float(fit.misses @ fit.misses), len(fit.misses) - 12)
        covariance = factor * fit.inverse @ fit.inverse.T
    jump = velocity_jump(window.seconds, misses[:, :3])
    falls = not is_held(window.seconds, misses[:, :3], gravity)
    return FitResult(
        state=fit.model.state,
        covariance=covariance,
        position_residual=position,
        orientation_residual=orientation,
        count=len(states),
        rounds=fit.rounds,
        converged=converged and jump is None and falls,
        velocity_jump=jump,
        falls=falls,
        noise=None if noise is None else scaled(noise, factor, factor),
        turns_known=chosen.turns_known,
        alternatives=chosen.alternatives,
        position_misses_W=misses[:, :3],
        orientation_misses_W=misses[:, 3:6],
    )


def _noise_of(position_residual: float, orientation_residual: float, count: int) -> StateNoise:
    """Return the noise of each component estimated from the residuals of ``count`` poses."""
    # Residuals are root mean squares of vectors, and six numbers are fitted to each.
    share = math.sqrt(count / (3 * count - 6))
    return StateNoise(
        position=max(share * position_residual, LEAST_NOISE),
        orientation=max(share * orientation_residual, LEAST_NOISE),
    )


class _Seen(Window[ForcedMotion]):
    """The published states, as arrays, with the methods that fit a motion to them."""

    unknowns = 12

    def __init__(
        self, body: MassProperties, states: Sequence[BodyState], noise: StateNoise, *, noise_is_known: bool
    ) -> None:
        super().__init__(body, states)
        self.p = np.array([state.p_WB_W for state in states])
        self.v = np.array([state.v_WB_W for state in states])
        deviations = (noise.position, noise.orientation, noise.linear_velocity, noise.angular_velocity)
        self._used = np.repeat([deviation is not None for deviation in deviations], 3)
        self._weights = 1.0 / np.repeat([deviation or 1.0 for deviation in deviations], 3)[self._used]
        self._times = noise.position_time, noise.orientation_time
        self._negligible = np.where(np.arange(12) < 6, SMALL_STEP, math.inf)[self._used] * self._weights
        self.by_q = 1.0 / noise.orientation
        self.noise_is_known = noise_is_known
        self.rates_weigh = noise.angular_velocity is not None

    def misses(self, motion: ForcedMotion, count: int = MAX_STATES) -> FloatArray:
        """Return measured minus computed states, (n, 12), of the last ``count`` states."""
        then = self.at(motion, min(count, len(self.seconds)))
        return np.hstack(
            [
                self.p[-count:] - then.p_WB_W,
                rotation_vectors(self.q[-count:], then.q_WB),
                self.v[-count:] - then.v_WB_W,
                self.w[-count:] - then.w_WB_W,
            ]
        )

    def residuals(self, motion: ForcedMotion) -> tuple[float, float]:
        """Return the root mean square distance, m, and angle, rad."""
        squares = np.square(self.misses(motion))
        n = len(self.seconds)
        return math.sqrt(squares[:, :3].sum() / n), math.sqrt(squares[:, 3:6].sum() / n)

    def fitted(self, start: ForcedMotion, count: int) -> Fit[ForcedMotion]:
        """Return the fit to the last ``count`` states, of the components whose noise has a deviation."""

        def moved(motion: ForcedMotion, step: FloatArray) -> ForcedMotion:
            state = motion.state
            return motion.from_state(
                BodyState(
                    p_WB_W=state.p_WB_W + step[:3],
                    q_WB=turned(state.q_WB[None], step[None, 3:6])[0],
                    v_WB_W=state.v_WB_W + step[6:9],
                    w_WB_W=state.w_WB_W + step[9:],
                    stamp_ns=state.stamp_ns,
                )
            )

        return gauss_newton(
            start,
            misses_of=lambda motion: self._white(self.misses(motion, count)).ravel(),
            derivatives_of=lambda motion: self.derivatives(motion, count).reshape(-1, 12),
            moved=moved,
            negligible=np.tile(self._negligible, count),
        )

    def derivatives(self, motion: ForcedMotion, count: int = MAX_STATES) -> FloatArray:
        """Return the derivatives of the whitened residuals' computed part, (n, used, 12)."""
        return self._white(forced_state_derivatives(motion, self.seconds[-count:]))

    def _white(self, rows: FloatArray) -> FloatArray:
        """Return rows (n, 12, ...) of the components used, in deviations and without correlation in time."""
        seconds = self.seconds[-len(rows) :]
        parts = [
            whitened(rows[:, :3], seconds, self._times[0]),
            whitened(rows[:, 3:6], seconds, self._times[1]),
        ]
        white = np.concatenate([*parts, rows[:, 6:]], axis=1)[:, self._used]
        weighted: FloatArray = self._weights.reshape((-1,) + (1,) * (rows.ndim - 2)) * white
        return weighted

    def with_rate(self, model: ForcedMotion, rate: FloatArray) -> ForcedMotion:
        """Return the motion with another angular velocity at the newest state."""
        return model.from_state(replace(model.state, w_WB_W=rate))
