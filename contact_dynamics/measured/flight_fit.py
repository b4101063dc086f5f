# SPDX-License-Identifier: Apache-2.0
"""Fits a free flight to measured poses, including those after the time of interest.

Model: the centre of mass follows a parabola under known gravity, and the angular momentum L about it is
constant (lecture 25). Because the orientations are measured, the angular inertia in world axes is known at
each frame, and the rotation depends linearly on L: with theta the rotation vector from a reference
orientation, d theta / dt = J(theta)^-1 I_W^-1 L, where J is the left Jacobian of rotation vectors. Both fits
are linear least squares, of p_0 and v_0 to the positions and of theta_0 and L to the orientations. They use
neither an integrator nor the closed form of tumbling, so they are independent of the physics under test.

Uncertainties assume white noise of the given size, and are enlarged by Birge's ratio if the residuals are
larger. Not covered: drag, a wrong gravity or inertia, and noise that is correlated from frame to frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import to_ns
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import cross_matrices, matrices_of, rotation_vectors, turned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.measured.motion import MeasuredPoses
    from contact_dynamics.validation import FloatArray

FEWEST_FRAMES: Final = 4
"""Minimum number of frames: two for the two unknown vectors of positions and of orientations, and two for
residuals."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeasuredState(Record):
    """A state found by a fit, with the standard deviations of its parts."""

    time: float  # s, on the clock of the recording
    state: BodyState  # the state of the centre of mass, world axes
    position_std: float  # standard deviation of each coordinate, m
    orientation_std: FloatArray  # (3,), rad, of the components of a rotation vector, world axes
    velocity_std: float  # standard deviation of each component, m/s
    angular_velocity_std: FloatArray  # (3,), rad/s, of each component, world axes


