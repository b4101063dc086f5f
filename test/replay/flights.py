# SPDX-License-Identifier: Apache-2.0
"""Recordings of a ball that flies, strikes the floor and flies on, exactly as the mechanics has it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from contact_dynamics import Body, BodyState, Surface, World, free_motion
from contact_dynamics.questions import Context, ImpactQuestion, ask
from msg_adapters.stamps import stamp_to_msg

START_NS = 1_700_000_000_000_000_000
RATE = 200  # Hz
CONFIGURATION = """
/**:
  ros__parameters:
    world_frame: world
    bodies: [ball]
    surfaces: [floor]
    body:
      ball:
        mass: 0.5
        inertia: [0.002, 0.002, 0.002, 0.0, 0.0, 0.0]
        sphere: [0.1]
    surface.floor.friction: 0.4
    surface.floor.restitution: 0.5
"""
BALL = Body.sphere(0.1, mass=0.5, name="ball")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.4, restitution=0.5)
WORLD = World(bodies=(BALL,), surfaces=(FLOOR,))
THROWN = BodyState(
    p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[0.5, 0, 1], w_WB_W=[3, 20, 1], stamp_ns=START_NS
)


def flight() -> list[BodyState]:
    """States that strike once; the last ones are before the second strike, which comes after 0.98 s."""
    impact = ask(ImpactQuestion(body="ball", state=THROWN), Context(world=WORLD))
    before = free_motion(BALL.mass_properties, THROWN)
    after = free_motion(BALL.mass_properties, impact.impact.state)
    states = []
    for number in range(int(0.95 * RATE)):
        seconds = number / RATE
        left = seconds - impact.seconds_to_contact
        state = before.state_at(seconds) if left < 0.0 else after.state_at(left)
        states.append(state)
    return states


def odometry(state: BodyState, frame: str = "world") -> Odometry:
    """A state as it is published. The body's frame is at its centre of mass, and the twist is in it."""
    msg: Any = Odometry(child_frame_id="ball")
    msg.header.frame_id, msg.header.stamp = frame, stamp_to_msg(state.stamp_ns)
    pose, twist = msg.pose.pose, msg.twist.twist
    pose.position.x, pose.position.y, pose.position.z = state.p_WB_W.tolist()
    q = pose.orientation
    q.x, q.y, q.z, q.w = state.q_WB.tolist()
    twist.linear.x, twist.linear.y, twist.linear.z = (state.R_WB.T @ state.v_WB_W).tolist()
    twist.angular.x, twist.angular.y, twist.angular.z = (state.R_WB.T @ state.w_WB_W).tolist()
    return msg


def write_flight(
    folder: Path,
    *,
    storage: StoragePlugin = StoragePlugin.SQLITE3,
    mode: CompressionMode = CompressionMode.NONE,
    topic: str = "/tracker/ball",
) -> None:
    """The flight as rosbags records it, with a few messages of another frame, and another topic."""
    store = get_typestore(Stores.ROS2_JAZZY)
    writer = RosbagsWriter(folder, version=9, storage_plugin=storage)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        states = writer.add_connection(topic, "nav_msgs/msg/Odometry", typestore=store)
        points = writer.add_connection("/points", "geometry_msgs/msg/Point", typestore=store)
        for number, state in enumerate(flight()):
            frame = "map" if number in {50, 51} else "world"
            data = bytes(serialize_message(odometry(state, frame)))
            writer.write(states, state.stamp_ns + 3_000_000, data)
            writer.write(points, state.stamp_ns + 3_000_000, b"\0\1\0\0" + bytes(24))
