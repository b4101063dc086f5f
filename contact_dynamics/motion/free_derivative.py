# SPDX-License-Identifier: Apache-2.0
"""The exact derivatives of a free motion with respect to its initial state, at any time.

With theta a small rotation applied after the attitude and dL the change of L, both in world axes, the
neighbours of a torque-free rotation obey

    d theta / dt = I_W^-1 (dL - theta x L),    dL constant,    I_W = R I R^T.

Five of the six solutions follow from symmetry (Arnold, Mathematical Methods of Classical Mechanics, 29):
turns of the world, theta = e and dL = e x L; a later start, theta = w; a faster motion, theta = t w and
dL = L. The last one needs A(t), with theta = A(t) theta_0 at dL = 0. Then any change obeys

    theta(t) = e + A(t) (theta_0 - e) + t w(t) (dL . L) / L^2,    e = L x dL / L^2.

In the body's axes A is B = R^T A R_0 with dB/dt = (I^-1 [L_B] - [w_B]) B. Its coefficients are elliptic
functions of time with the period T of the polhode. B is computed on one period by Gauss collocation, in
pieces so short that its error is rounding. B(T) does not change L and w and keeps volumes, so B(T) - 1 is
nilpotent and B(n T) = 1 + n (B(T) - 1). The cost therefore does not grow with time. A steady spin has a
constant coefficient with K^3 = -nu^2 K, and a closed form. For motion that turns by less than `SMALL_TURN`,
dL is part of the solved equations, because e would grow without bounds.

Accuracy, relative to the largest entry: 1e-13 for compact bodies. Thin rods amplify rounding, to 1e-9 where
moments are as 1 to 1000 and to some percent at 1 to 50 000. Near the middle axis neighbours part by a factor
G before a flip and meet again after it. This leaves at most 1e-15 G^2, which is 1e-9 for 1e-3 rad from that
axis.

Not covered: torque. The answer is NaN where G is beyond about 1e6 and a flip has come, and where neighbours
part so far that the derivative exceeds the range of doubles.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.gauss_collocation import Collocation
from contact_dynamics.rigid_body.body import angular_momentum
from contact_dynamics.rotations.many import cross_matrices, matrices_of
from contact_dynamics.rotations.one import cross_matrix, rotation_matrix
from contact_dynamics.tolerances import GROWTH_ROUNDING, LARGEST_DERIVATIVE_ERROR, SMALL_TURN
from contact_dynamics.tumbling.poinsot_construction import polhode_period
from contact_dynamics.tumbling.polhode import Spin, largest_rate
from contact_dynamics.validation import FloatArray

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.tumbling import FreeMotion, Trajectory

GAUSS: Final = Collocation(12)

PIECE: Final = 0.5
"""Length of a piece in u, the argument of the elliptic functions. Their nearest poles are pi/2 away, so the
polynomial through 12 points in 0.5 errs by about (0.25 / pi)^12, 1e-13."""

FARTHEST: Final = 300.0
"""Largest exponent by which neighbours may part, so that squares stay in the range of doubles."""


def state_derivatives(motion: FreeMotion, seconds: ArrayLike) -> FloatArray:
    """Return the derivatives of the state at times (n,), s, with respect to the state at time 0: (n, 12, 12).

    Rows and columns are position (m), rotation vector (rad, world axes, a small rotation applied after the
    attitude), linear velocity (m/s) and angular velocity (rad/s, world axes).

    Raises:
        InvalidFieldError: the times are not a flat list of finite numbers.
    """
    then = motion.at(seconds)
    times = then.seconds
    derivatives = np.zeros((len(times), 12, 12))
    i = np.arange(3)
    derivatives[:, i, i] = derivatives[:, i + 6, i + 6] = 1.0
    derivatives[:, i, i + 6] = times[:, None]
    rows = np.r_[3:6, 9:12]
    derivatives[:, rows[:, None], rows] = derivatives_along(motion, then)
    return derivatives


def derivatives_along(motion: FreeMotion, then: Trajectory) -> FloatArray:
    """Return the part of `state_derivatives` for rotation vector and angular velocity, (n, 6, 6).

    ``then`` is the motion at the times.
    """
    times = then.seconds
    if len(times) == 0:
        return np.zeros((0, 6, 6))
    state, body = motion.state, motion.body
    L = angular_momentum(body, state)
    L_cross = cross_matrix(L)
    by_w = body.inertia_in_world(state.R_WB)
    by_theta = by_w @ cross_matrix(state.w_WB_W) - L_cross  # dL = I dw + theta x L - I (theta x w)
    R = matrices_of(then.q_WB)
    if largest_rate(motion.rotation) * float(np.abs(times).max()) < SMALL_TURN:
        homogeneous, by_L = _slowly(motion, times)
    else:
        homogeneous = R @ _seen_from_the_body(motion, times) @ state.R_WB.T
        faster = times[:, None, None] * then.w_WB_W[:, :, None] * L
        by_L = (faster + (np.eye(3) - homogeneous) @ L_cross) / (L @ L)
    theta = np.concatenate([homogeneous + by_L @ by_theta, by_L @ by_w], axis=2)
    rate = _inverse_inertia(motion, R) @ (np.hstack([by_theta, by_w]) + L_cross @ theta)
    return np.concatenate([theta, rate - cross_matrices(then.w_WB_W) @ theta], axis=1)


def _slowly(motion: FreeMotion, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return A, and theta's derivative by L, (n, 3, 3) each."""
    L_cross = cross_matrix(angular_momentum(motion.body, motion.state))
    answers = np.zeros((len(times), 3, 6))
    for side in (times > 0.0, times < 0.0):
        if side.any():
            span = float(times[side][np.argmax(np.abs(times[side]))])
            inverse = _inverse_inertia(motion, matrices_of(motion.at(span * GAUSS.points).q_WB))
            forcing = span * np.concatenate([inverse @ L_cross, inverse], axis=2)[None]
            rates = GAUSS.slopes(forcing[..., :3], forcing)[0]
            answers[side] = np.einsum("nk,kij->nij", GAUSS.integrals(times[side] / span), rates)
    return np.eye(3) + answers[:, :, :3], answers[:, :, 3:]


