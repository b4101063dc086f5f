# SPDX-License-Identifier: Apache-2.0
"""Who asks and finds no state is told what became of those that came; the log, asked again, says the same."""

from __future__ import annotations

import math
import signal
from pathlib import Path
from typing import Any

from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock

from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.msg import BodyStates
from contact_dynamics_interfaces.srv import PredictTumbling, PredictTumblingBatch
from message_words import says
from msg_adapters.stamps import stamp_to_msg
from nodes.monitor import odometry
from running_server import ROOT, Client, process

HOUR_NS = 3_600_000_000_000
PARCEL = (
    "bodies:=[brick, parcel]",
    "body.parcel.mass:=1.0",
    "body.parcel.inertia:=[0.0]",
    "body.parcel.sphere:=[0.05]",
)
ARGUMENTS = (
    *("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "use_sim_time:=true"),
    *(each for parameter in PARCEL for each in ("-p", parameter)),
)


def asked(client: Client, body_name: str) -> Any:
    return client.ask(PredictTumbling.Request(body_name=body_name, times=[0.0]))


def newest(client: Client) -> Any:
    return asked(client, "brick")


def ask_beyond_reason(client: Client) -> None:
    """A question whose numbers overflow, of which NumPy would warn."""
    far = PredictTumblingBatch.Request(body_name="brick", times=[1e300])
    far.states = BodyStates(
        positions=[0.0, 0.0, 1.0],
        orientations=[0.0, 0.0, 0.0, 1.0],
        linear_velocities=[1e30, 0.0, -1.0],
        angular_velocities=[0.0, 3.0, 0.0],
    )
    assert client.ask(far).status != 0


def test_no_state_says_what_became_of_those_that_came(tmp_path: Path) -> None:
    """Nor is a state kept that makes no sense, or is NumPy's warning of it printed."""
    ready = "ready: bodies brick, parcel (no state topic); log"
    with process("server", *ARGUMENTS, "-p", f"log_directory:={tmp_path}", ready=ready) as server:
        client = Client()
        try:
            states = client.publisher(Odometry, "/brick/odometry")
            clock = client.publisher(Clock, "/clock")

            def wait_for(words: str) -> None:
                client.spin_until(lambda: says(newest(client).message, words))

            clock.publish(Clock(clock=stamp_to_msg(2 * HOUR_NS)))
            wait_for(
                "no state of 'brick': none has been received on /brick/odometry (1 publisher); "
                "publish states there, or set state_source: 1 (STATE_EXPLICIT) and provide the field state"
            )
            assert says(
                asked(client, "parcel").message, "no topic ... set body.parcel.odometry_topic, or set"
            )
            states.publish(odometry(2 * HOUR_NS, frame="map"))
            wait_for("1 message received; the last was rejected ... s ago because header.frame_id must be")
            states.publish(b"\0\1\0\0no message at all")
            wait_for("2 messages received; ... ago because data must be a..., got 24 bytes")
            states.publish(odometry(4 * HOUR_NS))
            wait_for("3 messages received; the last was rejected ... because stamp must be ..., got 7200")
            for number, nonsense in enumerate((math.nan, math.inf, 1e308, 1e300, 1e9)):
                msg = odometry(2 * HOUR_NS)
                msg.pose.covariance[0] = msg.pose.pose.position.x = nonsense
                msg.twist.twist.linear.x = msg.twist.twist.angular.y = nonsense
                states.publish(msg)
                wait_for(f"{4 + number} messages received; the last was rejected ... because")
                ask_beyond_reason(client)
            states.publish(odometry(2 * HOUR_NS))
            client.spin_until(lambda: newest(client).status == 0)
            states.publish(odometry(2 * HOUR_NS, frame="map"))
            clock.publish(Clock(clock=stamp_to_msg(2 * HOUR_NS + 1_000_000_000)))
            wait_for("the latest state of 'brick' must be at most 0.5 s old (state_timeout), got 1.000 s")
            wait_for("later messages were rejected, the last ... s ago because header.frame_id must be")
            clock.publish(Clock(clock=stamp_to_msg(HOUR_NS)))
            wait_for("10 messages received; the stored states were discarded when the clock was set back")
            states.publish(odometry(HOUR_NS))
            client.spin_until(lambda: newest(client).status == 0)
        finally:
            client.close()
        server.send_signal(signal.SIGINT)
        assert server.stdout is not None
        printed = server.stdout.read()
    assert "message ignored" in printed
    assert "RuntimeWarning" not in printed
    (log,) = tmp_path.iterdir()
    assert verify_log(log).agrees
