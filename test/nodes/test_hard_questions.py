# SPDX-License-Identifier: Apache-2.0
"""Questions that take long, over real DDS: they cost who asks them alone, and end when the server says."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from contact_dynamics.nodes.situations import Part, Situation
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from nodes.monitor import hard, monitored
from running_server import PATIENCE_S, ROOT, Client, process, wait_for

DEADLINE_S = 0.4
QUICKLY_S = 2.0  # far below what the hard questions would take, and far above what a busy machine takes
ENDS_S = 10.0  # a second on a quiet machine; to answer what waits would take a minute
MOMENTS = 16  # of an answer on its way
LEAVING = 200  # requests that a client leaves with
ARGUMENTS = ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "log:=false")

NAMESPACE = "/apart"  # the server of the fixture would answer what others are asked, too
APART = ("-r", f"__ns:={NAMESPACE}")


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    limits = ("-p", f"answer_deadline:={DEADLINE_S}", "-p", "workers:=1", "-p", "max_waiting:=1")
    with process("server", *ARGUMENTS, *limits, ready="ready"):
        client = Client()
        try:
            slowed = quick()
            slowed.linear_drag = 0.1
            client.spin_until(lambda: client.ask(slowed).status == 0)  # a worker, which is ready from here on
            yield client
        finally:
            client.close()


@contextlib.contextmanager
def apart(*arguments: str) -> Iterator[tuple[subprocess.Popen[str], Client]]:
    """A server that a test may end, and a client of it."""
    with process("server", *ARGUMENTS, *APART, *arguments, ready="ready") as server:
        client = Client(NAMESPACE)
        try:
            yield server, client
        finally:
            client.close()


def quick() -> Any:
    return PredictTumbling.Request(
        body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT, times=[0.1]
    )


def test_hard_questions_are_refused_in_time_and_quick_ones_are_answered_meanwhile(client: Client) -> None:
    begun = time.monotonic()
    futures = [client.begin_to_ask(hard()) for _ in range(6)]
    trips = []
    while not all(future.done() for future in futures):
        asked = time.monotonic()
        answer = client.ask(quick())
        assert answer.status == answer.OK, answer.message
        trips.append(time.monotonic() - asked)
        assert asked - begun < PATIENCE_S
    statuses = sorted(future.result().status for future in futures)
    codes = PredictImpact.Response
    assert codes.BUSY in statuses
    assert codes.TIMEOUT in statuses
    assert set(statuses) <= {codes.OK, codes.TOO_LARGE, codes.BUSY, codes.TIMEOUT}
    assert sorted(trips)[len(trips) // 2] < QUICKLY_S
    late = next(each.result() for each in futures if each.result().status == codes.TIMEOUT)
    assert "no answer within 0.4 s" in late.message
    assert late.message.endswith("(answer_deadline)")
    busy = next(each.result() for each in futures if each.result().status == codes.BUSY)
    assert busy.message.endswith("(workers and max_waiting)")
    assert late.computation_time < DEADLINE_S + QUICKLY_S


def test_a_client_that_leaves_with_requests_pending_freezes_nobody(client: Client) -> None:
    """To send to a client that left takes 0.1 s in DDS. All of its answers would take 20 s."""
    leaving = Client()
    request = quick()
    request.times = [0.001 * i for i in range(5000)]
    for _ in range(LEAVING):
        leaving.begin_to_ask(request)
    leaving.close()
    begun = time.monotonic()
    answer = client.ask(quick())
    assert answer.status == answer.OK, answer.message
    assert time.monotonic() - begun < 15.0  # of the 20 s that it took to send to who is gone


def test_a_server_that_a_busy_machine_stops_answers_all_the_same_and_ends_well() -> None:
    """Stopped for 0.07 s while it sends, it once took its client for gone. Here a stop meets each moment.

    Then it is stopped while requests wait, which are answered or rejected.
    """
    with apart() as (server, client):
        long = quick()
        long.times = [0.0001 * i for i in range(20_000)]
        client.ask(long)  # the first takes longer
        begun = time.monotonic()
        client.ask(long)
        trip = time.monotonic() - begun
        for i in range(MOMENTS):
            future = client.begin_to_ask(long)
            time.sleep(trip * i / MOMENTS)
            server.send_signal(signal.SIGSTOP)
            time.sleep(0.07)
            server.send_signal(signal.SIGCONT)
            client.spin_until(future.done)
            assert future.result().status == 0, future.result().message
        server.send_signal(signal.SIGSTOP)
        pending = [client.begin_to_ask(quick()) for _ in range(20)]
        time.sleep(0.2)  # they arrive
        server.send_signal(signal.SIGINT)
        server.send_signal(signal.SIGCONT)
        client.spin_until(lambda: all(one.done() for one in pending))
        codes = PredictTumbling.Response
        assert {one.result().status for one in pending} <= {codes.OK, codes.BUSY}
        assert server.wait(PATIENCE_S) == 0


def test_answers_that_are_ready_while_the_server_ends_do_not_make_it_fail() -> None:
    arguments = ("-p", "answer_deadline:=3600.0", "-p", "workers:=2", "-p", "max_waiting:=1000")
    with apart(*arguments) as (server, client):
        slowed = quick()
        slowed.linear_drag = 0.1
        slowed.times = [0.001 * i for i in range(1000)]
        answer = client.ask(slowed)  # a worker, which is ready from here on
        assert answer.status == answer.OK, answer.message
        pending = [client.begin_to_ask(slowed) for _ in range(500)]
        client.ask(quick())  # requests arrive in order, so that all of them are there once it is answered
        # A busy machine stops this process while the answers arrive, and its socket drops most of them.
        me = os.getpid()
        stopped = f"kill -STOP {me}; kill -INT {server.pid}; sleep 0.3; kill -CONT {me}"
        subprocess.run(["sh", "-c", stopped], check=True)
        assert server.wait(PATIENCE_S) == 0
        assert not pending[-1].done()
        client.spin_until(pending[-1].done)
        refused = pending[-1].result()
        assert refused.status == refused.BUSY
        assert refused.message == "the server ended, or was cleaned up, before the response was computed"


def test_the_server_ends_soon_whatever_is_being_computed() -> None:
    with apart("-p", "answer_deadline:=3600.0", "-p", "workers:=1") as (server, client):
        for _ in range(8):
            client.begin_to_ask(hard())
        answer = client.ask(quick())  # the others came before it
        assert answer.status == answer.OK, answer.message
        begun = time.monotonic()
        server.send_signal(signal.SIGTERM)
        assert server.wait(PATIENCE_S) == 0
        assert time.monotonic() - begun < ENDS_S


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_to_all_processes_meets_workers_that_still_start_without_a_traceback(
    number: signal.Signals,
) -> None:
    """Ctrl-C reaches all processes of a terminal, and a service manager stops all of a service."""
    with process("server", *ARGUMENTS, *APART, "-p", "workers:=2", group=True) as server:
        fork_server_of(server)
        os.killpg(server.pid, number)
        assert server.stdout is not None
        printed = server.stdout.read()
        assert server.wait(PATIENCE_S) == 0
        assert "Traceback" not in printed, printed


def test_a_signal_that_comes_while_another_is_handled_does_not_wait_for_it() -> None:
    """Ctrl-C comes in the moment in which the event of a SIGTERM has its lock."""
    program = """
