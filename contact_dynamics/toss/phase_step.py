"""One step of the integrator of contact phases: the pair of Dormand and Prince, and its interpolant.

The pair has the orders 5 and 4 (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.5).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.toss.forces import Pushed, pushed_by_contacts
from contact_dynamics.toss.holding import out_of_flats

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Held, Numbers, Solid
    from contact_dynamics.validation import FloatArray

_STAGES: Final = tuple(
    np.array(row)
    for row in (
        [1 / 5],
        [3 / 40, 9 / 40],
        [44 / 45, -56 / 15, 32 / 9],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    )
)
_ERRORS: Final = np.array([-71 / 57600, 0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])
INTERPOLANT: Final = np.array(
    [
        [1, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
        [0, 0, 0, 0],
        [0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
        [0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
        [0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632],
        [0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
        [0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423],
    ]
)

"""(7, 4), the coefficients of the interpolant, for each stage."""


class PhaseStep(NamedTuple):
    """One step of the integrator.

    Attributes:
        solid: The body and the flats.
        start: s, its beginning.
        span: s, its length, up to where it counts.
        y: (13,), the state at its beginning.
        rates: (13, 4), the coefficients of the interpolant.
        whole: s, the length that the interpolant's coefficients belong to.
    """

    solid: Solid
    start: float
    span: float
    y: FloatArray
    rates: FloatArray
    whole: float

    def at(self, seconds: float) -> Numbers:
        """Return the 13 numbers at a time of this step, s, counted as its start is."""
        return out_of_flats(self.solid, within(self, (seconds - self.start) / self.whole).tolist())


def within(step: PhaseStep, x: float) -> FloatArray:
    """Return the 13 numbers at a share of a step's whole length, which the interpolant gives."""
    values: FloatArray = step.y + (step.whole * x) * (step.rates @ np.array([1.0, x, x * x, x * x * x]))
    return values


def scales_of(solid: Solid) -> FloatArray:
    """Return what each of the 13 numbers is multiplied with to become a length or a speed."""
    reach = max(solid.reach, math.sqrt(solid.inertia[0][0] / solid.mass))
    return np.array([1.0] * 3 + [2.0 * reach] * 4 + [1.0] * 3 + [reach] * 3)


class Trial(NamedTuple):
    """A step that is tried.

    Attributes:
        y: The state at its end.
        size: Its error, by the allowed one.
        stages: (7, 13), the rates at the stages.
        pushed: The rates and forces at its end.
    """

    y: Numbers
    size: float
    stages: FloatArray
    pushed: Pushed


def tried(
    solid: Solid,
    y: Numbers,
    pushed: Pushed,
    mode: tuple[Held, ...],
    *,
    span: float,
    scales: FloatArray,
    error: float,
) -> Trial:
    """Return a step from a state.

    Args:
        solid: The body and the flats.
        y: The state.
        pushed: The rates and forces there.
        mode: The contacts that are held.
        span: s, its length.
        scales: What the 13 numbers are multiplied with (`scales_of`).
        error: m, m/s. The error that it may have.
    """
    begin, trial, after = np.array(y), y, pushed
    stages = np.empty((7, 13))
    stages[0] = pushed.rates
    for k, row in enumerate(_STAGES, start=1):
        trial = (begin + span * (row @ stages[:k])).tolist()
        after = pushed_by_contacts(solid, trial, mode)
        stages[k] = after.rates
    size = float(np.abs((_ERRORS @ stages) * scales).max()) * span / error
    return Trial(trial, size, stages, after)
