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

from benchmarks._quotes import quote
from contact_dynamics.recording import BagWriter, Recorder

RATE = 240
MESSAGES = 60 * RATE
TOPIC = "/brick/odometry"


def run() -> None:
    """Print times and sizes."""
    messages = _messages()
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
