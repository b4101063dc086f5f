# SPDX-License-Identifier: Apache-2.0
"""This file follows the impulse path of one contact in space, from the first touch to the end of restitution.

The contact first slides. It swerves (`SlidingSeries`), or slides straight if its direction is invariant.
After a stop it sticks, or it leaves in the one admissible direction (`SlidingLaw`). Its path is straight in
both cases. Straight paths have closed forms. These are the paths of central and spherical impacts, of planar
impacts put into space, of impacts without friction, and of every impact after its stop.

`path.pxd` gives the C types with which this file compiles (`numerics.compiled`). It is plain Python all the
same, and both forms give the same bits. A series is a list of fixed length here, which is an array in C. In
C, a quotient by zero is not an error, and functions have no keywords.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.planar.routh import LARGEST_FRICTION
from contact_dynamics.tolerances import (
    AT_THE_STOP,
    ESCAPE_ARRIVED,
    EVENT_LOCATED,
    LAST_TERM,
    LEAST_FRICTION,
    SETTLED_TURN,
    SINGULAR_RESPONSE,
    SLOW_TURNING,
    SMALLEST,
    STOPPED,
    STRAIGHT,
    TRUNCATION,
    UNCOUPLED,
)

MAX_STRETCHES: Final = 2000

MAX_ITERATIONS: Final = 100

ESCAPE_ROUNDS: Final = 60
"""Bound on the iterations for the direction in which a contact leaves. They converge quadratically."""

TERMS_ROUNDING: Final = 1.0 / 16.0
"""Share of the terms that a turning is summed from which counts beside the attraction: 16 times less than
`SETTLED_TURN` are two roundings."""

ORDER: Final = 24
"""Degree of the series of a stretch, whose integrals have one term more. A decay e^-s, whose series converges
everywhere, is reached over s = 0.9 by 16 terms and over s = 2.6 by 24, for twice the work."""

LONGEST: Final = 16.0
"""Longest stretch, in s. It only matters where hardly anything changes."""

SURE: Final = 0.5
"""Length of a stretch, in s, where the last terms underflow to zero, so that they do not say how far the
series reaches. The direction hardly turns over this length."""

TERMS: Final = 24
"""Terms of the series to a stop. With the limit on the last of them it reaches a third to a half of the way
to the next zero of h."""

FARTHEST: Final = 0.8
"""rad. Beyond it the series to a stop is not tried, since it would not converge."""

ROUNDS: Final = 8
"""Newton's steps towards the direction at the stop. They converge quadratically."""

SLOW_TERMS: Final = 10
"""Terms of the iteration for slow turning. They need derivatives up to this order."""

_INFINITE: Final = math.inf
_NOT_ENDED: Final = -1
"""Stands for an outcome where a path has no end, which only singular mechanisms have: they can wedge."""

# What the enumerations mean, as numbers that compiled code has at hand.
_START: Final = PathEvent.START
_SLIDING_STOPS: Final = PathEvent.SLIDING_STOPS
_COMPRESSION_ENDS: Final = PathEvent.COMPRESSION_ENDS
_RESTITUTION_ENDS: Final = PathEvent.RESTITUTION_ENDS
_SAMPLE: Final = PathEvent.SAMPLE
_NO_IMPULSE: Final = ImpactOutcome.NO_IMPULSE
_SLIDES: Final = ImpactOutcome.SLIDES
_STICKS_THROUGHOUT: Final = ImpactOutcome.STICKS_THROUGHOUT
_STICKS_IN_COMPRESSION: Final = ImpactOutcome.STICKS_IN_COMPRESSION
_REVERSES_IN_COMPRESSION: Final = ImpactOutcome.REVERSES_IN_COMPRESSION
_STICKS_IN_RESTITUTION: Final = ImpactOutcome.STICKS_IN_RESTITUTION
_REVERSES_IN_RESTITUTION: Final = ImpactOutcome.REVERSES_IN_RESTITUTION

# An enumeration takes longer to find a member.
OUTCOMES: Final = tuple(ImpactOutcome)
_EVENTS: Final = tuple(PathEvent)

Impulse = tuple[float, float, float]  # N s: two tangential components and the normal one


class SpatialPath(NamedTuple):
    """An impulse path in contact axes, which are the two principal tangents and then the normal.

    Attributes:
        outcome: What the contact did.
        jams: Whether sliding drove the contact into compression at first.
        vertices: N s, the points of the path, each with its meaning.
        compression: N s, the impulse at the end of compression.
        impulse: N s, the total impulse.
        u: m/s, sliding velocity afterwards.
        v_n: m/s, normal velocity afterwards.
    """

    outcome: ImpactOutcome
    jams: bool
    vertices: list[tuple[PathEvent, Impulse]]
    compression: Impulse
    impulse: Impulse
    u: tuple[float, float]
    v_n: float


def trace(
    sliding: SlidingLaw, u: tuple[float, float], v_n: float, *, restitution: float, law: RestitutionLaw
) -> SpatialPath:
    """Return the path of a contact that starts with ``u``, tangential, and ``v_n`` <= 0, normal, m/s.

    A velocity of exactly 0 means that the contact does not slide, or does not approach. The caller has
    applied the tolerances.
    """
    vertices: list[tuple[PathEvent, Impulse]] = []
    progress = Progress(RULES[law], vertices)
    tracer = Tracer(sliding, progress)
    outcome = tracer.trace(u[0], u[1], v_n, restitution)
    if outcome == _NOT_ENDED:
        raise AssertionError  # each stretch turns or slows the sliding by a fixed part
    return SpatialPath(
        OUTCOMES[outcome],
        tracer.jams,
        vertices,
        (progress.c1, progress.c2, progress.c),
        (progress.i1, progress.i2, progress.p),
        (tracer.u1, tracer.u2),
        progress.v_n,
    )


