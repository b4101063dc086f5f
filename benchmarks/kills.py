# SPDX-License-Identifier: Apache-2.0
"""Server, publisher and client are killed with SIGKILL at random, and started again.

After each kill a client asks until it has an answer. It prints how long that takes from the start of the
process that was killed, by which one it was; how much processor time that process took until then, which
tells more where others keep the machine busy; how much later than the start of its log a server answers,
which is what DDS adds to its own start; and how many messages the logs of the killed servers hold.
`python -m benchmarks.kills --times 200` kills 200 times. It ends with 1 if an answer took longer than the
aim.

The processes keep the bytecode of modules, as an installed package does. Where the environment forbids that,
each start would compile all of them, and take twice as long.

One server has been killed before the next one starts, so these are not two of one name. The other processes
stay, and must find the new one.

Client and publisher have queues of the usual depth, and the profile of `config/fast_dds_back_at_once.xml`,
which says what takes longer without it. With `--plain` they have no profile.
"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
import sys
import tempfile
import time
import warnings
from collections import defaultdict
from pathlib import Path
from typing import Any, Final

import rclpy
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.nodes.fast_dds import VARIABLE
from contact_dynamics.recording import BagReader
from contact_dynamics_interfaces.srv import PredictTumbling

TIMES: Final = 20
AIM_S: Final = 2.0
"""s, within which the service is back after a start."""

RATE: Final = 250.0  # Hz, of the states
LONGEST_LIFE_S: Final = 1.5  # between two kills
ASK_AGAIN_S: Final = 0.1
PATIENCE_S: Final = 60.0
SEED: Final = 12
USUAL: Final = QoSProfile(depth=10)
ROOT: Final = Path(__file__).parents[1]
ROLES: Final = ("server", "publisher", "client")


def run(times: int = TIMES, *, plain: bool = False) -> int:
    """Kill and measure; return 1 if an answer came later than the aim."""
    os.environ.update(ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST", ROS_DOMAIN_ID=str(claim_domain()))
    draw = random.Random(SEED)  # noqa: S311  nothing is secret
    took: dict[str, list[float]] = defaultdict(list)
    cpu: dict[str, list[float]] = defaultdict(list)
    beyond: list[float] = []  # the start of a server's log, s
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as bytecode:
        os.environ.update(PYTHONDONTWRITEBYTECODE="", PYTHONPYCACHEPREFIX=bytecode)
        commands = {
            "server": [
                *(sys.executable, "-m", "contact_dynamics", "server"),
                *("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args"),
                *("-p", f"log_directory:={folder}", "--log-level", "error"),
            ],
            "publisher": [sys.executable, "-m", "benchmarks.kills", "--role", "publisher"],
            "client": [sys.executable, "-m", "benchmarks.kills", "--role", "client"],
        }
        profile = {} if plain else {VARIABLE: str(ROOT / "config" / "fast_dds_back_at_once.xml")}
        own: dict[str, dict[str, str]] = {"server": {}, "publisher": profile, "client": profile}
        running = {role: _started(commands[role], own[role]) for role in ROLES}
        try:
            _wait_for_answer(running["client"], what="the first start")
            for _ in range(times):
                role = draw.choice(ROLES)
                time.sleep(draw.uniform(0.0, LONGEST_LIFE_S))
                running[role].kill()
                running[role].communicate()
                known, begun_ns = set(Path(folder).iterdir()), time.time_ns()
                running[role] = _started(commands[role], own[role])
                _forget_answers(running["client"])
                if role == "server":
                    _wait_for_log(Path(folder), known)
                    log_ns = time.time_ns()
                took[role].append(_wait_for_answer(running["client"], what=role, after_ns=begun_ns))
                if role == "server":
                    beyond.append(took[role][-1] - 1e-9 * (log_ns - begun_ns))
                cpu[role].append(_cpu_s(running[role].pid))
        finally:
            for process in running.values():
                process.kill()
                process.communicate()
        _print(took, cpu, Path(folder))
        if beyond:
            print(
                f"beyond the start of a server's log: median {_median(beyond):.2f} s, "
                f"longest {max(beyond):.2f} s"
            )
    return 0 if max(max(each) for each in took.values()) <= AIM_S else 1


def _print(took: dict[str, list[float]], cpu: dict[str, list[float]], folder: Path) -> None:
    for role, seconds in sorted(took.items()):
        ordered = sorted(seconds)
        late = sum(each > AIM_S for each in ordered)
        print(
            f"{role:10} killed {len(ordered):4} times; an answer after its start: "
            f"median {_median(seconds):.2f} s, longest {ordered[-1]:.2f} s, "
            f"later than {AIM_S:g} s: {late}; "
            f"processor time until then: median {_median(cpu[role]):.2f} s"
        )
    messages = [_messages(log) for log in sorted(folder.iterdir())]
    print(f"logs: {len(messages)}, with {sum(messages)} messages")


def _median(numbers: list[float]) -> float:
    return sorted(numbers)[len(numbers) // 2]


def _wait_for_log(folder: Path, known: set[Path]) -> None:
    """Wait until there is another log, whose server creates its services a moment later."""
    deadline = time.monotonic() + PATIENCE_S
    while set(folder.iterdir()) <= known and time.monotonic() < deadline:
        time.sleep(0.005)


def _messages(log: Path) -> int:
    """Return how many messages of a log can be read; an exception ends the benchmark."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a log was cut short, as all of these are
        return sum(1 for _ in BagReader(log).messages())


