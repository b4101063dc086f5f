# SPDX-License-Identifier: Apache-2.0
"""Sends requests about the body of an example to a running server, and prints each new response in words.

It sends four requests per second, about the first body of the server's parameters, which it receives as well.
"""

from __future__ import annotations

import sys
import time
from typing import Any, Final

import numpy as np
from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.utilities import remove_ros_args

from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.contact_modes.result import does_turn
from contact_dynamics.demo.arguments import PUSHED_BLOCK, THROWN_BOX, TRAY, commentator_parser
from contact_dynamics.demo.patience import Patience
from contact_dynamics.diagrams.words import OUTCOMES, VERDICTS
from contact_dynamics.errors import ContactDynamicsError, NotSupportedError
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.nodes.node_parameters import NodeParameters
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.running import ros_until_stopped
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact
from msg_adapters.geometry import vector_from_msg, vector_to_msg

QOS: Final = QoSProfile(depth=1000)  # with many clients, responses overflow shorter queues
PERIOD_S: Final = 0.25  # s between two requests
SOON_S: Final = 0.02  # s; before an earlier landing, it requests the contact mode instead
DEADLINE_S: Final = 1.0  # s; a request without a response is abandoned after this time

SILENCE_S: Final = 1.5  # s without a state after which the scenario is over


