# SPDX-License-Identifier: Apache-2.0
"""The impact of an uncertain state has a mean, a covariance and a probability of each outcome.

An impact is not smooth in the state, because sliding may stop or turn. So nothing is linearised. States are
drawn from the normal distribution in opposite pairs. A linear law would keep the mean and the covariance of
such a draw. The impact of each state is worked out, and the results are counted. The error of a probability P
is sqrt(P (1 - P) / samples).

Draws whose contact separates do not strike. They keep their velocity and count as *missed*. Only the state is
uncertain. Body, friction, restitution, normal and the time of the impact are known.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw
from contact_dynamics.impact.spatial.batch import StrikingBodies, spatial_impacts
from contact_dynamics.impact.spatial.one_contact import check_striking
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import products, quaternions_of, rotated
from contact_dynamics.tolerances import SYMMETRY_TOLERANCE, VELOCITY_TOLERANCE
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_at_rest,
    check_magnitude,
    check_not_negative,
    check_whole,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import Contact
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties

MAX_SAMPLES: Final = 1_000_000

MAX_VARIANCE: Final = 1e12
"""In squares of SI units. Rotations by more than 1e6 rad have no digits left that say where a point is."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactDistribution(Record):
    """Distribution of the velocities after an impact, for a state with a covariance.

    Attributes:
        mean: (6,), m/s and rad/s, mean linear then angular velocity after the impact, world axes.
        covariance: (12, 12), covariance of position, rotation vector, linear and angular velocity.
        probabilities: (7,), probability of each ImpactOutcome, by its value. The sum of these and of
            ``missed`` is 1.
        missed: Probability that the contact separates, without an impact.
        samples: Number of sampled states.
    """

    mean: FloatArray
    covariance: FloatArray
    probabilities: FloatArray
    missed: float
    samples: int

    @property
    def standard_errors(self) -> FloatArray:
        """Return the standard errors of ``probabilities``, (7,), from the number of samples."""
        errors: FloatArray = np.sqrt(self.probabilities * (1.0 - self.probabilities) / self.samples)
        return errors


def spatial_impact_distribution(
    body: HasMassProperties,
    state: BodyState,
    contact: Contact,
    *,
    covariance: ArrayLike,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    samples: int = 2000,
    seed: int = 0,
) -> ImpactDistribution:
    """Return the distribution of the velocity after an impact in space.

    The contact is a point of the body and moves with each sampled pose. The normal is constant. The time of
    the impact is not part of the distribution; `sampled_toss` returns the distribution of times of strikes.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Mean state just before the impact.
        contact: Contact at the mean pose, with its normal into the body, friction and restitution.
        covariance: (12, 12), covariance of the state before the impact. Rows are position (m), rotation
            vector (rad, world axes, applied after the attitude), linear velocity (m/s) and angular velocity
            (rad/s), each as x, y, z.
        restitution_law: Law of restitution, which defines the coefficient of restitution.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of the contact's velocity up to it
            count as zero.
        samples: Number of sampled states, even. 2000 take about 20 ms, 10 000 about 60 ms.
        seed: Seed of the samples. The same seed yields the same result.

    Raises:
        InvalidFieldError: `spatial_impact` rejects a number, the covariance is not symmetric and positive
            semidefinite, the number of samples is odd or outside [2, 1 000 000], a variance exceeds
            `MAX_VARIANCE`, or the seed is not an integer >= 0.
    """
    body = body.mass_properties
    check_at_rest("contact", contact, "spatial_impact_distribution")
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    check_striking(body, state, contact.p_WC_W)
    draws = _draw(covariance, samples, seed)
    turns = quaternions_of(draws[:, 3:6])
    arms, normal = rotated(turns, contact.p_WC_W - state.p_WB_W), contact.normal_W
    after = np.concatenate((state.v_WB_W, state.w_WB_W)) + draws[:, 6:]
    v_n = (after[:, :3] + np.cross(after[:, 3:], arms)) @ normal
    # Half the tolerance counts here, because the impact judges the approach again by a sum that rounds
    # differently.
    strikes = v_n <= 0.5 * tolerance
    outcomes = np.zeros(0, dtype=np.int64)
    if strikes.any():
        impacts = spatial_impacts(
            StrikingBodies(
                masses=np.array(body.mass),
                inertias_B=body.I_B,
                q_WB=products(turns[strikes], state.q_WB),
                v_WB_W=after[strikes, :3],
                w_WB_W=after[strikes, 3:],
                r_W=arms[strikes],
            ),
            normals_W=normal,
            frictions=contact.friction,
            restitutions=contact.impact_restitution,
            restitution_laws=restitution_law,
            velocity_tolerance=tolerance,
        )
        after[strikes] = np.concatenate((impacts.v_WB_W, impacts.w_WB_W), axis=1)
        outcomes = impacts.outcomes
    return ImpactDistribution(
        mean=after.mean(axis=0),
        covariance=np.cov(np.concatenate([draws[:, :6], after], axis=1), rowvar=False),
        probabilities=np.bincount(outcomes, minlength=len(ImpactOutcome)) / samples,
        missed=1.0 - len(outcomes) / samples,
        samples=samples,
    )


def _draw(covariance: ArrayLike, samples: int, seed: int) -> FloatArray:
    """Return drawn deviations from the mean, (samples, 12), in opposite pairs."""
    matrix = check_magnitude("covariance", check_array("covariance", covariance, (12, 12)), MAX_VARIANCE)
    check_whole("seed", seed, 0)
    if check_whole("samples", samples, 2, MAX_SAMPLES) % 2:
        raise InvalidFieldError("samples", samples, f"an even number in [2, {MAX_SAMPLES}]")
    largest = float(abs(matrix).max())
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    symmetric = float(abs(matrix - matrix.T).max()) <= SYMMETRY_TOLERANCE * largest
    if not symmetric or values[0] < -SYMMETRY_TOLERANCE * largest:
        raise InvalidFieldError("covariance", matrix.tolist(), "a symmetric positive semidefinite matrix")
    half = np.random.default_rng(seed).standard_normal((samples // 2, 12))
    # The symmetric root is the same for any axes of equal variances, which a rounding error would turn.
    root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    deviations: FloatArray = half @ root
    return np.concatenate([deviations, -deviations])
