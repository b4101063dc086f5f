# SPDX-License-Identifier: Apache-2.0
"""The uncertainty of a toss, and samples from it.

The state has a covariance, and so have the parameters that a calibration estimates: friction, restitution,
centre of mass and inertia. The impact law has a model error, which is the scatter of measured velocities
after strikes about it. Each sample consists of a body, a world and a state.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import matrices_of, products, quaternions_of
from contact_dynamics.toss.solid import factors_of
from contact_dynamics.validation import FloatArray, check_array, check_magnitude, check_within
from contact_dynamics.validation_batches import check_covariance
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.random import Generator
    from numpy.typing import ArrayLike

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.world import Body, World

MAX_PARAMETERS: Final = 100
"""Largest number of uncertain parameters, enough for 46 surfaces. It bounds the size of requests."""


MAX_SPREAD: Final = 1e6
"""Largest standard deviation of any quantity, in SI units."""

MAX_INERTIA_SPREAD: Final = 10.0
"""Largest standard deviation of the inertia's relative change. Its exponential scales the inertia."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TossUncertainty(Record):
    """Uncertainty of the parameters and of the impact law of a toss.

    Attributes:
        covariance: (2 s + 4, 2 s + 4) or (2 s + 7, 2 s + 7), covariance of the parameters, with s surfaces,
            in this order: the friction of each surface, the restitution of each surface, the centre of mass
            x, y, z in body axes (m), and the inertia as a relative change of all its components. The larger
            matrix also contains the components of gravity in world axes (m/s^2), which apply to impacts and
            to the flights between them. If the matrix is empty, all parameters are exact.
        velocity: m/s, >= 0, model error of the impact law in each component of the velocity after an impact.
            It is the standard deviation of normal residuals with the same median (`law_spread`).
        spin: rad/s, >= 0, the same for the angular velocity.
        height: m, >= 0, standard deviation of the distance of each corner from the centre of mass. It makes
            the time of an impact uncertain.
        lasting_factors: (s,), >= 0, friction of sustained contact with each surface, relative to that of
            impacts. If it is empty, the factors of the surfaces are used.
        lasting_factor_stds: (s,), >= 0, standard deviations of these factors, which include the variation
            from toss to toss and the uncertainty of the estimates. If it is empty, the factors are exact.

    Raises:
        InvalidFieldError: the matrix is not a covariance, a number is negative or not finite, a standard
            deviation is larger than `MAX_SPREAD`, or the numbers of standard deviations and of factors
            differ.
        TooLargeError: the matrix has more than `MAX_PARAMETERS` rows.
    """

    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    velocity: float = 0.0
    spin: float = 0.0
    height: float = 0.0
    lasting_factors: FloatArray = field(default_factory=lambda: np.zeros(0))
    lasting_factor_stds: FloatArray = field(default_factory=lambda: np.zeros(0))

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            covariance: ArrayLike = ...,
            velocity: float = ...,
            spin: float = ...,
            height: float = ...,
            lasting_factors: ArrayLike = ...,
            lasting_factor_stds: ArrayLike = ...,
        ) -> None:
            """Accept values that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check all fields."""
        rows = check_array("covariance", self.covariance, (None, None))
        if len(rows) > MAX_PARAMETERS:
            raise TooLargeError("covariance", len(rows), f"at most {MAX_PARAMETERS}")
        check_magnitude("covariance", rows, MAX_SPREAD**2)
        matrix = check_covariance("covariance", rows, len(rows)) if len(rows) else rows
        object.__setattr__(self, "covariance", matrix)
        for name in ("velocity", "spin", "height"):
            object.__setattr__(self, name, check_within(name, getattr(self, name), 0.0, MAX_SPREAD))
        for name in ("lasting_factors", "lasting_factor_stds"):
            object.__setattr__(self, name, check_factors(name, getattr(self, name)))
        count = len(self.lasting_factors)
        if len(self.lasting_factor_stds) not in {0, count}:
            found = f"{len(self.lasting_factor_stds)} numbers"
            raise InvalidFieldError("lasting_factor_stds", found, f"{count}, one for each factor, or none")


def exact_inputs(uncertainty: TossUncertainty, covariance: FloatArray | None) -> tuple[str, ...]:
    """Return the names of those inputs among state, friction, restitution and impact law that are exact."""
    size = len(uncertainty.covariance)
    s = (size - (7 if size % 2 else 4)) // 2  # surfaces
    variances = uncertainty.covariance.diagonal()
    spread = {
        "state": covariance is not None and covariance.any(),
        "friction": variances[:s].any() or uncertainty.lasting_factor_stds.any(),
        "restitution": variances[s : 2 * s].any(),
        "impact law": uncertainty.velocity > 0.0 or uncertainty.spin > 0.0,
    }
    return tuple(name for name, is_uncertain in spread.items() if not is_uncertain)


def check_factors(field: str, values: ArrayLike) -> FloatArray:
    """Return numbers in [0, `MAX_SPREAD`], (s,)."""
    factors = check_magnitude(field, check_array(field, values, (None,)), MAX_SPREAD)
    if (factors < 0.0).any():
        raise InvalidFieldError(field, factors, "numbers >= 0")
    return factors


EXACT: Final = TossUncertainty()
"""Exact parameters and an exact impact law."""


class Samples(NamedTuple):
    """Sampled bodies, worlds and states, one per row.

    Attributes:
        p_WB_W: (n, 3), m, centres of mass.
        q_WB: (n, 4), unit quaternions x, y, z, w.
        v_WB_W: (n, 3), m/s.
        w_WB_W: (n, 3), rad/s.
        inertias_B: (n, 3, 3), kg m^2.
        corners_B: (n, k, 3), m, relative to each sample's centre of mass.
        frictions: (n, s), friction of each surface in strikes.
        lasting_frictions: (n, s), friction of each surface in sustained contact.
        restitutions: (n, s), restitution of each surface.
        gravities_W: (n, 3), m/s^2.
    """

    p_WB_W: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray
    inertias_B: FloatArray
    corners_B: FloatArray
    frictions: FloatArray
    lasting_frictions: FloatArray
    restitutions: FloatArray
    gravities_W: FloatArray


