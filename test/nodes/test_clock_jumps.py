# SPDX-License-Identifier: Apache-2.0
"""A simulated clock that jumps, over real DDS; and one that nobody goes by."""

from __future__ import annotations

import time
from typing import Any

from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters.stamps import stamp_to_msg
from running_server import DEEP, ROOT, Client, process

HOUR_NS = 3_600_000_000_000
ARGUMENTS = ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "log:=false")


def odometry(stamp_ns: int) -> Odometry:
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(stamp_ns)
    return msg


def newest(client: Client) -> Any:
    return client.ask(PredictTumbling.Request(body_name="brick", times=[0.0]))


def test_after_a_jump_forwards_states_are_stale_and_after_one_backwards_gone_until_new_ones_come() -> None:
    domain_id = claim_domain()
    with process("server", *ARGUMENTS, "-p", "use_sim_time:=true", ready="ready", domain_id=domain_id):
        client = Client(domain_id=domain_id)
        try:
            clock = client.publisher(Clock, "/clock")
            states = client.publisher(Odometry, "/brick/odometry")
            for hour, said in (
                (2, "none has been received on"),
                (3, "(state_timeout), got 3600.000 s"),
                (1, "states were discarded when the clock was set back"),
            ):
                clock.publish(Clock(clock=stamp_to_msg(hour * HOUR_NS)))
                client.spin_until(lambda said=said: said in newest(client).message)
                states.publish(odometry(hour * HOUR_NS))
                client.spin_until(lambda: newest(client).status == 0)
        finally:
            client.close()


def test_without_simulated_time_nobody_minds_a_clock_that_jumps() -> None:
    domain_id = claim_domain()
    patient = ("-p", "state_timeout:=1000.0")
    with process("server", *ARGUMENTS, *patient, ready="ready", domain_id=domain_id):
        client = Client(domain_id=domain_id)
        try:
            states = client.publisher(Odometry, "/brick/odometry")
            clock = client.node.create_publisher(Clock, "/clock", DEEP)
            states.publish(odometry(time.time_ns()))
            client.spin_until(lambda: newest(client).status == 0)
            for hour in (2, 3, 1):
                clock.publish(Clock(clock=stamp_to_msg(hour * HOUR_NS)))
                answer = newest(client)
                assert answer.status == answer.OK, answer.message
        finally:
            client.close()
