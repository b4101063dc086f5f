"""This file resolves many planar impacts at once.

The operations of `routh` and `one_contact` are repeated in the same order on arrays. Every number equals that
of the single call to the last bit, because both round all these operations correctly: sums, products,
quotients and square roots. Branches become masks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import NORMAL_HINT, SeparatingContactError
from contact_dynamics.impact.energy import ManyEnergies
from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw, refuse_unknown
from contact_dynamics.impact.planar.routh import LARGEST_FRICTION
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import FloatArray, check_magnitude, check_not_negative
from contact_dynamics.validation_batches import (
    check_not_negative_rows,
    check_positive_rows,
    check_rows,
    check_share_rows,
    check_sizes,
    check_unit_rows,
    common_length,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_CHUNK: Final = 4096

# The index of an outcome is a sum: 1 if sliding stops early, 2 if it stops late, 4 if friction holds.
_OUTCOMES: Final = np.array(
    [
        ImpactOutcome.SLIDES,
        ImpactOutcome.REVERSES_IN_COMPRESSION,
        ImpactOutcome.REVERSES_IN_RESTITUTION,
        ImpactOutcome.SLIDES,
        ImpactOutcome.SLIDES,
        ImpactOutcome.STICKS_IN_COMPRESSION,
        ImpactOutcome.STICKS_IN_RESTITUTION,
        ImpactOutcome.SLIDES,
    ],
    dtype=np.int64,
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlanarImpacts(ManyEnergies):
    """The answers to N planar impacts. Row i belongs to case i, and `PlanarImpact` explains the fields.

    Attributes:
        restitution_law: The restitution law of all of them.
        outcomes: (N,), values of ImpactOutcome.
        v: (N, 2), m/s, of the centres of mass afterwards, axes of the plane.
        w: (N,), rad/s, afterwards.
        impulses_C: (N, 2), N s, contact axes.
        compressions_C: (N, 2), N s, contact axes.
        velocities_before_C: (N, 2), m/s, of the contacts, contact axes.
        velocities_after_C: (N, 2), m/s, of the contacts, contact axes.
    """

    restitution_law: RestitutionLaw
    outcomes: NDArray[np.int64]
    v: FloatArray
    w: FloatArray
    impulses_C: FloatArray
    compressions_C: FloatArray
    velocities_before_C: FloatArray
    velocities_after_C: FloatArray

    def _at_contacts(self) -> tuple[list[FloatArray], ...]:
        return list(self.impulses_C.T), list(self.velocities_before_C.T), list(self.velocities_after_C.T)


def planar_impacts(
    *,
    masses: ArrayLike,
    inertias: ArrayLike,
    v: ArrayLike,
    w: ArrayLike,
    r: ArrayLike,
    normals: ArrayLike,
    frictions: ArrayLike,
    restitutions: ArrayLike,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> PlanarImpacts:
    """Return what N planar impacts do. Each answer is that of `planar_impact`.

    Args:
        masses: (N,) or one number, kg.
        inertias: (N,) or one number, kg m^2, about the centres of mass.
        v: (N, 2) or (2,), m/s, of the centres of mass.
        w: (N,) or one number, rad/s.
        r: (N, 2) or (2,), m, from the centres of mass to the contacts.
        normals: (N, 2) or (2,), unit, into the bodies.
        frictions: (N,) or one number, >= 0.
        restitutions: (N,) or one number, in [0, 1].
        restitution_law: What the coefficients of restitution mean.
        velocity_tolerance: m/s, >= 0. A component of a contact's velocity within it counts as zero.

    Raises:
        SeparatingContactError: a contact's normal velocity is above the tolerance; the message names the
            first.
        InvalidFieldError: a number is not allowed or beyond `LARGEST_NUMBER`, or a mass or an inertia is
            below its inverse. The message names the field and the first row.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    fields = {
        "masses": check_sizes("masses", check_positive_rows("masses", masses)),
        "inertias": check_sizes("inertias", check_positive_rows("inertias", inertias)),
        "frictions": check_not_negative_rows("frictions", frictions),
        "restitutions": check_share_rows("restitutions", restitutions),
        "v": check_magnitude("v", check_rows("v", v, (2,))),
        "w": check_magnitude("w", check_rows("w", w)),
        "r": check_magnitude("r", check_rows("r", r, (2,))),
        "normals": check_unit_rows("normals", normals, 2),
    }
    count = common_length(fields)
    columns = [np.broadcast_to(column, count) for rows in fields.values() for column in np.atleast_2d(rows.T)]
    outcomes = np.empty(count, dtype=np.int64)
    results = np.empty((11, count))
    # Chunks whose columns stay in the cache make this about twice as fast.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for first in range(0, count, _CHUNK):
            chunk = slice(first, first + _CHUNK)
            outcomes[chunk] = _strike(
                [x[chunk] for x in columns], results[:, chunk], restitution_law, tolerance, first
            )
    return PlanarImpacts(
        restitution_law=restitution_law,
        outcomes=outcomes,
        v=results[:2].T,
        w=results[2],
        impulses_C=results[3:5].T,
        compressions_C=results[5:7].T,
        velocities_before_C=results[7:9].T,
        velocities_after_C=results[9:11].T,
    )