def draw(
    body: Body,
    state: BodyState,
    world: World,
    *,
    covariance: FloatArray | None,
    by_gravity: Sequence[float] | FloatArray = (0.0, 0.0),
    uncertainty: TossUncertainty,
    count: int,
    chance: Generator,
) -> Samples:
    """Return samples of normal distributions, with friction and restitution limited to valid values.

    Args:
        body: Body with the best estimate of its parameters. Its shape is a hull of corners.
        state: Best estimate of the state.
        world: Surfaces, which must be planes, and gravity.
        covariance: (12, 12), covariance of the state, in the order of `questions.UncertainState`, or None if
            the state is exact.
        by_gravity: s^2 and s, derivatives of the estimated position and velocity with respect to gravity, as
            a fit under the world's gravity returns them.
        uncertainty: Uncertainty of the parameters.
        count: Number of samples.
        chance: Random number generator.

    Raises:
        InvalidFieldError: the size of the parameters' covariance or the number of factors does not match the
            number of surfaces, or a variance is too large (`MAX_SPREAD`, `MAX_INERTIA_SPREAD`).
    """
    flats = [surface for surface in world.surfaces if isinstance(surface, Surface)]
    s = len(flats)
    size = len(uncertainty.covariance)
    whole = 2 * s + 7
    if size not in {0, whole - 3, whole}:
        allowed = (
            f"{whole - 3} rows, two for each of {s} surfaces and four more, or {whole} with gravity, or none"
        )
        raise InvalidFieldError("covariance", f"{size} rows", allowed)
    if size and uncertainty.covariance[2 * s + 3, 2 * s + 3] > MAX_INERTIA_SPREAD**2:
        found = f"a variance of the inertia of {uncertainty.covariance[2 * s + 3, 2 * s + 3]:g}"
        raise InvalidFieldError("covariance", found, f"at most {MAX_INERTIA_SPREAD**2:g}")
    if covariance is not None:
        check_magnitude("state.covariance", covariance, MAX_SPREAD**2)
    off = _normal(uncertainty.covariance, count, chance) if size else np.zeros((count, whole - 3))
    off = np.column_stack([off, np.zeros((count, whole - off.shape[1]))])
    pulled = off[:, 2 * s + 4 :]
    moved = _normal(covariance, count, chance) if covariance is not None else np.zeros((count, 12))
    q = products(quaternions_of(moved[:, 3:6]), np.broadcast_to(state.q_WB, (count, 4)))
    centre = off[:, 2 * s : 2 * s + 3]
    shift = np.einsum("nij,nj->ni", matrices_of(q), centre)
    w = state.w_WB_W + moved[:, 9:]
    frictions = np.maximum(np.array([flat.friction for flat in flats]) + off[:, :s], 0.0)
    corners = _corners(body, uncertainty.height, count, chance) - centre[:, None, :]
    return Samples(
        p_WB_W=state.p_WB_W + moved[:, :3] + shift + by_gravity[0] * pulled,
        q_WB=q,
        v_WB_W=state.v_WB_W + moved[:, 6:9] + np.cross(w, shift) + by_gravity[1] * pulled,
        w_WB_W=w,
        inertias_B=body.mass_properties.I_B * np.exp(off[:, 2 * s + 3])[:, None, None],
        corners_B=corners,
        frictions=frictions,
        lasting_frictions=frictions * _factors(uncertainty, flats, count, chance),
        restitutions=np.clip(np.array([flat.restitution for flat in flats]) + off[:, s : 2 * s], 0.0, 1.0),
        gravities_W=world.gravity_W + pulled,
    )


def _factors(
    uncertainty: TossUncertainty, surfaces: Sequence[Surface], count: int, chance: Generator
) -> FloatArray:
    """Return samples of the friction of sustained contact relative to that of strikes, (n, s)."""
    factors = np.tile(factors_of(uncertainty.lasting_factors, surfaces), (count, 1))
    stds = uncertainty.lasting_factor_stds
    if stds.any():
        factors += stds * chance.standard_normal((count, len(surfaces)))
    return np.maximum(factors, 0.0)


def _corners(body: Body, height: float, count: int, chance: Generator) -> FloatArray:
    """Return sampled corners, (n, k, 3), m, each displaced along its ray from the centre of mass."""
    vertices = body.shape.vertices
    lengths = np.linalg.norm(vertices, axis=1)
    rays = np.divide(vertices, lengths[:, None], out=np.zeros_like(vertices), where=lengths[:, None] > 0.0)
    moved: FloatArray = vertices + height * chance.standard_normal((count, len(vertices), 1)) * rays
    return moved


def _normal(covariance: FloatArray, count: int, chance: Generator) -> FloatArray:
    """Return normal samples, (n, k), with a covariance that may be singular."""
    scaled, sizes = _scaled(covariance)
    values, axes = np.linalg.eigh(scaled)
    drawn: FloatArray = chance.standard_normal((count, len(sizes))) * np.sqrt(np.maximum(values, 0.0))
    numbers: FloatArray = (drawn @ axes.T) * sizes
    return numbers


def _scaled(covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the correlation matrix and the standard deviations. Both are zero for exact components."""
    sizes = np.sqrt(np.maximum(covariance.diagonal(), 0.0))
    units = np.where(sizes > 0.0, sizes, 1.0)
    return covariance / np.outer(units, units), sizes