import signal, sys
from contact_dynamics.nodes.running import stop_signals

def interrupt(frame, *_):
    if frame.f_code.co_name == "notify_all":
        sys.settrace(None)
        signal.raise_signal(signal.SIGINT)

with stop_signals() as stop:
    sys.settrace(interrupt)
    signal.raise_signal(signal.SIGTERM)
    assert stop.is_set() and sys.gettrace() is None
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=PATIENCE_S)


def fork_server_of(server: subprocess.Popen[str]) -> int:
    """The process from which the workers of a server are made, as soon as it is there."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        assert time.monotonic() < deadline
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):  # it ended meanwhile
                parent = int((folder / "stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[1])
                if parent == server.pid and b"forkserver" in (folder / "cmdline").read_bytes():
                    return int(folder.name)
        time.sleep(0.01)


def test_a_server_is_ready_once_its_workers_are(tmp_path: Path) -> None:
    """Quick questions are answered before. What starts the workers stands still here, as if it took long."""
    stopped: list[int] = []

    def stop_what_starts_workers(server: subprocess.Popen[str]) -> None:
        stopped.append(fork_server_of(server))
        os.kill(stopped[0], signal.SIGSTOP)

    with monitored(tmp_path, ready="", at_start=stop_what_starts_workers, log=False, workers=2) as (
        server,
        monitor,
    ):
        try:
            monitor.wait(Situation.WORKERS, "0 of 2 workers are ready")
            assert monitor.client.ask(quick()).status == 0
            told = printed(server)
            assert "ready" not in told
            assert told.startswith("contact-dynamics server: starting")
            assert "2 workers start; inexpensive requests are answered meanwhile" in told
        finally:
            os.kill(stopped[0], signal.SIGCONT)
        wait_for(server, "ready: bodies brick")
        monitor.wait_until_ok(Part.ANSWERS)


def printed(server: subprocess.Popen[str]) -> str:
    """What a server has printed so far."""
    lines = ""
    while server.stdout is not None and select.select([server.stdout], [], [], 0.0)[0]:
        lines += server.stdout.readline()
    return lines
