"""This file fits a free flight to a stretch of measured poses, in hindsight.

Model: the centre of mass flies a parabola of known gravity, and the angular momentum L about it is constant
(lecture 25). The orientations themselves are measured, so the angular inertia in world axes is known at each
frame and the rotation follows from L linearly: with theta the rotation vector from a reference orientation, d
theta / dt = J(theta)^-1 I_W^-1 L, where J is the left Jacobian of rotation vectors. Both fits are linear
least squares, p_0 and v_0 from the positions, theta_0 and L from the orientations, and use no integrator and
no closed form of tumbling: the physics that is to be tested takes no part in them.

Uncertainties follow from white noise of the toss's stated size. If the residuals are larger, they are
enlarged by Birge's ratio. Not covered: drag, a wrong gravity or inertia, noise that is correlated from frame
to frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import to_ns
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import matrices_of, rotation_vectors, turned

if TYPE_CHECKING:
    from contact_dynamics.measured.poses import MeasuredPoses
    from contact_dynamics.validation import FloatArray

FEWEST_FRAMES: Final = 4
"""Least number of frames. Positions and orientations have two unknown vectors each, and two more frames give
residuals."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeasuredState(Record):
    """A state found by a fit, with the standard deviation of each of its parts.

    Attributes:
        time: Time of the state, s, on the recording's clock.
        state: The state of the centre of mass, world axes.
        position_std: Standard deviation of each coordinate, m.
        orientation_std: (3,), rad, those of a rotation vector's components, world axes.
        velocity_std: Standard deviation of each component, m/s.
        angular_velocity_std: (3,), rad/s, that of each component, world axes.
    """

    time: float
    state: BodyState
    position_std: float
    orientation_std: FloatArray
    velocity_std: float
    angular_velocity_std: FloatArray


class FittedPoses(NamedTuple):
    """Poses of a fitted flight, with the standard deviation of each of their parts.

    Attributes:
        p_WB_W: (n, 3), m.
        q_WB: (n, 4), unit quaternions x, y, z, w.
        position_std: (n,), m, that of each coordinate.
        orientation_std: (n, 3), rad, those of a rotation vector's components, world axes.
    """

    p_WB_W: FloatArray
    q_WB: FloatArray
    position_std: FloatArray
    orientation_std: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FlightFit(Record):
    """A fitted free flight: position and rotation vector at a reference time, with velocity and L.

    Attributes:
        reference: The reference time, s.
        q_reference: (4,), x, y, z, w, the measured orientation from which rotation vectors start.
        p_W: (3,), m, position at the reference.
        v_W: (3,), m/s, velocity at the reference.
        theta_W: (3,), rad, rotation vector at the reference, world axes.
        L_W: (3,), kg m^2/s, angular momentum about the centre of mass.
        gravity_W: (3,), m/s^2.
        I_B: (3, 3), kg m^2, body axes.
        cov_p: (2, 2), covariance of a coordinate and its rate: m^2, m^2/s, m^2/s^2.
        cov_rotation: (6, 6), covariance of theta and L.
    """

    reference: float
    q_reference: FloatArray
    p_W: FloatArray
    v_W: FloatArray
    theta_W: FloatArray
    L_W: FloatArray
    gravity_W: FloatArray
    I_B: FloatArray
    cov_p: FloatArray
    cov_rotation: FloatArray

    def at(self, time: float) -> MeasuredState:
        """Return the flight's state at ``time``, s; see `poses_at`."""
        poses, after = self.poses_at(np.array([time])), time - self.reference
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
        """Return the poses at many ``times``, (n,), s.

        An orientation is one step of the midpoint rule from the reference. Its error is of third order in the
        angle, so ask within a few frames of the reference.
        """
        after = times - self.reference
        q_0 = turned(self.q_reference, self.theta_W[None])
        w_0 = self._inverse_inertias(q_0)[0] @ self.L_W
        q_half = turned(q_0[0], 0.5 * after[:, None] * w_0)
        q = turned(q_0[0], after[:, None] * (self._inverse_inertias(q_half) @ self.L_W))
        to_q = np.concatenate(
            [
                np.broadcast_to(np.eye(3), (len(times), 3, 3)),
                after[:, None, None] * self._inverse_inertias(q),
            ],
            axis=2,
        )
        to_p = np.column_stack([np.ones_like(after), after])
        return FittedPoses(
            p_WB_W=self.p_W + after[:, None] * self.v_W + (0.5 * after * after)[:, None] * self.gravity_W,
            q_WB=q,
            position_std=np.sqrt(np.einsum("ni,ij,nj->n", to_p, self.cov_p, to_p)),
            orientation_std=np.sqrt(np.einsum("nij,nij->ni", to_q @ self.cov_rotation, to_q)),
        )

    def _inverse_inertias(self, q: FloatArray) -> FloatArray:
        R = matrices_of(q)
        inverses: FloatArray = R @ np.linalg.solve(self.I_B, R.transpose(0, 2, 1))
        return inverses


