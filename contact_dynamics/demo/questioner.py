# SPDX-License-Identifier: Apache-2.0
"""Asks the server about a toss while it happens, as a robot would.

It asks at meaningful moments, and uses only what was published so far.
"""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import rclpy
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from contact_dynamics.constants import ns_after, seconds_between, to_seconds
from contact_dynamics.demo.patience import Patience
from contact_dynamics.demo.toss_publisher import QOS, WORLD_FRAME, topic_of
from contact_dynamics.motion.velocity_estimate import WINDOW
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from msg_adapters.odometry import body_state_from_odometry
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.measured.recorded_toss import Toss
    from contact_dynamics.rigid_body.body import BodyState

ANSWER_S: Final = 10.0
"""Longest time for an answer, s, also on a busy machine."""

LAST_MOMENT: Final = 0.025
"""Time before the predicted landing at which it asks for the impact, s: late, but early enough to act."""

SILENCE_S: Final = 1.0
"""If states are missing, the toss is over when its publisher has ended and none has come for this time, s."""

REST_FRAMES: Final = 2  # number of frames for which a body must be slow before it asks for the contact mode

REST_DEVIATIONS: Final = 3.0
"""A body is slow if its velocities are within this many standard deviations of their noise."""

CURVE_POINTS: Final = 120  # number of points of polhode and herpolhode, for the picture

_START_S: Final = 30.0
_POLL_S: Final = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """One question with its answer."""

    time: float  # time of the newest state when it was asked, s, on the recording's clock
    response: Any  # the service's response
    round_trip: float  # time until the answer came, s


class Questioner(Node):
    """The node `demo`, which listens to a body's states and asks."""

    def __init__(self, toss: Toss) -> None:
        """Look for the services."""
        super().__init__("demo")
        self._toss = toss
        self._epoch_ns: int | None = None
        self._now = 0.0
        self._flying_since = 0.0  # s on the recording's clock, as predicted
        self._silence = Patience(_START_S)  # until the first state, as long as a start may take
        self._recent: deque[BodyState] = deque(maxlen=REST_FRAMES)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self)
        self._askers = {
            service: self.create_client(service, f"/contact_dynamics/{name}", qos_profile=QOS)
            for service, name in (
                (PredictTumbling, "predict_tumbling"),
                (PredictImpact, "predict_impact"),
                (PredictContactMode, "predict_contact_mode"),
            )
        }
        self.received = 0
        self.latest = 0.0  # s, the longest that a state was on its way
        self.flights: list[Asked] = []
        self.impacts: list[Asked] = []
        self.modes: list[Asked] = []

    def get_ready(self, go_on: Callable[[], object]) -> None:
        """Wait until all services are there, and only then subscribe, as the publisher waits for that.

        Waiting ends where ``go_on`` raises because it is useless, or with a `TimeoutError`.
        """
        deadline = time.monotonic() + _START_S
        for client in self._askers.values():
            while not client.wait_for_service(_POLL_S):
                go_on()
                if time.monotonic() > deadline:
                    message = f"the server does not serve {client.srv_name}"
                    raise TimeoutError(message)
        self.create_subscription(Odometry, topic_of(self._toss), self._receive, QOS)

    def watch(self, playing: Callable[[], bool]) -> None:
        """Listen and ask until the toss is over."""
        self._silence = Patience(_START_S)
        landing: float | None = None  # predicted, s on the recording's clock
        # velocities look back over WINDOW, so it must have seen that much flight before it asks
        blind_until = 0.0
        while self.received < len(self._toss) and (playing() or not self._silence.is_over):
            if not self._spin():
                continue
            if self._at_rest() and not self.modes:
                self._ask_contact_mode()
            elif landing is not None and self._now >= landing - LAST_MOMENT:
                self._ask_impact()
                self._flying_since = landing + 0.5 * WINDOW
                blind_until = self._flying_since + WINDOW
                landing = None
            elif landing is None and self._now >= max(blind_until, WINDOW) and not self.modes:
                landing = self._ask_landing()
                if landing is None:
                    blind_until = self._now + WINDOW
        if self.received and not self.modes:  # recordings may end as soon as the body does not move
            self._ask_contact_mode()

    def _flight_seen(self) -> float:
        """Return how long the body has been flying, s, less one frame, in which it may have touched."""
        return max(0.0, self._now - self._flying_since - 1.0 / self._toss.rate)

    def _receive(self, msg: Odometry) -> None:
        state = body_state_from_odometry(msg, world_frame=WORLD_FRAME, p_FB_F=self._toss.body.p_FB_F)
        if self._epoch_ns is None:
            self._epoch_ns = ns_after(state.stamp_ns, -float(self._toss.times[0]))
        self._now = seconds_between(self._epoch_ns, state.stamp_ns)
        late_ns = self.get_clock().now().nanoseconds - state.stamp_ns
        self.latest = max(self.latest, to_seconds(late_ns))
        self._recent.append(state)
        self._silence = Patience(SILENCE_S)
        self.received += 1

    def _spin(self) -> bool:
        """Return whether a state has come."""
        before = self.received
        self._executor.spin_once(timeout_sec=0.1)
        self._silence.look()
        return self.received > before

    def _at_rest(self) -> bool:
        slow = REST_DEVIATIONS * self._toss.velocity_noise
        slow_spin = REST_DEVIATIONS * self._toss.angular_velocity_noise
        return len(self._recent) == REST_FRAMES and all(
            abs(state.v_WB_W).max() < slow and abs(state.w_WB_W).max() < slow_spin for state in self._recent
        )

    def _ask_landing(self) -> float | None:
        request = PredictTumbling.Request(
            body_name=self._toss.body.name, rate=self._toss.rate, fit_window=self._flight_seen()
        )
        request.sampling = request.UNTIL_CONTACT
        request.curve_points = CURVE_POINTS
        asked = self._ask(request)
        landing = self.seconds_of(asked.response.state.header.stamp) + float(asked.response.event_time)
        if landing - self._now <= LAST_MOMENT:  # it touches, or soon will, so no flight is left to fit
            self._flying_since = self._now
        if not landing - self._now > LAST_MOMENT:  # it does not land (NaN), or it is too late to ask
            return None
        self.flights.append(asked)
        return landing

    def _ask_impact(self) -> None:
        request = PredictImpact.Request(body_name=self._toss.body.name, fit_window=self._flight_seen())
        self.impacts.append(self._ask(request))

    def _ask_contact_mode(self) -> None:
        self.modes.append(self._ask(PredictContactMode.Request(body_name=self._toss.body.name)))

    def seconds_of(self, stamp: Any) -> float:
        """Return a stamp on the recording's clock, s."""
        return seconds_between(self._epoch_ns or 0, stamp_ns_from_msg(stamp))

    def _ask(self, request: Any) -> Asked:
        request.state_source = request.STATE_AT_STAMP
        request.stamp = stamp_to_msg(self._recent[-1].stamp_ns)  # however far the toss has gone
        client = next(
            self._askers[service] for service in self._askers if isinstance(request, service.Request)
        )
        start, now = time.monotonic(), self._now
        future, patience = client.call_async(request), Patience(ANSWER_S)
        while not future.done():
            if patience.is_over:
                message = f"no answer from {client.srv_name} within {ANSWER_S:g} s"
                raise TimeoutError(message)
            self._executor.spin_once(timeout_sec=0.1)
            patience.look()
        return Asked(time=now, response=future.result(), round_trip=time.monotonic() - start)

    def close(self) -> None:
        """Leave ROS."""
        self._executor.shutdown()
        self.destroy_node()
        rclpy.try_shutdown()