class Commentator(Node):
    """The node `commentator`."""

    def __init__(self, situation: str, server: str) -> None:
        """Read the configuration, and create the clients.

        Raise `ContactDynamicsError` if the configuration is invalid, or has no body with an odometry_topic.
        """
        super().__init__("commentator")
        parameters = read_server_parameters(NodeParameters(self, read_only=True))
        topics = [source.topics[0] for each in parameters.sources[:1] for source in each.sources]
        if not topics:
            raise NotSupportedError("bodies must have one with an odometry_topic, got none")
        self._body = parameters.world.bodies[0]
        self._comment = {
            THROWN_BOX: self._comment_on_the_box,
            PUSHED_BLOCK: self._comment_on_the_push,
            TRAY: self._comment_on_the_tray,
        }[situation]
        self._newest: dict[type, Any] = {}
        self._silence: Patience | None = None  # since the newest state
        self._measured: list[tuple[type, str]] = [(Odometry, topics[0].full_name)]
        if situation == PUSHED_BLOCK:
            self._measured.append((WrenchStamped, "/finger/wrench"))
        elif situation == TRAY:
            self._measured.append((Vector3Stamped, "/tray/gravity"))
        self._impact = self.create_client(PredictImpact, f"{server}/predict_impact", qos_profile=QOS)
        self._mode = self.create_client(PredictContactMode, f"{server}/predict_contact_mode", qos_profile=QOS)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self)
        self._begun: float | None = None
        self._told = ""

    def get_ready(self) -> bool:
        """Return whether the server responds, and then subscribe to the measurements.

        The publishers start when they have subscribers, so it subscribes only when the server is ready.
        """
        if self._ask(self._mode, PredictContactMode.Request(body_name=self._body.name)) is None:
            self._spin()
            return False
        for msg_type, topic in self._measured:
            self._listen(msg_type, topic)
        return True

    @property
    def is_over(self) -> bool:
        """Whether there were states, and no more arrive."""
        return self._silence is not None and self._silence.is_over

    def comment(self) -> None:
        """Send a request, print its response if it is new, and receive until the next request is due."""
        due = time.monotonic() + PERIOD_S
        words = self._comment()
        if words and words != self._told:
            self._told = words
            now = time.monotonic()
            self._begun = now if self._begun is None else self._begun
            print(f"{now - self._begun:5.1f} s  {words}", flush=True)
        while time.monotonic() < due:
            self._spin()

    def _comment_on_the_box(self) -> str:
        """Return the outcome of the next landing, or the contact mode of the box."""
        answer = self._ask(self._impact, PredictImpact.Request(body_name=self._body.name))
        if answer is None or answer.status != answer.OK or answer.time_to_contact < SOON_S:
            request = PredictContactMode.Request(body_name=self._body.name)
            # The recorded states were measured, with this noise.
            request.velocity_tolerance, request.distance_tolerance = 0.05, 0.003
            return self._words_of_modes(request, "it touches")
        v = answer.impact.state_after.linear_velocity
        where, outcome = answer.contacts.surface_names[0], OUTCOMES[ImpactOutcome(answer.impact.outcome)]
        return (
            f"it lands in {answer.time_to_contact:.3f} s on {where}, where it {outcome} and leaves with"
            f" ({v.x:.2f}, {v.y:.2f}, {v.z:.2f}) m/s"
        )

    def _comment_on_the_push(self) -> str:
        """Return the contact mode under the finger's wrench, which refers to the world's origin."""
        if len(self._newest) < 2:
            return ""
        measured = self._newest[WrenchStamped]
        wrench = measured.wrench
        force, torque = vector_from_msg(wrench.force), vector_from_msg(wrench.torque)
        center = vector_from_msg(self._newest[Odometry].pose.pose.position)
        request = self._request_at(measured.header.stamp)
        request.applied_wrench.force = vector_to_msg(force)
        request.applied_wrench.torque = vector_to_msg(torque - np.cross(center, force))
        request.plane_normal.y = -1.0
        return self._words_of_modes(request, f"pushed with {np.linalg.norm(force):4.2f} N")

    def _comment_on_the_tray(self) -> str:
        """Return the contact mode under gravity as measured by the tray's accelerometer."""
        if len(self._newest) < 2:
            return ""
        measured = self._newest[Vector3Stamped]
        gravity = vector_from_msg(measured.vector)
        request = self._request_at(measured.header.stamp)
        request.gravity = request.GRAVITY_NONE  # all of it is in the wrench
        request.applied_wrench.force = vector_to_msg(self._body.mass_properties.mass * gravity)
        request.plane_normal.y = -1.0
        tilt = np.degrees(np.arctan2(gravity[0], -gravity[2]))
        return self._words_of_modes(request, f"tilted by {tilt:4.1f} degrees")

    def _request_at(self, stamp: Any) -> PredictContactMode.Request:
        """Return a request about the state at the time of a measurement."""
        request = PredictContactMode.Request(body_name=self._body.name, include_margins=True)
        request.state_source, request.stamp = request.STATE_AT_STAMP, stamp
        return request

    def _words_of_modes(self, request: PredictContactMode.Request, where: str) -> str:
        answer = self._ask(self._mode, request)
        if answer is None:
            return ""
        if answer.status != answer.OK:
            is_silent = answer.status in {answer.NO_STATE, answer.STALE_STATE, answer.NO_CONTACT}
            return "" if is_silent else f"{where}: {answer.message}"
        if answer.verdict != answer.UNIQUE:
            return f"{where}: {self._body.name} {VERDICTS[ModeVerdict(answer.verdict)]}"
        (mode,) = answer.modes
        words = f"{where}: {mode_in_words(mode.mode, turns=does_turn(mode.angular_acceleration))}"
        if np.isfinite(mode.margin):
            beyond = " or ".join(mode_in_words(other) for other in mode.margin_modes)
            words += f" (margin {mode.margin:.2f} N, then {beyond or 'no mode is consistent'})"
        return words

    def _ask(self, client: Any, request: Any) -> Any:
        """Return the response, or None after the deadline."""
        if not client.service_is_ready():
            return None
        future = client.call_async(request)
        patience = Patience(DEADLINE_S)
        # In rclpy 7.1, each call of spin_until_future_complete makes the next one slower.
        while not (future.done() or patience.is_over):
            self._spin()
            patience.look()
        if future.done():
            return future.result()
        client.remove_pending_request(future)
        return None

    def _spin(self) -> None:
        self._executor.spin_once(timeout_sec=0.05)
        if self._silence is not None:
            self._silence.look()

    def _listen(self, msg_type: type, topic: str) -> None:
        def keep(msg: object) -> None:
            self._newest[msg_type] = msg
            self._silence = Patience(SILENCE_S)

        self.create_subscription(msg_type, topic, keep, 1)  # only the latest


def main(arguments: list[str]) -> int:
    """Print responses until the states end or the process is interrupted, and return the exit code."""
    given = commentator_parser().parse_args(remove_ros_args(arguments))
    with ros_until_stopped(arguments) as stop:
        try:
            commentator = Commentator(given.situation, given.server)
        except ContactDynamicsError as error:
            print(f"configuration: {error}", file=sys.stderr)
            return 2
        while not (stop.is_set() or commentator.get_ready()):
            pass
        while not (stop.is_set() or commentator.is_over):
            commentator.comment()
    return 0
