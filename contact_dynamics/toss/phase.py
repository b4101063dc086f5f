# SPDX-License-Identifier: Apache-2.0
"""The motion of a body in one contact mode, integrated until the mode ends.

The mode determines the accelerations (`forces`), which are integrated in adaptive steps by the Dormand-Prince
pair of orders 5 and 4 (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.5). The mode
ends when the normal force at a held contact vanishes, when the friction of a sticking contact reaches its
limit, or when another corner arrives. These times are found on the interpolant. The mode also ends when
sliding stops. Because friction is discontinuous there, steps end before that time, and each of them leaves at
least a tenth of the speed.

`phase.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.records import NamedInt
from contact_dynamics.tolerances import (
    BEGUN_TO_SLIDE,
    COARSE_SLIDING_STOPPED,
    COMES_DOWN_FOUND,
    CREEPING_STEP,
    FORCE_END_FOUND,
    GRAZING_DEPTH,
    PHASE_ERROR,
    PHASE_LEAST_STEP,
    RESOLVED_SLIDING,
    SAMPLED_PHASE_ERROR,
    SLIDING_STOPPED,
)
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.forces import HeldContacts, force_rounding, out_of_flats
from contact_dynamics.toss.mode_choice import corrected
from contact_dynamics.toss.solid import Above, Held

if TYPE_CHECKING:
    from contact_dynamics.toss.solid import Numbers, Solid

MAX_PHASE_STEPS: Final = 20_000
"""Largest number of steps of a phase. A tenth of a second of sliding or tipping takes some twenty."""

_MAX_SHORT_STEPS: Final = 60
"""Such steps after which a phase ends. Sliding that stops takes some ten."""

LARGEST_STEP: Final = 0.2
"""s. A step is no longer than this where no other corner comes down."""

SHORT_STEP: Final = 0.02
"""s. A step may be this long where another corner would come down earlier, by its present speed. One that
comes down and leaves again within it is looked for where it is lowest."""

FIRST_STEP: Final = 0.03
"""s. The first step at `SAMPLED_PHASE_ERROR`, shorter for smaller errors as the order of the steps says."""

_TOWARDS_STOP: Final = 0.9


_MAX_ROOT_STEPS: Final = 60

_STAGES: Final = array(
    "d",
    (
        *(1.0 / 5.0,),
        *(3.0 / 40.0, 9.0 / 40.0),
        *(44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0),
        *(19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0),
        *(9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0),
        *(35.0 / 384.0, 0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0),
    ),
)
_ERRORS: Final = array(
    "d", (-71.0 / 57600.0, 0, 71.0 / 16695.0, -71.0 / 1920.0, 17253.0 / 339200.0, -22.0 / 525.0, 1.0 / 40.0)
)
_INTERPOLANT: Final = array(
    "d",
    (
        *(1, -8048581381.0 / 2820520608.0, 8663915743.0 / 2820520608.0, -12715105075.0 / 11282082432.0),
        *(0, 0, 0, 0),
        *(0, 131558114200.0 / 32700410799.0, -68118460800.0 / 10900136933.0, 87487479700.0 / 32700410799.0),
        *(0, -1754552775.0 / 470086768.0, 14199869525.0 / 1410260304.0, -10690763975.0 / 1880347072.0),
        *(
            0,
            127303824393.0 / 49829197408.0,
            -318862633887.0 / 49829197408.0,
            701980252875.0 / 199316789632.0,
        ),
        *(0, -282668133.0 / 205662961.0, 2019193451.0 / 616988883.0, -1453857185.0 / 822651844.0),
        *(0, 40617522.0 / 29380423.0, -110615467.0 / 29380423.0, 69997945.0 / 29380423.0),
    ),
)
"""The coefficients of the interpolant, four for each stage. C would divide whole numbers as such."""

_INFINITE: Final = math.inf
_HEIGHT, _FORCE, _BEGUN = 0, 1, 2  # what becomes negative where a mode ends
_NONE: Final = -1


class PhaseEnd(NamedInt):
    """Reason for the end of a phase in one contact mode."""

    FORCES = 0
    """A held contact no longer presses, or friction no longer holds a contact that sticks."""
    SLIDING_STOPS = 1
    """A contact stops sliding, or one that begins to slide would do so along its friction."""
    COMES_DOWN = 2
    """Another corner arrives at a plane."""
    SLOW = 3
    """The kinetic energy has fallen to the requested bound."""
    TIME = 4
    """The requested time was reached."""
    STEPS = 5
    """The largest number of steps was reached."""
    CREEPS = 6
    """The steps have become too short, because the forces are discontinuous."""


_FORCES, _SLIDING_STOPS, _COMES_DOWN = PhaseEnd.FORCES, PhaseEnd.SLIDING_STOPS, PhaseEnd.COMES_DOWN
_SLOW, _TIME, _STEPS, _CREEPS = PhaseEnd.SLOW, PhaseEnd.TIME, PhaseEnd.STEPS, PhaseEnd.CREEPS


class PhaseStep:
    """One step of the integrator.

    Attributes:
        solid: The body and the flats.
        start: s, its beginning.
        span: s, its length, up to where it counts.
        whole: s, the length that the interpolant's coefficients belong to.
    """

    def __init__(self, solid: Solid, start: float, span: float) -> None:
        self.solid, self.start, self.span, self.whole = solid, start, span, span
        self.y = [0.0] * 13  # the state at its beginning
        self.rates = [0.0] * 52  # the four coefficients of the interpolant of each number

    def __reduce__(self) -> tuple[object, ...]:
        numbers = [self.y[k] for k in range(13)], [self.rates[k] for k in range(52)]
        return _step_of, (self.solid, self.start, self.span, self.whole, *numbers)

    def interpolate(self, y: Numbers, stages: list[float]) -> None:
        """Take the state at the beginning, and the rates at the seven stages, 13 each."""
        for i in range(13):
            self.y[i] = y[i]
            for j in range(4):
                rate = 0.0
                for k in range(7):
                    rate += stages[13 * k + i] * _INTERPOLANT[4 * k + j]
                self.rates[4 * i + j] = rate

    def within(self, x: float, y: Numbers) -> None:
        """Find the 13 numbers at a share of the whole length."""
        r = self.rates
        for i in range(13):
            rate = r[4 * i] + x * (r[4 * i + 1] + x * (r[4 * i + 2] + x * r[4 * i + 3]))
            y[i] = self.y[i] + (self.whole * x) * rate

    def at(self, seconds: float) -> Numbers:
        """Return the 13 numbers at a time of this step, s, counted as its start is."""
        # A new one, since several threads may ask at once.
        above = Above(self.solid.count * len(self.solid.flats))
        self.within((seconds - self.start) / self.whole, above.y)
        return out_of_flats(self.solid, [above.y[k] for k in range(13)], above)


def _step_of(  # noqa: PLR0917
    solid: Solid, start: float, span: float, whole: float, y: Numbers, rates: list[float]
) -> PhaseStep:
    step = PhaseStep(solid, start, span)
    step.whole = whole
    for k in range(13):
        step.y[k] = y[k]
    for k in range(52):
        step.rates[k] = rates[k]
    return step


def straight_step(solid: Solid, start: float, span: float, y: Numbers, rates: Numbers) -> PhaseStep:
    """Return a step with constant rates of the 13 numbers."""
    coefficients = [x for rate in rates for x in (rate, 0.0, 0.0, 0.0)]
    return _step_of(solid, start, span, span, y, coefficients)


class Phase(NamedTuple):
    """The motion in one contact mode.

    Attributes:
        end: Reason for the end.
        seconds: Time of the end, s.
        y: State at that time.
        steps: Steps of the integrator; empty unless requested.
        step_count: Number of steps.
    """

    end: PhaseEnd
    seconds: float
    y: Numbers
    steps: list[PhaseStep]
    step_count: int


def phase(
    solid: Solid,
    y: Numbers,
    mode: tuple[Held, ...],
    *,
    start: float,
    until: float,
    slow: float = 0.0,
    error: float = PHASE_ERROR,
    has_steps: bool = True,
) -> Phase:
    """Return the motion in a mode, from a state to the end of the mode.

    Args:
        solid: The body and the planes.
        y: Initial state.
        mode: The sticking and sliding contacts.
        start: Time of the initial state, s.
        until: Latest time of the end, s.
        slow: Kinetic energy, J, below which the phase ends, or 0 for no bound.
        error: Largest error of a step, in m, m/s, and radians times the body's reach.
        has_steps: True to return the steps.
    """
    run = _Run(solid, out_of_flats(solid, y), mode, error)
    end = run.go(start, until, slow, has_steps)
    return Phase(PhaseEnd(end), run.now, [run.y[k] for k in range(13)], run.steps, run.count)


class _Run:
    """The integration of a phase."""

    def __init__(self, solid: Solid, y: Numbers, mode: tuple[Held, ...], error: float) -> None:
        self.solid, self.error = solid, error
        self.held = HeldContacts(solid, mode)
        heights = solid.count * len(solid.flats)
        self.here, self.there = Above(heights), Above(heights)  # at the beginning of a step and at its end
        self.y, self.trial, self.scales, self.probe = [0.0] * 13, [0.0] * 13, [0.0] * 13, [0.0] * 13
        self.stages = [0.0] * 91
        for k in range(13):
            self.y[k] = y[k]
        self._set_scales()
        # Corners on a flat or below have the depths that they may have, and held corners any.
        self.depths = array("d", bytes(8 * self.here.count))
        self.here.take(self.solid, self.y)
        for k in range(self.here.count):
            height = self.here.heights[k]
            self.depths[k] = 0.5 * GRAZING_DEPTH - min(height, 0.0) if height <= 0.5 * GRAZING_DEPTH else 0.0
        for one in mode:
            self.depths[one.flat * solid.count + one.corner] = _INFINITE
        self.resolved = max(SLIDING_STOPPED, min(RESOLVED_SLIDING * error, COARSE_SLIDING_STOPPED))
        self.now, self.count, self.before_stop, self.fast = 0.0, 0, 0.0, False
        self.steps: list[PhaseStep] = []
        self.stopped: list[int] = []  # the contacts that have stopped sliding
        self.span = 0.0  # s, of the step
        self.step: PhaseStep | None = None  # the step, once its interpolant is known

    def _set_scales(self) -> None:
        """Set what each of the 13 numbers is multiplied with to become a length or a speed."""
        solid = self.solid
        reach = max(solid.reach, math.sqrt(solid.inertia[0] / solid.mass))
        for k in range(13):
            self.scales[k] = 2.0 * reach if 3 <= k < 7 else reach if k >= 10 else 1.0

    def go(self, start: float, until: float, slow: float, has_steps: bool) -> int:  # noqa: FBT001
        """Integrate to the end of the mode, and return the reason for the end."""
        y = self.y  # C copies arrays that are assigned in parallel
        trial = self.trial
        held = self.held
        held.aim(y)
        held.hold(y)
        held.push(y)
        self._note_rates()
        self.now, step, short = start, FIRST_STEP * (self.error / SAMPLED_PHASE_ERROR) ** 0.2, 0
        self._look_at_sliding()
        self.fast = held.pose.kinetic_energy() > slow
        for _ in range(MAX_PHASE_STEPS):
            self.here.take(self.solid, y)
            step = min(step, self._before_arrival(), until - self.now, self.before_stop)
            size = self._try(step)
            short += step < CREEPING_STEP
            if short > _MAX_SHORT_STEPS:
                return _CREEPS
            if size > 1.0 and step > PHASE_LEAST_STEP:
                step *= max(0.2, 0.9 * size**-0.2)
                continue
            self.count, self.span = self.count + 1, step
            self.held.choose_forces()
            end, x = self._first_end()
            if has_steps:
                done = self._interpolated()
                done.span = x * step
                self.steps.append(done)
            if end != _NONE:
                self._interpolated().within(x, y)
                self.now += x * step
                held.hold(y)
                return end
            self.now += step
            for k in range(13):
                y[k] = trial[k]
            held.hold(y)
            self._turn_beginning()
            held = self.held
            self._note_rates()
            left = self.before_stop
            self._look_at_sliding()
            end = self._end_here(until, slow)
            if end != _NONE:
                return end
            self._forget_risen()
            step *= min(5.0, 0.9 * size**-0.2) if size > 0.0 else 5.0
            # Towards a stop the motion is alike at all speeds, and so are steps relative to what is left.
            if left < _INFINITE:
                step *= min(1.0, self.before_stop / left)
        return _STEPS

    def _end_here(self, until: float, slow: float) -> int:
        """Return the reason why the mode ends at the end of this step, or -1."""
        if self.stopped:
            self._stop()
            return _SLIDING_STOPS
        if self.now >= until:
            return _TIME
        energy = self.held.pose.kinetic_energy()
        if self.fast and energy <= slow:
            return _SLOW
        self.fast = self.fast or energy > slow
        return _NONE

    def _note_rates(self) -> None:
        """Begin the next step with the present rates."""
        for k in range(13):
            self.stages[k] = self.held.rates[k]

    def _before_arrival(self) -> float:
        """Return a step, s, in which hardly another corner comes down and leaves again."""
        least = LARGEST_STEP
        for k in range(self.here.count):
            height, rate = self.here.heights[k], self.here.rates[k]
            if rate < 0.0 and self.depths[k] < _INFINITE:
                least = min(least, max(-height / rate, SHORT_STEP))
        return least

    def _try(self, step: float) -> float:
        """Try a step, s, and return its error by the allowed one."""
        y = self.y
        trial = self.trial
        stages = self.stages
        rates = self.held.rates
        row = 0
        for k in range(1, 7):
            for i in range(13):
                rate = 0.0
                for j in range(k):
                    rate += _STAGES[row + j] * stages[13 * j + i]
                trial[i] = y[i] + step * rate
            row += k
            self.held.accelerate(trial)
            for i in range(13):
                stages[13 * k + i] = rates[i]
        largest = 0.0
        for i in range(13):
            rate = 0.0
            for j in range(7):
                rate += _ERRORS[j] * stages[13 * j + i]
            largest = max(largest, abs(rate) * self.scales[i])
        self.step = None
        return largest * step / self.error

    def _interpolated(self) -> PhaseStep:
        """Return the step with its interpolant."""
        if self.step is None:
            self.step = PhaseStep(self.solid, self.now, self.span)
            self.step.interpolate(self.y, self.stages)
        return self.step

    # Sliding

    def _look_at_sliding(self) -> None:
        """Find the longest step before which no contact stops sliding, and the contacts that have stopped.

        Below the speed ``resolved``, m/s, the direction of a stopping contact turns too fast for the allowed
        error. The contact would slide on in steps of a microsecond, and counts as stopped if friction can
        hold it.
        """
        longest = _INFINITE
        self.stopped.clear()
        held = self.held
        for i in range(held.count):
            one = held.mode[i]
            flat = self.solid.flats[one.flat]
            if not one.slides or one.begins or flat.friction == 0.0:
                continue
            arm = held.pose.arm(one.flat, one.corner)
            d = held.pose.sliding(arm, flat.normal, one.towards)
            rate = vec.dot(held.accelerated(one.flat, one.corner), d)
            if rate < 0.0:
                speed = vec.dot(held.pose.velocity(arm), d)
                longest = min(longest, _TOWARDS_STOP * speed / -rate)
                if speed <= SLIDING_STOPPED or (speed <= self.resolved and self._friction_holds(i)):
                    self.stopped.append(i)
        self.before_stop = max(longest, PHASE_LEAST_STEP)

    def _friction_holds(self, i: int) -> bool:
        """Return whether friction holds a contact if it sticks and the others remain in their mode."""
        mode = list(self.held.mode)
        mode[i] = Held(mode[i].touch)
        still = HeldContacts(self.solid, tuple(mode))
        still.push(self.y)
        force = still.force(i)
        flat = self.solid.flats[mode[i].flat]
        return vec.norm(vec.without(force, flat.normal)) <= flat.holding() * vec.dot(force, flat.normal)

    def _stop(self) -> None:
        """Hold the contacts that have stopped sliding where they are."""
        mode = list(self.held.mode)
        for i in self.stopped:
            mode[i] = Held(mode[i].touch)
        still = HeldContacts(self.solid, tuple(mode))
        still.aim_as(self.held)
        still.hold(self.y)

    def _turn_beginning(self) -> None:
        """Update the directions of contacts that have just begun to slide."""
        before = self.held
        mode = before.mode
        if not before.begins:
            return
        y = [self.y[k] for k in range(13)]
        guess = tuple([Held(one.touch) if one.begins else one for one in mode])
        new = {one.touch: one for one in corrected(self.solid, y, guess)[0] or ()}
        turned = []
        for one in mode:
            if one.begins:
                other = new.get(one.touch, one)
                slow = vec.norm(before.pose.velocity(before.pose.arm(one.flat, one.corner))) < BEGUN_TO_SLIDE
                turned.append(other if slow and other.slides else Held(one.touch, one.slides, one.towards))
            else:
                turned.append(one)
        if tuple(turned) != mode:
            self.held = HeldContacts(self.solid, tuple(turned))
            self.held.aim_as(before)
            self.held.push(self.y)

    # The end of a mode within a step

    def _forget_risen(self) -> None:
        """Corners that have risen from a flat may not be below it again."""
        self.there.take(self.solid, self.y)
        for k in range(self.there.count):
            if self.there.heights[k] > 0.5 * GRAZING_DEPTH and self.depths[k] < _INFINITE:
                self.depths[k] = 0.0

    def _first_end(self) -> tuple[int, float]:
        """Return the reason and the place, as a share of the step, of the mode's end, or -1 and 1.

        Corners that come down are those below a flat at the end of the step, and those that fall at its
        beginning and are below one in between.
        """
        end, x = _NONE, 1.0
        no_force = self.held.least_left() < 0.0
        # Contacts that jam push each other, and whether friction drives one of them is a matter of rounding.
        goes_back = self.held.begins and len(self.held.mode) == 1 and self._least_begun() < 0.0
        self.there.take(self.solid, self.trial)
        dip = self._first_dip()
        if dip < 1.0 or self._least_height() < 0.0:
            end, x = _COMES_DOWN, self._crossing(_HEIGHT, dip, COMES_DOWN_FOUND)
        if no_force and (end == _NONE or self._left_at(_FORCE, x) < 0.0):
            end, x = _FORCES, self._crossing(_FORCE, x, FORCE_END_FOUND * force_rounding(self.solid))
        if goes_back and (end == _NONE or self._left_at(_BEGUN, x) < 0.0):
            end, x = _SLIDING_STOPS, self._crossing(_BEGUN, x, 0.5 * SLIDING_STOPPED)
        return (end, x)

    def _least_begun(self) -> float:
        """Return the least speed, m/s, against its friction of a contact that begins to slide, plus rounding.

        It is negative where friction would drive the contact, so that the mode is not consistent any more.
        At the last force that friction can hold, a paradoxical contact may begin to slide in theory alone.
        """
        least, pose = _INFINITE, self.held.pose
        for one in self.held.mode:
            if one.begins:
                least = min(least, vec.dot(pose.velocity(pose.arm(one.flat, one.corner)), one.towards))
        return least + 0.5 * SLIDING_STOPPED

    def _least_height(self) -> float:
        """Return the least height, m, of a corner that is not held, plus the depth that it may have."""
        least = _INFINITE
        for k in range(self.there.count):
            least = min(least, self.there.heights[k] + self.depths[k])
        return least

    def _left_at(self, kind: int, x: float) -> float:
        """Return what is left at a share of the step: the least height, m, force, N, or speed, m/s."""
        self._interpolated().within(x, self.probe)
        if kind == _HEIGHT:
            self.there.take(self.solid, self.probe)
            return self._least_height()
        if kind == _BEGUN:
            self.held.pose.take(self.probe)
            return self._least_begun()
        self.held.push(self.probe)
        return self.held.least_left()

    def _first_dip(self) -> float:
        """Return the first share of the step at which a corner that falls and rises is lowest, below a flat.

        Heights and rates at both ends make a cubic. Corners that by their first rate stay above their flat
        are left out. Without any, it is 1.
        """
        first, span = 1.0, self.span
        for k in range(self.here.count):
            height, rate = self.here.heights[k], self.here.rates[k] * span
            last, rise = self.there.heights[k], self.there.rates[k] * span
            if rate < 0.0 < rise and height + rate < 0.0 and self.depths[k] < _INFINITE:
                change = last - height
                # The derivative is a x^2 + b x + rate, which is below zero at 0 and above at 1.
                a, b = 3.0 * (rate + rise - 2.0 * change), 2.0 * (3.0 * change - 2.0 * rate - rise)
                x = 2.0 * -rate / (b + math.sqrt(max(b * b - 4.0 * a * rate, 0.0)))
                if x < first and self._left_at(_HEIGHT, x) < 0.0:
                    first = x
                self.there.take(self.solid, self.trial)
        return first

    def _crossing(self, kind: int, bad: float, enough: float) -> float:
        """Return where in [0, ``bad``], as a share of the step, a value becomes negative: just after that.

        Just after is where the value is between -``enough`` and 0, or a time of `PHASE_LEAST_STEP` later at
        most. The root is that of the value plus half of ``enough``. It is found by inverse quadratic
        interpolation where that is safe, and by halves otherwise (Chandrupatla 1997).
        """
        half = 0.5 * enough
        a, f_a = bad, self._left_at(kind, bad) + half
        if f_a > -half:  # it is there already, or the interpolant is off by rounding
            return bad
        begun = self._left_at(kind, 0.0)
        if begun < -enough:
            return min(bad, PHASE_LEAST_STEP / self.span)
        b, f_b = 0.0, max(begun, 0.0) + half
        share = 0.5
        for _ in range(_MAX_ROOT_STEPS):
            x = a + share * (b - a)
            f_x = self._left_at(kind, x) + half
            if abs(f_x) < half:
                return x
            if (f_x > 0.0) == (f_a > 0.0):
                c, f_c = a, f_a
            else:
                c, f_c, b, f_b = b, f_b, a, f_a
            a, f_a = x, f_x
            least = PHASE_LEAST_STEP / (abs(b - a) * self.span)
            if least >= 1.0:
                break
            place, height = (a - b) / (c - b), (f_a - f_b) / (f_c - f_b)
            share = 0.5
            rest = 1.0 - height
            if height * height < place and rest * rest < 1.0 - place:
                share = f_a / (f_b - f_a) * f_c / (f_b - f_c)
                share += (c - a) / (b - a) * f_a / (f_c - f_a) * f_b / (f_c - f_b)
            share = min(max(share, 0.5 * least), 1.0 - 0.5 * least)
        return a if f_a < 0.0 else b
