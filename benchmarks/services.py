# SPDX-License-Identifier: Apache-2.0
"""Round trip of each service, between processes, beside an empty service of the same type in the same run.

The empty service returns its response untouched, so the ratio of both times shows what the answer costs
beside the middleware. A third service has the server's answer ready, and publishes its service events as the
server does. It computes nothing, so the ratio of its time shows what ROS takes for messages of this size.
Calls alternate between the three, so that a change of the machine's speed affects all.

"Inside" is the time that an answer takes in the server, as the response says. "CPU" is that of the server's
process for each call, including the log and the service events.

The targets are: at most 1.3 times the empty service at the median, inside at most a fifth of the server's
CPU, the first answer 2 s after the start, and 110 MB.
"""

from __future__ import annotations

import contextlib
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import Inertia
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.service_introspection import ServiceIntrospectionState

from benchmarks._quotes import quote
from benchmarks._service_calls import PATIENCE_S, QOS, ROOT, SERVICES, Asker, cpu_ms, questions
from contact_dynamics.demo.processes import claim_domain
from contact_dynamics_interfaces.msg import BodyStates
from contact_dynamics_interfaces.srv import (
    PredictImpactBatch,
    PredictTumbling,
    PredictTumblingBatch,
)

CALLS = 500
WARM_UP = 50
BATCH = 1000
"""States in one call of the services that take many."""