def _seen_from_the_body(motion: FreeMotion, times: FloatArray) -> FloatArray:
    """Return B at times (n,): (n, 3, 3)."""
    rotation = motion.rotation
    if isinstance(rotation, Spin):
        I_B = motion.body.I_B
        w_B = motion.state.R_WB.T @ motion.state.w_WB_W
        return _of_steady_spin(np.linalg.inv(I_B) @ cross_matrix(I_B @ w_B) - cross_matrix(w_B), times)
    rate = abs(float(rotation.omega_p))
    period = polhode_period(rotation)
    turns = np.trunc(times / period)
    answers, errors = _in_pieces(motion, times - turns * period if turns.any() else times, rate)
    if turns.any():
        whole, error = _in_pieces(motion, np.array([period]), rate)
        w_B = motion.state.R_WB.T @ motion.state.w_WB_W
        L_B = motion.body.I_B @ w_B
        across = np.cross(L_B / np.linalg.norm(L_B), w_B / np.linalg.norm(w_B))
        across /= math.sqrt(across @ across)
        drift = (whole[0] - np.eye(3)) @ across
        drift -= across * (across @ drift)
        late = np.eye(3) + turns[:, None, None] * np.outer(drift, across)
        errors = errors * _largest(late) + _largest(answers) * np.abs(turns) * error
        answers = answers @ late
    lost = errors > LARGEST_DERIVATIVE_ERROR * _largest(answers)
    answers[lost] = np.nan
    return answers


