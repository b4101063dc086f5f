# SPDX-License-Identifier: Apache-2.0
"""Routh's construction follows a planar impact through impulse space in closed form (lecture 27; Routh 1860).

The model has one contact with Coulomb friction. Positions do not change during the impact. The normal
impulse p grows from 0 and plays the part of time. The contact's velocity is affine in the impulse (lecture
27, eq. 8),

    v_t = v_t0 + a I_t + b p,        v_n = v_n0 + b I_t + c p,

so the path (I_t, p) is straight while the contact slides one way or sticks. It bends at most once, where it
meets the sticking line v_t = 0 (eq. 9). From there it goes on along that line if friction can hold the
contact, |b| <= mu a. If not, the contact slides back. Compression ends on the line v_n = 0 (eq. 10). After
the bend v_n always grows, because a c > b^2, so every path ends.

Sliding itself may drive the contact into compression: c < s mu b, where s is the sign of v_t (the lecture's
sliding rod, after Painleve 1895). Then v_n falls first. Such a path always meets the sticking line, and it
needs no approach to begin with.

The lecture has one slip: the compression impulse of an approaching particle is -m v_n, but its formulas write
m v_n.

All numbers here are plain floats in contact axes, tangent and normal, unless said otherwise. `routh.pxd` has
the C types with which this file compiles (`numerics.compiled`), so that batches are loops over the code of
one impact.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray

LARGEST_FRICTION: Final = 1e100
"""A larger coefficient of friction counts as this one. No path differs in any digit, and mu a cannot
overflow."""

_INFINITE: Final = math.inf
_MAX_FRICTION: Final = LARGEST_FRICTION

# What the enumerations mean, as numbers that compiled code has at hand.
_POISSON: Final = RestitutionLaw.POISSON
_NEWTON: Final = RestitutionLaw.NEWTON
_NO_IMPULSE: Final = ImpactOutcome.NO_IMPULSE
_SLIDES: Final = ImpactOutcome.SLIDES
_STICKS_THROUGHOUT: Final = ImpactOutcome.STICKS_THROUGHOUT
_STICKS_IN_COMPRESSION: Final = ImpactOutcome.STICKS_IN_COMPRESSION
_REVERSES_IN_COMPRESSION: Final = ImpactOutcome.REVERSES_IN_COMPRESSION
_STICKS_IN_RESTITUTION: Final = ImpactOutcome.STICKS_IN_RESTITUTION
_REVERSES_IN_RESTITUTION: Final = ImpactOutcome.REVERSES_IN_RESTITUTION

_OUTCOMES: Final = tuple(ImpactOutcome)  # an enumeration takes longer to find a member


class InverseInertia(NamedTuple):
    """The contact's response to an impulse, as the symmetric matrix [[a, b], [b, c]] of lecture 27, eq. 8.

    Attributes:
        a: 1/kg, tangential velocity per tangential impulse, > 0.
        b: 1/kg, tangential velocity per normal impulse, and normal velocity per tangential impulse.
        c: 1/kg, normal velocity per normal impulse, > 0.
        det: 1/kg^2, the determinant a c - b^2 > 0. It is formed without that subtraction.
    """

    a: float
    b: float
    c: float
    det: float


class ImpulsePath(NamedTuple):
    """One impulse path in contact axes. Each tangential impulse belongs to the normal one listed before it.

    Attributes:
        outcome: What the contact did.
        jams: Whether sliding drove the contact into compression.
        p_stop: N s, normal impulse at which sliding stops. It is infinite if sliding never stops.
        t_stop: N s, tangential impulse at which sliding stops.
        p_compression: N s, normal impulse at the end of compression.
        t_compression: N s, tangential impulse at the end of compression.
        p_end: N s, total normal impulse.
        t_end: N s, total tangential impulse.
        v_t: m/s, tangential velocity of the contact afterwards.
        v_n: m/s, normal velocity of the contact afterwards, >= 0.
    """

    outcome: ImpactOutcome
    jams: bool
    p_stop: float
    t_stop: float
    p_compression: float
    t_compression: float
    p_end: float
    t_end: float
    v_t: float
    v_n: float


def inverse_inertia(mass: float, inertia: float, r_t: float, r_n: float) -> InverseInertia:
    """Return the response at a contact at (r_t, r_n), m, from the centre of mass (lecture 27, eq. 8)."""
    strike = PlanarStrike(RestitutionLaw.POISSON)
    strike.respond(mass, inertia, r_t, r_n)
    return strike.response


def impulse_path(
    v_t: float, v_n: float, response: InverseInertia, friction: float, restitution: float, law: RestitutionLaw
) -> ImpulsePath:
    """Return the path of a contact that starts at (``v_t``, ``v_n``), m/s, with ``v_n`` <= 0.

    A velocity of exactly 0 means that the contact does not slide, or does not approach. The caller has
    applied the tolerances.
    """
    strike = PlanarStrike(law)
    strike.a, strike.b, strike.c, strike.det = response
    strike.follow(v_t, v_n, friction, restitution)
    return strike.path


def planar_strikes(
    columns: list[FloatArray], law: RestitutionLaw, tolerance: float
) -> tuple[NDArray[np.int64], FloatArray, tuple[int, float] | None]:
    """Return the strikes of many bodies against the fixed world.

    Args:
        columns: Numbers of each, (n,): the arguments of `PlanarStrike.strike`, but for the tolerance.
        law: What the coefficients of restitution mean.
        tolerance: m/s. A component of a contact's velocity within it counts as zero.

    Returns:
        The outcomes, (n,), and the results, (11, n): v_x, v_y and w afterwards, the total impulse, the
        impulse of compression, and the velocities of the contact before and after, all by components. Then
        the first case that separates, with its normal velocity, or None.
    """
    count = len(columns[0])
    outcomes, results = np.empty(count, dtype=np.int64), np.empty((11, count))
    strike = PlanarStrike(law)
    views: list[Any] = [*(x.data for x in columns), tolerance, outcomes.data, results.data]
    first = strike.strike_all(*views)
    return outcomes, results, None if first < 0 else (first, strike.v_n_before)


class PlanarStrike:
    """One body that strikes the fixed world at one contact, by one restitution law.

    Attributes are the numbers of `InverseInertia` and of `ImpulsePath`, then

        v_t_before, v_n_before: m/s, the contact's velocity before. Components within the tolerance are 0.
        i_x, i_y: N s, the total impulse on the body, axes of the plane.
        v_x, v_y, w: m/s and rad/s, the body's velocity afterwards.
    """

    def __init__(self, law: RestitutionLaw) -> None:
        self.law = int(law)
        self.outcome: int = _NO_IMPULSE
        self.jams = False
        self.a = self.b = self.c = self.det = 0.0
        self.p_stop = self.t_stop = self.p_compression = self.t_compression = 0.0
        self.p_end = self.t_end = self.v_t = self.v_n = 0.0
        self.v_t_before = self.v_n_before = 0.0
        self.i_x = self.i_y = self.v_x = self.v_y = self.w = 0.0

    @property
    def response(self) -> InverseInertia:
        """Return the contact's response."""
        return tuple.__new__(InverseInertia, (self.a, self.b, self.c, self.det))  # in half of a call's time

    @property
    def path(self) -> ImpulsePath:
        """Return the impulse path."""
        numbers = (
            _OUTCOMES[self.outcome],
            self.jams,
            self.p_stop,
            self.t_stop,
            self.p_compression,
            self.t_compression,
            self.p_end,
            self.t_end,
            self.v_t,
            self.v_n,
        )
        return tuple.__new__(ImpulsePath, numbers)

    def strike_all(  # the columns of `planar_strikes`
        self,
        mass: Any,
        inertia: Any,
        friction: Any,
        restitution: Any,
        v_x: Any,
        v_y: Any,
        w: Any,
        r_x: Any,
        r_y: Any,
        n_x: Any,
        n_y: Any,
        tolerance: float,
        outcomes: Any,
        results: Any,
    ) -> int:
        """Fill in ``outcomes`` and ``results`` of all strikes, and return the first that separates, or -1."""
        for i in range(len(outcomes)):
            if not self.strike(
                mass[i],
                inertia[i],
                friction[i],
                restitution[i],
                v_x[i],
                v_y[i],
                w[i],
                r_x[i],
                r_y[i],
                n_x[i],
                n_y[i],
                tolerance,
            ):
                return i
            outcomes[i] = self.outcome
            results[0, i], results[1, i], results[2, i] = self.v_x, self.v_y, self.w
            results[3, i], results[4, i] = self.t_end, self.p_end
            results[5, i], results[6, i] = self.t_compression, self.p_compression
            results[7, i], results[8, i] = self.v_t_before, self.v_n_before
            results[9, i], results[10, i] = self.v_t, self.v_n
        return -1

    def strike(
        self,
        mass: float,
        inertia: float,
        friction: float,
        restitution: float,
        v_x: float,
        v_y: float,
        w: float,
        r_x: float,
        r_y: float,
        n_x: float,
        n_y: float,
        tolerance: float,
    ) -> bool:
        """Strike, and return whether the contact does that: it separates if v_n is above ``tolerance``.

        Args:
            mass: kg.
            inertia: kg m^2.
            friction: Coulomb's coefficient.
            restitution: The coefficient of restitution.
            v_x: m/s, of the centre of mass, axes of the plane, and so on.
            v_y: m/s.
            w: rad/s.
            r_x: m, from the centre of mass to the contact.
            r_y: m.
            n_x: The unit normal into the body.
            n_y: The same.
            tolerance: m/s. A component of the contact's velocity within it counts as zero.
        """
        c_x = v_x - w * r_y
        c_y = v_y + w * r_x
        v_t = c_x * n_y - c_y * n_x
        v_n = c_x * n_x + c_y * n_y
        if v_n > tolerance:
            self.v_n_before = v_n
            return False
        if -tolerance <= v_t <= tolerance:
            v_t = 0.0
        if v_n >= -tolerance:
            v_n = 0.0
        r_t = r_x * n_y - r_y * n_x
        r_n = r_x * n_x + r_y * n_y
        self.respond(mass, inertia, r_t, r_n)
        self.follow(v_t, v_n, friction, restitution)
        self.v_t_before, self.v_n_before = v_t, v_n
        self.i_x = self.t_end * n_y + self.p_end * n_x
        self.i_y = self.p_end * n_y - self.t_end * n_x
        self.v_x = v_x + self.i_x / mass
        self.v_y = v_y + self.i_y / mass
        self.w = w + (r_t * self.p_end - r_n * self.t_end) / inertia
        return True

    def respond(self, mass: float, inertia: float, r_t: float, r_n: float) -> None:
        """Find the response at a contact at (r_t, r_n), m, from the centre of mass (lecture 27, eq. 8)."""
        per_mass = 1.0 / mass
        self.a = per_mass + r_n * r_n / inertia
        self.b = -(r_t * r_n) / inertia
        self.c = per_mass + r_t * r_t / inertia
        self.det = per_mass * (per_mass + (r_t * r_t + r_n * r_n) / inertia)

    def follow(  # noqa: C901, PLR0912, PLR0915 - one computation
        self, v_t: float, v_n: float, friction: float, restitution: float
    ) -> None:
        """Follow the path of a contact that starts at (``v_t``, ``v_n``), as `impulse_path` says."""
        a, b, c = self.a, self.b, self.c
        mu = min(friction, _MAX_FRICTION)
        holds = abs(b) <= mu * a
        s, p_stop = 0.0, 0.0
        if v_t != 0.0 or not holds:
            s = math.copysign(1.0, b if v_t == 0.0 else v_t)
            slowing = mu * a - s * b
            p_stop = abs(v_t) / slowing if slowing > 0.0 else _INFINITE
        rate_1 = c - s * mu * b
        self.jams = s != 0.0 and rate_1 < 0.0
        if v_n == 0.0 and not self.jams:
            self.outcome = _NO_IMPULSE
            self.p_stop, self.t_stop = _INFINITE, 0.0
            self.p_compression = self.t_compression = self.p_end = self.t_end = 0.0
            self.v_t, self.v_n = v_t, 0.0
            return

        # rate_2 is the rate of v_n after the stop, and v_stop is v_n at the stop.
        rate_2 = self.det / a if holds else c + s * mu * b
        v_stop = v_n + rate_1 * p_stop if p_stop < _INFINITE else _INFINITE
        stops_early = v_stop <= 0.0
        if stops_early:
            p_c = p_stop - v_stop / rate_2
            rate = rate_2
        else:
            p_c = -v_n / rate_1
            rate = rate_1

        # These are the closed forms of the laws for a path that does not bend during restitution (see
        # `impact.law`). The last one is the energetic law's.
        taken = 0.0
        if self.law == _POISSON:
            gain = restitution * p_c
            v_end = rate * gain
        elif self.law == _NEWTON:
            v_end = restitution * -v_n
            gain = v_end / rate
        else:
            # This is twice the work that compression took, which is the area between v_n over p and zero.
            taken = -(v_n + v_stop) * p_stop - v_stop * (p_c - p_stop) if stops_early else -v_n * p_c
            gain = restitution * math.sqrt(taken / rate)
            v_end = rate * gain
        p_end = p_c + gain

        stops_late = not stops_early and p_end > p_stop
        if stops_late:
            if self.law == _POISSON:
                v_end = v_stop + rate_2 * (p_end - p_stop)
            elif self.law == _NEWTON:
                p_end = p_stop + (v_end - v_stop) / rate_2
            else:
                rest = restitution * restitution * taken - v_stop * (p_stop - p_c)
                after = rest / (v_stop + math.sqrt(v_stop * v_stop + rate_2 * rest))
                p_end = p_stop + after
                v_end = v_stop + rate_2 * after

        # The tangential impulse follows the cone's edge, then the sticking line or the way back.
        s_mu = s * mu
        t_stop = 0.0
        t_c = -s_mu * p_c
        t_end = -s_mu * p_end
        v_t_end = v_t + a * t_end + b * p_end
        if stops_early or stops_late:
            t_stop = -s_mu * p_stop
            if holds:
                t_end = -(v_t + b * p_end) / a
                v_t_end = 0.0
                if stops_early:
                    t_c = -(v_t + b * p_c) / a
            else:
                t_end = s_mu * (p_end - p_stop - p_stop)
                v_t_end = v_t + a * t_end + b * p_end
                if stops_early:
                    t_c = s_mu * (p_c - p_stop - p_stop)

        self.outcome = _SLIDES
        if s == 0.0:
            self.outcome = _STICKS_THROUGHOUT
        elif stops_early:
            self.outcome = _STICKS_IN_COMPRESSION if holds else _REVERSES_IN_COMPRESSION
        elif stops_late:
            self.outcome = _STICKS_IN_RESTITUTION if holds else _REVERSES_IN_RESTITUTION
        self.p_stop, self.t_stop = p_stop, t_stop
        self.p_compression, self.t_compression = p_c, t_c
        self.p_end, self.t_end, self.v_t, self.v_n = p_end, t_end, v_t_end, v_end