def run() -> None:
    """Measure and print the table."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(claim_domain())
    with tempfile.TemporaryDirectory() as log:
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": f"{log}/byte_code"}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        server = [
            sys.executable,
            "-m",
            "contact_dynamics",
            "server",
            "--params-file",
            str(ROOT / "config" / "server.yaml"),
        ]
        server += ["--ros-args", "-p", f"log_directory:={log}", "--log-level", "warn"]
        myself = [sys.executable, "-m", "benchmarks.services"]
        processes: list[subprocess.Popen[bytes]] = []

        def start(command: list[str]) -> int:
            processes.append(
                subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)  # noqa: S603  our own
            )
            return processes[-1].pid

        def start_ready(name: str, answer: Any) -> int:
            file = Path(log) / f"{name}.cdr"
            file.write_bytes(serialize_message(answer))
            return start([*myself, "ready", name, str(file)])

        try:
            _measure(
                start_server=lambda: start(server),
                start_empty=lambda: start([*myself, "empty"]),
                start_ready=start_ready,
            )
        finally:
            for process in processes:
                process.terminate()
            for process in processes:
                process.wait(PATIENCE_S)


def _measure(
    *,
    start_server: Callable[[], int],
    start_empty: Callable[[], int],
    start_ready: Callable[[str, Any], int],
) -> None:
    rclpy.init()
    node = Node("benchmark")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    server_pid, _ = _first_answer(node, executor, start_server)
    os.kill(server_pid, signal.SIGTERM)
    os.waitpid(server_pid, 0)
    # The first start has written byte code, which an installed package has.
    server_pid, first_answer = _first_answer(node, executor, start_server)
    quote("services.first_answer", first_answer, "s", digits=1)
    print(f"first answer {first_answer:.2f} s after the server's start")
    empty_pid = start_empty()
    print(f"{CALLS} calls of each, alternating; ms")
    print(
        f"{'question':34} {'p50':>6} {'p99':>6} {'CPU':>6}   {'empty p50':>9} {'p99':>6} {'CPU':>6}"
        f"   {'ratio':>6}   {'inside':>7} {'of CPU':>6}   {'ready p50':>9} {'CPU':>6} {'ratio':>6}"
    )
    inside, ratios, singles, of_messages = [], {}, {}, []
    for title, name, request in questions():
        ours, empty = (Asker(node, executor, server, name) for server in ("contact_dynamics", "empty"))
        ready_pid = start_ready(name, ours.ask(request))
        ready = Asker(node, executor, f"ready_{name}", name)
        for asker, pid in zip((ours, empty, ready), (server_pid, empty_pid, ready_pid), strict=True):
            asker.pid = pid
        _alternate([ours, empty, ready], request)
        medians = [statistics.median(asker.trips) for asker in (ours, empty, ready)]
        ratios[title] = medians[0] / medians[1]
        of_messages.append(medians[2] / medians[1])
        beside = f"   {medians[2]:9.2f} {ready.cpu / CALLS:6.2f} {of_messages[-1]:6.2f}"
        print(_line(title, ours, empty) + beside, flush=True)
        singles[title] = medians[0]
        inside.append(statistics.median(ours.inside))
        for asker in (ours, empty, ready):
            asker.close()
        os.kill(ready_pid, signal.SIGTERM)
    for title, name, request in _batches():
        askers = [Asker(node, executor, server, name) for server in ("contact_dynamics", "empty")]
        for asker, pid in zip(askers, (server_pid, empty_pid), strict=True):
            asker.pid = pid
        _alternate(askers, request)
        print(_line(f"{title}, {BATCH} at once", *askers))
        each = 1e3 * statistics.median(askers[0].trips) / BATCH
        print(
            f"{'':34} {each:.1f} µs for each, {1e3 * singles[title] / each:.0f} times less than a single call"
        )
        for asker in askers:
            asker.close()
    quote("services.ratio", list(ratios.values()))
    quote("services.ratio.of_messages", of_messages)
    quote("services.ratio.one_time", ratios["tumbling, one time"])
    quote("services.ratio.impact_in_space", ratios["impact, one contact in space"])
    quote("services.inside", inside, "ms")
    resident = (
        Path(f"/proc/{server_pid}/status").read_text(encoding="utf-8").split("VmRSS:")[1].split("kB")[0]
    )
    quote("services.memory", int(resident) / 1024, "MB")
    print(f"resident memory of the server: {int(resident) / 1024:.0f} MB")
    rclpy.shutdown()


def _first_answer(
    node: Node, executor: SingleThreadedExecutor, start_server: Callable[[], int]
) -> tuple[int, float]:
    """Start a server, and return its process and the time until its first answer, s."""
    started = time.perf_counter()
    server_pid = start_server()
    first = Asker(node, executor, "contact_dynamics", "predict_tumbling")
    first.ask(
        PredictTumbling.Request(
            inertia=Inertia(m=1.0, ixx=1.0, iyy=1.0, izz=1.0), state_source=1, times=[0.1]
        )
    )
    first_answer = time.perf_counter() - started
    first.close()
    return server_pid, first_answer


def _alternate(askers: list[Asker], request: Any) -> None:
    for call in range(WARM_UP + CALLS):
        if call == WARM_UP:
            for asker in askers:
                asker.forget()
        for asker in askers:
            asker.ask(request)
    for asker in askers:
        asker.cpu += cpu_ms(asker.pid)


def _line(title: str, ours: Asker, empty: Asker) -> str:
    trip, nothing = statistics.median(ours.trips), statistics.median(empty.trips)
    inside, cpu = statistics.median(ours.inside), ours.cpu / CALLS
    return (
        f"{title:34} {trip:6.2f} {_p99(ours.trips):6.2f} {cpu:6.2f}   {nothing:9.2f} {_p99(empty.trips):6.2f}"
        f" {empty.cpu / CALLS:6.2f}   {trip / nothing:6.2f}   {inside:7.3f} {100.0 * inside / cpu:5.0f}%"
    )


def _p99(times: list[float]) -> float:
    return statistics.quantiles(times, n=100)[98]


def _batches() -> list[tuple[str, str, Any]]:
    """Return questions about many states at once, each with the title of the single one."""
    draw = np.random.default_rng(29)
    states = BodyStates(
        positions=draw.normal(size=3 * BATCH).tolist(),
        orientations=[0.0, 0.0, 0.0, 1.0] * BATCH,
        linear_velocities=(draw.normal(size=(BATCH, 3)) - [0.0, 0.0, 5.0]).ravel().tolist(),
        angular_velocities=draw.normal(size=3 * BATCH).tolist(),
    )
    tumblings = PredictTumblingBatch.Request(body_name="brick", states=states, times=[0.1])
    points = np.array(states.positions).reshape(-1, 3) - [0.05, 0.02, 0.025]
    impacts = PredictImpactBatch.Request(
        body_name="brick",
        states=states,
        contact_positions=points.ravel().tolist(),
        contact_normals=[0.0, 0.0, 1.0],
        frictions=[0.5],
        restitutions=[0.5],
    )
    return [
        ("impact, one contact in space", "predict_impact_batch", impacts),
        ("tumbling, one time", "predict_tumbling_batch", tumblings),
    ]


def _serve_empty() -> None:
    rclpy.init()
    node = Node("empty")
    untouched: Callable[[Any, Any], Any] = lambda request, response: response  # noqa: ARG005, E731
    for name, service in SERVICES.items():
        node.create_service(service, f"~/{name}", untouched, qos_profile=QOS)
    _spin(node)


def _serve_ready(name: str, file: str) -> None:
    """Answer one service with what is in a file, and publish the service events."""
    rclpy.init()
    node = Node(f"ready_{name}")
    answer = deserialize_message(Path(file).read_bytes(), SERVICES[name].Response)
    same: Callable[[Any, Any], Any] = lambda request, response: answer  # noqa: ARG005, E731
    service = node.create_service(SERVICES[name], f"~/{name}", same, qos_profile=QOS)
    service.configure_introspection(node.get_clock(), QOS, ServiceIntrospectionState.CONTENTS)
    _spin(node)


def _spin(node: Node) -> None:
    executor = EventsExecutor()  # the same as the server's
    executor.add_node(node)
    with contextlib.suppress(ExternalShutdownException):
        while rclpy.ok():
            executor.spin_once(timeout_sec=0.1)


if __name__ == "__main__":
    if sys.argv[1:] == ["empty"]:
        _serve_empty()
    elif sys.argv[1:2] == ["ready"]:
        _serve_ready(*sys.argv[2:])
