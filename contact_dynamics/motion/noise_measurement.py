# SPDX-License-Identifier: Apache-2.0
"""Estimates the noise of poses from the residuals of recorded flights of one body with one tracker.

Standard deviation, correlation time and degrees of freedom maximise the restricted likelihood of the
residuals (REML; Patterson and Thompson, Biometrika 58, 1971), which accounts for the part of slow errors that
a fit absorbs. Gravity is free in each flight, so that a wrong value does not count as noise.

An error that is constant over a flight is not observable. Correlation times much longer than the flights
therefore fit equally well, and the shortest one that the residuals do not reject is used. Flights whose
residuals exceed the noise of the others by as much as a fit rejects (`whole_turns.MAX_NOISE_RATIO`) are
excluded, because something touched the body in them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W, seconds_since
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.free_derivative import derivatives_along
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.motion.state_noise import LEAST_DEGREES, StateNoise, fit_whitened
from contact_dynamics.motion.whole_turns import MAX_NOISE_RATIO
from contact_dynamics.tolerances import LEAST_NOISE
from contact_dynamics.tumbling import free_motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties
    from contact_dynamics.validation import FloatArray

MIN_FLIGHTS: Final = 10
"""Minimum number of flights. The degrees of freedom describe how the noise differs between flights."""

FEWEST_POSES: Final = 4
"""Minimum number of poses in a flight, whose path has three unknowns in each coordinate."""

SHORTEST: Final = 0.25
"""Shortest correlation time other than 0, in intervals between poses. Neighbours then share 2 %."""

LONGEST: Final = 2.0
"""Longest correlation time, in durations of the longest flight. Longer ones are indistinguishable."""

STEP: Final = 1.25
"""Factor from one correlation time to the next. Hundreds of flights do not determine it better."""

NOT_REJECTED: Final = 2.0
"""Logarithm of the ratio of likelihoods up to which a time is not rejected, at two standard deviations."""

DEGREES: Final = tuple(LEAST_DEGREES + 1.25**k for k in range(32))
"""Degrees of freedom that are tried, from 3 to 1000, which is Gaussian noise. With fewer than 3, the variance
would come from the few flights that are none."""

ROUNDS: Final = 50
"""Rounds of the EM algorithm. Each halves the error, or better where flights have many poses."""


def measured_noise(
    body: HasMassProperties,
    flights: Sequence[Sequence[BodyState]],
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
) -> StateNoise:
    """Return the noise of the poses of recorded ``flights``, each as for `fit_free_motion`.

    The result contains no deviations of velocities, since published velocities are estimates from the poses.

    Raises:
        InvalidFieldError: a free motion fits fewer than `MIN_FLIGHTS` flights of `FEWEST_POSES` poses, or
            `fit_free_motion` rejects an argument.
    """
    places, turns = [], []
    for states in flights:
        fit = fit_free_motion(body, states, gravity_W=gravity_W)
        if len(states) < FEWEST_POSES or not fit.converged:
            continue
        seconds = seconds_since(states[-1].stamp_ns, [state.stamp_ns for state in states])
        powers = np.column_stack([np.ones_like(seconds), seconds, np.square(seconds)])
        places.append((powers[:, None], fit.position_misses_W[:, None], seconds))
        motion = free_motion(body, fit.state, gravity_W=gravity_W)
        design = derivatives_along(motion, motion.at(seconds))[:, :3]
        turns.append((design, fit.orientation_misses_W[:, :, None], seconds))
    used = np.ones(len(places), dtype=bool)
    both = (_Fits(places), _Fits(turns)) if places else ()
    while (count := int(used.sum())) >= MIN_FLIGHTS:
        degrees = max(DEGREES, key=lambda each: sum(fits.best(used, each)[0] for fits in both))
        (_, position, position_time, calm), (_, orientation, orientation_time, steady) = (
            fits.best(used, degrees) for fits in both
        )
        used &= calm & steady
        if used.sum() == count:
            return StateNoise(
                position=position,
                orientation=orientation,
                position_time=position_time,
                orientation_time=orientation_time,
                degrees_of_freedom=degrees,
            )
    found = f"{int(used.sum())} of {len(flights)} that a free motion fits"
    raise InvalidFieldError("flights", found, f"at least {MIN_FLIGHTS}")


class _Fits:
    """Fits to all flights, with each of several correlation times."""

    def __init__(self, windows: list[tuple[FloatArray, FloatArray, FloatArray]]) -> None:
        shortest = SHORTEST * float(np.median(np.concatenate([np.diff(window[2]) for window in windows])))
        longest = LONGEST * max(-float(seconds[0]) for *_, seconds in windows)
        steps = math.ceil(math.log(longest / shortest) / math.log(STEP))
        self.times = [0.0, *(shortest * STEP**k for k in range(steps + 1))]
        fits = [fit_whitened(*window, np.array(self.times)) for window in windows]
        self.costs = np.array([fit.cost for fit in fits]).T
        self.logs = np.array([fit.log_weight for fit in fits]).T
        self.free = np.array([fit.free for fit in fits])

    def best(self, used: NDArray[np.bool_], degrees: float) -> tuple[float, float, float, NDArray[np.bool_]]:
        """Return the log likelihood under Student's distribution, and where it is the largest.

        That is the standard deviation, the correlation time, s, and which flights do not exceed them. The
        squared scale comes from the EM algorithm, for all times at once.
        """
        costs, free = self.costs[:, used], self.free[used]
        whole = degrees + free
        scale = np.maximum(costs.sum(axis=1) / free.sum(), LEAST_NOISE**2)
        for _ in range(ROUNDS):
            weights = whole / (degrees + costs / scale[:, None])
            scale = np.maximum((weights * costs).sum(axis=1) / free.sum(), LEAST_NOISE**2)
        tails = 0.5 * (whole * np.log1p(costs / (degrees * scale[:, None]))).sum(axis=1)
        constant = sum(map(math.lgamma, 0.5 * whole)) - len(whole) * math.lgamma(0.5 * degrees)
        logs = self.logs[:, used].sum(axis=1) + constant - tails - 0.5 * free.sum() * np.log(degrees * scale)
        k = int((logs >= logs.max() - NOT_REJECTED).argmax())
        variance = float(scale[k]) * degrees / (degrees - LEAST_DEGREES)
        fits = self.costs[k] <= MAX_NOISE_RATIO**2 * variance * self.free
        return float(logs.max()), math.sqrt(variance), self.times[k], fits
