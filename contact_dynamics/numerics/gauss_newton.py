# SPDX-License-Identifier: Apache-2.0
"""Nonlinear least squares by the Gauss-Newton method, whose steps are halved until the residuals decrease.

SciPy's ``least_squares`` has the same results, as tests show, but is not used for three reasons: attitudes
change by a new rotation vector in each round, for which SciPy would have to be restarted; rounds end here
when the change of the measured quantities is negligible; and its import would delay the first request with a
window of states by tenths of a second.

Not covered: bounds, outliers, and starts that are too far off for linearisation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Generic, TypeVar

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import SMALL_SHARE

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.validation import FloatArray

Model = TypeVar("Model")

MAX_ROUNDS: Final = 20
"""Bound on the rounds. Most fits take three; a start that is off by a radian takes a few more."""

MAX_HALVINGS: Final = 10
"""Bound on the halvings of a step that does not reduce the residuals."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit(Generic[Model]):
    """The best fit.

    Attributes:
        misses: (m,), weighted residuals: measured less computed.
        inverse: (k, k). inverse @ inverse^T is the parameters' covariance for unit variances.
        converged: Whether the change in the last round was negligible.
    """

    model: Model
    misses: FloatArray
    inverse: FloatArray
    rounds: int
    converged: bool


def gauss_newton(
    model: Model,
    *,
    misses_of: Callable[[Model], FloatArray],
    derivatives_of: Callable[[Model], FloatArray],
    moved: Callable[[Model, FloatArray], Model],
    negligible: FloatArray,
) -> Fit[Model]:
    """Return the model whose weighted residuals have the least sum of squares, near a start.

    Args:
        model: the start.
        misses_of: a model's weighted residuals, (m,), measured less computed.
        derivatives_of: the derivatives of what is computed by k parameters, (m, k), m >= k, with the same
            weights.
        moved: a model changed by steps of the parameters, (k,).
        negligible: (m,), changes of what is computed, weighted, that count as none.

    Raises:
        InvalidFieldError: the derivatives by several parameters depend on each other, so that the measured
            numbers do not determine the model.
    """
    misses = misses_of(model)
    rounds, converged = 0, False
    before = 0.0  # part of the sum of squares explained by the round before, if its step was not halved
    while rounds < MAX_ROUNDS and not converged:
        rounds += 1
        design = derivatives_of(model)
        sizes = np.sqrt(np.einsum("mk,mk->k", design, design))
        orthogonal, triangle = np.linalg.qr(design / sizes)
        explained = orthogonal.T @ misses
        try:
            step = np.linalg.solve(triangle, explained) / sizes
        except np.linalg.LinAlgError:
            raise InvalidFieldError(
                "states",
                f"{len(misses)} numbers that leave a part of the motion open",
                "more or other states",
            ) from None
        cost, part = float(misses @ misses), float(explained @ explained)
        small = bool((np.abs(design @ step) < negligible).all())
        # Convergence accelerates, so the next round explains at most the same share of this one.
        shrinks = part / before if part < before else 1.0
        converged = small or shrinks * part < SMALL_SHARE * cost
        start, before = model, part
        for _ in range(MAX_HALVINGS):
            model = moved(start, step)
            misses = misses_of(model)
            if converged or float(misses @ misses) <= cost:
                break
            step *= 0.5
            before = 0.0
    inverse = np.linalg.inv(triangle) / sizes[:, None]
    return Fit(model, misses, inverse, rounds, converged)
