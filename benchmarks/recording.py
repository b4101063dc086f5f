# SPDX-License-Identifier: Apache-2.0
"""The cost of the log, for a minute of Odometry at 240 Hz with noisy values and constant covariances.

The time for handing over is processor time of the thread that received the message. The time for writing is
that of the process less the former, so it includes compression. The size is that of the file for a message.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message

from benchmarks._log_rates import rates
from benchmarks._quotes import quote
from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.questions import Context, ImpactQuestion, ask
from contact_dynamics.recording import BagWriter, Recorder
from contact_dynamics.shapes import box
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters.impact import impact_answer_to_msg

RATE = 240
MESSAGES = 60 * RATE
TOPIC = "/brick/odometry"
EVENTS = "/contact_dynamics/predict_impact/_service_event"
BRICK = Body(
    name="brick",
    mass_properties=MassProperties(mass=0.4, I_B=np.diag([0.000353333, 0.000833333, 0.00102])),
    shape=box(size=(0.15, 0.09, 0.05)),
)
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)


def run() -> None:
    """Print times and sizes."""
    messages = _messages()
    _calls()
    rates(messages)
    size = len(messages[0])
    with tempfile.TemporaryDirectory() as folder:
        writer = BagWriter(Path(folder) / "log")
        writer.add_topic(TOPIC, "nav_msgs/msg/Odometry")
        process, thread = time.process_time(), time.thread_time()
        recorder = Recorder(writer)
        for i, data in enumerate(messages):
            recorder.record(TOPIC, data, log_time_ns=i * 1_000_000_000 // RATE)
        handing = time.thread_time() - thread
        status = recorder.close()
        writing = time.process_time() - process - handing
        if status.written != MESSAGES:
            raise RuntimeError(f"{status.written} of {MESSAGES} messages were written: {status.problem}")
        stored = writer.path.stat().st_size / MESSAGES
    per_hour = 1e-9 * stored * RATE * 3600
    print(
        f"an Odometry of {size} bytes: {stored:.0f} bytes in the file, {per_hour:.3f} GB an hour at {RATE} Hz"
    )
    print(f"handing it over {1e6 * handing / MESSAGES:.1f} us, writing it {1e6 * writing / MESSAGES:.1f} us")
    quote("recording.message", size, "bytes", digits=4)
    quote("recording.stored", stored, "bytes")
    quote("recording.hour", per_hour, "GB")
    quote("recording.hand_over", 1e6 * handing / MESSAGES, "µs", digits=1)
    quote("recording.write", 1e6 * writing / MESSAGES, "µs", digits=1)


def _calls() -> None:
    """Measure what a call costs the log: its request and its response, about an impact in space."""
    state = BodyState(p_WB_W=[0, 0, 0.4], q_WB=[0.6, 0, 0, 0.8], v_WB_W=[1, 0, -2], w_WB_W=[3, 5, 1])
    world = World(bodies=(BRICK,), surfaces=(FLOOR,))
    answer = ask(ImpactQuestion(body="brick", state=state), Context(world=world))
    response = impact_answer_to_msg(answer, world_frame="world")
    asked = PredictImpact.Event(request=[PredictImpact.Request(body_name="brick")])
    events = [serialize_message(each) for each in (asked, PredictImpact.Event(response=[response]))]
    calls = MESSAGES // 10
    with tempfile.TemporaryDirectory() as folder:
        writer = BagWriter(Path(folder) / "log")
        writer.add_topic(EVENTS, "contact_dynamics_interfaces/srv/PredictImpact_Event")
        process, thread = time.process_time(), time.thread_time()
        recorder = Recorder(writer)
        for i in range(calls):
            for data in events:
                recorder.record(EVENTS, data, log_time_ns=i)
        handing = time.thread_time() - thread
        recorder.close()
        whole = time.process_time() - process
        stored = writer.path.stat().st_size / calls
    print(
        f"a call: {1e6 * handing / calls:.1f} us in the server's thread, {1e6 * whole / calls:.1f} us in all"
    )
    quote("recording.call.hand_over", 1e6 * handing / calls, "µs")
    quote("recording.call", 1e6 * whole / calls, "µs")
    quote("recording.call.stored", stored, "bytes")


def _messages() -> list[bytes]:
    """Return a minute of one body's states, serialised."""
    rng = np.random.default_rng(0)
    message = Odometry()
    message.header.frame_id, message.child_frame_id = "world", "brick"
    message.pose.covariance = np.diag([1e-6] * 3 + [1e-5] * 3).ravel()
    message.twist.covariance = np.diag([1e-4] * 3 + [1e-2] * 3).ravel()
    found = []
    for i in range(MESSAGES):
        nanoseconds = i * 1_000_000_000 // RATE
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
        pose, twist = message.pose.pose, message.twist.twist
        for vector in (pose.position, twist.linear, twist.angular):
            vector.x, vector.y, vector.z = rng.normal(size=3).tolist()
        q = rng.normal(size=4)
        x, y, z, w = (q / np.linalg.norm(q)).tolist()
        pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = x, y, z, w
        found.append(serialize_message(message))
    return found
