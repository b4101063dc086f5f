# SPDX-License-Identifier: Apache-2.0
"""What one impact at a single contact shows about restitution and friction.

The measured velocities after the impact are compared with those predicted for given coefficients. The
difference has the covariance of the prediction, of the measurement, and of the model error of the impact law.
With a model error of the law, differences have the tails of Student's t (`ModelError.freedom`). Without it,
they are normal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.evaluation.comparison import velocity_difference
from contact_dynamics.impact.spatial.batch import StrikingBodies, spatial_impacts
from contact_dynamics.records import Record
from contact_dynamics.tolerances import SAME_COEFFICIENT
from contact_dynamics.tumbling import free_motion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.evaluation.model_error import ModelError
    from contact_dynamics.measured.events import FoundEvent
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World

    BoolArray = NDArray[np.bool_]

COMPONENTS: Final = 6  # linear and angular velocity
STEP: Final = 1.1  # ratio of neighbouring values of a coefficient that changes are detected with
STEPS: Final = 14  # values in each direction: from 0.26 to 3.8 times the configured coefficient


class Parameter(Enum):
    """The coefficients that an impact shows."""

    RESTITUTION = "restitution"
    FRICTION = "friction"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImpactEvidence(Record):
    """One impact, as evidence of restitution and friction."""

    struck: StrikingBodies  # the body in its state just before the impact, with its contact
    normal_W: FloatArray  # (3,), unit normal into the body, world axes
    measured: FloatArray  # (6,), velocities just after the impact, m/s and rad/s, world axes
    inverse: FloatArray  # (6, 6), inverse of the covariance of the difference
    configured: FloatArray  # (2,), restitution and friction
    freedom: float  # degrees of freedom of Student's t, or infinity

    @property
    def distance(self) -> float:
        """Return how far the prediction is off in standard deviations (Mahalanobis)."""
        return math.sqrt(float(self.squares(self.configured[None])[0]))

    def differences(self, values: FloatArray) -> FloatArray:
        """Return measured less predicted velocities, (k, 6), for k pairs of restitution and friction."""
        found = spatial_impacts(
            self.struck,
            normals_W=self.normal_W,
            restitutions=values[:, 0],
            frictions=values[:, 1],
            skip_separating=True,
        )
        return self.measured - np.hstack([found.v_WB_W, found.w_WB_W])

    def squares(self, values: FloatArray) -> FloatArray:
        """Return squared Mahalanobis distances, (k,), for k pairs of restitution and friction."""
        r = self.differences(values)
        squares: FloatArray = np.einsum("ki,ij,kj->k", r, self.inverse, r)
        return squares

    def log_likelihoods(self, values: FloatArray) -> FloatArray:
        """Return logarithms of likelihoods, (k,), up to a constant, for k pairs."""
        squares = self.squares(values)
        if math.isinf(self.freedom):
            return -0.5 * squares
        found: FloatArray = -0.5 * (self.freedom + COMPONENTS) * np.log1p(squares / self.freedom)
        return found

    def slopes(self, at: FloatArray) -> FloatArray:
        """Return how predicted velocities change with restitution and friction there, (6, 2)."""
        pairs = np.array(
            [at * factors for factors in ((STEP, 1.0), (1.0 / STEP, 1.0), (1.0, STEP), (1.0, 1.0 / STEP))]
        )
        pairs[:, 0] = np.minimum(pairs[:, 0], 1.0)
        r = self.differences(pairs)
        widths = [pairs[0, 0] - pairs[1, 0], pairs[2, 1] - pairs[3, 1]]
        return np.column_stack(
            [
                (r[2 * k + 1] - r[2 * k]) / width if width > 0.0 else np.zeros(COMPONENTS)
                for k, width in enumerate(widths)
            ]
        )

    def each_alone(self) -> FloatArray:
        """Return what each coefficient alone would be, and its standard deviation, (2, 2), or NaN.

        The first row is the difference from the configured coefficients, to first order.
        """
        slopes = self.slopes(self.configured)
        information = np.diag(slopes.T @ self.inverse @ slopes).copy()
        information[~is_known(np.diag(information))] = math.nan
        along = slopes.T @ self.inverse @ self.differences(self.configured[None])[0]
        return np.array([along / information, 1.0 / np.sqrt(information)])

    def widened(self, factors: FloatArray) -> ImpactEvidence:
        """Return the impact with larger standard deviations along both coefficients, by factors, (2,)."""
        slopes = self.slopes(self.configured)
        information = np.diag(slopes.T @ self.inverse @ slopes)
        covariance = np.linalg.inv(self.inverse)
        for k in np.flatnonzero(is_known(np.diag(information))):
            share = (factors[k] ** 2 - 1.0) / information[k]
            covariance = covariance + share * np.outer(slopes[:, k], slopes[:, k])
        return replace(self, inverse=np.linalg.inv(covariance))

    def weight(self, at: FloatArray) -> float:
        """Return the weight of this impact in an estimate, which is small for an outlier."""
        square = float(self.squares(at[None])[0])
        if math.isinf(self.freedom):
            return min(1.0, OUTLIER / square) if square > 0.0 else 1.0
        return (self.freedom + COMPONENTS) / (self.freedom + square)

    def estimates(self) -> tuple[FloatArray, FloatArray]:
        """Return restitution and friction that explain this impact alone, and standard deviations, (2,) each.

        They are first order about the configured ones. What the impact does not determine, such as the
        friction of a contact that sticks, is NaN.
        """
        slopes = self.slopes(self.configured)
        inverse = inverse_of_known(slopes.T @ self.inverse @ slopes)
        known = ~np.isnan(np.diag(inverse))
        gradient = slopes.T @ self.inverse @ self.differences(self.configured[None])[0]
        values = np.full(2, math.nan)
        values[known] = self.configured[known] + inverse[known][:, known] @ gradient[known]
        return values, np.sqrt(np.diag(inverse))

    def probability(self) -> float:
        """Return the probability of a difference at least as large, if the prediction is correct."""
        return float(self.probabilities(np.square([self.distance]), COMPONENTS)[0])

    def probabilities(self, squares: FloatArray, components: int) -> FloatArray:
        """Return the probabilities of larger squared distances with that number of components."""
        from scipy.stats import chi2, f

        if math.isinf(self.freedom):
            return np.asarray(chi2.sf(squares, components))
        return np.asarray(f.sf(squares / components, components, self.freedom))

    def explained_by(self) -> Parameter | None:
        """Return the coefficient whose change brings this impact into the 99 % region best, if one does."""
        best = []
        for k in range(len(Parameter)):
            values, width = alternatives(self.configured, k), math.log(STEP)
            least = math.inf
            while len(values) and width > SAME_COEFFICIENT:
                squares = self.squares(values)
                least, nearest = float(squares.min()), values[squares.argmin()]
                values = np.tile(nearest, (2 * STEPS + 1, 1))
                values[:, k] *= np.exp(width * np.linspace(-1.0, 1.0, len(values)))
                values[:, 0] = np.minimum(values[:, 0], 1.0)
                width /= STEPS
            best.append(least)
        k = int(np.argmin(best))
        if (
            math.isinf(best[k])
            or self.probabilities(np.array([best[k]]), COMPONENTS - 1)[0] < 1.0 - REGIONS[-1]
        ):
            return None
        return tuple(Parameter)[k]


OUTLIER: Final = 16.8
"""Squared distance beyond which an impact counts less in an estimate although differences are normal: of 100
such impacts, one is farther away. An outlier may be two strikes that were detected as one."""

LEAST_KNOWN: Final = 1.0  # a coefficient with a larger standard deviation is not known
REGIONS: Final = (0.5, 0.9, 0.99)  # probabilities of the prediction regions


def is_known(information: FloatArray) -> BoolArray:
    """Return which coefficients, (2,), an information matrix determines to better than `LEAST_KNOWN`."""
    known: BoolArray = np.diag(information) > LEAST_KNOWN**-2
    return known


def inverse_of_known(information: FloatArray) -> FloatArray:
    """Return the covariance of the coefficients, (2, 2), NaN where one is not known."""
    known = is_known(information)
    found = np.full((2, 2), math.nan)
    whole = information + np.eye(2) * LEAST_KNOWN**-2  # regular where both change velocities alike
    found[np.ix_(known, known)] = np.linalg.inv(whole[np.ix_(known, known)])
    return found


def alternatives(configured: FloatArray, parameter: int) -> FloatArray:
    """Return pairs of coefficients, (k, 2), of which one differs from the configured one, (2,).

    The ``parameter`` is 0 for restitution, and 1 for friction.
    """
    value = float(configured[parameter])
    if value <= 0.0:
        return np.zeros((0, 2))
    powers = [k for k in range(-STEPS, STEPS + 1) if k]
    pairs = np.tile(configured, (len(powers), 1))
    pairs[:, parameter] = value * STEP ** np.array(powers, dtype=float)
    return pairs[pairs[:, 0] <= 1.0]


def evidence_of(
    event: FoundEvent, answer: ImpactAnswer, world: World, error: ModelError
) -> ImpactEvidence | None:
    """Return the evidence of a measured impact, or None without a single contact and a known covariance.

    The ``answer`` is the prediction from the states before it, in the ``world``, with its covariance.
    """
    covariance, contacts = answer.impact.covariance, answer.contacts
    if event.several or covariance is None or len(contacts) != 1 or contacts.restitutions is None:
        return None
    if not np.isfinite(covariance).all():
        return None
    properties = world.body(event.body).mass_properties
    before, after = answer.state, answer.impact.state
    flown = free_motion(properties, after, gravity_W=world.gravity_W).state_at(event.duration)
    noise = np.diag(np.square([*[event.velocity_std] * 3, *event.angular_velocity_std]))
    whole = covariance[6:, 6:] + noise + error.of_law(properties, before, contacts.p_WC_W[0])
    return ImpactEvidence(
        struck=StrikingBodies.of(
            properties,
            p_WB_W=before.p_WB_W,
            q_WB=before.q_WB,
            v_WB_W=before.v_WB_W,
            w_WB_W=before.w_WB_W,
            p_WC_W=contacts.p_WC_W[0],
        ),
        normal_W=contacts.normals_W[0],
        measured=np.concatenate([after.v_WB_W, after.w_WB_W]) + velocity_difference(flown, event.state),
        inverse=np.linalg.inv(whole),
        configured=np.array([contacts.restitutions[0], contacts.frictions[0]]),
        freedom=error.freedom,
    )