def _strike(
    columns: list[FloatArray], results: FloatArray, law: RestitutionLaw, tolerance: float, first: int
) -> NDArray[np.int64]:
    """Fill ``results``, (11, n), with the planar impacts of some cases, and return the outcomes."""
    mass, inertia, friction, restitution, v_x, v_y, w, r_x, r_y, n_x, n_y = columns
    c_x = v_x - w * r_y
    c_y = v_y + w * r_x
    v_t = c_x * n_y - c_y * n_x
    v_n = c_x * n_x + c_y * n_y
    for i in np.flatnonzero(v_n > tolerance)[:1]:
        raise SeparatingContactError(
            f"contact normal velocity of case {first + i}",
            f"v_n = {v_n[i]:.9g} m/s",
            f"at most {tolerance:g} m/s, since above it nothing strikes ({NORMAL_HINT})",
        )
    v_n[v_n >= -tolerance] = 0.0
    v_t[(v_t >= -tolerance) & (v_t <= tolerance)] = 0.0
    r_t = r_x * n_y - r_y * n_x
    r_n = r_x * n_x + r_y * n_y
    response = _response(mass, inertia, r_t, r_n)
    outcomes, t_c, p_c, t_end, p_end, v_t_end, v_n_end = _paths(
        v_t, v_n, *response, friction, restitution, law
    )
    i_x = t_end * n_y + p_end * n_x
    i_y = p_end * n_y - t_end * n_x
    parts = (
        v_x + i_x / mass,
        v_y + i_y / mass,
        w + (r_t * p_end - r_n * t_end) / inertia,
        *(t_end, p_end, t_c, p_c, v_t, v_n, v_t_end, v_n_end),
    )
    for whole, part in zip(results, parts, strict=True):
        whole[:] = part
    return outcomes


def _response(
    mass: FloatArray, inertia: FloatArray, r_t: FloatArray, r_n: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return `routh.inverse_inertia` of each case, by its four numbers."""
    per_mass = 1.0 / mass
    return (
        per_mass + r_n * r_n / inertia,
        -(r_t * r_n) / inertia,
        per_mass + r_t * r_t / inertia,
        per_mass * (per_mass + (r_t * r_t + r_n * r_n) / inertia),
    )


def _paths(  # noqa: PLR0917 - the columns of one table
    v_t: FloatArray,
    v_n: FloatArray,
    a: FloatArray,
    b: FloatArray,
    c: FloatArray,
    det: FloatArray,
    friction: FloatArray,
    e: FloatArray,
    law: RestitutionLaw,
) -> tuple[NDArray[np.int64], FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return what `routh.impulse_path` finds in each case.

    After the outcomes come the impulses at the end of compression (tangential, normal), those at the end of
    the impact, and the velocities afterwards.
    """
    mu = np.minimum(friction, LARGEST_FRICTION)
    holds = abs(b) <= mu * a
    rests = v_t == 0.0
    s = np.where(rests & holds, 0.0, np.copysign(1.0, np.where(rests, b, v_t)))
    slowing = mu * a - s * b
    p_stop = np.where(s == 0.0, 0.0, np.where(slowing > 0.0, abs(v_t) / slowing, np.inf))
    rate_1 = c - s * mu * b
    jams = (s != 0.0) & (rate_1 < 0.0)
    nothing = (v_n == 0.0) & ~jams

    rate_2 = np.where(holds, det / a, c + s * mu * b)
    v_stop = np.where(p_stop < np.inf, v_n + rate_1 * p_stop, np.inf)
    early = v_stop <= 0.0
    p_c = np.where(early, p_stop - v_stop / rate_2, -v_n / rate_1)
    rate = np.where(early, rate_2, rate_1)

    if law is RestitutionLaw.POISSON:
        gain = e * p_c
        v_end = rate * gain
        p_end = p_c + gain
        late = ~early & (p_end > p_stop)
        v_end = np.where(late, v_stop + rate_2 * (p_end - p_stop), v_end)
    elif law is RestitutionLaw.NEWTON:
        v_end = e * -v_n
        gain = v_end / rate
        p_end = p_c + gain
        late = ~early & (p_end > p_stop)
        p_end = np.where(late, p_stop + (v_end - v_stop) / rate_2, p_end)
    elif law is RestitutionLaw.ENERGETIC:
        taken = np.where(early, -(v_n + v_stop) * p_stop - v_stop * (p_c - p_stop), -v_n * p_c)
        gain = e * np.sqrt(taken / rate)
        v_end = rate * gain
        p_end = p_c + gain
        late = ~early & (p_end > p_stop)
        rest = e * e * taken - v_stop * (p_stop - p_c)
        after = rest / (v_stop + np.sqrt(v_stop * v_stop + rate_2 * rest))
        p_end = np.where(late, p_stop + after, p_end)
        v_end = np.where(late, v_stop + rate_2 * after, v_end)
    else:
        refuse_unknown(law)

    s_mu = s * mu
    stops = early | late
    t_c = np.where(early, np.where(holds, -(v_t + b * p_c) / a, s_mu * (p_c - p_stop - p_stop)), -s_mu * p_c)
    t_end = np.where(
        stops, np.where(holds, -(v_t + b * p_end) / a, s_mu * (p_end - p_stop - p_stop)), -s_mu * p_end
    )
    v_t_end = np.where(stops & holds, 0.0, v_t + a * t_end + b * p_end)

    outcomes = _OUTCOMES[(early + 2 * late + 4 * holds).astype(np.intp)]
    outcomes[s == 0.0] = ImpactOutcome.STICKS_THROUGHOUT
    outcomes[nothing] = ImpactOutcome.NO_IMPULSE
    for result in (t_c, p_c, t_end, p_end, v_end):
        result[nothing] = 0.0
    return outcomes, t_c, p_c, t_end, p_end, np.where(nothing, v_t, v_t_end), v_end
