"""The steps in which a motion is integrated. They are made when a time needs them, and kept.

SciPy's DOP853 makes the steps. `motion.integrated` says why, and how exact they are.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import INTEGRATION_ABSOLUTE, INTEGRATION_RELATIVE

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.motion.equations import MotionLaw
    from contact_dynamics.validation import FloatArray


class IntegratedStep(NamedTuple):
    """One step of the integrator: all variables are polynomials of degree 7 in time.

    Attributes:
        start: Time at which the step begins, s.
        end: Time at which it ends, s, > start.
        variables: Function from times, (n,), s, to the variables, (13, n) (`equations.VARIABLES`).
        scale: L over the last three variables, kg m^2.
    """

    start: float
    end: float
    variables: Callable[[FloatArray], FloatArray]
    scale: float


class Steps:
    """The steps of the integrator in one direction of time. They are continued when a time needs it."""

    def __init__(self, law: MotionLaw, end: float, most: int) -> None:
        self.law = law
        self.end = end  # s, of time: inf or -inf
        self.most = most
        self.solver: Any = None
        self.ends: list[float] = [0.0]  # s, |time| at the end of each step
        self.dense: list[Any] = []  # and the interpolant of each

    def at(self, seconds: float) -> FloatArray:
        """Return the variables, (13,), at a time on this side."""
        self._reach(abs(seconds))
        if not self.dense:
            return self.law.start
        value: FloatArray = self.dense[max(bisect_left(self.ends, abs(seconds)) - 1, 0)](seconds)
        return value

    def step_at(self, seconds: float) -> IntegratedStep:
        """Return the step that contains a time on this side."""
        self._reach(math.nextafter(seconds, self.end))
        step = bisect_right(self.ends, abs(seconds)) - 1
        return IntegratedStep(self.ends[step], self.ends[step + 1], self.dense[step], self.law.scale)

    def at_many(self, seconds: FloatArray) -> FloatArray:
        """Return the variables, (n, 13), at times (n,) on this side."""
        values = np.tile(self.law.start, (len(seconds), 1))
        if len(seconds) == 0:
            return values
        self._reach(float(np.abs(seconds).max()))
        if self.dense:
            steps = np.maximum(np.searchsorted(self.ends, np.abs(seconds)) - 1, 0)
            for step in np.unique(steps):
                here = steps == step
                values[here] = self.dense[step](seconds[here]).T
        return values

    def _reach(self, distance: float) -> None:
        """Step until |time| is at least ``distance``."""
        if distance <= self.ends[-1]:
            return
        if self.solver is None:
            from scipy.integrate import DOP853

            with np.errstate(all="ignore"):
                self.solver = DOP853(
                    self.law.rates,
                    0.0,
                    self.law.start,
                    self.end,
                    rtol=INTEGRATION_RELATIVE,
                    atol=INTEGRATION_ABSOLUTE,
                )
        while self.ends[-1] < distance:
            if len(self.dense) >= self.most:
                self._refuse(distance, f"{self.most} steps of the integrator reach")
            if self.solver.status != "running":
                self._refuse(distance, "the motion stays within bounds")
            with np.errstate(all="ignore"):  # what grows without bounds is seen by its steps
                self.solver.step()
            if self.solver.status != "failed":
                self.dense.append(self.solver.dense_output())
                self.ends.append(abs(self.solver.t))

    def _refuse(self, distance: float, limit: str) -> None:
        sign = math.copysign(1.0, self.end)
        raise InvalidFieldError(
            "seconds", f"{sign * distance:g} s", f"no further than {limit}: {sign * self.ends[-1]:g} s"
        )
