# SPDX-License-Identifier: Apache-2.0
"""Converts poses alone to states: the velocities are estimated from the poses in a short window.

The filter is `motion.velocity_estimate`: a quadratic is fitted to each coordinate over the window, and its
slope at the newest pose is the velocity. Its delay is zero while the acceleration is constant, as in flight.
For 50 poses at 1 kHz with white noise sigma, the velocity has the noise 38 sigma per second; for 12 poses at
240 Hz, 75 sigma per second (`slope_noise`). After an impact it is wrong until the window has passed.

Not covered: a body that turns by nearly a whole turn or more between poses. Its poses equal those of a body
that turns slowly or backwards.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import seconds_since, to_ns
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.velocity_estimate import FEWEST_FRAMES, newest_velocity, slope_weights
from contact_dynamics.motion.whole_turns import THIRD_OF_A_TURN
from contact_dynamics.rigid_body.published_frame import state_of_center_of_mass
from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics.validation import check_array, check_unit
from msg_adapters.published_covariance import with_covariance

if TYPE_CHECKING:
    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.validation import FloatArray
    from msg_adapters.state_adapter import SourceSettings

LONGEST_GAP: Final = 5.0  # number of windows without a pose, after which earlier poses are discarded
MAX_POSES: Final = 1000  # largest number of stored poses in a window: 20 kHz in the default one


class _Pose(NamedTuple):
    stamp_ns: int
    p: FloatArray
    q: FloatArray


class PoseTrack:
    """The last poses of a body's frame, in world axes."""

    def __init__(self, settings: SourceSettings) -> None:
        """Begin without poses."""
        self._window_ns = to_ns(settings.velocity_window)
        self._p_FB_F = settings.p_FB_F
        self._poses: deque[_Pose] = deque(maxlen=MAX_POSES)
        self._far_behind = 0  # poses in turn

    def add(
        self, p_WF: FloatArray, q_WF: FloatArray, *, stamp_ns: int, covariance: FloatArray | None = None
    ) -> KnownState | None:
        """Add a pose; return its state, or None for the first poses and for a late one.

        The origin ``p_WF``, (3,), m, and the orientation ``q_WF``, (4,), x y z w, are those of the frame. The
        noise of the poses is assumed independent, with the same ``covariance``, (6, 6), in ROS's order, or
        unknown.

        After `FEWEST_FRAMES` successive poses that are behind the newest by more than `LONGEST_GAP` windows,
        the publisher's clock was set back, or a simulation restarted. Earlier poses are then discarded.

        Raise `InvalidFieldError` if a number is not finite, the quaternion is not unit, the body turns by
        half a turn or more within the window, or it may have done so while poses were missing.
        """
        pose = _Pose(
            stamp_ns, check_array("pose.position", p_WF, (3,)), check_unit("pose.orientation", q_WF, 4)
        )
        poses = self._poses
        if poses and stamp_ns <= poses[-1].stamp_ns:
            self._far_behind += poses[-1].stamp_ns - stamp_ns > LONGEST_GAP * self._window_ns
            if self._far_behind < FEWEST_FRAMES:
                return None
            poses.clear()
        self._far_behind = 0
        if poses and stamp_ns - poses[-1].stamp_ns > LONGEST_GAP * self._window_ns:
            poses.clear()
        poses.append(pose)
        while len(poses) > FEWEST_FRAMES and stamp_ns - poses[0].stamp_ns > self._window_ns:
            poses.popleft()
        return None if len(poses) < FEWEST_FRAMES else self._newest(covariance)

    def _newest(self, covariance: FloatArray | None) -> KnownState:
        newest = self._poses[-1]
        times = seconds_since(newest.stamp_ns, [pose.stamp_ns for pose in self._poses])
        q = np.array([pose.q for pose in self._poses])
        turns = rotation_vectors(q[1:], q[:-1])
        angle = float(np.sqrt(np.einsum("ij,ij->i", turns, turns)).sum())
        if angle >= np.pi:
            found = f"a turn by {angle:.3g} rad within {-times[0]:.3g} s"
            raise InvalidFieldError("pose.orientation", found, "less than half a turn (velocity_window)")
        self._check_gap(times, turns)
        v_WF, w_WF = newest_velocity(times, np.array([pose.p for pose in self._poses]), q)
        state = state_of_center_of_mass(
            p_WF_W=newest.p,
            q_WF=newest.q,
            v_WF_W=v_WF,
            w_WF_W=w_WF,
            p_FB_F=self._p_FB_F,
            stamp_ns=newest.stamp_ns,
        )
        if covariance is None:
            return state
        weights = slope_weights(times)
        shares = np.array([[1.0, weights[-1]], [weights[-1], weights @ weights]])
        return with_covariance(state, np.kron(shares, covariance), self._p_FB_F, twist_in_body_axes=False)

    @staticmethod
    def _check_gap(times: FloatArray, turns: FloatArray) -> None:
        """Compare the turn over the longest gap with that at the mean rate of the other poses."""
        gaps = np.diff(times)
        longest = int(np.argmax(gaps))
        others = np.delete(turns, longest, axis=0).sum(axis=0) / (gaps.sum() - gaps[longest])
        expected = others * gaps[longest]
        if np.linalg.norm(turns[longest] - expected) > THIRD_OF_A_TURN:
            found = f"{gaps[longest]:.3g} s without a pose, at about {np.linalg.norm(others):.3g} rad/s"
            raise InvalidFieldError("pose.orientation", found, "less than half a turn between poses")
