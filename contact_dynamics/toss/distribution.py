# SPDX-License-Identifier: Apache-2.0
"""What can happen in a toss that is not known exactly: a tree of the next strikes, regions, and rest.

A region is an ellipsoid about the mean of samples, by their covariance. Half of the samples, or nine tenths,
are within it. These sizes are counted among the samples, so that they hold for any distribution of theirs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, overload

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rotations.many import rotation_vectors, turned
from contact_dynamics.tolerances import EXACT_SHARE
from contact_dynamics.validation import FloatArray, check_magnitude, check_within
from contact_dynamics.validation_batches import check_not_negative_rows, check_rows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

LEVELS: Final = (0.5, 0.9)
"""Probabilities of the regions."""

QUANTILES: Final = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Quantiles of time and place of rest."""

FEWEST: Final = 20
"""Samples of a branch that has regions. Of fewer, nine tenths are no more than two from all."""

_MEAN_ROUNDS: Final = 4

_ALONG_AXIS: Final = 0.98

_SHOWN_FACES: Final = 6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Region(Record):
    """Region of the samples of a quantity with k components: an ellipsoid about their mean.

    Where samples have no spread in a direction, such as the height of a face at rest, the ellipsoid is flat.

    Attributes:
        mean: (k,), mean of the samples.
        covariance: (k, k), covariance of the samples.
        radii: (2,), distances from the mean within which half and nine tenths of the samples lie, in standard
            deviations of the covariance.
    """

    mean: FloatArray
    covariance: FloatArray
    radii: FloatArray

    def distances(self, values: ArrayLike, *, noise: ArrayLike = 0.0) -> FloatArray:
        """Return the distances of values, (n, k), from the mean, in standard deviations, (n,).

        Args:
            values: (n, k) or (k,), the values.
            noise: Standard deviation of the values themselves, as of measurements: one, or (k,). At rest on a
                face, samples have no spread along its normal, so that measured positions are beyond any
                distance unless their noise is given.

        Raises:
            InvalidFieldError: the values do not have k components, or the noise is negative.
            NotSupportedError: there are too few samples for a region.
        """
        rows = check_magnitude("values", check_rows("values", values, self.mean.shape))
        stds = check_magnitude("noise", check_not_negative_rows("noise", noise))
        if len(stds) not in {1, len(self.mean)}:
            raise InvalidFieldError("noise", noise, f"one number, or {len(self.mean)}")
        if not np.isfinite(self.covariance).all():
            message = f"a region requires at least {FEWEST} samples: covariance and radii are NaN"
            raise NotSupportedError(message)
        return _distances(rows - self.mean, self.covariance + np.diag(stds**2 * np.ones_like(self.mean)))

    def holds(self, values: ArrayLike, *, noise: ArrayLike = 0.0) -> NDArray[np.bool_]:
        """Return whether values, (n, k), are inside the 50 and 90 % regions, (n, 2). See `distances`."""
        held: NDArray[np.bool_] = self.distances(values, noise=noise)[:, None] <= self.radii
        return held


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EventRegions(Record):
    """Prediction regions of the time and pose of an impact, and of the velocities after it.

    Attributes:
        probability: Share of all samples that have this impact. The regions are those of these samples.
        seconds: Time, s after the initial state's stamp (k = 1).
        position: Position of the centre of mass, m, world (k = 3).
        q_WB: (4,), mean attitude.
        turn: Rotation vectors from the mean attitude, rad, world axes (k = 3).
        velocity: Velocity of the centre of mass after the impact, m/s, world axes (k = 3).
        spin: Angular velocity after the impact, rad/s, world axes (k = 3).
    """

    probability: float
    seconds: Region
    position: Region
    q_WB: FloatArray
    turn: Region
    velocity: Region
    spin: Region


