# SPDX-License-Identifier: Apache-2.0
"""A real server in its own process and a real client in this one, for the tests of nodes."""

from __future__ import annotations

import io
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.questions import services

ROOT = Path(__file__).parents[1]
DOMAIN_ID = claim_domain()  # of this test run alone
PATIENCE_S = 90.0
PATIENT = "state_timeout:=1000.0"  # no stall of a busy machine makes a state too old to ask about
DEEP = QoSProfile(depth=1000)
BYTECODE = Path(tempfile.gettempdir()) / f"contact_dynamics_bytecode_{os.getuid()}"
SERVICES = {each.service_type: f"/contact_dynamics/{each.name}" for each in services.SERVICES}


def environment(domain_id: int = DOMAIN_ID) -> dict[str, str]:
    """What processes of this test run are started with.

    Where Python is told to keep no bytecode, each would compile all modules, which doubles its start.
    """
    kept = {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(BYTECODE)}
    return {
        **os.environ,
        **(kept if sys.dont_write_bytecode else {}),
        "ROS_DOMAIN_ID": str(domain_id),
        "ROS_PYTHON_CHECK_FIELDS": "1",
        "PYTHONUNBUFFERED": "1",
        "PYTHONFAULTHANDLER": "1",  # so that SIGABRT makes it print where it is
    }


@contextmanager
def process(
    verb: str,
    *arguments: str,
    ready: str = "",
    domain_id: int = DOMAIN_ID,
    group: bool = False,
    program: Sequence[str] = ("-m", "contact_dynamics"),
    settings: Mapping[str, str] = MappingProxyType({}),
) -> Iterator[subprocess.Popen[str]]:
    """Start a verb of the command line; wait until it prints ``ready``; stop it with SIGINT, as it must.

    ``program`` is what Python runs, with ``settings`` in its environment. With ``group`` it leads a group of
    processes, as one that was started in a terminal does.

    Unless the arguments say otherwise, a server may take as long for an answer as tests wait, since on a busy
    machine the configured deadline of 5 s passes for questions that take milliseconds elsewhere. It has no
    workers, which take longer to start than it does.
    """
    command = [sys.executable, *program, verb, *arguments]
    for name, value in (("answer_deadline", PATIENCE_S), ("workers", 0)) if verb == "server" else ():
        if not any(argument.startswith(f"{name}:=") for argument in arguments):
            command += ["--ros-args", "-p", f"{name}:={value}"]
    started = subprocess.Popen(
        command,
        cwd=ROOT,
        env={**environment(domain_id), **settings},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        bufsize=0,
        start_new_session=group,
    )
    assert isinstance(started.stdout, io.TextIOWrapper)
    # Lines are read letter by letter. Otherwise a line that was read with the one before it waits in a buffer
    # where `select` does not see it.
    started.stdout._CHUNK_SIZE = 1  # type: ignore[attr-defined]
    try:
        if ready:
            wait_for(started, ready)
        yield started
    finally:
        started.send_signal(signal.SIGINT)
        try:
            started.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            started.kill()
            raise
        finally:
            assert started.stdout is not None
            started.stdout.close()


def wait_for(started: subprocess.Popen[str], text: str) -> str:
    """Return what a process printed up to the line that holds ``text``."""
    assert started.stdout is not None
    printed = ""
    deadline = time.monotonic() + PATIENCE_S
    while text not in printed:
        readable, _, _ = select.select([started.stdout], [], [], max(0.0, deadline - time.monotonic()))
        line = started.stdout.readline() if readable else ""
        if not line:
            for pid in [*_children_of(started.pid), started.pid]:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGABRT)
            last, _ = started.communicate(timeout=PATIENCE_S)
            pytest.fail(f"{started.args} did not print {text!r}:\n{printed}{last}")
        printed += line
    return printed


def _children_of(pid: int) -> list[int]:
    """The processes that a process has started, such as what starts the workers of a server."""
    tasks = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text(encoding="ascii").split()]


class Client:
    """A node that calls the services and publishes."""

    def __init__(self, namespace: str = "", *, wait: bool = True, domain_id: int = DOMAIN_ID) -> None:
        """Join the domain and find the services of the server in a namespace, and wait for them."""
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain_id)
        self.node = Node("test_client", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._namespace = namespace
        self._clients = {
            service: self.node.create_client(service, namespace + name, qos_profile=DEEP)
            for service, name in SERVICES.items()
        }
        for client in self._clients.values():
            assert not wait or client.wait_for_service(PATIENCE_S)
        if wait:
            self.wait_until_found()

    def ready(self) -> int:
        """Return how many of the services there are now."""
        return sum(client.service_is_ready() for client in self._clients.values())

    def publisher(self, msg_type: Any, topic: str, qos: QoSProfile = DEEP) -> Any:
        """Return a publisher that the server listens to.

        That it is matched here says nothing of the server, which may find it later and then takes nothing
        that was sent before.
        """
        made = self.node.create_publisher(msg_type, topic, qos)
        self.spin_until(lambda: made.get_subscription_count() > 0)
        self.wait_until_found()
        return made

    def wait_until_found(self) -> None:
        """Wait until the server has found all that this node has made.

        DDS announces the endpoints of a process in the order they were made in, so a server that answers a
        client made last has found the others. It drops an answer if it has not found who asked within 0.1 s,
        which happens on a busy machine. So this asks again.
        """
        probe = self.node.create_client(GetParameters, self._namespace + "/contact_dynamics/get_parameters")
        assert probe.wait_for_service(PATIENCE_S)
        answers: list[Any] = []

        def is_answered() -> bool:
            if not answers or time.monotonic() - begun > len(answers):  # once a second
                answers.append(probe.call_async(GetParameters.Request(names=["bodies"])))
            return any(answer.done() for answer in answers)

        begun = time.monotonic()
        self.spin_until(is_answered)
        self.node.destroy_client(probe)

    def ask(self, request: Any) -> Any:
        """Call the service that a request belongs to; return the response."""
        future = self.begin_to_ask(request)
        self.spin_until(future.done)
        return future.result()

    def begin_to_ask(self, request: Any) -> Any:
        """Call the service that a request belongs to; return the future of the response."""
        service = next(service for service in SERVICES if isinstance(request, service.Request))
        return self._clients[service].call_async(request)

    def spin_until(self, done: Any) -> None:
        """Spin until ``done()``; fail after a while."""
        deadline = time.monotonic() + PATIENCE_S
        while not done():
            assert time.monotonic() < deadline, "no answer"
            self._executor.spin_once(timeout_sec=0.1)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)


@contextmanager
def server_and_client(
    log_directory: Path,
    *,
    params_file: Path = ROOT / "config" / "server.yaml",
    domain_id: int = DOMAIN_ID,
    parameters: Sequence[str] = (),
) -> Iterator[Client]:
    """Run a server with the commented configuration, logging to ``log_directory``, and a client beside it.

    The parameters, each "name:=value", count before the configuration.
    """
    arguments = ["--params-file", str(params_file), "--ros-args", "-p", f"log_directory:={log_directory}"]
    for parameter in parameters:
        arguments += ["-p", parameter]
    with process("server", *arguments, ready="ready", domain_id=domain_id):
        client = Client(domain_id=domain_id)
        try:
            yield client
        finally:
            client.close()
