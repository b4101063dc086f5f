# SPDX-License-Identifier: Apache-2.0
"""Integrates the motion of a rigid body under forces and torques in addition to gravity (lecture 24).

The equations are Newton's and Euler's laws about the centre of mass, dp/dt = v, m dv/dt = m g + F, dL/dt = N,
dR/dt = [w] R with w = R I^-1 R^T L. Forces may be constant in world or in body axes, drag in still air, and a
user's function of time and state.

Method: L in world axes is a variable, and therefore constant to the last bit without torque. The attitude is
a quaternion whose rates depend on q / |q| only; the integration error of |q| therefore has no effect, and
results are divided by |q|. Rotation vectors would require restarts. Position and velocity are deviations from
the free parabola, which is therefore exact. SciPy's DOP853 (Hairer, Norsett and Wanner, Solving Ordinary
Differential Equations I, II.5) integrates these variables in both directions of time. Steps are computed when
a requested time requires them, and stored.

Accuracy, against the closed form at zero torque: 1e-12 rad after 10 revolutions of a compact body and 5e-11
after 100, growing with the square of time; a rod of 1 to 20 is ten times as sensitive, and spin near the
middle axis amplifies it as any error of its state (see `poinsot`). Cost: about 15 ms per revolution. Without
wrench and drag, the closed form is better in all respects; `motion_of` selects it.

Not covered: discontinuous forces (each jump requires small steps), impacts, wind, lift, added mass.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.forces import (
    NO_DRAG,
    NO_WRENCH,
    VARIABLES,
    ConstantWrench,
    Drag,
    MotionLaw,
    WrenchAxes,
)
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
from contact_dynamics.rotations.many import make_continuous
from contact_dynamics.tolerances import INTEGRATION_ABSOLUTE, INTEGRATION_RELATIVE, LARGEST_NUMBER
from contact_dynamics.tumbling import FreeMotion, Sample, Trajectory, free_motion
from contact_dynamics.tumbling.motion import check_extent
from contact_dynamics.validation import FloatArray, check_array, check_magnitude, check_whole, check_within
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from contact_dynamics.motion.forces import MotionLaw, WrenchFunction
    from contact_dynamics.validation import FloatArray


MAX_STEPS: Final = 20_000
"""Largest number of steps in one direction of time. They take about 10 s, and cover about 500 revolutions."""


class Method(NamedInt):
    """Method by which a motion is computed. The values are those of PredictTumbling.srv."""

    CLOSED_FORM = 0  # exact to rounding, the error does not grow with time
    INTEGRATED = 1  # stepped by an integrator


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ForcedMotion(Record):
    """Motion of a body under forces, made by `forced_motion`. It must not be shared by threads.

    Attributes:
        body: Mass and angular inertia.
        state: State of the body at time 0.
        gravity_W: (3,), m/s^2, world axes.
        wrench: Constant wrench in addition to gravity.
        drag: Drag in still air.
        wrench_of: User-defined function of time and state that returns a wrench, or None.
        law: Differential equations.
        ahead: Steps into the future.
        back: Steps into the past.
    """

    body: MassProperties
    state: BodyState
    gravity_W: FloatArray
    wrench: ConstantWrench
    drag: Drag
    wrench_of: WrenchFunction | None
    law: MotionLaw = field(repr=False)
    ahead: Steps = field(repr=False)
    back: Steps = field(repr=False)

    @property
    def rotates_freely(self) -> bool:
        """Return whether only forces act, so that the rotation is that of `free_motion`."""
        angular_drag = self.drag.linear_angular or self.drag.quadratic_angular
        return not (self.wrench.torque.any() or angular_drag or self.wrench_of is not None)

    def sample(self, seconds: float) -> Sample:
        """Return the motion at one time, s after the state's stamp, in plain floats.

        Raises:
            InvalidFieldError: the integrator does not reach the time, because it takes too many steps, or
                because the motion grows without bounds before, as under drag into the past.
        """
        side = self.ahead if seconds >= 0.0 else self.back
        return self.law.sample(seconds, side.at(seconds).tolist())

    def step_at(self, seconds: float) -> IntegratedStep:
        """Return the step that contains a time >= 0, s. Where two steps meet, it is the later one.

        Raises:
            InvalidFieldError: as for `sample`.
        """
        return self.ahead.step_at(seconds)

    @checks_types
    def from_state(self, state: BodyState) -> ForcedMotion:
        """Return the motion of the same body under the same forces from another state at time 0."""
        return forced_motion(
            self.body,
            state,
            gravity_W=self.gravity_W,
            wrench=self.wrench,
            drag=self.drag,
            wrench_of=self.wrench_of,
            max_steps=self.ahead.most,
        )

    def steps_to(self, seconds: float) -> FloatArray:
        """Return the times, s, from 0 to ``seconds`` of either sign, between which the integrator steps.

        Raises:
            InvalidFieldError: as for `sample`.
        """
        side = self.ahead if seconds >= 0.0 else self.back
        side.at(seconds)
        ends = np.array(side.ends[: bisect_left(side.ends, abs(seconds))])
        times: FloatArray = np.copysign(np.append(ends, abs(seconds)), seconds)
        return times

    def state_at(self, seconds: float) -> BodyState:
        """Return the body's state at one time, s after the state's stamp.

        Raises:
            InvalidFieldError: the time is not finite, or beyond the range of `sample`.
        """
        check_within("seconds", seconds, -LARGEST_NUMBER, LARGEST_NUMBER)
        return self.sample(seconds).as_state(self.state.stamp_ns, seconds)

    def at(self, seconds: ArrayLike) -> Trajectory:
        """Return the motion at times (n,), s after the state's stamp, of any sign and in any order.

        Raises:
            InvalidFieldError: the times are not a flat list of finite numbers, or are beyond the range of
                `sample`.
        """
        times = check_magnitude("seconds", check_array("seconds", seconds, (None,)))
        values = np.empty((len(times), VARIABLES))
        for side, belongs in ((self.ahead, times >= 0.0), (self.back, times < 0.0)):
            values[belongs] = side.at_many(times[belongs])
        rows = [self.law.sample(t, y) for t, y in zip(times.tolist(), values.tolist(), strict=True)]
        numbers = np.array([[*row.p_WB_W, *row.q_WB, *row.v_WB_W, *row.w_WB_W] for row in rows])
        p_WB_W, q_WB, v_WB_W, w_WB_W = np.split(numbers.reshape(-1, VARIABLES), (3, 7, 10), axis=1)
        make_continuous(q_WB, self.state.q_WB)
        return Trajectory(seconds=times, p_WB_W=p_WB_W, q_WB=q_WB, v_WB_W=v_WB_W, w_WB_W=w_WB_W)


class ChosenMotion(NamedTuple):
    """Motion, and the method by which it is computed."""

    motion: FreeMotion | ForcedMotion
    method: Method


def motion_of(
    body: HasMassProperties,
    state: BodyState,
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    wrench: ConstantWrench = NO_WRENCH,
    drag: Drag = NO_DRAG,
    wrench_of: WrenchFunction | None = None,
    max_steps: int = MAX_STEPS,
) -> ChosenMotion:
    """Return a body's motion: in closed form without torque and drag, and otherwise by integration.

    A constant force in world axes acts like a change of gravity, so the motion is still in closed form.
    Arguments and errors are those of `forced_motion`.
    """
    body = body.mass_properties
    if turns_or_drags(wrench, drag, wrench_of):
        forced = forced_motion(
            body,
            state,
            gravity_W=gravity_W,
            wrench=wrench,
            drag=drag,
            wrench_of=wrench_of,
            max_steps=max_steps,
        )
        return ChosenMotion(forced, Method.INTEGRATED)
    fall = check_array("gravity_W", gravity_W, (3,)) + wrench.force / body.mass
    return ChosenMotion(free_motion(body, state, gravity_W=fall), Method.CLOSED_FORM)


def turns_or_drags(wrench: ConstantWrench, drag: Drag, wrench_of: WrenchFunction | None) -> bool:
    """Return whether a torque or drag acts, which the closed form does not cover."""
    turns = any(wrench.torque.tolist())
    turns = turns or (wrench.axes is WrenchAxes.BODY and any(wrench.force.tolist()))
    return turns or drag != NO_DRAG or wrench_of is not None


def forced_motion(
    body: HasMassProperties,
    state: BodyState,
    *,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
    wrench: ConstantWrench = NO_WRENCH,
    drag: Drag = NO_DRAG,
    wrench_of: WrenchFunction | None = None,
    max_steps: int = MAX_STEPS,
) -> ForcedMotion:
    """Return the motion of a body under a constant wrench, drag and a user-defined function, by integration.

    Gravity is (3,), m/s^2, world axes. ``wrench_of(seconds, sample)`` returns a force, N, and a torque about
    the centre of mass, N m, three numbers each, in world axes; its seconds are relative to the state's stamp.
    Times that require more than ``max_steps`` of the integrator raise an error.

    Raises:
        InvalidFieldError: gravity is not three finite numbers; a number exceeds `LARGEST_NUMBER`; or the
            function does not return two vectors of three finite numbers, now or whenever the motion calls it.
    """
    body = body.mass_properties
    gravity = check_array("gravity_W", gravity_W, (3,))
    max_steps = check_whole("max_steps", max_steps, 1)
    check_extent(state, gravity)
    law = MotionLaw(body, state, gravity, wrench=wrench, drag=drag, wrench_of=wrench_of)
    law.rates(0.0, law.start)  # rejects an invalid function immediately
    return ForcedMotion(
        body=body,
        state=state,
        gravity_W=law.gravity_W,
        wrench=wrench,
        drag=drag,
        wrench_of=wrench_of,
        law=law,
        ahead=Steps(law, math.inf, max_steps),
        back=Steps(law, -math.inf, max_steps),
    )


class IntegratedStep(NamedTuple):
    """One step of the integrator: all variables are polynomials of degree 7 in time."""

    start: float  # s
    end: float  # s, > start
    variables: Callable[[FloatArray], FloatArray]  # from times, (n,), s, to (13, n), as `VARIABLES` says
    scale: float  # L over the last three variables, kg m^2


class Steps:
    """The steps of the integrator in one direction of time, which are continued when a time requires it."""

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
            with np.errstate(all="ignore"):  # a motion that grows without bounds needs ever smaller steps
                self.solver.step()
            if self.solver.status != "failed":
                self.dense.append(self.solver.dense_output())
                self.ends.append(abs(self.solver.t))

    def _refuse(self, distance: float, limit: str) -> None:
        sign = math.copysign(1.0, self.end)
        raise InvalidFieldError(
            "seconds", f"{sign * distance:g} s", f"no further than {limit}: {sign * self.ends[-1]:g} s"
        )