class BranchKind(NamedInt):
    """Event of a branch."""

    STRIKES = 0
    """A corner has an impact."""
    STAYS = 1
    """The rebounds of the previous contact are negligible, and it stays closed."""
    FLIES = 2
    """The body has no contact until the horizon."""
    ENDS = 3
    """There is no further impact: the body rests, or slides and rolls until the horizon."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Branch(Record):
    """Branch of the tree of possible next events.

    Attributes:
        parent: Index of the branch that it follows, or -1 for the first impact.
        strike: Number of the impact, from 1.
        kind: Event of the branch.
        probability: Share of all samples in this branch.
        corner: Index of the corner that has the impact, or -1.
        surface: Name of the surface at this corner, or an empty string.
        regions: Regions of the samples in this branch. None without an impact, or with fewer than `FEWEST`
            samples.
    """

    parent: int
    strike: int
    kind: BranchKind
    probability: float
    corner: int
    surface: str
    regions: EventRegions | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RestSpread(Record):
    """Distribution of the time and place of rest.

    The place depends on the friction of sustained contact (docs/toss.md). The distribution contains all
    samples that rest, on any face; for each face there is `TossDistribution.face_positions`.
    `TossDistribution.ghosts` contains single poses of rest.

    Attributes:
        seconds: (5,), s, the 5, 25, 50, 75 and 95 % quantiles of the time of rest. The duration of chatter on
            a face is approximate (docs/toss.md).
        positions: (5, 3), m, the same quantiles of each coordinate of the centre of mass, world.
        position: Region of the position of the centre of mass at rest, m (k = 3).
    """

    seconds: FloatArray
    positions: FloatArray
    position: Region

    def in_short(self) -> str:
        """Return a label with the quantiles."""
        return f"RestSpread, quantiles {', '.join(f'{q:.0%}' for q in QUANTILES)} of time (s) and place (m)"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Ghosts(Record):
    """Poses of some samples, for visualization.

    Attributes:
        samples: (m,), number of the sample of each pose.
        strikes: (m,), number of the strike of each pose, from 1, or 0 at rest.
        p_WB_W: (m, 3), m, centres of mass.
        q_WB: (m, 4), unit quaternions.
        v_WB_W: (m, 3), m/s, velocities after the strike.
        w_WB_W: (m, 3), rad/s, angular velocities after the strike.
    """

    samples: NDArray[np.int64]
    strikes: NDArray[np.int64]
    p_WB_W: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TossDistribution(Record):
    """Distribution of the outcomes of an uncertain toss.

    Attributes:
        samples: Number of samples.
        strikes: Prediction regions of the next impacts, at any corner. The list ends before the first impact
            that no sample has.
        branches: Tree of the next events. Each branch is listed after the one that it follows, and more
            probable branches are listed first.
        face_normals_B: (f, 3), unit normals of the surface below, body axes, one for each face on which
            samples rest, most probable first. Empty without ``to_rest``.
        face_probabilities: (f,), shares of all samples. Empty without ``to_rest``. The sum is less than 1 if
            some samples do not come to rest.
        face_positions: Regions of the position of the centre of mass at rest on each of these faces, m, world
            (k = 3). Covariance and radii are NaN for a face with fewer than `FEWEST` samples.
        rest: Distribution of the time and position of rest. None if no sample rests, or if samples were not
            followed to rest.
        ghosts: Poses of the first samples.
        to_rest: Whether samples were followed to rest.
        exact: Names of those inputs among state, friction, restitution and impact law that are the same in
            all samples, because ``covariance`` and ``uncertainty`` do not include them. None if that is not
            recorded, as in a message, whose request contains it.
    """

    samples: int
    strikes: tuple[EventRegions, ...]
    branches: tuple[Branch, ...]
    face_normals_B: FloatArray
    face_probabilities: FloatArray
    face_positions: tuple[Region, ...]
    rest: RestSpread | None
    ghosts: Ghosts
    to_rest: bool = field(repr=False)
    exact: tuple[str, ...] | None = field(default=None, repr=False)

    def in_short(self) -> str:
        """Return the number of samples, the most probable resting faces, and the inputs taken as exact."""
        exact = f"; taken as exact: {', '.join(self.exact)}" if self.exact else ""
        return f"TossDistribution of {self.samples} samples{self._rests()}{exact}"

    def _rests(self) -> str:
        """Return the most probable faces on top, and the share that did not rest."""
        if not self.to_rest:
            return ", not followed to rest (to_rest=False)"
        shares = self.face_probabilities.tolist()
        if not shares:
            return ", none of which came to rest before the horizon"
        words = [f"{face} {share:.1%}" for face, share in zip(self.faces_on_top, shares, strict=True)]
        if len(words) > _SHOWN_FACES:
            words[_SHOWN_FACES:] = [f"other faces {sum(shares[_SHOWN_FACES:]):.1%}"]
        if 1.0 - sum(shares) > 0.5 / self.samples:
            words.append(f"not at rest {1.0 - sum(shares):.1%}")
        return f", on top at rest: {', '.join(words)}"

    @overload
    def standard_error(self, probability: float) -> float: ...

    @overload
    def standard_error(self, probability: FloatArray) -> FloatArray: ...

    def standard_error(self, probability: float | FloatArray) -> float | FloatArray:
        """Return the standard error of a probability, such as a branch's, from the number of samples.

        It is the sampling error only, and does not include errors of inputs that were taken as exact
        (`exact`). For several probabilities, such as ``face_probabilities``, it returns an array. For 0 and 1
        the standard error is zero, which does not mean certainty: an outcome that no sample has, has a
        probability of at most 3 / samples, with 95 % confidence.
        """
        if isinstance(probability, np.ndarray):
            return np.array([self.standard_error(share) for share in probability.ravel().tolist()]).reshape(
                probability.shape
            )
        share = check_within("probability", probability, 0.0, 1.0)
        return math.sqrt(share * (1.0 - share) / self.samples)

    @property
    def faces_on_top(self) -> tuple[str, ...]:
        """Return the body axis that points away from the surface for each resting face, such as "+z".

        If no axis is nearly normal to the face, it is the components of the direction. The order is that of
        ``face_probabilities``. For a die, it is the face on top. Faces on which no sample rests are not
        listed; without ``to_rest`` the list is empty.
        """
        return tuple(axis_in_words(normal) for normal in self.face_normals_B)


def axis_in_words(direction_B: FloatArray) -> str:
    """Return the body axis that a unit direction, (3,), is nearly along, "+x" to "-z", or its numbers."""
    axis = int(np.abs(direction_B).argmax())
    if abs(direction_B[axis]) >= _ALONG_AXIS:
        return f"{'-' if direction_B[axis] < 0.0 else '+'}{'xyz'[axis]}"
    return f"({' '.join(f'{x:.2g}' for x in (np.round(direction_B, 2) + 0.0).tolist())})"


def region_of(values: FloatArray) -> Region:
    """Return the region of samples, (n, k)."""
    (region,) = _regions(values[None])
    return region


def region_of_face(positions: FloatArray) -> Region:
    """Return the region of the positions, (n, 3), of samples that rest on one face."""
    if len(positions) >= FEWEST:
        return region_of(positions)
    unknown = np.full((3, 3), math.nan)
    return Region(mean=positions.mean(axis=0), covariance=unknown, radii=unknown[0, :2])


def regions_of(
    share: float, seconds: FloatArray, *, p: FloatArray, q: FloatArray, v: FloatArray, w: FloatArray
) -> EventRegions:
    """Return the regions of strikes: times (n,), poses and velocities after them, a row each."""
    mean = q[0]
    for _ in range(_MEAN_ROUNDS):
        mean = turned(mean[None], rotation_vectors(q, mean).mean(axis=0)[None])[0]
    position, turn, velocity, spin = _regions(np.stack([p, rotation_vectors(q, mean), v, w]))
    return EventRegions(
        probability=share,
        seconds=region_of(seconds[:, None]),
        position=position,
        q_WB=mean,
        turn=turn,
        velocity=velocity,
        spin=spin,
    )


def rest_of(seconds: FloatArray, p: FloatArray) -> RestSpread:
    """Return when, (n,), and where, (n, 3), samples rest."""
    return RestSpread(
        seconds=np.quantile(seconds, QUANTILES),
        positions=np.quantile(p, QUANTILES, axis=0),
        position=region_of(p),
    )


def _regions(values: FloatArray) -> list[Region]:
    """Return the regions of several quantities, (m, n, k), with n samples each."""
    means = values.mean(axis=1)
    off = values - means[:, None]
    covariances = off.transpose(0, 2, 1) @ off / max(values.shape[1] - 1, 1)
    radii = np.quantile(_distances(off, covariances), LEVELS, axis=-1).T
    each = zip(means, covariances, radii, strict=True)
    return [Region(mean=mean, covariance=covariance, radii=two) for mean, covariance, two in each]


def _distances(off: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the distances, (..., n), of values, (..., n, k), in standard deviations; see `Region`."""
    values, axes = np.linalg.eigh(covariance)
    least = np.maximum(values[..., -1:] * EXACT_SHARE, np.finfo(float).tiny)
    across: FloatArray = off @ axes / np.sqrt(np.maximum(values, least))[..., None, :]
    distances: FloatArray = np.sqrt(np.einsum("...ij,...ij->...i", across, across))
    return distances
