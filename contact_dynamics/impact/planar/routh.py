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

All numbers here are plain floats in contact axes, tangent and normal. `one_contact` and `two_bodies` apply
this to bodies, and `batch` repeats the same operations in the same order on arrays.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw, refuse_unknown

LARGEST_FRICTION: Final = 1e100
"""A larger coefficient of friction counts as this one. No path differs in any digit, and mu a cannot
overflow."""

_POISSON: Final = RestitutionLaw.POISSON  # an enumeration finds a member in 30 ns, a module in 2
_NEWTON: Final = RestitutionLaw.NEWTON
_ENERGETIC: Final = RestitutionLaw.ENERGETIC


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
    per_mass = 1.0 / mass
    return InverseInertia(
        per_mass + r_n * r_n / inertia,
        -(r_t * r_n) / inertia,
        per_mass + r_t * r_t / inertia,
        per_mass * (per_mass + (r_t * r_t + r_n * r_n) / inertia),
    )


def pair_inverse_inertia(
    body: tuple[float, float, float, float], other: tuple[float, float, float, float]
) -> InverseInertia:
    """Return how the relative velocity of two bodies responds. Each body is its mass, inertia, r_t and r_n.

    The impulses on the two are opposite, so their responses add. The determinant is expanded into terms that
    cannot cancel.
    """
    (m_1, i_1, t_1, n_1), (m_2, i_2, t_2, n_2) = body, other
    a_1, b_1, c_1, det_1 = inverse_inertia(m_1, i_1, t_1, n_1)
    a_2, b_2, c_2, det_2 = inverse_inertia(m_2, i_2, t_2, n_2)
    crossing = n_1 * t_2 - n_2 * t_1
    mixed = 2.0 / (m_1 * m_2)
    mixed += (t_2 * t_2 + n_2 * n_2) / (m_1 * i_2) + (t_1 * t_1 + n_1 * n_1) / (m_2 * i_1)
    mixed += crossing * crossing / (i_1 * i_2)
    return InverseInertia(a_1 + a_2, b_1 + b_2, c_1 + c_2, det_1 + det_2 + mixed)


def impulse_path(  # noqa: C901, PLR0912, PLR0915, PLR0917 - one computation; each call costs a tenth of it
    v_t: float, v_n: float, response: InverseInertia, friction: float, restitution: float, law: RestitutionLaw
) -> ImpulsePath:
    """Return the path of a contact that starts at (``v_t``, ``v_n``), m/s, with ``v_n`` <= 0.

    A velocity of exactly 0 means that the contact does not slide, or does not approach. The caller has
    applied the tolerances.
    """
    a, b, c, det = response
    mu = min(friction, LARGEST_FRICTION)
    holds = abs(b) <= mu * a
    if v_t == 0.0 and holds:
        s, p_stop = 0.0, 0.0
    else:
        s = math.copysign(1.0, b if v_t == 0.0 else v_t)
        slowing = mu * a - s * b
        p_stop = abs(v_t) / slowing if slowing > 0.0 else math.inf
    rate_1 = c - s * mu * b
    jams = s != 0.0 and rate_1 < 0.0
    if v_n == 0.0 and not jams:
        return ImpulsePath(ImpactOutcome.NO_IMPULSE, jams, math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, v_t, 0.0)

    # rate_2 is the rate of v_n after the stop, and v_stop is v_n at the stop.
    rate_2 = det / a if holds else c + s * mu * b
    v_stop = v_n + rate_1 * p_stop if p_stop < math.inf else math.inf
    stops_early = v_stop <= 0.0
    if stops_early:
        p_c = p_stop - v_stop / rate_2
        rate = rate_2
    else:
        p_c = -v_n / rate_1
        rate = rate_1

    # These are the closed forms of the laws for a path that does not bend during restitution (see
    # `impact.law`).
    taken = 0.0
    if law is _POISSON:
        gain = restitution * p_c
        v_end = rate * gain
    elif law is _NEWTON:
        v_end = restitution * -v_n
        gain = v_end / rate
    elif law is _ENERGETIC:
        # This is twice the work that compression took, which is the area between v_n over p and zero.
        taken = -(v_n + v_stop) * p_stop - v_stop * (p_c - p_stop) if stops_early else -v_n * p_c
        gain = restitution * math.sqrt(taken / rate)
        v_end = rate * gain
    else:
        refuse_unknown(law)
    p_end = p_c + gain

    stops_late = not stops_early and p_end > p_stop
    if stops_late:
        if law is _POISSON:
            v_end = v_stop + rate_2 * (p_end - p_stop)
        elif law is _NEWTON:
            p_end = p_stop + (v_end - v_stop) / rate_2
        elif law is _ENERGETIC:
            rest = restitution * restitution * taken - v_stop * (p_stop - p_c)
            after = rest / (v_stop + math.sqrt(v_stop * v_stop + rate_2 * rest))
            p_end = p_stop + after
            v_end = v_stop + rate_2 * after
        else:
            refuse_unknown(law)

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

    if s == 0.0:
        outcome = ImpactOutcome.STICKS_THROUGHOUT
    elif stops_early:
        outcome = ImpactOutcome.STICKS_IN_COMPRESSION if holds else ImpactOutcome.REVERSES_IN_COMPRESSION
    elif stops_late:
        outcome = ImpactOutcome.STICKS_IN_RESTITUTION if holds else ImpactOutcome.REVERSES_IN_RESTITUTION
    else:
        outcome = ImpactOutcome.SLIDES
    return ImpulsePath(outcome, jams, p_stop, t_stop, p_c, t_c, p_end, t_end, v_t_end, v_end)
