# SPDX-License-Identifier: Apache-2.0
"""The server under more than it can do: 20 bodies at 1 kHz, and four clients that ask as fast as they can.

It prints how many questions were answered and how fast, why others were not, how old the states in the
answers were, what came of the states that were published, and how the memory grew.
`python -m benchmarks.overload --duration 120` asks for two minutes, and `--duration 3600 --rate 250` for an
hour at another rate of each body. It tells of the memory every minute.

Publisher, clients and server share the machine, so that the numbers are of all of them together. The time
begins when each client has had its first answers. The memory still fills then: with the states of five
seconds, and with the queues of DDS, each of which keeps the room that its longest wait so far took. So the
last third tells whether the memory grows for good.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rclpy
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rclpy.signals import SignalHandlerOptions

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics_interfaces.srv import PredictTumbling

if TYPE_CHECKING:
    from collections.abc import Iterator

BODIES = 20
CLIENTS = 4
SECONDS = 20.0
RATE = 1000.0
PATIENCE_S = 30.0
TELL_EVERY_S = 60.0
ANSWER_S = 10.0  # for an answer; the server answers a client that seemed gone again after 1 s
REASONS = ("NO_STATE", "STALE_STATE", "BUSY", "TIMEOUT")  # of the refusals that a load can cause
DEEP = QoSProfile(depth=1000)
ROOT = Path(__file__).parents[1]


def run(seconds: float = SECONDS, rate: float = RATE) -> None:
    """Measure and print."""
    os.environ.update(ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST", ROS_DOMAIN_ID=str(claim_domain()))
    print(f"{BODIES} bodies at {rate:g} Hz, {CLIENTS} clients, {seconds:g} s")
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file = Path(folder) / "bodies.yaml"
        file.write_text(yaml.safe_dump(_configuration(folder)), encoding="utf-8")
        server = [sys.executable, "-m", "contact_dynamics", "server", "--params-file", str(file)]
        server_process = stack.enter_context(_process([*server, "--ros-args", "--log-level", "error"]))
        publisher = stack.enter_context(_process(_myself("publish", rate)))
        clients = [stack.enter_context(_process(_myself("ask", seconds, index))) for index in range(CLIENTS)]
        for client in clients:
            _line(client)  # it has its first answer
        watched = _watch(server_process.pid, seconds)
        asked = [json.loads(_line(client)) for client in clients]
        sent = json.loads(publisher.communicate(timeout=PATIENCE_S)[0])  # it ends with its input
        counts = _states(server_process.pid)
    _print(asked, sent, counts, watched)


def _print(asked: list[dict[str, Any]], sent: int, counts: dict[str, int], watched: dict[str, float]) -> None:
    trips = sorted(trip for each in asked for trip in each["trips"])
    ages = sorted(age for each in asked for age in each["ages"])
    failed: Counter[str] = Counter()
    for each in asked:
        failed.update(each["failed"])
    reasons = ", ".join(f"{count} {reason}" for reason, count in failed.most_common()) or "none"
    print(f"answers: {len(trips)}, {len(trips) / watched['seconds']:.0f} a second")
    print(f"questions without an answer: {reasons}")
    print(
        f"round trip: p50 {_at(trips, 0.5):.2f} ms, p99 {_at(trips, 0.99):.2f} ms, "
        f"longest {_at(trips, 1.0):.1f} ms"
    )
    print(f"age of the state in an answer: p50 {_at(ages, 0.5):.2f} ms, p99 {_at(ages, 0.99):.2f} ms")
    missing = sent - counts["messages"] - counts["lost"]
    print(
        f"states: {sent} published, {counts['messages']} received, {counts['lost']} lost and told, "
        f"{missing} before the first or after the last that came"
    )
    print(
        f"server: {watched['cpu']:.2f} cores, {watched['memory']:.0f} MB resident at the end, "
        f"growing by {watched['half']:.3f} MB/s in the second half, {watched['third']:.3f} in the last third"
    )


def _configuration(folder: str) -> dict[str, Any]:
    names = [f"body{index}" for index in range(BODIES)]
    parameters: dict[str, Any] = {"bodies": names, "log_directory": folder}
    for name in names:
        parameters[f"body.{name}.mass"] = 0.4
        parameters[f"body.{name}.inertia"] = [0.001, 0.002, 0.0025, 0.0, 0.0, 0.0]
        parameters[f"body.{name}.odometry_topic"] = f"/{name}/odometry"
    return {"/**": {"ros__parameters": parameters}}


def _watch(pid: int, seconds: float) -> dict[str, float]:
    """Return what a process took in this time."""
    begun, cpu = time.monotonic(), _cpu_s(pid)
    memory: list[tuple[float, float]] = []
    told = 0.0
    while (elapsed := time.monotonic() - begun) < seconds:
        memory.append((elapsed, _resident_mb(pid)))
        if elapsed >= told + TELL_EVERY_S:
            told = elapsed
            cores = (_cpu_s(pid) - cpu) / elapsed
            print(f"after {elapsed:.0f} s: {memory[-1][1]:.0f} MB resident, {cores:.2f} cores", flush=True)
        time.sleep(0.5)
    return {
        "seconds": elapsed,
        "cpu": (_cpu_s(pid) - cpu) / elapsed,
        "memory": memory[-1][1],
        "half": _slope(memory[len(memory) // 2 :]),
        "third": _slope(memory[2 * len(memory) // 3 :]),
    }


def _slope(points: list[tuple[float, float]]) -> float:
    return statistics.linear_regression(*zip(*points, strict=True)).slope if len(points) > 1 else math.nan


def _states(pid: int) -> dict[str, int]:
    """Return how many states the server received and lost, as it tells itself."""
    reports: list[DiagnosticArray] = []
    rclpy.init()
    node = Node("watcher")
    node.create_subscription(DiagnosticArray, "/diagnostics", reports.append, DEEP)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    deadline = time.monotonic() + PATIENCE_S
    while len(reports) < 3 and time.monotonic() < deadline:  # the first may be of before the last state
        executor.spin_once(timeout_sec=1.0)
    rclpy.shutdown()
    if not reports:
        raise RuntimeError(f"process {pid} tells nothing on /diagnostics")
    values = [pair for status in reports[-1].status for pair in status.values if "/odometry: " in pair.key]
    return {
        kind: sum(int(pair.value) for pair in values if pair.key.endswith(f": {kind}"))
        for kind in ("messages", "lost")
    }


def _publish(rate: float) -> None:
    """Publish until the input ends, so that all clients have states for as long as they ask."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    ended = threading.Event()

    def wait_for_end() -> None:
        sys.stdin.read()
        ended.set()

    threading.Thread(target=wait_for_end, daemon=True).start()
    node = Node("publisher")
    topics = [node.create_publisher(Odometry, f"/body{index}/odometry", DEEP) for index in range(BODIES)]
    messages = [Odometry(child_frame_id=f"body{index}") for index in range(BODIES)]
    deadline = time.monotonic() + PATIENCE_S
    while not all(topic.get_subscription_count() for topic in topics) and time.monotonic() < deadline:
        time.sleep(0.05)
    begun, rounds = time.monotonic(), 0
    while not ended.is_set():
        if rounds > (time.monotonic() - begun) * rate:
            time.sleep(0.5 / rate)
            continue
        for topic, message in zip(topics, messages, strict=True):
            message.header.frame_id = "world"
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
            topic.publish(serialize_message(message))
        rounds += 1
    time.sleep(5.0)  # what is on its way arrives, and the server tells of it
    print(rounds * BODIES)