class SlidingLaw:
    """How a contact in space slides under a growing normal impulse (Routh 1860; Keller 1986).

    Tangential axes are the principal ones of the tangential block of the contact's inverse inertia. With the
    normal impulse p, the tangential velocity u, and friction -mu u/|u| per unit of normal impulse, this gives

        du/dp = k - mu L u/|u|,     dv_n/dp = k_n - mu k . u/|u|,     L = diag(l_1, l_2).

    The sliding direction turns at the rate (component of du/dp across u)/|u|. That component is the
    derivative of E = k . d - mu/2 d.L d along the circle of directions d. So directions climb E, and no path
    circles for ever. There are two or four directions that stay as they are (*invariant* ones), and every
    other one is a maximum of E.

    A contact that has stopped stays if friction can hold it, |L^-1 k| <= mu. If not, it leaves in the one
    direction d that it can keep while speeding up, (mu L + g) d = k with g > 0. There is exactly one, because
    the length of (mu L + g)^-1 k falls from above 1 to 0 as g grows from 0. While it leaves, dv_n/dp > mu g >
    0, since the inverse inertia is positive definite.

    A mechanism's inverse inertia may be singular. In a tangential direction in which it cannot move, l = k =
    0, and friction that holds has no component there, which is the least that holds. If a contact that does
    not slide cannot move along the normal either, ``rise`` is 0: the contact is wedged while it sticks.

    Attributes:
        l1: 1/kg, first principal tangential inverse inertia, >= 0.
        l2: 1/kg, second principal tangential inverse inertia, >= 0.
        k1: 1/kg, coupling of the first tangential direction with the normal.
        k2: 1/kg, coupling of the second tangential direction with the normal.
        kn: 1/kg, normal inverse inertia, > 0.
        x1: The first tangential impulse for each normal one that keeps a stopped contact where it is.
        x2: The second one.
        rise: 1/kg, dv_n/dp of a stopped contact that friction holds, >= 0.
        mu: Coulomb's coefficient, with which the path is followed. It is 0 where friction is too small to
            change anything. Otherwise the path would be followed to a stop that is farther away than numbers
            reach.
    """

    def __init__(self, l1: float, l2: float, k1: float, k2: float, kn: float, friction: float) -> None:
        self.take(l1, l2, k1, k2, kn, friction)

    def take(self, l1: float, l2: float, k1: float, k2: float, kn: float, friction: float) -> None:
        """Take the numbers of another contact."""
        self.l1, self.l2, self.k1, self.k2, self.kn = l1, l2, k1, k2, kn
        self.x1 = -k1 / l1 if l1 > 0.0 else 0.0
        self.x2 = -k2 / l2 if l2 > 0.0 else 0.0
        self.rise = kn + k1 * self.x1 + k2 * self.x2
        self.mu = min(friction, LARGEST_FRICTION) * (1.0 if friction >= LEAST_FRICTION else 0.0)

    def round_rise(self, least: float) -> bool:
        """Make a ``rise`` of 0 of one that is rounding, and return whether it is not negative.

        A response, 1/kg, counts as none up to ``least``. The rise is that of the vector (x1, x2, 1).
        """
        if abs(self.rise) <= least * (1.0 + self.x1 * self.x1 + self.x2 * self.x2):
            self.rise = 0.0
        return self.rise >= 0.0

    def holds(self) -> bool:
        """Return whether friction can hold a contact that has stopped."""
        return math.sqrt(self.x1 * self.x1 + self.x2 * self.x2) <= self.mu

    def coupling(self) -> float:
        """Return the length of k, 1/kg."""
        return math.sqrt(self.k1 * self.k1 + self.k2 * self.k2)

    def scale(self) -> float:
        """Return a bound on the length of du/dp, 1/kg."""
        return self.coupling() + self.mu * max(self.l1, self.l2)

    def speeding(self, d1: float, d2: float) -> float:
        """Return d|u|/dp, 1/kg, in the unit direction (d1, d2)."""
        return self.k1 * d1 + self.k2 * d2 - self.mu * (self.l1 * d1 * d1 + self.l2 * d2 * d2)

    def turning(self, d1: float, d2: float) -> float:
        """Return |u| times the rate of turning, 1/kg. It is zero in an invariant direction."""
        return self.k2 * d1 - self.k1 * d2 + self.mu * (self.l1 - self.l2) * d1 * d2

    def attraction(self, d1: float, d2: float) -> float:
        """Return the derivative of `turning` in the angle. It is negative where neighbours come closer."""
        return self.mu * (self.l1 - self.l2) * (d1 * d1 - d2 * d2) - self.k1 * d1 - self.k2 * d2

    def lifting(self, d1: float, d2: float) -> float:
        """Return dv_n/dp, 1/kg, while sliding in the unit direction (d1, d2). It is negative if that jams."""
        return self.kn - self.mu * (self.k1 * d1 + self.k2 * d2)

    def keeps(self, d1: float, d2: float, started: bool) -> bool:
        """Return whether sliding keeps the unit direction (d1, d2), to rounding.

        A direction that attracts its neighbours is kept once no more than rounding is left of its turning.
        One that repels them is kept within the rounding of the coefficients, and only at first: sliding that
        has swerved leaves such directions.
        """
        turning, attraction = abs(self.turning(d1, d2)), self.attraction(d1, d2)
        if attraction < 0.0:
            terms = abs(self.k2 * d1) + abs(self.k1 * d2) + self.mu * abs((self.l1 - self.l2) * d1 * d2)
            return turning <= SETTLED_TURN * max(-attraction, TERMS_ROUNDING * terms)
        return not started and turning <= max(STRAIGHT * self.scale(), UNCOUPLED * (self.l1 + self.l2))

    def settled(self, d1: float, d2: float) -> tuple[float, float]:
        """Return the invariant direction beside a kept one that attracts, and else the direction itself.

        It is one of Newton's steps away. The rates along it are right even where they are small beside the
        rate at which neighbours come closer, as for slender bodies.
        """
        attraction = self.attraction(d1, d2)
        attracts = 1.0 if attraction < 0.0 else 0.0
        step = attracts * self.turning(d1, d2) / (attraction - SMALLEST)
        return d1 + step * d2, d2 - step * d1

    def escape_step(self, g: float) -> tuple[float, float, float]:
        """Return (mu L + g)^-1 k, and the step from ``g`` that makes its length 1.

        This is Newton's method on 1/|d| - 1, which is concave and rises. So the steps come from the left and
        do not overshoot.
        """
        m1, m2 = self.mu * self.l1 + g, self.mu * self.l2 + g
        d1, d2 = self.k1 / m1, self.k2 / m2
        square = d1 * d1 + d2 * d2
        step = (math.sqrt(square) - 1.0) * square / (d1 * d1 / m1 + d2 * d2 / m2)
        return d1, d2, step

    def after_stop(self) -> tuple[float, float, float, float]:
        """Return d(I_1, I_2)/dp, dv_n/dp and d|u|/dp of a stopped contact. If it is held, the last is 0."""
        if self.holds():
            return self.x1, self.x2, self.rise, 0.0
        g = max(abs(self.k1) - self.mu * self.l1, abs(self.k2) - self.mu * self.l2, 0.0)
        d1, d2, step = self.escape_step(g)
        for _ in range(ESCAPE_ROUNDS):
            g += step
            arrived = step <= ESCAPE_ARRIVED * g
            d1, d2, step = self.escape_step(g)
            if arrived:
                break
        length = math.sqrt(d1 * d1 + d2 * d2)
        d1, d2 = d1 / length, d2 / length
        return -self.mu * d1, -self.mu * d2, self.lifting(d1, d2), g


