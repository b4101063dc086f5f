"""Round trip of each service, between processes, beside an empty service of the same type in the same run.

The empty one returns its response untouched, so that the ratio is what the answer costs over what the
middleware does. Calls alternate between the two, so that a change of the machine's speed meets both.
"""

from __future__ import annotations

import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

from contact_dynamics.demo.ros_domain import claim_domain
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling

CALLS = 500
WARM_UP = 50
QOS = QoSProfile(depth=1000)
PATIENCE_S = 20.0
ROOT = Path(__file__).parents[1]
SERVICES = {
    "predict_contact_mode": PredictContactMode,
    "predict_impact": PredictImpact,
    "predict_tumbling": PredictTumbling,
}


def run() -> None:
    """Measure and print the table."""
    environment = {
        **os.environ,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": str(claim_domain()),
    }
    os.environ.update(environment)
    with tempfile.TemporaryDirectory() as log:
        server = [
            sys.executable,
            "-m",
            "contact_dynamics",
            "server",
            "--params-file",
            str(ROOT / "config" / "server.yaml"),
        ]
        server += ["--ros-args", "-p", f"log_directory:={log}", "--log-level", "warn"]
        empty = [sys.executable, "-m", "benchmarks.services", "empty"]
        processes = [
            subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)  # noqa: S603  our own
            for command in (server, empty)
        ]
        try:
            _measure(processes[0].pid)
        finally:
            for process in processes:
                process.terminate()
            for process in processes:
                process.wait(PATIENCE_S)


def _measure(server_pid: int) -> None:
    rclpy.init()
    node = Node("benchmark")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    print(f"{CALLS} calls of each, alternating; ms")
    head = (
        f"{'question':34} {'p50':>6} {'p99':>6}   {'empty p50':>9} {'p99':>6}   {'ratio':>6}   {'inside':>7}"
    )
    print(head)
    for title, name, request in _questions():
        ours, empty, inside = _alternate(node, executor, name, request)
        ratio = statistics.median(ours) / statistics.median(empty)
        print(
            f"{title:34} {statistics.median(ours):6.2f} {_p99(ours):6.2f}   {statistics.median(empty):9.2f}"
            f" {_p99(empty):6.2f}   {ratio:6.2f}   {statistics.median(inside):7.3f}",
            flush=True,
        )
    resident = (
        Path(f"/proc/{server_pid}/status").read_text(encoding="utf-8").split("VmRSS:")[1].split("kB")[0]
    )
    print(f"resident memory of the server: {int(resident) / 1024:.0f} MB")
    rclpy.shutdown()


def _alternate(
    node: Node, executor: SingleThreadedExecutor, name: str, request: Any
) -> tuple[list[float], list[float], list[float]]:
    """Return the round trips of our service and of the empty one, and the time inside ours; ms."""
    clients = [
        node.create_client(SERVICES[name], f"/{server}/{name}", qos_profile=QOS)
        for server in ("contact_dynamics", "empty")
    ]
    for client in clients:
        if not client.wait_for_service(PATIENCE_S):
            raise TimeoutError(f"no service {client.srv_name}")
    trips: list[list[float]] = [[], []]
    inside = []
    for call in range(WARM_UP + CALLS):
        for client, times in zip(clients, trips, strict=True):
            start = time.perf_counter()
            future = client.call_async(request)
            while not future.done():
                executor.spin_once(timeout_sec=PATIENCE_S)
            answer = future.result()
            if answer.status != answer.OK:
                raise RuntimeError(answer.message)
            if call >= WARM_UP:
                times.append(1e3 * (time.perf_counter() - start))
                if client is clients[0]:
                    inside.append(1e3 * answer.computation_time)
    for client in clients:
        node.destroy_client(client)
    return trips[0], trips[1], inside


def _p99(times: list[float]) -> float:
    return statistics.quantiles(times, n=100)[98]


def _questions() -> list[tuple[str, str, Any]]:
    mode = PredictContactMode.Request()
    _box_on_floor(mode)
    impact = PredictImpact.Request()
    _box_on_floor(impact)
    impact.contacts.positions = impact.contacts.positions[:3]
    impact.contacts.normals = impact.contacts.normals[:3]
    impact.contacts.frictions = impact.contacts.frictions[:1]
    impact.contacts.restitutions = impact.contacts.restitutions[:1]
    impact.state.linear_velocity.z = -1.0
    impact.state.angular_velocity.x, impact.state.angular_velocity.y = 2.0, -3.0
    landing = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    _tossed(landing.state)
    one, many, contact = (
        PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
        for _ in range(3)
    )
    for request in (one, many, contact):
        _tossed(request.state)
    one.times = [0.1]
    many.times = [0.001 * i for i in range(1000)]
    contact.sampling, contact.rate = contact.UNTIL_CONTACT, 100.0
    return [
        ("contact mode, box on two feet", "predict_contact_mode", mode),
        ("impact, one contact in space", "predict_impact", impact),
        ("impact at the next landing", "predict_impact", landing),
        ("tumbling, one time", "predict_tumbling", one),
        ("tumbling, 1000 times", "predict_tumbling", many),
        ("tumbling until the first contact", "predict_tumbling", contact),
    ]


def _box_on_floor(request: Any) -> None:
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.contacts.positions = [-1.0, 0.0, -1.0, 1.0, 0.0, -1.0]
    request.contacts.normals = [0.0, 0.0, 1.0] * 2
    request.contacts.frictions = [0.5] * 2
    request.contacts.restitutions = [0.5] * 2


def _tossed(state: Any) -> None:
    state.pose.position.z = 1.0
    state.linear_velocity.x = 1.0
    state.angular_velocity.x, state.angular_velocity.y, state.angular_velocity.z = 1.0, 6.0, 2.0


def _serve_empty() -> None:
    rclpy.init()
    node = Node("empty")
    untouched: Callable[[Any, Any], Any] = lambda request, response: response  # noqa: ARG005, E731
    for name, service in SERVICES.items():
        node.create_service(service, f"~/{name}", untouched, qos_profile=QOS)
    executor = EventsExecutor()  # the same as the server's
    executor.add_node(node)
    with contextlib.suppress(ExternalShutdownException):
        while rclpy.ok():
            executor.spin_once(timeout_sec=0.1)


if __name__ == "__main__" and sys.argv[1:] == ["empty"]:
    _serve_empty()