def _ask(seconds: float, index: int) -> None:
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node(f"client{index}")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    client = node.create_client(PredictTumbling, "/contact_dynamics/predict_tumbling", qos_profile=DEEP)
    client.wait_for_service(PATIENCE_S)

    def ask(body: int) -> Any:
        future = client.call_async(PredictTumbling.Request(body_name=f"body{body}", times=[0.1]))
        # `spin_until_future_complete` gives the future one more callback each time that it wakes. All are
        # called with the answer, and wake the next call. A client that was busy once stays busy for good.
        given_up = time.monotonic() + ANSWER_S
        while not future.done() and (left := given_up - time.monotonic()) > 0.0:
            executor.spin_once(timeout_sec=left)
        if future.done():
            return future.result()
        client.remove_pending_request(future)
        return None

    deadline = time.monotonic() + PATIENCE_S
    for body in range(BODIES):  # until the states of all are told
        while ((answer := ask(body)) is None or answer.status != answer.OK) and time.monotonic() < deadline:
            time.sleep(0.1)
    print("asking", flush=True)
    trips, ages, asked = [], [], 0
    failed: Counter[str] = Counter()
    begun = time.monotonic()
    while time.monotonic() - begun < seconds:
        asked += 1
        start = time.perf_counter()
        answer = ask((index + asked) % BODIES)
        if answer is None:
            failed[f"without a response in {ANSWER_S:g} s"] += 1
            continue
        if answer.status != answer.OK:
            failed[_reason(answer)] += 1
            continue
        stamp = answer.state.header.stamp
        trips.append(1e3 * (time.perf_counter() - start))
        ages.append(1e-6 * (time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec))
    print(json.dumps({"trips": trips, "ages": ages, "failed": failed}), flush=True)


def _reason(answer: PredictTumbling.Response) -> str:
    """Return what a question was refused for: the name of the status, or the message of one not expected."""
    return next((name for name in REASONS if getattr(answer, name) == answer.status), str(answer.message))


@contextmanager
def _process(command: list[str]) -> Iterator[subprocess.Popen[str]]:
    started = subprocess.Popen(  # noqa: S603  our own
        command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    with started:  # which closes its pipes
        try:
            yield started
        finally:
            started.terminate()
            try:
                started.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                started.kill()


def _line(process: subprocess.Popen[str]) -> str:
    """Return the next line that a process prints."""
    line = process.stdout.readline() if process.stdout is not None else ""
    if not line:
        raise RuntimeError(f"process {process.pid} ended before it had told what it measured")
    return line


def _myself(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "benchmarks.overload", *map(str, arguments)]


def _at(values: list[float], share: float) -> float:
    return values[min(len(values) - 1, int(share * len(values)))] if values else math.nan


def _resident_mb(pid: int) -> float:
    text = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    return int(text.split("VmRSS:")[1].split("kB")[0]) / 1024


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _run_as_asked() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.overload", description=__doc__)
    parser.add_argument("--duration", type=float, default=SECONDS, help=f"s (default {SECONDS:g})")
    parser.add_argument("--rate", type=float, default=RATE, help=f"of each body, Hz (default {RATE:g})")
    given = parser.parse_args()
    run(given.duration, given.rate)


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["publish", rate]:
            _publish(float(rate))
        case ["ask", seconds, index]:
            _ask(float(seconds), int(index))
        case _:
            _run_as_asked()
