# SPDX-License-Identifier: Apache-2.0
"""Determines the number of whole turns between poses, which angular velocities show and poses do not.

A body that turns by half a turn or more from one pose to the next appears to turn more slowly, or backwards.
Motions whose attitudes agree at all stamps differ by at least one turn over some interval, so their angular
velocities differ by at least 2 pi over the longest interval. Published velocities that are closer to a motion
than a third of this therefore exclude all others. Otherwise, other motions are searched for, starting from
the published velocities and from motions with more and fewer whole turns. A search starts with the last few
states and doubles their number in each round, so that the start need not fit the whole window.

Motions that the states do not distinguish are alternatives. The criterion is the likelihood of the residuals,
with the given noise or with noise of unknown size. Among motions that fit equally well, published velocities
decide if they are twice as far from the second as from the first. Velocities that are all zero count as not
published, unless the body rests.

Not covered: without velocities, the search includes up to two turns per interval more or less. Other motions
may fit as well, so a fit without alternatives is not proven to be unique.
"""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Generic, TypeVar

import numpy as np

from contact_dynamics.constants import seconds_since
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rotations.many import rotation_vectors, turned
from contact_dynamics.tolerances import LEAST_NOISE, ROUNDED_STAMP_TURN

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from contact_dynamics.motion.integrated import ForcedMotion
    from contact_dynamics.numerics.gauss_newton import Fit
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.tumbling import FreeMotion, Trajectory
    from contact_dynamics.validation import FloatArray

THIRD_OF_A_TURN: Final = 2.0 * math.pi / 3.0
"""rad. A turn that is closer than this to the expected one is distinguished from those a whole turn away."""

MAX_NOISE_RATIO: Final = 3.0
"""Root mean square of residuals, in standard deviations, up to which they fit the noise. Nine times the
expected sum of squares has a probability of 6e-6 even for three degrees of freedom, and stated deviations are
rarely wrong by as much."""

MAX_ORIENTATION_RESIDUAL: Final = 0.1
"""rad. Residuals of more are no noise, where none is stated. Trackers have a fraction of it."""

MIN_EVIDENCE: Final = 25.0
"""Difference of two fits' sums of squares, in variances, that decides between them. The better fit is the
wrong one with a probability below that of five standard deviations."""

_CLEAR: Final = 2.0
"""Published velocities decide for a motion if they are this much farther from all others."""

_RESTS: Final = 10.0
"""A body rests if it turns by no more than this many residuals within the window."""

_WORST: Final = 10.0
"""A search is given up where residuals are this many times those of the best fit so far, or of the noise."""

_MORE_TURNS: Final = (0, 1, -1, 2, -2)
"""Turns more or less in an interval with which other motions are searched for."""

_NEAR: Final = 0.5
"""rad. A motion with turns more that misses one of the newest states by more is not searched from."""

Model = TypeVar("Model", bound="FreeMotion | ForcedMotion")


class Window(ABC, Generic[Model]):
    """Published states, and how a motion is fitted to the last of them.

    The last motion at their stamps is kept, because many parts of a fit look at it.
    """

    unknowns: int
    by_q: float  # weight of orientations, 1/rad
    noise_is_known: bool
    rates_weigh: bool  # angular velocities are among the residuals

    def __init__(self, body: MassProperties, states: Sequence[BodyState]) -> None:
        """Take a body and its states, in the order of time."""
        self.body = body
        self.seconds = seconds_since(states[-1].stamp_ns, [state.stamp_ns for state in states])
        self.q = np.array([state.q_WB for state in states])
        self.w = np.array([state.w_WB_W for state in states])
        self._last: tuple[Model, int, Trajectory] | None = None

    def at(self, model: Model, count: int) -> Trajectory:
        """Return a motion at the last ``count`` stamps."""
        if self._last is None or self._last[0] is not model or self._last[1] != count:
            self._last = model, count, model.at(self.seconds[-count:])
        return self._last[2]

    @abstractmethod
    def fitted(self, start: Model, count: int) -> Fit[Model]:
        """Return the fit to the last ``count`` states."""

    @abstractmethod
    def with_rate(self, model: Model, rate: FloatArray) -> Model:
        """Return the motion with another angular velocity, (3,), at the newest state."""