class RestitutionRule:
    """The rule of Poisson's law: it says what compression collects and where restitution ends.

    ``due`` is what restitution still owes, in the unit of the amount. ``final`` is the velocity at which
    Newton's law ends the impact, m/s.

    Attributes:
        needs_work: Whether the work of the normal impulse must be known on the way.
    """

    def __init__(self, *, needs_work: bool = False) -> None:
        self.needs_work = needs_work

    def share(self, restitution: float, v_n: float) -> float:
        """Return the part of the amount that restitution gives back, for a coefficient e.

        ``v_n``, m/s, is the normal velocity before the impact, on which e may depend.
        """
        return restitution

    def final(self, restitution: float, v_n: float) -> float:
        """Return the velocity at which Newton's law ends an impact that begins with ``v_n``, m/s."""
        return restitution * -v_n

    def amount(self, p: float, work: float) -> float:
        """Return the amount that a normal impulse, N s, collects or gives back while it does some work, J."""
        return p

    def is_done(self, p: float, v_n: float, work: float, due: float, final: float) -> bool:
        """Return whether restitution is over once an impulse, with its work, has led to v_n."""
        return self.amount(p, work) >= due

    def distance(self, v_n: float, lifting: float, due: float, final: float) -> float:
        """Return the normal impulse, N s, that is left until restitution is over.

        The normal velocity grows by ``lifting`` for each N s.
        """
        return due

    def meter(self, velocity: list[float], impulse: list[float], work: list[float]) -> list[float]:
        """Return which series along a path tells when restitution is over."""
        return impulse

    def level(self, first: float, due: float, final: float) -> float:
        """Return the value that the meter has when restitution is over.

        ``first`` is the value of the meter at the beginning of the stretch.
        """
        return first + due


class NewtonRule(RestitutionRule):
    """Newton's law looks at the normal velocity alone."""

    def is_done(self, p: float, v_n: float, work: float, due: float, final: float) -> bool:
        """Return whether the final velocity is reached."""
        return v_n >= final

    def distance(self, v_n: float, lifting: float, due: float, final: float) -> float:
        """Return the normal impulse, N s, until the final velocity."""
        missing = final - v_n
        if missing <= 0.0:
            return 0.0
        return missing / lifting if lifting > 0.0 else _INFINITE

    def meter(self, velocity: list[float], impulse: list[float], work: list[float]) -> list[float]:
        """Return the series of the velocity."""
        return velocity

    def level(self, first: float, due: float, final: float) -> float:
        """Return the final velocity."""
        return final


class EnergeticRule(RestitutionRule):
    """The energetic law collects work, of which e squared is given back."""

    def share(self, restitution: float, v_n: float) -> float:
        """Return the square of e."""
        return restitution * restitution

    def amount(self, p: float, work: float) -> float:
        """Return the work."""
        return work

    def distance(self, v_n: float, lifting: float, due: float, final: float) -> float:
        """Return the normal impulse, N s, that does the work that is due."""
        if due <= 0.0:
            return 0.0
        square = v_n * v_n + 2.0 * lifting * due
        return 2.0 * due / (v_n + math.sqrt(square)) if square > 0.0 else _INFINITE

    def meter(self, velocity: list[float], impulse: list[float], work: list[float]) -> list[float]:
        """Return the series of the work."""
        return work


RULES: Final = {
    RestitutionLaw.POISSON: RestitutionRule(),
    RestitutionLaw.NEWTON: NewtonRule(),
    RestitutionLaw.ENERGETIC: EnergeticRule(needs_work=True),
}
"""The rule of each law."""