class FittedPoses(NamedTuple):
    """Poses of fitted flights, with the standard deviations of their parts."""

    p_WB_W: FloatArray  # (..., n, 3), m
    q_WB: FloatArray  # (..., n, 4), unit quaternions x, y, z, w
    position_std: FloatArray  # (..., n), m, of each coordinate
    orientation_std: FloatArray  # (..., n, 3), rad, of the components of a rotation vector, world axes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FlightFit(Record):
    """One or several fitted free flights: position, velocity, rotation vector and L at a reference time.

    The leading axes of all arrays are those of the flights; a single flight has none.
    """

    reference: FloatArray  # (...), the reference time, s
    # (..., 4), x, y, z, w, the measured orientation to which rotation vectors refer.
    q_reference: FloatArray
    p_W: FloatArray  # (..., 3), m, position at the reference
    v_W: FloatArray  # (..., 3), m/s, velocity at the reference
    theta_W: FloatArray  # (..., 3), rad, rotation vector at the reference, world axes
    L_W: FloatArray  # (..., 3), kg m^2/s, angular momentum about the centre of mass
    gravity_W: FloatArray  # (3,), m/s^2
    I_B: FloatArray  # (3, 3), kg m^2, body axes
    cov_p: FloatArray  # (..., 2, 2), covariance of a coordinate and its rate: m^2, m^2/s, m^2/s^2
    cov_rotation: FloatArray  # (..., 6, 6), covariance of theta and L
    by_L: FloatArray  # (..., n, 3, 3), 1/(kg m^2/s), derivatives of the frames' rotation vectors by L

    def at(self, time: float) -> MeasuredState:
        """Return the state of a single flight at ``time``, s; see `poses_at`."""
        poses, after = self.poses_at(np.array([time])), time - float(self.reference)
        inverse = self._inverse_inertias(poses.q_WB)[0]
        cov_w = inverse @ self.cov_rotation[3:, 3:] @ inverse.T
        return MeasuredState(
            time=time,
            state=BodyState(
                p_WB_W=poses.p_WB_W[0],
                q_WB=poses.q_WB[0],
                v_WB_W=self.v_W + after * self.gravity_W,
                w_WB_W=inverse @ self.L_W,
                stamp_ns=to_ns(time),
            ),
            position_std=float(poses.position_std[0]),
            orientation_std=poses.orientation_std[0],
            velocity_std=math.sqrt(self.cov_p[1, 1]),
            angular_velocity_std=np.sqrt(cov_w.diagonal()),
        )

    def poses_at(self, times: FloatArray) -> FittedPoses:
        """Return the poses at several ``times``, (..., n), s.

        An orientation is one step of the midpoint rule from the reference. Its error is of third order in the
        angle, so times must be within a few frames of the reference.
        """
        after = (times - self.reference[..., None])[..., None]  # (..., n, 1)
        L = self.L_W[..., None]
        q_0 = _turned(self.q_reference, self.theta_W)
        w_0 = (self._inverse_inertias(q_0) @ L)[..., 0]
        q_half = _turned(q_0[..., None, :], 0.5 * after * w_0[..., None, :])
        w_half = (self._inverse_inertias(q_half) @ L[..., None, :, :])[..., 0]
        q = _turned(q_0[..., None, :], after * w_half)
        return self._poses(after, q, after[..., None] * self._inverse_inertias(q))

    def poses_of_frames(self, times: FloatArray) -> FittedPoses:
        """Return the poses at the fitted frames, at times (..., n), s, for rotations by less than pi."""
        turns = self.theta_W[..., None, :] + (self.by_L @ self.L_W[..., None, :, None])[..., 0]
        after = (times - self.reference[..., None])[..., None]
        return self._poses(after, _turned(self.q_reference[..., None, :], turns), self.by_L)

    def _poses(self, after: FloatArray, q: FloatArray, to_L: FloatArray) -> FittedPoses:
        """Return poses at times after the reference, (..., n, 1), s, from orientations and what L adds."""
        to_q = np.concatenate([np.broadcast_to(np.eye(3), to_L.shape), to_L], axis=-1)
        to_p = np.concatenate([np.ones_like(after), after], axis=-1)
        fallen = self.p_W[..., None, :] + after * self.v_W[..., None, :] + (0.5 * after**2) * self.gravity_W
        return FittedPoses(
            p_WB_W=fallen,
            q_WB=q,
            position_std=np.sqrt(np.einsum("...ni,...ij,...nj->...n", to_p, self.cov_p, to_p)),
            orientation_std=np.sqrt(
                np.einsum("...ij,...ij->...i", to_q @ self.cov_rotation[..., None, :, :], to_q)
            ),
        )

    def _inverse_inertias(self, q: FloatArray) -> FloatArray:
        R = _matrices(q)
        inverses: FloatArray = R @ np.linalg.inv(self.I_B) @ np.swapaxes(R, -1, -2)
        return inverses


def fit_flight(
    poses: MeasuredPoses, frames: slice | NDArray[np.intp], *, reference: int | NDArray[np.intp] | None = None
) -> FlightFit:
    """Return the free flight that fits the poses of ``frames`` best, or one flight per row of frames.

    ``frames`` is a slice or an array of numbers, (..., n), of at least `FEWEST_FRAMES` frames. The reference
    of time and orientation is the frame ``reference``, (...), by default the last one.
    """
    if isinstance(frames, slice):
        frames = np.arange(frames.start, frames.stop)
    chosen = frames[..., -1] if reference is None else np.asarray(reference)
    times = poses.times[frames] - poses.times[chosen][..., None]
    q_reference = poses.q_WB[chosen]
    gravity_W, I_B = poses.gravity_W, poses.body.mass_properties.I_B

    line = np.stack([np.ones_like(times), times], axis=-1)
    straight = poses.p_WB_W[frames] - 0.5 * np.square(times)[..., None] * gravity_W
    lines, cov_p = _least_squares(line, straight, poses.position_noise)

    q = poses.q_WB[frames]
    theta = rotation_vectors(
        q.reshape(-1, 4), np.broadcast_to(q_reference[..., None, :], q.shape).reshape(-1, 4)
    )
    R = _matrices(q)
    inverse_inertias = R @ np.linalg.inv(I_B) @ np.swapaxes(R, -1, -2)
    rates = _inverse_left_jacobians(theta).reshape(R.shape) @ inverse_inertias
    by_L = _integral(rates, times)
    design = np.concatenate([np.broadcast_to(np.eye(3), by_L.shape), by_L], axis=-1)
    rows = (*times.shape[:-1], 3 * times.shape[-1])
    solution, cov_rotation = _least_squares(
        design.reshape(*rows, 6), theta.reshape(*rows, 1), poses.orientation_noise
    )
    return FlightFit(
        reference=poses.times[chosen],
        q_reference=q_reference,
        p_W=lines[..., 0, :],
        v_W=lines[..., 1, :],
        theta_W=solution[..., :3, 0],
        L_W=solution[..., 3:, 0],
        gravity_W=gravity_W,
        I_B=I_B,
        cov_p=cov_p,
        cov_rotation=cov_rotation,
        by_L=by_L,
    )