def fit_flight(poses: MeasuredPoses, frames: slice, *, reference: int | None = None) -> FlightFit:
    """Return the free flight that fits the poses of ``frames`` (a slice of at least `FEWEST_FRAMES`) best.

    ``reference`` is the frame to which the fit refers in time and orientation. The default is the last one.
    """
    if reference is None:
        reference = frames.stop - 1
    times = poses.times[frames] - poses.times[reference]
    gravity_W, I_B = poses.gravity_W, poses.body.mass_properties.I_B

    line = np.column_stack([np.ones_like(times), times])
    straight = poses.p_WB_W[frames] - 0.5 * np.square(times)[:, None] * gravity_W
    (p_W, v_W), cov_p = _least_squares(line, straight, poses.position_noise)

    theta = rotation_vectors(poses.q_WB[frames], poses.q_WB[reference])
    R = matrices_of(poses.q_WB[frames])
    rates = _inverse_left_jacobians(theta) @ (R @ np.linalg.inv(I_B) @ R.transpose(0, 2, 1))
    turned = _integral(rates, times)
    design = np.concatenate([np.broadcast_to(np.eye(3), turned.shape), turned], axis=2).reshape(-1, 6)
    solution, cov_rotation = _least_squares(design, theta.reshape(-1, 1), poses.orientation_noise)
    return FlightFit(
        reference=float(poses.times[reference]),
        q_reference=poses.q_WB[reference],
        p_W=p_W,
        v_W=v_W,
        theta_W=solution[:3, 0],
        L_W=solution[3:, 0],
        gravity_W=gravity_W,
        I_B=I_B,
        cov_p=cov_p,
        cov_rotation=cov_rotation,
    )


def _least_squares(design: FloatArray, values: FloatArray, noise: float) -> tuple[FloatArray, FloatArray]:
    """Return the solution, (m, k), and the covariance, (m, m), of each of its k columns."""
    scale = np.abs(design).max(axis=0)
    scaled = design / scale
    solution = np.linalg.lstsq(scaled, values, rcond=None)[0]
    residuals = values - scaled @ solution
    freedom = residuals.size - solution.size
    birge = max(1.0, float(np.square(residuals).sum()) / (freedom * noise * noise)) if freedom else 1.0
    covariance = np.linalg.inv(scaled.T @ scaled) * (birge * noise * noise)
    return solution / scale[:, None], covariance / np.outer(scale, scale)


def _inverse_left_jacobians(theta: FloatArray) -> FloatArray:
    """Return J^-1 = 1 - [theta] / 2 + c [theta]^2, (n, 3, 3): d theta / dt = J^-1 w of R = Exp(theta) R_0."""
    square = np.einsum("ij,ij->i", theta, theta)
    half = 0.5 * np.sqrt(square)
    # with h half the angle, c = (1 - h cot h) / (4 h^2) cancels towards 0; 1/12 + h^2 / 180 is off by 1e-11
    small = half < 1e-2
    h = np.where(small, 1.0, half)
    c = np.where(small, 1.0 / 12.0 + square / 720.0, (1.0 - h / np.tan(h)) / (4.0 * h * h))
    cross = np.zeros((len(theta), 3, 3))
    cross[:, 2, 1], cross[:, 0, 2], cross[:, 1, 0] = theta.T
    cross -= cross.transpose(0, 2, 1)
    jacobians: FloatArray = np.eye(3) - 0.5 * cross + c[:, None, None] * (cross @ cross)
    return jacobians


def _integral(rates: FloatArray, times: FloatArray) -> FloatArray:
    """Return the integrals of ``rates``, (n, 3, 3), by trapezoids, from time 0, one of ``times``, to each."""
    steps = 0.5 * (rates[1:] + rates[:-1]) * np.diff(times)[:, None, None]
    total = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(steps, axis=0)])
    integral: FloatArray = total - total[np.argmin(np.abs(times))]
    return integral