class SlidingSeries:
    """One stretch of a swerving path as power series in a parameter s, from 0 to ``length``: Taylor's method.

    With ds = |law's scale| dp/|u|, the sliding equations lose their singularity at the stop. Their
    coefficients are then of size 1. Apart from the scale, which divides each,

        du/ds = |u| k - mu L u,    dp/ds = |u|,    dI/ds = -mu u,    dv_n/ds = k_n |u| - mu k . u.

    The series of q = |u| follows from that of q^2 = u.u, term by term. The last terms tell how far a series
    reaches (after Jorba and Zou 2005). A series is its own interpolant, so that events are located to
    rounding.

    Lists hold coefficients of rising powers, and `value` evaluates them. Impulses and work count from the
    start of the stretch.
    """

    def __init__(self) -> None:
        # ORDER + 1 coefficients
        self.u1 = [0.0] * 25  # m/s
        self.u2 = [0.0] * 25
        self.q = [0.0] * 25
        self.lifting = [0.0] * 25  # dv_n/ds
        # and one more in an integral
        self.normal_impulse = [0.0] * 26  # N s
        self.t1 = [0.0] * 26  # N s
        self.t2 = [0.0] * 26
        self.normal_velocity = [0.0] * 26  # m/s
        self.normal_work = [0.0] * 26  # J
        self.length = 0.0

    def expand(self, law: SlidingLaw, u1: float, u2: float, v_n: float, with_work: bool) -> None:
        """Expand about a state, m/s, with |u| > 0. The work is expanded on demand only."""
        per_scale = 1.0 / law.scale()
        k1, k2, kn, mu = law.k1 * per_scale, law.k2 * per_scale, law.kn * per_scale, law.mu
        m1, m2 = mu * law.l1 * per_scale, mu * law.l2 * per_scale
        x_n, y_n, q_n = u1, u2, math.sqrt(u1 * u1 + u2 * u2)
        first, per_speed = q_n, 1.0 / q_n
        x, y, q = self.u1, self.u2, self.q
        x[0], y[0], q[0] = x_n, y_n, q_n
        for n in range(1, ORDER + 1):
            share = 1.0 / n
            x_n, y_n = (k1 * q_n - m1 * x_n) * share, (k2 * q_n - m2 * y_n) * share
            x[n], y[n] = x_n, y_n
            # Half of what u.u has in its n-th coefficient beyond the known part of q's square.
            half = u1 * x_n + u2 * y_n
            for i in range(1, (n + 1) // 2):
                half += x[i] * x[n - i] + y[i] * y[n - i] - q[i] * q[n - i]
            if n % 2 == 0:
                i = n // 2
                half += 0.5 * (x[i] * x[i] + y[i] * y[i] - q[i] * q[i])
            q_n = half * per_speed
            q[n] = q_n
        opposing = -(mu * per_scale)
        b1, b2 = mu * k1, mu * k2
        p, t1, t2, v = self.normal_impulse, self.t1, self.t2, self.normal_velocity
        p[0], t1[0], t2[0], v[0] = 0.0, 0.0 * (opposing * u1), 0.0 * (opposing * u2), v_n
        for n in range(ORDER + 1):
            share = 1.0 / (n + 1)
            p[n + 1] = share * (per_scale * q[n])
            t1[n + 1] = share * (opposing * x[n])
            t2[n + 1] = share * (opposing * y[n])
            self.lifting[n] = kn * q[n] - b1 * x[n] - b2 * y[n]
            v[n + 1] = share * self.lifting[n]
        self.length = min(self._reach(first, ORDER), self._reach(first, ORDER - 1))
        if with_work:
            work = self.normal_work
            work[0] = 0.0 * (per_scale * (v_n * q[0]))
            for n in range(ORDER + 1):
                total = v_n * q[n]
                for i in range(1, n + 1):
                    total += v[i] * q[n - i]
                work[n + 1] = (1.0 / (n + 1)) * (per_scale * total)
            # The work is a product of two series, which leaves out more than either.
            size = max(abs(work[1]), abs(work[2]))
            last, before = abs(work[ORDER + 1]), abs(work[ORDER])
            reached = min(reach(size, last, ORDER + 1), reach(size, before, ORDER))
            self.length = min(self.length, reached)

    def _reach(self, size: float, n: int) -> float:
        """Return the `reach` of the velocities' series by their terms of degree ``n``.

        The terms are those of u and of the integral of |u|. Of |u| only the integral matters, and |u| has
        singularities of its own if the normal does not couple with u.
        """
        integral = (1.0 / (n + 1)) * self.q[n]
        return reach(size, max(abs(self.u1[n]), abs(self.u2[n]), abs(integral)), n)


def reach(size: float, term: float, n: int) -> float:
    """Return the length at which a ``term`` of degree ``n`` is `TRUNCATION` of ``size``."""
    return min((TRUNCATION * size / term) ** (1.0 / n), LONGEST) if term > 0.0 else SURE


def value(series: list[float], degree: int, s: float) -> float:
    """Return the value of a polynomial at ``s``."""
    total = series[degree]
    for i in range(degree - 1, -1, -1):
        total = total * s + series[i]
    return total


def gain(series: list[float], degree: int, begin: float, end: float) -> float:
    """Return the growth from ``begin`` to ``end`` of a polynomial that starts at 0."""
    total = value(series, degree, end)
    return total - value(series, degree, begin) if begin != 0.0 else total


def crossing(series: list[float], degree: int, level: float, begin: float, end: float) -> float:
    """Return where a polynomial, which is monotone there, crosses ``level`` between ``begin`` and ``end``.

    Newton's method works inside a bracket that bisection keeps.
    """
    low, high = begin, end
    first, last = value(series, degree, begin), value(series, degree, end)
    rising = last >= first
    s = end
    if last != first:
        s = begin + (end - begin) * min(max((level - first) / (last - first), 0.0), 1.0)
    for _ in range(MAX_ITERATIONS):
        total = series[degree]
        slope = 0.0 * total
        for i in range(degree - 1, -1, -1):
            slope = slope * s + total
            total = total * s + series[i]
        excess = total - level
        if (excess > 0.0) == rising:
            high = s
        else:
            low = s
        guess = s - excess / slope if slope != 0.0 else high
        if abs(guess - s) <= EVENT_LOCATED * abs(guess) and slope != 0.0:
            break
        s = guess if low < guess < high else 0.5 * (low + high)
    return s


class Progress:
    """How far an impact has come while the normal impulse grows, on a path that is not known in advance.

    The impact is in compression while the contact approaches, and in restitution while it leaves. Compression
    collects an amount, and restitution gives a share of it back. For Poisson's law the amount is the normal
    impulse, and for the energetic law it is the work of the normal impulse. Newton's law only looks at the
    normal velocity. In space the sliding direction swerves, so that a contact can approach once more before
    its restitution is over. Then the amount of the second compression is added to what is left of the first.
    """

    def __init__(self, rule: RestitutionRule, vertices: list[tuple[PathEvent, Impulse]] | None) -> None:
        self.rule = rule
        self.vertices = vertices
        self.keeps_vertices = vertices is not None
        self.begin(0.0, 0.0)

    def begin(self, restitution: float, v_n: float) -> None:
        """Begin an impact with the normal velocity ``v_n`` <= 0, m/s."""
        self.v_n = v_n
        self.i1 = self.i2 = self.p = 0.0  # N s, the impulse
        self.c1 = self.c2 = self.c = 0.0  # N s, the same at the last end of compression
        self.compressing = True
        self.over = False
        self.final_velocity = self.rule.final(restitution, v_n)  # m/s, Newton's end
        self.share = self.rule.share(restitution, v_n)
        self.due = 0.0  # N s or J, what restitution still owes

    def go_straight(self, length: float, rate1: float, rate2: float, lifting: float) -> float:
        """Advance by at most ``length`` of normal impulse while the impulse and v_n grow at constant rates.

        Returns:
            The normal impulse gone, N s. It is less than ``length`` if the impact was over before.
        """
        gone = 0.0
        while not self.over:
            rest = length - gone
            if self.compressing:
                turn = -self.v_n / lifting if lifting > 0.0 else _INFINITE
                step = min(turn, rest)
                self._straight_step(step, rate1, rate2, lifting)
                gone += step
                if turn >= rest:
                    break
                self._end_compression()
            else:
                end = self.rule.distance(self.v_n, lifting, self.due, self.final_velocity)
                turn = self.v_n / -lifting if lifting < 0.0 else _INFINITE
                step = min(end, turn, rest)
                self._straight_step(step, rate1, rate2, lifting)
                gone += step
                if step == end:
                    self._finish()
                elif step == turn:
                    self._compress_again()
                else:
                    break
        return gone

    def go_curved(self, series: SlidingSeries, begin: float, end: float) -> float:
        """Advance along ``series`` from ``begin`` to ``end``, between which v_n rises or falls throughout.

        Returns:
            The parameter reached. It is less than ``end`` if the impact was over before.
        """
        s = begin
        v_n = series.normal_velocity
        while not self.over:
            v_end = value(v_n, ORDER + 1, end)
            if self.compressing:
                if v_end < 0.0:
                    return self._curved_step(series, s, end, v_end)
                s = self._curved_step(series, s, crossing(v_n, ORDER + 1, 0.0, s, end), 0.0)
                self._end_compression()
                continue
            turn, v_turn = end, v_end
            if v_end < 0.0:
                turn, v_turn = crossing(v_n, ORDER + 1, 0.0, s, end), 0.0
            finish = self._curved_finish(series, s, turn)
            if finish >= 0.0:
                s = self._curved_step(series, s, finish, value(v_n, ORDER + 1, finish))
                self._finish()
                break
            s = self._curved_step(series, s, turn, v_turn)
            if v_end >= 0.0:
                break
            self._compress_again()
        return s

    def jump(self, i1: float, i2: float, p: float, v_n: float, work: float) -> bool:
        """Advance by an impulse at once, to ``v_n``, unless compression or the impact ends on the way.

        The normal velocity must rise all the way, or fall all the way.

        Returns:
            Whether the impact has advanced.
        """
        if self.compressing:
            if v_n > 0.0:
                return False
        elif v_n < 0.0 or self.rule.is_done(p, v_n, work, self.due, self.final_velocity):
            return False
        self._account(p, work)
        self.i1 += i1
        self.i2 += i2
        self.p += p
        self.v_n = v_n
        return True

    def sample(self, event: int) -> None:
        """Add the present impulse to the path, if its vertices are kept."""
        if self.keeps_vertices:
            self._add_vertex(event)

    def stop_at(self, v_n: float) -> bool:
        """Take the normal velocity at the stop, m/s, and return whether the impact can end with it.

        It cannot if the contact approaches, or if it must leave faster by Newton's or the energetic law.
        """
        self.compressing = self.compressing or v_n < 0.0
        if self.compressing and v_n >= 0.0:
            self._end_compression()
        self.v_n = v_n
        end = self.rule.distance(v_n, 0.0, self.due, self.final_velocity)
        return not self.compressing and end < _INFINITE

    def _add_vertex(self, event: int) -> None:
        if self.vertices is not None:
            self.vertices.append((_EVENTS[event], (self.i1, self.i2, self.p)))

    def _straight_step(self, step: float, rate1: float, rate2: float, lifting: float) -> None:
        work = step * (self.v_n + 0.5 * lifting * step)
        self.i1 += rate1 * step
        self.i2 += rate2 * step
        self.p += step
        self._account(step, work)
        self.v_n += lifting * step

    def _curved_step(self, series: SlidingSeries, begin: float, end: float, v_n: float) -> float:
        """Advance to ``end``, where the normal velocity is ``v_n``, and return ``end``."""
        p = gain(series.normal_impulse, ORDER + 1, begin, end)
        work = gain(series.normal_work, ORDER + 1, begin, end) if self.rule.needs_work else 0.0
        self._account(p, work)
        self.i1 += gain(series.t1, ORDER + 1, begin, end)
        self.i2 += gain(series.t2, ORDER + 1, begin, end)
        self.p += p
        self.v_n = v_n
        return end

    def _curved_finish(self, series: SlidingSeries, begin: float, end: float) -> float:
        """Return the parameter in [begin, end] at which restitution is complete, or -1 if it is not."""
        meter = self.rule.meter(series.normal_velocity, series.normal_impulse, series.normal_work)
        first = value(meter, ORDER + 1, begin)
        level = self.rule.level(first, self.due, self.final_velocity)
        if first >= level:
            return begin
        if value(meter, ORDER + 1, end) >= level:
            return crossing(meter, ORDER + 1, level, begin, end)
        return -1.0

    def _account(self, p: float, work: float) -> None:
        amount = self.rule.amount(p, work)
        self.due += self.share * abs(amount) if self.compressing else -amount

    def _end_compression(self) -> None:
        self.v_n = 0.0
        self.compressing = False
        self.c1, self.c2, self.c = self.i1, self.i2, self.p
        self.sample(_COMPRESSION_ENDS)

    def _compress_again(self) -> None:
        self.v_n = 0.0
        self.compressing = True

    def _finish(self) -> None:
        self.over = True
        self.sample(_RESTITUTION_ENDS)


class Stop:
    """How much normal impulse brings a swerving contact to its stop, without following it there.

    A contact that stops does so in an invariant direction f with g < 0 that attracts its neighbours. Here g
    is d|u|/dp, and h is |u| times the rate of turning. Let x be the angle from f. Near f, the impulse that is
    left until the stop is |u| F(x), and friction dissipates mu |u|^2 G(x) on the way. Along the path
    d|u| : dx : dp = g : h/|u| : 1, so that

        h F' + g F = -1,        h G' + 2 g G = -1.

    The solutions that are regular at f are power series with the recurrence below. Both converge as far as
    the next zero of h.

    Where the direction turns slowly in comparison with the slowing down, |h| << |g|, the iteration
    F = -1/g - (h/g) F' gives the same solution anywhere, also far from f. Its terms fall like (h/g)^n until
    they are far below rounding. Then the path has all but stopped before its direction turns.

    Attributes:
        p: N s, the normal impulse until the stop.
        dissipated: J, the energy that friction dissipates until the stop, if it was asked for.
        d1: The first component of the sliding direction at the stop.
        d2: The second component of the sliding direction at the stop.
    """

    def __init__(self) -> None:
        self.p = self.dissipated = self.d1 = self.d2 = 0.0
        # Taylor coefficients of g and h in the angle: TERMS + 1 of them
        self.g = [0.0] * 25
        self.h = [0.0] * 25

    def find(self, law: SlidingLaw, u1: float, u2: float, first_speed: float, with_work: bool) -> bool:
        """Find the stop ahead of a contact that slides with (u1, u2), m/s, and slows down.

        Errors are compared with ``first_speed``, m/s, the sliding speed at the beginning of the whole path.

        Returns:
            Whether a stop is near and a series converges.
        """
        if law.l1 == 0.0 or law.l2 == 0.0:
            return False  # sliding that turns keeps its velocity along that tangent, and does not stop
        speed = math.sqrt(u1 * u1 + u2 * u2)
        d1, d2 = u1 / speed, u2 / speed
        if turns_slowly(law, d1, d2, speed, first_speed):
            last = self._find_slow(law, d1, d2, speed, with_work)
            if last * speed <= LAST_TERM * max(first_speed, speed):
                return True
        return self._find_near(law, u1, u2, speed, with_work)

    def _find_near(self, law: SlidingLaw, u1: float, u2: float, speed: float, with_work: bool) -> bool:
        """Find the stop in an attracting direction close to the present one."""
        d1, d2 = u1 / speed, u2 / speed
        angle = math.atan2(u2, u1)
        fixed = angle
        for _ in range(ROUNDS):
            attraction = law.attraction(d1, d2)
            if attraction >= 0.0:
                return False
            step = law.turning(d1, d2) / attraction
            fixed -= step
            if abs(fixed - angle) > FARTHEST:
                return False
            d1, d2 = math.cos(fixed), math.sin(fixed)
            if abs(step) < AT_THE_STOP:
                break
        if law.speeding(d1, d2) >= 0.0 or law.attraction(d1, d2) >= 0.0:
            return False
        self._expand(law, d1, d2, TERMS)
        if self.g[0] >= 0.0:
            return False  # by rounding, where the response is singular
        found, left = self._regular_solution(angle - fixed, 1.0)
        if not found:
            return False
        dissipation = 0.0
        if with_work:
            found, dissipation = self._regular_solution(angle - fixed, 2.0)
        self.p, self.dissipated = speed * left, law.mu * speed * speed * dissipation
        self.d1, self.d2 = d1, d2
        return found

    def _regular_solution(self, x: float, power: float) -> tuple[bool, float]:
        """Return whether the series of F has converged, with h F' + power g F = -1, regular at 0, and F(x).

        ``power`` is the power of |u| to which the sought quantity is proportional.
        """
        g, h = self.g, self.h
        f = [0.0] * 25  # TERMS + 1 coefficients of F
        f[0] = -1.0 / (power * g[0])
        total, x_n, last = f[0], 1.0, 0.0
        for m in range(1, TERMS + 1):
            known = g[m] * f[0]
            for i in range(1, m):
                known += g[m - i] * f[i]
            known = power * known
            for i in range(m - 1):
                known += h[m - i] * ((i + 1) * f[i + 1])
            f[m] = -known / (m * h[1] + power * g[0])
            x_n *= x
            term = f[m] * x_n
            total += term
            if m >= 2 and abs(term) + abs(last) <= LAST_TERM * abs(total):
                return True, total
            last = term
        return False, total

    def _find_slow(self, law: SlidingLaw, d1: float, d2: float, speed: float, with_work: bool) -> float:
        """Find the stop of a contact that turns slowly, and return the relative error."""
        self._expand(law, d1, d2, SLOW_TERMS)
        g, h = self.g, self.h
        reciprocal = [0.0] * 11  # SLOW_TERMS + 1 coefficients of 1/g
        reciprocal[0] = 1.0 / g[0]
        for n in range(1, SLOW_TERMS + 1):
            known = g[n] * reciprocal[0]
            for i in range(1, n):
                known += g[n - i] * reciprocal[i]
            reciprocal[n] = -known * reciprocal[0]
        left, last = slow_solution(reciprocal, h, 1.0)
        dissipation = 0.0
        if with_work:
            dissipation, last_too = slow_solution(reciprocal, h, 0.5)
            last = max(last, last_too)
        self.p, self.dissipated = speed * left, law.mu * speed * speed * dissipation
        self.d1, self.d2 = d1, d2
        return last

    def _expand(self, law: SlidingLaw, d1: float, d2: float, terms: int) -> None:
        """Expand g and h in the angle from the direction (d1, d2), up to ``terms``."""
        g, h = self.g, self.h
        mean = 0.5 * law.mu * (law.l1 + law.l2)
        spread = 0.5 * law.mu * (law.l1 - law.l2)
        along = law.k1 * d1 + law.k2 * d2
        across = law.k2 * d1 - law.k1 * d2
        cos_2, sin_2 = d1 * d1 - d2 * d2, 2.0 * d1 * d2
        share = 1.0
        for n in range(terms + 1):
            # n-th derivatives: g = k.d - mean - spread cos 2a, h = k x d + spread sin 2a.
            g[n] = (along - spread * cos_2) * share
            h[n] = (across + spread * sin_2) * share
            along, across = across, -along
            cos_2, sin_2 = -2.0 * sin_2, 2.0 * cos_2
            share /= n + 1
        g[0] -= mean


def turns_slowly(law: SlidingLaw, d1: float, d2: float, speed: float, first_speed: float) -> bool:
    """Return whether a contact that slows down in the direction (d1, d2) all but stops before it turns.

    The answer also demands that v_n rises all the way until then, or falls all the way. It does so if the
    rate of v_n has the same sign in all directions near by.
    """
    turning, change = abs(law.turning(d1, d2)), abs(law.attraction(d1, d2))
    ratio = (turning + change) / abs(law.speeding(d1, d2))
    squared = ratio * ratio
    eighth = squared * squared * squared * squared
    coupling = law.mu * law.coupling()
    keeps_rate = law.kn > coupling or abs(law.lifting(d1, d2)) > 0.5 * coupling
    return eighth * squared * speed <= SLOW_TURNING * first_speed and keeps_rate


def slow_solution(reciprocal: list[float], h: list[float], share: float) -> tuple[float, float]:
    """Return F with h F' + g F / share = -1 for slow turning, and the relative size of its last terms."""
    term, slope, product = [0.0] * 11, [0.0] * 11, [0.0] * 11  # SLOW_TERMS + 1 coefficients
    for n in range(SLOW_TERMS + 1):
        term[n] = -share * reciprocal[n]
    total = term[0]
    last = previous = abs(total)
    for terms in range(SLOW_TERMS, 0, -1):
        for n in range(terms):
            slope[n] = (n + 1) * term[n + 1]
        for n in range(terms):
            product[n] = coefficient(h, slope, n)
        for n in range(terms):
            term[n] = -share * coefficient(reciprocal, product, n)
        total += term[0]
        previous, last = last, abs(term[0])
    return total, (previous + last) / abs(total)


def coefficient(a: list[float], b: list[float], n: int) -> float:
    """Return coefficient ``n`` of a product of series."""
    total = a[n] * b[0]
    for i in range(1, n + 1):
        total += a[n - i] * b[i]
    return total


class Tracer:
    """Follows one path after the other, each with the numbers that its law has then.

    Attributes:
        u1: m/s, the first component of the sliding velocity.
        u2: m/s, the second one.
        jams: Whether sliding drove the contact into compression at first.
    """

    def __init__(self, law: SlidingLaw, progress: Progress) -> None:
        self.law = law
        self.progress = progress
        self.series = SlidingSeries()
        self.stop = Stop()
        self.u1 = self.u2 = 0.0
        self.jams = False

    def trace(self, u1: float, u2: float, v_n: float, restitution: float) -> int:  # noqa: PLR0911
        """Follow the path of a contact with these velocities, m/s, and return its outcome."""
        self.u1, self.u2 = u1, u2
        speed = math.sqrt(u1 * u1 + u2 * u2)
        self.jams = speed > 0.0 and self.law.lifting(u1 / speed, u2 / speed) < 0.0
        self.progress.begin(restitution, v_n)
        self.progress.sample(_START)
        if v_n == 0.0 and not self.jams:
            return _NO_IMPULSE
        in_compression = False
        if speed > 0.0:
            if not self._slide(speed):
                return _NOT_ENDED
            if self.progress.over:
                return _SLIDES
            in_compression = self.progress.compressing
            self.progress.sample(_SLIDING_STOPS)
        i1, i2, lifting, speeding = self.law.after_stop()
        held = speeding == 0.0
        if self.law.rise == 0.0:
            # No impulse changes this part of the velocity, so it is the whole velocity when sliding stops.
            part1, part2 = self.law.x1 * u1, self.law.x2 * u2
            kept, size = v_n + part1 + part2, abs(v_n) + abs(part1) + abs(part2)
            kept = kept if abs(kept) > SINGULAR_RESPONSE * size else 0.0
            in_compression = in_compression or kept == 0.0
            # Without hold x1 and x2 may be large, and inexact: then the v_n of the path is right.
            if (kept == 0.0 or held) and not self.progress.stop_at(kept) and held:
                return _NOT_ENDED
        gone = self.progress.go_straight(_INFINITE, i1, i2, lifting)
        self.u1 = 0.0 if held else (self.law.k1 + self.law.l1 * i1) * gone
        self.u2 = 0.0 if held else (self.law.k2 + self.law.l2 * i2) * gone
        if speed == 0.0:
            return _STICKS_THROUGHOUT if held else _SLIDES
        if in_compression:
            return _STICKS_IN_COMPRESSION if held else _REVERSES_IN_COMPRESSION
        return _STICKS_IN_RESTITUTION if held else _REVERSES_IN_RESTITUTION

    def _slide(self, first_speed: float) -> bool:
        """Follow sliding until it stops, with u = 0, or the impact is over. Return whether that happens.

        Errors are compared with ``first_speed``, m/s, the sliding speed at the beginning of the whole path.
        """
        slowest = STOPPED * first_speed
        with_work = self.progress.rule.needs_work
        ends_before = -1  # the phase (whether it is compression) that ends before the stop ahead, if known
        for stretch in range(MAX_STRETCHES):
            speed = math.sqrt(self.u1 * self.u1 + self.u2 * self.u2)
            d1, d2 = self.u1 / speed, self.u2 / speed
            speeding, lifting = self.law.speeding(d1, d2), self.law.lifting(d1, d2)
            if self.law.keeps(d1, d2, stretch > 0):
                d1, d2 = self.law.settled(d1, d2)
                self._slide_straight(d1, d2, speed)
                return True
            if speeding < 0.0 and speed <= slowest:
                self._slide_straight(d1, d2, speed)
                return True
            if self.law.mu == 0.0:
                # Without friction u changes along a line, which misses 0.
                p = self.progress.go_straight(_INFINITE, 0.0, 0.0, self.law.kn)
                self.u1 += self.law.k1 * p
                self.u2 += self.law.k2 * p
                return True
            if (
                speeding < 0.0
                and self.progress.compressing != ends_before
                and self.stop.find(self.law, self.u1, self.u2, first_speed, with_work)
                # If v_n rises at both ends it rises all the way, and if it falls at both it falls.
                and (lifting < 0.0) == (self.law.lifting(self.stop.d1, self.stop.d2) < 0.0)
            ):
                if self._jump_to_stop():
                    return True
                ends_before = self.progress.compressing
            self.series.expand(self.law, self.u1, self.u2, self.progress.v_n, with_work)
            self._slide_along(lifting)
            if self.progress.over:
                return True
            self.progress.sample(_SAMPLE)
        return False  # which cannot be for bodies: each stretch turns or slows the sliding by a fixed part

    def _jump_to_stop(self) -> bool:
        """Go to the stop that was found, unless compression or the impact ends before it."""
        p, v_n = self.stop.p, self.progress.v_n
        i1, i2 = -(self.u1 + self.law.k1 * p) / self.law.l1, -(self.u2 + self.law.k2 * p) / self.law.l2
        v_stop = v_n + self.law.kn * p + self.law.k1 * i1 + self.law.k2 * i2
        work = 0.5 * (i1 * self.u1 + i2 * self.u2 + p * (v_n + v_stop)) + self.stop.dissipated
        if not self.progress.jump(i1, i2, p, v_stop, work):
            return False
        self.u1 = self.u2 = 0.0
        return True

    def _slide_straight(self, d1: float, d2: float, speed: float) -> None:
        speeding = self.law.speeding(d1, d2)
        length = speed / -speeding if speeding < 0.0 else _INFINITE
        gone = self.progress.go_straight(
            length, -self.law.mu * d1, -self.law.mu * d2, self.law.lifting(d1, d2)
        )
        final = speed + speeding * gone if self.progress.over else 0.0
        self.u1, self.u2 = d1 * final, d2 * final

    def _slide_along(self, lifting: float) -> None:
        """Advance along one stretch, in two parts if v_n turns from falling to rising or back."""
        end = self.series.length
        s = 0.0
        if (value(self.series.lifting, ORDER, end) < 0.0) != (lifting < 0.0):
            s = self.progress.go_curved(self.series, 0.0, crossing(self.series.lifting, ORDER, 0.0, 0.0, end))
        if not self.progress.over:
            s = self.progress.go_curved(self.series, s, end)
        self.u1, self.u2 = value(self.series.u1, ORDER, s), value(self.series.u2, ORDER, s)