def _least_squares(design: FloatArray, values: FloatArray, noise: float) -> tuple[FloatArray, FloatArray]:
    """Return the solutions, (..., m, k), and the covariance of each of their k columns, (..., m, m)."""
    scale = np.abs(design).max(axis=-2)
    scaled = design / scale[..., None, :]
    orthogonal, triangle = np.linalg.qr(scaled)
    inverse = np.linalg.inv(triangle)
    solution = inverse @ (np.swapaxes(orthogonal, -1, -2) @ values)
    squares = np.square(values - scaled @ solution).sum(axis=(-2, -1))
    freedom = (values.shape[-2] - design.shape[-1]) * values.shape[-1]
    birge = np.maximum(1.0, squares / (freedom * noise * noise)) if freedom else np.ones_like(squares)
    covariance = inverse @ np.swapaxes(inverse, -1, -2) * (birge * noise * noise)[..., None, None]
    return solution / scale[..., None], covariance / (scale[..., None, :] * scale[..., None])


def _matrices(q: FloatArray) -> FloatArray:
    return matrices_of(q.reshape(-1, 4)).reshape(*q.shape[:-1], 3, 3)


def _turned(q: FloatArray, theta: FloatArray) -> FloatArray:
    q = np.broadcast_to(q, (*theta.shape[:-1], 4))
    return turned(q.reshape(-1, 4), theta.reshape(-1, 3)).reshape(q.shape)


def _inverse_left_jacobians(theta: FloatArray) -> FloatArray:
    """Return J^-1 = 1 - [theta] / 2 + c [theta]^2, (n, 3, 3): d theta / dt = J^-1 w of R = Exp(theta) R_0."""
    square = np.einsum("ij,ij->i", theta, theta)
    half = 0.5 * np.sqrt(square)
    # with h half the angle, c = (1 - h cot h) / (4 h^2) loses digits near 0; 1/12 + h^2 / 180 is off by 1e-11
    small = half < 1e-2
    h = np.where(small, 1.0, half)
    c = np.where(small, 1.0 / 12.0 + square / 720.0, (1.0 - h / np.tan(h)) / (4.0 * h * h))
    cross = cross_matrices(theta)
    jacobians: FloatArray = np.eye(3) - 0.5 * cross + c[:, None, None] * (cross @ cross)
    return jacobians


def _integral(rates: FloatArray, times: FloatArray) -> FloatArray:
    """Return the integrals of ``rates``, (..., n, 3, 3), by the trapezoidal rule from time 0."""
    steps = 0.5 * (rates[..., 1:, :, :] + rates[..., :-1, :, :]) * np.diff(times)[..., None, None]
    total = np.zeros_like(rates)
    np.cumsum(steps, axis=-3, out=total[..., 1:, :, :])
    begin = np.abs(times).argmin(axis=-1)[..., None, None, None]
    integral: FloatArray = total - np.take_along_axis(total, begin, axis=-3)
    return integral