def _of_steady_spin(K: FloatArray, times: FloatArray) -> FloatArray:
    """Return exp(K t), (n, 3, 3), for K^3 = -nu^2 K."""
    square = -0.5 * float(np.trace(K @ K))  # nu^2, which is negative about the middle axis
    nu = math.sqrt(abs(square))
    angle = nu * times
    if nu == 0.0:
        first, second = times, 0.5 * times * times
    elif square > 0.0:
        first, second = np.sin(angle) / nu, 2.0 * np.square(np.sin(0.5 * angle) / nu)
    else:
        angle = np.where(np.abs(angle) < FARTHEST, angle, np.nan)
        first, second = np.sinh(angle) / nu, 2.0 * np.square(np.sinh(0.5 * angle) / nu)
    flow: FloatArray = np.eye(3) + first[:, None, None] * K + second[:, None, None] * (K @ K)
    return flow


def _in_pieces(motion: FreeMotion, times: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Return B at times (n,), (n, 3, 3), and its errors, by pieces short at ``rate``, du/dt in 1/s."""
    errors = np.zeros(len(times))
    answers = np.full((len(times), 3, 3), np.nan)
    answers[times == 0.0] = np.eye(3)
    within = np.abs(times) * rate < FARTHEST
    for sign in (1.0, -1.0):
        here = within & (sign * times > 0.0)
        if not here.any():
            continue
        ahead = np.abs(times[here])
        edges = _edges(float(ahead.max()), rate, largest_rate(motion.rotation))
        edges *= sign
        K = _coefficients(motion, GAUSS.nodes_of(edges).ravel()).reshape(-1, GAUSS.count, 3, 3)
        begin, answers[here] = GAUSS.solutions(K, edges, times[here])
        which = np.minimum(np.searchsorted(np.abs(edges), ahead, side="right") - 1, len(edges) - 2)
        errors[here] = GROWTH_ROUNDING * np.square(np.maximum.accumulate(_largest(begin))[which])
    return answers, errors


def _largest(matrices: FloatArray) -> FloatArray:
    """Return the largest entry, by size, of each matrix."""
    largest: FloatArray = np.abs(matrices).max(axis=(1, 2))
    return largest


def _edges(farthest: float, rate: float, w: float) -> FloatArray:
    """Return where pieces begin and end, (n + 1,), s, from 0 to ``farthest``.

    In a nearly symmetric body a piece may last for many turns, w t, and B grows with w t. The first piece is
    therefore divided again at a tenth of its length, a hundredth and so on. Otherwise the small numbers early
    in it would lose their digits beside the large ones late in it.
    """
    count = max(math.ceil(farthest * rate / PIECE), 1)
    length = farthest / count
    tenths = max(math.ceil(math.log10(length * w)), 0)
    early = length * 10.0 ** np.arange(-tenths, 0)
    edges: FloatArray = np.concatenate([[0.0], early, length * np.arange(1, count + 1)])
    return edges


def _coefficients(motion: FreeMotion, times: FloatArray) -> FloatArray:
    """Return I^-1 [L] - [w] in body axes, (n, 3, 3), 1/s, of a tumble.

    In principal axes, with l = L / |L|, an entry is one of l times a difference of |L| / I_i and |L| / I_j.
    """
    l_1, l_2, l_3 = motion.form.momenta(times)
    first, third = motion.w_across
    K = np.zeros((len(times), 3, 3))
    K[:, 0, 1], K[:, 0, 2] = (third - first) * l_3, first * l_2
    K[:, 1, 0], K[:, 1, 2] = -third * l_3, first * l_1
    K[:, 2, 0], K[:, 2, 1] = -third * l_2, (third - first) * l_1
    R_PB = rotation_matrix(np.array(motion.q_PB))
    in_body: FloatArray = R_PB.T @ K @ R_PB
    return in_body


def _inverse_inertia(motion: FreeMotion, R: FloatArray) -> FloatArray:
    inverse: FloatArray = R @ np.linalg.inv(motion.body.I_B) @ R.transpose(0, 2, 1)
    return inverse