@dataclass(frozen=True, slots=True, eq=False)
class Chosen(Generic[Model]):
    """The best fit, and other motions that fit equally well."""

    fit: Fit[Model]  # the best fit
    converged: bool  # whether it converged, and its residuals fit the noise
    turns_known: bool  # whether published velocities exclude other numbers of turns
    alternatives: tuple[BodyState, ...]  # states at the newest stamp of the other motions


@dataclass(frozen=True, slots=True, eq=False)
class _Found(Generic[Model]):
    fit: Fit[Model]
    cost: float
    free: int
    orientation_residual: float  # rad
    spin_miss: float  # rad/s, rms of the published angular velocities less its own
    converged: bool


def turns_near(q: FloatArray, q_from: FloatArray, expected: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the turns, (n, 3), between attitudes that are nearest to the expected ones, and their errors.

    A turn is a rotation vector, rad, of any length. It is the one of at most half a turn if that is within
    `THIRD_OF_A_TURN` of the expected one. Otherwise it is the expected one, with its error, (n, 3), rad.
    """
    seen = rotation_vectors(q, q_from)
    rest = np.zeros_like(seen)
    far = np.linalg.norm(seen - expected, axis=1) > THIRD_OF_A_TURN
    if far.any():
        seen[far] = expected[far]
        rest[far] = rotation_vectors(q[far], turned(q_from[far], expected[far]))
    return seen, rest


def chosen_motion(window: Window[Model], start: Model, others: Iterable[Model]) -> Chosen[Model]:
    """Return the best fit from a start, or from others if published velocities do not confirm that.

    Raises:
        InvalidFieldError: the states leave a part of the motion open.
    """
    every: list[_Found[Model]] = []
    failure: InvalidFieldError | None = None
    try:
        every.append(_judged(window, window.fitted(start, len(window.seconds))))
    except InvalidFieldError as error:  # perhaps the states, and perhaps the start
        failure = error
    sound = bool(every) and every[0].converged
    if sound and _confirmed(window, every[0]):
        return Chosen(every[0].fit, converged=True, turns_known=True, alternatives=())
    if window.w.any() or not sound:
        for model in others:
            every += _searched(window, model, every)
    if failure is not None and not every:
        raise failure
    for model in _with_more_turns(window, min(every, key=_goodness)):
        every += _searched(window, model, every)
    best = min(every, key=_goodness)
    alike = _distinct(window, [each for each in every if _evidence(window, best, each) < MIN_EVIDENCE])
    if not window.rates_weigh:
        alike.sort(key=lambda each: each.spin_miss)
        others_miss = min((each.spin_miss for each in alike[1:]), default=math.inf)
        if alike[0].converged and window.w.any() and others_miss > _CLEAR * alike[0].spin_miss:
            del alike[1:]
    first = alike[0]
    if first.converged and _confirmed(window, first):
        del alike[1:]
    return Chosen(
        fit=first.fit,
        converged=first.converged,
        turns_known=first.converged
        and len(alike) == 1
        and (_confirmed(window, first) or bool(window.w.any())),
        alternatives=tuple(each.fit.model.state for each in alike[1:]),
    )


def _goodness(found: _Found[Model]) -> tuple[bool, float]:
    return not found.converged, found.cost


def _judged(window: Window[Model], fit: Fit[Model]) -> _Found[Model]:
    then = window.at(fit.model, len(window.seconds))
    turns, rates = rotation_vectors(window.q, then.q_WB), window.w - then.w_WB_W
    count = len(window.seconds)
    orientation_residual = math.sqrt(float(np.square(turns).sum()) / count)
    cost, free = float(fit.misses @ fit.misses), len(fit.misses) - window.unknowns
    fits = (
        cost <= MAX_NOISE_RATIO**2 * free
        if window.noise_is_known
        else orientation_residual <= MAX_ORIENTATION_RESIDUAL
    )
    spin_miss = math.sqrt(float(np.square(rates).sum()) / count)
    if window.w.any() and spin_miss * _longest(window) > math.pi:  # not better than by chance
        fits = False
    return _Found(
        fit=fit,
        cost=cost,
        free=free,
        orientation_residual=orientation_residual,
        spin_miss=spin_miss,
        converged=fit.converged and fits,
    )


def _confirmed(window: Window[Model], found: _Found[Model]) -> bool:
    """Return whether published angular velocities exclude motions with more or fewer whole turns."""
    if not window.w.any():
        turn = float(np.linalg.norm(found.fit.model.state.w_WB_W)) * -float(window.seconds[0])
        return turn <= _RESTS * max(found.orientation_residual, LEAST_NOISE)
    return found.spin_miss * _longest(window) < THIRD_OF_A_TURN


def _longest(window: Window[Model]) -> float:
    return float(np.diff(window.seconds).max())


def _evidence(window: Window[Model], best: _Found[Model], other: _Found[Model]) -> float:
    """Return twice the difference of the logarithms of the likelihoods of two fits."""
    least = (window.by_q * ROUNDED_STAMP_TURN) ** 2
    if window.noise_is_known:
        return (other.cost - best.cost) / max(1.0, best.cost / best.free, least)
    least *= len(best.fit.misses)
    return best.free * math.log((other.cost + least) / (best.cost + least))


def _distinct(window: Window[Model], found: list[_Found[Model]]) -> list[_Found[Model]]:
    """Return fits of different motions, judged by their angular velocities, best first."""
    kept: list[_Found[Model]] = []
    apart = 0.5 * THIRD_OF_A_TURN / _longest(window)
    for each in sorted(found, key=_goodness):
        rate = each.fit.model.state.w_WB_W
        if all(np.linalg.norm(rate - other.fit.model.state.w_WB_W) > apart for other in kept):
            kept.append(each)
    return kept


def _searched(window: Window[Model], model: Model, found: list[_Found[Model]]) -> list[_Found[Model]]:
    """Return the fit from a start, extended over twice as many states in each round, or none."""
    total = len(window.seconds)
    variances = [each.cost / each.free for each in found if each.converged]
    variance = 1.0 if window.noise_is_known else min(variances, default=math.inf)
    count = min(3, total)
    try:
        while count < total:
            fit = window.fitted(model, count)
            if float(fit.misses @ fit.misses) > _WORST**2 * variance * len(fit.misses):
                return []
            model, count = fit.model, min(2 * count, total)
        return [_judged(window, window.fitted(model, total))]
    except InvalidFieldError:  # these states leave a part open, or this motion goes beyond all bounds
        return []


def _with_more_turns(window: Window[Model], nearest: _Found[Model]) -> Iterator[Model]:
    """Return motions that have nearly the same attitudes one interval of the usual length on.

    There is none where published velocities confirm the number of turns, which they would miss by one.

    A body with an axis of symmetry precesses about L and spins about this axis, both steadily. Whole turns
    more of either do not change its attitudes. Such a motion obeys the laws of rotation if its own L points
    the same way.
    """
    if window.w.any() and _confirmed(window, nearest):
        return
    model = nearest.fit.model
    R, w = model.state.R_WB, model.state.w_WB_W
    moments, axes = np.linalg.eigh(window.body.I_B)
    axes_W = R @ axes
    symmetric = axes_W[:, 0] if moments[1] - moments[0] > moments[2] - moments[1] else axes_W[:, 2]
    inertia = R @ window.body.I_B @ R.T
    L = inertia @ w
    size = float(np.linalg.norm(L))
    steady = L / size if size > 0.0 else symmetric
    turn = 2.0 * math.pi / float(np.median(np.diff(window.seconds)))
    rates = [w]
    for precessions, spins in itertools.product(_MORE_TURNS, repeat=2):
        rate = w + turn * (precessions * steady + spins * symmetric)
        other = inertia @ rate
        along = abs(float(other @ steady))
        is_new = all(np.linalg.norm(rate - each) > _NEAR * turn for each in rates)
        if is_new and along > math.cos(_NEAR) * float(np.linalg.norm(other)):
            rates.append(rate)
            motion = window.with_rate(model, rate)
            misses = rotation_vectors(window.q[-3:], motion.at(window.seconds[-3:]).q_WB)
            if np.abs(misses).max() < _NEAR:
                yield motion