def _started(command: list[str], own: dict[str, str]) -> subprocess.Popen[bytes]:
    """Start a process, which has variables of its own."""
    return subprocess.Popen(command, cwd=ROOT, env=os.environ | own, stdout=subprocess.PIPE)  # noqa: S603  ours


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _forget_answers(client: subprocess.Popen[bytes]) -> None:
    """Take what a client has told so far."""
    assert client.stdout is not None
    os.set_blocking(client.stdout.fileno(), False)
    while client.stdout.read(65536):
        pass


def _wait_for_answer(client: subprocess.Popen[bytes], *, what: str, after_ns: int = 0) -> float:
    """Return how long after a time, ns, a client had the answer to a question that it asked after it, s."""
    assert client.stdout is not None
    os.set_blocking(client.stdout.fileno(), False)
    deadline, told = time.monotonic() + PATIENCE_S, b""
    while time.monotonic() < deadline:
        told += client.stdout.read() or b""
        for line in told.splitlines()[:-1]:
            numbers = line.split()
            if len(numbers) == 2 and int(numbers[0]) >= after_ns:
                return 1e-9 * (int(numbers[1]) - after_ns)
        time.sleep(0.005)
    raise RuntimeError(f"{what}: no answer within {PATIENCE_S:g} s")


def _publish() -> None:
    """Publish the state of the brick for ever."""
    rclpy.init()
    publisher = Node("publisher").create_publisher(Odometry, "/brick/odometry", USUAL)
    message = Odometry(child_frame_id="brick")
    message.header.frame_id = "world"
    while True:
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
        publisher.publish(message)
        time.sleep(1.0 / RATE)


def _ask() -> None:
    """Ask for ever, as a client with a deadline does, and tell of each answer when it was asked and came."""
    rclpy.init()
    node = Node("client")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    client = node.create_client(PredictTumbling, "/contact_dynamics/predict_tumbling", qos_profile=USUAL)
    while True:
        asked_ns = time.time_ns()
        future: Any = client.call_async(PredictTumbling.Request(body_name="brick", times=[0.1]))
        again = time.monotonic() + ASK_AGAIN_S
        while not future.done() and time.monotonic() < again:
            executor.spin_once(timeout_sec=0.02)
        if not future.done():
            client.remove_pending_request(future)
        elif future.result().status == PredictTumbling.Response.OK:
            print(asked_ns, time.time_ns(), flush=True)
            time.sleep(0.01)


def main() -> int:
    """Run as one of the processes, or all of it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kills", description=__doc__)
    parser.add_argument("--times", type=int, default=TIMES, help=f"how many are killed (default {TIMES})")
    parser.add_argument("--role", choices=ROLES[1:], help=argparse.SUPPRESS)
    parser.add_argument("--plain", action="store_true", help="start client and publisher without a profile")
    given = parser.parse_args()
    if given.role == "publisher":
        _publish()
    elif given.role == "client":
        _ask()
    return run(given.times, plain=given.plain)


if __name__ == "__main__":
    sys.exit(main())
