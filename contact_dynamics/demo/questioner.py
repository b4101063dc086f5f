# SPDX-License-Identifier: Apache-2.0
"""Sends requests about a toss to the server while the states are published, as a robot would.

Each request uses only the states published before it.
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

ANSWER_S: Final = 10.0  # longest time to wait for a response, s, even on a busy machine

LAST_MOMENT: Final = 0.025
"""Time before the predicted landing at which the impact is requested, s: late, but early enough to act."""

SILENCE_S: Final = 1.0
"""The toss is also over if its publisher has ended and no state has arrived for this time, s."""

REST_FRAMES: Final = 2  # frames for which the body must be slow before the contact mode is requested

REST_DEVIATIONS: Final = 3.0
"""A body is slow if all velocity components are within this many standard deviations of the noise."""

CURVE_POINTS: Final = 120  # number of points of the polhode and herpolhode in the picture

_START_S: Final = 30.0
_POLL_S: Final = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """One request with its response."""

    time: float  # time of the latest state at the request, s, on the recording's clock
    response: Any  # response of the service
    round_trip: float  # time until the response, s


class Questioner(Node):
    """The node `demo`, which receives a body's states and sends the requests."""

    def __init__(self, toss: Toss) -> None:
        """Create the clients."""
        super().__init__("demo")
        self._toss = toss
        self._epoch_ns: int | None = None
        self._now = 0.0
        self._flying_since = 0.0  # predicted, s on the recording's clock
        self._silence = Patience(_START_S)  # until the first state, the start of the processes counts
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
        self.latest = 0.0  # s, longest time between the stamp and the arrival of a state
        self.flights: list[Asked] = []
        self.impacts: list[Asked] = []
        self.modes: list[Asked] = []

    def get_ready(self, check: Callable[[], object]) -> None:
        """Wait for all services, and then subscribe to the states, which makes the publisher start.

        It calls ``check`` repeatedly, which raises an error when waiting has become useless. Raise
        `TimeoutError` if the server does not provide the services in time.
        """
        deadline = time.monotonic() + _START_S
        for client in self._askers.values():
            while not client.wait_for_service(_POLL_S):
                check()
                if time.monotonic() > deadline:
                    raise TimeoutError(f"the server does not serve {client.srv_name}")
        self.create_subscription(Odometry, topic_of(self._toss), self._receive, QOS)

    def watch(self, playing: Callable[[], bool]) -> None:
        """Receive states and send requests until the toss is over."""
        self._silence = Patience(_START_S)
        landing: float | None = None  # predicted, s on the recording's clock
        # Velocities are estimated over WINDOW, so the flight must have lasted that long before a request.
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
        if self.received and not self.modes:  # a recording may end when the body stops
            self._ask_contact_mode()

    def _flight_seen(self) -> float:
        """Return the duration of the flight, s, without its first frame, which may contain the contact."""
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
        """Wait for a state, and return whether one has arrived."""
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
        if landing - self._now <= LAST_MOMENT:  # too close to the contact for a fit of the flight
            self._flying_since = self._now
        if not landing - self._now > LAST_MOMENT:  # no landing (NaN), or too late for a request
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
        request.stamp = stamp_to_msg(self._recent[-1].stamp_ns)  # although newer states may have arrived
        client = next(
            self._askers[service] for service in self._askers if isinstance(request, service.Request)
        )
        start, now = time.monotonic(), self._now
        future, patience = client.call_async(request), Patience(ANSWER_S)
        while not future.done():
            if patience.is_over:
                raise TimeoutError(f"no answer from {client.srv_name} within {ANSWER_S:g} s")
            self._executor.spin_once(timeout_sec=0.1)
            patience.look()
        return Asked(time=now, response=future.result(), round_trip=time.monotonic() - start)

    def close(self) -> None:
        """Leave ROS."""
        self._executor.shutdown()
        self.destroy_node()
        rclpy.try_shutdown()
