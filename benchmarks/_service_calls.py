# SPDX-License-Identifier: Apache-2.0
"""Questions to the services of a server, and a client that asks them and keeps the times."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

from contact_dynamics.questions import services
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling

QOS = QoSProfile(depth=1000)
PATIENCE_S = 20.0
AGAIN_S = 2.0  # for an answer, before the question is asked again
ROOT = Path(__file__).parents[1]
SERVICES = {each.name: each.service_type for each in services.SERVICES}


class Asker:
    """A client that asks one server, and keeps the times."""

    def __init__(self, node: Node, executor: SingleThreadedExecutor, server: str, name: str) -> None:
        self._node = node
        self._executor = executor
        self._client = node.create_client(SERVICES[name], f"/{server}/{name}", qos_profile=QOS)
        if not self._client.wait_for_service(PATIENCE_S):
            raise TimeoutError(f"no service {self._client.srv_name}")
        self.pid = 0
        self.trips: list[float] = []  # ms
        self.inside: list[float] = []  # ms
        self.cpu = 0.0  # ms, of all calls that were kept

    def ask(self, request: Any) -> Any:
        """Ask, keep the times, and return the answer."""
        answer = None
        while answer is None:  # a server that has not found a new client yet cannot send it an answer
            start = time.perf_counter()
            future = self._client.call_async(request)
            while not future.done() and time.perf_counter() < start + AGAIN_S:
                self._executor.spin_once(timeout_sec=AGAIN_S)
            answer = future.result() if future.done() else None
        self.trips.append(1e3 * (time.perf_counter() - start))
        if answer.status != answer.OK:
            raise RuntimeError(answer.message)
        self.inside.append(1e3 * answer.computation_time)
        return answer

    def forget(self) -> None:
        """Forget all times so far."""
        self.trips.clear()
        self.inside.clear()
        self.cpu = -cpu_ms(self.pid)

    def close(self) -> None:
        self._node.destroy_client(self._client)


def cpu_ms(pid: int) -> float:
    """Return the CPU time that a process has taken, ms."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return 1e3 * (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def questions() -> list[tuple[str, str, Any]]:
    """Return questions, each with a title and the name of its service."""
    one_foot, two_feet, four_feet = (PredictContactMode.Request() for _ in range(3))
    on_floor(one_foot, [(-1.0, 0.0)])
    on_floor(two_feet, [(-1.0, 0.0), (1.0, 0.0)])
    on_floor(four_feet, [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    impact = PredictImpact.Request()
    on_floor(impact, [(-1.0, 0.0)])
    impact.state.linear_velocity.z = -1.0
    impact.state.angular_velocity.x, impact.state.angular_velocity.y = 2.0, -3.0
    in_plane = PredictImpact.Request(problem=PredictImpact.Request.PLANAR)
    on_floor(in_plane, [(-1.0, 0.0)])
    in_plane.state.linear_velocity.z, in_plane.state.angular_velocity.y = -1.0, -3.0
    landing = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    tossed(landing.state)
    one, ten, many, contact = (
        PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
        for _ in range(4)
    )
    for request in (one, ten, many, contact):
        tossed(request.state)
    one.times = [0.1]
    ten.times = [0.1 * i for i in range(10)]
    many.times = [0.001 * i for i in range(1000)]
    contact.sampling, contact.rate = contact.UNTIL_CONTACT, 100.0
    return [
        ("contact mode, one contact", "predict_contact_mode", one_foot),
        ("contact mode, box on two feet", "predict_contact_mode", two_feet),
        ("contact mode, box on four feet", "predict_contact_mode", four_feet),
        ("impact, one contact in the plane", "predict_impact", in_plane),
        ("impact, one contact in space", "predict_impact", impact),
        ("impact at the next landing", "predict_impact", landing),
        ("tumbling, one time", "predict_tumbling", one),
        ("tumbling, 10 times", "predict_tumbling", ten),
        ("tumbling, 1000 times", "predict_tumbling", many),
        ("tumbling until the first contact", "predict_tumbling", contact),
    ]


def on_floor(request: Any, feet: list[tuple[float, float]]) -> None:
    """Put a body at rest on feet at x, y below its centre of mass."""
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.contacts.positions = [number for x, y in feet for number in (x, y, -1.0)]
    request.contacts.normals = [0.0, 0.0, 1.0] * len(feet)
    request.contacts.frictions = [0.5] * len(feet)
    request.contacts.restitutions = [0.5] * len(feet)


def tossed(state: Any) -> None:
    state.pose.position.z = 1.0
    state.linear_velocity.x = 1.0
    state.angular_velocity.x, state.angular_velocity.y, state.angular_velocity.z = 1.0, 6.0, 2.0
