# SPDX-License-Identifier: Apache-2.0
"""The derivatives of a motion under forces with respect to its initial state, along the integrated motion.

Let theta be a small rotation applied after the attitude, dL the change of the angular momentum, and dF and dN
the changes of force and torque, all in world axes. The neighbours of a motion then obey

    dp' = dv,   theta' = I_W^-1 (dL - theta x L),   m dv' = dF,   dL' = dN,   I_W = R I R^T,

where dF and dN are linear in dp, theta, dv and dw = theta x w + I_W^-1 (dL - theta x L). A wrench in body
axes turns by theta, drag follows its law, and a user's function is differentiated by differences. Gauss
collocation (`numerics.gauss_collocation`) solves these equations over the integrator's own steps, which are
cut where neighbours move faster than the motion does.

The accuracy is that of the motion: 1e-11 relative to the largest entry over ten revolutions of a compact
body. With a user's function it is that of the differences (`DIFFERENCE_STEP`). Not covered: forces that jump,
and quadratic drag where the speed passes through zero, beyond its one-sided slopes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.motion.forces import WrenchAxes
from contact_dynamics.numerics.gauss_collocation import Collocation
from contact_dynamics.rotations.many import cross_matrices, matrices_of, turned
from contact_dynamics.tolerances import DIFFERENCE_STEP
from contact_dynamics.tumbling import Sample
from contact_dynamics.validation import FloatArray, check_array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.motion.forces import WrenchFunction
    from contact_dynamics.motion.integrated import ForcedMotion
    from contact_dynamics.rotations.one import Quaternion
    from contact_dynamics.tumbling import Trajectory

GAUSS: Final = Collocation(8)

PIECE: Final = 0.5
"""Length of a piece times the fastest rate at which neighbours turn, part or meet, rad. Its 8 points then err
by about (PIECE / 4)^8 / 8!, 1e-12, in the middle of a piece, and by far less at its end."""

MAX_PIECES: Final = 5000
"""Pieces in one direction of time: 0.2 GB, and some seconds of computing. A turn takes some twenty."""

P, THETA, V, W = (slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12))
"""Rows and columns of the parts of a state. In the equations the last part is dL / I_max, rad/s."""


def forced_state_derivatives(motion: ForcedMotion, seconds: ArrayLike) -> FloatArray:
    """Return the derivatives of the state at times (n,), s, with respect to the state at time 0: (n, 12, 12).

    Order and units are those of `contact_dynamics.motion.free_derivative.state_derivatives`.

    Raises:
        InvalidFieldError: the times are not a flat list of finite numbers, or are beyond the range of the
            motion.
        TooLargeError: the times are so far away, or the drag is so strong, that it takes more than
            `MAX_PIECES` pieces.
    """
    times = check_array("seconds", seconds, (None,))
    answers = np.tile(np.eye(12), (len(times), 1, 1))
    for side in (times > 0.0, times < 0.0):
        if side.any():
            answers[side] = _one_way(motion, times[side])
    return answers


def _one_way(motion: ForcedMotion, times: FloatArray) -> FloatArray:
    edges = _edges(motion, float(times[np.argmax(np.abs(times))]))
    nodes = GAUSS.nodes_of(edges).ravel()
    K = _coefficients(motion, nodes).reshape(-1, GAUSS.count, 12, 12)
    with np.errstate(over="ignore", invalid="ignore"):  # neighbours may diverge beyond the range of doubles
        flow = GAUSS.solutions(K, edges, times)[1]
        begin = _rates_for_momenta(motion, motion.at([0.0]))[0]
        found: FloatArray = _rates_for_momenta(motion, motion.at(times)) @ flow @ np.linalg.inv(begin)
    return found


def _edges(motion: ForcedMotion, end: float) -> FloatArray:
    """Return the integrator's steps from 0 to ``end``, each cut into pieces short for the neighbours."""
    steps = motion.steps_to(end)
    lengths = np.diff(steps)
    rates = np.abs(np.linalg.eigvals(_coefficients(motion, steps[:-1] + 0.5 * lengths))).max(axis=1)
    pieces = np.maximum(np.ceil(rates * np.abs(lengths) / PIECE), 1.0)
    total = float(pieces.sum())
    if not total <= MAX_PIECES:
        found = f"{end:g} s, which takes {total:.6g} pieces"
        raise TooLargeError("times", found, f"at most {MAX_PIECES} pieces for a covariance")
    counts = pieces.astype(int)
    shares = np.concatenate([np.arange(count) / count for count in counts.tolist()])
    edges: FloatArray = np.append(np.repeat(steps[:-1], counts) + shares * np.repeat(lengths, counts), end)
    return edges


