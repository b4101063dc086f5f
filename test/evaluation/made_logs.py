# SPDX-License-Identifier: Apache-2.0
"""Logs of the package's recorded toss, with other noise, as a server would have written them."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message

from contact_dynamics.demo.run import write_parameters
from contact_dynamics.demo.toss_publisher import topic_of
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.measured.recorded_toss import Toss
from contact_dynamics.nodes.run_record import run_record
from contact_dynamics.recording import BagWriter
from contact_dynamics.rotations.many import rotated, turned

BRIEF = 0.8  # s
EPOCH_NS = 1_700_000_000_000_000_000
PARTS = ("x", "y", "z", "w")


def parameters_of_toss(folder: Path, toss: Toss) -> dict[str, Any]:
    """The demo's parameters for a toss, and their file `server.yaml` in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    write_parameters(folder / "server.yaml", toss, log_directory=folder)
    content = json.loads((folder / "server.yaml").read_text(encoding="utf-8"))
    parameters: dict[str, Any] = content["/**"]["ros__parameters"]
    return parameters


def write_log(
    folder: Path,
    *,
    toss: Toss | None = None,
    seed: int | None = None,
    delay_ns: int = 2_000_000,
    clock_offset_ns: int = 0,
    with_run: bool = True,
    until: float = math.inf,
    names: Sequence[str] = (),
) -> Path:
    """A log of a toss.

    Args:
        folder: of the log, which is made.
        toss: whose states; None: the package's recording.
        seed: of noise that is added, half as large as the toss's own; None: none is.
        delay_ns: from a state's stamp until it arrives.
        clock_offset_ns: what the clock of the stamps lacks.
        until: s, the end of what is logged. `BRIEF` has a flight, an impact and the next flight.
        with_run: whether the log says how its server was configured.
        names: of bodies that move as the toss's, instead of it; that of the name "silent" has no states.
    """
    toss = toss or read_toss()
    parameters = parameters_of_toss(folder.parent / f"{folder.name}.parameters", toss)
    topics = {toss.body.name: topic_of(toss)}
    if names:
        own = [key for key in parameters if key.startswith(f"body.{toss.body.name}.")]
        of_toss = {key.removeprefix(f"body.{toss.body.name}."): parameters.pop(key) for key in own}
        topics = {name: f"/{name}/odometry" for name in names}
        for name, topic in topics.items():
            parameters |= {f"body.{name}.{key}": value for key, value in of_toss.items()}
            parameters[f"body.{name}.odometry_topic"] = topic
        parameters["bodies"] = list(names)
    p, q, v, w = shaken(toss, seed)
    body_axes = q * [-1.0, -1.0, -1.0, 1.0]
    resolved = {f"body.{name}.odometry_topic": topic for name, topic in topics.items()}
    run = run_record(parameters, resolved) if with_run else {}
    topics.pop("silent", None)
    with BagWriter(folder, run=run) as writer:
        for topic in topics.values():
            writer.add_topic(topic, "nav_msgs/msg/Odometry")
        for i, time in enumerate(toss.times[toss.times <= until].tolist()):
            stamp_ns = EPOCH_NS + round(1e9 * time) - clock_offset_ns
            msg = Odometry()
            msg.header.frame_id = "world"
            msg.header.stamp.sec, msg.header.stamp.nanosec = divmod(stamp_ns, 10**9)
            linear = rotated(body_axes[i : i + 1], v[i])[0]
            angular = rotated(body_axes[i : i + 1], w[i])[0]
            for k, part in enumerate(PARTS):
                setattr(msg.pose.pose.orientation, part, float(q[i, k]))
                if k < 3:
                    setattr(msg.pose.pose.position, part, float(p[i, k]))
                    setattr(msg.twist.twist.linear, part, float(linear[k]))
                    setattr(msg.twist.twist.angular, part, float(angular[k]))
            arrival = stamp_ns + clock_offset_ns + delay_ns
            for name, topic in topics.items():
                msg.child_frame_id = name
                data = bytes(serialize_message(msg))
                writer.write(topic, data, log_time_ns=arrival, publish_time_ns=stamp_ns)
    return folder


def shaken(toss: Toss, seed: int | None) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The poses and velocities of a toss with more noise."""
    if seed is None:
        return toss.p_WB_W, toss.q_WB, toss.v_WB_W, toss.w_WB_W
    random = np.random.default_rng(seed)
    n = len(toss)
    return (
        toss.p_WB_W + 0.5 * toss.position_noise * random.standard_normal((n, 3)),
        turned(toss.q_WB, 0.5 * toss.orientation_noise * random.standard_normal((n, 3))),
        toss.v_WB_W + 0.5 * toss.velocity_noise * random.standard_normal((n, 3)),
        toss.w_WB_W + 0.5 * toss.angular_velocity_noise * random.standard_normal((n, 3)),
    )
