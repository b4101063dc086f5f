# SPDX-License-Identifier: Apache-2.0
"""Nodes are found on this machine alone, however they are started, unless the environment asks for more."""

from __future__ import annotations

import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

from contact_dynamics.command_line import DISCOVERY_RANGE
from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.nodes.fast_dds import PORTS_OF_DOMAIN, first_port, ports_in_use
from running_server import PATIENCE_S, ROOT, environment

FIRST_DISCOVERY = 10  # the port at which the first participant of a machine discovers others, in the domain
SERVER = ("server", "--ros-args", "-p", "log:=false", "-p", "workers:=0")
PYTHON = (sys.executable, "-m", "contact_dynamics")
SCRIPT = (str(Path(sys.executable).with_name("contact-dynamics")),)
EXECUTABLE = (sys.executable, str(ROOT / "executables" / "server"), *SERVER[1:])
TRAY = str(ROOT / "config" / "tray.yaml")
BLOCK = (*PYTHON, "block_publisher", "tray", "--ros-args", "--params-file", TRAY)
ASKS_FOR_MORE = {DISCOVERY_RANGE: "SUBNET"}
STARTS: list[tuple[tuple[str, ...], dict[str, str]]] = [
    ((*SCRIPT, *SERVER), {}),
    (EXECUTABLE, {DISCOVERY_RANGE: ""}),  # which ROS takes as if it were not set
    (BLOCK, {}),
    ((*PYTHON, *SERVER), ASKS_FOR_MORE),
]


def test_a_node_listens_to_other_machines_only_where_that_is_asked_for() -> None:
    """Whoever looks beyond this machine listens to multicast, at the first port of the domain."""
    with ExitStack() as stack:
        asked: dict[int, bool] = {}
        for command, variables in STARTS:
            domain_id = claim_domain()
            given = environment(domain_id)
            given.pop(DISCOVERY_RANGE)
            started = stack.enter_context(
                subprocess.Popen(
                    command,
                    cwd=ROOT,
                    env=given | variables,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
            )
            stack.callback(started.kill)
            asked[domain_id] = variables == ASKS_FOR_MORE
        deadline = time.monotonic() + PATIENCE_S
        while not all(map(has_joined, asked)):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert {domain_id: first_port(domain_id) in ports_in_use() for domain_id in asked} == asked


def has_joined(domain_id: int) -> bool:
    """Whether some process has the ports of a participant by now, which it takes after that of multicast."""
    first = first_port(domain_id)
    return any(first + FIRST_DISCOVERY <= port < first + PORTS_OF_DOMAIN for port in ports_in_use())