def _coefficients(motion: ForcedMotion, times: FloatArray) -> FloatArray:
    """Return the matrices, (n, 12, 12), of the equations for dp, theta, dv and dL / I_max."""
    then = motion.at(times)
    to_rates = _rates_for_momenta(motion, then)
    by_state = _wrench_derivatives(motion, then)
    K = np.zeros((len(times), 12, 12))
    K[:, P, V] = np.eye(3)
    K[:, THETA] = to_rates[:, W]
    K[:, THETA, THETA] += cross_matrices(then.w_WB_W)  # theta' = dw + w x theta
    K[:, V] = by_state[:, :3] @ to_rates / motion.body.mass
    K[:, W] = by_state[:, 3:] @ to_rates / motion.law.scale
    return K


def _rates_for_momenta(motion: ForcedMotion, then: Trajectory) -> FloatArray:
    """Return the matrices, (n, 12, 12), from a state's change with dL / I_max in it to that with dw."""
    R = matrices_of(then.q_WB)
    R_T = R.transpose(0, 2, 1)
    inverse = R @ np.linalg.inv(motion.body.I_B) @ R_T
    L = np.einsum("nij,jk,nlk,nl->ni", R, motion.body.I_B, R, then.w_WB_W)
    matrices = np.tile(np.eye(12), (len(R), 1, 1))
    matrices[:, W, THETA] = inverse @ cross_matrices(L) - cross_matrices(then.w_WB_W)
    matrices[:, W, W] = motion.law.scale * inverse
    return matrices


def _wrench_derivatives(motion: ForcedMotion, then: Trajectory) -> FloatArray:
    """Return the derivatives, (n, 6, 12), of force and torque by position, rotation, and both velocities."""
    found = np.zeros((len(then), 6, 12))
    if motion.wrench.axes is WrenchAxes.BODY:
        R = matrices_of(then.q_WB)
        found[:, :3, THETA] = -cross_matrices(R @ motion.wrench.force)
        found[:, 3:, THETA] = -cross_matrices(R @ motion.wrench.torque)
    drag = motion.drag
    found[:, :3, V] = _drag_derivatives(then.v_WB_W, drag.linear, drag.quadratic)
    found[:, 3:, W] = _drag_derivatives(then.w_WB_W, drag.linear_angular, drag.quadratic_angular)
    if motion.wrench_of is not None:
        for i in range(len(then)):
            found[i] += _differences(motion.wrench_of, then, i)
    return found


def _drag_derivatives(v: FloatArray, linear: float, quadratic: float) -> FloatArray:
    """Return the derivatives, (n, 3, 3), of -(linear + quadratic |v|) v."""
    speed = np.sqrt(np.einsum("ni,ni->n", v, v))
    along = np.divide(v, speed[:, None], out=np.zeros_like(v), where=speed[:, None] > 0.0)
    across = -(linear + quadratic * speed)[:, None, None] * np.eye(3)
    found: FloatArray = across - quadratic * v[:, :, None] * along[:, None, :]
    return found


def _differences(wrench_of: WrenchFunction, then: Trajectory, i: int) -> FloatArray:
    """Return the derivatives, (6, 12), of a user's function at sample i, by central differences."""
    seconds = float(then.seconds[i])
    q = then.q_WB[i]
    attitude: Quaternion = tuple(q.tolist())
    numbers = [*then.p_WB_W[i].tolist(), 0.0, 0.0, 0.0, *then.v_WB_W[i].tolist(), *then.w_WB_W[i].tolist()]
    found = np.empty((6, 12))
    for column, number in enumerate(numbers):
        size = DIFFERENCE_STEP * max(1.0, abs(number))
        pair = []
        for step in (size, -size):
            moved = numbers.copy()
            moved[column] += step
            px, py, pz, *theta, vx, vy, vz, wx, wy, wz = moved
            there = attitude
            if any(theta):
                there = tuple(turned(q[None], np.array([theta]))[0].tolist())
            force, torque = wrench_of(seconds, Sample((px, py, pz), there, (vx, vy, vz), (wx, wy, wz)))
            pair.append([*map(float, force), *map(float, torque)])
        found[:, column] = (np.array(pair[0]) - np.array(pair[1])) / (2.0 * size)
    if not math.isfinite(float(found.sum())):
        raise InvalidFieldError("wrench_of", f"a slope that is not finite at {seconds:g} s", "finite slopes")
    return found
